//! F_N = k_N δ and nothing else.
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{Law, Past, Push, Slip, Touch};
use crate::granular::lanes::Vectors;

/// No friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::granular) struct Frictionless;

impl Law for Frictionless {
    const IS_ROUGH: bool = false;

    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        _part: usize,
        touch: Touch<S>,
        _slip: Slip<S>,
        _time_step: f64,
    ) -> Push<S> {
        Push {
            normal: touch.stiffness * touch.overlap,
            shear: Vectors::zero(simd),
            acts: touch.is_touching,
        }
    }

    #[inline(always)]
    fn forget<S: Simd>(&mut self, _simd: S, _part: usize) {}

    fn past(&self, _lane: usize) -> Past {
        Past::default()
    }

    fn set_past(&mut self, _lane: usize, _past: &Past) {}
}
