//! The dashpot across the normal against the damped oscillator, and friction's limit on it.
use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    assert_close, body,
    laws::{MODULUS, POISSON, hertz, mass, scene},
    run,
    scene::Record,
    sphere, submission,
};

const RADII: [f64; 2] = [0.01, 0.015];
/// Overlap in which bodies are held [m].
const DEPTH: f64 = 1e-7;
/// They do not slide.
const STICKS: f64 = 1.5;

/// A sphere that stays at its height.
fn held(radius: f64, height: f64, speed: f64) -> Value {
    let mut held = sphere("stone", radius, [0.0, 0.0, height], [speed, 0.0, 0.0]);
    held["fixed"] = json!(["z"]);
    held
}

fn base() -> Value {
    json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}])
}

/// What a body of this radius brings to [`slip`], as recorded in a row of `bodies.csv`.
fn surface(row: &[f64], radius: f64) -> [f64; 3] {
    [row[6], row[10], radius]
}

/// How fast the surfaces pass each other along x (G.6), given velocity along x, spin about y and
/// radius of the body below and of that above [m/s].
fn slip(below: [f64; 3], above: [f64; 3]) -> f64 {
    let ([velocity, spin, radius], [other, other_spin, other_radius]) = (below, above);
    let reach = radius + other_radius;
    (other - velocity) * reach / (reach - DEPTH) - radius * spin - other_radius * other_spin
}

/// The same of body 0 and a plane at rest, at each recorded step.
fn slips_on_plane(record: &Record, radius: f64) -> Vec<f64> {
    let rows = record.table("bodies.csv").into_iter();
    rows.map(|row| slip([0.0, 0.0, radius], surface(&row, radius)))
        .collect()
}

/// k_T [N/m] of two spheres, or of a sphere and a plane, at [`DEPTH`].
fn shear_stiffness(law: &str, radii: [f64; 2], is_flat: bool) -> f64 {
    if law == "hertz_mindlin" {
        let (modulus, radius) = hertz(radii);
        let radius = if is_flat { radii[0] } else { radius };
        2.0 * modulus * (radius * DEPTH).sqrt() * 2.0 * (1.0 - POISSON) / (2.0 - POISSON)
    } else {
        let [first, second] = radii.map(|radius| 0.3 * MODULUS * 2.0 * radius);
        first * second / (first + second)
    }
}

/// β that leaves this part of the speed in half a period.
fn damping_ratio(restitution: f64) -> f64 {
    let logarithm = -restitution.ln();
    logarithm / PI.hypot(logarithm)
}

/// Half a period π/(ω √(1 − β²)) with ω² = 7/2 k_T/m*, after which −e_T is left of the speed at which
/// the surfaces pass each other.
#[test]
fn what_sticks_keeps_the_part_of_its_speed_asked_for() {
    const STEPS: u64 = 20_000;
    let speed = 1e-4;
    for law in ["linear", "logarithmic", "hertz_mindlin"] {
        for (restitution, along) in [(1.0, 1.0), (0.9, 1.0), (0.5, 0.5), (0.1, 1.0), (0.1, 0.5)] {
            for is_flat in [true, false] {
                let radii = if is_flat { [RADII[0]; 2] } else { RADII };
                let [own, other] = radii.map(|radius| 1.0 / mass(radius));
                let inverse_mass = if is_flat { own } else { own + other };
                let frequency = (3.5 * shear_stiffness(law, radii, is_flat) * inverse_mass).sqrt();
                let damping = damping_ratio(restitution);
                let half_period = PI / (frequency * (1.0 - damping * damping).sqrt());
                let bodies = if is_flat {
                    vec![held(radii[0], radii[0] - DEPTH, speed)]
                } else {
                    let away = radii[0] + radii[1] - DEPTH;
                    vec![held(radii[0], 0.0, 0.0), held(radii[1], away, speed)]
                };
                let material = json!({"friction_angle_rad": STICKS, "restitution": along,
                                      "shear_restitution": restitution});
                let step = half_period / STEPS as f64;
                let mut spec = scene(law, &material, &bodies, step, STEPS);
                spec["record"]["every_steps"] = json!(STEPS);
                if is_flat {
                    spec["planes"] = base();
                }
                let (_, record) = run(&spec);
                let slips = if is_flat {
                    slips_on_plane(&record, radii[0])
                } else {
                    let rows = record.table("bodies.csv");
                    let pairs = rows.chunks(2);
                    let slips = pairs
                        .map(|pair| slip(surface(&pair[0], radii[0]), surface(&pair[1], radii[1])));
                    slips.collect()
                };
                let found = -slips[1] / slips[0];
                // second order in the step but for its first: a tenth of what the speed of half a step ago
                // would make, ln e_T larger by its part βω Δt
                let late = -0.1 * restitution.ln() * damping * frequency * step;
                // spheres come to stand aslant, and F_N pushes them on: δ/(r_a + r_b) k_N/k_T = 1e-5
                let tolerance = restitution * (2.0 * late + 2e-5);
                assert_close(found, restitution, tolerance);
            }
        }
    }
}

/// What slides on a plane is at its limit F_N tan φ, then sticks. Without the dashpot it would swing at
/// F_N tan φ √(7/2 /(m k_T)) from then on.
#[test]
fn what_slid_comes_to_stick_without_a_swing() {
    let (radius, friction, speed, step, steps) = (RADII[0], 0.3_f64, 0.01, 1e-6, 4000);
    // sphere and plane in series: K = E r
    let limit = MODULUS * radius * DEPTH * friction.tan();
    let swing =
        limit * (3.5 / (mass(radius) * shear_stiffness("linear", [radius; 2], true))).sqrt();
    let left = |restitution: f64| {
        let material = json!({"friction_angle_rad": friction, "shear_restitution": restitution});
        let sliding = held(radius, radius - DEPTH, speed);
        let mut spec = scene("linear", &material, &[sliding], step, steps);
        spec["planes"] = base();
        let (report, record) = run(&spec);
        assert!(
            report.quality["created_energy_ratio"].value < 1e-3,
            "{report:?}"
        );
        let slips = slips_on_plane(&record, radius);
        let stops = slips.iter().position(|slip| *slip < 0.0).expect("it stops");
        for row in record.table("contacts.csv") {
            let force = row[10].hypot(row[11]);
            // the overlap is a difference of two numbers of order r
            let rounding = 1e-9 * limit;
            assert!(force <= limit + rounding, "{row:?}");
            // the first steps stretch the spring
            if row[0] > 20.0 && row[0] < stops as f64 {
                assert_close(force, limit, rounding);
            }
        }
        assert!(stops < 2000, "{stops}");
        slips[3000..]
            .iter()
            .fold(0.0_f64, |most, slip| most.max(slip.abs()))
    };
    // the slide ends within a step: ω Δt
    assert_close(left(1.0), swing, 1e-2 * swing);
    // five half periods
    assert_close(left(0.1), 0.0, 2e-5 * swing);
}

/// The limit is that of the spring along the normal, whatever the dashpot there adds.
#[test]
fn friction_limits_spring_and_dashpot_together() {
    let (radius, friction, step, steps) = (RADII[0], 0.3_f64, 1e-6, 600);
    let place = [0.0, 0.0, radius + 1e-6];
    let bodies = [sphere("stone", radius, place, [0.2, 0.1, -0.3])];
    let material = json!({"friction_angle_rad": friction, "restitution": 0.3,
                          "shear_restitution": 0.3});
    let mut spec = scene("linear", &material, &bodies, step, steps);
    spec["planes"] = base();
    let (_, record) = run(&spec);
    let (mut sliding, mut sticking) = (0, 0);
    for row in record.table("contacts.csv") {
        let spring = MODULUS * radius * row[3];
        let force = row[10].hypot(row[11]);
        let limit = spring * friction.tan();
        // rounding of places: 1e-18 m of an overlap
        let rounding = 1e-10 * limit + 1e-17 * MODULUS * radius;
        assert!(force <= limit + rounding, "{row:?}");
        if force >= limit - rounding {
            sliding += 1;
            let along = row[9].abs();
            assert!((along - spring).abs() > 1e-6 * spring, "{row:?}");
        } else {
            sticking += 1;
        }
    }
    assert!(sliding > 20 && sticking > 20, "{sliding} {sticking}");
}

/// Shear is what limits the step here, 7/2 k_T/m with k_T = k_N; the dashpot shortens it by
/// √(1 + 4β²) − 2β. Just below, a swing dies; just above, it grows and is refused.
#[test]
fn a_dashpot_shortens_the_critical_step_of_shear() {
    let (radius, speed, restitution, steps) = (RADII[0], 1e-4, 0.01, 400);
    let damping = damping_ratio(restitution);
    let shortened = (1.0 + 4.0 * damping * damping).sqrt() - 2.0 * damping;
    let critical = 2.0 * (mass(radius) / (3.5 * MODULUS * radius)).sqrt() * shortened;
    let material = |restitution: f64| {
        json!({"friction_angle_rad": STICKS, "stiffness_ratio": 1.0,
               "shear_restitution": restitution})
    };
    let swinging = [held(radius, radius - DEPTH, speed)];
    for (part, is_stable) in [(0.98, true), (1.02, false)] {
        let mut spec = scene(
            "linear",
            &material(restitution),
            &swinging,
            part * critical,
            steps,
        );
        spec["planes"] = base();
        if !is_stable {
            assert_eq!(submission(&spec).expect_err("unstable")[0].code, "unstable");
            spec["allow_unstable"] = json!(true);
        }
        let (report, record) = run(&spec);
        assert_close(report.quality["step_over_critical"].value, part, 1e-9);
        let left = slips_on_plane(&record, radius)[steps as usize].abs() / speed;
        assert_eq!(left < 1e-3, is_stable, "{left}");
        assert_eq!(left > 10.0, !is_stable, "{left}");
    }
    let [damped, free] = [restitution, 1.0].map(|restitution| {
        let mut spec = scene("linear", &material(restitution), &swinging, critical, 1);
        spec["planes"] = base();
        spec["time_step_s"] = json!("auto");
        let (_, record) = run(&spec);
        record.table("bodies.csv")[1][1]
    });
    assert_close(damped / free, shortened, 1e-9);
}

/// Local damping is off unless given, as with a dashpot along the normal.
#[test]
fn it_takes_the_place_of_local_damping() {
    let mut spec = scene("linear", &json!({"shear_restitution": 0.5}), &[], 1e-6, 1);
    let falling = sphere("stone", RADII[0], [0.0, 0.0, 1.0], [0.0; 3]);
    spec["bodies"] = json!([falling]);
    spec["gravity_m_per_s2"] = json!([0, 0, -10]);
    spec["stages"] = json!([{"run": {"steps": 100}}]);
    spec["laws"] = json!({});
    let (_, record) = run(&spec);
    assert_close(body(&record, 100, 0)[1][2], -1e-3, 1e-5);
}
