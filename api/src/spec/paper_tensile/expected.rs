//! How much a sheet will be, before it is made.
use std::f64::consts::PI;

use super::equilibrium::{DIRECT, FACTORED_TRUSS, LEAST_TAUT, has_rigid_groups};
use super::{BondsAt, ExplicitSheet, Level, MadeSheet, PaperTensile, Placement, Pulp, Specimen};
use crate::fibre::{OnInadmissible, Window, line_length_um};

/// Entries that the engine keeps of breaks, however small the factor is, and how often an unknown has one
/// before a factor is made anew: six terms of 35 breaks.
const FREE_COLUMNS: f64 = 1e7;
const COLUMNS: f64 = 6.0 * 35.0;

/// Nodes of a fibre between closed jaws, laid in quarters of a width.
const NODES_OF_A_PIECE: f64 = 6.0;
/// Entries of a factor of tubes: a bond joins the four rings around it, all points with all.
const TUBE_ENTRIES: f64 = 7.3;
/// Memory of tubes [B] for an unknown and for a bond, counted: five springs for a point, the blocks of a bond's points.
const TUBE_UNKNOWN: f64 = 1100.0;
const TUBE_BOND: f64 = 40e3;
/// Memory of iterations [B] for an unknown and for a bond.
const ITERATED: f64 = 280.0;
const ITERATED_BOND: f64 = 800.0;

/// About how much a sheet will be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    pub(super) fibres: f64,
    /// Points of the centre lines, as finely as they are laid.
    pub(super) points: f64,
    pub(super) bonds: f64,
    /// Nodes of the beams.
    pub(super) nodes: f64,
    pub(super) memory_mb: f64,
}

impl MadeSheet {
    /// A pulp of fibre length ℓ and total length Λ on an area A of perimeter P makes Λ (1/ℓ + P/(π A))
    /// pieces; straight fibres cross Λ²/(π A) times, and each has room for a contact per width on each
    /// of its two faces. Sheets of 90 to 1800 bonds have about a third of that room taken.
    pub(super) fn expected(&self, spec: &PaperTensile) -> Expected {
        let [length, width] = [self.length_mm, self.width_mm].map(|size| 1e3 * size);
        let area = length * width;
        let (total, fibres) = self.length_and_fibres(spec);
        if spec.test.is_zero_span() {
            // what crosses a line across the pull, 2/π of the length over that of the sheet, in pieces of
            // a few nodes; no bonds
            let crossing = 2.0 / PI * total / length;
            let points = total / (0.25 * spec.narrowest_um());
            let nodes = NODES_OF_A_PIECE * crossing;
            return Expected {
                fibres,
                points,
                bonds: crossing,
                nodes,
                memory_mb: memory_mb(spec, [points, 0.0, 0.0], nodes * motions(spec)),
            };
        }
        let narrowest = spec.narrowest_um();
        let crossings = total * total / (PI * area);
        let (points, bonds, pixels) = match self.placement {
            Placement::Deposition(_) => {
                let segment = 0.25 * narrowest;
                let bonds = crossings.min(0.36 * total / narrowest);
                (total / segment, bonds, area / (segment * segment))
            }
            // of all crossings those whose heights are within a fibre's thickness of one another
            Placement::Random(random) => {
                let fibres = spec.pulp.iter().flat_map(Pulp::fibres);
                let thickness = fibres.filter_map(|fibre| fibre.thickness_um());
                let share = 2.0 * thickness.fold(0.0, f64::max) / random.thickness_um;
                (total / narrowest, crossings * share.min(1.0), 0.0)
            }
        };
        let of_fibres = total / spec.sheet_segment_um() + fibres;
        let is_inside = spec.accuracy.knobs().bonds_at == BondsAt::Inside;
        let nodes = match spec.level() {
            Level::Tube => spec.points_of_tubes(total, fibres),
            Level::Beam | Level::Truss => of_fibres + if is_inside { 0.0 } else { 2.0 * bonds },
        };
        let laid = [points, bonds, pixels];
        Expected {
            fibres,
            points,
            bonds,
            nodes,
            memory_mb: memory_mb(spec, laid, nodes * motions(spec)),
        }
    }

    /// Length of all fibres [µm], and into how many pieces the edges cut them.
    pub(super) fn length_and_fibres(&self, spec: &PaperTensile) -> (f64, f64) {
        let [length, width] = [self.length_mm, self.width_mm].map(|size| 1e3 * size);
        let area = length * width;
        let (mut total, mut fibres) = (0.0, 0.0);
        for pulp in &spec.pulp {
            let Some(coarseness) = pulp.mean_coarseness_ug_per_um() else {
                continue;
            };
            let mass = pulp.mass_fraction * self.grammage_g_per_m2 * 1e-6 * area;
            let laid = mass / coarseness;
            let edges = 2.0 * (length + width) / (PI * area);
            fibres += laid * (1e-3 / pulp.mean_length_mm() + edges);
            total += laid;
        }
        (total, fibres)
    }
}

impl ExplicitSheet {
    /// Points of its fibres as beams or bars, with those between that keep segments short.
    pub(super) fn points(&self, segment_um: Option<f64>) -> f64 {
        let gaps = |line: &[[f64; 3]]| match segment_um {
            None => line.len() as f64,
            Some(longest) => {
                let parts = |ends: &[[f64; 3]]| (line_length_um(ends) / longest).ceil().max(1.0);
                1.0 + line.windows(2).map(parts).sum::<f64>()
            }
        };
        self.fibres
            .iter()
            .map(|fibre| gaps(&fibre.centre_line_um))
            .sum()
    }

    /// Points that hold its springs or beams together, and what they take [MB].
    pub(super) fn nodes(&self, spec: &PaperTensile) -> (f64, f64) {
        let bonds = self.bonds.len() as f64;
        let is_inside = spec.accuracy.knobs().bonds_at == BondsAt::Inside;
        let nodes = match spec.level() {
            Level::Tube => spec.as_tubes_points(),
            Level::Beam | Level::Truss => {
                let of_bonds = if is_inside { 0.0 } else { 2.0 * bonds };
                self.points(spec.model.segment_um) + of_bonds
            }
        };
        (
            nodes,
            memory_mb(spec, [0.0, bonds, 0.0], nodes * motions(spec)),
        )
    }
}

/// Motions of a node that are solved for.
pub(super) fn motions(spec: &PaperTensile) -> f64 {
    match spec.level() {
        Level::Truss | Level::Tube => 3.0,
        Level::Beam => 6.0,
    }
}

impl PaperTensile {
    /// Points of the tubes of a sheet, were its fibres such: of one fibre after the other with the segments of the first
    /// pulp.
    pub(super) fn as_tubes_points(&self) -> f64 {
        let (total, fibres) = match &self.specimen {
            Specimen::Sheet(sheet) => sheet.length_and_fibres(self),
            Specimen::Explicit(sheet) => {
                let lines = sheet
                    .fibres
                    .iter()
                    .map(|f| line_length_um(&f.centre_line_um));
                (lines.sum(), sheet.fibres.len() as f64)
            }
            Specimen::SingleFibre(_) => (0.0, 0.0),
        };
        self.points_of_tubes(total, fibres)
    }

    /// Points of so many tubes of so much length [µm]: a ring for each segment, and one for each fibre.
    pub(super) fn points_of_tubes(&self, total_um: f64, fibres: f64) -> f64 {
        let division = self.model.division();
        let window = self.pulp.iter().find_map(|pulp| {
            let (section, elasticity) = (pulp.section().ok()?, pulp.elasticity().ok()?);
            let diameter = section.ring_diameter_um(division.ring).ok()?;
            Window::new(division.points_on_ring, diameter, &section, &elasticity).ok()
        });
        let segment_um = match (window, division.segment_um) {
            (Some(window), Some(wanted))
                if division.on_inadmissible == OnInadmissible::Robust || window.admits(wanted) =>
            {
                wanted
            }
            (Some(window), _) => window.from_um,
            (None, _) => self.narrowest_um(),
        };
        (total_um / segment_um + fibres) * division.points_on_ring as f64
    }
}

/// Whether equilibrium is found by iterations, as the engine chooses.
pub(super) fn is_iterated(spec: &PaperTensile, unknowns: f64) -> bool {
    let knobs = spec.accuracy.knobs();
    let has_factor = spec.yields() || spec.level() == Level::Tube;
    knobs.bonds_at == BondsAt::Inside || (unknowns > DIRECT as f64 && !has_factor)
}

/// Entries of the factor of a flat network, fitted to ten from 1600 to 710 000 unknowns, with 27 to 384
/// for each, to half of them; of tubes to two of 3024 and 11 844 unknowns with 211 and 380
/// for each.
pub(super) fn factor_entries(spec: &PaperTensile, unknowns: f64) -> f64 {
    if spec.level() == Level::Tube {
        return TUBE_ENTRIES * unknowns.powf(1.42);
    }
    1.2 * unknowns.powf(1.42)
}

/// Entries of the factor that iterations have. Of rigid groups, fitted to sheets of beams of 332 000 to 1 300 000
/// unknowns with 7.5 to 11 for each, bonds inside segments or with nodes, and to trusses, whose groups are larger,
/// of 166 000 to 655 000 with 1.6 to 2.7. Of a truss that is small, of the truss itself, by one of 28 000 unknowns.
pub(super) fn iterated_entries(spec: &PaperTensile, unknowns: f64) -> f64 {
    if is_factored_truss(spec, unknowns) {
        return 10.6 * unknowns.powf(1.42);
    }
    match spec.level() {
        Level::Truss => 0.013 * unknowns.powf(1.4),
        Level::Beam | Level::Tube => 0.156 * unknowns.powf(1.305),
    }
}

/// Whether iterations have a factor of a truss itself.
pub(super) fn is_factored_truss(spec: &PaperTensile, unknowns: f64) -> bool {
    spec.level() == Level::Truss && tautness(spec).is_none() && unknowns <= FACTORED_TRUSS as f64
}

/// Strain of the bars of a truss over that from which on they count as taut; none below, and where every break is told
/// exactly.
pub(super) fn tautness(spec: &PaperTensile) -> Option<f64> {
    let strain = spec.model.taut_strain?;
    let is_grouped = has_rigid_groups(strain, spec.accuracy.knobs().break_precision);
    (spec.level() == Level::Truss && is_grouped).then_some(strain / LEAST_TAUT)
}

/// Whether iterations are in single precision.
pub(super) fn is_single(spec: &PaperTensile) -> bool {
    spec.level() == Level::Beam && spec.accuracy.knobs().bonds_at == BondsAt::Inside
}

/// Memory [MB] of the process, of points and contacts while they are searched, as the sheets count them,
/// of pixels, of nodes with their elements, of the factor, and of what is kept of breaks until the next
/// factor is made; ten sheets took 27 to 2500 MB.
pub(super) fn memory_mb(
    spec: &PaperTensile,
    [points, bonds, pixels]: [f64; 3],
    unknowns: f64,
) -> f64 {
    let laid = 100.0 * points + 80.0 * bonds + 8.0 * pixels;
    if is_iterated(spec, unknowns) {
        let entries = iterated_entries(spec, unknowns);
        return 20.0 + 1e-6 * (laid + ITERATED * unknowns + ITERATED_BOND * bonds + 8.0 * entries);
    }
    let factor = factor_entries(spec, unknowns);
    let breaks = factor.max(FREE_COLUMNS).min(COLUMNS * unknowns);
    let [unknown, bond] = match spec.level() {
        Level::Tube => [TUBE_UNKNOWN, TUBE_BOND],
        Level::Beam | Level::Truss => [500.0, 0.0],
    };
    20.0 + 1e-6 * (laid + unknown * unknowns + bond * bonds + 8.0 * (factor + breaks))
}
