//! What the JSON Schema cannot say of sheets: bonds that must join fibres where they touch, fibres that
//! must fit into a sheet, memory that there must be.
use super::{
    BondsAt, Direction, ExplicitBond, ExplicitSheet, MadeSheet, Orientation, PaperTensile,
    Placement, Pulp,
};
use crate::spec::repeats::check_seeds;
use crate::{Violation, Violations};

/// At most this many violations of a list are told.
const LISTED: usize = 20;
/// Points of a fibre nearer than this share of its width are one.
const ONE_PLACE: f64 = 1e-6;
/// An arc length may be beyond its fibre by this share of the fibre's length: round-off.
const AT_END: f64 = 1e-6;
/// Bonded points may be apart by this much more than the fibres' radii: arc lengths are written with
/// few digits.
const TOUCH: f64 = 1.01;
/// Most memory [MB] a sheet is given.
pub(super) const MOST_MB: f64 = 64e3;
/// Log-normal lengths are drawn within so many standard deviations of their logarithm.
const LENGTH_CUT: f64 = 3.0;
/// Longest fibre of a sheet [µm].
const LONGEST_UM: f64 = 1e5;
/// Below this the ends of an arc come so near to one another that a fibre would be a ring.
const LEAST_SHAPE: f64 = 0.1;

/// A specimen names a pulp that is not there.
pub(super) fn unknown_pulp(spec: &PaperTensile, place: String, name: &str) -> Violation {
    let known: Vec<&str> = spec.pulp.iter().map(|pulp| pulp.name.as_str()).collect();
    Violation::new(place, "unknown_pulp", "there is no such pulp")
        .value(name)
        .allowed(format!("one of: {}", known.join(", ")))
}

/// What holds for sheets of both sorts.
pub(super) fn check_test(spec: &PaperTensile, violations: &mut Violations) {
    if spec.yields() && spec.accuracy.knobs().bonds_at == BondsAt::Inside {
        let detail = "fibres that yield are followed with bonds at nodes of their own";
        violations.push(
            Violation::new("/accuracy/bonds_at", "not_of_fibres_that_yield", detail)
                .value("inside")
                .allowed("nodes, or left out"),
        );
    }
    check_dynamics(spec, violations);
    let fraction = spec.test.stop_fraction();
    if fraction >= 1.0 {
        let detail = "the test of a sheet would end at its first fall of force";
        violations.push(
            Violation::new("/test/stop_force_fraction", "out_of_range", detail)
                .value(fraction)
                .allowed("0 to below 1")
                .unit("1"),
        );
    }
    violations.extend(check_seeds(spec.seed, spec.specimens(), "repeats"));
}

/// What masses in motion cannot be asked.
fn check_dynamics(spec: &PaperTensile, violations: &mut Violations) {
    if spec.test.dynamics.is_none() {
        return;
    }
    let knobs = spec.accuracy.knobs();
    let inside = knobs.bonds_at == BondsAt::Inside;
    for (is_wrong, pointer, detail, allowed) in [
        (
            spec.test.is_zero_span(),
            "/test/type",
            "pieces between closed jaws have no bonds that could break one after the other",
            "tensile, or left out; or no dynamics",
        ),
        (
            spec.yields(),
            "/test/dynamics",
            "fibres that yield are pulled from rest to rest",
            "left out, or pulps without yielding",
        ),
        (
            inside,
            "/accuracy/bonds_at",
            "masses in motion are at nodes, and bonds must have such of their own",
            "nodes, or left out",
        ),
        (
            knobs.break_precision > 0.0,
            "/accuracy/break_precision",
            "in motion every part breaks at its own strength, in the step in which it comes to it",
            "0, or left out",
        ),
    ] {
        if is_wrong {
            violations.push(Violation::new(pointer, "not_of_dynamics", detail).allowed(allowed));
        }
    }
}

/// A sheet that is given. Every fibre and bond has one violation at most.
pub(super) fn check_explicit(
    spec: &PaperTensile,
    sheet: &ExplicitSheet,
    violations: &mut Violations,
) {
    if spec.test.pulled() != Direction::Md {
        let detail = "a sheet that is given is pulled along x; give it turned to pull it across";
        violations.push(
            Violation::new("/test/direction", "not_of_a_given_sheet", detail)
                .value(spec.test.pulled().name())
                .allowed("md, or left out"),
        );
    }
    if spec.test.is_zero_span() {
        let detail = "jaws close on the fibres of a sheet that is made; give a strip of the fibres between \
                      them to pull it so";
        violations.push(
            Violation::new("/test/type", "not_of_a_given_sheet", detail)
                .value("zero_span")
                .allowed("tensile, or left out"),
        );
    }
    let before = violations.count();
    let fibres = sheet.fibres.iter().enumerate();
    let wrong = fibres.filter_map(|(index, _)| fibre_violation(spec, sheet, index));
    violations.extend(wrong.take(LISTED));
    if violations.count() > before {
        // bonds of fibres that are wrong say nothing more
        return;
    }
    let (nodes, memory_mb) = sheet.nodes(spec);
    if memory_mb > MOST_MB {
        let detail = format!(
            "the sheet would have about {nodes:.0} points and need {memory_mb:.0} MB of memory"
        );
        violations.push(
            Violation::new("/model/segment_um", "too_large", detail)
                .value(spec.model.segment_um)
                .allowed(format!(
                    "what takes at most {MOST_MB} MB: longer segments, or a smaller sheet"
                ))
                .unit("µm"),
        );
    }
    let lines: Vec<Line<'_>> = sheet
        .fibres
        .iter()
        .filter_map(|fibre| Line::new(spec.pulp_named(&fibre.pulp)?, &fibre.centre_line_um))
        .collect();
    let bonds = sheet.bonds.iter().enumerate();
    let wrong = bonds.filter_map(|(index, bond)| bond_violation(&lines, index, bond));
    violations.extend(wrong.take(LISTED));
}

fn fibre_violation(spec: &PaperTensile, sheet: &ExplicitSheet, index: usize) -> Option<Violation> {
    let fibre = &sheet.fibres[index];
    let place = format!("/specimen/explicit/fibres/{index}");
    let Some(pulp) = spec.pulp_named(&fibre.pulp) else {
        return Some(unknown_pulp(spec, format!("{place}/pulp"), &fibre.pulp));
    };
    let near = ONE_PLACE * pulp.width_um;
    let pairs = fibre.centre_line_um.windows(2);
    let equal = pairs
        .map(|ends| distance(ends[0], ends[1]))
        .position(|step| step.is_nan() || step <= near)?;
    let place = format!("{place}/centre_line_um/{}", equal + 1);
    let detail = format!("points {equal} and {} are in one place", equal + 1);
    let violation = Violation::new(place, "points_in_one_place", detail)
        .value(fibre.centre_line_um[equal + 1].to_vec())
        .allowed(format!("more than {near:e} from the point before"))
        .unit("µm");
    Some(violation)
}

/// A fibre by its arc length.
struct Line<'a> {
    points: &'a [[f64; 3]],
    arcs: Vec<f64>,
    width_um: f64,
}

impl<'a> Line<'a> {
    fn new(pulp: &Pulp, points: &'a [[f64; 3]]) -> Option<Self> {
        let mut arcs = vec![0.0];
        let mut arc = 0.0;
        for ends in points.windows(2) {
            arc += distance(ends[0], ends[1]);
            arcs.push(arc);
        }
        (points.len() > 1).then_some(Self {
            points,
            arcs,
            width_um: pulp.width_um,
        })
    }

    fn length_um(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    fn at(&self, arc: f64) -> [f64; 3] {
        let last = self.points.len() - 1;
        let after = self.arcs.partition_point(|&point| point <= arc);
        let next = after.clamp(1, last);
        let share = (arc - self.arcs[next - 1]) / (self.arcs[next] - self.arcs[next - 1]);
        let [from, to] = [self.points[next - 1], self.points[next]];
        std::array::from_fn(|axis| from[axis] + share.clamp(0.0, 1.0) * (to[axis] - from[axis]))
    }
}

fn bond_violation(lines: &[Line<'_>], index: usize, bond: &ExplicitBond) -> Option<Violation> {
    let place = format!("/specimen/explicit/bonds/{index}");
    let [one, other] = bond.fibres.map(|fibre| lines.get(fibre as usize));
    let (Some(one), Some(other)) = (one, other) else {
        let detail = "the bond names a fibre that does not exist";
        let violation = Violation::new(format!("{place}/fibres"), "no_such_fibre", detail)
            .value(bond.fibres.to_vec())
            .allowed(format!("0 … {}", lines.len().saturating_sub(1)));
        return Some(violation);
    };
    for (side, line) in [one, other].into_iter().enumerate() {
        let (at_um, length_um) = (bond.at_um[side], line.length_um());
        if at_um > length_um * (1.0 + AT_END) {
            let detail = format!(
                "fibre {} is {length_um:.6} µm long, and the bond lies beyond",
                bond.fibres[side]
            );
            let violation = Violation::new(format!("{place}/at_um/{side}"), "beyond_fibre", detail)
                .value(at_um)
                .allowed(format!("0 … {length_um:.6}"))
                .unit("µm");
            return Some(violation);
        }
    }
    let [near, far] = [one.width_um, other.width_um].map(|width| 0.5 * width);
    let [a, b] = [one.at(bond.at_um[0]), other.at(bond.at_um[1])];
    let apart = distance(a, b);
    let [first, second] = bond.at_um;
    let is_itself = bond.fibres[0] == bond.fibres[1];
    if is_itself && (first - second).abs() <= ONE_PLACE * one.width_um {
        let detail = "the bond joins a point of a fibre with itself";
        let violation = Violation::new(format!("{place}/at_um"), "bond_to_itself", detail)
            .value(bond.at_um.to_vec())
            .allowed("two different points")
            .unit("µm");
        return Some(violation);
    }
    let most = near + far;
    (apart > TOUCH * most).then(|| {
        let detail = format!(
            "fibres {} and {} do not touch here: their centre lines are {apart:.4} µm apart, and half \
             their widths sum to {most:.4} µm",
            bond.fibres[0], bond.fibres[1]
        );
        Violation::new(format!("{place}/at_um"), "do_not_touch", detail)
            .value(apart)
            .allowed(format!("up to {:.4}", TOUCH * most))
            .unit("µm")
    })
}

/// A sheet that is made.
pub(super) fn check_made(spec: &PaperTensile, sheet: &MadeSheet, violations: &mut Violations) {
    let is_zero_span = spec.test.is_zero_span();
    if spec.bond.is_none() && !is_zero_span {
        let detail = "fibres of a sheet need to hold one another: give the bonds' strength, or an empty \
                      object for bonds that do not break";
        violations.push(Violation::new("/bond", "missing_field", detail).allowed("an object"));
    }
    let used = || {
        spec.pulp
            .iter()
            .enumerate()
            .filter(|(_, pulp)| pulp.mass_fraction > 0.0)
    };
    let before = violations.count();
    for (index, pulp) in used() {
        violations.extend(pulp_violation(index, pulp));
        if is_zero_span && pulp.strength_mpa.is_none() {
            let detail = "a zero-span test breaks fibres, and these never break";
            let place = format!("/pulp/{index}/strength_mpa");
            let violation = Violation::new(place, "missing_field", detail);
            violations.push(violation.allowed("a number").unit("MPa"));
        }
    }
    if violations.count() > before {
        return;
    }
    let widest = used().fold(0.0, |most: f64, (_, pulp)| most.max(pulp.widths_um()[1]));
    for (name, size_mm) in [("length_mm", sheet.length_mm), ("width_mm", sheet.width_mm)] {
        let least_mm = 2e-3 * widest;
        if size_mm < least_mm {
            let detail = "the sheet has no room for its fibres";
            violations.push(
                Violation::new(format!("/specimen/sheet/{name}"), "sheet_too_small", detail)
                    .value(size_mm)
                    .allowed(format!(
                        "from {least_mm}, twice the width of the widest fibre"
                    ))
                    .unit("mm"),
            );
        }
    }
    if let Placement::Random(random) = sheet.placement {
        let fibres = used().flat_map(|(_, pulp)| pulp.fibres());
        let thickest = fibres.filter_map(|fibre| fibre.thickness_um());
        let thickest = thickest.fold(0.0, f64::max);
        if random.thickness_um < thickest {
            let detail =
                "the sheet is thinner than a fibre, which is as thick as its flattened wall";
            let place = "/specimen/sheet/placement/random/thickness_um";
            violations.push(
                Violation::new(place, "sheet_too_thin", detail)
                    .value(random.thickness_um)
                    .allowed(format!("from {thickest:.4}"))
                    .unit("µm"),
            );
        }
    }
    if let Orientation::Histogram(histogram) = &sheet.orientation
        && histogram.densities.iter().sum::<f64>() <= 0.0
    {
        let detail = "no fibre may point anywhere";
        let place = "/specimen/sheet/orientation/histogram/densities";
        violations.push(
            Violation::new(place, "out_of_range", detail)
                .value(0.0)
                .allowed("a sum above 0"),
        );
    }
    let area_um2 = 1e6 * sheet.length_mm * sheet.width_mm;
    for (_, pulp) in used() {
        let Some(coarseness) = pulp.coarseness_ug_per_um() else {
            continue;
        };
        let widest_um = pulp.widths_um()[1];
        let mass_ug = pulp.mass_fraction * sheet.grammage_g_per_m2 * 1e-6 * area_um2;
        let least = sheet.grammage_g_per_m2 * coarseness * widest_um / mass_ug;
        if mass_ug < coarseness * widest_um {
            let detail = format!(
                "the sheet would have less of pulp {:?} than a piece of fibre as long as it is wide",
                pulp.name
            );
            let place = "/specimen/sheet/grammage_g_per_m2";
            violations.push(
                Violation::new(place, "too_little_fibre", detail)
                    .value(sheet.grammage_g_per_m2)
                    .allowed(format!("from {least}, or a larger sheet"))
                    .unit("g/m2"),
            );
        }
    }
    let expected = sheet.expected(spec);
    if expected.memory_mb > MOST_MB {
        let detail = format!(
            "the sheet would have about {:.0} fibres and {:.0} bonds and need {:.0} MB of memory",
            expected.fibres, expected.bonds, expected.memory_mb
        );
        violations.push(
            Violation::new("/specimen/sheet/grammage_g_per_m2", "too_large", detail)
                .value(sheet.grammage_g_per_m2)
                .allowed(format!(
                    "what takes at most {MOST_MB} MB: a smaller or thinner sheet"
                ))
                .unit("g/m2"),
        );
    }
}

/// The first thing of a pulp that no sheet is made of.
fn pulp_violation(index: usize, pulp: &Pulp) -> Option<Violation> {
    let at = |field: String| format!("/pulp/{index}/{field}");
    for (place, fibre) in pulp.fibres().enumerate() {
        let listed = |list: &str, is_listed: bool, field: &str| {
            at(if is_listed {
                format!("measured/{list}/{place}")
            } else {
                field.to_owned()
            })
        };
        let median = 1e3 * fibre.length_mm * (-0.5 * variance(pulp)).exp();
        let sigma = variance(pulp).sqrt();
        let [shortest, longest] = [-LENGTH_CUT, LENGTH_CUT].map(|cut| median * (cut * sigma).exp());
        let least = 2.0 * fibre.width_um;
        if shortest < least || longest > LONGEST_UM {
            let detail = format!(
                "fibres of the pulp would be {shortest:.1} to {longest:.1} µm long; fibres of a sheet have \
                 {least} to {LONGEST_UM} µm"
            );
            let (field, value) = if pulp.length_variation > 0.0 {
                ("length_variation", pulp.length_variation)
            } else {
                ("length_mm", fibre.length_mm)
            };
            let place = listed("lengths_mm", pulp.measured.is_some(), field);
            return Some(
                Violation::new(place, "length_not_of_a_sheet", detail)
                    .value(value)
                    .allowed(format!("fibres of {least} … {LONGEST_UM} µm")),
            );
        }
        if fibre.shape_factor < LEAST_SHAPE {
            let detail = "a fibre so curled is nearly a ring";
            let list = pulp
                .measured
                .as_ref()
                .and_then(|m| m.shape_factors.as_ref());
            let place = listed("shape_factors", list.is_some(), "shape_factor");
            return Some(
                Violation::new(place, "out_of_range", detail)
                    .value(fibre.shape_factor)
                    .allowed(format!("{LEAST_SHAPE} … 1"))
                    .unit("1"),
            );
        }
    }
    None
}

/// σ² of the logarithm of log-normal lengths, ln(1 + v²).
fn variance(pulp: &Pulp) -> f64 {
    pulp.length_variation.powi(2).ln_1p()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let parts = (0..3).map(|axis| (b[axis] - a[axis]).powi(2));
    parts.sum::<f64>().sqrt()
}
