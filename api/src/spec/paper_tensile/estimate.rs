//! What a test takes: of one fibre factors of a narrow band, of a sheet a factor and a solution for
//! every break.
use super::equilibrium;
use super::expected::{
    factor_entries, is_factored_truss, is_iterated, is_single, iterated_entries, motions, tautness,
};
use super::{
    BondsAt, Dynamics, Level, PaperTensile, Placement, SingleFibre, SingleFibreLoad, Specimen,
};
use crate::fibre::{divide, line_length_um};
use crate::{Calibration, Estimate, Extent, Sharing};

#[cfg(test)]
mod tests;

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
/// Of sheets, fitted to ten from 1600 to 710 000 unknowns, of 10 to 120 g/m², 0.4 to 4 mm long, which took
/// 0.02 to 73 s: where a sheet is long what breaks is in a band, as wide as fibres are long.
const BAND: f64 = 0.3;
/// What these cost, in evaluations of one bond: an entry of the factor for every break, with its share in
/// factors to come; a multiplication of a factor; and a point that is laid.
const BREAK: f64 = 1.4;
const MULTIPLICATION: f64 = 0.018;
const POINT_LAID: f64 = 500.0;
/// Of sheets that iterate: iterations of the first solution and of later ones, and what an unknown, a bond and an
/// entry of the factor cost in one, in evaluations of one bond. The first of sheets of beams of 1033 to 13 798
/// fibres are 90 to 140; the later ones, of pulls of 466 to 13 798 fibres, were 19 to 26.
const FIRST_ITERATIONS: f64 = 110.0;
const ITERATIONS: f64 = 24.0;
/// Iterations with a factor of a truss, and how many times those of beams a larger truss takes without: one that is
/// loose, and one whose bars are taut by 1e-5, with the power of the strain by which they fall.
const WITH_FACTOR: f64 = 12.0;
const OF_TRUSS: f64 = 14.0;
const OF_TAUT_TRUSS: f64 = 3.2;
const POWER_OF_TAUT: f64 = 0.12;
const UNKNOWN: f64 = 21.0;
const BOND: f64 = 59.0;
const ENTRY: f64 = 0.33;
/// What is left of these in single precision, and of bars, which do not turn.
const SINGLE: f64 = 0.38;
const OF_BARS: f64 = 0.21;
/// By which power of the unknowns beyond so many an iteration is dearer, the less of them the caches of the processor
/// hold, and by how much at most: in sheets of 4 300 to 11.6 million unknowns it took 0.9 to 2.4 times as much.
const OF_CACHES: f64 = 0.17;
const IN_CACHES: f64 = 8500.0;
const OF_MEMORY: f64 = 2.4;
/// Where fibres yield there are so many yields for every break, each of which costs a break's solution and
/// takes a look at all elements. Not measured yet.
const YIELDS: f64 = 10.0;
/// Of masses in motion: the step over the time in which sound goes from node to node, with a tenth of the mass added; by
/// which power of it that grows, and what is left of it without any (sheets at 20 and 40 g/m²: 0.08 ns without, 0.4,
/// 0.8, 1.7, 4 and 10 ns with a thousandth to ten times the mass).
const STEP: f64 = 0.37;
const USUAL_MASS: f64 = 0.1;
const OF_MASS: f64 = 0.35;
const WITHOUT_MASS: f64 = 0.045;
/// What a node with its segment, with the springs of a tube, and a bond cost in a step, in evaluations of one bond.
const OF_NODE: f64 = 8.0;
const TUBE_SPRINGS: f64 = 1.0;
const OF_BOND: f64 = 8.0;
/// An element in a picture, a break with its two points of the curve [MB].
const CELL_MB: f64 = 120e-6;
const EVENT_MB: f64 = 300e-6;
/// Reading the spec and writing the files [s].
const START_S: f64 = 0.02;
/// Points are laid in the time in which a tenth as many parts are built and drawn.
const POINTS_OF_A_PART: f64 = 10.0;

pub(super) fn extent(spec: &PaperTensile) -> Extent {
    let (drawn, laid) = match &spec.specimen {
        Specimen::SingleFibre(fibre) => {
            // along, around and across from every point
            let springs = 4.0 * rings(spec, fibre) * f64::from(spec.model.points_on_ring);
            let what = "springs";
            return Extent {
                parts: springs,
                what,
            };
        }
        Specimen::Explicit(sheet) => {
            let nodes = match spec.level() {
                // lines along and around from every point
                Level::Tube => 2.0 * spec.as_tubes_points(),
                Level::Beam | Level::Truss => sheet.points(spec.model.segment_um),
            };
            (nodes + sheet.bonds.len() as f64, 0.0)
        }
        Specimen::Sheet(sheet) => {
            let expected = sheet.expected(spec);
            let lines = match spec.level() {
                Level::Tube => 2.0 * expected.nodes,
                Level::Beam | Level::Truss => expected.nodes,
            };
            (lines + expected.bonds, expected.points)
        }
    };
    let by_points = laid / POINTS_OF_A_PART;
    if by_points > drawn {
        return Extent {
            parts: by_points,
            what: "parts, by the points that its fibres are laid in",
        };
    }
    Extent {
        parts: drawn,
        what: "segments and bonds",
    }
}

pub(super) fn estimate(spec: &PaperTensile, calibration: &Calibration) -> Estimate {
    match &spec.specimen {
        Specimen::SingleFibre(fibre) => of_fibre(spec, fibre, calibration),
        Specimen::Explicit(sheet) => {
            let (nodes, memory_mb) = sheet.nodes(spec);
            let bonds = sheet.bonds.len() as f64;
            of_sheet(spec, calibration, [0.0, bonds, nodes], memory_mb)
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
    let unknowns = nodes * motions(spec);
    let entries = factor_entries(spec, unknowns);
    let has_strength = matches!(spec.specimen, Specimen::Explicit(_))
        || spec.pulp.iter().any(|pulp| pulp.strength_mpa.is_some())
        || spec.bond.is_none_or(|bond| {
            bond.normal_strength_mpa.is_some() || bond.shear_strength_mpa.is_some()
        });
    let broken_share = equilibrium::broken_share(spec.level());
    let share = match &spec.specimen {
        // breaks of large sheets are not those of one band
        Specimen::Sheet(_) if is_iterated(spec, unknowns) => broken_share,
        Specimen::Sheet(sheet) => {
            let lengths = spec.pulp.iter();
            let mean: f64 = lengths
                .map(|pulp| pulp.mass_fraction * pulp.mean_length_mm())
                .sum();
            broken_share.min(BAND * mean / sheet.length_mm)
        }
        Specimen::SingleFibre(_) | Specimen::Explicit(_) => broken_share,
    };
    let events = if has_strength && !folds(spec) {
        share * bonds
    } else {
        0.0
    };
    // columns of a factor are entries/unknowns long, and each meets all that are as long
    let work = if is_iterated(spec, unknowns) {
        let iterations = if is_factored_truss(spec, unknowns) {
            WITH_FACTOR * (1.0 + solutions(spec, events))
        } else {
            let times = match (spec.level(), tautness(spec)) {
                (Level::Truss, Some(taut)) => OF_TAUT_TRUSS * taut.powf(-POWER_OF_TAUT),
                (Level::Truss, None) => OF_TRUSS,
                (Level::Beam | Level::Tube, _) => 1.0,
            };
            // where every break is told exactly, each solution takes as many as the first
            let later = if spec.accuracy.knobs().break_precision > 0.0 {
                ITERATIONS
            } else {
                FIRST_ITERATIONS
            };
            times * (FIRST_ITERATIONS + later * solutions(spec, events))
        };
        let entries = iterated_entries(spec, unknowns);
        let each = UNKNOWN * unknowns + BOND * bonds + ENTRY * entries;
        let light = match spec.level() {
            // nearly all of it is the factor
            _ if is_factored_truss(spec, unknowns) => 1.0,
            Level::Truss => OF_BARS,
            Level::Beam | Level::Tube if is_single(spec) => SINGLE,
            Level::Beam | Level::Tube => 1.0,
        };
        let from_memory = (unknowns / IN_CACHES).powf(OF_CACHES).min(OF_MEMORY);
        iterations * each * light * from_memory
    } else {
        let factor = MULTIPLICATION * 2.0 * entries * entries / unknowns.max(1.0);
        let yields = if spec.yields() { YIELDS } else { 0.0 };
        factor + BREAK * entries * events * (1.0 + yields)
    };
    let work = match spec.test.dynamics {
        None => work,
        Some(dynamics) => of_motion(spec, dynamics, [bonds, nodes]),
    };
    let work = POINT_LAID * points + work;
    let directions = spec.test.pulled().each().len();
    let repeats = f64::from(spec.specimens()) * directions as f64;
    Estimate {
        wall_s: START_S + repeats * work / calibration.bond_evaluations_per_s,
        memory_mb,
        disk_mb: if spec.output.snapshot_every_steps > 0 {
            3.0 * CELL_MB * (nodes + bonds) + events * EVENT_MB
        } else {
            events * EVENT_MB
        },
        calibrated: false,
        threads_wall_s: None,
        sharing: Sharing {
            tests: repeats,
            // iterations are shared, and sheets that were measured gained nothing by it
            within: 0.0,
        },
    }
}

/// Solutions in which so many parts break.
fn solutions(spec: &PaperTensile, events: f64) -> f64 {
    let precision = spec.accuracy.knobs().break_precision;
    equilibrium::solutions(spec.level(), precision, events)
}

/// Of masses in motion: steps of time, each a look at all elements.
fn of_motion(spec: &PaperTensile, dynamics: Dynamics, [bonds, nodes]: [f64; 2]) -> f64 {
    let length_um = match &spec.specimen {
        Specimen::Sheet(sheet) => sheet.length_and_fibres(spec).0,
        Specimen::Explicit(sheet) => {
            let lines = sheet
                .fibres
                .iter()
                .map(|fibre| line_length_um(&fibre.centre_line_um));
            lines.sum()
        }
        Specimen::SingleFibre(_) => return 0.0,
    };
    let (in_ring, springs) = match spec.level() {
        Level::Tube => (f64::from(spec.model.points_on_ring), TUBE_SPRINGS),
        Level::Beam | Level::Truss => (1.0, 1.0),
    };
    let spacing_um = length_um * in_ring / nodes.max(1.0);
    // sound [µm/µs] in the fastest fibre: 1 GPa µm² is 1 mN
    let sounds = spec.pulp.iter().filter_map(|pulp| {
        let area = pulp.section().ok()?.area_um2();
        Some((pulp.youngs_modulus_gpa * area / pulp.coarseness_ug_per_um()?).sqrt())
    });
    let longer = (dynamics.added_mass / USUAL_MASS).powf(OF_MASS);
    let step_us = STEP * longer.max(WITHOUT_MASS) * spacing_um
        / sounds.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let until_us = 1e6 * spec.test.max_strain / dynamics.strain_rate_per_s;
    let steps = (until_us / step_us).max(f64::from(dynamics.points));
    steps * (OF_NODE * nodes * springs + OF_BOND * bonds)
}

/// Whether a sheet of bars is a mechanism, which folds and breaks nothing: all by deposition are, whose fibres climb
/// over others (two, pulled by a tenth, had no break).
fn folds(spec: &PaperTensile) -> bool {
    let Specimen::Sheet(sheet) = &spec.specimen else {
        return false;
    };
    let is_laid = matches!(sheet.placement, Placement::Deposition(_));
    let has_nodes = spec.accuracy.knobs().bonds_at == BondsAt::Nodes;
    is_laid && has_nodes && spec.level() == Level::Truss
}

/// Rings of points that a fibre is divided into.
fn rings(spec: &PaperTensile, fibre: &SingleFibre) -> f64 {
    spec.pulp_of(fibre)
        .and_then(|pulp| {
            let (section, elasticity) = (pulp.section().ok()?, pulp.elasticity().ok()?);
            let division = spec.model.division();
            divide(
                1e3 * pulp.mean_length_mm(),
                &section,
                &elasticity,
                &division,
            )
            .ok()
        })
        .map_or(0.0, |divided| divided.segments as f64 + 1.0)
}

fn of_fibre(spec: &PaperTensile, fibre: &SingleFibre, calibration: &Calibration) -> Estimate {
    let points_on_ring = f64::from(spec.model.points_on_ring);
    let rings = rings(spec, fibre);
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
        threads_wall_s: None,
        sharing: Sharing::ALONE,
    }
}
