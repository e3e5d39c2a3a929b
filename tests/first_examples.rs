//! The first example of every kind, which a user starts from, ends without a warning.
#![allow(clippy::unwrap_used, reason = "tests stop at what is unexpected")]
use loadframe_api::{JobKind, Outcome};
use loadframe_tests::run_alone;

#[test]
fn the_first_example_of_every_kind_ends_without_a_warning() {
    let folder = tempfile::TempDir::new().unwrap();
    let mut warned = Vec::new();
    for kind in JobKind::ALL {
        let example = kind.examples().first().unwrap();
        assert_eq!(example.name, kind.name(), "a kind's name names its first");
        let body = serde_json::from_str(example.body).unwrap();
        let results = folder.path().join(example.name);
        run_alone(&body, 1, &results);
        let outcome = std::fs::read(results.join("outcome.json")).unwrap();
        let outcome: Outcome = serde_json::from_slice(&outcome).unwrap();
        let doubtful = outcome.quality.iter().filter(|(_, check)| !check.ok);
        warned.extend(doubtful.map(|(name, check)| format!("{kind}: {name} is {}", check.value)));
        let warnings = outcome.warnings.iter();
        warned.extend(warnings.map(|warning| format!("{kind}: {}", warning.detail)));
    }
    assert!(warned.is_empty(), "{warned:#?}");
}
