//! Planned stops: SIGTERM and pause leave a checkpoint, cost no attempt, and the job goes on
//! elsewhere to the same bytes.
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, JobView, ReasonCode};
use loadframe_tests::{
    Chance, Cut, JobFiles, LONG, Relay, Server, Worker, is_sound, run_alone, until, with_seed,
};
use nix::sys::signal::Signal;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};
use uuid::Uuid;

/// More stops than a job may lose workers, so that a stop counted as a loss would show.
const STOPS: usize = 5;

struct Scene {
    server: Server,
    alone: JobFiles,
    /// How long the job takes undisturbed.
    duration: Duration,
    chance: Chance,
    id: Uuid,
}

impl Scene {
    fn new(test: &str) -> Self {
        let server = Server::start();
        let body = with_seed(LONG, 1);
        let begin = Instant::now();
        let alone = run_alone(&body, 1, &server.folder().join("alone"));
        let duration = begin.elapsed();
        let id = server.client.submit(&body);
        Self {
            server,
            alone,
            duration,
            chance: Chance::new(test),
            id,
        }
    }

    /// Waits until the attempt `number` computes, and a little longer.
    fn computes(&mut self, number: usize) {
        until("the job computes", || {
            let job = self.server.client.job(self.id);
            assert_ne!(job.status, JobStatus::Finished, "done too early: {job:#?}");
            let is_running = job.status == JobStatus::Running && job.attempts.len() == number;
            (is_running && job.progress > 0.0).then_some(())
        });
        let share = u32::try_from(2 * STOPS).unwrap();
        std::thread::sleep(self.chance.duration(self.duration / share));
    }

    fn reaches(&self, status: JobStatus) -> JobView {
        until("the job is in the expected state", || {
            let job = self.server.client.job(self.id);
            let is_over = job.status == JobStatus::Finished && status != JobStatus::Finished;
            assert!(!is_over, "done before it was {status:?}: {job:#?}");
            (job.status == status).then_some(job)
        })
    }

    /// Lets the job finish and checks its end: `stops` ends of one sort, then success.
    fn finishes(&self, stops: AttemptEnd) {
        let job = self.reaches(JobStatus::Finished);
        is_sound(&job);
        assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
        let ends: Vec<_> = job
            .attempts
            .iter()
            .filter_map(|attempt| attempt.end_reason)
            .collect();
        let mut expected = vec![stops; STOPS];
        expected.push(AttemptEnd::Completed);
        assert_eq!(ends, expected);
        assert_eq!(
            JobFiles::on_server(&self.server.client, self.id),
            self.alone
        );
    }
}

#[test]
fn sigterm_hands_the_job_on_and_costs_no_attempt() {
    let mut scene = Scene::new("SIGTERM");
    let resumed = Arc::new(AtomicU64::new(0));
    let relay = {
        let resumed = Arc::clone(&resumed);
        Relay::start(&scene.server.url, move |seen| {
            let is_resume =
                seen.request.starts_with("GET") && seen.request.ends_with("/checkpoint");
            if is_resume && seen.status == Some(200) {
                resumed.fetch_add(1, Relaxed);
            }
            Cut::Pass
        })
    };
    for stop in 1..=STOPS {
        let mut worker =
            Worker::start_through(&scene.server, &relay.url, &format!("worker-{stop}"));
        // a job keeps its progress between attempts: this one goes on once it has what the last one left
        until("the worker has the checkpoint", || {
            (resumed.load(Relaxed) + 1 >= stop as u64).then_some(())
        });
        scene.computes(stop);
        worker.process.signal(Signal::SIGTERM);
        let status = until("the worker has ended", || worker.process.ended());
        assert!(status.success(), "a planned stop is no failure: {status}");
        let job = scene.server.client.job(scene.id);
        assert_eq!(
            (job.status, job.reason_code),
            (JobStatus::Queued, ReasonCode::WorkerReleased),
            "{job:#?}"
        );
    }
    let _worker = Worker::start_through(&scene.server, &relay.url, "last");
    scene.finishes(AttemptEnd::Released);
    assert_eq!(
        resumed.load(Relaxed),
        STOPS as u64,
        "attempts began anew instead of going on"
    );
}

#[test]
fn pause_and_resume_lead_to_the_same_bytes() {
    let mut scene = Scene::new("pause");
    let _worker = Worker::start(&scene.server, "worker");
    for stop in 1..=STOPS {
        scene.computes(stop);
        let answer = scene.server.client.ask(scene.id, "pause");
        assert!(matches!(answer.status, 200 | 202), "{answer}");
        let job = scene.reaches(JobStatus::Paused);
        assert_eq!(job.reason_code, ReasonCode::PausedByUser, "{job:#?}");
        let answer = scene.server.client.ask(scene.id, "resume");
        assert!(matches!(answer.status, 200 | 202), "{answer}");
    }
    scene.finishes(AttemptEnd::Paused);
}

#[test]
fn a_server_stopped_by_plan_forgets_nothing() {
    let mut scene = Scene::new("server SIGTERM");
    let _worker = Worker::start(&scene.server, "worker");
    scene.computes(1);
    scene.server.process.signal(Signal::SIGTERM);
    let process = &mut scene.server.process;
    let status = until("the server has ended", || process.ended());
    assert!(status.success(), "a planned stop is no failure: {status}");
    scene.server.restart();
    scene.server.wait_until_ready();
    let job = scene.reaches(JobStatus::Finished);
    is_sound(&job);
    assert_eq!(
        job.attempts.len(),
        1,
        "the worker went on by itself: {job:#?}"
    );
    assert_eq!(
        JobFiles::on_server(&scene.server.client, scene.id),
        scene.alone
    );
}
