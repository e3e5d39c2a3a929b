//! Submitting, finding and deleting jobs.
use std::collections::HashSet;

use loadframe_api::{JobStatus, Timestamp};
use loadframe_server::store::{
    Counts, IdempotencyKey, JobEdit, JobFilter, StoreError, UserAction, Wanted,
};

use crate::lab::{LONG, Lab, is_conflict, is_invalid, is_missing, key, submission};

fn named(key: &str, body: &str) -> Option<IdempotencyKey> {
    Some(IdempotencyKey {
        key: key.to_owned(),
        body_sha256: body.to_owned(),
    })
}

#[tokio::test(flavor = "multi_thread")]
async fn a_key_makes_one_job_however_many_ask_at_once() {
    let lab = Lab::open(LONG).await;
    let clients = (0..40).map(|client| {
        let store = lab.store.clone();
        let name = format!("key-{}", client % 4);
        tokio::spawn(async move {
            let submission = submission("", 0);
            store
                .enqueue(&submission, named(&name, "body"))
                .await
                .unwrap()
        })
    });
    let mut ids = HashSet::new();
    let mut fresh = 0;
    for client in clients.collect::<Vec<_>>() {
        let enqueued = client.await.unwrap();
        ids.insert(enqueued.job.id);
        fresh += usize::from(!enqueued.replayed);
    }
    assert_eq!((ids.len(), fresh), (4, 4));
    assert_eq!(lab.counts().await.unwrap().queued, 4);
}

#[tokio::test]
async fn a_key_belongs_to_its_body_even_after_the_job_is_gone() {
    let lab = Lab::open(LONG).await;
    let submission = submission("", 0);
    let job = lab.enqueue(&submission, named("k", "a")).await.unwrap().job;
    let other = lab.enqueue(&submission, named("k", "b")).await;
    assert!(matches!(other, Err(StoreError::KeyReused)));
    lab.delete(job.id).await.unwrap();
    assert!(is_conflict(lab.enqueue(&submission, named("k", "a")).await));
    assert_eq!(lab.counts().await.unwrap().queued, 0);
}

#[tokio::test]
async fn lists_are_filtered_and_come_in_pages_newest_first() {
    let lab = Lab::open(LONG).await;
    let mut ids = Vec::new();
    for number in 0..7 {
        ids.push(lab.submit_with(&format!("Sample {number}"), 0).await);
    }
    ids.reverse();
    let mut seen = Vec::new();
    let mut cursor = None;
    loop {
        let page = lab
            .jobs(&JobFilter::default(), cursor.as_deref(), 3)
            .await
            .unwrap();
        assert!(page.items.len() <= 3);
        seen.extend(page.items.iter().map(|job| job.id));
        cursor = page.next;
        if cursor.is_none() {
            break;
        }
    }
    assert_eq!(seen, ids);
    assert!(is_invalid(
        lab.jobs(&JobFilter::default(), Some("x"), 3).await
    ));

    let tags = Some(vec!["wet".to_owned(), "PET".to_owned()]);
    let edit = JobEdit {
        tags,
        ..JobEdit::default()
    };
    lab.edit(ids[2], edit).await.unwrap();
    lab.request(ids[0], UserAction::Cancel).await.unwrap();
    let found = async |filter: JobFilter| {
        let page = lab.jobs(&filter, None, 100).await.unwrap();
        page.items.into_iter().map(|job| job.id).collect::<Vec<_>>()
    };
    let all = JobFilter::default;
    let finished = JobFilter {
        status: Some(JobStatus::Finished),
        ..all()
    };
    assert_eq!(found(finished).await, [ids[0]]);
    assert_eq!(
        found(JobFilter {
            tag: Some("wet".into()),
            ..all()
        })
        .await,
        [ids[2]]
    );
    assert!(
        found(JobFilter {
            tag: Some("we".into()),
            ..all()
        })
        .await
        .is_empty()
    );
    assert_eq!(
        found(JobFilter {
            q: Some("pet".into()),
            ..all()
        })
        .await,
        [ids[2]]
    );
    assert_eq!(
        found(JobFilter {
            q: Some("sAMPLE 3".into()),
            ..all()
        })
        .await,
        [ids[3]]
    );
    let id = ids[4].to_string();
    assert_eq!(
        found(JobFilter {
            q: Some(id),
            ..all()
        })
        .await,
        [ids[4]]
    );
    let later = Some(Timestamp(Timestamp::now().as_millis() + 1000));
    assert!(
        found(JobFilter {
            created_after: later,
            ..all()
        })
        .await
        .is_empty()
    );
    assert_eq!(
        found(JobFilter {
            created_before: later,
            ..all()
        })
        .await
        .len(),
        7
    );
}

#[tokio::test]
async fn any_part_of_a_text_is_found_as_it_is_and_as_it_was_edited() {
    let lab = Lab::open(LONG).await;
    let names = [
        "Wet\" OR \"dry strip",
        "100 % \u{c4}ltere Probe_7",
        "it's C:\\sheet",
        "wet strip",
    ];
    let mut ids = Vec::new();
    for name in names {
        ids.push(lab.submit_with(name, 0).await);
    }
    let found = async |text: &str| {
        let filter = JobFilter {
            q: Some(text.to_owned()),
            ..JobFilter::default()
        };
        let page = lab.jobs(&filter, None, 100).await.unwrap();
        let place = |id| ids.iter().position(|of| *of == id).unwrap();
        let mut found: Vec<usize> = page.items.iter().map(|job| place(job.id)).collect();
        found.reverse();
        // a search through specs walks the same
        let wanted = Wanted {
            conditions: vec!["/spec/seed>=0".parse().unwrap()],
            ..Wanted::default()
        };
        let searched = lab.jobs_wanted(&filter, &wanted, None, 100).await.unwrap();
        assert_eq!(searched.items.len(), found.len(), "{text}");
        found
    };
    for (text, expected) in [
        ("strip", vec![0, 3]),
        ("TRI", vec![0, 3]),
        ("\" or \"", vec![0]),
        ("0 % ", vec![1]),
        ("\u{e4}lt", vec![1]),
        // these stand for nothing else
        ("%", vec![1]),
        ("e_7", vec![1]),
        ("e.7", vec![]),
        ("c:\\s", vec![2]),
        ("t's", vec![2]),
        // each of its threes is there, and it is not
        ("stripstrip", vec![]),
        ("wet strip", vec![3]),
    ] {
        assert_eq!(found(text).await, expected, "{text}");
    }
    let edit = JobEdit {
        name: Some("renamed".to_owned()),
        notes: Some("pulled twice".to_owned()),
        tags: Some(vec!["acrylic".to_owned()]),
        ..JobEdit::default()
    };
    lab.edit(ids[3], edit).await.unwrap();
    lab.delete(ids[0]).await.unwrap();
    for (text, expected) in [
        ("strip", vec![]),
        ("rename", vec![3]),
        ("twice", vec![3]),
        ("acryl", vec![3]),
        // a text does not go on in the next field
        ("renamed pulled", vec![]),
    ] {
        assert_eq!(found(text).await, expected, "{text}");
    }
}

#[tokio::test]
async fn delete_frees_rows_and_files_but_not_those_of_others() {
    let lab = Lab::open(LONG).await;
    let (mine, other) = (lab.submit().await, lab.submit().await);
    for _ in 0..2 {
        let lease = lab.lease().await;
        // the same content under both jobs, and one file of its own each
        lab.put(&lease, "own.txt", lease.job_id.as_bytes()).await;
        let mut result = lab.result(&lease).await;
        result
            .files
            .push(lab.put(&lease, "own.txt", lease.job_id.as_bytes()).await);
        lab.complete(key(&lease), &result).await.unwrap();
    }
    let before = lab.blobs().await;
    assert_eq!(before, 4, "curve and outcome shared, one own file each");
    lab.delete(mine).await.unwrap();
    assert_eq!(lab.blobs().await, 3);
    assert!(is_missing(lab.job(mine).await));
    assert!(is_missing(lab.files(mine).await));
    assert_eq!(lab.files(other).await.unwrap().len(), 3);
    lab.delete(other).await.unwrap();
    assert_eq!(lab.blobs().await, 0);
    let left = Counts {
        workers_alive: 2,
        ..Counts::default()
    };
    assert_eq!(lab.counts().await.unwrap(), left);
}

#[tokio::test]
async fn versions_change_when_what_is_shown_does() {
    let lab = Lab::open(LONG).await;
    let first = lab.submit().await;
    let second = lab.submit().await;
    let all = lab.jobs_version().await.unwrap();
    let waiting = lab.job_version(second).await.unwrap();
    assert_eq!(lab.job_version(second).await.unwrap(), waiting);
    let lease = lab.lease().await;
    assert_eq!(lease.job_id, first);
    // its place in the queue has changed, though nobody touched it
    assert_ne!(lab.job_version(second).await.unwrap(), waiting);
    assert_ne!(lab.jobs_version().await.unwrap(), all);
    let running = lab.job_version(first).await.unwrap();
    lab.heartbeat(key(&lease)).await.unwrap();
    assert_eq!(lab.job_version(first).await.unwrap(), running);
    let report = loadframe_api::worker::ProgressReport::default();
    lab.report(key(&lease), &report).await.unwrap();
    assert_ne!(lab.job_version(first).await.unwrap(), running);
}
