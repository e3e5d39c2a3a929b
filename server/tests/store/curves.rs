//! Curves and logs that grow.
use loadframe_api::worker::{CurveBlock, ProgressReport, ReleaseReason};

use crate::lab::{LONG, Lab, is_invalid, key};

fn row(index: u64) -> Vec<f64> {
    let strain = index as f64 * 0.1;
    vec![strain, strain.sin(), 1.0 / (1.0 + strain)]
}

fn block(first: u64, count: u64) -> ProgressReport {
    ProgressReport {
        progress: 0.25,
        phase: "pulling".to_owned(),
        eta_s: Some(3.0),
        points: Some(CurveBlock {
            columns: ["strain", "force_n", "other"].map(str::to_owned).to_vec(),
            first,
            rows: (first..first + count).map(row).collect(),
        }),
        log: Vec::new(),
        log_from: None,
    }
}

fn bits(points: &[Vec<f64>]) -> Vec<u64> {
    points
        .iter()
        .flatten()
        .map(|value| value.to_bits())
        .collect()
}

#[tokio::test]
async fn points_come_back_bit_by_bit_however_they_were_sent() {
    const POINTS: u64 = 9_500;
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    // one by one, then repeating what is known, then more than a block at once
    let mut known = 0;
    for count in [1, 1, 1, 7, 200, 5000, 4290] {
        let repeated = known / 2;
        let report = block(known - repeated, count + repeated);
        lab.report(key(&lease), &report).await.unwrap();
        known += count;
    }
    assert_eq!(known, POINTS);
    lab.report(key(&lease), &block(0, 10)).await.unwrap();

    let curve = lab.curve(id, 0, None).await.unwrap();
    let expected: Vec<Vec<f64>> = (0..POINTS).map(row).collect();
    assert_eq!(bits(&curve.points), bits(&expected));
    assert_eq!(curve.columns, ["strain", "force_n", "other"]);
    assert_eq!(
        (curve.next, curve.attempt, curve.complete),
        (POINTS, 1, false)
    );

    for (since, limit) in [
        (0, 5),
        (4000, 500),
        (4166, 2),
        (9_499, 10),
        (9_500, 10),
        (20_000, 1),
    ] {
        let part = lab.curve(id, since, Some(limit)).await.unwrap();
        let range =
            since.min(POINTS) as usize..(since + limit).min(POINTS).max(since.min(POINTS)) as usize;
        assert_eq!(
            bits(&part.points),
            bits(&expected[range]),
            "{since} {limit}"
        );
        assert_eq!(part.next, since + part.points.len() as u64);
    }
    let job = lab.view(id).await;
    assert_eq!((job.phase.as_str(), job.eta_s), ("pulling", Some(3.0)));
}

#[tokio::test]
async fn gaps_and_misshapen_blocks_are_refused_whole() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    lab.report(key(&lease), &block(0, 5)).await.unwrap();

    let mut gap = block(6, 1);
    gap.log = vec!["must not be kept".to_owned()];
    let mut other_columns = block(5, 1);
    let mut short_row = block(5, 1);
    let mut not_finite = block(5, 1);
    other_columns.points.as_mut().unwrap().columns[2] = "renamed".to_owned();
    short_row.points.as_mut().unwrap().rows[0].pop();
    not_finite.points.as_mut().unwrap().rows[0][1] = f64::INFINITY;
    let mut progress = block(5, 1);
    progress.progress = f64::NAN;
    for bad in [gap, other_columns, short_row, not_finite, progress] {
        assert!(is_invalid(lab.report(key(&lease), &bad).await));
    }
    assert_eq!(lab.curve(id, 0, None).await.unwrap().next, 5);
    assert!(lab.log(id, 0).await.unwrap().is_empty());
    lab.report(key(&lease), &block(5, 1)).await.unwrap();
}

#[tokio::test]
async fn a_curve_never_shrinks_and_the_result_shows_the_attempt_that_completed() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let first = lab.lease().await;
    lab.report(key(&first), &block(0, 100)).await.unwrap();
    lab.release(key(&first), ReleaseReason::Shutdown)
        .await
        .unwrap();

    let second = lab.lease().await;
    lab.report(key(&second), &block(0, 40)).await.unwrap();
    let curve = lab.curve(id, 0, None).await.unwrap();
    assert_eq!((curve.next, curve.attempt), (100, 1));
    lab.report(key(&second), &block(40, 80)).await.unwrap();
    let curve = lab.curve(id, 0, None).await.unwrap();
    assert_eq!((curve.next, curve.attempt), (120, 2));
    lab.release(key(&second), ReleaseReason::Shutdown)
        .await
        .unwrap();

    let third = lab.lease().await;
    lab.report(key(&third), &block(0, 120)).await.unwrap();
    lab.finish(&third).await;
    let curve = lab.curve(id, 0, None).await.unwrap();
    assert_eq!((curve.next, curve.attempt, curve.complete), (120, 3, true));
}

#[tokio::test]
async fn a_job_that_never_ran_has_an_empty_curve() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let curve = lab.curve(id, 0, None).await.unwrap();
    assert!(curve.points.is_empty() && curve.columns.is_empty() && !curve.complete);
}

#[tokio::test]
async fn a_log_keeps_its_last_lines_and_their_numbers() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    for hundred in 0..25 {
        let log = (0..100).map(|line| format!("line {}", hundred * 100 + line));
        let report = ProgressReport {
            log: log.collect(),
            ..ProgressReport::default()
        };
        lab.report(key(&lease), &report).await.unwrap();
    }
    let all = lab.log(id, 0).await.unwrap();
    assert_eq!(all.len(), 2000);
    assert_eq!(all[0].message, "line 500");
    assert_eq!(all[1999].message, "line 2499");
    let tail = lab.log(id, 2490).await.unwrap();
    assert_eq!(tail.len(), 10);
    assert_eq!(
        (tail[0].message.as_str(), tail[0].attempt),
        ("line 2490", 1)
    );
    assert!(lab.log(id, 2500).await.unwrap().is_empty());
}

#[tokio::test]
async fn a_resumed_attempt_has_the_blocks_of_the_curve_before_its_checkpoint() {
    let lab = Lab::open(LONG).await;
    let id = lab.submit().await;
    let lease = lab.lease().await;
    assert_eq!(lease.curve_points, 0);
    // three columns of 8 bytes: a block of 100 kB has 4167 points
    const BLOCK: u64 = 4167;
    lab.report(key(&lease), &block(0, 9_000)).await.unwrap();
    lab.checkpoint_with(&lease, b"state", 5.0).await;
    // what came after the checkpoint is computed again
    lab.report(key(&lease), &block(9_000, 9_000)).await.unwrap();
    let release = lab.release(key(&lease), ReleaseReason::Shutdown);
    release.await.unwrap();

    let next = lab.lease().await;
    assert_eq!((next.attempt, next.curve_points), (2, 2 * BLOCK));
    let gap = lab.report(key(&next), &block(2 * BLOCK + 1, 1)).await;
    assert!(is_invalid(gap));
    assert_eq!(lab.curve(id, 0, None).await.unwrap().points.len(), 18_000);
    let rest = block(2 * BLOCK, 10_000);
    lab.report(key(&next), &rest).await.unwrap();
    lab.report(key(&next), &block(2 * BLOCK + 10_000, 2_000))
        .await
        .unwrap();
    let curve = lab.curve(id, 0, None).await.unwrap();
    let expected: Vec<Vec<f64>> = (0..2 * BLOCK + 12_000).map(row).collect();
    assert_eq!(curve.attempt, 2);
    assert_eq!(bits(&curve.points), bits(&expected));
    // a checkpoint of the second attempt, from which a third goes on
    lab.checkpoint_with(&next, b"further", 9.0).await;
    let release = lab.release(key(&next), ReleaseReason::Shutdown);
    release.await.unwrap();
    // its last block ends where the checkpoint is
    assert_eq!(lab.lease().await.curve_points, 2 * BLOCK + 12_000);
}
