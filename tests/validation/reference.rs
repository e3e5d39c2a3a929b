//! What the engine must reproduce: near-exact solutions of the same fabric by a second program.
use crate::{QUANTITIES, Run};
use loadframe_tests::run_alone;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// What `tests/validation/prototype.py --out tests/validation/prototype.json` found: Newton's method
/// to 10⁻⁴ of the force limit, in a program that shares nothing with the engine. Its random streams
/// differ, so that only distributions can be compared.
#[derive(Deserialize)]
pub(crate) struct Prototype {
    pub(crate) results: Vec<Reference>,
}

/// A result over the seeds.
#[derive(Deserialize)]
pub(crate) struct Reference {
    pub(crate) jaws: String,
    pub(crate) quantity: String,
    pub(crate) mean: f64,
    /// Standard deviation.
    pub(crate) deviation: f64,
    /// Seeds.
    pub(crate) n: u32,
    /// Student's t beyond which two means of the same distribution lie apart once in a hundred
    /// times, by the seeds behind the deviation.
    student_99: f64,
}

impl Prototype {
    pub(crate) fn read() -> Self {
        serde_json::from_str(include_str!("prototype.json")).unwrap()
    }
}

/// The mean over the runs with these jaws.
pub(crate) fn mean(runs: &[Run], jaws: &str, quantity: &str) -> f64 {
    let index = QUANTITIES
        .iter()
        .position(|name| *name == quantity)
        .unwrap();
    let chosen = runs.iter().filter(|run| run.jaws == jaws);
    let values: Vec<f64> = chosen.map(|run| run.values[index]).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// Holds the means over seeds against the references.
///
/// # Panics
/// When one lies further off than the scatter over seeds allows.
pub(crate) fn check(runs: &[Run]) {
    let prototype = Prototype::read();
    let mut misses = Vec::new();
    for reference in &prototype.results {
        let Reference { jaws, quantity, .. } = reference;
        let found = mean(runs, jaws, quantity);
        let own_seeds = runs.iter().filter(|run| run.jaws == *jaws).count() as f64;
        let error = reference.deviation * (1.0 / own_seeds + 1.0 / f64::from(reference.n)).sqrt();
        let allowed = reference.student_99 * error;
        let off = found - reference.mean;
        let line = format!(
            "{jaws} {quantity}: {found:.4}, reference {:.4}, off {off:+.4} of ± {allowed:.4}",
            reference.mean
        );
        eprintln!("{line}");
        if off.abs() > allowed {
            misses.push(line);
        }
    }
    assert_eq!(
        prototype.results.len(),
        crate::JAWS.len() * QUANTITIES.len()
    );
    assert!(misses.is_empty(), "{misses:#?}");
}

/// Relative difference of two solutions that both end at a millionth of a bond's force.
const NEAR_EXACT: f64 = 1e-6;

/// Specimens that `prototype.py --specimens` wrote out bond by bond: where every node, bond and
/// strength is the same, so must be the order in which bonds break, and with it every result.
///
/// # Panics
/// When a result differs.
pub(crate) fn check_specimens() {
    #[derive(Deserialize)]
    struct Specimen {
        job: Value,
        found: BTreeMap<String, f64>,
    }
    let specimens: Vec<Specimen> = serde_json::from_str(include_str!("specimens.json")).unwrap();
    let folder = tempfile::TempDir::new().unwrap();
    assert_eq!(specimens.len(), crate::JAWS.len());
    for (number, Specimen { job, found }) in specimens.iter().enumerate() {
        let files = run_alone(job, 1, &folder.path().join(number.to_string()));
        for (name, expected) in found {
            let own = files.outcome["summary"][name]["value"].as_f64().unwrap();
            assert!(
                (own - expected).abs() <= NEAR_EXACT * expected,
                "{}: {name} {own}, the prototype finds {expected}",
                job["name"]
            );
        }
    }
}
