//! Regular places and random directions.
use std::f64::consts::TAU;

use loadframe_api::filling::{Arrangement, Lattice};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{Rng, RngExt as _};

use super::Region;
use crate::geometry::sphere::Sphere;

/// Places a bound may be missed by [share of the spacing], rounded.
const ROUND_OFF: f64 = 1e-9;

/// Centres [m] on a lattice for spheres of `radius` that stay inside a region, from below upwards.
///
/// The lattice starts in the lower corner of a cuboid, on the axis of a cylinder and in the middle of a ball. Each centre
/// is moved by a random vector no longer than `jitter` [m]; spheres do not overlap as long as
/// 2 radius + 2 jitter ≤ spacing.
pub(crate) fn place_regularly(
    region: &Region,
    arrangement: Arrangement,
    spacing: f64,
    radius: f64,
    jitter: f64,
    random: &mut impl Rng,
) -> Vec<Vector3<f64>> {
    let Some(inner) = region.inset(radius + jitter) else {
        return Vec::new();
    };
    let anchor = match inner {
        Region::Cuboid { lower, .. } => lower,
        Region::Cylinder { base, .. } => base,
        Region::Ball { centre, .. } => centre,
    };
    let [lower, upper] = inner.bounds();
    let lattice = Lattice {
        arrangement,
        spacing,
        anchor,
    };
    let mut centres = lattice.points_between(&lower, &upper);
    centres.retain(|centre| inner.contains(centre, ROUND_OFF * spacing));
    for centre in &mut centres {
        // a point of the unit ball, all equally likely
        let step = loop {
            let step = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0_f64));
            if step.norm_squared() <= 1.0 {
                break step;
            }
        };
        *centre += step * jitter;
    }
    centres
}

/// Radius [m] of the sphere about `centre` that holds all members: what a grain needs to be placed
/// before it is turned.
pub(crate) fn bounding_radius(members: &[Sphere], centre: &Vector3<f64>) -> f64 {
    let reaches = members
        .iter()
        .map(|member| (member.centre - centre).norm() + member.radius);
    reaches.fold(0.0, f64::max)
}

/// A rotation, all equally likely. Source: K. Shoemake, *Graphics Gems III* (1992) 124.
pub(crate) fn random_rotation(random: &mut impl Rng) -> UnitQuaternion<f64> {
    let [u, v, w]: [f64; 3] = std::array::from_fn(|_| random.random());
    let (near, far) = ((1.0 - u).sqrt(), u.sqrt());
    let ((s, c), (t, d)) = ((TAU * v).sin_cos(), (TAU * w).sin_cos());
    UnitQuaternion::new_normalize(Quaternion::new(near * s, near * c, far * t, far * d))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    #[test]
    fn a_box_takes_its_rows_of_spheres() {
        let upper = Vector3::new(0.5, 0.3, 0.2);
        let region = Region::Cuboid {
            lower: Vector3::zeros(),
            upper,
        };
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let place = |jitter, spacing, random: &mut ChaCha8Rng| {
            place_regularly(
                &region,
                Arrangement::SimpleCubic,
                spacing,
                0.05,
                jitter,
                random,
            )
        };
        assert_eq!(place(0.0, 0.1, &mut random).len(), 5 * 3 * 2);
        let jittered = place(0.01, 0.12, &mut random);
        // one layer of 4 x 2
        assert_eq!(jittered.len(), 8);
        let room = region.inset(0.05).expect("there is room");
        assert!(jittered.iter().all(|centre| room.contains(centre, 0.0)));
        for (number, one) in jittered.iter().enumerate() {
            let apart = |other: &Vector3<f64>| (one - other).norm() >= 0.1;
            assert!(jittered[..number].iter().all(apart));
        }
    }

    #[test]
    fn a_cylinder_takes_what_is_inside() {
        let base = Vector3::new(1.0, 2.0, 3.0);
        let region = Region::Cylinder {
            base,
            radius: 0.15,
            height: 0.3,
        };
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let arrangement = Arrangement::Hexagonal;
        let centres = place_regularly(&region, arrangement, 0.1, 0.05, 0.0, &mut random);
        let layer = |height: f64| {
            let at = move |centre: &&Vector3<f64>| (centre.z - height).abs() < 1e-9;
            centres.iter().filter(at).count()
        };
        // one in the middle and six around it, then three over the gaps, and so on
        let step = 0.1 * (2.0_f64 / 3.0).sqrt();
        assert_eq!(
            [0.0, 1.0, 2.0].map(|number| layer(3.05 + number * step)),
            [7, 3, 7]
        );
        assert_eq!(centres.len(), 17);
    }

    #[test]
    fn a_bounding_sphere_touches_the_outermost_member() {
        let member = |x: f64, radius| Sphere::new(Vector3::new(x, 0.0, 0.0), radius);
        let members = [member(-1.0, 0.5), member(1.0, 0.75), member(0.0, 1.0)];
        assert!((bounding_radius(&members, &Vector3::zeros()) - 1.75).abs() < 1e-15);
    }

    /// A turned vector is evenly spread over the sphere, and the angle of a random rotation has
    /// the mean π/2 + 2/π.
    #[test]
    fn rotations_prefer_no_direction() {
        const COUNT: u32 = 40_000;
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let rotations: Vec<_> = (0..COUNT).map(|_| random_rotation(&mut random)).collect();
        let mean = |value: &dyn Fn(&UnitQuaternion<f64>) -> f64| {
            rotations.iter().map(value).sum::<f64>() / f64::from(COUNT)
        };
        let error = 4.0 / f64::from(COUNT).sqrt();
        for (from, to) in [(0, 0), (0, 2), (1, 1), (2, 0), (2, 2)] {
            let component =
                |rotation: &UnitQuaternion<f64>| (rotation * Vector3::ith(from, 1.0))[to];
            assert!(mean(&component).abs() < error / 3.0_f64.sqrt());
            let squares = mean(&|rotation| component(rotation).powi(2));
            assert!((squares - 1.0 / 3.0).abs() < error * (4.0_f64 / 45.0).sqrt());
        }
        let angle = mean(&|rotation| rotation.angle());
        let expected = std::f64::consts::FRAC_PI_2 + 2.0 / std::f64::consts::PI;
        assert!((angle - expected).abs() < error, "{angle}");
    }
}
