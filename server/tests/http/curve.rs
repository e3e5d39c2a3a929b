//! The curve in its forms.
use crate::support::Lab;

#[tokio::test]
async fn a_curve_grows_and_is_read_from_where_one_was() {
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let path = format!("/v1/jobs/{id}/curve");
    let empty = lab.get(&path).await.json();
    assert_eq!(
        (&empty["points"], &empty["next"]),
        (&serde_json::json!([]), &0.into())
    );
    assert_eq!(lab.get(&format!("{path}.csv")).await.text(), "");
    let lease = lab.claim().await;
    lab.report(&lease, 0, vec![vec![0.0, 0.0], vec![0.1, 2.0]])
        .await;
    let first = lab.get(&path).await.json();
    assert_eq!(first["columns"], serde_json::json!(["strain", "force_n"]));
    assert_eq!(
        (&first["next"], &first["complete"]),
        (&2.into(), &false.into())
    );
    lab.report(&lease, 2, vec![vec![0.2, 3.0]]).await;
    let more = lab.get(&format!("{path}?since=2")).await.json();
    assert_eq!(more["points"], serde_json::json!([[0.2, 3.0]]));
    let none = lab.get(&format!("{path}?since=3")).await.json();
    assert_eq!(
        (&none["points"], &none["next"]),
        (&serde_json::json!([]), &3.into())
    );
}

#[tokio::test]
async fn csv_by_suffix_or_by_accept_has_full_digits() {
    let lab = Lab::open().await;
    let id = lab.finished(&[]).await;
    let expected = "strain,force_n\n0,1\n1,2.5e-7\n";
    let by_suffix = lab.get(&format!("/v1/jobs/{id}/curve.csv")).await;
    assert_eq!(by_suffix.header("content-type"), "text/csv; charset=utf-8");
    assert_eq!(by_suffix.text(), expected);
    let path = format!("/v1/jobs/{id}/curve");
    let accept = [("accept", "application/json;q=0.5, text/csv")];
    let by_accept = lab.get_with(&path, &accept).await;
    assert_eq!(
        (by_accept.text().as_str(), by_accept.header("vary")),
        (expected, "accept")
    );
    let thinned = lab
        .get(&format!("/v1/jobs/{id}/curve.csv?max_points=10"))
        .await;
    assert_eq!(thinned.text(), expected);
    let json = lab.get_with(&path, &[("accept", "*/*")]).await;
    assert_eq!(json.json()["complete"], true);
}

#[tokio::test]
async fn a_long_curve_is_thinned_out_and_csv_has_it_all() {
    const POINTS: u64 = 45_000;
    const BLOCK: u64 = 9_000;
    let height = |index: u64| {
        if index == 31_234 {
            99.0
        } else {
            (index % 10) as f64
        }
    };
    let lab = Lab::open().await;
    let id = lab.submit().await;
    let lease = lab.claim().await;
    for first in (0..POINTS).step_by(BLOCK as usize) {
        let rows = (first..first + BLOCK).map(|index| vec![index as f64, height(index)]);
        lab.report(&lease, first, rows.collect()).await;
    }
    let path = format!("/v1/jobs/{id}/curve");
    let thinned = lab.get(&format!("{path}?max_points=500")).await.json();
    let points = thinned["points"].as_array().expect("points");
    assert!((100..=500).contains(&points.len()), "{}", points.len());
    assert_eq!(points[0][0], 0.0);
    assert_eq!(points[points.len() - 1][0], (POINTS - 1) as f64);
    assert!(
        points.iter().any(|point| point[1] == 99.0),
        "the peak is kept"
    );
    assert_eq!(thinned["next"], POINTS);

    let csv = lab.get(&format!("{path}.csv")).await.text();
    assert_eq!(csv.lines().count() as u64, POINTS + 1);
    let mut since = 0;
    let mut read = 0;
    loop {
        let part = lab.get(&format!("{path}?since={since}")).await.json();
        let count = part["points"].as_array().map_or(0, Vec::len);
        read += count as u64;
        since = part["next"].as_u64().expect("next");
        if count == 0 {
            break;
        }
    }
    assert_eq!(read, POINTS);
}
