//! What can be tested.
use loadframe_api::{JobKind, kind_schema};

use crate::support::Lab;

#[tokio::test]
async fn every_kind_has_a_schema_and_examples_that_are_accepted() {
    let lab = Lab::open().await;
    let kinds = lab.get("/v1/kinds").await.json();
    let kinds = kinds["items"].as_array().expect("items").clone();
    assert_eq!(kinds.len(), JobKind::ALL.len());
    for (kind, view) in JobKind::ALL.iter().zip(kinds) {
        assert_eq!(view["kind"], kind.name());
        let link = |name: &str| view["links"][name].as_str().expect("a link").to_owned();
        assert_eq!(lab.get(&link("self")).await.json(), view);
        let schema = lab.get(&link("schema")).await;
        assert_eq!(schema.header("content-type"), "application/schema+json");
        assert_eq!(&schema.json(), kind_schema(*kind));
        let examples = lab.get(&link("examples")).await.json();
        let examples = examples["items"].as_array().expect("items").clone();
        assert_eq!(examples.len(), kind.examples().len());
        for example in examples {
            assert_eq!(example["title"], example["job"]["name"]);
            let accepted = lab
                .post("/v1/jobs?dry_run=true", &example["job"].to_string())
                .await;
            assert_eq!(accepted.status, 200, "{accepted:?}");
        }
    }
    lab.get("/v1/kinds/sorcery").await.problem(404, "not-found");
    lab.get("/v1/kinds/sorcery/schema")
        .await
        .problem(404, "not-found");
    lab.get("/v1/kinds/sorcery/examples")
        .await
        .problem(404, "not-found");
}
