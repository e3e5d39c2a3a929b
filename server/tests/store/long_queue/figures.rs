//! How long lists, searches, claims and heartbeats take, of a thousand jobs and of a million.
use std::time::{Duration, Instant};

use loadframe_api::{JobKind, JobOutcome, JobStatus, Timestamp};
use loadframe_server::store::JobFilter;
use uuid::Uuid;

use super::all;
use super::filling::fill_in_bulk;
use crate::lab::{LONG, Lab, group, key, submission, worker};

/// Prints the median, the 95th percentile and the longest of many tries.
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
pub(super) async fn measure(what: &str, tries: usize, mut work: impl AsyncFnMut()) -> Duration {
    let mut times = Vec::with_capacity(tries);
    for _ in 0..tries {
        let start = Instant::now();
        work().await;
        times.push(start.elapsed());
    }
    times.sort();
    let quantile = |part: f64| times[((times.len() - 1) as f64 * part).round() as usize];
    let p95 = quantile(0.95);
    eprintln!(
        "  {what:<34} median {:>10.2?}  p95 {p95:>10.2?}  longest {:>10.2?}",
        quantile(0.5),
        quantile(1.0)
    );
    p95
}

/// `cargo test --release -p loadframe-server --test store a_million -- --ignored --nocapture`
#[tokio::test(flavor = "multi_thread")]
#[ignore = "takes minutes; prints figures"]
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
async fn a_million_jobs_are_listed_searched_and_claimed_as_fast_as_a_thousand() {
    const TRIES: usize = 100;
    /// What reliability.md holds of a page of a list.
    const LONGEST: Duration = Duration::from_millis(100);
    // of a thousand: on a machine that has other work, all takes as long as it takes
    let mut few = Vec::new();
    let mut slow = Vec::new();
    let mut claims = Vec::new();
    for count in [1_000, 100_000, 1_000_000] {
        let lab = Lab::open(LONG).await;
        let start = Instant::now();
        fill_in_bulk(&lab, count, &[]).await;
        eprintln!("{count} jobs, filled in {:.1?}", start.elapsed());
        let q = |text: &str| JobFilter {
            q: Some(text.to_owned()),
            ..all()
        };
        let filters = [
            ("200 of all", all()),
            (
                "200 queued",
                JobFilter {
                    status: Some(JobStatus::Queued),
                    ..all()
                },
            ),
            (
                "running, of which there are few",
                JobFilter {
                    status: Some(JobStatus::Running),
                    ..all()
                },
            ),
            (
                "succeeded paper",
                JobFilter {
                    kind: Some(JobKind::PaperTensile),
                    outcome: Some(JobOutcome::Succeeded),
                    ..all()
                },
            ),
            (
                "a tag of many",
                JobFilter {
                    tag: Some("wet".to_owned()),
                    ..all()
                },
            ),
            ("a text of all", q("sample")),
            ("a text of one", q("Sample 777 of series 0")),
            ("a text of none", q("no such text")),
            (
                "running with a text of all",
                JobFilter {
                    status: Some(JobStatus::Running),
                    ..q("sample")
                },
            ),
            ("two characters of all", q("sa")),
        ];
        for (index, (what, filter)) in filters.iter().enumerate() {
            let page = async || drop(lab.jobs(filter, None, 200).await.unwrap());
            let p95 = measure(what, TRIES, page).await;
            if count == 1_000 {
                few.push(p95);
            }
            if p95 > LONGEST.max(3 * few[index]) {
                slow.push(format!("{what} of {count}: {p95:?}"));
            }
        }
        let early = Some(Timestamp(1_700_000_000_100));
        let old = JobFilter {
            created_before: early,
            ..all()
        };
        measure("before an early moment", TRIES, async || {
            drop(lab.jobs(&old, None, 200).await.unwrap());
        })
        .await;
        measure("two characters of none", 5, async || {
            drop(lab.jobs(&q("zq"), None, 200).await.unwrap());
        })
        .await;
        let twenty = async || {
            let lists = (0..20).map(|_| {
                let store = lab.store.clone();
                tokio::spawn(async move { drop(store.jobs(&all(), None, 200).await.unwrap()) })
            });
            for list in lists.collect::<Vec<_>>() {
                list.await.unwrap();
            }
        };
        measure("twenty lists of 200 at once", 20, twenty).await;
        measure("counts", TRIES, async || {
            assert!(lab.counts().await.unwrap().queued > 0);
        })
        .await;
        let mut number = 0;
        let claim = async || {
            number += 1;
            let mut worker = worker(&number.to_string());
            worker.worker_id = Uuid::new_v4();
            drop(lab.claim(&worker).await.unwrap().unwrap());
        };
        claims.push(measure("claim", TRIES, claim).await);
        let mut last = worker("last");
        last.worker_id = Uuid::new_v4();
        let lease = lab.claim(&last).await.unwrap().unwrap();
        measure("heartbeat", TRIES, async || {
            lab.heartbeat(key(&lease)).await.unwrap();
        })
        .await;
        // and while lists are asked for without a pause
        let readers: Vec<_> = (0..4)
            .map(|_| {
                let store = lab.store.clone();
                tokio::spawn(async move {
                    loop {
                        drop(store.jobs(&all(), None, 200).await.unwrap());
                    }
                })
            })
            .collect();
        measure("heartbeat beside lists", TRIES, async || {
            lab.heartbeat(key(&lease)).await.unwrap();
        })
        .await;
        measure("a write that changes nothing", TRIES, async || {
            lab.try_write().await.unwrap();
        })
        .await;
        readers.iter().for_each(tokio::task::JoinHandle::abort);
    }
    assert!(slow.is_empty(), "{slow:#?}");
    assert!(claims[2] < LONGEST.max(3 * claims[0]), "{claims:?}");
}

/// Medians of submitting, claiming and listing with a thousand jobs and a million, by one person's server and by
/// that of ten people, in turns.
///
/// `cargo test -p loadframe-server --test store ten_people -- --ignored --nocapture`
#[tokio::test(flavor = "multi_thread")]
#[ignore = "takes minutes; prints figures"]
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
async fn ten_people_submit_claim_and_list_nearly_as_fast_as_one() {
    const ROUNDS: usize = 200;
    for count in [1_000, 1_000_000] {
        let sole = Lab::open(LONG).await;
        fill_in_bulk(&sole, count, &[]).await;
        let shared = Lab::open(LONG).await;
        let names = ["A", "B", "C", "D", "E", "F", "G", "H", "I", "J"];
        let people = group(&shared, names).await;
        let ids: Vec<Uuid> = people.iter().map(|(id, _)| *id).collect();
        fill_in_bulk(&shared, count, &ids).await;
        let mut times: [[Vec<Duration>; 2]; 3] = Default::default();
        for round in 0..ROUNDS {
            let forms = [(&sole, &sole.store), (&shared, &people[round % 10].1)];
            for (form, (lab, store)) in forms.into_iter().enumerate() {
                let job = submission("new", 0);
                let start = Instant::now();
                store.enqueue(&job, None).await.unwrap();
                times[0][form].push(start.elapsed());
                let worker = worker(&round.to_string());
                let start = Instant::now();
                lab.claim(&worker).await.unwrap().expect("a job");
                times[1][form].push(start.elapsed());
                let start = Instant::now();
                drop(store.jobs(&all(), None, 200).await.unwrap());
                times[2][form].push(start.elapsed());
            }
        }
        for (what, mut forms) in ["submit", "claim", "list of 200"].into_iter().zip(times) {
            forms.iter_mut().for_each(|times| times.sort());
            let at = |form: usize, part: usize| forms[form][ROUNDS * part / 100];
            eprintln!(
                "  {count} jobs, {what:<12} one: median {:.2?} p95 {:.2?}; ten: median {:.2?} p95 {:.2?}",
                at(0, 50),
                at(0, 95),
                at(1, 50),
                at(1, 95)
            );
        }
    }
}
