//! A job of several tests, side by side on the job's threads.
//!
//! Each test is a run of its own, with [`Relay`] for a recorder, and the calling thread listens to
//! all of them: it alone talks to the job's recorder and keeps the state of the plan. Tests are
//! begun in the plan's order and share nothing, so results do not know how many threads there were.
//! What the tests are, a kind says by [`Tests`]; a [`CurveKeeper`] keeps what a test draws. Where they
//! are the same test of further specimens, it says so by [`Specimens`], and the rest is done here.
mod directions;
mod gate;
mod keeper;
mod relay;
mod reports;
mod specimens;

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use loadframe_numerics::ThreadsError;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{
    Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::{self, Fingerprint},
};
use gate::{Gate, Passage};
use relay::{Message, Relay};

pub use directions::Compared;
pub use keeper::{Curve, CurveKeeper};
pub use relay::{Conclusion, Share};
pub use reports::{SavedReport, joint_warnings, mean, values, worst_quality};
use reports::{add_sampling_errors, join_repeats, write_repeats};
pub use specimens::{Place, Specimens, first_of, test_specimens};

/// Messages under way before a test waits for the recorder.
const MESSAGES: usize = 64;

/// What the tests of a plan are.
pub trait Tests: Sync {
    /// What is kept of a finished test.
    type Result: Send + Serialize + DeserializeOwned;

    /// What the job's recorder gets of a test.
    fn share(&self, test: usize) -> Share;

    /// Carries out a test.
    ///
    /// # Errors
    /// What made a result impossible.
    fn run(
        &self,
        test: usize,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<Self::Result>, SimulationError>;
}

/// The state of a plan: the content of its checkpoint.
#[derive(Debug, Serialize, Deserialize)]
pub struct Plan<T> {
    job: Fingerprint,
    tests: Vec<Test<T>>,
    /// How far each test was.
    fractions: Vec<f64>,
    /// Columns and points of the job's own curve, needed again once its test is finished.
    columns: Vec<String>,
    points: Vec<Vec<f64>>,
}

/// A test of a plan.
#[derive(Debug, Serialize, Deserialize)]
enum Test<T> {
    /// Nothing of it is kept.
    Waiting,
    /// Its own checkpoint.
    Begun(Vec<u8>),
    Finished(T),
}

impl<T: Send + Serialize + DeserializeOwned> Plan<T> {
    /// A plan of so many tests that has not begun.
    pub fn new(job: Fingerprint, count: usize) -> Self {
        Self {
            job,
            tests: (0..count).map(|_| Test::Waiting).collect(),
            fractions: vec![0.0; count],
            columns: Vec::new(),
            points: Vec::new(),
        }
    }

    /// The plan of a checkpoint. The recorder hears what it has to hear before the tests speak.
    ///
    /// # Errors
    /// When the checkpoint cannot be used or the recorder fails.
    pub fn resume(
        job: Fingerprint,
        bytes: &[u8],
        recorder: &mut dyn Recorder,
    ) -> Result<Self, SimulationError> {
        let plan: Self = checkpoint::unpack(bytes)?;
        job.check(plan.job)?;
        // a test that goes on repeats its curve itself
        if matches!(plan.tests.first(), Some(Test::Finished(_))) && !plan.columns.is_empty() {
            let columns: Vec<&str> = plan.columns.iter().map(String::as_str).collect();
            recorder.columns(&columns)?;
            for point in &plan.points {
                recorder.point(point)?;
            }
        }
        Ok(plan)
    }

    /// Carries out the tests that are not finished. A plan that is told to suspend leaves its
    /// checkpoint with the recorder.
    ///
    /// # Errors
    /// Of the first test that failed, or of the recorder, the checkpoints and the threads.
    pub fn carry_out(
        mut self,
        tests: &impl Tests<Result = T>,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Conclusion<Vec<T>>, SimulationError> {
        let gate = Gate::new(context.interrupt);
        let failure = self.work(tests, context.threads, &gate, recorder)?;
        match (gate.seen(), failure) {
            (Some(Interrupt::Cancel), _) => Ok(Conclusion::Interrupted(Interrupt::Cancel)),
            (Some(Interrupt::Suspend), _) if !self.is_finished() => {
                recorder.checkpoint(&checkpoint::pack(&self)?)?;
                Ok(Conclusion::Interrupted(Interrupt::Suspend))
            }
            (_, Some(error)) => Err(error),
            (_, None) => self.results(),
        }
    }

    fn is_finished(&self) -> bool {
        let mut tests = self.tests.iter();
        tests.all(|test| matches!(test, Test::Finished(_)))
    }

    /// Carries out the tests that are not finished, until they are or the gate closes. Returns the
    /// error of the first that failed.
    ///
    /// # Errors
    /// Of the recorder, the checkpoints and the threads, which are not those of a test.
    fn work(
        &mut self,
        tests: &impl Tests<Result = T>,
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
                Test::Finished(_) => None,
            });
        let open: Vec<(usize, Option<Vec<u8>>)> = open.collect();
        let workers = threads.clamp(1, open.len().max(1));
        let stage = Stage {
            tests,
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
                let stage = &stage;
                let work = move || stage.work(&sender);
                let handle = thread::Builder::new().spawn_scoped(scope, work);
                handles.push(handle.map_err(|error| {
                    gate.stop(Interrupt::Cancel);
                    ThreadsError {
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
        messages: Receiver<Message<T>>,
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
                Message::Ended { run, result } => {
                    answers[run] = None;
                    match *result {
                        Ok(Conclusion::Finished(result)) => {
                            self.tests[run] = Test::Finished(result);
                        }
                        Ok(Conclusion::Interrupted(_)) => {}
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
                recorder.checkpoint(&checkpoint::pack_wanted(self, gate.source())?)?;
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
        let finished = finished.filter(|test| matches!(test, Test::Finished(_)));
        let phase = format!("{} of {count} tests finished", finished.count());
        recorder.progress(done, &phase);
    }

    /// What the tests left, in the plan's order.
    fn results(self) -> Result<Conclusion<Vec<T>>, SimulationError> {
        let finished = self.tests.into_iter().map(|test| match test {
            Test::Finished(result) => Ok(result),
            Test::Waiting | Test::Begun(_) => {
                Err(checkpoint::form("a test is not finished").into())
            }
        });
        let results: Result<Vec<T>, SimulationError> = finished.collect();
        results.map(Conclusion::Finished)
    }
}

/// What the threads of a plan share.
struct Stage<'a, K> {
    tests: &'a K,
    /// Threads for each test.
    threads: usize,
    /// Tests to be done in their order, and what they go on from.
    open: &'a [(usize, Option<Vec<u8>>)],
    next: &'a AtomicUsize,
    requests: &'a AtomicU64,
    gate: &'a Gate<'a>,
}

impl<K: Tests> Stage<'_, K> {
    /// Does one test after the other until there are none left or the gate is closed.
    fn work(&self, messages: &SyncSender<Message<K::Result>>) {
        while let Some((run, saved)) = self.open.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let run = *run;
            if self.gate.is_closed(run) {
                return;
            }
            let answered = self.requests.load(Ordering::Relaxed);
            if messages.send(Message::Started { run, answered }).is_err() {
                return;
            }
            let passage = Passage {
                gate: self.gate,
                run,
            };
            let mut relay = Relay {
                run,
                passage: &passage,
                share: self.tests.share(run),
                messages: messages.clone(),
                requests: self.requests,
                answered,
            };
            let context = RunContext {
                threads: self.threads,
                interrupt: &passage,
                checkpoint: saved.as_deref(),
            };
            let result = Box::new(self.tests.run(run, context, &mut relay));
            if messages.send(Message::Ended { run, result }).is_err() {
                return;
            }
        }
    }
}
