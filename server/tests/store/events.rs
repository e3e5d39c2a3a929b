//! What is told to those who watch.
use loadframe_api::worker::{CurveBlock, ProgressReport};
use loadframe_api::{Event, JobStatus};
use loadframe_server::store::StoredEvent;

use crate::lab::{LONG, Lab, key};

fn names(events: &[StoredEvent]) -> Vec<&'static str> {
    events.iter().map(|stored| stored.event.name()).collect()
}

#[tokio::test]
async fn events_follow_a_job_and_are_replayed_from_any_number() {
    let lab = Lab::open(LONG).await;
    let mut changes = lab.changes();
    let start = lab.last_event().await;
    let id = lab.submit().await;
    assert!(changes.has_changed().unwrap());
    let submitted = lab.events_after(start, None, 100).await.unwrap();
    assert_eq!(names(&submitted), ["job"]);
    assert_eq!(submitted[0].number, *changes.borrow_and_update());

    let lease = lab.lease().await;
    let mut report = ProgressReport {
        progress: 0.5,
        phase: "half".to_owned(),
        ..ProgressReport::default()
    };
    lab.report(key(&lease), &report).await.unwrap();
    report.points = Some(CurveBlock {
        columns: vec!["a".to_owned()],
        first: 0,
        rows: vec![vec![1.0], vec![2.0]],
    });
    lab.report(key(&lease), &report).await.unwrap();
    let running = lab
        .events_after(submitted[0].number, None, 100)
        .await
        .unwrap();
    assert_eq!(names(&running), ["job", "points", "progress"]);
    let Event::Points(points) = &running[1].event else {
        panic!()
    };
    assert_eq!((points.total, points.attempt), (2, 1));
    assert!(running.is_sorted_by_key(|stored| stored.number));

    lab.finish(&lease).await;
    let ended = lab
        .events_after(running[2].number, None, 100)
        .await
        .unwrap();
    let Some(Event::Job(job)) = ended.first().map(|stored| &stored.event) else {
        panic!("{ended:?}")
    };
    assert_eq!(ended.len(), 1);
    assert_eq!(job.status, JobStatus::Finished);
    assert!(job.summary.is_some());

    lab.delete(id).await.unwrap();
    let all = lab.events_after(0, None, 100).await.unwrap();
    assert_eq!(names(&all), ["deleted"]);
    assert_eq!(all[0].number, lab.last_event().await);
    assert!(
        lab.events_after(all[0].number, None, 100)
            .await
            .unwrap()
            .is_empty()
    );
}

#[tokio::test]
async fn watchers_of_one_job_hear_of_that_job_only() {
    let lab = Lab::open(LONG).await;
    let (mine, other) = (lab.submit().await, lab.submit().await);
    let heard = lab.events_after(0, Some(&[mine]), 100).await.unwrap();
    assert_eq!(heard.len(), 1);
    assert_eq!(heard[0].event.job_id(), mine);
    let both = lab.events_after(0, Some(&[mine, other]), 1).await.unwrap();
    assert_eq!(both.len(), 1, "the limit holds");
}

#[tokio::test]
async fn numbers_never_come_again() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    lab.delete(id).await.unwrap();
    let last = lab.last_event().await;
    let lab = lab.reopen(LONG).await;
    assert_eq!(lab.last_event().await, last);
    lab.submit().await;
    assert!(lab.last_event().await > last);
}
