//! How a bond holds on to a tube: by the points of the rings around the place where it is.
//!
//! A ring of N points x on a circle of radius R about its centre c, across its normal n, moves in the mean as a
//! body. With r = x - c and Σ r rᵀ = N R²/2 (1 - n nᵀ) its rotation in the sense of least squares is
//!
//! ```text
//! θ = M⁻¹ Σ r × u,   M⁻¹ a = (2 a - n (n·a))/(N R²)
//! ```
//!
//! and a point p of its plane moves by the weights w = 1/N + 2 r·(p - c)/(N R²), which sum to 1 and have Σ w x = p. What
//! acts on p acts on the points by the same weights, with the same force and the same moment about any
//! point; a moment a acts as forces (M⁻¹ a) × r, which have no resultant. A place between two rings moves with both, each by
//! its share of the way. When the segment between them is torn it goes with the nearer ring as with a body: what is
//! left between them is a stub.
use nalgebra::{Matrix3, Vector3};

use super::super::element::PARTS;
use super::point_springs::{PointSpring, PointSprings};

/// A ring at rest.
#[derive(Debug, Clone)]
pub(crate) struct Ring {
    /// Its first node; the others follow.
    pub(crate) first: u32,
    pub(crate) centre: Vector3<f64>,
    pub(crate) normal: Vector3<f64>,
    /// r of every point.
    pub(crate) arms: Vec<Vector3<f64>>,
    /// N R².
    spread: f64,
}

impl Ring {
    /// The ring of `count` points from node `first` on.
    pub(crate) fn new(positions: &[Vector3<f64>], first: u32, count: usize) -> Self {
        let points = &positions[first as usize..first as usize + count];
        let centre = points.iter().sum::<Vector3<f64>>() / count as f64;
        let arms: Vec<Vector3<f64>> = points.iter().map(|point| point - centre).collect();
        Self {
            first,
            centre,
            // neighbours are a quarter of a circle apart or less
            normal: arms[0].cross(&arms[1]).normalize(),
            spread: arms.iter().map(Vector3::norm_squared).sum(),
            arms,
        }
    }

    /// M⁻¹ a.
    pub(crate) fn per_moment(&self, moment: Vector3<f64>) -> Vector3<f64> {
        (moment * 2.0 - self.normal * self.normal.dot(&moment)) / self.spread
    }

    /// Displacement along `direction` of the place of its plane at `from_centre`.
    fn shift(
        &self,
        from_centre: Vector3<f64>,
        direction: Vector3<f64>,
    ) -> impl Iterator<Item = (u32, Vector3<f64>)> + '_ {
        let count = self.arms.len() as f64;
        let weight =
            move |arm: &Vector3<f64>| 1.0 / count + 2.0 * arm.dot(&from_centre) / self.spread;
        let points = (self.first..).zip(&self.arms);
        points.map(move |(point, arm)| (point, direction * weight(arm)))
    }

    /// Rotation about `axis`.
    fn turn(&self, axis: Vector3<f64>) -> impl Iterator<Item = (u32, Vector3<f64>)> + '_ {
        let axis = self.per_moment(axis);
        let points = (self.first..).zip(&self.arms);
        points.map(move |(point, arm)| (point, axis.cross(arm)))
    }
}

/// Where a bond holds on to a fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hold {
    pub(crate) segment: u32,
    /// The ring before it; the next is the one behind.
    pub(crate) ring: u32,
    /// Share of the way from the one to the other.
    pub(crate) share: f64,
    /// Where the fibres touch [µm].
    pub(crate) at: Vector3<f64>,
}

impl Hold {
    /// The ring that it goes with when its segment is torn.
    pub(crate) fn nearer(&self) -> u32 {
        self.ring + u32::from(self.share >= 0.5)
    }

    /// Displacement along and rotation about a direction, by displacements of points.
    fn felt(
        &self,
        positions: &[Vector3<f64>],
        count: usize,
        is_whole: bool,
        direction: Vector3<f64>,
    ) -> [Vec<(u32, Vector3<f64>)>; 2] {
        let ring = |ring: u32| Ring::new(positions, ring * count as u32, count);
        if !is_whole {
            let ring = ring(self.nearer());
            let away = self.at - ring.centre;
            // e·(θ × d) = θ·(d × e) for what d has out of the plane
            let out = ring.normal * ring.normal.dot(&away);
            let lifted = ring.turn(out.cross(&direction));
            let shift = ring.shift(away, direction).zip(lifted);
            let shift = shift.map(|((point, one), (_, other))| (point, one + other));
            return [shift.collect(), ring.turn(direction).collect()];
        }
        let rings = [ring(self.ring), ring(self.ring + 1)];
        let shares = [1.0 - self.share, self.share];
        let centre = rings[0].centre * shares[0] + rings[1].centre * shares[1];
        let mut felt = [Vec::new(), Vec::new()];
        for (ring, share) in rings.iter().zip(shares) {
            felt[0].extend(ring.shift(self.at - centre, direction * share));
            felt[1].extend(ring.turn(direction * share));
        }
        felt
    }
}

/// A bond of two tubes.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) holds: [Hold; 2],
    /// Axes as rows, the first across its face.
    pub(crate) axes: Matrix3<f64>,
    /// Against displacement and rotation along the axes, as between beams [mN/µm, mN µm].
    pub(crate) stiffness: [f64; PARTS],
}

impl Joint {
    /// Its springs while the segments that it holds on to are whole, or not.
    pub(crate) fn springs(
        &self,
        positions: &[Vector3<f64>],
        points_on_ring: usize,
        are_whole: [bool; 2],
    ) -> PointSprings {
        let mut springs: Vec<PointSpring> = Vec::with_capacity(PARTS);
        let mut turning: Vec<PointSpring> = Vec::with_capacity(PARTS);
        for axis in 0..3 {
            let direction = self.axes.row(axis).transpose();
            let sides = [(0, -1.0), (1, 1.0)].map(|(side, sign)| {
                let (hold, is_whole) = (&self.holds[side], are_whole[side]);
                hold.felt(positions, points_on_ring, is_whole, direction * sign)
            });
            let [one, other] = sides;
            for (sort, (one, other)) in one.into_iter().zip(other).enumerate() {
                let part = 3 * sort + axis;
                let mut loads = [0.0; PARTS];
                loads[part] = 1.0;
                let spring = PointSpring {
                    entries: one.into_iter().chain(other).collect(),
                    stiffness: self.stiffness[part],
                    loads,
                };
                if sort == 0 {
                    springs.push(spring);
                } else {
                    turning.push(spring);
                }
            }
        }
        springs.extend(turning);
        PointSprings::new(springs)
    }
}
