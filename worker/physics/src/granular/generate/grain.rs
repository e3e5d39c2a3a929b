//! Grains made of equal spheres on a lattice.
//!
//! The four shapes of [Dubina2014] table 4.11, sphere 24/24/24, ellipsoid 24/30/19, "cylinder"
//! 18/18/40 and "pie" 10/37/37 mm, are ellipsoids with these semi-axes: only then their volumes are
//! nearly equal, as the text says (57.9, 57.3, 54.3 and 57.3 cm³).
//!
//! Touching members leave gaps: those of the 48 mm sphere are 46 % of its volume at 3.6 mm and 35 %
//! at 8.48 mm. A spacing below the diameter fills more.
use nalgebra::Vector3;

use crate::granular::{
    lattice::{Arrangement, Lattice},
    sphere::Sphere,
};

/// Share of the radius by which a member may be outside: it may touch the surface, rounded.
const ROUND_OFF: f64 = 1e-9;

/// Outer shape of a grain, its middle in the origin. Lengths [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GrainShape {
    /// Members have their centres in the ellipsoid whose semi-axes are shorter by their radius, as
    /// in Yade's packs; where curvature changes fast they stand out a little.
    Ellipsoid { semi_axes: [f64; 3] },
    /// Axis along z; members are wholly inside.
    Cylinder { radius: f64, half_height: f64 },
    /// Members touch all faces, the spacing shrinks until rows fit.
    Cuboid { sides: [f64; 3] },
    #[allow(dead_code, reason = "the sleeper of the box test, whose mass is given")]
    /// The outermost layer of the cuboid: what others can touch. Its inside is empty, so that mass
    /// and inertia have to be given.
    CuboidShell { sides: [f64; 3] },
}

/// Why a grain cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum GrainError {
    #[error("no member of radius {radius} m fits into {shape:?} (lengths in m)")]
    NothingFits { radius: f64, shape: GrainShape },
}

/// Member spheres of a grain: equal, on a lattice of the given spacing, inside the shape.
///
/// A hexagonal lattice has a point in the middle of the grain: radius 3.55 or 3.6 mm makes touching
/// members of a 48 mm sphere 135, their number in [Lim2004] and [Dubina2014]. A simple cubic lattice
/// has the middle of a cell there: radius 8.48 mm makes the 8 of the coarsest clump. How the members
/// were arranged is not written there.
///
/// # Errors
/// See [`GrainError`].
pub(crate) fn members(
    shape: &GrainShape,
    radius: f64,
    arrangement: Arrangement,
    spacing: f64,
) -> Result<Vec<Sphere>, GrainError> {
    let centres = match *shape {
        GrainShape::Ellipsoid { semi_axes } => {
            let inner = Vector3::from(semi_axes).add_scalar(-radius * (1.0 - ROUND_OFF));
            let is_inside =
                |centre: &Vector3<f64>| centre.component_div(&inner).norm_squared() <= 1.0;
            on_lattice(&inner, arrangement, spacing, is_inside)
        }
        GrainShape::Cylinder {
            radius: outer,
            half_height,
        } => {
            let less = radius * (1.0 - ROUND_OFF);
            let inner = Vector3::new(outer, outer, half_height).add_scalar(-less);
            on_lattice(&inner, arrangement, spacing, |centre| {
                centre.xy().norm() <= inner.x
            })
        }
        GrainShape::Cuboid { sides } => in_rows(sides, radius, spacing, false),
        GrainShape::CuboidShell { sides } => in_rows(sides, radius, spacing, true),
    };
    if centres.is_empty() {
        return Err(GrainError::NothingFits {
            radius,
            shape: *shape,
        });
    }
    Ok(centres
        .into_iter()
        .map(|centre| Sphere::new(centre, radius))
        .collect())
}

/// Lattice points within a box of half sides `inner` and a condition.
fn on_lattice(
    inner: &Vector3<f64>,
    arrangement: Arrangement,
    spacing: f64,
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

/// Points of a cuboid in evenly spaced rows, no further apart than the spacing.
fn in_rows(sides: [f64; 3], radius: f64, spacing: f64, is_shell: bool) -> Vec<Vector3<f64>> {
    let reach = sides.map(|side| side - 2.0 * radius * (1.0 - ROUND_OFF));
    if reach.iter().any(|length| *length < 0.0) {
        return Vec::new();
    }
    // a side no wider than one member has one in its middle
    let gaps = reach.map(|length| (length / spacing - ROUND_OFF).ceil() as usize);
    let at = |axis: usize, number: usize| match gaps[axis] {
        0 => 0.0,
        gaps => reach[axis] * (number as f64 / gaps as f64 - 0.5),
    };
    let mut points = Vec::new();
    for z in 0..=gaps[2] {
        for y in 0..=gaps[1] {
            for x in 0..=gaps[0] {
                let numbers = [x, y, z];
                let is_outermost = (0..3).any(|axis| [0, gaps[axis]].contains(&numbers[axis]));
                if is_outermost || !is_shell {
                    points.push(Vector3::from_fn(|axis, _| at(axis, numbers[axis])));
                }
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const MM: f64 = 1e-3;

    fn ellipsoid(semi_axes: [f64; 3]) -> GrainShape {
        let semi_axes = semi_axes.map(|length| length * MM);
        GrainShape::Ellipsoid { semi_axes }
    }

    fn count(shape: &GrainShape, radius: f64, arrangement: Arrangement) -> usize {
        let radius = radius * MM;
        members(shape, radius, arrangement, 2.0 * radius)
            .expect("it fits")
            .len()
    }

    #[test]
    fn the_48_mm_clump_has_135_members_and_the_coarsest_8() {
        let sphere = ellipsoid([24.0; 3]);
        assert_eq!(count(&sphere, 3.6, Arrangement::Hexagonal), 135);
        assert_eq!(count(&sphere, 3.55, Arrangement::Hexagonal), 135);
        assert_eq!(count(&sphere, 8.48, Arrangement::SimpleCubic), 8);
    }

    #[test]
    fn members_of_round_grains_are_inside_and_do_not_overlap() {
        let cylinder = GrainShape::Cylinder {
            radius: 0.018,
            half_height: 0.02,
        };
        for arrangement in [Arrangement::Hexagonal, Arrangement::SimpleCubic] {
            let sphere = members(&ellipsoid([24.0; 3]), 0.0036, arrangement, 0.0072).expect("fits");
            assert!(
                sphere
                    .iter()
                    .all(|member| member.centre.norm() <= 0.0204 + 1e-9)
            );
            let members = members(&cylinder, 0.003, arrangement, 0.006).expect("it fits");
            assert!(members.iter().all(|member| {
                member.centre.xy().norm() <= 0.015 + 1e-9 && member.centre.z.abs() <= 0.017 + 1e-9
            }));
            for (number, one) in members.iter().enumerate() {
                let apart = |other: &Sphere| (one.centre - other.centre).norm() >= 0.006 - 1e-12;
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
        let counts = shapes.map(|axes| count(&ellipsoid(axes), 3.6, Arrangement::Hexagonal));
        let inner = |axes: [f64; 3]| axes.map(|axis| axis - 3.6).iter().product::<f64>();
        for (axes, count) in shapes.into_iter().zip(counts) {
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
    fn a_sleeper_reaches_its_faces() {
        let sides = [0.25, 0.3, 0.15];
        let solid = GrainShape::Cuboid { sides };
        let shell = GrainShape::CuboidShell { sides };
        let [solid, shell] = [solid, shell]
            .map(|shape| members(&shape, 0.005, Arrangement::SimpleCubic, 0.01).expect("it fits"));
        assert_eq!(solid.len(), 25 * 30 * 15);
        assert_eq!(shell.len(), 25 * 30 * 15 - 23 * 28 * 13);
        let reach = |axis: usize| {
            shell
                .iter()
                .map(move |member| member.centre[axis] + member.radius)
        };
        for (axis, side) in sides.into_iter().enumerate() {
            let reach = reach(axis).fold(0.0, f64::max);
            assert!((reach - 0.5 * side).abs() < 1e-9);
        }
        // rows come closer where they do not fit evenly, and a rail of one layer stays one
        let rail = GrainShape::Cuboid {
            sides: [0.25, 0.15, 0.01],
        };
        let rail = members(&rail, 0.005, Arrangement::SimpleCubic, 0.011).expect("it fits");
        assert_eq!(rail.len(), 23 * 14);
    }

    #[test]
    fn members_larger_than_the_grain_are_refused() {
        for shape in [
            ellipsoid([10.0, 37.0, 37.0]),
            GrainShape::Cylinder {
                radius: 0.02,
                half_height: 0.01,
            },
            GrainShape::Cuboid {
                sides: [0.1, 0.1, 0.02],
            },
        ] {
            let error =
                members(&shape, 0.0101, Arrangement::Hexagonal, 0.0202).expect_err("too large");
            assert!(
                error
                    .to_string()
                    .starts_with("no member of radius 0.0101 m fits into")
            );
        }
    }
}
