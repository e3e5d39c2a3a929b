//! What waits, as whoever starts workers sees it.
use crate::lab::{LONG, Lab};

#[tokio::test]
async fn the_backlog_counts_what_waits_by_memory_and_adds_up_its_work() {
    let lab = Lab::open(LONG).await;
    let empty = lab.backlog().await.unwrap();
    assert_eq!((empty.waiting, empty.classes.len()), (0, 0));
    for _ in 0..3 {
        lab.submit().await;
    }
    let backlog = lab.backlog().await.unwrap();
    assert_eq!((backlog.waiting, backlog.classes.len()), (3, 1));
    let class = backlog.classes[0];
    // the small job of these tests is in the least class
    assert_eq!((class.memory_mb, class.jobs), (500.0, 3));
    let sum = 3.0 * class.longest_wall_s;
    assert!((class.total_wall_s - sum).abs() <= 1e-9 * sum, "{class:?}");
    assert!(class.longest_wall_s > 0.0, "{class:?}");
    // one that is running waits no more
    lab.lease().await;
    assert_eq!(lab.backlog().await.unwrap().waiting, 2);
}
