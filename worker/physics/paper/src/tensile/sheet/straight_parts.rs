//! How much too stiff a sheet is for the straight parts of its fibres' lines, as measured before.
//!
//! A straight part cuts the waves of a fibre that climbs over others, and the longer it is and the steeper
//! fibres climb the more. Held against the lines as they are laid, in parts of a quarter of a width; how
//! finely those are laid is not looked at. `tests/figures paper_straight_parts` measures the table again.
use loadframe_api::spec::paper_tensile::{Level, PaperTensile, Placement, Specimen as Kind};
use loadframe_api::{ErrorBasis, ErrorPart, Spec as _, Tenth};

/// Length of parts over the width of the narrowest fibre; the first are those of the lines themselves.
const WIDTHS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Flexibilities of deposition.
const FLEXIBILITIES: [f64; 3] = [0.1, 0.2, 0.4];
/// Stiffness above that of the lines, over it, by flexibility: five sheets each of 0.8 mm x 0.5 mm,
/// 25 g/m², softwood 28 µm wide with a wall of 2 µm. Other grammages (15 and 60 g/m²), thicker walls and
/// hardwood are within a factor 2.
const TOO_STIFF: [[f64; 6]; 3] = [
    [0.0, 0.0052, 0.0156, 0.0343, 0.0569, 0.0864],
    [0.0, 0.0208, 0.0610, 0.1285, 0.2110, 0.2899],
    [0.0, 0.0601, 0.1783, 0.3337, 0.5349, 0.6642],
];
/// Fibres more curled than this were not measured.
const LEAST_SHAPE: f64 = 0.9;
/// Grammages that were [g/m²].
const GRAMMAGES: [f64; 2] = [10.0, 100.0];

/// The part of the error of a stiffness that straight parts make; none outside of what was measured.
pub(super) fn error(spec: &PaperTensile, stiffness: f64) -> Option<ErrorPart> {
    let Kind::Sheet(made) = &spec.specimen else {
        return None;
    };
    let Placement::Deposition(deposition) = made.placement else {
        return None;
    };
    let grammages = GRAMMAGES[0]..=GRAMMAGES[1];
    let mut shapes = spec.pulp.iter().flat_map(|pulp| pulp.fibres());
    let is_measured = spec.level() == Level::Beam
        && grammages.contains(&made.grammage_g_per_m2)
        && shapes.all(|fibre| fibre.shape_factor >= LEAST_SHAPE);
    let widths = spec.sheet_segment_um() / spec.narrowest_um();
    let row = position(&FLEXIBILITIES, deposition.flexibility)?;
    let column = position(&WIDTHS, widths)?;
    let too_stiff = |column: (usize, f64)| {
        let along = |row: usize| between(&TOO_STIFF[row], column);
        let (first, share) = row;
        (1.0 - share) * along(first) + share * along(first + 1)
    };
    // what is too stiff by a share is above what it should be by that share of the latter
    let off = |column: (usize, f64)| stiffness * too_stiff(column) / (1.0 + too_stiff(column));
    let value = off(column);
    is_measured.then(|| {
        // the longest of them that will do
        let tenth = SHARES
            .iter()
            .map(|share| share * widths)
            .find(|widths| position(&WIDTHS, *widths).is_some_and(|at| off(at) <= 0.1 * value))
            .and_then(|widths| with_parts(spec, widths * spec.narrowest_um()));
        ErrorPart::new("straight_parts", value, ErrorBasis::MeasuredTable).with_tenth(tenth)
    })
}

/// Lengths of parts that are tried for what a digit costs, over the present one.
const SHARES: [f64; 7] = [0.5, 0.3, 0.2, 0.12, 0.08, 0.05, 0.03];

/// The same sheet in shorter parts.
fn with_parts(spec: &PaperTensile, segment_um: f64) -> Option<Tenth> {
    // two digits say it as well
    let scale = 10.0_f64.powf(segment_um.log10().floor() - 1.0);
    let segment_um = (segment_um / scale).floor() * scale;
    let mut shorter = spec.clone();
    shorter.model.segment_um = Some(segment_um);
    spec.tenth(format!("model.segment_um {segment_um}"), &shorter)
}

/// Between which two of a rising list a value lies, and how far; none outside.
pub(super) fn position(list: &[f64], value: f64) -> Option<(usize, f64)> {
    let is_within = list.first()? <= &value && &value <= list.last()?;
    let first = list.partition_point(|&one| one <= value);
    let first = first.clamp(1, list.len() - 1) - 1;
    is_within.then(|| {
        (
            first,
            (value - list[first]) / (list[first + 1] - list[first]),
        )
    })
}

pub(super) fn between(list: &[f64], (first, share): (usize, f64)) -> f64 {
    (1.0 - share) * list[first] + share * list[first + 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn found(change: impl FnOnce(&mut Value)) -> Option<f64> {
        let mut spec = json!({
            "version": 1,
            "pulp": [{"name": "a", "length_mm": 1, "width_um": 28, "wall_um": 2, "youngs_modulus_gpa": 30,
                      "poisson_ratio": 0.3, "shear_modulus_gpa": 3}],
            "specimen": {"sheet": {"length_mm": 1, "width_mm": 1, "grammage_g_per_m2": 25}},
        });
        change(&mut spec);
        let spec = serde_json::from_value(spec).unwrap();
        error(&spec, 2.0).map(|part| part.value)
    }

    #[test]
    fn the_error_is_that_of_the_table_and_of_what_lies_between() {
        let near = |found: Option<f64>, share: f64| {
            let expected = 2.0 * share / (1.0 + share);
            assert!((found.unwrap() - expected).abs() < 1e-12, "{found:?}");
        };
        // the preset `standard` and its flexibility of 0.2
        near(found(|_| {}), 0.061);
        near(found(|spec| spec["accuracy"] = json!("draft")), 0.211);
        let half = (0.0610 + 0.1285) / 2.0;
        near(
            found(|spec| spec["model"] = json!({"segment_um": 42})),
            half,
        );
        let flexible = |flexibility: f64| {
            found(|spec| {
                spec["specimen"]["sheet"]["placement"] =
                    json!({"deposition": {"flexibility": flexibility}});
            })
        };
        near(flexible(0.3), (0.0610 + 0.1783) / 2.0);
        near(flexible(0.4), 0.1783);
        assert_eq!(flexible(0.5), None);
    }

    #[test]
    fn a_digit_costs_shorter_parts() {
        let spec = |widths: f64| {
            let spec = json!({
                "version": 1,
                "pulp": [{"name": "a", "length_mm": 1, "width_um": 28, "wall_um": 2,
                          "youngs_modulus_gpa": 30, "poisson_ratio": 0.3, "shear_modulus_gpa": 3}],
                "specimen": {"sheet": {"length_mm": 1, "width_mm": 1, "grammage_g_per_m2": 25}},
                "model": {"segment_um": 28.0 * widths},
            });
            serde_json::from_value(spec).unwrap()
        };
        // 0.0610 at one width; 0.0061 lies between a quarter, 0, and a half, 0.0208: at 0.3 of a width
        let part = error(&spec(1.0), 2.0).unwrap();
        let tenth = part.tenth.unwrap();
        assert_eq!(tenth.change, "model.segment_um 8.4");
        assert!((1.0..100.0).contains(&tenth.time_factor), "{tenth:?}");
        // below a quarter of a width nothing was measured
        assert_eq!(error(&spec(0.3), 2.0).unwrap().tenth, None);
    }

    #[test]
    fn nothing_is_said_of_what_was_not_measured() {
        let sheet = |name: &'static str, value: Value| {
            found(|spec| spec["specimen"]["sheet"][name] = value)
        };
        assert_eq!(sheet("grammage_g_per_m2", json!(5)), None);
        assert_eq!(
            sheet("placement", json!({"random": {"thickness_um": 50}})),
            None
        );
        assert_eq!(
            found(|spec| spec["pulp"][0]["shape_factor"] = json!(0.8)),
            None
        );
        assert_eq!(
            found(|spec| spec["model"] = json!({"level": "truss"})),
            None
        );
        assert_eq!(
            found(|spec| spec["model"] = json!({"segment_um": 300})),
            None
        );
    }
}
