#![allow(clippy::float_cmp, reason = "equal inputs give equal results")]
use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::Rotation3;
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

use super::*;

mod degenerate;

/// Daily builds are hardly optimised: what takes long is tried in full in release builds only.
const IS_OPTIMISED: bool = !cfg!(debug_assertions);

/// Relative round-off of a closed form with a few operations.
const ROUND_OFF: f64 = 1e-13;

fn sphere(centre: [f64; 3], radius: f64) -> Sphere {
    Sphere::new(Vector3::from(centre), radius)
}

/// Largest difference, each relative to the size of the union.
fn difference(one: &MassProperties, other: &MassProperties) -> f64 {
    let length = other.volume.cbrt();
    let volume = (one.volume - other.volume).abs() / other.volume;
    let centroid = (one.centroid - other.centroid).norm() / length;
    let inertia = (one.inertia - other.inertia).norm() / other.inertia.norm();
    volume.max(centroid).max(inertia)
}

#[track_caller]
fn assert_close(one: &MassProperties, other: &MassProperties, tolerance: f64) {
    let difference = difference(one, other);
    assert!(difference < tolerance, "{difference:e}: {one:?} {other:?}");
}

/// Moments of spheres on the z axis, each given with the range of z it fills alone: closed form.
fn chain(parts: &[(f64, f64, [f64; 2])]) -> MassProperties {
    let [mut volume, mut first, mut along, mut across] = [0.0; 4];
    for &(centre, radius, [from, to]) in parts {
        let square = radius * radius;
        let between = |power: i32| {
            ((to - centre).powi(power) - (from - centre).powi(power)) / f64::from(power)
        };
        // discs of area π (r² − z²), of second moment π/4 (r² − z²)²
        let disc = PI * (square * between(1) - between(3));
        let lever = PI * (square * between(2) - between(4));
        volume += disc;
        first += lever + centre * disc;
        along +=
            PI * (square * between(3) - between(5)) + 2.0 * centre * lever + centre * centre * disc;
        across +=
            PI / 4.0 * (square * square * between(1) - 2.0 * square * between(3) + between(5));
    }
    let centroid = first / volume;
    let along = along - centroid * first;
    let moments = Vector3::new(across + along, across + along, 2.0 * across);
    MassProperties {
        volume,
        centroid: Vector3::new(0.0, 0.0, centroid),
        inertia: Matrix3::from_diagonal(&moments),
    }
}

/// Two overlapping spheres on the z axis.
fn pair(radii: [f64; 2], distance: f64) -> MassProperties {
    let [first, second] = radii;
    let plane = (distance * distance + first * first - second * second) / (2.0 * distance);
    let parts = [
        (0.0, first, [-first, plane]),
        (distance, second, [plane, distance + second]),
    ];
    chain(&parts)
}

/// The union cut into lines along z, each exact, over a square grid: error some 3e-6 with
/// 1000 × 1000 lines, against 3e-7 with 2000 × 2000.
fn by_lines(spheres: &[Sphere], lines: u32) -> MassProperties {
    let lower = spheres
        .iter()
        .fold(Vector3::repeat(f64::MAX), |lower, sphere| {
            lower.inf(&sphere.centre.add_scalar(-sphere.radius))
        });
    let upper = spheres
        .iter()
        .fold(Vector3::repeat(f64::MIN), |upper, sphere| {
            upper.sup(&sphere.centre.add_scalar(sphere.radius))
        });
    let step = (upper - lower) / f64::from(lines);
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for column in 0..lines {
        for row in 0..lines {
            let x = lower.x + (f64::from(column) + 0.5) * step.x;
            let y = lower.y + (f64::from(row) + 0.5) * step.y;
            spans.clear();
            spans.extend(spheres.iter().filter_map(|sphere| {
                let away = (x - sphere.centre.x).powi(2) + (y - sphere.centre.y).powi(2);
                let half = (sphere.radius.powi(2) - away).sqrt();
                (half > 0.0).then(|| [sphere.centre.z - half, sphere.centre.z + half])
            }));
            spans.sort_by(|one, other| one[0].total_cmp(&other[0]));
            let mut from = f64::MIN;
            for [start, end] in &spans {
                let start = start.max(from);
                if *end > start {
                    let length = end - start;
                    let middle = Vector3::new(x, y, 0.5 * (start + end));
                    volume += length;
                    first += middle * length;
                    second += middle * middle.transpose() * length;
                    second[(2, 2)] += length.powi(3) / 12.0;
                    from = *end;
                }
            }
        }
    }
    let cell = step.x * step.y;
    let centroid: Vector3<f64> = first / volume;
    let about: Matrix3<f64> = (second - centroid * centroid.transpose() * volume) * cell;
    MassProperties {
        volume: volume * cell,
        centroid,
        inertia: Matrix3::from_diagonal_element(about.trace()) - about,
    }
}

fn random_clump(seed: u64, members: usize, radii: [f64; 2]) -> Vec<Sphere> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut member = |_| {
        let centre = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
        Sphere::new(centre, random.random_range(radii[0]..radii[1]))
    };
    (0..members).map(&mut member).collect()
}

/// 2³, 3³, ... spheres at the points of a simple cubic lattice of spacing 1.
fn cubic(points: u32, radius: f64) -> Vec<Sphere> {
    let coordinates = || (0..points).map(f64::from);
    let at = |x, y, z| sphere([x, y, z], radius);
    let row = |x, y| coordinates().map(move |z| at(x, y, z));
    let layer = |x| coordinates().flat_map(move |y| row(x, y));
    coordinates().flat_map(layer).collect()
}

#[test]
fn one_sphere_has_its_textbook_moments() {
    let properties = mass_properties(&[sphere([0.1, -2.0, 3.0], 0.7)]);
    let volume = 4.0 / 3.0 * PI * 0.343;
    let expected = MassProperties {
        volume,
        centroid: Vector3::new(0.1, -2.0, 3.0),
        inertia: Matrix3::from_diagonal_element(0.4 * volume * 0.49),
    };
    assert_close(&properties, &expected, ROUND_OFF);
}

#[test]
fn two_spheres_agree_with_the_lens_formula() {
    let cases = [
        ([1.0, 1.0], 1.0),
        ([1.0, 0.5], 0.8),
        ([1.0, 0.5], 1.4999),
        ([1.0, 0.5], 0.5001),
        ([1.0, 1.0], 1e-3),
        ([1.0, 0.01], 1.0),
        ([0.01, 1.0], 1.005),
        ([1.0, 1e-3], 0.9995),
    ];
    for (radii, distance) in cases {
        let spheres = [
            sphere([0.0; 3], radii[0]),
            sphere([0.0, 0.0, distance], radii[1]),
        ];
        assert_close(
            &mass_properties(&spheres),
            &pair(radii, distance),
            ROUND_OFF,
        );
    }
}

#[test]
fn nearly_equal_spheres_are_one() {
    let one = mass_properties(&[sphere([0.0; 3], 1.0)]);
    for offset in [1e-18, 3e-16, 1e-15, 1e-13, 1e-10] {
        for growth in [0.0, 2.3e-16, 1e-15, 0.7e-10] {
            let spheres = [
                sphere([0.0; 3], 1.0),
                sphere([0.0, offset, 0.0], 1.0 + growth),
            ];
            // the union is at most so much larger, its inertia five times so
            let larger = 5.0 * (offset + growth) + ROUND_OFF;
            assert_close(&mass_properties(&spheres), &one, larger);
        }
    }
}

#[test]
fn a_hidden_or_repeated_member_adds_nothing() {
    let outer = sphere([1.0, 0.0, 0.0], 1.0);
    let alone = mass_properties(&[outer]);
    let inside = sphere([1.2, 0.1, 0.0], 0.3);
    let touching_from_inside = sphere([1.0, 0.7, 0.0], 0.3);
    let concentric = sphere([1.0, 0.0, 0.0], 0.5);
    for hidden in [inside, touching_from_inside, concentric, outer] {
        assert_close(&mass_properties(&[outer, hidden]), &alone, ROUND_OFF);
        assert_close(&mass_properties(&[hidden, outer]), &alone, ROUND_OFF);
        assert_close(
            &mass_properties(&[hidden, outer, hidden]),
            &alone,
            ROUND_OFF,
        );
    }
}

#[test]
fn touching_and_separate_spheres_add_up() {
    for distance in [1.5, 1.7] {
        let spheres = [sphere([0.0; 3], 1.0), sphere([0.0, 0.0, distance], 0.5)];
        let parts = [
            (0.0, 1.0, [-1.0, 1.0]),
            (distance, 0.5, [distance - 0.5, distance + 0.5]),
        ];
        assert_close(&mass_properties(&spheres), &chain(&parts), ROUND_OFF);
    }
}

#[test]
fn spheres_through_one_circle_leave_the_outer_two() {
    // centres on the z axis, all through the circle of radius 1 in z = 0
    let through = |z: f64| sphere([0.0, 0.0, z], z.hypot(1.0));
    let spheres = [-0.3, 0.5, 0.1, 0.0, 0.9].map(through);
    let ends = [spheres[0], spheres[4]];
    let expected = mass_properties(&ends);
    let (low, high) = (ends[0].radius, ends[1].radius);
    let parts = [
        (-0.3, low, [-0.3 - low, 0.0]),
        (0.9, high, [0.0, 0.9 + high]),
    ];
    assert_close(&expected, &chain(&parts), ROUND_OFF);
    assert_close(&mass_properties(&spheres), &expected, 10.0 * ROUND_OFF);
}

#[test]
fn cubic_lattices_with_pair_overlaps_add_up() {
    // up to r = 1/√2 only neighbours overlap; there four spheres meet in points
    for radius in [0.5, 0.55, 0.65, FRAC_1_SQRT_2] {
        for points in [2, 3, 5] {
            let spheres = cubic(points, radius);
            let count = f64::from(points);
            let lens = PI / 12.0 * (4.0 * radius + 1.0) * (2.0 * radius - 1.0).powi(2);
            let pairs = 3.0 * count * count * (count - 1.0);
            let expected = count.powi(3) * spheres[0].volume() - pairs * lens;
            let properties = mass_properties(&spheres);
            let off = (properties.volume / expected - 1.0).abs();
            assert!(off < ROUND_OFF, "{radius} {points}: {off:e}");
            let middle = Vector3::repeat(0.5 * (count - 1.0));
            assert!((properties.centroid - middle).norm() < ROUND_OFF * count);
            let isotropic = Matrix3::from_diagonal_element(properties.inertia.trace() / 3.0);
            let off = (properties.inertia - isotropic).norm() / isotropic.norm();
            assert!(off < 10.0 * ROUND_OFF, "{radius} {points}: {off:e}");
        }
    }
}

/// Eight spheres of radius √3/2 about a cube meet in its middle, and fill it and all inside.
#[test]
fn lattices_that_just_close_have_no_holes() {
    let radii: &[f64] = if IS_OPTIMISED { &[0.9, 1.0, 1.5] } else { &[] };
    for radius in [&[0.75_f64.sqrt()], radii].concat() {
        let spheres = cubic(4, radius);
        let lines = by_lines(&spheres, 600);
        assert_close(&mass_properties(&spheres), &lines, 5e-5);
    }
}

#[test]
fn random_clumps_agree_with_lines() {
    let cases = [
        (1, 3, [0.3, 1.0]),
        (2, 8, [0.3, 0.9]),
        (3, 8, [0.01, 1.0]),
        (4, 40, [0.1, 0.5]),
        (5, 135, [0.05, 0.4]),
        (6, 300, [0.2, 0.21]),
    ];
    let few = |members: usize| members < 100 || IS_OPTIMISED;
    for (seed, members, radii) in cases.into_iter().filter(|(_, members, _)| few(*members)) {
        let spheres = random_clump(seed, members, radii);
        assert_close(&mass_properties(&spheres), &by_lines(&spheres, 1000), 1e-5);
    }
}

/// A large sphere sprinkled with small ones, 1:100: each adds its cap by the lens formula.
#[test]
fn small_spheres_on_a_large_one_each_add_their_own() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut spheres = vec![sphere([0.0; 3], 1.0)];
    while spheres.len() < 200 {
        let way = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0_f64)).normalize();
        let small = Sphere::new(way * random.random_range(0.991..1.009), 0.01);
        let apart = |other: &Sphere| (other.centre - small.centre).norm() > 0.02;
        if spheres[1..].iter().all(apart) {
            spheres.push(small);
        }
    }
    let whole = spheres[0].volume();
    let added = spheres[1..]
        .iter()
        .map(|small| pair([1.0, 0.01], small.centre.norm()).volume - whole);
    let expected = whole + added.sum::<f64>();
    let off = mass_properties(&spheres).volume / expected - 1.0;
    assert!(off.abs() < ROUND_OFF, "{off:e}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn moving_reordering_and_scaling_commute_with_the_union(
        seed in 0..1000_u64,
        members in 1..20_usize,
        shift in prop::array::uniform3(-3.0..3.0_f64),
        angles in prop::array::uniform3(-3.0..3.0_f64),
        scale in 0.001..1000.0_f64,
    ) {
        let spheres = random_clump(seed, members, [0.1, 1.0]);
        let here = mass_properties(&spheres);
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let moved: Vec<Sphere> = spheres
            .iter()
            .rev()
            .map(|member| {
                let centre = (turn * member.centre + Vector3::from(shift)) * scale;
                Sphere::new(centre, member.radius * scale)
            })
            .collect();
        let expected = MassProperties {
            volume: here.volume * scale.powi(3),
            centroid: (turn * here.centroid + Vector3::from(shift)) * scale,
            inertia: turn * here.inertia * turn.transpose() * scale.powi(5),
        };
        // a shift of some diameters costs a digit
        assert_close(&mass_properties(&moved), &expected, 10.0 * ROUND_OFF);
    }

    #[test]
    fn a_union_is_between_its_largest_member_and_the_sum(
        seed in 0..1000_u64, members in 1..12_usize,
    ) {
        let spheres = random_clump(seed, members, [0.1, 1.0]);
        let volumes: Vec<f64> = spheres.iter().map(Sphere::volume).collect();
        let volume = mass_properties(&spheres).volume;
        let largest = volumes.iter().copied().fold(0.0, f64::max);
        prop_assert!(volume >= largest * (1.0 - ROUND_OFF));
        prop_assert!(volume <= volumes.iter().sum::<f64>() * (1.0 + ROUND_OFF));
    }
}

#[test]
fn a_rod_spins_about_its_length_most_easily() {
    let way = Vector3::new(1.0, 2.0, -0.5).normalize();
    let member = |step: i32| Sphere::new(way * f64::from(step), 0.8);
    let rod: Vec<Sphere> = (0..5).map(member).collect();
    let inertia = mass_properties(&rod).inertia;
    let super::principal::PrincipalAxes { moments, rotation } = principal_axes(&inertia);
    let easy = moments.imin();
    let axis = rotation.matrix().column(easy).into_owned();
    assert!((axis.dot(&way).abs() - 1.0).abs() < ROUND_OFF);
    let [one, other] = [(easy + 1) % 3, (easy + 2) % 3].map(|number| moments[number]);
    assert!((one / other - 1.0).abs() < 10.0 * ROUND_OFF);
}
