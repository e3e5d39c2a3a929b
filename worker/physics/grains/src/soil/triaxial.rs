//! A triaxial test's terms.
//!
//! With the places of the walls, sides l_x, l_y, l_z and the forces F on them (compression positive),
//! σ_a = F_z/(l_x l_y), σ_r the mean of F_x/(l_y l_z) and F_y/(l_x l_z); q = σ_a − σ_r,
//! p = (σ_a + 2 σ_r)/3; ε_a = 1 − l_z/l_z₀, ε_v = 1 − V/V₀ (compression positive). The mobilised angle of a soil
//! without cohesion is sin φ = (σ_a − σ_r)/(σ_a + σ_r), the angle of dilatancy
//! sin ψ = (dε_v/dε_a)/(dε_v/dε_a − 2) ([SchanzVermeer1996]), the secant modulus q/ε_a at half the peak of q
//! beyond that at the start. The void ratio is of the solid volume in the box, e = n/(1 − n).
use loadframe_api::spec::soil::{SAMPLE, Script, Triaxial};
use loadframe_api::{ErrorBasis, ErrorPart, Report};
use loadframe_harness::{ReportBuilder, curve};

use super::{
    Measured, Reading,
    angles::{critical, secant, slope_at},
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
        let to_peak = &deviator[..=peak];
        let at_half = secant(to_peak, 0.5);
        if at_half.is_some_and(|(strain, _)| strain < deviator[1].0) {
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
                at_half.map_or(f64::NAN, |(_, modulus)| 1e3 * modulus),
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

    /// The secant modulus is read where half the peak is reached. Where the curve is flat there, as that of a loose
    /// soil is, a peak that is a little higher is reached by half much later.
    fn propagate(&self, report: &mut Report, rows: &Rows) {
        let kept = rows.kept(self.kept_stress());
        let deviator = points(&kept, AXIAL_STRAIN, DEVIATOR);
        let Some(peak) = curve::peak(&points(&kept, AXIAL_STRAIN, ANGLE)) else {
            return;
        };
        let known = |name: &str| {
            let found = report.summary.get(name)?;
            Some((found.value?, found.error.clone()?))
        };
        let (Some((strength, of_strength)), Some((modulus, error))) =
            (known("peak_deviator_stress"), known("secant_modulus"))
        else {
            return;
        };
        let by = |part: ErrorPart| {
            let relative = part.value / strength.abs();
            let beside = [1.0 - relative, 1.0 + relative]
                .into_iter()
                .filter_map(|times| secant(&deviator[..=peak], 0.5 * times));
            let largest = beside
                .map(|(_, beside)| (1e3 * beside - modulus).abs())
                .fold(0.0, f64::max);
            ErrorPart::new(&part.source, largest, ErrorBasis::Propagated)
        };
        let parts = error.parts.into_iter();
        let parts = parts.chain(of_strength.parts.into_iter().map(by)).collect();
        if let Some(modulus) = report.summary.get_mut("secant_modulus") {
            *modulus = modulus.clone().with_error(parts);
        }
    }
}

#[cfg(test)]
mod tests {
    use loadframe_api::Quantity;

    use super::*;

    /// Parts of the error of the secant modulus, given those of a strength of 100 kPa and that the modulus has one.
    fn parts(curve: &[(f64, f64)], of_strength: &[(&str, f64)], has_error: bool) -> Vec<ErrorPart> {
        let test = curve.iter().map(|(strain, deviator)| {
            let mut row = vec![0.0; 13];
            (row[AXIAL_STRAIN], row[DEVIATOR]) = (*strain, *deviator);
            (row[ANGLE], row[RADIAL]) = (*deviator, 50.0);
            row
        });
        let rows = Rows {
            test: test.collect(),
            ..Rows::default()
        };
        let part = |(source, value): &(&str, f64)| {
            ErrorPart::new(source, *value, ErrorBasis::MeasuredTable)
        };
        let mut report = Report::default();
        let strength = Quantity::new(1e5, "Pa", "");
        let parts = of_strength.iter().map(part).collect();
        report.summary.insert(
            "peak_deviator_stress".to_owned(),
            strength.with_error(parts),
        );
        let modulus = secant(curve, 0.5).map_or(f64::NAN, |(_, modulus)| 1e3 * modulus);
        let own = part(&("specimens", 2e6));
        let parts = if has_error { vec![own] } else { Vec::new() };
        let modulus = Quantity::new(modulus, "Pa", "").with_error(parts);
        report.summary.insert("secant_modulus".to_owned(), modulus);
        let test = Triaxial {
            confining_pressure_pa: 5e4,
            ..serde_json::from_str(
                r#"{"width_m": 0.1, "height_m": 0.2, "confining_pressure_pa": 5e4, "axial_strain": 0.1}"#,
            )
            .expect("a test")
        };
        test.propagate(&mut report, &rows);
        let error = report.summary["secant_modulus"].error.clone();
        error.map_or_else(Vec::new, |error| error.parts)
    }

    #[test]
    fn a_modulus_that_is_read_where_the_curve_is_flat_has_the_error_that_the_peak_makes_of_it() {
        // 50 kPa at 0.01, where the curve turns: 45 kPa at 0.009, 55 at 0.02
        let flat = [(0.0, 0.0), (0.01, 50.0), (0.02, 55.0), (0.05, 100.0)];
        let found = parts(&flat, &[("specimens", 1e4), ("preset", 2e4)], true);
        let told: Vec<_> = found
            .iter()
            .map(|part| (&*part.source, part.basis))
            .collect();
        assert_eq!(
            told,
            [
                ("specimens", ErrorBasis::MeasuredTable),
                ("specimens", ErrorBasis::Propagated),
                ("preset", ErrorBasis::Propagated),
            ]
        );
        // 5 MPa; 55 kPa at 0.02 is 2.75 MPa, and 60 kPa at 0.02 + 5/45 of 0.03 is 2.571 MPa
        let expected = [
            2e6,
            2.25e6,
            1e6 * (5.0 - 60e-3 / (0.02 + 0.03 * 5.0 / 45.0)),
        ];
        for (part, expected) in found.iter().zip(expected) {
            assert!(
                (part.value / expected - 1.0).abs() < 1e-9,
                "{part:?} {expected}"
            );
        }
        // along a straight line it is the same wherever it is read
        let straight = [(0.0, 0.0), (0.05, 100.0)];
        let found = parts(&straight, &[("specimens", 1e4)], true);
        assert!(found[1].value < 1e-6, "{found:?}");
        assert_eq!(parts(&flat, &[("specimens", 1e4)], false), []);
        assert_eq!(parts(&flat, &[], true).len(), 1);
    }
}
