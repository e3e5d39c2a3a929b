//! Carries out a study: its tests side by side, one thread each.
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;
use std::time::Instant;

use loadframe_api::{Calibration, JobSpec, Report};
use loadframe_physics::{Ending, Recorder, RunContext, SimulationError, simulate};

use super::analysis::Study;
use super::design::Design;
use super::runs_file::{Finished, RunsFile};
use crate::machine::thread_processor_time_s;
use crate::run::{Progress, TimeToGo};
use crate::{ENGINE_COMMIT, StopSwitch};

/// Messages under way before a test waits.
const MESSAGES: usize = 64;

/// How a study is carried out.
#[derive(Clone, Copy, Debug)]
pub struct StudyOptions<'a> {
    /// Tests side by side.
    pub threads: usize,
    /// Where finished tests are kept.
    pub folder: &'a Path,
    pub switch: &'a StopSwitch,
}

/// How a study ended.
#[derive(Debug)]
pub enum StudyEnd {
    Finished(Box<Study>),
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
    #[error("the test with {setting}, seed {seed}, has no result")]
    Simulation {
        setting: String,
        seed: u64,
        #[source]
        source: SimulationError,
    },
    #[error("this machine gave no thread")]
    Machine(#[source] io::Error),
}

/// A test to be done.
struct Task {
    setting: usize,
    seed: usize,
    spec: JobSpec,
    sha256: String,
    /// Expected share of the work.
    weight: f64,
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
/// [`StudyError`] when a test has no result or the folder cannot be used.
pub fn run(
    design: &Design,
    options: StudyOptions<'_>,
    tell: &mut dyn FnMut(Progress),
) -> Result<StudyEnd, StudyError> {
    let unusable = |source| StudyError::Folder {
        folder: options.folder.display().to_string(),
        source,
    };
    let (mut file, known) = RunsFile::open(options.folder).map_err(unusable)?;
    let mut finished: Vec<Vec<Option<Finished>>> =
        vec![vec![None; design.seeds.len()]; design.settings.len()];
    let mut tasks = Vec::new();
    for task in tasks_of(design) {
        match known.get(&task.sha256) {
            Some(test) => finished[task.setting][task.seed] = Some(test.clone()),
            None => tasks.push(task),
        }
    }
    let mut bar = Bar::new(design.tests(), &tasks);
    let next = AtomicUsize::new(0);
    let mut failure = None;
    thread::scope(|scope| {
        let (sender, receiver) = sync_channel(MESSAGES);
        for _ in 0..options.threads.clamp(1, tasks.len().max(1)) {
            let (sender, tasks, next) = (sender.clone(), &tasks, &next);
            let work = move || work(tasks, next, options.switch, &sender);
            let spawned = thread::Builder::new().spawn_scoped(scope, work);
            spawned.map_err(StudyError::Machine)?;
        }
        drop(sender);
        for message in receiver {
            match message {
                Message::Progress { task, fraction } => bar.fractions[task] = fraction,
                Message::Ended { task, result } => {
                    let Task { setting, seed, .. } = tasks[task];
                    match *result {
                        Ok(Some(test)) => {
                            file.add(&test).map_err(unusable)?;
                            finished[setting][seed] = Some(test);
                            bar.finish(task);
                        }
                        Ok(None) => {}
                        Err(source) => {
                            // nothing more is begun; what runs is still kept
                            next.store(tasks.len(), Ordering::Relaxed);
                            failure.get_or_insert(StudyError::Simulation {
                                setting: design.words(setting),
                                seed: design.seeds[seed],
                                source,
                            });
                        }
                    }
                }
            }
            tell(bar.progress());
        }
        Ok(())
    })?;
    if let Some(failure) = failure {
        return Err(failure);
    }
    let complete = finished
        .into_iter()
        .map(|tests| tests.into_iter().collect());
    Ok(match complete.collect::<Option<Vec<Vec<Finished>>>>() {
        Some(finished) => StudyEnd::Finished(Box::new(Study::of(design, &finished))),
        None => StudyEnd::Suspended,
    })
}

/// All tests, seed by seed: a study that is stopped early has whole seeds.
fn tasks_of(design: &Design) -> impl Iterator<Item = Task> {
    let calibration = Calibration::default();
    design
        .seeds
        .iter()
        .enumerate()
        .flat_map(move |(index, seed)| {
            design
                .settings
                .values()
                .enumerate()
                .map(move |(setting, spec)| {
                    let spec = spec.single(*seed);
                    Task {
                        setting,
                        seed: index,
                        sha256: spec.sha256(),
                        weight: spec.estimate(&calibration).wall_s,
                        spec,
                    }
                })
        })
}

/// Does one test after the other until there are none left.
fn work(tasks: &[Task], next: &AtomicUsize, switch: &StopSwitch, messages: &SyncSender<Message>) {
    while let Some((task, Task { spec, sha256, .. })) = {
        let index = next.fetch_add(1, Ordering::Relaxed);
        tasks.get(index).map(|task| (index, task))
    } {
        if switch.cause().is_some() {
            return;
        }
        let context = RunContext {
            threads: 1,
            interrupt: switch,
            checkpoint: None,
        };
        let mut relay = Relay { task, messages };
        let started_s = thread_processor_time_s();
        let ending = simulate(spec, context, &mut relay);
        let cpu_s = thread_processor_time_s() - started_s;
        let result = Box::new(ending.map(|ending| match ending {
            Ending::Finished(report) => Some(finished(spec, sha256, cpu_s, report)),
            Ending::Cancelled | Ending::Suspended => None,
        }));
        if messages.send(Message::Ended { task, result }).is_err() {
            return;
        }
    }
}

fn finished(spec: &JobSpec, sha256: &str, cpu_s: f64, report: Report) -> Finished {
    let results = report.summary.into_iter();
    let results = results.filter(|(name, _)| spec.compares(name));
    Finished {
        spec_sha256: sha256.to_owned(),
        engine_commit: ENGINE_COMMIT.to_owned(),
        cpu_s,
        is_good: report.quality.values().all(|check| check.ok),
        results: results
            .map(|(name, quantity)| (name, (quantity.value, quantity.unit)))
            .collect(),
    }
}

/// A recorder that only tells how far a test is.
struct Relay<'a> {
    task: usize,
    messages: &'a SyncSender<Message>,
}

impl Recorder for Relay<'_> {
    fn columns(&mut self, _: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _: &[f64]) -> io::Result<()> {
        Ok(())
    }

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

    fn log(&mut self, _: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _: &[u8]) -> io::Result<()> {
        Ok(())
    }
}

/// How far the study is.
struct Bar<'a> {
    tests: usize,
    tasks: &'a [Task],
    fractions: Vec<f64>,
    finished: usize,
    begun: Instant,
    to_go: TimeToGo,
}

impl<'a> Bar<'a> {
    fn new(tests: usize, tasks: &'a [Task]) -> Self {
        Self {
            tests,
            tasks,
            fractions: vec![0.0; tasks.len()],
            finished: tests - tasks.len(),
            begun: Instant::now(),
            to_go: TimeToGo::default(),
        }
    }

    fn finish(&mut self, task: usize) {
        self.fractions[task] = 1.0;
        self.finished += 1;
    }

    fn progress(&mut self) -> Progress {
        let all: f64 = self.tasks.iter().map(|task| task.weight).sum();
        let done = self.tasks.iter().zip(&self.fractions);
        let done: f64 = done.map(|(task, fraction)| task.weight * fraction).sum();
        let fraction = if all > 0.0 { done / all } else { 1.0 };
        Progress {
            fraction,
            phase: format!("{} of {} tests finished", self.finished, self.tests),
            eta_s: self.to_go.update(self.begun.elapsed(), fraction),
        }
    }
}
