//! The same spec gives the same bytes on any number of threads.
#![allow(clippy::unwrap_used, reason = "tests stop at what is unexpected")]
use loadframe_tests::run_alone;
use serde_json::{Value, json};

const EXAMPLES: [&str; 4] = [
    include_str!("../api/examples/nonwoven_tensile.json"),
    include_str!("../api/examples/nonwoven_tensile_network.json"),
    include_str!("../api/examples/nonwoven_tensile_quick.json"),
    include_str!("../api/examples/nonwoven_tensile_repeats.json"),
];

#[test]
fn one_two_three_and_eight_threads_give_the_same_bytes() {
    let folder = tempfile::TempDir::new().unwrap();
    for (number, example) in EXAMPLES.into_iter().enumerate() {
        let body: Value = serde_json::from_str(example).unwrap();
        let run = |threads: u32| {
            run_alone(
                &body,
                threads,
                &folder.path().join(format!("{number}-{threads}")),
            )
        };
        let alone = run(1);
        assert!(alone.sums.contains_key("curve.csv"), "{alone:?}");
        for threads in [2, 3, 8] {
            assert_eq!(
                run(threads),
                alone,
                "{} with {threads} threads",
                body["name"]
            );
        }
    }
}

/// The thesis' relaxations as well, on a fabric they do not take minutes for.
#[test]
fn relaxations_too() {
    let folder = tempfile::TempDir::new().unwrap();
    for solver in ["sequential", "parallel"] {
        let mut body: Value = serde_json::from_str(EXAMPLES[2]).unwrap();
        body["spec"]["accuracy"] = json!({"solver": solver, "force_accuracy": 10});
        let run = |threads| {
            run_alone(
                &body,
                threads,
                &folder.path().join(format!("{solver}-{threads}")),
            )
        };
        assert_eq!(run(3), run(1), "{solver}");
    }
}
