//! Queues longer than anybody submits by hand: filled in bulk, beside the open store.
use std::time::{Duration, Instant};

use loadframe_api::{JobKind, JobOutcome, JobStatus, Timestamp};
use loadframe_server::store::{JobEdit, JobFilter, UserAction};
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, query, query_as, query_scalar};
use uuid::Uuid;

use crate::lab::{LONG, Lab, key, worker};

/// The database beside the store.
async fn beside(lab: &Lab) -> SqliteConnection {
    let file = lab.folder.path().join("loadframe.db");
    let options = SqliteConnectOptions::new().filename(file);
    let options = options.busy_timeout(Duration::from_secs(60));
    options.foreign_keys(true).connect().await.unwrap()
}

/// Adds `count` jobs: one of ten has succeeded, one of fifty is urgent, one of five has tags; two kinds.
async fn fill(lab: &Lab, count: i64) -> SqliteConnection {
    let mut database = beside(lab).await;
    query("BEGIN IMMEDIATE")
        .execute(&mut database)
        .await
        .unwrap();
    query(
        "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < ?1)
         INSERT INTO jobs (id, kind, name, notes, tags, priority, spec_sha256, status, outcome,
                           reason_code, reason, created_at, updated_at)
         SELECT unhex(printf('%012x7%019x', 1700000000000 + i, i)),
                CASE i % 3 WHEN 0 THEN 'paper_tensile' ELSE 'nonwoven_tensile' END,
                printf('Sample %d of series %d', i, i / 1000),
                CASE i % 10 WHEN 0 THEN 'a note on what was Wet' ELSE '' END,
                CASE i % 5 WHEN 0 THEN json_array('wet', 'series-' || (i / 1000)) ELSE '[]' END,
                CASE i % 50 WHEN 0 THEN 5 ELSE 0 END, printf('%064d', i),
                CASE i % 10 WHEN 1 THEN 'finished' ELSE 'queued' END,
                CASE i % 10 WHEN 1 THEN 'succeeded' END,
                'submitted', 'waiting for a worker', 1700000000000 + i, 1700000000000 + i
         FROM n",
    )
    .bind(count)
    .execute(&mut database)
    .await
    .unwrap();
    for statement in [
        "INSERT INTO specs (job, json) SELECT seq, '{}' FROM jobs WHERE true ON CONFLICT DO NOTHING",
        "INSERT INTO events (job, type, at) SELECT id, 'job', created_at FROM jobs
         WHERE true ON CONFLICT DO NOTHING",
        "COMMIT",
    ] {
        query(statement).execute(&mut database).await.unwrap();
    }
    database
}

/// The same for very many, without triggers and with what these keep made at once.
async fn fill_in_bulk(lab: &Lab, count: i64) {
    let mut database = beside(lab).await;
    let triggers: Vec<(String, String)> = query_as(
        "SELECT name, sql FROM sqlite_master WHERE type = 'trigger' AND tbl_name = 'jobs'",
    )
    .fetch_all(&mut database)
    .await
    .unwrap();
    for (name, _) in &triggers {
        let drop = AssertSqlSafe(format!("DROP TRIGGER {name}"));
        query(drop).execute(&mut database).await.unwrap();
    }
    drop(fill(lab, count).await);
    for statement in [
        "INSERT INTO waiting_counts (bits, priority, block, jobs)
         SELECT bits, priority, seq >> bits, COUNT(*)
         FROM jobs, (SELECT 6 AS bits UNION SELECT 12 UNION SELECT 18)
         WHERE status = 'queued' GROUP BY 1, 2, 3",
        "INSERT INTO job_counts SELECT COALESCE(outcome, status), COUNT(*) FROM jobs GROUP BY 1",
        "INSERT INTO job_tags (tag, job) SELECT value, seq FROM jobs, json_each(jobs.tags)",
        "INSERT INTO job_texts (job_texts) VALUES ('rebuild')",
    ] {
        query(statement).execute(&mut database).await.unwrap();
    }
    for (_, sql) in triggers {
        query(AssertSqlSafe(sql))
            .execute(&mut database)
            .await
            .unwrap();
    }
}

fn all() -> JobFilter {
    JobFilter::default()
}

/// Names of the first `limit` jobs that pass.
async fn names(lab: &Lab, filter: JobFilter, limit: u32) -> Vec<String> {
    let page = lab.jobs(&filter, None, limit).await.unwrap();
    page.items.into_iter().map(|job| job.name).collect()
}

/// Checks what triggers keep against the jobs themselves.
async fn is_consistent(database: &mut SqliteConnection) {
    for (what, kept, counted) in [
        (
            "places",
            "SELECT bits || ' ' || priority || ' ' || block, jobs FROM waiting_counts ORDER BY 1",
            "SELECT bits || ' ' || priority || ' ' || (seq >> bits), COUNT(*)
             FROM jobs, (SELECT 6 AS bits UNION SELECT 12 UNION SELECT 18) WHERE status = 'queued'
             GROUP BY 1 ORDER BY 1",
        ),
        (
            "counts",
            "SELECT state, jobs FROM job_counts WHERE jobs <> 0 ORDER BY 1",
            "SELECT COALESCE(outcome, status), COUNT(*) FROM jobs GROUP BY 1 ORDER BY 1",
        ),
        (
            "tags",
            "SELECT tag, job FROM job_tags ORDER BY 1, 2",
            "SELECT DISTINCT value, seq FROM jobs, json_each(jobs.tags) ORDER BY 1, 2",
        ),
    ] {
        let kept: Vec<(String, i64)> = query_as(kept).fetch_all(&mut *database).await.unwrap();
        let counted: Vec<(String, i64)> =
            query_as(counted).fetch_all(&mut *database).await.unwrap();
        assert!(kept == counted, "{what}: {kept:?} are {counted:?}");
    }
    // holds every word against the table
    query("INSERT INTO job_texts (job_texts, rank) VALUES ('integrity-check', 1)")
        .execute(database)
        .await
        .unwrap();
}

#[tokio::test]
async fn places_in_the_queue_are_those_that_counting_gives() {
    let lab = Lab::open(LONG).await;
    // several of the smallest blocks; larger ones would take long to fill
    let mut database = fill(&lab, 1000).await;
    is_consistent(&mut database).await;
    let mut cursor = None;
    let mut seen = 0;
    loop {
        let page = lab.jobs(&all(), cursor.as_deref(), 300).await.unwrap();
        for job in &page.items {
            let counted: Option<i64> = query_scalar(
                "SELECT CASE j.status WHEN 'queued' THEN 1 + (SELECT COUNT(*) FROM jobs b
                    WHERE b.status = 'queued' AND (b.priority > j.priority
                       OR (b.priority = j.priority AND b.seq < j.seq))) END FROM jobs j WHERE id = ?",
            )
            .bind(job.id)
            .fetch_one(&mut database)
            .await
            .unwrap();
            assert_eq!(job.position, counted.map(i64::unsigned_abs), "{}", job.name);
            seen += 1;
        }
        cursor = page.next;
        if cursor.is_none() {
            break;
        }
    }
    assert_eq!(seen, 1000);
    // in the second of the largest blocks: a job far behind
    query("UPDATE sqlite_sequence SET seq = 300000 WHERE name = 'jobs'")
        .execute(&mut database)
        .await
        .unwrap();
    let late = lab.submit().await;
    assert_eq!(lab.view(late).await.position, Some(901));
}

#[tokio::test]
async fn what_triggers_keep_follows_every_step_of_a_job() {
    let lab = Lab::open(LONG).await;
    let mut database = fill(&lab, 100).await;
    let page = lab.jobs(&all(), None, 100).await.unwrap();
    let queued = page
        .items
        .iter()
        .filter(|job| job.status == JobStatus::Queued);
    let ids: Vec<Uuid> = queued.map(|job| job.id).collect();
    let edit = JobEdit {
        name: Some("Renamed: \"quoted\"".to_owned()),
        tags: Some(vec!["dry".to_owned(), "wet".to_owned(), "dry".to_owned()]),
        priority: Some(-3),
        ..JobEdit::default()
    };
    lab.edit(ids[0], edit).await.unwrap();
    for (id, action) in [
        (ids[1], UserAction::Cancel),
        (ids[2], UserAction::Pause),
        (ids[3], UserAction::Pause),
        (ids[3], UserAction::Resume),
        (ids[1], UserAction::Retry),
    ] {
        lab.request(id, action).await.unwrap();
        is_consistent(&mut database).await;
    }
    let lease = lab.submit().await;
    lab.delete(ids[4]).await.unwrap();
    lab.delete(lease).await.unwrap();
    let mut leases = Vec::new();
    for number in 0..3 {
        leases.push(lab.claim(&worker(&number.to_string())).await.unwrap());
    }
    is_consistent(&mut database).await;
    assert_eq!(
        names(
            &lab,
            JobFilter {
                q: Some("d: \"QUOTED".into()),
                ..all()
            },
            9
        )
        .await
        .len(),
        1
    );
    assert_eq!(lab.counts().await.unwrap().running, 3);
}

#[tokio::test]
async fn a_claim_takes_the_first_of_what_its_worker_can_do() {
    let lab = Lab::open(LONG).await;
    let mut database = fill(&lab, 100).await;
    let claim = |kinds: &[JobKind]| {
        let mut worker = worker("picky");
        worker.kinds = kinds.to_vec();
        worker.worker_id = Uuid::new_v4();
        worker
    };
    let mut taken = Vec::new();
    for kinds in [
        &[JobKind::NonwovenTensile, JobKind::PaperTensile][..],
        &[JobKind::PaperTensile],
        &[JobKind::Calibrate],
        JobKind::ALL,
        &[JobKind::NonwovenTensile],
    ] {
        // specs of the filling are none, so only the order is looked at
        let first: Option<i64> = {
            let _ = lab.claim(&claim(kinds)).await;
            query_scalar(
                "SELECT MAX(job) FROM attempts WHERE seq = (SELECT MAX(seq) FROM attempts)",
            )
            .fetch_one(&mut database)
            .await
            .unwrap()
        };
        taken.push(first);
    }
    // 50 and 100 are urgent, and no paper; 3 is the first paper; nobody waits to calibrate: none is taken
    assert_eq!(taken, [Some(50), Some(3), Some(3), Some(100), Some(2)]);
}

#[tokio::test]
async fn lists_find_the_same_whatever_they_walk() {
    let lab = Lab::open(LONG).await;
    let mut database = fill(&lab, 3000).await;
    let q = |text: &str| JobFilter {
        q: Some(text.to_owned()),
        ..all()
    };
    let wet = |filter: JobFilter| JobFilter {
        tag: Some("wet".to_owned()),
        ..filter
    };
    // dense and rare, alone and together: more and fewer than are looked at one by one
    let queued = |filter| JobFilter {
        status: Some(JobStatus::Queued),
        ..filter
    };
    let succeeded = |filter| JobFilter {
        outcome: Some(JobOutcome::Succeeded),
        ..filter
    };
    let paper = |filter| JobFilter {
        kind: Some(JobKind::PaperTensile),
        ..filter
    };
    for (what, filter, expected) in [
        ("all", all(), 3000),
        ("queued", queued(all()), 2700),
        ("succeeded", succeeded(all()), 300),
        ("paper", paper(all()), 1000),
        ("paper succeeded", succeeded(paper(all())), 100),
        ("wet", wet(all()), 600),
        ("wet queued", wet(queued(all())), 600),
        ("wet succeeded", wet(succeeded(all())), 0),
        ("text", q("sAMPLE"), 3000),
        ("text of one", q("mple 2999 of"), 1),
        ("text queued", queued(q("sample")), 2700),
        ("text succeeded", succeeded(q("sample")), 300),
        ("text of notes", q("what was wet"), 300),
        ("text or tag", q("wet"), 600),
        ("text wet", wet(q("series 2")), 200),
        (
            "series tag and text",
            JobFilter {
                tag: Some("series-1".into()),
                ..q("sample")
            },
            200,
        ),
        ("two characters", q("Wt"), 0),
        ("two characters of many", q("ER"), 3000),
        ("nothing", q("no such text"), 0),
        ("a quote", q("\""), 600),
        ("syntax", q("sample OR series"), 0),
        ("a zero", q("sam\0ple"), 0),
        ("stars", q("sam*"), 0),
    ] {
        let mut count = 0;
        let mut cursor = None;
        let mut last = String::new();
        loop {
            let page = lab.jobs(&filter, cursor.as_deref(), 700).await.unwrap();
            count += page.items.len();
            cursor = page.next;
            let Some(next) = &cursor else { break };
            assert_ne!(*next, last, "{what}");
            last.clone_from(next);
        }
        assert_eq!(count, expected, "{what}");
    }
    let newest = names(&lab, wet(q("sample")), 2).await;
    assert_eq!(
        newest,
        ["Sample 3000 of series 3", "Sample 2995 of series 2"]
    );
    // an id by its first digits: those of its moment are the first twelve
    let one: Uuid = query_scalar("SELECT id FROM jobs WHERE seq = 1234")
        .fetch_one(&mut database)
        .await
        .unwrap();
    let found = names(&lab, q(&one.to_string()[..13].to_uppercase()), 9).await;
    assert_eq!(found, ["Sample 1234 of series 1"]);
}

#[tokio::test]
async fn moments_part_the_jobs_wherever_they_lie_and_though_the_clock_was_set() {
    let lab = Lab::open(LONG).await;
    let mut database = fill(&lab, 100).await;
    // the clock was set back for one of the last, and forward for one of the first
    query("UPDATE jobs SET created_at = CASE seq WHEN 90 THEN 1700000000010 ELSE 1700000000095 END WHERE seq IN (5, 90)")
        .execute(&mut database)
        .await
        .unwrap();
    let at = |millis: i64| Some(Timestamp(1_700_000_000_000 + millis));
    let numbers = async |filter: JobFilter| {
        let names = names(&lab, filter, 1000).await;
        let number = |name: &String| name.split(' ').nth(1).unwrap().parse::<i64>().unwrap();
        names.iter().map(number).collect::<Vec<_>>()
    };
    let after = numbers(JobFilter {
        created_after: at(97),
        ..all()
    })
    .await;
    assert_eq!(after, [100, 99, 98]);
    let after = numbers(JobFilter {
        created_after: at(94),
        ..all()
    })
    .await;
    assert_eq!(after, [100, 99, 98, 97, 96, 95, 5]);
    let before = numbers(JobFilter {
        created_before: at(4),
        ..all()
    })
    .await;
    assert_eq!(before, [3, 2, 1]);
    let before = numbers(JobFilter {
        created_before: at(11),
        ..all()
    })
    .await;
    assert_eq!(before, [90, 10, 9, 8, 7, 6, 4, 3, 2, 1]);
    assert!(
        numbers(JobFilter {
            created_after: at(100),
            ..all()
        })
        .await
        .is_empty()
    );
    assert!(
        numbers(JobFilter {
            created_before: at(0),
            ..all()
        })
        .await
        .is_empty()
    );
}

/// Prints the median, the 95th percentile and the longest of many tries.
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
async fn measure(what: &str, tries: usize, mut work: impl AsyncFnMut()) -> Duration {
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
    let mut claims = Vec::new();
    for count in [1_000, 100_000, 1_000_000] {
        let lab = Lab::open(LONG).await;
        let start = Instant::now();
        fill_in_bulk(&lab, count).await;
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
        for (what, filter) in &filters {
            let page = async || drop(lab.jobs(filter, None, 200).await.unwrap());
            assert!(measure(what, TRIES, page).await < LONGEST, "{what}");
        }
        let early = Some(Timestamp(1_700_000_000_100));
        let old = JobFilter {
            created_before: early,
            ..all()
        };
        measure("before an early moment", TRIES, async || {
            drop(lab.jobs(&old, None, 200).await.unwrap())
        })
        .await;
        measure("two characters of none", 5, async || {
            drop(lab.jobs(&q("zq"), None, 200).await.unwrap())
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
        measure("counts", TRIES, async || drop(lab.counts().await.unwrap())).await;
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
            lab.try_write().await.unwrap()
        })
        .await;
        readers.iter().for_each(tokio::task::JoinHandle::abort);
    }
    assert!(claims[2] < LONGEST, "{claims:?}");
}
