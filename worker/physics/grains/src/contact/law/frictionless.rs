//! A normal spring and nothing else.
use std::marker::PhantomData;

use pulp::Simd;

use super::super::{packed::Columns, past::Past};
use super::{ContactForces, Lanewise, Law, Normal, Push, Slip, Spring, Touch};
use crate::numbers::{
    Vector,
    lanes::{Lanes, Vectors},
};

/// No friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Frictionless<N: Normal>(PhantomData<N>);

impl<N: Normal> Law for Frictionless<N> {
    type Normal = N;
    const IS_ROUGH: bool = false;
    const FOLLOWS_NORMALS: bool = false;

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
            normal: N::force(simd, &touch),
            shear: Vectors::zero(simd),
            limit: Lanes::splat(simd, 0.0),
            compression: touch.overlap,
            acts: touch.is_touching,
            moment: None,
        }
    }

    #[inline(always)]
    fn ask(&self) {}

    #[inline(always)]
    fn forget<S: Simd>(&mut self, _simd: S, _part: usize) {}
}

impl<N: Normal> Lanewise for Frictionless<N> {
    fn past(&self, _lane: usize) -> Past {
        Past::default()
    }

    fn remember(&mut self, _lane: usize, _past: &Past) {}

    fn forces(&self, _lane: usize, spring: &Spring) -> ContactForces {
        ContactForces::spring::<N>(spring, 0.0, Vector::zeros())
    }

    fn show(&mut self, _columns: &mut dyn Columns) {}
}
