//! Where rollers make the cells of a graded grid small, about: the engine does it with the contacts that it finds,
//! the estimate with those of a beam on them.
use super::lowest::average;
use super::{CompositeBending, Way};
use crate::section::contact::{CONTACT_CELLS, CONTACT_REACH, hertz_half_width_mm};
use crate::section::lines::Fine;
use crate::section::stiffness::compliance;

/// What is small beneath rollers, along x and along y; nothing without rollers, or of materials without constants.
pub(super) fn beneath_rollers(spec: &CompositeBending) -> [Vec<Fine>; 2] {
    let mut fine = [Vec::new(), Vec::new()];
    let way = spec.test.way();
    let Some((way, (_, test))) = way.and_then(|way| Some((way, way.flexure()?))) else {
        return fine;
    };
    let Some((stiffness, _)) = average(spec, 1.0) else {
        return fine;
    };
    let section = &spec.section;
    let inertia = section.thickness_mm * section.height_mm.powi(3) / 12.0;
    // three-point flexure of a slender beam
    let per_mm = 48.0 / compliance(&stiffness)[(0, 0)] * inertia / test.span_mm.powi(3);
    let driven = test.displacement_mm.map(|way| way * per_mm);
    let Some(force) = test.force_n.or(driven) else {
        return fine;
    };
    let above: &[f64] = match way {
        Way::FourPoint(_) => &[-1.0 / 6.0, 1.0 / 6.0],
        _ => &[0.0],
    };
    let each = force / above.len() as f64;
    let beneath = [-0.5, 0.5].map(|share| (share, 0.0, 0.5 * force, test.support_radius_mm));
    let pressed = above
        .iter()
        .map(|share| (*share, section.height_mm, each, test.loading_radius_mm));
    for (share, y, force, radius) in beneath.into_iter().chain(pressed) {
        let half_width = hertz_half_width_mm(&stiffness, section.thickness_mm, radius, force);
        let x = 0.5 * section.length_mm + share * test.span_mm;
        let reach = CONTACT_REACH * half_width;
        for (fine, at) in fine.iter_mut().zip([x, y]) {
            fine.push(Fine {
                between: [at - reach, at + reach],
                size: half_width / CONTACT_CELLS as f64,
            });
        }
    }
    fine
}
