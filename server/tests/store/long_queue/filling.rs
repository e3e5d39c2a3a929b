//! Jobs in bulk, written beside the open store.
use std::time::Duration;

use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, query, query_as};
use uuid::Uuid;

use crate::lab::Lab;

/// The database beside the store.
pub(super) async fn beside(lab: &Lab) -> SqliteConnection {
    let file = lab.folder.path().join("loadframe.db");
    let options = SqliteConnectOptions::new().filename(file);
    let options = options.busy_timeout(Duration::from_secs(60));
    options.foreign_keys(true).connect().await.unwrap()
}

/// Adds `count` jobs: one of ten has succeeded, one of fifty is urgent, one of five has tags; two kinds.
pub(super) async fn fill(lab: &Lab, count: i64) -> SqliteConnection {
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

/// The same for very many, without triggers and with what these keep made at once. Where there are people,
/// the first has every second job and the others have the rest.
pub(super) async fn fill_in_bulk(lab: &Lab, count: i64, people: &[Uuid]) {
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
    if !people.is_empty() {
        let names: Vec<String> = people.iter().map(|id| id.simple().to_string()).collect();
        query(
            "UPDATE jobs SET owner = unhex(json_extract(?1,
                '$[' || CASE seq % 2 WHEN 0 THEN 0 ELSE seq / 2 % ?2 END || ']'))",
        )
        .bind(serde_json::to_string(&names).unwrap())
        .bind(i64::try_from(people.len()).unwrap())
        .execute(&mut database)
        .await
        .unwrap();
    }
    for statement in [
        "INSERT INTO waiting_counts (bits, priority, owner, block, jobs)
         SELECT bits, priority, COALESCE(owner, x''), seq >> bits, COUNT(*)
         FROM jobs, (SELECT 6 AS bits UNION SELECT 12 UNION SELECT 18)
         WHERE status = 'queued' GROUP BY 1, 2, 3, 4",
        "INSERT INTO waiting_lines (priority, owner, kind, needs, jobs, core_ms)
         SELECT priority, COALESCE(owner, x''), kind, needs, COUNT(*), 0
         FROM jobs WHERE status = 'queued' GROUP BY 1, 2, 3, 4",
        "INSERT INTO job_counts SELECT COALESCE(outcome, status), COUNT(*) FROM jobs WHERE status <> 'queued' GROUP BY 1",
        "INSERT INTO job_tags (tag, job) SELECT value, seq FROM jobs, json_each(jobs.tags)",
        "INSERT INTO job_texts (job_texts) VALUES ('rebuild')",
        "UPDATE job_texts_known SET up_to = (SELECT MAX(seq) FROM jobs)",
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
