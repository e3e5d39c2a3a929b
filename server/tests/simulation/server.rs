//! The server: the real store, started and killed, and what it is asked.
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;

use loadframe_api::worker::{
    CheckpointQuery, ClaimRequest, Command, CompleteRequest, FailRequest, FaultRequest, Lease,
    ProgressReport, ReleaseReason,
};
use loadframe_api::{FileEntry, JobView, Submission, Timestamp, sha256_hex};
use loadframe_server::store::{
    Clock, IdempotencyKey, LeaseKey, Store, StoreError, StoreOptions, UserAction,
};
use uuid::Uuid;

/// How long a silent worker keeps its job.
pub(crate) const LEASE: Duration = Duration::from_secs(30);

/// What the server is asked.
#[derive(Clone)]
pub(crate) enum Request {
    Claim(ClaimRequest),
    /// Under a lease.
    Leased(Arc<Lease>, Leased),
    Submit {
        name: String,
        seed: u64,
    },
    Ask {
        job: Uuid,
        action: UserAction,
    },
}

/// What a worker sends under its lease.
#[derive(Clone)]
pub(crate) enum Leased {
    Heartbeat,
    Report(Arc<ProgressReport>),
    Upload(String, Arc<Vec<u8>>),
    Save(Arc<Vec<u8>>, f64),
    Fetch,
    Complete(Arc<CompleteRequest>),
    Fail(FailRequest),
    Fault(FaultRequest),
    Release(ReleaseReason),
    ExceedEstimate,
}

/// What it answers.
#[derive(Clone)]
pub(crate) enum Answer {
    Claimed(Option<Arc<Lease>>),
    Command(Command),
    Done,
    /// The bytes of a checkpoint and the files that came with it, if there is one.
    Checkpoint(Option<(Arc<Vec<u8>>, Vec<FileEntry>)>),
    LeaseLost,
    Job(Box<JobView>),
    /// The state of the job does not allow it.
    Conflict,
}

pub(crate) struct Server {
    /// Nothing while it is down.
    store: Option<Store>,
    options: StoreOptions,
    clock: Arc<AtomicI64>,
    /// When the sweeper's last step ended, by the clock.
    swept: Timestamp,
}

impl Server {
    pub(crate) fn new(folder: &Path) -> Self {
        let clock = Arc::<AtomicI64>::default();
        Self {
            store: None,
            options: StoreOptions {
                lease: LEASE,
                clock: Clock::Told(Arc::clone(&clock)),
                database: crate::database::place(folder),
                ..StoreOptions::new(folder)
            },
            clock,
            swept: Timestamp(0),
        }
    }

    pub(crate) fn set_clock(&self, millis: i64) {
        self.clock.store(millis, Ordering::SeqCst);
    }

    pub(crate) async fn start(&mut self) {
        // tasks of the server that was killed live on in this process, where killing it would have ended them
        let mut store = Store::open(self.options.clone()).await;
        for _ in 0..10_000 {
            if !matches!(store, Err(StoreError::InUse(_))) {
                break;
            }
            tokio::time::sleep(Duration::from_millis(1)).await;
            store = Store::open(self.options.clone()).await;
        }
        self.store = Some(store.expect("a store that was closed opens again"));
        self.swept = self.options.clock.now();
    }

    /// What was not committed is gone, and whatever was only remembered.
    pub(crate) fn kill(&mut self) {
        self.store = None;
    }

    pub(crate) fn store(&self) -> Option<&Store> {
        self.store.as_ref()
    }

    pub(crate) async fn sweep(&mut self) {
        if let Some(store) = &self.store {
            store.sweep_since(self.swept).await.unwrap();
            self.swept = self.options.clock.now();
        }
    }

    /// The answer; what none is expected of is a failure of the test.
    pub(crate) async fn serve(&self, request: Request) -> Answer {
        let store = self.store.as_ref().expect("a server that is up");
        let answer = match request {
            Request::Claim(request) => store
                .claim(&request)
                .await
                .map(|lease| Answer::Claimed(lease.map(Arc::new))),
            Request::Leased(lease, message) => leased(store, &lease, message).await,
            Request::Submit { name, seed } => {
                let body = submission(&name, seed);
                let key = IdempotencyKey {
                    key: name,
                    body_sha256: sha256_hex(&body),
                };
                let submission = Submission::from_slice(&body).unwrap();
                let enqueued = store.enqueue(&submission, Some(key)).await;
                enqueued.map(|enqueued| Answer::Job(Box::new(enqueued.job)))
            }
            Request::Ask { job, action } => {
                let view = store.request(job, action).await;
                view.map(|view| Answer::Job(Box::new(view)))
            }
        };
        match answer {
            Ok(answer) => answer,
            Err(StoreError::LeaseLost) => Answer::LeaseLost,
            Err(StoreError::Conflict(_)) => Answer::Conflict,
            Err(error) => panic!("the store says {error}"),
        }
    }
}

async fn leased(store: &Store, lease: &Lease, message: Leased) -> Result<Answer, StoreError> {
    let key = LeaseKey {
        id: lease.id,
        token: lease.token,
    };
    let done = |()| Answer::Done;
    match message {
        Leased::Heartbeat => store.heartbeat(key).await.map(Answer::Command),
        Leased::Report(report) => store.report(key, &report).await.map(Answer::Command),
        Leased::Upload(name, bytes) => {
            let sha256 = sha256_hex(&bytes);
            let upload = store.upload(key, &name, &sha256, bytes.as_slice());
            upload.await.map(|_| Answer::Done)
        }
        Leased::Save(bytes, wall_s) => {
            let query = CheckpointQuery {
                sha256: sha256_hex(&bytes),
                wall_s,
                cpu_s: wall_s,
            };
            let saved = store.save_checkpoint(key, &query, bytes.as_slice()).await;
            saved.map(|_| Answer::Done)
        }
        Leased::Fetch => match store.checkpoint(key, None).await {
            Ok((info, path)) => {
                let state = Arc::new(std::fs::read(path.path().expect("a file")).unwrap());
                Ok(Answer::Checkpoint(Some((state, info.files))))
            }
            Err(StoreError::NotFound(_)) => Ok(Answer::Checkpoint(None)),
            Err(error) => Err(error),
        },
        Leased::Complete(result) => store.complete(key, &result).await.map(done),
        Leased::Fail(why) => store.fail(key, &why).await.map(done),
        Leased::Fault(why) => store.fault(key, &why).await.map(done),
        Leased::Release(reason) => store.release(key, reason).await.map(done),
        Leased::ExceedEstimate => store.exceed_estimate(key, "2 h of 1 h").await.map(done),
    }
}

/// The smallest example with a seed of its own.
fn submission(name: &str, seed: u64) -> Vec<u8> {
    let example = loadframe_api::JobKind::NonwovenTensile.examples()[2];
    let mut body: serde_json::Value = serde_json::from_str(example.body).unwrap();
    body["name"] = name.into();
    body["spec"]["seed"] = seed.into();
    body.to_string().into_bytes()
}
