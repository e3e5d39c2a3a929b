//! A section before it breaks: what its parts bear, and what of it was never bonded.
use super::composition::{Bearing, compose};
use super::options::{BetweenPlies, BreakingOptions, MaterialStrength, check};
use super::part::{Damage, Part};
use super::parts::Parts;
use super::saw::RESIDUAL;
use super::scatter::Drawn;
use crate::error::CompositeError;
use crate::lattice::Lattice;
use crate::section::Layout;
use crate::stiffness::Stiffness;

/// A section with what was never bonded.
pub(super) struct Begun {
    pub(super) damage: Vec<Damage>,
    pub(super) bearings: Vec<Bearing>,
    pub(super) lost: Vec<f64>,
    pub(super) lattice: Lattice,
}

impl Begun {
    pub(super) fn new(layout: &Layout, parts: &Parts, teeth: u16) -> Self {
        let law = |part: &Part| &parts.laws[part.law as usize];
        let mut begun = Self {
            damage: (parts.all.iter())
                .map(|part| Damage::none(law(part)))
                .collect(),
            bearings: vec![Bearing::default(); parts.all.len()],
            lost: vec![0.0; layout.grid().cells()],
            lattice: Lattice::exact(layout),
        };
        for &place in &parts.open {
            begun.damage[place as usize] = Damage::unbonded(law(&parts.all[place as usize]), teeth);
        }
        for cell in 0..layout.grid().cells() {
            let of = parts.of(cell);
            let damage = &begun.damage[of.clone()];
            let left = compose(
                &parts.all[of.clone()],
                &parts.laws,
                damage,
                teeth,
                &mut begun.bearings[of],
            );
            if !damage.iter().all(Damage::is_none) {
                begun.lost[cell] = lost(&layout.stiffness()[cell], &left.stiffness);
                begun.lattice.replace_stiffness(cell, left);
            }
        }
        begun
    }
}

/// The lattice of a section in which some faces between plies are open, and nothing has broken yet.
///
/// # Errors
/// As [`Breaking::new`].
pub fn opened_lattice(
    layout: &Layout,
    strengths: &[MaterialStrength],
    between_plies: &BetweenPlies,
    options: &BreakingOptions,
) -> Result<Lattice, CompositeError> {
    let drawn = Drawn::new(options.scatter.as_ref(), options.seed)?;
    let parts = Parts::new(layout, strengths, between_plies, options.criterion, &drawn)?;
    Ok(Begun::new(layout, &parts, check(options)?).lattice)
}

/// 1 - the smallest λ of C n = λ C₀ n: the part of the stiffness that is lost in the strain n.
pub(super) fn lost(intact: &Stiffness, left: &Stiffness) -> f64 {
    let Some(root) = intact.cholesky().map(|factor| factor.l()) else {
        return 0.0;
    };
    let Some(inverse) = root.try_inverse() else {
        return 0.0;
    };
    let share = (inverse * left * inverse.transpose()).symmetric_eigenvalues();
    let lost = 1.0 - share.min();
    // what is kept for the equations' sake is none
    if lost > 1.0 - 2.0 * RESIDUAL {
        1.0
    } else {
        lost.max(0.0)
    }
}
