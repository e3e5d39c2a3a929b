//! The fibres of a pulp one by one, as a fibre analyser lists them, and what lists must be.
use super::{MeasuredFibres, Pulp};
use crate::fibre::Section;
use crate::{Violation, Violations};

/// One fibre of a pulp: of its list, or the one that it is said to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreSizes {
    pub length_mm: f64,
    pub width_um: f64,
    pub wall_um: f64,
    pub shape_factor: f64,
}

impl FibreSizes {
    /// The wall; none when it is thicker than half the width.
    pub fn section(&self) -> Option<Section> {
        Section::new(self.width_um, self.wall_um).ok()
    }

    /// Thickness of the fibre in the sheet, flattened to a ribbon of its width, A/W [µm].
    pub fn thickness_um(&self) -> Option<f64> {
        Some(self.section()?.area_um2() / self.width_um)
    }
}

impl Pulp {
    /// The fibres that may be drawn, one by one: those of the list, or one of the mean length.
    pub fn fibres(&self) -> impl Iterator<Item = FibreSizes> + '_ {
        let count = self.measured.as_ref().map_or(1, |m| m.lengths_mm.len());
        (0..count).map(|index| {
            let of = |list: fn(&MeasuredFibres) -> Option<&Vec<f64>>| {
                list(self.measured.as_ref()?)?.get(index).copied()
            };
            FibreSizes {
                length_mm: of(|m| Some(&m.lengths_mm))
                    .or(self.length_mm)
                    .unwrap_or(f64::NAN),
                width_um: of(|m| m.widths_um.as_ref()).unwrap_or(self.width_um),
                wall_um: of(|m| m.walls_um.as_ref()).unwrap_or(self.wall_um),
                shape_factor: of(|m| m.shape_factors.as_ref()).unwrap_or(self.shape_factor),
            }
        })
    }

    /// Mean length by number [mm], given or of the list; not a number of a pulp that has neither,
    /// which is refused.
    pub fn mean_length_mm(&self) -> f64 {
        match &self.measured {
            Some(measured) => {
                let lengths = &measured.lengths_mm;
                lengths.iter().sum::<f64>() / lengths.len() as f64
            }
            None => self.length_mm.unwrap_or(f64::NAN),
        }
    }

    /// Width of the narrowest and of the widest fibre [µm].
    pub fn widths_um(&self) -> [f64; 2] {
        let widths = || self.fibres().map(|fibre| fibre.width_um);
        [
            widths().fold(f64::INFINITY, f64::min),
            widths().fold(0.0, f64::max),
        ]
    }

    /// Mass of all fibres over their length [µg/µm]: the coarseness, of a list with walls of unlike
    /// areas that of its mean wall by length, for the density of the wall is one.
    pub fn mean_coarseness_ug_per_um(&self) -> Option<f64> {
        let nominal = self.section().ok()?.area_um2();
        let (mut areas, mut lengths) = (0.0, 0.0);
        for fibre in self.fibres() {
            areas += fibre.section()?.area_um2() * fibre.length_mm;
            lengths += fibre.length_mm;
        }
        Some(self.coarseness_ug_per_um()? * areas / (lengths * nominal))
    }
}

/// Lists that do not fit one another or the pulp; at most one violation of each list.
pub(super) fn check(index: usize, pulp: &Pulp, violations: &mut Violations) {
    let at = |field: &str| format!("/pulp/{index}/{field}");
    let Some(measured) = &pulp.measured else {
        if pulp.length_mm.is_none() {
            let detail = "a pulp has a mean length or a list of measured fibres";
            let violation = Violation::new(at("length_mm"), "missing_field", detail);
            violations.push(violation.allowed("a mean length, or measured"));
        }
        return;
    };
    if let Some(mean_mm) = pulp.length_mm {
        let detail = format!(
            "the fibres are listed, with a mean length of {} mm, and a mean length is given too",
            pulp.mean_length_mm()
        );
        violations.push(
            Violation::new(at("length_mm"), "not_allowed", detail)
                .value(mean_mm)
                .allowed("left out beside measured"),
        );
    }
    if pulp.length_variation > 0.0 {
        let detail = "the fibres are listed, and have the scatter of the list";
        violations.push(
            Violation::new(at("length_variation"), "not_allowed", detail)
                .value(pulp.length_variation)
                .allowed("left out beside measured"),
        );
    }
    let count = measured.lengths_mm.len();
    let before = violations.count();
    for (name, list) in [
        ("widths_um", &measured.widths_um),
        ("walls_um", &measured.walls_um),
        ("shape_factors", &measured.shape_factors),
    ] {
        if let Some(list) = list.as_ref().filter(|list| list.len() != count) {
            let detail = format!("{count} lengths and {} of these are listed", list.len());
            violations.push(
                Violation::new(at(&format!("measured/{name}")), "lists_differ", detail)
                    .value(list.len())
                    .allowed(format!("{count}, as many as lengths")),
            );
        }
    }
    if violations.count() > before {
        return;
    }
    let too_thick = |fibre: &FibreSizes| fibre.section().is_none();
    if let Some((place, fibre)) = pulp.fibres().enumerate().find(|(_, f)| too_thick(f)) {
        let detail = format!(
            "the wall of fibre {place} is {} µm thick and the fibre {} µm wide",
            fibre.wall_um, fibre.width_um
        );
        let list = if measured.walls_um.is_some() {
            "walls_um"
        } else {
            "widths_um"
        };
        violations.push(
            Violation::new(
                at(&format!("measured/{list}/{place}")),
                "wall_above_half_the_width",
                detail,
            )
            .value(fibre.wall_um)
            .allowed(format!("at most {} (half the width)", 0.5 * fibre.width_um))
            .unit("µm"),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    #[allow(clippy::float_cmp, reason = "what is copied is exact")]
    fn a_list_has_its_mean_length_and_the_coarseness_of_its_walls() {
        let pulp = json!({
            "name": "a", "width_um": 20, "wall_um": 2, "coarseness_mg_per_m": 0.1, "youngs_modulus_gpa": 30,
            "poisson_ratio": 0.3, "shear_modulus_gpa": 3,
            "measured": {"lengths_mm": [1, 3], "widths_um": [20, 40]},
        });
        let pulp: Pulp = serde_json::from_value(pulp).expect("a pulp");
        assert!((pulp.mean_length_mm() - 2.0).abs() < 1e-12);
        assert_eq!(pulp.widths_um(), [20.0, 40.0]);
        // areas π 2 (20 - 2) and π 2 (40 - 2), by length, over the first
        let expected = 1e-4 * (18.0 + 3.0 * 38.0) / (4.0 * 18.0);
        let found = pulp.mean_coarseness_ug_per_um().expect("a wall");
        assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
    }
}
