//! Carries out a study: its tests side by side, one thread each.
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use loadframe_api::{Calibration, JobSpec};
use loadframe_physics::{
    Decorator, Ending, Recorder, RunContext, SimulationError, Unrecorded, simulate,
};
use loadframe_run::{Engine, Progress, StopSwitch, thread_processor_time_s};

use crate::design::Design;
use crate::progress::StudyProgress;
use crate::runs_file::{Finished, RunsFile};
use crate::settings::Settings;
use crate::test_checkpoint::TestCheckpoint;

/// Messages under way before a test waits.
const MESSAGES: usize = 64;
/// Time between states kept of a test that runs.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);

/// How a study is carried out.
#[derive(Clone, Copy, Debug)]
pub struct StudyOptions<'a> {
    /// What computes.
    pub engine: Engine,
    /// Tests side by side.
    pub threads: usize,
    /// Where tests are kept.
    pub folder: &'a Path,
    pub switch: &'a StopSwitch,
}

/// How a study ended.
#[derive(Debug)]
pub enum StudyEnd<F> {
    Finished(F),
    /// Stopped early; the same call goes on.
    Suspended,
}

/// Why a study has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    #[error("{folder} cannot be used")]
    Folder {
        folder: String,
        #[source]
        source: io::Error,
    },
    #[error("the test with {setting}, seed {seed}, could not be done")]
    Simulation {
        setting: String,
        seed: u64,
        #[source]
        source: SimulationError,
    },
    #[error("no test has a result; the first: {reason}")]
    NoResults { reason: String },
    #[error("this machine gave no thread")]
    Machine(#[source] io::Error),
}

/// A test to be done.
struct Task {
    setting: usize,
    /// Its number among the seeds.
    seed: usize,
    spec: JobSpec,
    sha256: String,
}

enum Message {
    Progress {
        task: usize,
        fraction: f64,
    },
    Ended {
        task: usize,
        result: Box<Result<Option<Finished>, SimulationError>>,
    },
}

/// Runs all tests of `design` that `options.folder` does not hold yet.
///
/// # Errors
/// [`StudyError`] when no test has a result, or the folder or the machine cannot be used.
pub fn run<D: Design>(
    design: &D,
    options: StudyOptions<'_>,
    report: &mut dyn FnMut(Progress),
) -> Result<StudyEnd<D::Findings>, StudyError> {
    let unusable = |source| StudyError::Folder {
        folder: options.folder.display().to_string(),
        source,
    };
    let settings = design.settings();
    let (mut file, known) = RunsFile::open(options.folder, options.engine).map_err(unusable)?;
    let mut finished: Vec<Vec<Option<Finished>>> =
        vec![vec![None; settings.seeds().len()]; settings.len()];
    let mut tasks = Vec::new();
    for task in tasks_of(settings) {
        match known.get(&task.sha256) {
            Some(test) => finished[task.setting][task.seed] = Some(test.clone()),
            None => tasks.push(task),
        }
    }
    let calibration = Calibration::default();
    let weights = tasks
        .iter()
        .map(|task| task.spec.estimate(&calibration).wall_s);
    let mut progress = StudyProgress::new(settings.tests(), weights.collect());
    let next = AtomicUsize::new(0);
    let mut failure = None;
    thread::scope(|scope| {
        let (sender, receiver) = sync_channel(MESSAGES);
        for _ in 0..options.threads.clamp(1, tasks.len().max(1)) {
            let (sender, tasks, next) = (sender.clone(), &tasks, &next);
            let work = move || work(tasks, next, options, &sender);
            let spawned = thread::Builder::new().spawn_scoped(scope, work);
            spawned.map_err(StudyError::Machine)?;
        }
        drop(sender);
        for message in receiver {
            match message {
                Message::Progress { task, fraction } => progress.advance(task, fraction),
                Message::Ended { task, result } => {
                    let Task { setting, seed, .. } = tasks[task];
                    match *result {
                        Ok(Some(test)) => {
                            if let Some(reason) = &test.failure {
                                let (setting, seed) =
                                    (design.describe(setting), settings.seeds()[seed]);
                                tracing::warn!(setting, seed, reason, "a test has no result");
                            }
                            file.add(&test).map_err(unusable)?;
                            TestCheckpoint::new(
                                options.folder,
                                options.engine,
                                &tasks[task].sha256,
                            )
                            .remove();
                            finished[setting][seed] = Some(test);
                            progress.finish(task);
                        }
                        Ok(None) => {}
                        Err(source) => {
                            // nothing more is begun; what runs is still kept
                            next.store(tasks.len(), Ordering::Relaxed);
                            failure.get_or_insert(StudyError::Simulation {
                                setting: design.describe(setting),
                                seed: settings.seeds()[seed],
                                source,
                            });
                        }
                    }
                }
            }
            report(progress.now());
        }
        Ok(())
    })?;
    if let Some(failure) = failure {
        return Err(failure);
    }
    let complete = finished
        .into_iter()
        .map(|tests| tests.into_iter().collect());
    let Some(finished) = complete.collect::<Option<Vec<Vec<Finished>>>>() else {
        return Ok(StudyEnd::Suspended);
    };
    let mut tests = finished.iter().flatten();
    if let Some(reason) = tests.next().and_then(|first| first.failure.clone())
        && tests.all(|test| test.failure.is_some())
    {
        return Err(StudyError::NoResults { reason });
    }
    Ok(StudyEnd::Finished(
        design.findings(options.engine, &finished),
    ))
}

/// All tests, seed by seed: a study that is stopped early has whole seeds.
fn tasks_of(settings: &Settings) -> impl Iterator<Item = Task> {
    let seeds = settings.seeds().iter().enumerate();
    seeds.flat_map(move |(index, seed)| {
        (0..settings.len()).map(move |setting| {
            let spec = settings.test(setting, *seed);
            Task {
                setting,
                seed: index,
                sha256: spec.sha256(),
                spec,
            }
        })
    })
}

/// Does one test after the other until there are none left.
fn work(
    tasks: &[Task],
    next: &AtomicUsize,
    options: StudyOptions<'_>,
    messages: &SyncSender<Message>,
) {
    while let Some((task, Task { spec, sha256, .. })) = {
        let index = next.fetch_add(1, Ordering::Relaxed);
        tasks.get(index).map(|task| (index, task))
    } {
        if options.switch.cause().is_some() {
            return;
        }
        let checkpoint = TestCheckpoint::new(options.folder, options.engine, sha256);
        let attempt = || test(spec, task, options, &checkpoint, messages);
        let mut result = attempt();
        if let Err(SimulationError::Checkpoint(_)) = result {
            // what is lost is time, not the test
            checkpoint.remove();
            result = attempt();
        }
        let result = Box::new(result);
        if messages.send(Message::Ended { task, result }).is_err() {
            return;
        }
    }
}

/// Does a test, going on from its checkpoint where there is one; `None` when it was stopped.
fn test(
    spec: &JobSpec,
    task: usize,
    options: StudyOptions<'_>,
    checkpoint: &TestCheckpoint,
    messages: &SyncSender<Message>,
) -> Result<Option<Finished>, SimulationError> {
    let saved = checkpoint.read();
    let context = RunContext {
        threads: 1,
        interrupt: options.switch,
        checkpoint: saved.state(),
    };
    let mut recorder = TestRecorder {
        task,
        messages,
        checkpoint,
        cpu_before_s: saved.spent().cpu_s - thread_processor_time_s(),
        saved_at: Instant::now(),
        rest: Unrecorded,
    };
    let (engine, sha256) = (options.engine, saved.spec_sha256());
    match simulate(spec, context, &mut recorder) {
        Ok(Ending::Finished(report)) => {
            let cpu_s = recorder.cpu_s();
            Ok(Some(Finished::new(engine, sha256, cpu_s, report)))
        }
        Ok(Ending::Cancelled | Ending::Suspended) => Ok(None),
        Err(error) if error.is_of_the_spec() => {
            let cpu_s = recorder.cpu_s();
            let test = Finished::without_result(engine, sha256, cpu_s, &error);
            Ok(Some(test))
        }
        Err(error) => Err(error),
    }
}

/// A recorder that reports how far a test is and saves its state, and nothing else.
struct TestRecorder<'a> {
    task: usize,
    messages: &'a SyncSender<Message>,
    checkpoint: &'a TestCheckpoint,
    /// Processor time of the test before this run less that of the thread at its start [s].
    cpu_before_s: f64,
    /// When the state was last saved.
    saved_at: Instant,
    rest: Unrecorded,
}

impl TestRecorder<'_> {
    /// Processor time of the test so far [s].
    fn cpu_s(&self) -> f64 {
        self.cpu_before_s + thread_processor_time_s()
    }
}

impl Decorator for TestRecorder<'_> {
    fn inner(&self) -> &dyn Recorder {
        &self.rest
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        &mut self.rest
    }

    /// Nothing: a test has no folder of its own.
    fn file(
        &mut self,
        _: &str,
        _: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        Ok(())
    }

    fn progress(&mut self, fraction: f64, _: &str) {
        let task = self.task;
        // a full channel means that there is enough to show
        let _ = self.messages.try_send(Message::Progress { task, fraction });
    }

    fn checkpoint_due(&self) -> bool {
        self.saved_at.elapsed() >= CHECKPOINT_EVERY
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.saved_at = Instant::now();
        self.checkpoint.write(self.cpu_s(), bytes)
    }
}
