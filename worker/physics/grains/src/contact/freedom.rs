//! What is left of a body's freedom at a contact where some of its degrees of freedom are held.
//!
//! Dashpots are made for the mass that a contact moves. Of a body of mass m whose held axes are left out a
//! force F along the unit vector n moves the place of contact along n by
//!
//!   F Σ_free n_i²/m (G.35)
//!
//! as if it had the mass m/Σ: m where nothing is held, without limit where all that lies along n is. Across
//! n a force along t moves it by F (Σ_free t_i² + 5/2 Σ_free (n × t)_i²)/m, the second sum over rotations, of a
//! sphere, which is 7/2 where nothing is held; the t counts that gives most, since along that the
//! contact swings: in a scene of two dimensions the one in its plane. Moments turn it by the
//! rotations that are left, along n and across it alike.
//!
//! Normals are those of the moment in which contacts are listed: until they are listed anew, nothing
//! comes farther than the skin.
use crate::numbers::Vector;

/// Parts of the inverse mass of a body that are left [-]: of the motion along the normal and across it, and of
/// rolling and twisting; all 1 of a body that is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Freedom {
    pub(crate) along: f64,
    pub(crate) across: f64,
    /// Of rolling and twisting.
    pub(crate) turning: [f64; 2],
}

/// Bits of all rotations among degrees of freedom: walls do not turn with what they touch.
pub(crate) const ROTATIONS: u8 = 0b111_000;

/// Shares of translation and rotation in how far a push across the normal moves a sphere, with I = 2/5 m r².
const ACROSS: [f64; 2] = [2.0 / 7.0, 5.0 / 7.0];

impl Freedom {
    /// Nothing is held.
    pub(crate) const WHOLE: Self = Self {
        along: 1.0,
        across: 1.0,
        turning: [1.0; 2],
    };

    /// At a contact of this unit normal; bits of `fixed` are x, y, z, rx, ry, rz.
    pub(crate) fn left(fixed: u8, normal: &Vector) -> Self {
        if fixed == 0 {
            return Self::WHOLE;
        }
        let (ways, turns) = (fixed & 0b111, fixed >> 3);
        let [first, second] = across(normal);
        let pushed = |s: &Vector, t: &Vector| {
            let [way, turn] = ACROSS;
            way * part(ways, s, t) + turn * part(turns, &normal.cross(s), &normal.cross(t))
        };
        let turned = |s: &Vector, t: &Vector| part(turns, s, t);
        let most = |of: &dyn Fn(&Vector, &Vector) -> f64| {
            largest([
                of(&first, &first),
                of(&first, &second),
                of(&second, &second),
            ])
        };
        Self {
            along: part(ways, normal, normal),
            across: most(&pushed),
            turning: [most(&turned), part(turns, normal, normal)],
        }
    }
}

/// Σ s_i t_i over the axes that are free, for s and t of length 1 that are equal or at right angles. By those that
/// are held where these are the less: exact where s and t have no part in them.
fn part(held: u8, s: &Vector, t: &Vector) -> f64 {
    let sum = |is_held: bool| -> f64 {
        let axes = (0..3).filter(|axis| (held >> axis & 1 == 1) == is_held);
        axes.map(|axis| s[axis] * t[axis]).sum()
    };
    let whole = if s == t { 1.0 } else { 0.0 };
    match held {
        0 => whole,
        0b111 => 0.0,
        _ if sum(true).abs() < 0.5 => whole - sum(true),
        _ => sum(false),
    }
}

/// Two unit vectors across a third one and each other.
fn across(normal: &Vector) -> [Vector; 2] {
    let least = normal.iamin();
    let first = normal.cross(&Vector::ith(least, 1.0)).normalize();
    [first, normal.cross(&first)]
}

/// The larger eigenvalue of the symmetric matrix (a b; b c).
fn largest([a, b, c]: [f64; 3]) -> f64 {
    0.5 * (a + c) + (0.5 * (a - c)).hypot(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_left(fixed: u8, normal: [f64; 3], along: f64, across: f64, turning: [f64; 2]) {
        let left = Freedom::left(fixed, &Vector::from(normal));
        let found = [left.along, left.across, left.turning[0], left.turning[1]];
        let expected = [along, across, turning[0], turning[1]];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{left:?} {expected:?}");
        }
    }

    #[test]
    fn what_is_held_takes_its_part_of_the_freedom() {
        let oblique = [0.6, 0.0, 0.8];
        assert_left(0, oblique, 1.0, 1.0, [1.0; 2]);
        // z held: 0.6² along n; across it along y, with the rotation, nothing is lost
        assert_left(0b000_100, oblique, 0.36, 1.0, [1.0; 2]);
        assert_left(0b000_100, [0.0, 0.0, 1.0], 0.0, 1.0, [1.0; 2]);
        // a scene in the plane of x and z: nothing is lost in it, and nothing twists
        assert_left(0b101_010, oblique, 1.0, 1.0, [1.0, 0.0]);
        // all rotations: 2/7 of what a push across moves is translation
        assert_left(0b111_000, oblique, 1.0, 2.0 / 7.0, [0.0; 2]);
        // all translations: 5/7 is rotation
        assert_left(0b000_111, oblique, 0.0, 5.0 / 7.0, [1.0; 2]);
        assert_left(0b111_111, oblique, 0.0, 0.0, [0.0; 2]);
        // a plate that follows x alone, met along x and along z
        assert_left(0b111_110, [1.0, 0.0, 0.0], 1.0, 0.0, [0.0; 2]);
        assert_left(0b111_110, [0.0, 0.0, 1.0], 0.0, 2.0 / 7.0, [0.0; 2]);
        // y and rz held, met along z: a push along x turns about y, one along y about x
        assert_left(0b100_010, [0.0, 0.0, 1.0], 1.0, 1.0, [1.0, 0.0]);
    }
}
