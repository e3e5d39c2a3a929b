//! What the JSON Schema cannot say of tubes: segments that need no negative spring, lines that rings can
//! follow, and what sheets of tubes do not do.
use super::{BondsAt, ExplicitSheet, PaperTensile, Specimen};
use crate::fibre::{
    FibreError, OnInadmissible, Window, divide_piece, line_length_um, ring_centres,
};
use crate::{Violation, Violations};

/// More points than this are refused.
pub(super) const MOST_POINTS: usize = 2_000_000;

/// At most this many violations of a list are told.
const LISTED: usize = 20;

/// What holds for sheets of both sorts.
pub(super) fn check(spec: &PaperTensile, violations: &mut Violations) {
    let before = violations.count();
    if spec.test.is_zero_span() {
        let detail = "closed jaws hold pieces as long as fibres are wide, shorter than a segment of a tube; take beams";
        violations.push(
            Violation::new("/test/type", "not_of_tubes", detail)
                .value("zero_span")
                .allowed("tensile, or left out; or model.level beam or truss"),
        );
    }
    if spec.accuracy.knobs().bonds_at == BondsAt::Inside {
        let detail = "bonds hold on to the rings of tubes around them, at no nodes of their own, and a factor is made of all";
        violations.push(
            Violation::new("/accuracy/bonds_at", "not_of_tubes", detail)
                .value("inside")
                .allowed("nodes, or left out"),
        );
    }
    for (index, pulp) in spec.pulp.iter().enumerate() {
        let Some(yielding) = pulp.yielding else {
            continue;
        };
        let detail = "tubes are elastic until they break; take beams for fibres that yield";
        violations.push(
            Violation::new(format!("/pulp/{index}/yielding"), "not_of_tubes", detail)
                .value(serde_json::to_value(yielding).unwrap_or_default())
                .allowed("left out, or model.level beam or truss"),
        );
    }
    if violations.count() > before {
        return;
    }
    if let Some(error) = of_pulps(spec) {
        violations.push(indivisible(spec, &error));
        return;
    }
    if let Specimen::Explicit(sheet) = &spec.specimen {
        check_lines(spec, sheet, violations);
    }
}

/// Why fibres of the pulps have no tubes, whatever their length is: the first reason.
fn of_pulps(spec: &PaperTensile) -> Option<FibreError> {
    let division = spec.model.division();
    let used = spec.pulp.iter().filter(|pulp| pulp.mass_fraction > 0.0);
    for pulp in used {
        // wrong ones are told of elsewhere
        let Ok(elasticity) = pulp.elasticity() else {
            continue;
        };
        for section in pulp.fibres().filter_map(|fibre| fibre.section()) {
            let window = section
                .ring_diameter_um(division.ring)
                .and_then(|diameter| {
                    Window::new(division.points_on_ring, diameter, &section, &elasticity)
                });
            match (window, division.segment_um, division.on_inadmissible) {
                (Err(error), ..) => return Some(error),
                (Ok(window), Some(given_um), OnInadmissible::Reject)
                    if !window.admits(given_um) =>
                {
                    return Some(FibreError::Inadmissible {
                        given_um,
                        from_um: window.from_um,
                        to_um: window.to_um,
                    });
                }
                (Ok(_), Some(wanted), OnInadmissible::Robust) => {
                    // ten of them are as long as they are wanted to be
                    let error = divide_piece(10.0 * wanted, &section, &elasticity, &division).err();
                    if error.is_some() {
                        return error;
                    }
                }
                (Ok(_), ..) => {}
            }
        }
    }
    None
}

/// Fibres that are given must be long enough, and turn no more than rings can.
fn check_lines(spec: &PaperTensile, sheet: &ExplicitSheet, violations: &mut Violations) {
    let division = spec.model.division();
    let (mut points, mut wrong) = (0, Vec::new());
    for (index, fibre) in sheet.fibres.iter().enumerate() {
        let pulp = spec.pulp_named(&fibre.pulp);
        let known = pulp.and_then(|pulp| Some((pulp.section().ok()?, pulp.elasticity().ok()?)));
        // points in one place and unknown pulps are told of elsewhere
        let Some((section, elasticity)) = known else {
            return;
        };
        let length_um = line_length_um(&fibre.centre_line_um);
        if !(length_um.is_finite() && length_um > 0.0) {
            return;
        }
        let divided = divide_piece(length_um, &section, &elasticity, &division);
        let error = divided.and_then(|divided| {
            points += (divided.segments + 1) * division.points_on_ring;
            ring_centres(&fibre.centre_line_um, divided.segments, &divided.segment)
        });
        let place = format!("/specimen/explicit/fibres/{index}/centre_line_um");
        match error {
            Err(error @ FibreError::TooBent { at_um, .. }) => wrong.push(
                Violation::new(place, "turns_too_sharply", error.to_string())
                    .value(at_um)
                    .allowed("a smoother line, or longer segments")
                    .unit("µm"),
            ),
            Err(error) => wrong.push(
                Violation::new(place, "fibre_too_short", error.to_string())
                    .value(length_um)
                    .allowed("a fibre as long as a segment")
                    .unit("µm"),
            ),
            Ok(_) => {}
        }
    }
    violations.extend(wrong.into_iter().take(LISTED));
    if points > MOST_POINTS {
        let detail = format!("the tubes of all fibres have {points} points");
        violations.push(
            Violation::new("/model/level", "too_many_points", detail)
                .value("tube")
                .allowed(format!("at most {MOST_POINTS} points, or beams")),
        );
    }
}

/// What to tell of a fibre that has no tube.
pub(super) fn indivisible(spec: &PaperTensile, error: &FibreError) -> Violation {
    let detail = error.to_string();
    let window = |from_um: f64, to_um: f64| format!("{from_um:.4} … {to_um:.4}");
    match error {
        FibreError::Inadmissible {
            given_um,
            from_um,
            to_um,
        } => Violation::new("/model/segment_um", "inadmissible_segment", detail)
            .value(*given_um)
            .allowed(window(*from_um, *to_um))
            .unit("µm"),
        FibreError::NoWholeNumber {
            length_um,
            from_um,
            to_um,
        } => Violation::new("/model/segment_um", "no_whole_number_of_segments", detail)
            .value(*length_um)
            .allowed(format!(
                "a whole number of segments of {}; \"robust\" takes any",
                window(*from_um, *to_um)
            ))
            .unit("µm"),
        FibreError::TooShort { given_um, above_um } => {
            Violation::new("/model/segment_um", "segment_too_short", detail)
                .value(*given_um)
                .allowed(format!("above {above_um:.4}"))
                .unit("µm")
        }
        FibreError::TooBent { at_um, .. } => {
            Violation::new("/model/segment_um", "turns_too_sharply", detail)
                .value(*at_um)
                .allowed("longer segments")
                .unit("µm")
        }
        FibreError::OutOfRange { given, allowed, .. } => {
            let field = match spec.model.ring {
                super::Ring::Patent => "/model/ring",
                super::Ring::Gyration => "/model/points_on_ring",
            };
            Violation::new(field, "out_of_range", detail)
                .value(*given)
                .allowed(allowed.as_str())
        }
    }
}
