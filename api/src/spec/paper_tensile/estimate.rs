//! What a test takes: of one fibre factors of a narrow band, of a sheet a factor and a solution for
//! every break.
use super::sheet_checks::memory_of_given_mb;
use super::{Level, PaperTensile, SingleFibre, SingleFibreLoad, Specimen};
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
/// Of a sheet: bonds that break until the force has fallen; a solution's work for an entry of the
/// factor, a factor's, and breaks until the next, all in evaluations of one bond; laying a point.
const BROKEN_SHARE: f64 = 0.15;
const SOLUTION: f64 = 0.3;
const FACTOR_OF_ENTRY: f64 = 0.02;
const EVENTS_PER_FACTOR: f64 = 30.0;
const POINT_LAID: f64 = 300.0;
/// An element in a picture, a break with its two points of the curve [MB].
const CELL_MB: f64 = 120e-6;
const EVENT_MB: f64 = 300e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.02;

pub(super) fn estimate(spec: &PaperTensile, calibration: &Calibration) -> Estimate {
    match &spec.specimen {
        Specimen::SingleFibre(fibre) => of_fibre(spec, fibre, calibration),
        Specimen::Explicit(sheet) => {
            let points: usize = sheet.fibres.iter().map(|f| f.centre_line_um.len()).sum();
            let (points, bonds) = (points as f64, sheet.bonds.len() as f64);
            let memory_mb = memory_of_given_mb(points, bonds);
            of_sheet(
                spec,
                calibration,
                [0.0, bonds, points + 2.0 * bonds],
                memory_mb,
            )
        }
        Specimen::Sheet(sheet) => {
            let expected = sheet.expected(spec);
            let counts = [expected.points, expected.bonds, expected.nodes];
            of_sheet(spec, calibration, counts, expected.memory_mb)
        }
    }
}

/// A sheet by what it has of points to be laid, bonds, and nodes.
fn of_sheet(
    spec: &PaperTensile,
    calibration: &Calibration,
    [points, bonds, nodes]: [f64; 3],
    memory_mb: f64,
) -> Estimate {
    let motions = match spec.level() {
        Level::Truss => 3.0,
        Level::Tube | Level::Beam => 6.0,
    };
    let unknowns = motions * nodes;
    let entries = 8.0 * unknowns * (unknowns + 2.0).log2();
    let events = BROKEN_SHARE * bonds;
    // the factor is made anew when corrections have cost as much
    let solutions = entries * SOLUTION * events;
    let factors = FACTOR_OF_ENTRY * entries * unknowns.sqrt() * (1.0 + events / EVENTS_PER_FACTOR);
    let work = POINT_LAID * points + solutions + factors;
    let repeats = f64::from(spec.specimens());
    Estimate {
        wall_s: START_S + repeats * work / calibration.bond_evaluations_per_s,
        memory_mb,
        disk_mb: if spec.output.snapshot_every_steps > 0 {
            3.0 * CELL_MB * (nodes + bonds) + events * EVENT_MB
        } else {
            events * EVENT_MB
        },
        calibrated: false,
    }
}

fn of_fibre(spec: &PaperTensile, fibre: &SingleFibre, calibration: &Calibration) -> Estimate {
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
