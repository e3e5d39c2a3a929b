//! The triaxial test.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::results;
use super::script::{Aim, Pace, SMOOTH, Script, Shearing, following, moving};
use crate::{Violations, results::Named, spec::granular_scene::Axis};

/// A specimen between six smooth walls: the confining pressure acts on all, then the upper wall moves
/// down at a constant rate while those at the sides keep the pressure. Sides are those of the
/// specimen under it, about; the results tell them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Triaxial {
    /// Along x and y.
    #[schemars(range(min = 1e-6, max = 100.0), extend("x-unit" = "m"))]
    pub width_m: f64,
    /// Along z.
    #[schemars(range(min = 1e-6, max = 100.0), extend("x-unit" = "m"))]
    pub height_m: f64,
    /// σ₃.
    #[schemars(range(min = 1e-3, max = 1e12), extend("x-unit" = "Pa"))]
    pub confining_pressure_pa: f64,
    /// Shortening of the specimen over `height_m` at the end.
    #[serde(default = "fifth")]
    #[schemars(range(min = 1e-6, max = 0.5), extend("x-unit" = "1"))]
    pub axial_strain: f64,
    /// Over `height_m`; left out, it follows from the inertial number that `accuracy` asks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e6), extend("x-unit" = "1/s"))]
    pub axial_strain_rate_per_s: Option<f64>,
}

/// Shear rate √(2 D:D) of a shortening by 1/s without change of volume [1/s].
const SHEAR_PER_STRAIN: f64 = 1.732_050_807_568_877_2; // √3
/// How much faster than the shortening the sides may give way, at least.
const SIDES: f64 = 2.0;

impl Triaxial {
    /// ε̇ [1/s].
    fn rate(&self, pace: &Pace) -> f64 {
        self.axial_strain_rate_per_s
            .unwrap_or(pace.test / SHEAR_PER_STRAIN)
    }
}

impl Shearing for Triaxial {
    const COLUMNS: &'static [&'static str] = &[
        "time_s",
        "axial_strain",
        "volumetric_strain",
        "deviator_stress_kpa",
        "mean_stress_kpa",
        "axial_stress_kpa",
        "radial_stress_kpa",
        "mobilised_friction_angle_deg",
        "void_ratio",
        "inertial_number",
        "unbalanced_force_ratio",
        "coordination_number",
        "step_over_critical",
    ];

    const RESULTS: &'static [Named] = results::TRIAXIAL;

    fn stress(&self) -> f64 {
        self.confining_pressure_pa
    }

    fn sides(&self) -> [f64; 3] {
        [self.width_m, self.width_m, self.height_m]
    }

    fn room(&self, expansion: f64) -> [f64; 3] {
        self.sides().map(|side| side * expansion.cbrt())
    }

    fn given_shear_rate(&self, _pace: &Pace) -> Option<f64> {
        let rate = self.axial_strain_rate_per_s?;
        Some(SHEAR_PER_STRAIN * rate)
    }

    fn set_up(&self, script: &mut Script, pace: &Pace, friction_factor: f64) -> f64 {
        let [x, y, z] = self.room(pace.expansion);
        script.plane("left", Axis::X, [0.0, 1.0], SMOOTH);
        script.plane("right", Axis::X, [x, -1.0], SMOOTH);
        script.plane("front", Axis::Y, [0.0, 1.0], SMOOTH);
        script.plane("back", Axis::Y, [y, -1.0], SMOOTH);
        script.plane("base", Axis::Z, [0.0, 1.0], SMOOTH);
        script.plane("top", Axis::Z, [z, -1.0], SMOOTH);
        let aim = Aim::Stress(self.confining_pressure_pa);
        let walls = ["right", "back", "top"].into_iter().zip(self.sides());
        let walls: Vec<_> = walls
            .map(|(name, side)| {
                let velocity = pace.preparation * side;
                (following(name, aim, velocity), velocity)
            })
            .collect();
        let way = pace.expansion.cbrt() - 1.0;
        script.compress(&walls, way, pace, friction_factor);
        let rate = self.rate(pace);
        // as fast as they were pressed in: grains that give way do not wait for the shortening
        let fastest = (SIDES * rate).max(pace.preparation) * self.width_m;
        let side = |name: &str| following(name, aim, fastest);
        let top = moving("top", [0.0, 0.0, -rate * self.height_m]);
        let time = self.axial_strain / rate;
        script.shear(vec![side("right"), side("back"), top], time);
        script.scene.record.walls = ["base", "left", "front"].map(str::to_owned).to_vec();
        time
    }

    fn check(&self, _violations: &mut Violations) {}
}

fn fifth() -> f64 {
    0.2
}
