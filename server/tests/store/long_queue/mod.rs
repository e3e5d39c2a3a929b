//! Queues longer than anybody submits by hand: filled in bulk, beside the open store.
mod by_values;
mod figures;
mod filling;

use loadframe_api::{JobKind, JobOutcome, JobStatus, Timestamp};
use loadframe_server::store::{JobEdit, JobFilter, UserAction};
use sqlx::sqlite::SqliteConnection;
use sqlx::{query, query_as, query_scalar};
use uuid::Uuid;

use crate::lab::{LONG, Lab, worker};
use filling::fill;

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
            "SELECT bits || ' ' || priority || ' ' || hex(owner) || ' ' || block, jobs
             FROM waiting_counts ORDER BY 1",
            "SELECT bits || ' ' || priority || ' ' || hex(COALESCE(owner, x'')) || ' ' || (seq >> bits),
                COUNT(*)
             FROM jobs, (SELECT 6 AS bits UNION SELECT 12 UNION SELECT 18) WHERE status = 'queued'
             GROUP BY 1 ORDER BY 1",
        ),
        (
            "lines",
            "SELECT priority || ' ' || hex(owner) || ' ' || kind || ' ' || needs, jobs
             FROM waiting_lines ORDER BY 1",
            "SELECT priority || ' ' || hex(COALESCE(owner, x'')) || ' ' || kind || ' ' || needs, COUNT(*)
             FROM jobs WHERE status = 'queued' GROUP BY 1 ORDER BY 1",
        ),
        (
            "core hours",
            "SELECT hex(owner), SUM(core_ms) FROM waiting_lines GROUP BY 1 ORDER BY 1",
            "SELECT hex(COALESCE(owner, x'')), SUM(CAST(1000 * MIN(COALESCE(
                json_extract(estimate, '$.wall_s'), 0), 1e9) AS INTEGER))
             FROM jobs WHERE status = 'queued' GROUP BY 1 ORDER BY 1",
        ),
        (
            "files",
            "SELECT seq || '', file_bytes FROM jobs WHERE file_bytes <> 0 ORDER BY 1",
            "SELECT job || '', SUM(bytes) FROM (
                SELECT a.job, f.bytes FROM attempts a JOIN attempt_files f ON f.attempt = a.seq
                UNION ALL SELECT job, bytes FROM checkpoints) GROUP BY 1 HAVING SUM(bytes) <> 0 ORDER BY 1",
        ),
        (
            "counts",
            "SELECT state, jobs FROM job_counts WHERE jobs <> 0 ORDER BY 1",
            "SELECT COALESCE(outcome, status), COUNT(*) FROM jobs WHERE status <> 'queued' GROUP BY 1 ORDER BY 1",
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
    // texts of new jobs come into the index before a search
    for statement in [
        "INSERT INTO job_texts (rowid, name, notes, tags) SELECT seq, name, notes, tags FROM jobs
         WHERE seq > (SELECT up_to FROM job_texts_known)",
        "UPDATE job_texts_known SET up_to = (SELECT COALESCE(MAX(seq), up_to) FROM jobs)",
    ] {
        query(statement).execute(&mut *database).await.unwrap();
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
