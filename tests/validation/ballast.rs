//! The page of the ballast is what its prose and the committed data give, and these are what the
//! engine computes: one of its studies in part again.
use loadframe_tests::loadframe;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/validation/ballast");
/// The cheapest study, of which the first value takes some nine seconds: an oedometer, five beds.
const STUDY: &str = include_str!("../../api/studies/ballast_oedometer_stiffness_ratio.json");
const KEPT: &str = include_str!("ballast/data/oedometer_stiffness_ratio.json");
const VARIED: &str = "/materials/aggregate/stiffness_ratio";
/// Between equal numbers of which one was written as text.
const ROUND_OFF: f64 = 1e-9;

#[test]
fn ballast_page_is_what_prose_and_data_give() {
    let page = Path::new(HERE).join("page");
    let checked = Command::new("python3").arg(page).arg("--check").output();
    let checked = checked.expect("python3 is needed, which writes the page");
    assert!(
        checked.status.success(),
        "tests/validation/ballast/page writes it again: {}",
        String::from_utf8_lossy(&checked.stderr)
    );
}

#[test]
fn ballast_data_are_what_the_engine_computes() {
    let kept: Value = serde_json::from_str(KEPT).unwrap();
    let kept = &kept["cases"][0];
    let mut study: Value = serde_json::from_str(STUDY).unwrap();
    study["vary"][VARIED] = json!([study["vary"][VARIED][0]]);
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("study.json");
    std::fs::write(&file, study.to_string()).unwrap();
    let mut command = loadframe();
    command.args(["study", "parameters", "--json"]).arg(&file);
    let output = command.arg("--out").arg(folder.path().join("out"));
    let output = output.output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let found = &found["cases"][0];
    let label = format!("stiffness_ratio = {}", kept["label"].as_str().unwrap());
    assert_eq!(found["label"], label);
    for (name, kept) in kept["results"].as_object().unwrap() {
        for part in ["mean", "deviation"] {
            let [kept, found] =
                [kept, &found["results"][name]].map(|result| result[part].as_f64().unwrap());
            assert!(
                (kept - found).abs() <= ROUND_OFF * kept.abs(),
                "{part} of {name}: the page tells {kept}, the engine computes {found}; \
                 tests/validation/ballast/page --run renews it"
            );
        }
    }
}
