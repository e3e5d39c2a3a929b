//! What a contact remembers from step to step, whatever its law is.
use serde::{Deserialize, Serialize};

use crate::numbers::Vector;

/// What a contact remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Past {
    /// n₀, from a to b.
    pub(crate) normal: Vector,
    /// F_T on b [N].
    pub(crate) shear: Vector,
    /// √δ that the shear force belongs to, where that matters [√m].
    pub(crate) root: f64,
    /// Moments on b of what resists rolling, and of twisting along the normal [N m].
    pub(crate) rolling: Vector,
    pub(crate) twisting: f64,
    /// tan φ that it had, where it is to be kept.
    pub(crate) friction: Option<f64>,
    /// The bond between the bodies, also after it broke.
    pub(crate) bond: Bond,
    /// v_N in the middle of the last step [m/s], where a dashpot works along the normal.
    pub(crate) approach: Option<f64>,
    /// v_T of b then [m/s], where one works across it.
    pub(crate) slip: Option<Vector>,
}

/// A bond and what is left of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bond {
    pub(crate) is_intact: bool,
    /// a_N and a_T [N].
    pub(crate) strength: [f64; 2],
    /// Overlap without force [m].
    pub(crate) rest: f64,
    /// What it bends and twists with beside that, where it does.
    pub(crate) beam: Beam,
}

/// State of a bond that bends and twists, beside its moments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Beam {
    /// Overlap at which it carries no force along it [m].
    pub(crate) rest: f64,
    /// L [m].
    pub(crate) length: f64,
    /// F_T on b [N].
    pub(crate) shear: Vector,
}

impl Past {
    /// The same contact with its bodies in the other order.
    pub(crate) fn seen_from_b(&self) -> Self {
        Self {
            normal: -self.normal,
            shear: -self.shear,
            rolling: -self.rolling,
            slip: self.slip.map(|slip| -slip),
            bond: Bond {
                beam: Beam {
                    shear: -self.bond.beam.shear,
                    ..self.bond.beam
                },
                ..self.bond
            },
            ..*self
        }
    }
}
