//! Many jobs side by side: curves, what differs, measured curves, comparisons that are kept.
#![allow(clippy::float_cmp, reason = "these numbers are exact")]
use loadframe_api::worker::Lease;
use serde_json::{Value, json};
use uuid::Uuid;

use crate::people::group::{id_of, ids};
use crate::support::{Lab, example};

/// Submits the quick example with a change to its spec; its id.
async fn submit(lab: &Lab, name: &str, change: impl FnOnce(&mut Value)) -> Uuid {
    let mut body: Value = serde_json::from_str(example()).expect("JSON");
    body["name"] = json!(name);
    body["tags"] = json!(["series"]);
    change(&mut body["spec"]);
    let answer = lab.post("/v1/jobs", &body.to_string()).await;
    assert_eq!(answer.status, 201, "{answer:?}");
    id_of(&answer.json())
}

/// A job of this height, with a curve of so many points.
async fn with_curve(
    lab: &Lab,
    name: &str,
    points: u64,
    height: impl Fn(u64) -> f64,
) -> (Uuid, Lease) {
    let id = submit(lab, name, |_| {}).await;
    let lease = lab.claim().await;
    assert_eq!(lease.job_id, id);
    for first in (0..points).step_by(9_000) {
        let rows =
            (first..points.min(first + 9_000)).map(|index| vec![index as f64, height(index)]);
        lab.report(&lease, first, rows.collect()).await;
    }
    (id, lease)
}

fn joined(ids: &[Uuid]) -> String {
    let texts: Vec<String> = ids.iter().map(|id| id.simple().to_string()).collect();
    texts.join(",")
}

fn numbers(value: &Value) -> Vec<f64> {
    let all = value.as_array().expect("numbers").iter();
    all.map(|one| one.as_f64().expect("a number")).collect()
}

#[tokio::test]
async fn only_what_differs_is_listed_with_units_and_all_results() {
    let lab = Lab::open().await;
    let first = lab.finished(&[]).await;
    let stiff = submit(&lab, "stiff", |spec| {
        spec["bond"]["modulus_n"] = json!(0.5);
        spec["seed"] = json!(7);
    });
    let stiff = stiff.await;
    let absent = Uuid::from_u128(404);
    let path = format!(
        "/v1/differences?jobs={}",
        joined(&[stiff, absent, first, stiff])
    );
    let answer = lab.get(&path).await.json();
    assert_eq!(answer["missing"], json!([absent]));
    let order: Vec<&Value> = answer["jobs"]
        .as_array()
        .expect("jobs")
        .iter()
        .map(|job| &job["id"])
        .collect();
    assert_eq!(
        order,
        [&json!(stiff), &json!(first)],
        "in the order asked for, each once"
    );
    let fields = answer["fields"].as_array().expect("fields");
    let pointers: Vec<&Value> = fields.iter().map(|field| &field["pointer"]).collect();
    assert_eq!(pointers, ["/spec/seed", "/spec/bond/modulus_n"]);
    assert_eq!(fields[1]["unit"], "N");
    assert_eq!(fields[1]["values"][0], 0.5);
    assert_eq!(fields[0]["values"][0], 7);
    assert_eq!(fields[0].get("unit"), None);
    let expected = json!([{ "name": "max_force", "unit": "N", "values": [null, 12.5] }]);
    assert_eq!(answer["results"], expected);
    assert_eq!(answer["jobs"][1]["columns"], json!(["strain", "force_n"]));
    assert_eq!(
        (&answer["jobs"][1]["points"], &answer["more"]),
        (&json!(2), &json!(false))
    );
}

#[tokio::test]
async fn curves_keep_ends_and_extremes_and_csv_has_all_points() {
    const POINTS: u64 = 20_000;
    let peak = |index: u64| {
        if index == 12_345 {
            99.0
        } else {
            (index % 7) as f64
        }
    };
    let lab = Lab::open().await;
    let (long, _) = with_curve(&lab, "long, \"quoted\"", POINTS, peak).await;
    let (short, _) = with_curve(&lab, "short", 3, |index| index as f64 / 4.0).await;
    let none = submit(&lab, "none", |_| {}).await;
    let path = format!(
        "/v1/curves?jobs={}&points=200",
        joined(&[long, short, none])
    );
    let answer = lab.get(&path).await.json();
    let curves = answer["curves"].as_array().expect("curves");
    assert_eq!(curves.len(), 2);
    assert_eq!(answer["without"], json!([none]));
    let (x, y) = (numbers(&curves[0]["x"]), numbers(&curves[0]["y"]));
    assert!(
        (50..=200).contains(&x.len()) && x.len() == y.len(),
        "{}",
        x.len()
    );
    assert_eq!((x[0], x[x.len() - 1]), (0.0, (POINTS - 1) as f64));
    let at = x
        .iter()
        .position(|x| *x == 12_345.0)
        .expect("the peak is kept");
    assert_eq!(y[at], 99.0);
    assert_eq!(curves[0]["of_points"], POINTS);
    assert_eq!(curves[1]["y"], json!([0.0, 0.25, 0.5]));

    let swapped = lab
        .get(&format!("/v1/curves?jobs={short}&over=force_n&of=strain"))
        .await
        .json();
    assert_eq!(swapped["curves"][0]["x"], json!([0.0, 0.25, 0.5]));
    let foreign = lab
        .get(&format!("/v1/curves?jobs={short}&of=no_such"))
        .await
        .json();
    assert_eq!(foreign["without"], json!([short]));

    let csv = lab
        .get(&format!(
            "/v1/curves.csv?jobs={}",
            joined(&[long, short, none])
        ))
        .await;
    let text = csv.text();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("job,name,strain,force_n"));
    assert_eq!(
        lines.next(),
        Some(&*format!("{long},\"long, \"\"quoted\"\"\",0,0"))
    );
    assert_eq!(text.lines().count() as u64, 1 + POINTS + 3);
    assert_eq!(text.lines().last(), Some(&*format!("{short},short,2,0.5")));
}

#[tokio::test]
async fn jobs_are_chosen_in_one_way() {
    let lab = Lab::open().await;
    let id = submit(&lab, "one", |_| {}).await;
    submit(&lab, "other", |_| {}).await;
    for query in ["", &format!("jobs={id}&tag=series")] {
        let answer = lab.get(&format!("/v1/differences?{query}")).await;
        let problem = answer.problem(422, "invalid-request");
        assert_eq!(problem["violations"][0]["code"], "one_choice");
    }
    for (query, count) in [
        ("tag=series", 2),
        ("q=other", 1),
        ("kind=nonwoven_tensile", 2),
        ("tag=none", 0),
    ] {
        let answer = lab.get(&format!("/v1/differences?{query}")).await.json();
        assert_eq!(
            answer["jobs"].as_array().map(Vec::len),
            Some(count),
            "{query}"
        );
    }
    assert_eq!(lab.get("/v1/differences?jobs=nonsense").await.status, 400);
    assert_eq!(
        lab.get("/v1/differences?tag=series&points=100")
            .await
            .status,
        400
    );
    let many = joined(&vec![id; 1001]);
    assert_eq!(
        lab.get(&format!("/v1/curves?jobs={many}")).await.status,
        400
    );
    let most = joined(&vec![id; 1000]);
    assert_eq!(
        lab.get(&format!("/v1/curves?jobs={most}")).await.status,
        200
    );
}

#[tokio::test]
async fn a_measured_curve_is_read_by_name_and_unit() {
    let lab = Lab::open().await;
    let text = "Test report;\nStrain [%];Force [kN]\n0;0\n1,5;0,25\n";
    let body = json!({ "csv": text, "columns": ["nominal_strain", "force_n"] }).to_string();
    let answer = lab.post("/v1/curves/measured", &body).await.json();
    assert_eq!(
        (&answer["x"], &answer["y"]),
        (&json!([0.0, 0.015]), &json!([0.0, 250.0]))
    );
    assert!(
        answer["read_as"]
            .as_array()
            .is_some_and(|words| !words.is_empty())
    );
    for (body, pointer) in [
        (json!({ "columns": ["nominal_strain", "force_n"] }), "/csv"),
        (json!({ "csv": text }), "/columns"),
        (
            json!({ "csv": "no table at all", "columns": ["nominal_strain", "force_n"] }),
            "/csv",
        ),
    ] {
        let answer = lab.post("/v1/curves/measured", &body.to_string()).await;
        let problem = answer.problem(422, "invalid-request");
        assert_eq!(problem["violations"][0]["pointer"], pointer, "{body}");
    }
}

#[tokio::test]
async fn a_comparison_is_kept_under_a_name_and_its_jobs_never_change() {
    let lab = Lab::open().await;
    let [one, other] = [
        submit(&lab, "one", |_| {}).await,
        submit(&lab, "other", |_| {}).await,
    ];
    let new = json!({ "name": " bonds ", "jobs": [other, one], "view": "per=width" });
    let made = lab.post("/v1/comparisons", &new.to_string()).await;
    assert_eq!(made.status, 201, "{made:?}");
    let id = id_of(&made.json());
    let path = format!("/v1/comparisons/{id}");
    let read = lab.get(&path).await.json();
    assert_eq!(
        (&read["name"], &read["view"]),
        (&json!("bonds"), &json!("per=width"))
    );
    assert_eq!(read["jobs"], json!([other, one]));
    assert_eq!(ids(&lab.get("/v1/comparisons").await.json()), [id]);

    let differences = lab
        .get(&format!("/v1/differences?comparison={id}"))
        .await
        .json();
    assert_eq!(differences["jobs"][0]["id"], json!(other));
    lab.store.delete(other).await.expect("deleted");
    let differences = lab
        .get(&format!("/v1/differences?comparison={id}"))
        .await
        .json();
    assert_eq!(differences["missing"], json!([other]));

    let patched = lab
        .send(crate::support::request(
            "PATCH",
            &path,
            &[crate::support::JSON],
            r#"{"name": "ties"}"#,
        ))
        .await;
    assert_eq!(
        (patched.status, &patched.json()["name"]),
        (200, &json!("ties"))
    );
    let jobs = lab
        .send(crate::support::request(
            "PATCH",
            &path,
            &[crate::support::JSON],
            r#"{"jobs": []}"#,
        ))
        .await;
    jobs.problem(422, "invalid-request");
    let gone = lab
        .send(crate::support::request("DELETE", &path, &[], ""))
        .await;
    assert_eq!((gone.status, lab.get(&path).await.status), (204, 404));
    let missing = lab.get(&format!("/v1/curves?comparison={id}")).await;
    assert_eq!(
        missing.problem(404, "not-found")["detail"],
        format!("there is no comparison {id}")
    );
}

#[tokio::test]
async fn what_cannot_be_kept_is_told_by_its_field() {
    let lab = Lab::open().await;
    let id = submit(&lab, "one", |_| {}).await;
    let absent = Uuid::from_u128(404);
    for (body, pointer) in [
        (json!({ "name": "a", "jobs": [] }), "/jobs"),
        (json!({ "name": "a", "jobs": [id, absent] }), "/jobs/1"),
        (json!({ "name": "a", "jobs": [id, id] }), "/jobs/1"),
        (json!({ "name": " ", "jobs": [id] }), "/name"),
        (json!({ "name": "a", "jobs": [id], "owner": id }), "/owner"),
    ] {
        let answer = lab.post("/v1/comparisons", &body.to_string()).await;
        let problem = answer.problem(422, "invalid-request");
        assert_eq!(problem["violations"][0]["pointer"], pointer, "{body}");
    }
}
