//! The document against itself and against the router.
use std::fs;

use serde_json::{Value, json};

use crate::support::{Lab, request};

fn each(node: &Value, see: &mut impl FnMut(&serde_json::Map<String, Value>)) {
    match node {
        Value::Object(map) => {
            see(map);
            map.values().for_each(|child| each(child, see));
        }
        Value::Array(items) => items.iter().for_each(|child| each(child, see)),
        _ => {}
    }
}

#[tokio::test]
async fn every_reference_leads_somewhere() {
    let document = Lab::open().await.get("/openapi.json").await.json();
    assert_eq!(document["openapi"], "3.1.0");
    let mut count = 0;
    each(&document, &mut |map| {
        let mapping = map.get("discriminator").map(|of| &of["mapping"]);
        let mapped = mapping
            .and_then(Value::as_object)
            .into_iter()
            .flat_map(|of| of.values());
        for target in map
            .get("$ref")
            .into_iter()
            .chain(mapped)
            .filter_map(Value::as_str)
        {
            let pointer = target.strip_prefix('#').expect("within the document");
            assert!(document.pointer(pointer).is_some(), "{target}");
            count += 1;
        }
    });
    assert!(count > 50, "{count} references");
}

#[tokio::test]
async fn every_documented_operation_is_routed_and_no_other_method_is() {
    let lab = Lab::open().await;
    let document = lab.get("/openapi.json").await.json();
    let paths = document["paths"].as_object().expect("paths");
    assert!(paths.len() > 25, "{} paths", paths.len());
    for (path, item) in paths {
        let sample = path.replace("{name}", "a.csv").replace("{kind}", "sorcery");
        let sample = sample.replace("{id}", "00000000-0000-4000-8000-000000000000");
        // TRACE is never routed, so that the answer names what is
        let answer = lab.send(request("TRACE", &sample, &[], "")).await;
        answer.problem(405, "method-not-allowed");
        let mut routed: Vec<&str> = answer
            .header("allow")
            .split(',')
            .filter(|of| *of != "HEAD")
            .collect();
        routed.sort_unstable();
        let documented = item.as_object().expect("an item").keys();
        let mut documented: Vec<String> = documented.map(|method| method.to_uppercase()).collect();
        documented.sort_unstable();
        assert_eq!(routed, documented, "{path}");
    }
}

#[tokio::test]
async fn every_operation_says_how_it_can_fail() {
    let document = Lab::open().await.get("/openapi.json").await.json();
    let mut operations = std::collections::BTreeSet::new();
    for (path, item) in document["paths"].as_object().expect("paths") {
        for (method, operation) in item.as_object().expect("an item") {
            let id = operation["operationId"].as_str().expect("an id");
            assert!(operations.insert(id.to_owned()), "{id} is there twice");
            assert!(operation["summary"].is_string(), "{method} {path}");
            let answers = operation["responses"].as_object().expect("answers");
            assert!(
                answers.keys().any(|status| status.starts_with(['2', '3'])),
                "{method} {path}"
            );
            for (status, answer) in answers
                .iter()
                .filter(|(status, _)| status.starts_with(['4', '5']))
            {
                let schema = &answer["content"]["application/problem+json"]["schema"]["$ref"];
                assert_eq!(
                    schema, "#/components/schemas/Problem",
                    "{method} {path} {status}"
                );
            }
            if path.contains('{') {
                assert!(
                    answers.contains_key("404") || path.contains("/worker/"),
                    "{method} {path}"
                );
            }
            let guarded = path.starts_with("/v1/") || path == "/metrics";
            assert_eq!(answers.contains_key("401"), guarded, "{method} {path}");
        }
    }
}

#[tokio::test]
async fn the_example_bodies_are_accepted() {
    let lab = Lab::open().await;
    let document = lab.get("/openapi.json").await.json();
    let body = &document["paths"]["/v1/jobs"]["post"]["requestBody"];
    let examples = &body["content"]["application/json"]["examples"];
    let examples = examples.as_object().expect("examples");
    assert!(!examples.is_empty());
    for example in examples.values() {
        let body = example["value"].to_string();
        let answer = lab.post("/v1/jobs", &body).await;
        assert_eq!(answer.status, 201, "{answer:?}");
    }
}

#[tokio::test]
async fn a_submission_leads_to_what_can_be_done_with_the_job() {
    let document = Lab::open().await.get("/openapi.json").await.json();
    let links = &document["paths"]["/v1/jobs"]["post"]["responses"]["201"]["links"];
    for id in ["read_job", "cancel_job", "read_curve", "download_archive"] {
        assert_eq!(links[id]["operationId"], id);
    }
}

#[tokio::test]
async fn a_submission_is_one_named_variant_for_each_kind() {
    let document = Lab::open().await.get("/openapi.json").await.json();
    let schemas = &document["components"]["schemas"];
    let submission = &schemas["Submission"];
    assert_eq!(submission["discriminator"]["propertyName"], "kind");
    for kind in loadframe_api::JobKind::ALL {
        let target = submission["discriminator"]["mapping"][kind.name()].as_str();
        let variant = document
            .pointer(&target.expect("a variant")[1..])
            .expect("its schema");
        assert_eq!(variant["properties"]["kind"]["const"], kind.name());
        assert_eq!(variant["additionalProperties"], false);
        assert_eq!(
            variant["examples"].as_array().map(Vec::len),
            Some(kind.examples().len())
        );
    }
}

/// What the page's types are made from.
const PAGE_COPY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/page/openapi.json");

/// The document without the specs of the kinds and without example jobs: the page reads those when it
/// runs, so that a word changed in a spec does not change the page.
fn page_document() -> Value {
    let document = loadframe_server::http::document().expect("a document");
    let mut document = document.clone();
    let submit = &mut document["paths"]["/v1/jobs"]["post"]["requestBody"]["content"];
    let body = submit["application/json"].as_object_mut().expect("a body");
    body.remove("examples");
    let schemas = &mut document["components"]["schemas"];
    let variants = schemas["Submission"]["oneOf"].as_array().cloned();
    for variant in variants.expect("variants") {
        let submission = &mut schemas[schema_name(&variant)];
        let fields = submission.as_object_mut().expect("a schema");
        fields.remove("examples");
        let spec = schema_name(&fields["properties"]["spec"]).to_owned();
        schemas[spec] = json!({ "type": "object" });
    }
    document
}

fn schema_name(reference: &Value) -> &str {
    let target = reference["$ref"].as_str().expect("a reference");
    target.rsplit('/').next().unwrap_or(target)
}

#[test]
fn the_page_has_the_types_of_this_server() {
    let text = serde_json::to_string_pretty(&page_document()).expect("JSON") + "\n";
    if std::env::var("LOADFRAME_WRITE").as_deref() == Ok("openapi") {
        fs::write(PAGE_COPY, &text).expect("the copy is written");
    }
    let copy = fs::read_to_string(PAGE_COPY).unwrap_or_default();
    // both are too long to be shown
    assert!(
        copy == text,
        "server/page/openapi.json is out of date. Write it with \
         `LOADFRAME_WRITE=openapi cargo test -p loadframe-server --test http openapi`, \
         then the page's types with `npm run types` in server/page"
    );
}

#[tokio::test]
async fn what_is_always_sent_is_required() {
    let document = Lab::open().await.get("/openapi.json").await.json();
    let required = |name: &str| document["components"]["schemas"][name]["required"].to_string();
    assert!(required("JobView").contains("\"eta_s\""));
    assert!(
        !required("JobView").contains("\"spec\""),
        "only on a single job"
    );
    assert!(required("Quantity").contains("\"value\""));
    assert!(required("JobViewPage").contains("\"next\""));
    let deviation = &document["components"]["schemas"]["Quantity"]["properties"]["deviation"];
    assert_eq!(deviation["type"], "number", "left out, never null");
    // what a client may leave out is not required
    assert!(!required("ClaimRequest").contains("\"calibration\""));
    assert!(!required("ProgressReport").contains("\"log\""));
}
