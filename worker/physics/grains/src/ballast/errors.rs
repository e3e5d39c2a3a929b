//! Which tests of ballast have errors beside their results, and from where.
use loadframe_api::spec::ballast::{
    Accuracy, Apparatus, Ballast, BoxTest, Compaction, Knobs, Laws, Materials, Oedometer,
    Preparation, Railbed,
};
use loadframe_api::spec::granular_scene::{Arrangement, Material};
use loadframe_api::{Preset, Report};

use crate::output::bed_errors::{self, Bed, Sized};

#[cfg(test)]
mod tests;

/// An apparatus that knows whether its errors were measured.
pub trait Tabled: Apparatus + PartialEq {
    /// The table, where there is one.
    #[doc(hidden)]
    const ERRORS: Option<&'static str>;
}

impl Tabled for Oedometer {
    const ERRORS: Option<&'static str> = Some(include_str!("errors/ballast_oedometer.json"));
}

/// Under what a bed cannot carry, some give way far more than others. Under less than ten times ρ g B, errors
/// measured on twelve still did not hold for one of two further ones.
impl Tabled for BoxTest {
    const ERRORS: Option<&'static str> = None;
}

/// A reference of a rail bed takes too long for as many as a table needs.
impl Tabled for Railbed {
    const ERRORS: Option<&'static str> = None;
}

/// Of the first cycle, whatever comes after it. What is left of it may be next to nothing: its error is over
/// the largest way. Porosities are not among them: errors measured like these did not hold, see the guide.
const RESULTS: [Sized; 4] = [
    ("unloading_stiffness", "unloading_stiffness"),
    ("peak_displacement", "peak_displacement"),
    ("residual_displacement", "peak_displacement"),
    ("oedometric_modulus", "oedometric_modulus"),
];

/// Densities of rock [kg/m³]: they act with gravity and as the time scale alone.
const DENSITIES: std::ops::RangeInclusive<f64> = 2400.0..=3000.0;
/// The smallest force over the largest, at most.
const SMALLEST_FORCE: f64 = 0.1;

/// Gives results the errors that are known of them. Returns what is to be said of those that have none.
pub(super) fn add<A: Tabled>(report: &mut Report, spec: &Ballast<A>) -> Option<String> {
    let Some(table) = A::ERRORS else {
        return Some("results have no error: none was measured for this kind of test".to_owned());
    };
    let grains = &spec.grains;
    let spheres = bed_errors::spheres(&grains.shape, grains.sizes.as_ref());
    let (Some([diameter, ratio]), true) = (spheres, is_measured(spec)) else {
        return Some(
            "results have no error: it was measured for spheres of evenly spread radii in the apparatus as \
             it is by itself, shaken as they are by themselves, under a force that begins below a tenth of \
             its peak and has no given period, at full stiffness, with laws and walls that the spec leaves \
             out"
                .to_owned(),
        );
    };
    let stone = &spec.materials.aggregate;
    let modulus = stone.youngs_modulus_pa;
    let across = spec.apparatus.bed_height() / diameter;
    let stress = spec.test.peak_force_n / spec.apparatus.loaded_area();
    let traits = [
        ("grains_across", across),
        ("size_ratio", ratio),
        ("youngs_modulus_pa", modulus),
        ("stress_over_modulus", stress / modulus),
        ("stiffness_ratio", stone.stiffness_ratio),
        ("friction_angle_rad", stone.friction_angle()),
    ];
    let numbers = |knobs: Knobs| {
        // a bed that is prepared as stiff as it is tested cannot be stiffer
        let softening = (modulus / knobs.preparation_modulus_pa).max(1.0);
        let Knobs {
            critical_step_fraction,
            inertial_number,
            ..
        } = knobs;
        [critical_step_fraction, softening, inertial_number]
    };
    let of_preset = |preset: Preset| numbers(Accuracy::Preset(preset).knobs());
    let bed = Bed {
        traits: &traits,
        level: bed_errors::level(numbers(spec.accuracy.knobs()), of_preset),
        results: &RESULTS,
    };
    bed_errors::add(report, table, &bed)
}

/// Whether such a test was among the measured ones, but for its numbers.
fn is_measured<A: Tabled>(spec: &Ballast<A>) -> bool {
    let aggregate = &spec.materials.aggregate;
    // nothing but what a table has as numbers
    let plain = Material {
        poisson_ratio: None,
        restitution: None,
        shear_restitution: None,
        rolling_resistance: None,
        parallel_bond: None,
        normal_cohesion_pa: 0.0,
        shear_cohesion_pa: 0.0,
        ..aggregate.clone()
    };
    let alone = Materials {
        aggregate: aggregate.clone(),
        steel: None,
        rubber: None,
        mat: None,
        concrete: None,
    };
    let test = &spec.test;
    let has_own_pace =
        test.period_s.is_some() || test.frequency_hz.is_some() || test.velocity_m_per_s.is_some();
    *aggregate == plain
        && DENSITIES.contains(&aggregate.density_kg_per_m3)
        && spec.resolved_materials() == spec.apparatus.materials(&alone)
        && spec.apparatus == A::default()
        && spec.grains.arrangement == Arrangement::Random
        && spec.preparation
            == Preparation {
                longest_settling_s: spec.preparation.longest_settling_s,
                compaction: Some(Compaction::default()),
                ..Preparation::default()
            }
        && spec.laws == Laws::default()
        && !has_own_pace
        && (0.0..=SMALLEST_FORCE).contains(&(test.smallest_force_n / test.peak_force_n))
        && spec.accuracy.knobs().stiffness >= 1.0
}
