//! How much too stiff a sheet is for bonds inside the straight parts of its fibres, as measured before.
//!
//! With bonds inside, a fibre moves between its nodes as a beam does that is loaded at its ends alone: it
//! cannot kink where a bond pulls. That is a constraint, so that the sheet is always too stiff, the more the
//! more bonds there are for each node.
use loadframe_api::spec::paper_tensile::{
    Accuracy, BondsAt, Knobs, Level, PaperTensile, Specimen as Kind,
};
use loadframe_api::{ErrorBasis, ErrorPart, Spec as _};

use super::straight_parts::{between, position};
use crate::frame::Network;

/// Points of bonds, two each, over nodes of fibres.
const CROWDING: [f64; 4] = [0.0, 0.64, 1.17, 2.13];
/// Stiffness above that with bonds at nodes on the same straight parts, over the latter: one sheet of
/// 1 mm x 0.5 mm at 60 g/m² with parts of 28, 56 and 112 µm (guide, "Large sheets").
/// `tests/figures paper_bonds_inside` measures it again, by free nodes.
const TOO_STIFF: [f64; 4] = [0.0, 0.08, 0.17, 0.30];

/// The part of the error of a stiffness that bonds inside straight parts make; none outside of what was
/// measured.
pub(super) fn error(spec: &PaperTensile, network: &Network, stiffness: f64) -> Option<ErrorPart> {
    let knobs = spec.accuracy.knobs();
    let is_measured = matches!(spec.specimen, Kind::Sheet(_)) && spec.level() == Level::Beam;
    if knobs.bonds_at == BondsAt::Nodes || !is_measured {
        return None;
    }
    let value = off(
        2.0 * network.bonds() as f64 / network.fibre_nodes() as f64,
        stiffness,
    )?;
    let mut changed = spec.clone();
    changed.accuracy = Accuracy::Knobs(Knobs {
        bonds_at: BondsAt::Nodes,
        ..knobs
    });
    let tenth = spec.tenth("accuracy.bonds_at nodes".to_owned(), &changed);
    Some(ErrorPart::new("bonds_inside", value, ErrorBasis::MeasuredTable).with_tenth(tenth))
}

fn off(crowding: f64, stiffness: f64) -> Option<f64> {
    let too_stiff = between(&TOO_STIFF, position(&CROWDING, crowding)?);
    Some(above(stiffness, too_stiff))
}

/// What is too stiff by a share is above what it should be by that share of the latter.
pub(super) fn above(stiffness: f64, too_stiff: f64) -> f64 {
    stiffness * too_stiff / (1.0 + too_stiff)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_that_of_the_table_and_of_what_lies_between() {
        for (crowding, share) in [(0.0, 0.0), (0.32, 0.04), (1.17, 0.17), (1.65, 0.235)] {
            let found = off(crowding, 2.0).unwrap();
            assert!(
                (found - 2.0 * share / (1.0 + share)).abs() < 1e-12,
                "{found}"
            );
        }
        assert_eq!(off(2.2, 2.0), None);
    }
}
