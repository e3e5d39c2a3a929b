//! A worker: claims, computes, reports, leaves checkpoints, ends its attempt, and obeys.
use std::sync::Arc;

use loadframe_api::worker::{
    ClaimRequest, Command, CompleteRequest, CurveBlock, FailCode, FailRequest, FaultCode,
    FaultRequest, Lease, ProgressReport, ReleaseReason,
};
use loadframe_api::{Cost, FileEntry, Outcome, OutcomeStatus, Provenance, Quantity, sha256_hex};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use uuid::Uuid;

use crate::server::{Answer, Leased, Request};

/// What a job comes to; all of it follows from its spec.
pub(crate) struct Truth {
    /// Points of its curve.
    pub(crate) points: u64,
    factor: u64,
    /// Whether its simulation fails at the end.
    pub(crate) fails: bool,
}

impl Truth {
    pub(crate) fn of(spec_sha256: &str) -> Self {
        let number = u64::from_str_radix(&spec_sha256[..6], 16).unwrap();
        Self {
            points: 6 + number % 13,
            factor: 1 + number % 97,
            fails: number.is_multiple_of(11),
        }
    }

    pub(crate) fn point(&self, index: u64) -> Vec<f64> {
        vec![index as f64, (index * self.factor) as f64]
    }
}

/// The file that tells which attempt made a result.
pub(crate) const RESULT: &str = "curve.csv";

pub(crate) fn result_of(lease: &Lease) -> Vec<u8> {
    format!("job {} attempt {}", lease.job_id, lease.attempt).into_bytes()
}

/// The job that a worker is at.
struct Task {
    lease: Arc<Lease>,
    truth: Truth,
    /// Points that are computed, and that the server has.
    done: u64,
    sent: u64,
    /// Lines of its log.
    lines: u64,
    files: Vec<FileEntry>,
    /// Whether it knows where to begin.
    is_begun: bool,
    /// What the server wants.
    command: Command,
    /// Whether everything up to `done` is in a checkpoint.
    is_saved: bool,
}

/// A worker process, and the machine under it.
pub(crate) struct Worker {
    name: String,
    id: Uuid,
    task: Option<Task>,
}

impl Worker {
    pub(crate) fn new(number: usize) -> Self {
        Self {
            name: format!("worker {number}"),
            id: Uuid::new_v4(),
            task: None,
        }
    }

    /// Another process on the machine, which knows nothing of the one before.
    pub(crate) fn start_again(&mut self) {
        self.id = Uuid::new_v4();
        self.task = None;
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.task.is_none()
    }

    /// A heartbeat, while it has a job.
    pub(crate) fn heartbeat(&self) -> Option<Request> {
        let task = self.task.as_ref()?;
        Some(Request::Leased(Arc::clone(&task.lease), Leased::Heartbeat))
    }

    /// What it sends next, if anything.
    pub(crate) fn next(&mut self, rng: &mut ChaCha8Rng, is_whole: bool) -> Option<Request> {
        let Some(task) = &mut self.task else {
            return Some(self.claim());
        };
        let message = if is_whole || rng.random_bool(0.97) {
            task.next(rng)?
        } else {
            match rng.random_range(0..3) {
                0 => Leased::Release(ReleaseReason::Shutdown),
                1 => Leased::ExceedEstimate,
                _ => Leased::Fault(FaultRequest {
                    code: FaultCode::Disk,
                    reason: "no scratch folder".to_owned(),
                }),
            }
        };
        Some(Request::Leased(Arc::clone(&task.lease), message))
    }

    fn claim(&self) -> Request {
        Request::Claim(ClaimRequest::new(self.id, &self.name, &self.name, "1"))
    }

    /// Takes in the answer to what it sent.
    pub(crate) fn hear(&mut self, request: &Request, answer: Answer) {
        match (request, answer) {
            (Request::Claim(_), Answer::Claimed(lease)) => self.task = lease.map(Task::new),
            (Request::Leased(lease, message), answer) => {
                let Some(task) = &mut self.task else { return };
                if task.lease.id != lease.id {
                    return;
                }
                if !task.hear(message, answer) {
                    self.task = None;
                }
            }
            _ => panic!("an answer to something else"),
        }
    }
}

impl Task {
    fn new(lease: Arc<Lease>) -> Self {
        Self {
            truth: Truth::of(&lease.spec_sha256),
            done: 0,
            sent: 0,
            lines: 0,
            files: Vec::new(),
            is_begun: lease.checkpoint.is_none(),
            command: Command::Continue,
            is_saved: false,
            lease,
        }
    }

    fn next(&mut self, rng: &mut ChaCha8Rng) -> Option<Leased> {
        if !self.is_begun {
            return Some(Leased::Fetch);
        }
        match self.command {
            Command::Cancel => return Some(Leased::Release(ReleaseReason::Cancelled)),
            Command::Pause if self.is_saved || self.done == 0 => {
                return Some(Leased::Release(ReleaseReason::Paused));
            }
            Command::Pause => return Some(self.save()),
            Command::Continue => {}
        }
        if self.done < self.truth.points {
            self.done = self.truth.points.min(self.done + rng.random_range(1..4));
            self.is_saved = false;
            return match rng.random_range(0..10) {
                0..5 => Some(self.report(rng)),
                // a name has one content, as the engines' have: a copy that is late must change nothing
                5 | 6 => Some(Leased::Upload(
                    format!("snapshot_{}.vtp", self.done),
                    Arc::new(
                        format!("{} after {}", self.lease.spec_sha256, self.done).into_bytes(),
                    ),
                )),
                7 | 8 => Some(self.save()),
                _ => None,
            };
        }
        if self.sent < self.truth.points {
            return Some(self.report(rng));
        }
        if self.truth.fails {
            return Some(Leased::Fail(FailRequest {
                code: FailCode::SimulationError,
                reason: "no equilibrium".to_owned(),
            }));
        }
        let has = |name: &str| self.files.iter().any(|file| file.name == name);
        if !has(RESULT) {
            return Some(Leased::Upload(
                RESULT.to_owned(),
                Arc::new(result_of(&self.lease)),
            ));
        }
        let result = self.result();
        if !has("outcome.json") {
            let text = serde_json::to_vec(&result.outcome).unwrap();
            return Some(Leased::Upload("outcome.json".to_owned(), Arc::new(text)));
        }
        Some(Leased::Complete(Arc::new(result)))
    }

    /// New points, and some that were sent before.
    fn report(&mut self, rng: &mut ChaCha8Rng) -> Leased {
        let first = self.sent.saturating_sub(rng.random_range(0..3));
        let rows = (first..self.done).map(|index| self.truth.point(index));
        let progress = self.done as f64 / self.truth.points as f64;
        Leased::Report(Arc::new(ProgressReport {
            progress,
            phase: "pulling".to_owned(),
            points: Some(CurveBlock {
                columns: vec!["step".to_owned(), "force_n".to_owned()],
                first,
                rows: rows.collect(),
            }),
            log: vec![format!("line {}", self.lines)],
            log_from: Some(self.lines),
            ..ProgressReport::default()
        }))
    }

    fn save(&self) -> Leased {
        let state = format!("{} {}", self.lease.spec_sha256, self.done);
        Leased::Save(Arc::new(state.into_bytes()), self.done as f64)
    }

    fn result(&self) -> CompleteRequest {
        let named = |file: &&FileEntry| file.name != "outcome.json";
        let force = Quantity::new(self.truth.factor as f64, "N", "largest force");
        let outcome = Outcome {
            kind: self.lease.kind,
            status: OutcomeStatus::Succeeded,
            stop_reason: "max_strain".to_owned(),
            summary: [("max_force".to_owned(), force)].into_iter().collect(),
            quality: indexmap::IndexMap::new(),
            cost: Cost::default(),
            provenance: Provenance {
                spec_sha256: self.lease.spec_sha256.clone(),
                engine_version: "1".to_owned(),
                engine_commit: "unknown".to_owned(),
                seed: 1,
                threads: 1,
                started_at: "2026-11-21T09:00:00Z".to_owned(),
                host: "lab".to_owned(),
            },
            warnings: Vec::new(),
            bodies: Vec::new(),
            files: self.files.iter().filter(named).cloned().collect(),
        };
        CompleteRequest {
            outcome,
            files: self.files.clone(),
        }
    }

    /// Whether it goes on with the job.
    fn hear(&mut self, message: &Leased, answer: Answer) -> bool {
        match (message, answer) {
            (_, Answer::LeaseLost) => return false,
            (Leased::Heartbeat, Answer::Command(command)) => self.command = command,
            (Leased::Report(report), Answer::Command(command)) => {
                self.command = command;
                let block = report.points.as_ref().unwrap();
                self.sent = self.sent.max(block.first + block.rows.len() as u64);
                self.lines += 1;
            }
            (Leased::Upload(name, bytes), Answer::Done) => {
                self.files.retain(|file| file.name != *name);
                self.files.push(FileEntry {
                    name: name.clone(),
                    bytes: bytes.len() as u64,
                    sha256: sha256_hex(bytes),
                });
            }
            (Leased::Save(..), Answer::Done) => self.is_saved = true,
            (Leased::Fetch, Answer::Checkpoint(found)) => {
                self.is_begun = true;
                if let Some((state, files)) = found {
                    let state = std::str::from_utf8(&state).unwrap();
                    let (spec, done) = state.split_once(' ').unwrap();
                    assert_eq!(spec, self.lease.spec_sha256, "a checkpoint of another spec");
                    self.done = done.parse().unwrap();
                    self.sent = self.lease.curve_points;
                    self.files = files;
                    // its own end is another
                    let is_end = |name: &str| name == RESULT || name == "outcome.json";
                    self.files.retain(|file| !is_end(&file.name));
                    assert!(self.sent <= self.done, "points from after the checkpoint");
                }
            }
            (
                Leased::Complete(_)
                | Leased::Fail(_)
                | Leased::Fault(_)
                | Leased::Release(_)
                | Leased::ExceedEstimate,
                Answer::Done,
            ) => return false,
            _ => panic!("an answer to something else"),
        }
        true
    }
}
