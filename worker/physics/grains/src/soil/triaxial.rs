//! A triaxial test's terms.
//!
//! With the places of the walls, sides l_x, l_y, l_z and the forces F on them (compression positive),
//! σ_a = F_z/(l_x l_y), σ_r the mean of F_x/(l_y l_z) and F_y/(l_x l_z); q = σ_a − σ_r,
//! p = (σ_a + 2 σ_r)/3; ε_a = 1 − l_z/l_z₀, ε_v = 1 − V/V₀ (compression positive). The mobilised angle of a soil
//! without cohesion is sin φ = (σ_a − σ_r)/(σ_a + σ_r), the angle of dilatancy
//! sin ψ = (dε_v/dε_a)/(dε_v/dε_a − 2) ([SchanzVermeer1996]), the secant modulus q/ε_a at half the peak of q
//! beyond that at the start. The void ratio is of the solid volume in the box, e = n/(1 − n).
use loadframe_api::spec::soil::{SAMPLE, Script, Triaxial};
use loadframe_harness::{ReportBuilder, curve};

use super::{
    Measured, Reading,
    angles::{critical, reached, slope_at},
    measured::{Rows, points},
};

/// Places in a row of the test.
const AXIAL_STRAIN: usize = 1;
const VOLUMETRIC_STRAIN: usize = 2;
const DEVIATOR: usize = 3;
const MEAN: usize = 4;
const RADIAL: usize = 6;
const ANGLE: usize = 7;
const VOID_RATIO: usize = 8;

/// Sides [m] and stresses [Pa] of a specimen.
struct State {
    sides: [f64; 3],
    axial: f64,
    radial: f64,
}

impl State {
    fn of(script: &Script, row: &Reading<'_>) -> Self {
        let walls = [("right", "x"), ("back", "y"), ("top", "z")];
        let sides = walls.map(|(wall, axis)| {
            let plane = script.scene.planes.iter().find(|plane| plane.name == wall);
            let start = plane.map_or(f64::NAN, |plane| plane.position_m);
            start + row.at(&format!("{wall}_displacement_{axis}_m"))
        });
        let forces = walls.map(|(wall, axis)| row.at(&format!("{wall}_force_{axis}_n")));
        let [x, y, z] = sides;
        let areas = [y * z, x * z, x * y];
        let [along_x, along_y, axial] = [0, 1, 2].map(|axis: usize| forces[axis] / areas[axis]);
        Self {
            sides,
            axial,
            radial: 0.5 * (along_x + along_y),
        }
    }

    fn volume(&self) -> f64 {
        self.sides.iter().product()
    }
}

impl Measured for Triaxial {
    fn row(&self, script: &Script, row: &Reading<'_>, first: &Reading<'_>) -> Vec<f64> {
        let [now, start] = [row, first].map(|row| State::of(script, row));
        let porosity = row.at(&format!("{SAMPLE}_porosity"));
        let State { axial, radial, .. } = now;
        let deviator = axial - radial;
        vec![
            row.at("time_s") - first.at("time_s"),
            1.0 - now.sides[2] / start.sides[2],
            1.0 - now.volume() / start.volume(),
            1e-3 * deviator,
            1e-3 * (axial + 2.0 * radial) / 3.0,
            1e-3 * axial,
            1e-3 * radial,
            (deviator / (axial + radial)).asin().to_degrees(),
            porosity / (1.0 - porosity),
            row.at(&format!("{SAMPLE}_inertial_number")),
            row.at("unbalanced_force_ratio"),
            row.at("coordination_number"),
            row.at("step_over_critical"),
        ]
    }

    fn kept_stress(&self) -> (usize, f64) {
        (RADIAL, 1e-3 * self.confining_pressure_pa)
    }

    fn balance(&self, row: &Reading<'_>) -> [f64; 2] {
        ["top", "base"].map(|wall| row.at(&format!("{wall}_force_z_n")))
    }

    fn results(&self, report: &mut ReportBuilder, script: &Script, rows: &Rows) {
        let kept = rows.kept(self.kept_stress());
        let deviator = points(&kept, AXIAL_STRAIN, DEVIATOR);
        let angle = points(&kept, AXIAL_STRAIN, ANGLE);
        let volume = points(&kept, AXIAL_STRAIN, VOLUMETRIC_STRAIN);
        let (Some(peak), Some([first, _]), Some(last)) =
            (curve::peak(&angle), rows.ends(), rows.test.last())
        else {
            return;
        };
        let (strain, peak_angle) = angle[peak];
        let dilation = slope_at(&volume, strain);
        let half = 0.5 * (deviator[0].1 + deviator[peak].1);
        let at_half = reached(&deviator[..=peak], half);
        let secant = at_half.map(|strain| 1e3 * (half - deviator[0].1) / strain);
        if at_half.is_some_and(|strain| strain < deviator[1].0) {
            let detail = "half the peak of the deviator stress is passed before the first row of the curve, and the \
                          secant modulus is that of this row: ask for more of /output/rows";
            report.warn("secant_modulus", detail);
        }
        let mean = |column: usize| {
            rows.test.iter().map(|row| row[column]).sum::<f64>() / rows.test.len() as f64
        };
        let start = State::of(script, &first);
        for (name, value, unit, description) in [
            (
                "peak_deviator_stress",
                1e3 * deviator[peak].1,
                "Pa",
                "Deviator stress σ_a − σ_r where the mobilised friction angle is largest.",
            ),
            (
                "peak_friction_angle",
                peak_angle,
                "deg",
                "Largest mobilised friction angle, of a soil without cohesion.",
            ),
            (
                "critical_friction_angle",
                critical(&angle),
                "deg",
                "Mean mobilised friction angle over the last fifth of the strain: that of the critical state if the volume has stopped changing.",
            ),
            (
                "dilatancy_angle",
                (dilation / (dilation - 2.0)).asin().to_degrees(),
                "deg",
                "Angle of dilatancy at the peak.",
            ),
            (
                "axial_strain_at_peak",
                strain,
                "1",
                "Axial strain at the peak.",
            ),
            (
                "secant_modulus",
                secant.unwrap_or(f64::NAN),
                "Pa",
                "Secant modulus at half the peak deviator stress, between rows of the curve.",
            ),
            (
                "confining_pressure",
                1e3 * mean(RADIAL),
                "Pa",
                "Mean stress on the walls at the sides during the test.",
            ),
            (
                "mean_stress_at_peak",
                1e3 * kept[peak][MEAN],
                "Pa",
                "Mean stress p at the peak.",
            ),
            (
                "initial_void_ratio",
                rows.test[0][VOID_RATIO],
                "1",
                "Void ratio under the confining pressure.",
            ),
            (
                "final_void_ratio",
                last[VOID_RATIO],
                "1",
                "Void ratio at the end.",
            ),
            (
                "largest_axial_strain",
                last[AXIAL_STRAIN],
                "1",
                "Axial strain at the end, over the height of the specimen under the confining pressure.",
            ),
            (
                "final_volumetric_strain",
                last[VOLUMETRIC_STRAIN],
                "1",
                "Volumetric strain at the end: negative when the specimen has grown.",
            ),
            (
                "initial_height",
                1e3 * start.sides[2],
                "mm",
                "Height of the specimen under the confining pressure.",
            ),
            (
                "initial_width",
                1e3 * 0.5 * (start.sides[0] + start.sides[1]),
                "mm",
                "Mean width of the specimen under the confining pressure.",
            ),
        ] {
            report.result(name, value, unit, description);
        }
    }
}
