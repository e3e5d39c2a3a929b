//! The normal of the last step, by which a shear force is turned.
//!
//! Spheres come to where they are by x ← x + Δt v (G.9), so that the line between two of them was
//! d₀ = d − Δt (v_b − v_a) a step ago: what follows from numbers at hand need not be kept. Members
//! of clumps move along arcs, and walls of facets have a normal that jumps: there it is kept.
use std::fmt::Debug;

use pulp::Simd;

use crate::contact::packed::Columns;
use crate::numbers::{
    Vector,
    ahead::ask_all,
    lanes::{Array, Lanes, Vectors},
};

/// Where the normals of the last step come from.
pub(crate) trait Normals: Clone + Debug + Default + Send + Sync + 'static {
    /// Whether they follow from velocities.
    const FOLLOW: bool;

    /// The normals of the last step; `followed` are those that follow from velocities.
    fn before<S: Simd>(&self, simd: S, part: usize, followed: Vectors<S>) -> Vectors<S>;

    fn keep<S: Simd>(&mut self, part: usize, normal: Vectors<S>);

    /// Asks for their memory, see [`super::Law::ask`].
    fn ask(&self);

    /// As kept; zero when nothing is.
    fn at(&self, lane: usize) -> Vector;

    fn set(&mut self, lane: usize, normal: Vector);

    /// Shows all that is kept.
    fn show(&mut self, columns: &mut dyn Columns);
}

/// They are remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Kept([Array; 3]);

/// They follow from where the spheres are and how they move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Followed;

impl Normals for Kept {
    const FOLLOW: bool = false;

    #[inline(always)]
    fn before<S: Simd>(&self, simd: S, part: usize, _followed: Vectors<S>) -> Vectors<S> {
        Vectors::load(simd, &self.0, part)
    }

    #[inline(always)]
    fn keep<S: Simd>(&mut self, part: usize, normal: Vectors<S>) {
        normal.store(&mut self.0, part);
    }

    #[inline(always)]
    fn ask(&self) {
        ask_all(&self.0);
    }

    fn at(&self, lane: usize) -> Vector {
        Vector::from(self.0.map(|array| array[lane]))
    }

    fn set(&mut self, lane: usize, normal: Vector) {
        for axis in 0..3 {
            self.0[axis][lane] = normal[axis];
        }
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.all_numbers(&mut self.0);
    }
}

impl Normals for Followed {
    const FOLLOW: bool = true;

    #[inline(always)]
    fn before<S: Simd>(&self, _simd: S, _part: usize, followed: Vectors<S>) -> Vectors<S> {
        followed
    }

    #[inline(always)]
    fn keep<S: Simd>(&mut self, _part: usize, _normal: Vectors<S>) {}

    #[inline(always)]
    fn ask(&self) {}

    fn at(&self, _lane: usize) -> Vector {
        Vector::zeros()
    }

    fn set(&mut self, _lane: usize, _normal: Vector) {}

    fn show(&mut self, _columns: &mut dyn Columns) {}
}

/// The direction of `before`, a vector nearly as long as one with the inverse length `inverse`:
/// 1/|d₀| = (1/|d|)(1 + e)^(−½) with e = |d₀|²/|d|² − 1, by its series to e⁴. In a step no body
/// moves farther than a tenth of its radius, so that |e| < 0.2; a contact at e = 1e-3 is right to
/// round-off.
#[inline(always)]
pub(crate) fn direction<S: Simd>(simd: S, before: Vectors<S>, inverse: Lanes<S>) -> Vectors<S> {
    let number = |value| Lanes::splat(simd, value);
    let e = before.dot(before) * inverse * inverse - number(1.0);
    let series = number(-0.3125) + e * number(0.273_437_5);
    let series = number(1.0) + e * (number(-0.5) + e * (number(0.375) + e * series));
    before.scaled(inverse * series)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Scalar;

    #[test]
    fn a_direction_by_its_series_is_that_by_the_root() {
        // e is twice the stretch, and what is left out of the series (63/256) e⁵
        for (stretch, error) in [(1e-7, 1e-15), (1e-4, 1e-15), (4e-4, 1e-15), (0.1, 1e-4)] {
            let before = Vector::new(0.3, -0.4, 1.2);
            let inverse = 1.0 / (before.norm() * (1.0 + stretch));
            let simd = Scalar::new();
            let vectors = Vectors::splat(simd, before.into());
            let found = direction(simd, vectors, Lanes::splat(simd, inverse));
            let expected = before.normalize();
            assert!((found.x.value - expected.x).abs() < error, "{stretch}");
            assert!((found.z.value - expected.z).abs() < error, "{stretch}");
        }
    }
}
