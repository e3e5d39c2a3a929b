//! A direct shear test's terms.
//!
//! With the force T of the soil on the upper half and the top along x, the force N on the top, and the
//! area A of the box: τ = T/A and σ_n = N/A (nominal: what the halves still share is less by the
//! displacement), tan φ = T/N whatever the area. With the displacements u of the lower half and v of the
//! top, upwards positive, tan ψ = dv/du.
use loadframe_api::spec::soil::{DirectShear, SAMPLE, Script, Shearing};
use loadframe_harness::{ReportBuilder, curve};

use super::{
    Measured, Reading,
    angles::{critical, slope_at},
    measured::{Rows, points},
};

/// Places in a row of the test.
const DISPLACEMENT: usize = 1;
const VERTICAL: usize = 2;
const SHEAR: usize = 3;
const NORMAL: usize = 4;
const RATIO: usize = 5;

/// T [N].
fn shear_force(row: &Reading<'_>) -> f64 {
    row.at("upper_force_x_n") + row.at("top_force_x_n")
}

impl Measured for DirectShear {
    fn row(&self, _script: &Script, row: &Reading<'_>, first: &Reading<'_>) -> Vec<f64> {
        let way = |name: &str| 1e3 * (row.at(name) - first.at(name));
        let [length, width, _] = self.sides();
        let [shear, normal] = [shear_force(row), row.at("top_force_z_n")];
        let kilopascals = 1e-3 / (length * width);
        vec![
            row.at("time_s") - first.at("time_s"),
            way("lower_displacement_x_m"),
            way("top_displacement_z_m"),
            kilopascals * shear,
            kilopascals * normal,
            shear / normal,
            (shear / normal).atan().to_degrees(),
            row.at(&format!("{SAMPLE}_inertial_number")),
            row.at("unbalanced_force_ratio"),
            row.at("coordination_number"),
            row.at("step_over_critical"),
        ]
    }

    fn kept_stress(&self) -> (usize, f64) {
        (NORMAL, 1e-3 * self.normal_stress_pa)
    }

    fn balance(&self, row: &Reading<'_>) -> [f64; 2] {
        let lower = row.at("lower_force_x_n") + row.at("base_force_x_n");
        [shear_force(row), lower]
    }

    fn results(&self, report: &mut ReportBuilder, script: &Script, rows: &Rows) {
        let kept = rows.kept(self.kept_stress());
        let ratio = points(&kept, DISPLACEMENT, RATIO);
        let vertical = points(&kept, DISPLACEMENT, VERTICAL);
        let (Some(peak), Some([first, _]), Some(last)) =
            (curve::peak(&ratio), rows.ends(), rows.test.last())
        else {
            return;
        };
        let (displacement, strength) = ratio[peak];
        let normal = rows.test.iter().map(|row| row[NORMAL]).sum::<f64>() / rows.test.len() as f64;
        let top = script.scene.planes.iter().find(|plane| plane.name == "top");
        let height = top.map_or(f64::NAN, |plane| plane.position_m);
        let height = height + first.at("top_displacement_z_m");
        let porosity = first.at(&format!("{SAMPLE}_porosity"));
        let angle = |tangent: f64| tangent.atan().to_degrees();
        for (name, value, unit, description) in [
            (
                "peak_shear_stress",
                1e3 * kept[peak][SHEAR],
                "Pa",
                "Shear stress where its ratio to the normal stress is largest, over the area of the box.",
            ),
            (
                "peak_friction_angle",
                angle(strength),
                "deg",
                "Of the largest ratio of shear to normal stress, of a soil without cohesion.",
            ),
            (
                "critical_friction_angle",
                angle(critical(&ratio)),
                "deg",
                "Of the mean ratio over the last fifth of the displacement: that of the critical state if the height has stopped changing.",
            ),
            (
                "dilatancy_angle",
                angle(slope_at(&vertical, displacement)),
                "deg",
                "Angle of dilatancy at the peak.",
            ),
            (
                "shear_displacement_at_peak",
                displacement,
                "mm",
                "Displacement of the lower half at the peak.",
            ),
            (
                "normal_stress",
                1e3 * normal,
                "Pa",
                "Mean normal stress during the test, over the area of the box.",
            ),
            (
                "final_vertical_displacement",
                last[VERTICAL],
                "mm",
                "Of the top at the end: positive when the specimen has grown.",
            ),
            (
                "largest_shear_displacement",
                last[DISPLACEMENT],
                "mm",
                "Displacement of the lower half at the end.",
            ),
            (
                "initial_height",
                1e3 * height,
                "mm",
                "Height of the specimen under the normal stress.",
            ),
            (
                "initial_void_ratio",
                porosity / (1.0 - porosity),
                "1",
                "Void ratio under the normal stress.",
            ),
        ] {
            report.result(name, value, unit, description);
        }
    }
}
