//! Fibres as tubes of points and springs, held together by bonds.
//!
//! Nodes are the points of rings, with three motions each. A segment of a fibre is all springs from one ring to the
//! next, and breaks as one; the springs of a ring never break. Sections carry the same loads as a beam's: the force along
//! the fibre, and the moments about the centres of both rings, summed up from its springs, so that a fibre breaks by the
//! same rule. A bond takes hold of a point of both fibres, where they touch ([`Hold`]), and is the same six springs
//! there as between beams. A point moves with the rings around it:
//! [`Joint`] spreads force and moment over their points and loses nothing of either.
//!
//! From the bottom up: [`PointSprings`] are springs over any points, [`hold`] is how a bond holds, and this
//! file joins both. Knows no equilibrium, and no network: [`Network::of_tubes`](super::Network::of_tubes) makes one of these.
mod hold;
mod point_springs;

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

pub(crate) use hold::{Hold, Joint, Ring};
pub(crate) use point_springs::{PointSpring, PointSprings};

use super::balance::Motion;
use super::element::{PARTS, TAUT, axes_along};
use crate::fibre::{Sort, Tube};

/// The tubes of a network.
#[derive(Debug, Clone)]
pub(crate) struct Tubes {
    /// Points of every ring.
    pub(crate) points_on_ring: usize,
    /// Segments by fibre, then bonds, then rings.
    pub(crate) parts: Vec<PointSprings>,
    pub(crate) joints: Vec<Joint>,
    /// First ring of every segment.
    pub(crate) first_rings: Vec<u32>,
    /// Whether a bond holds on to a segment.
    pub(crate) has_bonds: Vec<bool>,
}

impl Tubes {
    /// Number of rings of all fibres.
    pub(crate) fn rings(&self) -> usize {
        self.parts.len() - self.first_rings.len() - self.joints.len()
    }

    /// The first node of a ring.
    pub(crate) fn node_of(&self, ring: u32) -> u32 {
        ring * self.points_on_ring as u32
    }

    /// Pairs of nodes that hang together while these parts are whole.
    pub(crate) fn links(&self, is_whole: &[bool]) -> Vec<[u32; 2]> {
        let rings = 0..self.rings() as u32;
        let count = self.points_on_ring as u32;
        let around = rings.flat_map(|ring| {
            let first = self.node_of(ring);
            (1..count).map(move |point| [first, first + point])
        });
        let along = self.first_rings.iter();
        let along = along.map(|&ring| [ring, ring + 1].map(|ring| self.node_of(ring)));
        let bonds = self.joints.iter();
        let bonds = bonds.map(|joint| joint.holds.map(|hold| self.node_of(hold.nearer())));
        let parts = along.chain(bonds).zip(is_whole);
        let whole = parts.filter_map(|(pair, is_whole)| is_whole.then_some(pair));
        around.chain(whole).collect()
    }

    /// Largest turn of a ring as a body [rad].
    pub(crate) fn largest_turn(&self, positions: &[Vector3<f64>], motion: &Motion) -> f64 {
        let turns = (0..self.rings()).map(|ring| {
            let ring = self.ring(positions, ring as u32);
            let moved = |point: usize| motion.nodes[ring.first as usize + point][0];
            let sum: Vector3<f64> = (0..self.points_on_ring)
                .map(|point| ring.arms[point].cross(&moved(point)))
                .sum();
            ring.per_moment(sum).norm()
        });
        turns.fold(0.0, f64::max)
    }

    pub(crate) fn ring(&self, positions: &[Vector3<f64>], ring: u32) -> Ring {
        Ring::new(positions, self.node_of(ring), self.points_on_ring)
    }
}

/// The springs of a tube whose first point is node `first`: those of every segment, and those of every ring.
pub(crate) fn springs_of(tube: &Tube, first: u32) -> [Vec<PointSprings>; 2] {
    let count = tube.segment().points_on_ring() as u32;
    let mut segments = vec![Vec::new(); tube.segments()];
    let mut rings = vec![Vec::new(); tube.segments() + 1];
    let at = |point: u32| Vector3::from(tube.places_um()[point as usize]);
    let centres: Vec<Vector3<f64>> = (0..=tube.segments())
        .map(|ring| tube.centre_um(ring).into())
        .collect();
    for spring in tube.springs() {
        let [low, high] = spring.points;
        let direction = (at(high) - at(low)).normalize();
        let between = |direction: Vector3<f64>, stiffness: f64, loads: [f64; PARTS]| PointSpring {
            entries: vec![(first + low, -direction), (first + high, direction)],
            stiffness,
            loads,
        };
        let ring = (low / count) as usize;
        match spring.sort {
            Sort::Along | Sort::Diagonal => {
                let arms = [at(low) - centres[ring], at(high) - centres[ring + 1]];
                let loads = section_loads(centres[ring + 1] - centres[ring], arms, direction);
                segments[ring].push(between(direction, spring.stiffness_mn_per_um, loads));
            }
            Sort::Around | Sort::Across | Sort::Second => {
                rings[ring].push(between(direction, spring.stiffness_mn_per_um, [0.0; PARTS]));
            }
        }
    }
    let first_of = |ring: usize| ring as u32 * count;
    let stiffest = |ring: &[PointSpring]| ring.iter().map(|one| one.stiffness).fold(0.0, f64::max);
    for (ring, springs) in rings.iter_mut().enumerate() {
        let points: Vec<Vector3<f64>> =
            (0..count).map(|point| at(first_of(ring) + point)).collect();
        let warping = warping(&points, first + first_of(ring), TAUT * stiffest(springs));
        springs.extend(warping);
    }
    [segments, rings].map(|all| all.into_iter().map(PointSprings::new).collect())
}

/// Springs against what bends a ring out of its plane, cos kφ and sin kφ of the angle φ for k from 2 to N/2. Where both
/// segments are torn from a ring nothing else holds these modes. No motion of a body strains them, nor does a force or moment
/// of a bond, so that they need only be there.
fn warping(
    points: &[Vector3<f64>],
    first: u32,
    stiffness: f64,
) -> impl Iterator<Item = PointSpring> {
    let ring = Ring::new(points, 0, points.len());
    let count = points.len();
    let waves = (2..=count / 2).flat_map(move |waves| {
        // with half as many waves as points the sine is nought on all of them
        let phases: &[f64] = if 2 * waves == count {
            &[0.0]
        } else {
            &[0.0, 0.5 * PI]
        };
        phases.iter().map(move |phase| (waves as f64, *phase))
    });
    waves.map(move |(waves, phase)| {
        let height = |point: usize| (waves * TAU * point as f64 / count as f64 - phase).cos();
        let entries = (0..count).map(|point| (first + point as u32, ring.normal * height(point)));
        PointSpring {
            entries: entries.collect(),
            stiffness,
            loads: [0.0; PARTS],
        }
    })
}

/// What a unit of tension of a spring is worth in the loads of its segment, `along` it: the force along it, the torque,
/// and the moments M₁ and M₂ about the centres of both rings, as (M₂ ∓ M₁)/2 like those of a beam.
fn section_loads(
    along: Vector3<f64>,
    arms: [Vector3<f64>; 2],
    direction: Vector3<f64>,
) -> [f64; PARTS] {
    let axes = axes_along(along);
    let force = axes * direction;
    let [first, second] = arms.map(|arm| axes * arm.cross(&direction));
    let (changing, uniform) = (0.5 * (second - first), 0.5 * (second + first));
    let torque = first.x;
    [
        force.x, changing.y, changing.z, torque, uniform.y, uniform.z,
    ]
}
