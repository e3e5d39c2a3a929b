//! What the JSON Schema cannot say: names that must exist, fractions that must sum up, walls that must
//! fit, segments that must need no negative spring.
use super::sheet_checks::{check_explicit, check_made, check_test, unknown_pulp};
use super::tube_checks::{self, MOST_POINTS, indivisible};
use super::{Level, PaperTensile, Pulp, SingleFibre, Specimen, measured};
use crate::fibre::divide;
use crate::{Violation, Violations};

/// Fractions sum up to one within this.
const FRACTIONS_SUM: f64 = 1e-6;
/// Shear moduli over Young's moduli for which springs are known to be right.
const SHEAR_RATIOS: [f64; 2] = [0.001, 2.0];
/// Hardening moduli over Young's moduli that a sheet is solved with.
const HARDENING: [f64; 2] = [1e-3, 0.99];

pub(super) fn check(spec: &PaperTensile, violations: &mut Violations) {
    let before = violations.count();
    check_pulps(spec, violations);
    let has_pulps = violations.count() == before;
    if !spec.specimen.is_single_fibre() {
        check_test(spec, violations);
    }
    if let (Some(strain), false) = (spec.model.taut_strain, spec.level() == Level::Truss) {
        let detail = "beams and tubes are held by their bending; only bars are taut";
        violations.push(
            Violation::new("/model/taut_strain", "not_of_this_level", detail)
                .value(strain)
                .allowed("left out, or model.level truss"),
        );
    }
    // a specimen of pulps that are wrong themselves says nothing more
    match &spec.specimen {
        _ if !has_pulps => {}
        Specimen::SingleFibre(fibre) => check_fibre(spec, fibre, violations),
        Specimen::Explicit(sheet) => check_explicit(spec, sheet, violations),
        Specimen::Sheet(sheet) => check_made(spec, sheet, violations),
    }
    let is_of_tubes = !spec.specimen.is_single_fibre() && spec.level() == Level::Tube;
    if has_pulps && is_of_tubes {
        tube_checks::check(spec, violations);
    }
}

fn check_pulps(spec: &PaperTensile, violations: &mut Violations) {
    let sum: f64 = spec.pulp.iter().map(|pulp| pulp.mass_fraction).sum();
    if (sum - 1.0).abs() > FRACTIONS_SUM {
        let detail = format!("the mass fractions of all pulps sum to {sum}");
        violations.push(
            Violation::new("/pulp", "fractions_do_not_sum", detail)
                .value(sum)
                .allowed("a sum of 1"),
        );
    }
    for (index, pulp) in spec.pulp.iter().enumerate() {
        let at = |field: &str| format!("/pulp/{index}/{field}");
        if spec.pulp[..index]
            .iter()
            .any(|other| other.name == pulp.name)
        {
            let detail = "two pulps have this name";
            violations
                .push(Violation::new(at("name"), "not_unique", detail).value(pulp.name.as_str()));
        }
        if let Err(error) = pulp.section() {
            violations.push(
                Violation::new(
                    at("wall_um"),
                    "wall_above_half_the_width",
                    error.to_string(),
                )
                .value(pulp.wall_um)
                .allowed(format!("at most {} (half the width)", pulp.width_um / 2.0))
                .unit("µm"),
            );
        }
        measured::check(index, pulp, violations);
        let [least, most] = SHEAR_RATIOS.map(|ratio| ratio * pulp.youngs_modulus_gpa);
        if !(least..=most).contains(&pulp.shear_modulus_gpa) {
            let detail = format!(
                "a shear modulus of {} GPa does not fit a Young's modulus of {} GPa",
                pulp.shear_modulus_gpa, pulp.youngs_modulus_gpa
            );
            violations.push(
                Violation::new(at("shear_modulus_gpa"), "moduli_do_not_fit", detail)
                    .value(pulp.shear_modulus_gpa)
                    .allowed(format!("{least} … {most}, 0.001 to 2 of Young's modulus"))
                    .unit("GPa"),
            );
        }
        violations.extend(yielding_violation(index, pulp));
    }
}

/// What a fibre cannot yield by.
fn yielding_violation(index: usize, pulp: &Pulp) -> Option<Violation> {
    let yielding = pulp.yielding?;
    let place = format!("/pulp/{index}/yielding");
    let [least, most] = HARDENING.map(|share| share * pulp.youngs_modulus_gpa);
    if !(least..=most).contains(&yielding.hardening_modulus_gpa) {
        let detail = format!(
            "a fibre with a Young's modulus of {} GPa does not harden so",
            pulp.youngs_modulus_gpa
        );
        let place = format!("{place}/hardening_modulus_gpa");
        return Some(
            Violation::new(place, "moduli_do_not_fit", detail)
                .value(yielding.hardening_modulus_gpa)
                .allowed(format!(
                    "{least} … {most}, 0.001 to 0.99 of Young's modulus"
                ))
                .unit("GPa"),
        );
    }
    let strength_mpa = pulp.strength_mpa?;
    (yielding.stress_mpa >= strength_mpa).then(|| {
        let detail = "the fibre breaks before it yields";
        let place = format!("{place}/stress_mpa");
        Violation::new(place, "yields_after_it_breaks", detail)
            .value(yielding.stress_mpa)
            .allowed(format!("below {strength_mpa}, the strength"))
            .unit("MPa")
    })
}

/// A fibre that can be divided without negative springs.
fn check_fibre(spec: &PaperTensile, fibre: &SingleFibre, violations: &mut Violations) {
    let Some(pulp) = spec.pulp_of(fibre) else {
        let name = fibre.pulp.as_deref().unwrap_or_default();
        let place = "/specimen/single_fibre/pulp".to_owned();
        violations.push(unknown_pulp(spec, place, name));
        return;
    };
    if spec.level() != Level::Tube {
        let detail = "a single fibre is a tube; beams and bars are for sheets";
        violations.push(
            Violation::new("/model/level", "not_of_a_fibre", detail)
                .value(spec.level().name())
                .allowed("tube, or left out"),
        );
    }
    let (Ok(section), Ok(elasticity)) = (pulp.section(), pulp.elasticity()) else {
        return;
    };
    let division = spec.model.division();
    match divide(
        1e3 * pulp.mean_length_mm(),
        &section,
        &elasticity,
        &division,
    ) {
        Ok(divided) => {
            let points = (divided.segments + 1) * division.points_on_ring;
            if points > MOST_POINTS {
                let detail = format!(
                    "a fibre of {} segments has {points} points",
                    divided.segments
                );
                violations.push(
                    Violation::new("/model/segment_um", "too_many_points", detail)
                        .value(points)
                        .allowed(format!("at most {MOST_POINTS} points")),
                );
            }
        }
        Err(error) => violations.push(indivisible(spec, &error)),
    }
}
