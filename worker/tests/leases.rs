//! A worker against the real server, both in this process.
use std::path::Path;
use std::time::{Duration, Instant};

use loadframe_api::{
    AttemptEnd, JobKind, JobOutcome, JobStatus, JobView, LogLine, Page, ReasonCode,
};
use loadframe_client::ServerClient;
use loadframe_run::{DirectoryEnd, DirectoryOptions, Engine, StopSwitch, run_to_directory};
use loadframe_server::{ServeConfig, serve};
use loadframe_worker::{Worker, WorkerEnd, WorkerOptions};
use reqwest::{Method, header};
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// A condition that has not come true after this long never will.
const NEVER: Duration = Duration::from_secs(120);
/// What users are promised: a cancelled job's worker is free again within this.
const CANCEL_PROMISE: Duration = Duration::from_secs(2);

const ENGINE: Engine = Engine {
    version: loadframe_server::VERSION,
    commit: loadframe_server::COMMIT,
};

/// A server with its data in a temporary folder, on a thread of its own.
struct Lab {
    client: ServerClient,
    folder: TempDir,
    stop: CancellationToken,
}

impl Lab {
    async fn open() -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let config = ServeConfig {
            listen: "127.0.0.1:0".to_owned(),
            ..ServeConfig::new(folder.path().join("data"))
        };
        let stop = CancellationToken::new();
        let (ready, is_ready) = tokio::sync::oneshot::channel();
        let until = stop.clone();
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Runtime::new().expect("a runtime");
            let tell = |address| ready.send(address).expect("the test waits");
            let serving = serve(config, tell, until.cancelled_owned());
            runtime.block_on(serving).expect("a server without errors");
        });
        let address = is_ready.await.expect("a server that starts");
        let client = ServerClient::new(&format!("http://{address}"), None);
        Self {
            client: client.expect("an address"),
            folder,
            stop,
        }
    }

    async fn post(&self, path: &str, body: &Value) -> JobView {
        let request = self.client.request(Method::POST, path).json(body);
        self.client.json(request).await.expect("accepted")
    }

    async fn job(&self, job: &JobView) -> JobView {
        let request = self.client.request(Method::GET, &job.links.this);
        self.client.json(request).await.expect("a job")
    }

    async fn ask(&self, job: &JobView, action: &str) -> JobView {
        self.post(&format!("{}/{action}", job.links.this), &json!({}))
            .await
    }

    /// Waits until the job is as `is` says.
    async fn until(&self, job: &JobView, is: impl Fn(&JobView) -> bool) -> JobView {
        let begin = Instant::now();
        loop {
            let now = self.job(job).await;
            if is(&now) {
                return now;
            }
            assert!(begin.elapsed() < NEVER, "{now:#?}");
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    async fn computes(&self, job: &JobView) {
        let is = |job: &JobView| job.status == JobStatus::Running && job.progress > 0.05;
        self.until(job, is).await;
    }

    fn worker(&self) -> (CancellationToken, JoinHandle<WorkerEnd>) {
        self.worker_ending(None, None)
    }

    fn worker_ending(
        &self,
        exit_when_idle: Option<Duration>,
        max_runtime: Option<Duration>,
    ) -> (CancellationToken, JoinHandle<WorkerEnd>) {
        let options = WorkerOptions {
            engine: ENGINE,
            server: self.client.clone(),
            heartbeat_server: self.client.clone(),
            name: "test".to_owned(),
            threads: 1,
            scratch: self.folder.path().join("scratch"),
            checkpoint_every: Duration::from_millis(200),
            exit_when_idle,
            max_runtime,
            server_away: NEVER,
            memory_mb: None,
        };
        let worker = Worker::prepare(options).expect("a scratch folder");
        let shutdown = worker.shutdown();
        let work = async { worker.work().await.expect("a server that takes it") };
        (shutdown, tokio::spawn(work))
    }

    /// The last attempt must have begun where the one before it ended.
    async fn went_on_from_a_checkpoint(&self, job: &JobView) {
        let request = self.client.request(Method::GET, &job.links.log);
        let log: Page<LogLine> = self.client.json(request).await.expect("a log");
        let says_so = |line: &LogLine| {
            line.attempt == job.attempt && line.message.starts_with("going on from the checkpoint")
        };
        assert!(job.attempt == 2 && log.items.iter().any(says_so), "{log:?}");
    }

    /// Every file of the job must be, byte for byte, what a run without a server writes.
    async fn has_files_of_undisturbed_run(&self, job: &JobView, spec: &Value) {
        let alone = self.folder.path().join("alone");
        run_alone(spec, &alone);
        for entry in alone_files(&alone) {
            let path = format!("{}/{entry}", job.links.files);
            let request = self.client.request(Method::GET, &path);
            let answer = self.client.send(request).await.expect("a file");
            let bytes = answer.bytes().await.expect("the whole file");
            let mine = std::fs::read(alone.join(&entry)).expect("a file");
            if entry == "outcome.json" {
                assert_eq!(timeless(&bytes), timeless(&mine));
            } else {
                assert!(bytes == mine, "{entry} differs");
            }
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        self.stop.cancel();
    }
}

/// The quick example, with a curve long enough to look at.
fn job() -> Value {
    let body = JobKind::NonwovenTensile.examples()[1].body;
    let mut body: Value = serde_json::from_str(body).expect("an example");
    body["spec"]["test"]["strain_step"] = json!(0.002);
    body["spec"]["output"] = json!({"snapshot_every_steps": 50});
    body
}

/// A job of several seconds: what is asked of it while it computes reaches it with a heartbeat, so
/// several of these must fit in.
fn long_job() -> Value {
    let mut body = job();
    let lattice = &mut body["spec"]["fabric"]["lattice"];
    lattice["points_per_row"] = json!(31);
    lattice["rows"] = json!(35);
    body["spec"]["test"]["strain_step"] = json!(0.000_25);
    body["spec"]["output"] = json!({"snapshot_every_steps": 400});
    body
}

fn run_alone(body: &Value, folder: &Path) {
    let submission = loadframe_api::Submission::from_slice(body.to_string().as_bytes());
    let options = DirectoryOptions {
        engine: ENGINE,
        threads: 1,
        checkpoint_every: NEVER,
        switch: &StopSwitch::default(),
    };
    let spec = submission.expect("a valid job").spec;
    let end = run_to_directory(&spec, folder, options, &mut |_| {});
    assert!(matches!(end, Ok(DirectoryEnd::Finished(_))), "{end:?}");
}

fn alone_files(folder: &Path) -> Vec<String> {
    let outcome = std::fs::read(folder.join("outcome.json")).expect("an outcome");
    let outcome: loadframe_api::Outcome = serde_json::from_slice(&outcome).expect("JSON");
    let names = outcome.files.into_iter().map(|entry| entry.name);
    names.chain(["outcome.json".to_owned()]).collect()
}

/// An outcome without what depends on the machine and the hour.
fn timeless(outcome: &[u8]) -> Value {
    let mut outcome: Value = serde_json::from_slice(outcome).expect("JSON");
    for part in ["cost", "provenance"] {
        outcome[part] = Value::Null;
    }
    outcome
}

fn has_ended(job: &JobView) -> bool {
    job.status == JobStatus::Finished
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_claimed_carried_out_and_completed() {
    let lab = Lab::open().await;
    let spec = job();
    let submitted = lab.post("/v1/jobs", &spec).await;
    let (shutdown, worker) = lab.worker();
    let finished = lab.until(&submitted, has_ended).await;
    assert_eq!(
        finished.outcome,
        Some(JobOutcome::Succeeded),
        "{}",
        finished.reason
    );
    assert_eq!(finished.attempt, 1);
    lab.has_files_of_undisturbed_run(&finished, &spec).await;
    let request = lab.client.request(Method::GET, &finished.links.curve);
    let request = request.header(header::ACCEPT, "application/json");
    let curve: loadframe_api::CurveView = lab.client.json(request).await.expect("a curve");
    assert!(
        curve.complete && curve.points.len() > 100,
        "{}",
        curve.points.len()
    );
    shutdown.cancel();
    assert_eq!(worker.await.expect("no panic"), WorkerEnd::Stopped);
}

/// In a batch script that is run again when its worker's time was over.
#[tokio::test(flavor = "multi_thread")]
async fn one_without_a_job_in_all_its_time_is_idle_where_it_may_end() {
    let lab = Lab::open().await;
    let time = Some(Duration::from_millis(600));
    for (idle, end) in [(None, WorkerEnd::TimeOver), (Some(NEVER), WorkerEnd::Idle)] {
        let (_shutdown, worker) = lab.worker_ending(idle, time);
        assert_eq!(worker.await.expect("it works"), end, "{idle:?}");
    }
    // one that had a job may find more when it is run again
    let job = lab.post("/v1/jobs", &job()).await;
    let time = Some(Duration::from_secs(15));
    let (_shutdown, worker) = lab.worker_ending(Some(NEVER), time);
    lab.until(&job, has_ended).await;
    assert_eq!(worker.await.expect("it works"), WorkerEnd::TimeOver);
}

#[tokio::test(flavor = "multi_thread")]
async fn cancelling_frees_the_worker() {
    let lab = Lab::open().await;
    let first = lab.post("/v1/jobs", &long_job()).await;
    let second = lab.post("/v1/jobs", &long_job()).await;
    let (_shutdown, _worker) = lab.worker();
    lab.computes(&first).await;
    lab.ask(&first, "cancel").await;
    let asked = Instant::now();
    let cancelled = lab.until(&first, has_ended).await;
    lab.until(&second, |job| job.status == JobStatus::Running)
        .await;
    // a promise to users, not a measurement: it includes two polls of this test
    assert!(asked.elapsed() < CANCEL_PROMISE, "{:?}", asked.elapsed());
    assert_eq!(cancelled.outcome, Some(JobOutcome::Cancelled));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stopped_worker_hands_its_job_to_the_next() {
    let lab = Lab::open().await;
    let spec = long_job();
    let submitted = lab.post("/v1/jobs", &spec).await;
    let (shutdown, worker) = lab.worker();
    lab.computes(&submitted).await;
    shutdown.cancel();
    assert_eq!(worker.await.expect("no panic"), WorkerEnd::Stopped);
    let released = lab.job(&submitted).await;
    assert_eq!(released.status, JobStatus::Queued);
    assert_eq!(released.reason_code, ReasonCode::WorkerReleased);
    assert_eq!(released.attempts[0].end_reason, Some(AttemptEnd::Released));
    let (_shutdown, _worker) = lab.worker();
    let finished = lab.until(&submitted, has_ended).await;
    assert_eq!(
        finished.outcome,
        Some(JobOutcome::Succeeded),
        "{}",
        finished.reason
    );
    lab.went_on_from_a_checkpoint(&finished).await;
    lab.has_files_of_undisturbed_run(&finished, &spec).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_paused_job_goes_on_to_the_same_bytes() {
    let lab = Lab::open().await;
    let spec = long_job();
    let submitted = lab.post("/v1/jobs", &spec).await;
    let (_shutdown, _worker) = lab.worker();
    lab.computes(&submitted).await;
    lab.ask(&submitted, "pause").await;
    let paused = lab
        .until(&submitted, |job| job.status != JobStatus::Running)
        .await;
    assert_eq!(paused.status, JobStatus::Paused, "{}", paused.reason);
    lab.ask(&submitted, "resume").await;
    let finished = lab.until(&submitted, has_ended).await;
    assert_eq!(
        finished.outcome,
        Some(JobOutcome::Succeeded),
        "{}",
        finished.reason
    );
    lab.went_on_from_a_checkpoint(&finished).await;
    lab.has_files_of_undisturbed_run(&finished, &spec).await;
}
