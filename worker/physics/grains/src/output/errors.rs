//! How wrong results may be for the time step, as measured before.
//!
//! `errors.json` is what `cargo run --release -p loadframe-physics --example stated_errors -- measure
//! granular_scene 40` prints; [`ErrorTable`] reads it. It holds what the energies at the end of scenes of
//! a few spheres on a plane, drawn at random, were off at levels of the time step over the critical one,
//! against a tenth of the finest preset, over the largest energy of the scene. Such scenes follow from
//! their start: they bounce, slide, roll and hit each other.
//!
//! What is not known here: beds, which a nanometre at the start makes other beds. How far they lie from
//! each other, seeds tell.
use loadframe_api::spec::granular_scene::{ContactLaw, GranularScene, Stage, TimeStep};
use loadframe_api::{Quantity, Report};
use loadframe_harness::{ErrorTable, Likeness};

use super::journal::Journal;
use crate::step::engine::Engine;

/// Bodies of the scenes that were measured, at most.
const MOST_BODIES: usize = 4;

const RESULTS: [(&str, &str); 2] = [
    ("kinetic_energy", "kinetic_energy"),
    ("elastic_energy", "elastic_energy"),
];

/// Gives energies the errors that are known of them. Returns why a scene like the measured ones has none.
pub(crate) fn add(
    report: &mut Report,
    spec: &GranularScene,
    engine: &Engine,
    journal: &Journal,
) -> Option<String> {
    if !is_measured(spec) || engine.model.has_driven_bodies {
        return None;
    }
    let table = match ErrorTable::read(include_str!("errors.json")) {
        Ok(table) => table,
        Err(error) => return Some(format!("results have no error: its table is none: {error}")),
    };
    let worst = journal.worst.with(&engine.state.seen);
    let step = match spec.time_step_s {
        TimeStep::Automatic(_) => spec.accuracy.knobs().critical_step_fraction,
        TimeStep::Given(_) => worst.step_ratio,
    };
    let critical = journal.time_step / worst.step_ratio;
    let traits = [
        ("critical_steps", engine.state.time / critical),
        ("largest_overlap_ratio", worst.overlap_ratio),
    ];
    // energies may be near nothing: what they are off is over the largest one
    let mut largest = Report::default();
    for (name, _) in RESULTS {
        let quantity = Quantity::new(journal.balance.scale, "J", "");
        largest.summary.insert(name.to_owned(), quantity);
    }
    let job = Likeness {
        traits: &traits,
        knobs: &[("time_step", step)],
        results: &RESULTS,
    };
    let words = table.add(&mut largest, &job);
    for (name, quantity) in largest.summary {
        if let (Some(known), Some(error)) = (report.summary.get_mut(&name), quantity.error) {
            *known = known.clone().with_error(error.parts);
        }
    }
    report.warnings.extend(largest.warnings);
    words
}

/// Spheres without cohesion or resistance to rolling, in linear contact with each other and with planes.
fn is_measured(spec: &GranularScene) -> bool {
    let has_spheres = spec.bodies.len() <= MOST_BODIES
        && spec.bodies.iter().all(|body| body.sphere.is_some())
        && spec.import.is_empty()
        && spec.generate.is_empty()
        && spec.facets.is_empty();
    let is_dry = spec.materials.values().all(|material| {
        material.rolling_resistance.is_none()
            && material.parallel_bond.is_none()
            && material.normal_cohesion_pa == 0.0
            && material.shear_cohesion_pa == 0.0
    });
    let runs = spec
        .stages
        .iter()
        .all(|stage| matches!(stage, Stage::Run(_)));
    has_spheres && is_dry && runs && spec.laws.contact == ContactLaw::Linear
}
