//! The direct shear test.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::results;
use super::script::{Aim, Pace, SMOOTH, SOIL, Script, Shearing, following, moving};
use crate::{Violation, Violations, results::Named, spec::granular_scene::Axis};

/// A box in two halves between a rough base and a rough top that carries the normal stress: the
/// lower half and the base move along x, the upper half stands. Where the halves leave each other
/// open, rims close them. Sides are those of the specimen under the stress, about, and of the area
/// that stresses refer to; the height is told by the results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectShear {
    /// Along x, in which it is sheared.
    #[schemars(range(min = 1e-6, max = 100.0), extend("x-unit" = "m"))]
    pub length_m: f64,
    /// Along y, between smooth walls.
    #[schemars(range(min = 1e-6, max = 100.0), extend("x-unit" = "m"))]
    pub width_m: f64,
    /// Along z; the halves part at half of it.
    #[schemars(range(min = 1e-6, max = 100.0), extend("x-unit" = "m"))]
    pub height_m: f64,
    /// σ_n on the area of the box.
    #[schemars(range(min = 1e-3, max = 1e12), extend("x-unit" = "Pa"))]
    pub normal_stress_pa: f64,
    /// Of the lower half at the end; left out, a tenth of the length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 100.0), extend("x-unit" = "m"))]
    pub shear_displacement_m: Option<f64>,
    /// Of the lower half; left out, it follows from the inertial number that `accuracy` asks for, over
    /// the height or ten mean grains, whichever is less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-12, max = 1e6), extend("x-unit" = "m/s"))]
    pub shear_velocity_m_per_s: Option<f64>,
}

/// Thickness of a shear band in mean grains.
const BAND: f64 = 10.0;
/// Displacement over the length, at most: beyond it hardly any soil is left between the halves.
const LARGEST: f64 = 0.5;
/// How much walls reach beyond what they must, over the specimen's height.
const BEYOND: f64 = 0.5;

impl DirectShear {
    /// Of the lower half at the end [m].
    pub fn displacement(&self) -> f64 {
        self.shear_displacement_m.unwrap_or(0.1 * self.length_m)
    }

    fn velocity(&self, pace: &Pace) -> f64 {
        let velocity = self.shear_velocity_m_per_s;
        velocity.unwrap_or(pace.test * self.band(pace))
    }

    /// Thickness of what is sheared [m].
    fn band(&self, pace: &Pace) -> f64 {
        self.height_m.min(BAND * pace.diameter)
    }
}

impl Shearing for DirectShear {
    const COLUMNS: &'static [&'static str] = &[
        "time_s",
        "shear_displacement_mm",
        "vertical_displacement_mm",
        "shear_stress_kpa",
        "normal_stress_kpa",
        "stress_ratio",
        "mobilised_friction_angle_deg",
        "inertial_number",
        "unbalanced_force_ratio",
        "coordination_number",
        "step_over_critical",
    ];

    const RESULTS: &'static [Named] = results::DIRECT_SHEAR;

    fn stress(&self) -> f64 {
        self.normal_stress_pa
    }

    fn sides(&self) -> [f64; 3] {
        [self.length_m, self.width_m, self.height_m]
    }

    fn room(&self, expansion: f64) -> [f64; 3] {
        [self.length_m, self.width_m, expansion * self.height_m]
    }

    fn given_shear_rate(&self, pace: &Pace) -> Option<f64> {
        let velocity = self.shear_velocity_m_per_s?;
        Some(velocity / self.band(pace))
    }

    fn set_up(&self, script: &mut Script, pace: &Pace, friction_factor: f64) -> f64 {
        let [length, width, room] = self.room(pace.expansion);
        script.plane("front", Axis::Y, [0.0, 1.0], SMOOTH);
        script.plane("back", Axis::Y, [width, -1.0], SMOOTH);
        script.plane("base", Axis::Z, [0.0, 1.0], SOIL);
        script.plane("top", Axis::Z, [room, -1.0], SOIL);
        let beyond = BEYOND * self.height_m;
        let (middle, top) = (0.5 * self.height_m, room + beyond);
        let rim = self.displacement() + beyond;
        let across = [-beyond, width + beyond];
        let lower = [
            [[0.0, -beyond], [0.0, middle]],
            [[length, -beyond], [length, middle]],
            [[-rim, middle], [0.0, middle]],
        ];
        let upper = [
            [[0.0, middle], [0.0, top]],
            [[length, middle], [length, top]],
            [[length, middle], [length + rim, middle]],
        ];
        script.facets("lower", across, &lower);
        script.facets("upper", across, &upper);
        let aim = Aim::Force(self.normal_stress_pa * length * width);
        let velocity = pace.preparation * self.height_m;
        let walls = [(following("top", aim, velocity), velocity)];
        script.compress(&walls, pace.expansion - 1.0, pace, friction_factor);
        let velocity = self.velocity(pace);
        let along = [velocity, 0.0, 0.0];
        let walls = vec![
            moving("lower", along),
            moving("base", along),
            // as fast as it was pressed down: grains that give way do not wait for the shear
            following("top", aim, velocity.max(pace.preparation * self.height_m)),
        ];
        let time = self.displacement() / velocity;
        script.shear(walls, time);
        script.scene.record.walls = vec!["upper".to_owned()];
        time
    }

    fn check(&self, violations: &mut Violations) {
        let most = LARGEST * self.length_m;
        violations.extend((self.displacement() > most).then(|| {
            let detail = "hardly any soil would be left between the halves";
            Violation::new("/test/shear_displacement_m", "too_large", detail)
                .value(self.displacement())
                .allowed(format!("≤ {most}"))
                .unit("m")
        }));
    }
}
