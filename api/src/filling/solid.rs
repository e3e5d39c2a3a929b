//! Ellipsoids, cylinders and boxes filled with equal spheres on a lattice. Lengths [m].
//!
//! The four shapes of [Dubina2014] table 4.11, sphere 24/24/24, ellipsoid 24/30/19, "cylinder"
//! 18/18/40 and "pie" 10/37/37 mm, are ellipsoids with these semi-axes: only then their volumes are
//! nearly equal, as the text says (57.9, 57.3, 54.3 and 57.3 cm³).
//!
//! Touching members leave gaps: those of the 48 mm sphere are 46 % of its volume at 3.6 mm and 35 %
//! at 8.48 mm. A spacing below the diameter fills more.
//!
//! A hexagonal lattice has a point in the middle of the grain: radius 3.55 or 3.6 mm makes touching
//! members of a 48 mm sphere 135, their number in [Lim2004] and [Dubina2014]. A simple cubic lattice
//! has the middle of a cell there: radius 8.48 mm makes the 8 of the coarsest clump. How the members
//! were arranged is not written there.
use nalgebra::Vector3;

use super::lattice::{Arrangement, Lattice};

/// Share of the radius by which a member may be outside: it may touch the surface, rounded.
const ROUND_OFF: f64 = 1e-9;

/// How members sit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    pub(super) radius: f64,
    pub(super) arrangement: Arrangement,
    pub(super) spacing: f64,
}

impl Rows {
    /// Least distance of a member's centre from the surface [m].
    pub(super) fn clearance(&self) -> f64 {
        self.radius * (1.0 - ROUND_OFF)
    }

    /// Members that touch their neighbours.
    #[cfg(test)]
    pub(super) fn touching(radius: f64, arrangement: Arrangement) -> Self {
        Self {
            radius,
            arrangement,
            spacing: 2.0 * radius,
        }
    }
}

/// Members have their centres in the ellipsoid whose semi-axes are shorter by their radius, as in
/// Yade's packs; where curvature changes fast they stand out a little.
pub(super) fn ellipsoid(semi_axes: [f64; 3], rows: Rows) -> Vec<Vector3<f64>> {
    let inner = Vector3::from(semi_axes).add_scalar(-rows.clearance());
    let is_inside = |centre: &Vector3<f64>| centre.component_div(&inner).norm_squared() <= 1.0;
    on_lattice(&inner, rows, is_inside)
}

/// Axis along z; members are wholly inside.
pub(super) fn cylinder(radius: f64, half_height: f64, rows: Rows) -> Vec<Vector3<f64>> {
    let inner = Vector3::new(radius, radius, half_height).add_scalar(-rows.clearance());
    on_lattice(&inner, rows, |centre| centre.xy().norm() <= inner.x)
}

/// Lattice points within a box of half sides `inner` and a condition.
fn on_lattice(
    inner: &Vector3<f64>,
    Rows {
        arrangement,
        spacing,
        ..
    }: Rows,
    is_inside: impl Fn(&Vector3<f64>) -> bool,
) -> Vec<Vector3<f64>> {
    if inner.min() < 0.0 {
        return Vec::new();
    }
    let anchor = match arrangement {
        Arrangement::Hexagonal => Vector3::zeros(),
        Arrangement::SimpleCubic => Vector3::repeat(0.5 * spacing),
    };
    let lattice = Lattice {
        arrangement,
        spacing,
        anchor,
    };
    let mut points = lattice.points_between(&-inner, inner);
    points.retain(is_inside);
    points
}

/// Members touch all faces of the box, in even rows no further apart than the spacing.
pub(super) fn cuboid(sides: [f64; 3], rows: Rows) -> Vec<Vector3<f64>> {
    let reach = sides.map(|side| side - 2.0 * rows.clearance());
    if reach.iter().any(|length| *length < 0.0) {
        return Vec::new();
    }
    // a side no wider than one member has one in its middle
    let gaps = reach.map(|length| (length / rows.spacing - ROUND_OFF).ceil() as usize);
    let at = |axis: usize, number: usize| match gaps[axis] {
        0 => 0.0,
        gaps => reach[axis] * (number as f64 / gaps as f64 - 0.5),
    };
    let mut points = Vec::new();
    for z in 0..=gaps[2] {
        for y in 0..=gaps[1] {
            for x in 0..=gaps[0] {
                let numbers = [x, y, z];
                points.push(Vector3::from_fn(|axis, _| at(axis, numbers[axis])));
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const MM: f64 = 1e-3;

    fn count(semi_axes: [f64; 3], radius: f64, arrangement: Arrangement) -> usize {
        let semi_axes = semi_axes.map(|length| length * MM);
        ellipsoid(semi_axes, Rows::touching(radius * MM, arrangement)).len()
    }

    #[test]
    fn the_48_mm_clump_has_135_members_and_the_coarsest_8() {
        assert_eq!(count([24.0; 3], 3.6, Arrangement::Hexagonal), 135);
        assert_eq!(count([24.0; 3], 3.55, Arrangement::Hexagonal), 135);
        assert_eq!(count([24.0; 3], 8.48, Arrangement::SimpleCubic), 8);
    }

    #[test]
    fn members_of_round_grains_are_inside_and_do_not_overlap() {
        for arrangement in [Arrangement::Hexagonal, Arrangement::SimpleCubic] {
            let ball = ellipsoid([0.024; 3], Rows::touching(0.0036, arrangement));
            assert!(ball.iter().all(|centre| centre.norm() <= 0.0204 + 1e-9));
            let members = cylinder(0.018, 0.02, Rows::touching(0.003, arrangement));
            assert!(
                members
                    .iter()
                    .all(|centre| centre.xy().norm() <= 0.015 + 1e-9
                        && centre.z.abs() <= 0.017 + 1e-9)
            );
            for (number, one) in members.iter().enumerate() {
                let apart = |other: &Vector3<f64>| (one - other).norm() >= 0.006 - 1e-12;
                assert!(members[..number].iter().all(apart));
            }
        }
    }

    /// Nearly equal volumes take nearly the same number of members.
    #[test]
    fn the_four_shapes_of_the_thesis_have_similar_numbers_of_members() {
        let shapes = [
            [24.0; 3],
            [24.0, 30.0, 19.0],
            [18.0, 18.0, 40.0],
            [10.0, 37.0, 37.0],
        ];
        let inner = |axes: [f64; 3]| axes.map(|axis| axis - 3.6).iter().product::<f64>();
        for axes in shapes {
            let count = count(axes, 3.6, Arrangement::Hexagonal);
            // π/√18 of the volume open to centres, give or take the surface layer
            let volume = 4.0 / 3.0 * std::f64::consts::PI * inner(axes);
            let expected = volume / (7.2_f64.powi(3) / 2.0_f64.sqrt());
            assert!(
                (count as f64 / expected - 1.0).abs() < 0.15,
                "{axes:?}: {count} {expected}"
            );
        }
    }

    #[test]
    fn a_box_is_filled_to_its_faces() {
        let sides = [0.25, 0.3, 0.15];
        let members = cuboid(sides, Rows::touching(0.005, Arrangement::SimpleCubic));
        assert_eq!(members.len(), 25 * 30 * 15);
        for (axis, side) in sides.into_iter().enumerate() {
            let reach = members.iter().map(|centre| centre[axis] + 0.005);
            let reach = reach.fold(0.0, f64::max);
            assert!((reach - 0.5 * side).abs() < 1e-9);
        }
        // rows come closer where they do not fit evenly, and a rail of one layer stays one
        let wider = Rows {
            spacing: 0.011,
            ..Rows::touching(0.005, Arrangement::SimpleCubic)
        };
        assert_eq!(cuboid([0.25, 0.15, 0.01], wider).len(), 23 * 14);
    }

    #[test]
    fn members_larger_than_the_grain_do_not_fit() {
        let large = Rows::touching(0.0101, Arrangement::Hexagonal);
        assert!(ellipsoid([0.01, 0.037, 0.037], large).is_empty());
        assert!(cylinder(0.02, 0.01, large).is_empty());
        assert!(cuboid([0.1, 0.1, 0.02], large).is_empty());
    }
}
