//! The examples run to their ends, and believe themselves.
use loadframe_api::{JobKind, Submission};
use loadframe_physics::{Ending, Uninterrupted};

use super::scene::{Record, run_job};

#[test]
fn every_example_ends_without_a_warning() {
    for example in JobKind::GranularScene.examples() {
        let submission =
            Submission::from_slice(example.body.as_bytes()).expect("examples are valid");
        let mut record = Record::default();
        let ending = run_job(&submission.spec, &mut record, &Uninterrupted, None, 1);
        let Ok(Ending::Finished(report)) = ending else {
            panic!("{}: {ending:?}", example.name)
        };
        assert!(
            report.warnings.is_empty(),
            "{}: {:?}",
            example.name,
            report.warnings
        );
        if let Some(broken) = report.summary.get("broken_bonds") {
            let (broken, bonds) = (broken.value, report.summary["bonds"].value);
            assert!(
                broken > Some(0.0) && broken < bonds,
                "{broken:?} of {bonds:?}"
            );
        }
    }
}
