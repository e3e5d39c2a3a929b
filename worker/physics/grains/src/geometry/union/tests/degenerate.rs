//! Spheres that share points and circles, touch, hide or all but repeat each other.
//!
//! Two yardsticks: the same clump shaken by round-off and a little more, and the identities
//!   ∮ n dA = 0,   ∮ x nᵀ dA = V 1
//! of every closed surface, which miss no patch that is counted once too often or not at all.
use super::*;

/// Where many spheres share one circle or touch: the root of round-off, and some spheres of it.
const DEGENERATE: f64 = 5e-8;
/// What a shift of all coordinates and relative radii by 1 may truly change: the surface moves by
/// up to √3 + r, inertia by 5 times that over r, and the smallest clump is one sphere of r = 1/4.
const TRUE_CHANGE: f64 = 40.0;

/// Whole coordinates and radii to corners, edges and middles of cells: spheres share points and
/// circles, hide each other, touch from both sides.
fn on_a_grid(members: usize, random: &mut ChaCha8Rng) -> Vec<Sphere> {
    let squares = [0.0625, 0.25, 0.5, 0.75, 1.0, 1.25, 2.0, 2.25, 3.0, 4.0_f64];
    let step = [1.0, 0.5, 1.0 / 3.0][random.random_range(0..3)];
    let mut member = || {
        let centre = Vector3::from_fn(|_, _| f64::from(random.random_range(0..4)) * step);
        Sphere::new(
            centre,
            squares[random.random_range(0..squares.len())].sqrt(),
        )
    };
    (0..members).map(|_| member()).collect()
}

/// Spheres through one circle in any direction, and others that touch them.
fn through_a_circle(members: usize, touching: usize, random: &mut ChaCha8Rng) -> Vec<Sphere> {
    let mut number = |from, to| random.random_range(from..to);
    let [roll, pitch, yaw] = [(); 3].map(|()| number(-3.0, 3.0));
    let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
    let mut spheres: Vec<Sphere> = (0..members)
        .map(|_| number(-1.0, 1.0))
        .map(|z: f64| Sphere::new(turn * Vector3::new(0.0, 0.0, z), z.hypot(1.0)))
        .collect();
    for _ in 0..touching {
        let touched = spheres[number(0.0, spheres.len() as f64) as usize];
        let way = Vector3::from_fn(|_, _| number(-1.0, 1.0)).normalize();
        let radius = number(0.05, 0.5);
        let distance = touched.radius + number(-1.0, 1.0).signum() * radius;
        spheres.push(Sphere::new(touched.centre + way * distance, radius));
    }
    spheres
}

/// Moves and grows every sphere by up to `amount`.
fn shaken(spheres: &[Sphere], amount: f64, random: &mut ChaCha8Rng) -> Vec<Sphere> {
    let mut shake = || amount * random.random_range(-1.0..1.0);
    let shaken = spheres.iter().map(|sphere| {
        let centre = sphere.centre.map(|coordinate| coordinate + shake());
        Sphere::new(centre, sphere.radius * (1.0 + shake()))
    });
    shaken.collect()
}

/// Mixes each sphere with up to two near copies of itself, off by up to `amount` and by amounts
/// down to the last digit.
fn with_near_copies(spheres: &[Sphere], amount: f64, random: &mut ChaCha8Rng) -> Vec<Sphere> {
    let mut mixed = Vec::new();
    for original in spheres {
        mixed.push(*original);
        for _ in 0..random.random_range(0..3) {
            let less = amount * 10.0_f64.powf(random.random_range(-3.0..0.0));
            let mut copy = shaken(&[*original], less, random)[0];
            match random.random_range(0..3) {
                0 => copy.centre = original.centre,
                1 => copy.radius = original.radius,
                _ => {}
            }
            mixed.insert(random.random_range(0..=mixed.len()), copy);
        }
    }
    mixed
}

/// Asserts the identities of a closed surface.
#[track_caller]
fn assert_closed(spheres: &[Sphere]) {
    let (mut normals, mut tensor) = (Vector3::zeros(), Matrix3::zeros());
    let mut caps = Vec::new();
    for (index, Sphere { centre, radius }) in spheres.iter().enumerate() {
        if collect_caps(spheres, index, &mut caps) {
            let patch = Patch::uncovered_by(&mut caps, centre);
            normals += patch.first * radius.powi(2);
            tensor += (centre * patch.first.transpose() + patch.second * *radius) * radius.powi(2);
        }
    }
    let volume = tensor.trace() / 3.0;
    let open = normals.norm() / volume.cbrt().powi(2);
    let askew = (tensor - Matrix3::from_diagonal_element(volume)).norm() / volume;
    assert!(open < DEGENERATE, "{open:e}: {spheres:?}");
    assert!(askew < DEGENERATE, "{askew:e}: {spheres:?}");
}

/// Asserts that nothing hangs on the last digit.
#[track_caller]
fn assert_bears_shaking(spheres: &[Sphere], amounts: &[f64], random: &mut ChaCha8Rng) {
    assert_closed(spheres);
    let properties = mass_properties(spheres);
    for &amount in amounts {
        let shaken = shaken(spheres, amount, random);
        assert_closed(&shaken);
        let tolerance = DEGENERATE + TRUE_CHANGE * amount;
        assert_close(&mass_properties(&shaken), &properties, tolerance);
    }
}

/// Among them three equal spheres: shaken in the last digit, one hid in the second, by a sum that
/// rounded their distance away, and still covered a part of the third.
#[test]
fn a_grid_with_three_equal_members_bears_shaking() {
    let mut random = ChaCha8Rng::seed_from_u64(5_833_484_689_604_079_080);
    let spheres = on_a_grid(11, &mut random);
    assert_bears_shaking(&spheres, &[1e-15, 1e-12, 1e-9], &mut random);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if IS_OPTIMISED { 2000 } else { 200 }))]

    #[test]
    fn spheres_on_a_grid_bear_shaking(seed in any::<u64>(), members in 2..15_usize) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let spheres = on_a_grid(members, &mut random);
        assert_bears_shaking(&spheres, &[1e-15, 1e-12, 1e-9], &mut random);
    }

    #[test]
    fn spheres_through_a_circle_bear_shaking(
        seed in any::<u64>(),
        members in 2..7_usize,
        touching in 0..4_usize,
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let spheres = through_a_circle(members, touching, &mut random);
        assert_bears_shaking(&spheres, &[1e-15, 1e-13, 1e-11, 1e-9], &mut random);
    }

    #[test]
    fn near_copies_of_members_add_nothing(
        seed in any::<u64>(),
        members in 1..10_usize,
        is_grid in any::<bool>(),
        exponent in -17.0..-7.0_f64,
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let spheres = if is_grid {
            on_a_grid(members, &mut random)
        } else {
            through_a_circle(members, 2, &mut random)
        };
        let amount = 10.0_f64.powf(exponent);
        let mixed = with_near_copies(&spheres, amount, &mut random);
        assert_closed(&mixed);
        let tolerance = DEGENERATE + TRUE_CHANGE * amount;
        assert_close(&mass_properties(&mixed), &mass_properties(&spheres), tolerance);
    }
}
