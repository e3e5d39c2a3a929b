//! How long lists by values of specs and results take, of a million jobs; on either database.
use std::time::{Duration, Instant};

use loadframe_api::{JobKind, JobOutcome, JobStatus};
use loadframe_server::access::Sight;
use loadframe_server::store::pointer::Pointer;
use loadframe_server::store::{JobFilter, Wanted};
use sqlx::{Connection as _, Executor as _, postgres::PgConnection};
use uuid::Uuid;

use super::all;
use super::figures::measure;
use super::filling::{beside, fill_in_bulk};
use crate::lab::{LONG, Lab, group, submission};

const FIELDS: [&str; 4] = [
    "/spec/seed",
    "/spec/test/strain_step",
    "/spec/test/breaking",
    "/summary/max_force",
];

/// As [`fill_in_bulk`], with specs of a kilobyte and a result of each that has succeeded.
async fn fill(lab: &Lab, count: i64, people: &[Uuid]) {
    let Some(address) = crate::database::address(lab.folder.path()) else {
        fill_in_bulk(lab, count, people).await;
        let mut database = beside(lab).await;
        for statement in [
            "UPDATE specs SET json = json_object('version', 1, 'seed', job * 7919 % 1000003, 'test',
                json_object('strain_step', 0.01 * (job % 7), 'breaking',
                CASE job % 3 WHEN 0 THEN 'none' WHEN 1 THEN 'all_over_strength' ELSE 'weakest_first' END),
                'rest', hex(randomblob(450)))",
            "INSERT INTO results (job, attempt, summary, outcome)
             SELECT seq, 1, json_object('max_force', json_object('value', seq * 31 % 99991 / 7.0, 'unit', 'N')), '{}'
             FROM jobs WHERE outcome = 'succeeded'",
        ] {
            sqlx::query(statement).execute(&mut database).await.unwrap();
        }
        return;
    };
    let mut database = PgConnection::connect(&address).await.unwrap();
    let owners: Vec<String> = people
        .iter()
        .map(|id| format!("'\\x{}'", id.simple()))
        .collect();
    let others = owners.len().max(1);
    let owners = match owners.is_empty() {
        true => "NULL".to_owned(),
        false => format!(
            "(ARRAY[{}]::BYTEA[])[1 + CASE i % 2 WHEN 0 THEN 0 ELSE i / 2 % {others} END]",
            owners.join(", ")
        ),
    };
    let jobs = format!(
        "INSERT INTO jobs (id, kind, name, notes, tags, priority, spec_sha256, status, outcome,
                           reason_code, reason, created_at, updated_at, owner)
         SELECT decode(lpad(to_hex(1700000000000 + i), 12, '0') || '7' || lpad(to_hex(i), 19, '0'), 'hex'),
            CASE i % 3 WHEN 0 THEN 'paper_tensile' ELSE 'nonwoven_tensile' END,
            'Sample ' || i || ' of series ' || i / 1000, '',
            CASE i % 5 WHEN 0 THEN '[\"wet\"]' ELSE '[]' END, 0, lpad(i::TEXT, 64, '0'),
            CASE i % 10 WHEN 1 THEN 'finished' ELSE 'queued' END, CASE i % 10 WHEN 1 THEN 'succeeded' END,
            'submitted', 'waiting for a worker', 1700000000000 + i, 1700000000000 + i, {owners}
         FROM generate_series(1, {count}) i"
    );
    let specs = "INSERT INTO specs (job, json) SELECT seq, json_build_object('version', 1, 'seed',
            seq * 7919 % 1000003, 'test', json_build_object('strain_step', 0.01 * (seq % 7), 'breaking',
            CASE seq % 3 WHEN 0 THEN 'none' WHEN 1 THEN 'all_over_strength' ELSE 'weakest_first' END),
            'rest', repeat(md5(seq::TEXT), 28))::TEXT FROM jobs";
    for statement in [
        "SET session_replication_role = replica",
        &jobs,
        specs,
        "INSERT INTO results (job, attempt, summary, outcome)
         SELECT seq, 1, json_build_object('max_force', json_build_object('value', seq * 31 % 99991 / 7.0))::TEXT, '{}'
         FROM jobs WHERE outcome = 'succeeded'",
        "INSERT INTO job_tags (tag, job) SELECT 'wet', seq FROM jobs WHERE tags <> '[]'",
        "INSERT INTO job_texts (job, trigrams) SELECT seq, trigrams(name, notes, tags) FROM jobs",
        "INSERT INTO job_counts (state, jobs) SELECT COALESCE(outcome, status), COUNT(*) FROM jobs
         WHERE status <> 'queued' GROUP BY 1",
        "INSERT INTO waiting_counts (bits, priority, owner, block, jobs)
         SELECT bits, priority, COALESCE(owner, ''), seq >> bits, COUNT(*)
         FROM jobs, unnest(ARRAY[6, 12, 18]) bits WHERE status = 'queued' GROUP BY 1, 2, 3, 4",
        "INSERT INTO waiting_lines (priority, owner, kind, needs, jobs, core_ms)
         SELECT priority, COALESCE(owner, ''), kind, needs, COUNT(*), 0
         FROM jobs WHERE status = 'queued' GROUP BY 1, 2, 3, 4",
        "ANALYZE",
    ] {
        database.execute(sqlx::AssertSqlSafe(statement)).await.unwrap();
    }
}

/// `cargo test -p loadframe-server --test store a_million_values -- --ignored --nocapture`; with the variable
/// `JOBS` another number of jobs.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "takes minutes; prints figures"]
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
async fn a_million_values_are_sorted_and_found() {
    /// What a page of a list of a million jobs may take.
    const LONGEST: Duration = Duration::from_millis(100);
    const TRIES: usize = 40;
    let count = std::env::var("JOBS").map_or(1_000_000, |text| text.parse().unwrap());
    let lab = Lab::open(LONG).await;
    let people = group(&lab, ["A", "B", "C", "D", "E", "F", "G", "H", "I", "J"]).await;
    let ids: Vec<Uuid> = people.iter().map(|(id, _)| *id).collect();
    let start = Instant::now();
    fill(&lab, count, &ids).await;
    eprintln!("{count} jobs, filled in {:.1?}", start.elapsed());
    let submit = async || drop(lab.enqueue(&submission("new", 0), None).await.unwrap());
    measure("a submission, no value kept", 200, submit).await;

    let list = async |filter: &JobFilter, conditions: &[&str], sort: Option<&str>| {
        let wanted = Wanted {
            conditions: conditions
                .iter()
                .map(|text| text.parse().unwrap())
                .collect(),
            order: sort.map(|text| text.parse().unwrap()),
            shown: Vec::new(),
        };
        lab.jobs_wanted(filter, &wanted, None, 200).await.unwrap()
    };
    let first = measure("sorted by seed, not kept yet", 1, async || {
        drop(list(&all(), &[], Some("/spec/seed")).await);
    });
    let first = first.await;
    let reads = measure("the same, while it is gathered", TRIES, async || {
        assert!(list(&all(), &[], Some("/spec/seed")).await.gathering);
    });
    let reads = reads.await;
    for field in FIELDS {
        let start = Instant::now();
        let field: Pointer = field.parse().unwrap();
        assert!(lab.keep_values(&field).await.unwrap());
        let (mut steps, mut longest) = (0, Duration::ZERO);
        loop {
            let step = Instant::now();
            if !lab.fill_values().await.unwrap() {
                break;
            }
            longest = longest.max(step.elapsed());
            steps += 1;
        }
        eprintln!(
            "  {} gathered in {:.1?}, {steps} steps, longest {longest:.1?}",
            field.text(),
            start.elapsed()
        );
    }
    measure("a submission, four values kept", 200, submit).await;

    let of = |person: Uuid| JobFilter {
        sight: Some(Sight {
            owner: Some(person),
            ..Sight::default()
        }),
        ..all()
    };
    let paper = JobFilter {
        kind: Some(JobKind::PaperTensile),
        ..all()
    };
    let queued = JobFilter {
        status: Some(JobStatus::Queued),
        ..all()
    };
    let succeeded = JobFilter {
        outcome: Some(JobOutcome::Succeeded),
        ..all()
    };
    let failed = JobFilter {
        outcome: Some(JobOutcome::Failed),
        ..all()
    };
    let wet = JobFilter {
        tag: Some("wet".to_owned()),
        ..all()
    };
    let text = |text: &str| JobFilter {
        q: Some(text.to_owned()),
        ..all()
    };
    let lists: [(&str, JobFilter, &[&str], Option<&str>); 21] = [
        ("sorted by seed", all(), &[], Some("/spec/seed")),
        (
            "by strain step, falling, with ties",
            all(),
            &[],
            Some("-/spec/test/strain_step"),
        ),
        ("by words", all(), &[], Some("/spec/test/breaking")),
        (
            "by results, falling",
            all(),
            &[],
            Some("-/summary/max_force"),
        ),
        ("one seed", all(), &["/spec/seed=77"], None),
        ("a thousand seeds", all(), &["/spec/seed<1000"], None),
        (
            "a seventh of all",
            all(),
            &["/spec/test/strain_step=0.03"],
            None,
        ),
        (
            "half of all",
            all(),
            &["/spec/test/strain_step>=0.03"],
            None,
        ),
        ("none", all(), &["/spec/seed<0"], Some("/spec/seed")),
        (
            "a thousand seeds by results",
            all(),
            &["/spec/seed<1000"],
            Some("-/summary/max_force"),
        ),
        (
            "a third by seed",
            all(),
            &["/spec/test/breaking=none"],
            Some("/spec/seed"),
        ),
        (
            "a range by itself",
            all(),
            &["/spec/seed>500000"],
            Some("/spec/seed"),
        ),
        (
            "three conditions",
            all(),
            &[
                "/spec/seed>9",
                "/spec/test/breaking!=none",
                "/spec/test/strain_step<0.05",
            ],
            Some("-/spec/seed"),
        ),
        (
            "paper by seed",
            paper.clone(),
            &["/spec/test/breaking=none"],
            Some("/spec/seed"),
        ),
        (
            "queued by results, which none has",
            queued,
            &[],
            Some("/summary/max_force"),
        ),
        (
            "succeeded by results",
            succeeded,
            &["/summary/max_force>100"],
            Some("/summary/max_force"),
        ),
        ("failed, which none has", failed, &[], Some("/spec/seed")),
        (
            "a tag by seed",
            wet,
            &["/spec/seed>1000"],
            Some("/spec/seed"),
        ),
        (
            "a text of all by seed",
            text("sample"),
            &[],
            Some("/spec/seed"),
        ),
        (
            "a text of some by seed",
            text("series 77"),
            &[],
            Some("/spec/seed"),
        ),
        (
            "what one of ten sees, by seed",
            of(ids[9]),
            &["/spec/seed>1000"],
            Some("-/spec/seed"),
        ),
    ];
    let mut slow = Vec::new();
    for (what, filter, conditions, sort) in lists {
        let page = list(&filter, conditions, sort).await;
        let p95 = measure(what, TRIES, async || {
            drop(list(&filter, conditions, sort).await);
        })
        .await;
        eprintln!(
            "      {} jobs, stopped after {:?}",
            page.items.len(),
            page.stopped_after
        );
        if p95 > LONGEST {
            slow.push(format!("{what}: {p95:?}"));
        }
    }
    // a page from the middle
    let by_seed = Wanted {
        order: Some("/spec/seed".parse().unwrap()),
        ..Wanted::default()
    };
    let p95 = measure("sorted by seed, from the middle on", TRIES, async || {
        let cursor = Some("n500000.0_7");
        drop(
            lab.jobs_wanted(&all(), &by_seed, cursor, 200)
                .await
                .unwrap(),
        );
    });
    if p95.await > LONGEST {
        slow.push("from the middle on".to_owned());
    }
    for (what, time) in [("first", first), ("while it is gathered", reads)] {
        if time > LONGEST {
            slow.push(format!("{what}: {time:?}"));
        }
    }
    assert!(slow.is_empty(), "{slow:#?}");
}
