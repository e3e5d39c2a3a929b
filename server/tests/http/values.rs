//! Lists by what specs and results say.
use loadframe_api::JobKind;
use loadframe_api::people::Visibility;
use serde_json::{Value, json};
use uuid::Uuid;

use crate::people::group::{Group, id_of, ids};
use crate::support::{Lab, example};

fn with_seed(seed: u64, strain_step: f64) -> String {
    let mut job: Value = serde_json::from_str(example()).expect("JSON");
    job["spec"]["seed"] = json!(seed);
    job["spec"]["test"]["strain_step"] = json!(strain_step);
    job.to_string()
}

/// Jobs with these seeds, the first submitted first.
async fn seeded(lab: &Lab, seeds: &[u64]) -> Vec<Uuid> {
    let mut jobs = Vec::new();
    for seed in seeds {
        let answer = lab
            .post("/v1/jobs", &with_seed(*seed, 0.01 * *seed as f64))
            .await;
        assert_eq!(answer.status, 201, "{answer:?}");
        jobs.push(id_of(&answer.json()));
    }
    jobs
}

fn encoded(text: &str) -> String {
    url::form_urlencoded::byte_serialize(text.as_bytes()).collect()
}

async fn listed(lab: &Lab, name: &str, text: &str) -> Vec<Uuid> {
    let answer = lab.get(&format!("/v1/jobs?{name}={}", encoded(text))).await;
    assert_eq!(answer.status, 200, "{text}: {answer:?}");
    ids(&answer.json())
}

#[tokio::test]
async fn a_list_is_filtered_and_sorted_by_values_of_specs() {
    let lab = Lab::open().await;
    let jobs = seeded(&lab, &[2, 9, 4]).await;
    let [two, nine, four] = [jobs[0], jobs[1], jobs[2]];
    for (conditions, expected) in [
        ("/spec/seed=4", &[four][..]),
        ("/spec/seed!=4", &[nine, two]),
        ("/spec/seed>=4", &[four, nine]),
        ("/spec/seed<4", &[two]),
        ("/spec/seed>=4,/spec/test/strain_step<0.05", &[four]),
        ("/spec/seed>4.5", &[nine]),
        // of another type, or not there
        ("/spec/seed=four", &[]),
        ("/spec/no_such_field=1", &[]),
        ("/spec/no_such_field!=1", &[]),
        ("/spec/fabric/lattice/spacing_mm/0>0", &[four, nine, two]),
        ("/summary/max_force>0", &[]),
    ] {
        assert_eq!(
            listed(&lab, "where", conditions).await,
            expected,
            "{conditions}"
        );
    }
    assert_eq!(listed(&lab, "sort", "/spec/seed").await, [two, four, nine]);
    assert_eq!(listed(&lab, "sort", "-/spec/seed").await, [nine, four, two]);
    // what has no value comes last, the newest first
    assert_eq!(
        listed(&lab, "sort", "-/summary/max_force").await,
        [four, nine, two]
    );
    let page = lab
        .get("/v1/jobs?where=/spec/seed%3E1&limit=2")
        .await
        .json();
    assert_eq!(
        (ids(&page), &page["stopped_after"]),
        (vec![four, nine], &Value::Null)
    );
    let next = page["next"].as_str().expect("another page");
    let page = lab
        .get(&format!(
            "/v1/jobs?where=/spec/seed%3E1&limit=2&cursor={next}"
        ))
        .await
        .json();
    assert_eq!((ids(&page), &page["next"]), (vec![two], &Value::Null));
    let page = lab.get("/v1/jobs?sort=-/spec/seed&limit=2").await.json();
    let next = page["next"].as_str().expect("another page");
    let page = lab
        .get(&format!("/v1/jobs?sort=-/spec/seed&limit=2&cursor={next}"))
        .await
        .json();
    assert_eq!((ids(&page), &page["next"]), (vec![two], &Value::Null));
}

#[tokio::test]
async fn a_list_shows_values_of_specs_with_their_units() {
    let lab = Lab::open().await;
    seeded(&lab, &[7]).await;
    let show = "/spec/seed,/spec/fabric/lattice/spacing_mm,/spec/fabric/lattice/spacing_mm/0,/spec/bond/modulus_n,/spec/none,/spec/bond";
    let page = lab.get(&format!("/v1/jobs?show={show}")).await.json();
    let values = &page["items"][0]["values"];
    assert_eq!(values["/spec/seed"], json!({ "value": 7 }));
    assert_eq!(
        values["/spec/fabric/lattice/spacing_mm"]["value"],
        "3 entries"
    );
    assert_eq!(values["/spec/fabric/lattice/spacing_mm/0"]["unit"], "mm");
    assert_eq!(values["/spec/bond/modulus_n"]["unit"], "N");
    assert!(values["/spec/bond/modulus_n"]["value"].is_f64());
    assert_eq!(values["/spec/bond"]["value"], "an object");
    assert_eq!(values.get("/spec/none"), None);
    let fields = lab.get("/v1/fields?kind=nonwoven_tensile").await.json();
    let fields = fields["items"].as_array().expect("fields");
    let modulus = fields
        .iter()
        .find(|of| of["pointer"] == "/spec/bond/modulus_n");
    assert_eq!(
        modulus.expect("a field"),
        &json!({ "pointer": "/spec/bond/modulus_n", "unit": "N", "jobs": 1 })
    );
}

#[tokio::test]
async fn results_are_sorted_and_filtered_by() {
    let lab = Lab::open().await;
    let done = lab.finished(&[]).await;
    let waiting = lab.submit().await;
    let job = lab.get(&format!("/v1/jobs/{done}")).await.json();
    let (name, quantity) = job["summary"]
        .as_object()
        .expect("results")
        .iter()
        .next()
        .expect("one");
    let value = quantity["value"].as_f64().expect("a number");
    let below = format!("/summary/{name}<{}", value + 1.0);
    assert_eq!(listed(&lab, "where", &below).await, [done]);
    let above = format!("/summary/{name}>{value}");
    assert!(listed(&lab, "where", &above).await.is_empty());
    assert_eq!(
        listed(&lab, "sort", &format!("/summary/{name}")).await,
        [done, waiting]
    );
    let fields = lab.get("/v1/fields").await.json();
    let result = fields["items"]
        .as_array()
        .expect("fields")
        .iter()
        .find(|of| of["pointer"] == format!("/summary/{name}"));
    assert_eq!(result.expect("a result")["unit"], quantity["unit"]);
}

#[tokio::test]
async fn what_is_no_pointer_is_refused_in_a_sentence() {
    let lab = Lab::open().await;
    for (query, words) in [
        ("where=/spec/seed", "is not a pointer, one of"),
        ("where=/name%3Dx", "is not /spec/"),
        ("where=/spec/a%3Cb", "only numbers are less or more"),
        ("sort=seed12", "is not /spec/"),
        ("sort=/spec/a,/spec/b", "sort: 2 values, of at most 1"),
        ("show=/spec", "is not /spec/"),
        ("show=/spec/a%22b", "without quotes"),
        ("show=/spec/a%0Ab", "control characters"),
        ("show=/spec/a~2b", "~ as ~0"),
        ("sort=/spec/a/4294967296", "up to 9 digits"),
        ("where=/spec/seed%3D1e999", "beyond 1.8e308"),
        ("where=/spec/seed%3E-1e999", "beyond 1.8e308"),
        ("where=/spec/seed%3CNaN", "only numbers are less or more"),
        ("where=/spec/seed%3D%3D3", "is not a pointer, one of"),
        ("where=/spec/a%3Dx%00y", "zero character"),
        (
            "where=/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1,/spec/a%3D1",
            "11 values, of at most 10",
        ),
    ] {
        let answer = lab.get(&format!("/v1/jobs?{query}")).await;
        let problem = answer.problem(422, "invalid-request");
        let detail = problem["detail"].as_str().expect("a sentence");
        assert!(detail.contains(words), "{query}: {detail}");
    }
    lab.get("/v1/jobs?sort=/spec/seed&cursor=7")
        .await
        .problem(422, "invalid-request");
}

#[tokio::test]
async fn whatever_a_text_or_a_name_holds_is_compared_as_it_is() {
    let lab = Lab::open().await;
    let names = ["a/b", "a~b", "50 %", "x_y", "it's", "[*]", "é", "0", "007"];
    let mut materials = serde_json::Map::new();
    let mut job: Value =
        serde_json::from_str(JobKind::CompositeBending.examples()[0].body).expect("JSON");
    for (place, name) in names.iter().enumerate() {
        materials.insert(
            (*name).to_owned(),
            json!({ "isotropic": { "youngs_modulus_mpa": 10 + place, "poisson_ratio": 0.3 } }),
        );
    }
    let given = job["spec"]["materials"].as_object_mut().expect("materials");
    given.append(&mut materials);
    let answer = lab.post("/v1/jobs", &job.to_string()).await;
    assert_eq!(answer.status, 201, "{answer:?}");
    let id = id_of(&answer.json());
    for (place, name) in names.iter().enumerate() {
        let part = name.replace('~', "~0").replace('/', "~1");
        let pointer = format!("/spec/materials/{part}/isotropic/youngs_modulus_mpa");
        let found = listed(&lab, "where", &format!("{pointer}={}", 10 + place)).await;
        // a whole number is a place in a list, and there is none
        let expected = if *name == "0" { vec![] } else { vec![id] };
        assert_eq!(found, expected, "{name}");
        assert_eq!(listed(&lab, "sort", &pointer).await, [id], "{name}");
    }
    for text in [
        "fill%",
        "fill_r",
        "'",
        "filler' OR '1'='1",
        "filler",
        "\"filler\"",
    ] {
        let found = listed(&lab, "where", &format!("/spec/matrix={text}")).await;
        let is_it = text.trim_matches('"') == "filler";
        assert_eq!(found.len(), usize::from(is_it), "{text}");
    }
}

#[tokio::test]
async fn values_of_others_are_not_found_by_searching() {
    let group = Group::open().await;
    let project = group
        .project(&group.anna, Visibility::Private, None)
        .await
        .id;
    let path = format!("/v1/jobs?project={project}");
    let job = id_of(
        &group
            .send(&group.anna, "POST", &path, &with_seed(77, 0.02))
            .await
            .json(),
    );
    for query in [
        "where=/spec/seed%3D77",
        "sort=/spec/seed",
        "show=/spec/seed",
    ] {
        let list = format!("/v1/jobs?{query}");
        assert_eq!(ids(&group.get(&group.anna, &list).await.json()), [job]);
        assert!(
            ids(&group.get(&group.bert, &list).await.json()).is_empty(),
            "{query}"
        );
    }
    assert_eq!(
        group.get(&group.bert, "/v1/fields").await.json()["items"],
        json!([])
    );
    assert_ne!(
        group.get(&group.anna, "/v1/fields").await.json()["items"],
        json!([])
    );
}
