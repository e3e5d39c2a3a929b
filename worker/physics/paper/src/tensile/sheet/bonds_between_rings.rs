//! How much too stiff a sheet of tubes is for bonds that hang between its rings, as measured before.
//!
//! A place of a tube moves with straight lines between two rings, so that no fibre kinks at a bond, nor between two
//! bonds of one segment. Shorter segments take it away: the same sheets in segments of a third of the length
//! are as stiff as beams, which kink at their bonds. `tests/figures paper_tubes` measures the table again.
use loadframe_api::spec::paper_tensile::{PaperTensile, Placement, Specimen as Kind};
use loadframe_api::{ErrorBasis, ErrorPart};

use super::bonds_inside::above;
use super::straight_parts::{between, position};
use crate::frame::Network;

/// Points of bonds, two each, over rings.
const CROWDING: [f64; 8] = [0.0, 0.21, 0.28, 0.36, 0.38, 0.59, 0.72, 0.79];
/// Stiffness above that of beams on the same lines, over the latter: means of six sheets of 0.6 mm x 0.4 mm each, at
/// 10, 20 and 40 g/m², in segments of 33, 16 and 12 µm, with deviations of 0.015 to 0.04.
const TOO_STIFF: [f64; 8] = [0.0, 0.007, 0.022, 0.053, 0.056, 0.112, 0.154, 0.163];

/// The part of the error of a stiffness that straight lines between rings make; none outside of what was
/// measured.
pub(super) fn error(spec: &PaperTensile, network: &Network, stiffness: f64) -> Option<ErrorPart> {
    let rings = network.rings()?;
    let Kind::Sheet(made) = &spec.specimen else {
        return None;
    };
    let Placement::Deposition(_) = made.placement else {
        return None;
    };
    let value = off(2.0 * network.bonds() as f64 / rings as f64, stiffness)?;
    let basis = ErrorBasis::MeasuredTable;
    Some(ErrorPart::new("bonds_between_rings", value, basis))
}

fn off(crowding: f64, stiffness: f64) -> Option<f64> {
    let too_stiff = between(&TOO_STIFF, position(&CROWDING, crowding)?);
    Some(above(stiffness, too_stiff))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_that_of_the_table_and_of_what_lies_between() {
        for (crowding, share) in [(0.0, 0.0), (0.72, 0.154), (0.655, 0.133)] {
            let found = off(crowding, 2.0).unwrap();
            let expected = 2.0 * share / (1.0 + share);
            assert!((found - expected).abs() < 1e-12, "{found}");
        }
        assert_eq!(off(0.8, 2.0), None);
    }
}
