//! Rollers that find room, and one drive.
use crate::spec::composite_bending::{CompositeBending, Flexure, Solver};
use crate::{Violation, Violations};

pub(super) fn check_flexure(
    spec: &CompositeBending,
    name: &str,
    flexure: &Flexure,
    loading: u32,
    violations: &mut Violations,
) {
    let pointer = |field: &str| format!("/test/{name}/{field}");
    if flexure.displacement_mm.is_some() == flexure.force_n.is_some() {
        violations.push(
            Violation::new(
                format!("/test/{name}"),
                "not_one_drive",
                "the rollers are driven by a way or by a force",
            )
            .allowed("exactly one of: displacement_mm, force_n"),
        );
    }
    let length = spec.section.length_mm;
    if flexure.span_mm >= length {
        violations.push(
            Violation::new(
                pointer("span_mm"),
                "out_of_range",
                "the supports are beyond the ends",
            )
            .value(flexure.span_mm)
            .allowed(format!("< length_mm = {length}"))
            .unit("mm"),
        );
    }
    // neighbouring rollers of one side must not meet, nor those of the other in the specimen's middle
    let room = flexure.span_mm / 2.0;
    if flexure.support_radius_mm > room {
        violations.push(
            Violation::new(
                pointer("support_radius_mm"),
                "out_of_range",
                "the supports meet",
            )
            .value(flexure.support_radius_mm)
            .allowed(format!("≤ span_mm / 2 = {room}"))
            .unit("mm"),
        );
    }
    let room = if loading == 2 {
        flexure.span_mm / 6.0
    } else {
        room
    };
    if flexure.loading_radius_mm > room {
        violations.push(
            Violation::new(
                pointer("loading_radius_mm"),
                "out_of_range",
                "the loading rollers are wider than the span has room for",
            )
            .value(flexure.loading_radius_mm)
            .allowed(format!("≤ {room}"))
            .unit("mm"),
        );
    }
    let knobs = spec.accuracy.knobs();
    if knobs.solver != Solver::Static {
        violations.push(
            Violation::new(
                "/accuracy/solver",
                "not_allowed",
                "rollers need the solver static",
            )
            .allowed("\"static\" with rollers"),
        );
    }
}
