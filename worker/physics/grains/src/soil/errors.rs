//! Which tests of soil have errors beside their results, and from where.
//!
//! There is no gravity in a specimen, so that neither its size nor its modulus alone changes what is found:
//! a test is compared by ratios.
use loadframe_api::spec::granular_scene::{Material, RollingResistance};
use loadframe_api::spec::soil::{DirectShear, Knobs, Laws, Shearing, Soil, Triaxial};
use loadframe_api::{Accuracy, Preset, Report};

use crate::output::bed_errors::{self, Bed};

#[cfg(test)]
mod tests;

/// A test whose errors were measured.
pub trait Tabled: Shearing {
    /// The table.
    #[doc(hidden)]
    const ERRORS: &'static str;

    /// Results with errors, and those whose size they were measured over.
    #[doc(hidden)]
    const SIZED: &'static [(&'static str, &'static str)];

    /// Ratios of its sides, and how far it goes.
    #[doc(hidden)]
    fn proportions(&self) -> Vec<(&'static str, f64)>;
}

impl Tabled for Triaxial {
    const ERRORS: &'static str = include_str!("errors/triaxial.json");
    const SIZED: &'static [(&'static str, &'static str)] = &[
        ("peak_deviator_stress", "peak_deviator_stress"),
        ("peak_friction_angle", "peak_friction_angle"),
        ("critical_friction_angle", "critical_friction_angle"),
        // dense or loose, it may be next to nothing
        ("dilatancy_angle", "peak_friction_angle"),
        ("secant_modulus", "secant_modulus"),
        ("initial_void_ratio", "initial_void_ratio"),
    ];

    fn proportions(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("height_over_width", self.height_m / self.width_m),
            ("way", self.axial_strain),
        ]
    }
}

impl Tabled for DirectShear {
    const ERRORS: &'static str = include_str!("errors/direct_shear.json");
    const SIZED: &'static [(&'static str, &'static str)] = &[
        ("peak_shear_stress", "peak_shear_stress"),
        ("peak_friction_angle", "peak_friction_angle"),
        ("critical_friction_angle", "critical_friction_angle"),
        ("dilatancy_angle", "peak_friction_angle"),
        ("initial_void_ratio", "initial_void_ratio"),
    ];

    fn proportions(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("length_over_height", self.length_m / self.height_m),
            ("width_over_height", self.width_m / self.height_m),
            ("way", self.displacement() / self.length_m),
        ]
    }
}

/// Gives results the errors that are known of them. Returns what is to be said of those that have none.
pub(super) fn add<T: Tabled>(report: &mut Report, spec: &Soil<T>) -> Option<String> {
    let spheres = bed_errors::spheres(&spec.grains.shape, spec.grains.sizes.as_ref());
    let (Some([diameter, ratio]), true) = (spheres, is_measured(spec)) else {
        return Some(
            "results have no error: it was measured for spheres of evenly spread radii without cohesion \
             that resist rolling and not twisting, with laws that the spec leaves out"
                .to_owned(),
        );
    };
    let Soil {
        soil,
        test,
        accuracy,
        preparation,
        ..
    } = spec;
    let sides = test.sides().into_iter();
    let narrowest = sides.fold(f64::INFINITY, f64::min);
    let mut traits = vec![
        ("grains_across", narrowest / diameter),
        ("size_ratio", ratio),
        (
            "stress_over_modulus",
            test.stress() / soil.youngs_modulus_pa,
        ),
        ("stiffness_ratio", soil.stiffness_ratio),
        ("friction_angle_rad", soil.friction_angle()),
        ("rolling_friction", soil.rolling().rolling_friction),
        ("preparation_friction_factor", preparation.friction_factor),
    ];
    traits.extend(test.proportions());
    let numbers = |knobs: Knobs| [knobs.critical_step_fraction, knobs.inertial_number];
    let of_preset = |preset: Preset| numbers(Accuracy::Preset(preset).knobs());
    let pace = spec.pace();
    let [step, asked] = numbers(accuracy.knobs());
    let given = test.given_shear_rate(&pace);
    let inertial_number = given.map_or(asked, |rate| asked * rate / pace.test);
    let bed = Bed {
        traits: &traits,
        level: bed_errors::level([step, inertial_number], of_preset),
        results: T::SIZED,
    };
    let words = bed_errors::add(report, T::ERRORS, &bed);
    // a result that a warning of its name doubts is not what the table was measured of
    let Report {
        summary, warnings, ..
    } = report;
    for warning in warnings {
        if let Some(doubted) = summary.get_mut(&warning.code) {
            doubted.error = None;
        }
    }
    words
}

/// Whether such a test was among the measured ones, but for its numbers.
fn is_measured<T: Tabled>(spec: &Soil<T>) -> bool {
    let soil = &spec.soil;
    let plain_rolling = |own: RollingResistance| RollingResistance {
        rolling_friction: own.rolling_friction,
        ..RollingResistance::default()
    };
    let plain = Material {
        poisson_ratio: None,
        restitution: None,
        shear_restitution: None,
        rolling_resistance: soil.rolling_resistance.map(plain_rolling),
        parallel_bond: None,
        normal_cohesion_pa: 0.0,
        shear_cohesion_pa: 0.0,
        ..soil.clone()
    };
    *soil == plain && spec.laws == Laws::default()
}
