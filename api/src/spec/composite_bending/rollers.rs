//! Where rollers make the cells of a graded grid small, about: the engine does it with the contacts that it finds,
//! the estimate with those of a beam on them.
use super::lowest::average;
use super::{CompositeBending, Way};
use crate::section::contact::{CONTACT_CELLS, CONTACT_REACH, hertz_half_width_mm};
use crate::section::lines::Fine;
use crate::section::stiffness::compliance;

/// Contacts narrower than this share of the height add hardly a line.
const LEAST_SHARE: f64 = 1e-6;

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
        // before a spec is checked it may say anything
        if !(half_width > 0.0 && half_width.is_finite()) {
            continue;
        }
        let half_width = half_width
            .max(LEAST_SHARE * section.height_mm)
            .min(section.length_mm);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{JobSpec, Submission};

    fn bent(test: &str) -> CompositeBending {
        let body = format!(
            r#"{{"kind": "composite_bending", "spec": {{"version": 1,
            "section": {{"length_mm": 60, "height_mm": 4, "thickness_mm": 1, "state": "plane_stress"}},
            "materials": {{"m": {{"isotropic": {{"youngs_modulus_mpa": 3000, "poisson_ratio": 0.35}}}}}},
            "matrix": "m", "grid": {{"cells": [60, 4], "graded_cells_per_fibre": 2}},
            "test": {{"three_point": {test}}}}}}}"#
        );
        let submission = Submission::from_slice(body.as_bytes()).expect("a job");
        let JobSpec::CompositeBending(spec) = submission.spec else {
            panic!("of another kind");
        };
        *spec
    }

    #[test]
    fn cells_are_small_beneath_rollers_whatever_presses() {
        let of = |test: &str| bent(test).particles();
        let usual = of(r#"{"span_mm": 48, "force_n": 10}"#);
        // three rollers, each on some lines of its own along both axes
        assert!((1_000..20_000).contains(&usual), "{usual}");
        let lightly = of(r#"{"span_mm": 48, "force_n": 1e-12}"#);
        assert!((usual..100_000).contains(&lightly), "{lightly}");
        let driven = of(r#"{"span_mm": 48, "displacement_mm": 1e6}"#);
        assert!((305..=usual).contains(&driven), "{driven}");
    }
}
