//! A job of several tests: which ones, side by side on the job's threads.
//!
//! A job of one test goes straight to [`super::run`]. Otherwise each test is such a run of a spec
//! of its own, with [`Relay`] for a recorder, and this thread listens to all of them: it alone
//! talks to the job's recorder and keeps the state of the plan. Tests are begun in the plan's
//! order and share nothing, so results do not know how many threads there were.
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use loadframe_api::{
    Report,
    spec::nonwoven_tensile::{Direction, NonwovenTensile},
};
use serde::{Deserialize, Serialize};

use super::{
    directions,
    relay::{Curve, Gate, Message, Passage, Relay, Share},
    repeats,
};
use crate::{
    Ending, Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::{self, Fingerprint},
};

/// Messages under way before a test waits for the recorder.
const MESSAGES: usize = 64;

/// The state of a plan: the content of its checkpoint.
#[derive(Debug, Serialize, Deserialize)]
struct Plan {
    spec: Fingerprint,
    tests: Vec<Test>,
    /// How far each test was.
    fractions: Vec<f64>,
    /// Columns and points of the job's own curve, needed again once its test is finished.
    columns: Vec<String>,
    points: Vec<Vec<f64>>,
}

/// A test of a plan.
#[derive(Debug, Serialize, Deserialize)]
enum Test {
    /// Nothing of it is kept.
    Waiting,
    /// Its own checkpoint.
    Begun(Vec<u8>),
    /// Its report as JSON, because a report leaves out what is empty and the form of checkpoints
    /// cannot; and its curve.
    Finished { report: String, curve: Curve },
}

/// Runs everything `spec` asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub(crate) fn run(
    spec: &NonwovenTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    if tests(spec) <= 1 {
        return super::run(spec, context, recorder);
    }
    let mut plan = Plan::new(spec, context, recorder)?;
    let gate = Gate::new(context.interrupt);
    let failure = plan.carry_out(spec, context.threads, &gate, recorder)?;
    match (gate.seen(), failure) {
        (Some(Interrupt::Cancel), _) => return Ok(Ending::Cancelled),
        (Some(Interrupt::Suspend), _) if !plan.is_finished() => {
            recorder.checkpoint(&checkpoint::pack(&plan)?)?;
            return Ok(Ending::Suspended);
        }
        (_, Some(error)) => return Err(error),
        (_, None) => {}
    }
    let (reports, curves) = plan.results()?;
    for (index, report) in reports.iter().enumerate() {
        recorder.log(&line(spec, index, report));
    }
    let per_repeat = reports.chunks(tests_per_repeat(spec));
    let reports: Vec<Report> = per_repeat
        .map(|reports| directions::join(&spec.test.directions, reports))
        .collect();
    let report = match reports.as_slice() {
        [report] => report.clone(),
        reports => {
            repeats::write(spec, reports, recorder)?;
            for direction in 0..tests_per_repeat(spec) {
                let name = share(spec, direction).name("repeats_curves.csv");
                let curves = curves
                    .iter()
                    .skip(direction)
                    .step_by(tests_per_repeat(spec));
                repeats::write_curves(&name, curves, recorder)?;
            }
            repeats::join(spec, reports)
        }
    };
    recorder.progress(1.0, "finished");
    Ok(Ending::Finished(report))
}

/// Tests in each repeat.
fn tests_per_repeat(spec: &NonwovenTensile) -> usize {
    spec.test.directions.len().max(1)
}

/// Tests of the job: the directions of each repeat after one another.
fn tests(spec: &NonwovenTensile) -> usize {
    spec.test.repeats as usize * tests_per_repeat(spec)
}

/// Number of the repeat and direction of test number `index`.
fn place(spec: &NonwovenTensile, index: usize) -> (u64, Option<Direction>) {
    let count = tests_per_repeat(spec);
    let direction = spec.test.directions.get(index % count);
    ((index / count) as u64, direction.copied())
}

/// The spec of test number `index`, on its own.
fn spec_of(spec: &NonwovenTensile, index: usize) -> NonwovenTensile {
    let (repeat, direction) = place(spec, index);
    let mut own = spec.clone();
    own.test.repeats = 1;
    own.test.directions = direction.into_iter().collect();
    own.seed += repeat;
    if repeat > 0 {
        // nobody would see them
        own.output.snapshot_every_steps = 0;
        own.output.force_distribution_strains.clear();
    }
    own
}

/// What the job shows of test number `index`: the first repeat, its first direction as its own.
fn share(spec: &NonwovenTensile, index: usize) -> Share {
    match place(spec, index) {
        _ if index == 0 => Share::All,
        (0, Some(direction)) => Share::Folder(directions::suffix(direction)),
        _ => Share::Nothing,
    }
}

/// A log line on a finished test.
fn line(spec: &NonwovenTensile, index: usize, report: &Report) -> String {
    let (repeat, direction) = place(spec, index);
    let along = match direction {
        Some(direction) if tests_per_repeat(spec) > 1 => format!(" along {}", direction.name()),
        _ => String::new(),
    };
    let value = |name: &str| report.summary.get(name).and_then(|quantity| quantity.value);
    format!(
        "seed {}{along}: {}, maximum force {} N, {} bonds broken",
        spec.seed + repeat,
        report.stop_reason.replace('_', " "),
        value("max_force").unwrap_or(f64::NAN),
        value("broken_bonds").unwrap_or(f64::NAN),
    )
}

/// What is going to be done.
fn overview(spec: &NonwovenTensile) -> String {
    let repeats = spec.test.repeats;
    let last = spec.seed + u64::from(repeats.saturating_sub(1));
    let specimens = match repeats {
        1 => "one specimen".to_owned(),
        _ => format!("{repeats} repeats, seeds {} to {last}", spec.seed),
    };
    match spec.test.directions.as_slice() {
        [first, second] => {
            let (first, second) = (first.name(), second.name());
            format!("{specimens}, along {first} and along {second}")
        }
        _ => specimens,
    }
}

impl Plan {
    /// A plan that has not begun, or the one of the checkpoint. The recorder hears what it has to
    /// hear before the tests speak.
    fn new(
        spec: &NonwovenTensile,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Self, SimulationError> {
        let count = tests(spec);
        let fingerprint = Fingerprint::of(spec)?;
        let Some(bytes) = context.checkpoint else {
            recorder.log(&overview(spec));
            return Ok(Self {
                spec: fingerprint,
                tests: (0..count).map(|_| Test::Waiting).collect(),
                fractions: vec![0.0; count],
                columns: Vec::new(),
                points: Vec::new(),
            });
        };
        let plan: Self = checkpoint::unpack(bytes)?;
        fingerprint.check(plan.spec)?;
        // a test that goes on repeats its curve itself
        if matches!(plan.tests.first(), Some(Test::Finished { .. })) {
            let columns: Vec<&str> = plan.columns.iter().map(String::as_str).collect();
            recorder.columns(&columns)?;
            for point in &plan.points {
                recorder.point(point)?;
            }
        }
        Ok(plan)
    }

    fn is_finished(&self) -> bool {
        let mut tests = self.tests.iter();
        tests.all(|test| matches!(test, Test::Finished { .. }))
    }

    /// Carries out the tests that are not finished, until they are or the gate closes. Returns the
    /// error of the first that failed.
    ///
    /// # Errors
    /// Of the recorder, the checkpoints and the threads, which are not those of a test.
    fn carry_out(
        &mut self,
        spec: &NonwovenTensile,
        threads: usize,
        gate: &Gate<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Option<SimulationError>, SimulationError> {
        let open = self
            .tests
            .iter()
            .enumerate()
            .filter_map(|(run, test)| match test {
                Test::Waiting => Some((run, None)),
                Test::Begun(bytes) => Some((run, Some(bytes.clone()))),
                Test::Finished { .. } => None,
            });
        let open: Vec<(usize, Option<Vec<u8>>)> = open.collect();
        let workers = threads.clamp(1, open.len().max(1));
        let stage = Stage {
            spec,
            // where there are fewer tests than threads, each gets several
            threads: (threads / workers).max(1),
            open: &open,
            next: &AtomicUsize::new(0),
            requests: &AtomicU64::new(0),
            gate,
        };
        thread::scope(|scope| {
            let (sender, receiver) = sync_channel(MESSAGES);
            let mut handles = Vec::with_capacity(workers);
            for _ in 0..workers {
                let sender = sender.clone();
                let work = move || stage.work(&sender);
                let handle = thread::Builder::new().spawn_scoped(scope, work);
                handles.push(handle.map_err(|error| {
                    gate.stop(Interrupt::Cancel);
                    SimulationError::Threads {
                        threads,
                        reason: error.to_string(),
                    }
                })?);
            }
            drop(sender);
            let heard = self.listen(receiver, stage.requests, gate, recorder);
            if heard.is_err() {
                gate.stop(Interrupt::Cancel);
            }
            for handle in handles {
                if let Err(panic) = handle.join() {
                    // a bug in a test is that of the job, with its own words
                    std::panic::resume_unwind(panic);
                }
            }
            heard
        })
    }

    /// Takes in what the tests say until all have ended.
    fn listen(
        &mut self,
        messages: Receiver<Message>,
        requests: &AtomicU64,
        gate: &Gate<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Option<SimulationError>, SimulationError> {
        let mut failure: Option<(usize, SimulationError)> = None;
        // for each running test, the last checkpoint request it answered
        let mut answers: Vec<Option<u64>> = vec![None; self.tests.len()];
        let (mut asked, mut kept) = (0, 0);
        for message in messages {
            match message {
                Message::Started { run, answered } => answers[run] = Some(answered),
                Message::Columns(columns) => {
                    let names: Vec<&str> = columns.iter().map(String::as_str).collect();
                    recorder.columns(&names)?;
                    self.columns = columns;
                    self.points.clear();
                }
                Message::Point(values) => {
                    recorder.point(&values)?;
                    self.points.push(values);
                }
                Message::File { name, bytes } => {
                    recorder.file(&name, &mut |out| out.write_all(&bytes))?;
                }
                Message::Progress { run, fraction } => {
                    self.progress(run, fraction, recorder);
                    if asked == kept && recorder.checkpoint_due() {
                        asked += 1;
                        requests.store(asked, Ordering::Relaxed);
                    }
                }
                Message::Checkpoint {
                    run,
                    bytes,
                    answered,
                } => {
                    self.tests[run] = Test::Begun(bytes);
                    answers[run] = Some(answered);
                }
                Message::Ended { run, result, curve } => {
                    answers[run] = None;
                    match *result {
                        Ok(Ending::Finished(report)) => {
                            let report =
                                serde_json::to_string(&report).map_err(checkpoint::form)?;
                            self.tests[run] = Test::Finished { report, curve };
                        }
                        Ok(Ending::Cancelled | Ending::Suspended) => {}
                        Err(error) => {
                            gate.fail(run);
                            if failure.as_ref().is_none_or(|(first, _)| run < *first) {
                                failure = Some((run, error));
                            }
                        }
                    }
                }
            }
            if asked > kept && answers.iter().flatten().all(|answered| *answered >= asked) {
                recorder.checkpoint(&checkpoint::pack(self)?)?;
                kept = asked;
            }
        }
        Ok(failure.map(|(_, error)| error))
    }

    /// How far all tests together are.
    fn progress(&mut self, run: usize, fraction: f64, recorder: &mut dyn Recorder) {
        // a test that goes on from a state before the last one told catches up in silence
        self.fractions[run] = self.fractions[run].max(fraction);
        let count = self.tests.len();
        let done = self.fractions.iter().sum::<f64>() / count as f64;
        let finished = self.tests.iter();
        let finished = finished.filter(|test| matches!(test, Test::Finished { .. }));
        let phase = format!("{} of {count} tests finished", finished.count());
        recorder.progress(done, &phase);
    }

    /// Reports and curves in the plan's order.
    fn results(self) -> Result<(Vec<Report>, Vec<Curve>), SimulationError> {
        let finished = self.tests.into_iter().map(|test| match test {
            Test::Finished { report, curve } => {
                let report = serde_json::from_str(&report).map_err(checkpoint::form)?;
                Ok((report, curve))
            }
            Test::Waiting | Test::Begun(_) => {
                Err(checkpoint::form("a test is not finished").into())
            }
        });
        finished.collect()
    }
}

/// What the threads of a plan share.
#[derive(Clone, Copy)]
struct Stage<'a> {
    spec: &'a NonwovenTensile,
    /// Threads for each test.
    threads: usize,
    /// Tests to be done in their order, and what they go on from.
    open: &'a [(usize, Option<Vec<u8>>)],
    next: &'a AtomicUsize,
    requests: &'a AtomicU64,
    gate: &'a Gate<'a>,
}

impl Stage<'_> {
    /// Does one test after the other until there are none left or the gate is closed.
    fn work(&self, messages: &SyncSender<Message>) {
        while let Some((run, saved)) = self.open.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let run = *run;
            if self.gate.is_closed(run) {
                return;
            }
            let answered = self.requests.load(Ordering::Relaxed);
            if messages.send(Message::Started { run, answered }).is_err() {
                return;
            }
            let mut relay = Relay {
                run,
                share: share(self.spec, run),
                curve: Vec::new(),
                messages: messages.clone(),
                requests: self.requests,
                answered,
            };
            let passage = Passage {
                gate: self.gate,
                run,
            };
            let context = RunContext {
                threads: self.threads,
                interrupt: &passage,
                checkpoint: saved.as_deref(),
            };
            let result = super::run(&spec_of(self.spec, run), context, &mut relay);
            let (result, curve) = (Box::new(result), relay.curve);
            if messages
                .send(Message::Ended { run, result, curve })
                .is_err()
            {
                return;
            }
        }
    }
}
