//! What a test of one fibre takes: factors of a narrow band.
use super::{PaperTensile, SingleFibreLoad, Specimen};
use crate::fibre::divide;
use crate::{Calibration, Estimate};

/// One entry of a block of two rings in a factor, in evaluations of one bond, and the constants of
/// the fibre, which are measured on 40 segments.
const FACTOR: f64 = 0.05;
const MEASURED_RINGS: f64 = 120.0;
/// Factors of a step of a large displacement.
const NEWTON_ROUNDS: f64 = 6.0;
/// Memory of the process and of one entry of the factor [MB].
const PROCESS_MB: f64 = 20.0;
const ENTRY_MB: f64 = 24e-6;
/// A point with its springs in a picture [MB].
const POINT_MB: f64 = 300e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.02;

pub(super) fn estimate(spec: &PaperTensile, calibration: &Calibration) -> Estimate {
    let Specimen::SingleFibre(fibre) = &spec.specimen;
    let points_on_ring = f64::from(spec.model.points_on_ring);
    let rings = spec
        .pulp_of(fibre)
        .and_then(|pulp| {
            let (section, elasticity) = (pulp.section().ok()?, pulp.elasticity().ok()?);
            let division = spec.model.division();
            divide(1e3 * pulp.length_mm, &section, &elasticity, &division).ok()
        })
        .map_or(0.0, |divided| divided.segments as f64 + 1.0);
    let steps = f64::from(spec.accuracy.knobs().load_steps);
    let factors = match fibre.load {
        SingleFibreLoad::Pull => NEWTON_ROUNDS * steps,
        SingleFibreLoad::Twist | SingleFibreLoad::Bend => 1.0,
        SingleFibreLoad::Buckle => 4.0,
    };
    let per_ring = (3.0 * points_on_ring).powi(3);
    let work = FACTOR * per_ring * (rings * (factors + 2.0) + MEASURED_RINGS);
    let pictures = match (spec.output.snapshot_every_steps, fibre.load) {
        (0, _) => 0.0,
        (every, SingleFibreLoad::Pull) => 1.0 + (steps / f64::from(every)).floor(),
        _ => 1.0,
    };
    Estimate {
        wall_s: START_S + work / calibration.bond_evaluations_per_s,
        memory_mb: PROCESS_MB + 2.0 * rings * (3.0 * points_on_ring).powi(2) * ENTRY_MB,
        disk_mb: pictures * rings * points_on_ring * POINT_MB,
        calibrated: false,
    }
}
