//! Resistance to rolling and twisting against closed forms.
use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    assert_close, body, codes,
    laws::{MODULUS, POISSON, hertz, mass, scene},
    one, run, run_on, sphere,
};

const RADIUS: f64 = 0.01;
const GRAVITY: f64 = 9.81;
/// Overlap in which a sphere of this stone rests on a plane [m], under linear springs.
fn depth(law: &str) -> f64 {
    let weight = mass(RADIUS) * GRAVITY;
    if law == "hertz_mindlin" {
        let (modulus, _) = hertz([RADIUS; 2]);
        (weight / (4.0 / 3.0 * modulus * RADIUS.sqrt())).powf(2.0 / 3.0)
    } else {
        weight / (MODULUS * RADIUS)
    }
}

/// k_T of that sphere at rest [N/m].
fn shear_stiffness(law: &str) -> f64 {
    if law == "hertz_mindlin" {
        let (modulus, _) = hertz([RADIUS; 2]);
        2.0 * modulus * (RADIUS * depth(law)).sqrt() * 2.0 * (1.0 - POISSON) / (2.0 - POISSON)
    } else {
        0.3 * MODULUS * RADIUS
    }
}

/// A sphere at rest in its hollow on a plane, with gravity inclined by `slope` [rad] along x.
fn on_plane(law: &str, resistance: &Value, slope: f64, step: f64, steps: u64) -> Value {
    let place = [0.0, 0.0, RADIUS - depth(law)];
    let bodies = [sphere("stone", RADIUS, place, [0.0; 3])];
    let material = json!({"friction_angle_rad": 1.0, "rolling_resistance": resistance});
    let mut spec = scene(law, &material, &bodies, step, steps);
    let (sine, cosine) = slope.sin_cos();
    spec["gravity_m_per_s2"] = json!([GRAVITY * sine, 0, -GRAVITY * cosine]);
    spec["planes"] =
        json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}]);
    spec["record"]["every_steps"] = json!(steps / 100);
    spec
}

/// From I ω̇ = F r − M and m v̇ = −F with v = ω r: v̇ = −5/7 μ_r g; what is lost is μ_r m g times the way.
#[test]
fn a_rolling_sphere_slows_down_by_five_sevenths_of_its_friction_and_loses_what_that_says() {
    let (friction, speed, step, steps) = (0.05, 0.1, 1e-6, 200_000);
    for law in ["linear", "logarithmic", "hertz_mindlin"] {
        for damping in [0.0, 0.3] {
            let resistance = json!({"rolling_friction": friction, "damping_ratio": damping});
            let mut spec = on_plane(law, &resistance, 0.0, step, steps);
            spec["bodies"][0]["velocity_m_per_s"] = json!([speed, 0, 0]);
            spec["bodies"][0]["angular_velocity_rad_per_s"] = json!([0, speed / RADIUS, 0]);
            let (report, record) = run(&spec);
            let rows = record.table("bodies.csv");
            let time = step * steps as f64;
            let [place, velocity, spin] = body(&record, steps, 0);
            // shear acts in the middle of the overlap, and slip counts spheres as if they just touched (G.7)
            let half = 0.5 * depth(law) / RADIUS;
            let slower = friction * GRAVITY * time / (1.4 - 0.6 * half);
            // the spring is wound up first: μ_r R F_N/k_r of turning at nearly full speed, 3e-6 rad
            let wound = friction * RADIUS * mass(RADIUS) * GRAVITY
                / (shear_stiffness(law) * RADIUS * RADIUS);
            let late = 0.5 * slower / time * wound * RADIUS / speed;
            // the moment comes at once, so that the surfaces swing on the shear spring: with ω² = 7/2 k_T/m
            // and the acceleration M r/I their speed is this, of which the centre has 2/7
            let swing =
                2.5 * friction * GRAVITY / (3.5 * shear_stiffness(law) / mass(RADIUS)).sqrt();
            assert_close(
                speed - velocity[0],
                slower,
                late + 2.0 / 7.0 * swing + 1e-4 * slower,
            );
            assert_close(
                spin[1] * RADIUS,
                velocity[0],
                1.01 * swing + 1e-4 * velocity[0],
            );
            assert!(
                rows.iter().all(|row| row[4].abs() + row[7].abs() < 1e-15),
                "{law}"
            );
            let energy = |velocity: f64| 0.7 * mass(RADIUS) * velocity * velocity;
            let lost = energy(speed) - energy(velocity[0]);
            // the shear force M/(1.4 R) turns the sphere on an arm that is shorter than the radius that slip
            // counts, and what lies between the two is lost on the way
            let friction_work = friction * mass(RADIUS) * GRAVITY * place[0] * (1.0 + half / 1.4);
            // of the way the first part winds up the spring
            assert_close(lost, friction_work, 1e-3 * friction_work);
            assert!(
                report.quality["created_energy_ratio"].value < 1e-4,
                "{law}: {report:?}"
            );
        }
    }
}

/// tan α = μ_r is where a sphere begins to roll: below it it swings on its springs and stays, above it
/// it gains 5/7 g (sin α − μ_r cos α). Dashpots take the swings, and no local damping, which holds what
/// rolls so slowly: its sign changes with every swing.
#[test]
fn a_sphere_begins_to_roll_where_the_slope_is_the_rolling_friction() {
    let friction: f64 = 0.2;
    let (step, steps) = (2e-6, 100_000);
    for law in ["linear", "hertz_mindlin"] {
        for factor in [0.97, 1.03] {
            let resistance = json!({"rolling_friction": friction, "damping_ratio": 0.3});
            let slope = (factor * friction).atan();
            let mut spec = on_plane(law, &resistance, slope, step, steps);
            for dashpot in ["restitution", "shear_restitution"] {
                spec["materials"]["stone"][dashpot] = json!(0.2);
            }
            let (_, record) = run(&spec);
            let [place, velocity, _] = body(&record, steps, 0);
            if factor < 1.0 {
                assert!(velocity[0].abs() < 1e-6, "{law}: {velocity:?}");
                assert!(place[0] < 2e-5, "{law}: {place:?}");
            } else {
                // shear acts in the middle of the overlap, at this arm over the radius
                let arm = 1.0 - 0.5 * depth(law) / RADIUS;
                let resisting = friction / arm * slope.cos();
                let gain = 5.0 / 7.0 * GRAVITY * (slope.sin() - resisting);
                let time = 0.5 * step * steps as f64;
                let [_, before, _] = body(&record, steps / 2, 0);
                assert_close(velocity[0] - before[0], gain * time, 0.01 * gain * time);
            }
        }
    }
}

/// I ω̇ = −μ_t r F_N: ω̇ = −5/2 μ_t g/r.
#[test]
fn a_top_slows_down_by_its_twisting_friction_and_stops() {
    let (friction, spin, step) = (0.05, 20.0, 1e-6);
    let slower = 2.5 * friction * GRAVITY / RADIUS;
    for law in ["linear", "logarithmic", "hertz_mindlin"] {
        let resistance = json!({"twisting_friction": friction, "damping_ratio": 0.3});
        for (steps, is_stopped) in [(100_000, false), (200_000, true)] {
            let mut spec = on_plane(law, &resistance, 0.0, step, steps);
            spec["bodies"][0]["angular_velocity_rad_per_s"] = json!([0, 0, spin]);
            let (_, record) = run(&spec);
            let [place, _, found] = body(&record, steps, 0);
            if is_stopped {
                assert!(found[2].abs() < 1e-9 * spin, "{law}: {found:?}");
            } else {
                let time = step * steps as f64;
                assert_close(spin - found[2], slower * time, 1e-4 * slower * time);
            }
            assert!(place[0].abs() + place[1].abs() < 1e-15, "{law}: {place:?}");
        }
    }
}

/// Two spheres whose centres are held swing against each other: ω² = k/I* with I* = (2/5) m r²/2 of equals,
/// k = β k_T R², R = r/2; the dashpot leaves exp(−π β/√(1 − β²)) of the spin in half a period, with
/// 2 β ω I* = c.
#[test]
fn spheres_swing_on_their_springs_against_rolling_and_twisting() {
    const STEPS: u64 = 20_000;
    let overlap = 1e-5;
    let ratio = 0.7;
    for (axis, damping) in [("twist", 0.0), ("twist", 0.3), ("roll", 0.0), ("roll", 0.3)] {
        let shear = 0.3 * MODULUS * RADIUS;
        let stiffness = ratio * shear * (0.5 * RADIUS).powi(2);
        let inertia = 0.4 * mass(RADIUS) * RADIUS * RADIUS;
        let frequency = (stiffness / (0.5 * inertia)).sqrt();
        let turning = if axis == "twist" { 0.4 } else { 1.4 };
        let rolling_inertia = 0.5 * turning * mass(RADIUS) * RADIUS * RADIUS;
        let dashpot = 2.0 * damping * (rolling_inertia * stiffness).sqrt();
        let beta = dashpot / (frequency * inertia);
        let half = PI / (frequency * (1.0 - beta * beta).sqrt());
        let step = half / STEPS as f64;
        let spin = if axis == "twist" {
            [0.0, 0.0, 1e-3]
        } else {
            [1e-3, 0.0, 0.0]
        };
        let bodies = [-1.0, 1.0].map(|side: f64| {
            let mut held = sphere(
                "stone",
                RADIUS,
                [0.0, 0.0, side * (RADIUS - 0.5 * overlap)],
                [0.0; 3],
            );
            held["fixed"] = json!(["x", "y", "z"]);
            held["angular_velocity_rad_per_s"] = json!(spin.map(|part| side * part));
            held
        });
        // without friction no shear spring is felt
        let material = json!({"friction_angle_rad": 0, "rolling_resistance": {
            "rolling_friction": 5.0, "twisting_friction": 5.0, "stiffness_ratio": ratio, "damping_ratio": damping}});
        let mut spec = scene("linear", &material, &bodies, step, STEPS);
        spec["record"]["every_steps"] = json!(STEPS);
        let (_, record) = run(&spec);
        let [_, _, found] = body(&record, STEPS, 1);
        let along = if axis == "twist" { found[2] } else { found[0] };
        let left = (-PI * beta / (1.0 - beta * beta).sqrt()).exp();
        // the dashpot is half a step late: ln of what is left by its part βω Δt
        let late = beta * frequency * step * PI;
        assert_close(-along / 1e-3, left, left * (late + 1e-3));
        let row = record.table("contacts.csv").pop().expect("they touch");
        assert_eq!(row.len(), 17);
    }
}

#[test]
fn scenes_that_resist_rolling_have_the_same_bits_on_threads_and_resume() {
    for (law, restitution) in [
        ("linear", None),
        ("logarithmic", None),
        ("hertz_mindlin", Some(0.5)),
    ] {
        let mut spec = super::determinism::rain(14, 0.5, 300, true);
        spec["laws"] = json!({"contact": law});
        let stone = &mut spec["materials"]["stone"];
        stone["rolling_resistance"] =
            json!({"rolling_friction": 0.1, "twisting_friction": 0.05, "damping_ratio": 0.1});
        if let Some(value) = restitution {
            stone["restitution"] = json!(value);
        }
        let (expected, record) = run(&spec);
        assert!(
            expected.quality["created_energy_ratio"].value < 0.05,
            "{expected:?}"
        );
        let (report, other) = run_on(&spec, 3);
        assert_eq!(report, expected, "{law}");
        assert!(other.files == record.files, "{law}");
        super::determinism::assert_resumes(&spec, 3);
    }
}

#[test]
fn bonds_do_not_resist_rolling() {
    let bodies = [sphere("stone", RADIUS, [0.0; 3], [0.0; 3])];
    let material =
        json!({"normal_cohesion_pa": 1e6, "rolling_resistance": {"rolling_friction": 0.1}});
    let found = codes(&scene("linear", &material, &bodies, 1e-7, 1));
    let pointer = "/spec/materials/stone/rolling_resistance";
    assert_eq!(found, one(pointer, "not_together"));
}

/// I Δω = −M Δt with the moment M on the floor: what is told is what acts, with its dashpots.
#[test]
fn moments_in_the_table_of_contacts_are_those_that_act() {
    let (spin, step) = (0.01, 1e-5);
    let resistance =
        json!({"rolling_friction": 0.5, "twisting_friction": 0.5, "damping_ratio": 0.3});
    let mut spec = on_plane("linear", &resistance, 0.0, step, 100);
    spec["bodies"][0]["angular_velocity_rad_per_s"] = json!([0, 0, spin]);
    spec["laws"]["local_damping"] = json!(0);
    spec["record"]["contacts"] = json!(true);
    let (_, record) = run(&spec);
    let inertia = 0.4 * mass(RADIUS) * RADIUS * RADIUS;
    let bodies = record.table("bodies.csv");
    let contacts = record.table("contacts.csv");
    let mut largest = 0.0_f64;
    for rows in bodies.windows(2) {
        let acting = inertia * (rows[1][11] - rows[0][11]) / step;
        let told = contacts
            .iter()
            .find(|row| (row[0] - rows[1][0]).abs() < 0.5);
        let told = -told.expect("a contact")[16];
        largest = largest.max(acting.abs());
        assert_close(told, acting, 1e-9 * largest);
    }
    // c ω alone, before the spring is wound up
    let stiffness = shear_stiffness("linear") * RADIUS * RADIUS;
    let dashpot = 2.0 * 0.3 * (inertia * stiffness).sqrt();
    assert!(largest > dashpot * spin, "{largest}");
}
