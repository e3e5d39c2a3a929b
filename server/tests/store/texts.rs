//! Texts of new jobs, which come into the index of a search later than the jobs into the store: whatever has become
//! of a job by then.
use loadframe_server::store::{JobEdit, JobFilter};
use sqlx::{ConnectOptions, Connection, Executor};
use uuid::Uuid;

use crate::lab::{LONG, Lab};

/// The jobs that a search finds, the newest first.
async fn found(lab: &Lab, text: &str) -> Vec<Uuid> {
    let filter = JobFilter {
        q: Some(text.to_owned()),
        ..JobFilter::default()
    };
    let page = lab.jobs(&filter, None, 100).await.unwrap();
    page.items.iter().map(|job| job.id).collect()
}

async fn rename(lab: &Lab, id: Uuid, name: &str) {
    let edit = JobEdit {
        name: Some(name.to_owned()),
        ..JobEdit::default()
    };
    lab.edit(id, edit).await.unwrap();
}

/// What SQLite's index of texts says of itself, held against the jobs.
async fn index_is_whole(lab: &Lab) -> bool {
    let database = lab.folder.path().join("loadframe.db");
    if !database.exists() {
        // another database, which keeps its index by itself
        return true;
    }
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    let mut connection = options.connect().await.unwrap();
    // sqlite.org/fts5.html#the_integrity_check_command
    let check = "INSERT INTO job_texts (job_texts, rank) VALUES ('integrity-check', 1)";
    let is_whole = connection.execute(check).await.is_ok();
    connection.close().await.unwrap();
    is_whole
}

#[tokio::test]
async fn a_search_finds_what_was_submitted_just_now_and_only_that() {
    let lab = Lab::open(LONG).await;
    // more than go into the index at once
    for number in 0..510 {
        lab.submit_with(&format!("sheet {number}"), 0).await;
    }
    assert_eq!(found(&lab, "sheet 509").await.len(), 1);
    assert!(index_is_whole(&lab).await);
    // of each what happens before it is in the index, and afterwards
    let known: [Uuid; 3] = [
        lab.submit_with("strip one", 0).await,
        lab.submit_with("strip two", 0).await,
        lab.submit_with("strip three", 0).await,
    ];
    assert_eq!(found(&lab, "strip").await, [known[2], known[1], known[0]]);
    let new: [Uuid; 3] = [
        lab.submit_with("strip four", 0).await,
        lab.submit_with("strip five", 0).await,
        lab.submit_with("strip six", 0).await,
    ];
    for [renamed, erased, discarded] in [known, new] {
        rename(&lab, renamed, "band").await;
        lab.delete(erased).await.unwrap();
        lab.discard(discarded).await.unwrap();
    }
    assert!(found(&lab, "strip").await.is_empty());
    assert_eq!(found(&lab, "band").await, [new[0], known[0]]);
    let newest = lab.submit_with("strip seven", 0).await;
    for back in [known[2], new[2]] {
        lab.bring_back(back).await.unwrap();
    }
    assert_eq!(found(&lab, "strip").await, [newest, new[2], known[2]]);
    // what was known before the trash, and what was not
    rename(&lab, new[2], "band").await;
    assert_eq!(found(&lab, "strip").await, [newest, known[2]]);
    assert!(index_is_whole(&lab).await);
    let lab = lab.reopen(LONG).await;
    assert_eq!(found(&lab, "strip").await, [newest, known[2]]);
}

#[tokio::test]
async fn a_name_is_found_by_itself_however_its_letters_are_made_small() {
    let lab = Lab::open(LONG).await;
    // letters of which the small one is two, another in another place, or one of ASCII; short and long
    for name in ["İzmir", "İz", "ΟΔΟΣ", "ÄÖ", "Ǆ", "STRASSE", "300 \u{212a}"] {
        let job = lab.submit_with(name, 0).await;
        assert_eq!(found(&lab, name).await.first(), Some(&job), "{name}");
    }
    let job = lab.submit_with("Größe Ä", 0).await;
    for other in ["größe ä", "GRÖ", "Größe"] {
        assert_eq!(found(&lab, other).await, [job], "{other}");
    }
}
