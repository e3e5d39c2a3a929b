//! How far results are off where parts break together, as measured before.
//!
//! Parts at about their strength, by `break_precision`, break with one solution. Measured against one by one, on eight
//! sheets of beams of 0.7 to 1.5 mm length, half as wide, at 30 g/m² with bonds at nodes, and on eight trusses of 0.7 to
//! 1 mm at 60 g/m² with bonds inside straight parts and bars that are taut by 1e-4. The root of the mean square of what
//! they were off, and no less than at a finer precision, which chance may make it. `tests/figures paper_together
//! paper_together_trusses` measures it again.
use loadframe_api::spec::paper_tensile::{Accuracy, Level, PaperTensile};
use loadframe_api::{ErrorBasis, ErrorPart, Spec as _};

use super::straight_parts::{between, position};

const PRECISIONS: [f64; 5] = [0.0, 0.02, 0.05, 0.1, 0.2];

/// Deviations over the result, by precision.
struct Deviations {
    force: [f64; 5],
    stretch: [f64; 5],
    energy: [f64; 5],
}

const OF_BEAMS: Deviations = Deviations {
    force: [0.0, 0.035, 0.051, 0.084, 0.125],
    stretch: [0.0, 0.121, 0.121, 0.170, 0.221],
    energy: [0.0, 0.181, 0.181, 0.267, 0.364],
};
const OF_TRUSSES: Deviations = Deviations {
    force: [0.0, 0.031, 0.056, 0.070, 0.073],
    stretch: [0.0, 0.076, 0.247, 0.309, 0.345],
    energy: [0.0, 0.102, 0.331, 0.407, 0.455],
};

/// What a result is of.
#[derive(Clone, Copy)]
pub(super) enum Of {
    Force,
    Stretch,
    Energy,
}

/// The part of the error of a result that breaking together makes; none where parts break one by one, and
/// outside of what was measured.
pub(super) fn error(spec: &PaperTensile, of: Of, value: f64) -> Option<ErrorPart> {
    let precision = spec.accuracy.knobs().break_precision;
    if precision <= 0.0 {
        return None;
    }
    let deviations = match spec.level() {
        Level::Truss => &OF_TRUSSES,
        Level::Beam | Level::Tube => &OF_BEAMS,
    };
    let off = match of {
        Of::Force => &deviations.force,
        Of::Stretch => &deviations.stretch,
        Of::Energy => &deviations.energy,
    };
    let share = between(off, position(&PRECISIONS, precision)?);
    // the coarsest of some finer ones that is a tenth as far off
    let finer = [0.5, 0.2, 0.1, 0.05, 0.02].map(|share| share * precision);
    let is_tenth = |finer: &f64| {
        position(&PRECISIONS, *finer).is_some_and(|at| between(off, at) <= 0.1 * share)
    };
    let tenth = finer.into_iter().find(is_tenth).and_then(|finer| {
        let mut changed = spec.clone();
        let mut knobs = spec.accuracy.knobs();
        knobs.break_precision = finer;
        changed.accuracy = Accuracy::Knobs(knobs);
        spec.tenth(format!("accuracy.break_precision {finer}"), &changed)
    });
    let part = ErrorPart::new("break_precision", share * value, ErrorBasis::MeasuredTable);
    Some(part.with_tenth(tenth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn found(level: &str, precision: f64, of: Of) -> Option<f64> {
        let spec = json!({
            "version": 1,
            "pulp": [{"name": "a", "length_mm": 1, "width_um": 28, "wall_um": 2, "youngs_modulus_gpa": 30,
                      "poisson_ratio": 0.3, "shear_modulus_gpa": 3}],
            "specimen": {"sheet": {"length_mm": 1, "width_mm": 1, "grammage_g_per_m2": 25}},
            "model": {"level": level},
            "accuracy": {"break_precision": precision},
        });
        error(&serde_json::from_value(spec).unwrap(), of, 2.0).map(|part| part.value)
    }

    #[test]
    fn the_error_is_that_of_the_table_and_of_what_lies_between() {
        assert_eq!(found("beam", 0.0, Of::Force), None);
        assert_eq!(found("truss", 0.3, Of::Force), None);
        for (level, precision, of, share) in [
            ("beam", 0.05, Of::Force, 0.051),
            ("beam", 0.075, Of::Force, 0.5 * (0.051 + 0.084)),
            ("beam", 0.1, Of::Stretch, 0.170),
            ("tube", 0.01, Of::Energy, 0.0905),
            ("truss", 0.05, Of::Force, 0.056),
            ("truss", 0.1, Of::Stretch, 0.309),
            ("truss", 0.01, Of::Energy, 0.051),
        ] {
            let told = found(level, precision, of).unwrap();
            assert!((told - 2.0 * share).abs() < 1e-12, "{level}, {precision}");
        }
    }
}
