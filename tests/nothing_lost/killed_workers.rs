//! Workers killed with -9: while they compute, while they upload, and between the last upload and
//! the end. Every job finishes exactly once with the bytes of an undisturbed run; three losses set
//! it aside.
use loadframe_api::{JobOutcome, JobStatus, JobView, ReasonCode};
use loadframe_tests::{
    Chance, Cut, JobFiles, Relay, SMALL, Seen, Server, Worker, is_sound, losses, run_alone, soak,
    until, with_seed,
};
use nix::sys::signal::Signal;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use uuid::Uuid;

/// Kills in each of the tests, when `LOADFRAME_SOAK` sets no time.
const KILLS: u64 = 20;
/// A job that has lost this many workers is spared: one more would set it aside.
const MOST_LOSSES: usize = 2;
/// Workers at a time.
const WORKERS: u64 = 2;
/// Jobs waiting at a time.
const QUEUED: usize = 3;
/// Sorts of jobs that differ in their seed, so that mixed-up results would show.
const SEEDS: std::ops::Range<u64> = 1..4;

/// A server with a stream of jobs whose results are known.
struct Campaign {
    server: Server,
    references: Vec<JobFiles>,
    /// How long a job takes undisturbed.
    duration: Duration,
    submitted: Mutex<Vec<(Uuid, usize)>>,
    hits: Hits,
    end: Option<Instant>,
}

/// Kills by the sort of moment they hit.
type Hits = Arc<[AtomicU64; 3]>;

impl Campaign {
    fn new() -> Self {
        let server = Server::start();
        let begin = Instant::now();
        let folder = |seed| server.folder().join(format!("alone-{seed}"));
        let alone = |seed| run_alone(&with_seed(SMALL, seed), 1, &folder(seed));
        let references: Vec<JobFiles> = SEEDS.map(alone).collect();
        let duration = begin.elapsed() / u32::try_from(references.len()).unwrap();
        Self {
            server,
            references,
            duration,
            submitted: Mutex::default(),
            hits: Arc::default(),
            end: soak().map(|duration| Instant::now() + duration),
        }
    }

    fn kills(&self) -> u64 {
        self.hits.iter().map(|hits| hits.load(Relaxed)).sum()
    }

    /// Whether to go on killing; submits jobs as long as there is.
    fn goes_on(&self) -> bool {
        let goes_on = match self.end {
            Some(end) => Instant::now() < end,
            None => self.kills() < KILLS,
        };
        let mut submitted = self.submitted.lock().unwrap();
        if goes_on && self.server.client.jobs("status=queued").len() < QUEUED {
            let sort = submitted.len() % self.references.len();
            let body = with_seed(SMALL, SEEDS.start + sort as u64);
            submitted.push((self.server.client.submit(&body), sort));
        }
        goes_on
    }

    /// Lets `strike` start and kill workers, a few at a time, until there were enough; then lets
    /// others finish, and checks every job.
    fn run(&self, test: &str, strike: impl Fn(&mut Chance, &str) + Sync) {
        let mut chance = Chance::new(test);
        std::thread::scope(|scope| {
            for place in 0..WORKERS {
                let (strike, mut chance) = (&strike, chance.split());
                scope.spawn(move || {
                    let mut starts = 0..;
                    while self.goes_on() {
                        let start = starts.next().unwrap_or_default();
                        strike(&mut chance, &format!("{place}-{start}"));
                    }
                });
            }
        });
        let _workers = ["last-0", "last-1"].map(|name| Worker::start(&self.server, name));
        let submitted = self.submitted.lock().unwrap();
        let mut lost = 0;
        for (id, sort) in &*submitted {
            let job = until("the job has finished", || {
                let job = self.server.client.job(*id);
                (job.status == JobStatus::Finished).then_some(job)
            });
            is_sound(&job);
            assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
            lost += losses(&job) as u64;
            let files = JobFiles::on_server(&self.server.client, *id);
            assert_eq!(files, self.references[*sort], "{job:#?}");
        }
        let (jobs, kills) = (submitted.len(), self.kills());
        eprintln!("{test}: {kills} kills over {jobs} jobs, {lost} of them cost an attempt");
        assert!(lost <= kills, "a living worker was called dead");
        // their files go with the jobs, those of lost attempts too
        for (id, _) in &*submitted {
            let path = format!("/v1/jobs/{id}?for_good=true");
            let answer = self.server.client.send("DELETE", &path, &[], b"").unwrap();
            assert_eq!(answer.status, 204, "{answer}");
        }
        let blobs = self.server.data().join("blobs");
        // the store's own name stays
        until("the files of deleted jobs are gone", || {
            (files_in(&blobs).0 == 1).then_some(())
        });
    }

    /// A worker that a relay kills at a moment that `is_now` chooses, by the number of bytes that
    /// still pass and the sort of the moment; returns when it is dead or not needed any more.
    fn kill_by_relay(
        &self,
        name: &str,
        mut is_now: impl FnMut(&Seen<'_>) -> Option<(u64, usize)> + Send + 'static,
    ) {
        let victim: Arc<Mutex<Option<Worker>>> = Arc::default();
        let is_dead = Arc::new(AtomicBool::new(false));
        let relay = {
            let (client, hits) = (self.server.client.clone(), Arc::clone(&self.hits));
            let (victim, is_dead) = (Arc::clone(&victim), Arc::clone(&is_dead));
            Relay::start(&self.server.url, move |seen| {
                if is_dead.load(Relaxed) {
                    return Cut::After(0);
                }
                let Some((bytes, sort)) = is_now(seen) else {
                    return Cut::Pass;
                };
                let mut victim = victim.lock().unwrap();
                match victim.as_mut() {
                    Some(worker) if !is_spared(worker.job(&client)) => worker.process.kill(),
                    _ => return Cut::Pass,
                }
                is_dead.store(true, Relaxed);
                hits[sort].fetch_add(1, Relaxed);
                Cut::After(bytes)
            })
        };
        *victim.lock().unwrap() = Some(Worker::start_through(&self.server, &relay.url, name));
        until("the worker is dead or not needed", || {
            (is_dead.load(Relaxed) || !self.goes_on()).then_some(())
        });
        let survivor = victim.lock().unwrap().take();
        if let Some(survivor) = survivor.filter(|_| !is_dead.load(Relaxed)) {
            survivor.retire();
        }
    }
}

/// One more loss would set the job aside.
fn is_spared(job: Option<JobView>) -> bool {
    job.is_some_and(|job| losses(&job) >= MOST_LOSSES)
}

/// Number and bytes of the files in a folder and those below.
fn files_in(folder: &Path) -> (usize, u64) {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let sizes = entries.map(|entry| match entry.metadata() {
        Ok(kind) if kind.is_dir() => files_in(&entry.path()),
        Ok(file) => (1, file.len()),
        // deleted meanwhile
        Err(_) => (0, 0),
    });
    sizes.fold((0, 0), |sum, next| (sum.0 + next.0, sum.1 + next.1))
}

#[test]
fn a_worker_may_die_at_any_moment() {
    let campaign = Campaign::new();
    let client = &campaign.server.client;
    campaign.run("killed at any moment", |chance, name| {
        let mut worker = Worker::start(&campaign.server, name);
        while campaign.goes_on() {
            until("the worker has a job", || {
                (worker.job(client).is_some() || !campaign.goes_on()).then_some(())
            });
            std::thread::sleep(chance.duration(campaign.duration));
            // frozen first, so that it cannot take up a job that must be spared
            worker.process.signal(Signal::SIGSTOP);
            let held = worker.job(client);
            if held.is_some() && !is_spared(held) {
                worker.process.kill();
                campaign.hits[0].fetch_add(1, Relaxed);
                return;
            }
            worker.process.signal(Signal::SIGCONT);
        }
        worker.retire();
    });
}

#[test]
fn a_worker_may_die_while_it_uploads() {
    let campaign = Campaign::new();
    let (_, volume) = files_in(&campaign.server.folder().join("alone-1"));
    campaign.run("killed in uploads", |chance, name| {
        let mut left = chance.number(0..volume);
        campaign.kill_by_relay(name, move |seen| {
            let is_upload = seen.request.starts_with("PUT") && seen.request.contains("/files/");
            if !is_upload || seen.status.is_some() {
                return None;
            }
            if left >= seen.bytes {
                left -= seen.bytes;
                return None;
            }
            Some((left, 0))
        });
    });
}

#[test]
fn a_worker_may_die_between_the_last_upload_and_the_end() {
    let campaign = Campaign::new();
    let starts = AtomicUsize::new(0);
    campaign.run("killed at the end", |chance, name| {
        // before the server hears of the end, in the middle of the message, or (more rarely, as no
        // attempt is lost then) after the server has answered but before the worker knows
        let moment = [0, 1, 2, 0, 1][starts.fetch_add(1, Relaxed) % 5];
        let mut chance = chance.split();
        campaign.kill_by_relay(name, move |seen| {
            let is_end = seen.request.starts_with("POST") && seen.request.ends_with("/complete");
            if !is_end || seen.status.is_some() != (moment == 2) {
                return None;
            }
            let passing = if moment == 1 {
                chance.number(1..seen.bytes)
            } else {
                0
            };
            Some((passing, moment))
        });
    });
    let hits = [0, 1, 2].map(|moment| campaign.hits[moment].load(Relaxed));
    eprintln!("killed at the end: {hits:?} before, within and after the last message");
    assert!(hits.iter().all(|hits| *hits > 0), "{hits:?}");
}

#[test]
fn three_losses_set_a_job_aside_until_somebody_asks_again() {
    let server = Server::start();
    let mut chance = Chance::new("quarantine");
    let id = server.client.submit(&with_seed(SMALL, 1));
    let (mut loss, mut unheard) = (0, 0);
    while loss < 3 {
        let mut worker = Worker::start(&server, &format!("victim-{loss}-{unheard}"));
        until("the worker has the job", || worker.job(&server.client));
        std::thread::sleep(chance.duration(Duration::from_millis(50)));
        worker.process.kill();
        let job = until("the loss is known", || {
            let job = server.client.job(id);
            (job.status != JobStatus::Running).then_some(job)
        });
        // a lease that was not used yet costs nothing
        if job.reason.contains("never heard of") {
            unheard += 1;
            continue;
        }
        loss += 1;
        assert_eq!(losses(&job), loss + unheard, "{job:#?}");
        if loss < 3 {
            assert_eq!(job.status, JobStatus::Queued);
            assert_eq!(job.reason_code, ReasonCode::WorkerLost);
        }
    }
    let job = server.client.job(id);
    is_sound(&job);
    assert_eq!(job.outcome, Some(JobOutcome::Quarantined), "{job:#?}");
    assert_eq!(job.reason_code, ReasonCode::TooManyLosses);
    // no worker is given it, though one is free
    let _worker = Worker::start(&server, "free");
    let other = server.client.submit(&with_seed(SMALL, 2));
    until("another job is done", || {
        (server.client.job(other).status == JobStatus::Finished).then_some(())
    });
    assert_eq!(server.client.job(id), job);
    let answer = server.client.ask(id, "retry");
    assert_eq!(answer.status, 200, "{answer}");
    until("the job is done after all", || {
        (server.client.job(id).outcome == Some(JobOutcome::Succeeded)).then_some(())
    });
}
