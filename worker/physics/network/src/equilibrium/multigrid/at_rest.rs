//! One grid over a network of few cells, with its bonds at rest.
//!
//! A handful of cells takes half the iterations away, and the stiffness of each counts for little: one
//! that is a whole test old serves nearly as well as the present one, if it is as stiff on the whole
//! (28 steps of a PET test to rupture took 209 iterations so, 188 with the present stiffness, 409
//! without a grid). Along z a network at rest has no stiffness of the kind that tension gives it, so
//! there the grid finds nothing.
use super::{dense::Inverse, level::Level, mesh::Mesh};
use crate::{assembly::Assembly, field::sum, stiffness::Stiffness};

/// A mesh with more corners needs a hierarchy of grids, which then pays from the start.
const MANY_CORNERS: usize = 500;
/// Corners of the grid: finer ones save less than they cost.
const CORNERS: usize = 64;

/// What is known of the long waves of a network before anything moved or broke.
#[derive(Clone, Debug)]
pub(super) struct AtRest {
    pub(super) mesh: Mesh,
    /// Along x and y.
    pub(super) inverse: Inverse,
    /// Sum of the stiffnesses of the free nodes along x and y [N/mm].
    pub(super) stiffness: f64,
}

impl AtRest {
    /// `None` for a network of no cells or of many, of which these are the `finest`.
    pub(super) fn new(assembly: &Assembly, finest: &Mesh) -> Option<Self> {
        if finest.corners() > MANY_CORNERS {
            return None;
        }
        let mesh = Mesh::over(assembly, CORNERS)?;
        let stiffness: Stiffness<f32> = Stiffness::at_rest(assembly);
        let free = assembly.free();
        let of_slot = |(slot, ends): (usize, &[u32; 2])| {
            let [xx, yy, ..] = stiffness.positive(slot);
            let ends = ends.iter().filter(|end| free.contains(&(**end as usize)));
            (xx + yy) * ends.count() as f32
        };
        let stiffnesses: Vec<f32> = assembly.ends.iter().enumerate().map(of_slot).collect();
        Some(Self {
            inverse: Inverse::new(&Level::finest(&mesh, assembly, &stiffness), 2),
            stiffness: sum(&stiffnesses),
            mesh,
        })
    }
}
