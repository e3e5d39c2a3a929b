//! Impacts: time and speed of a rebound, momentum of free collisions, Yade's numbers.
use serde_json::{Value, json};

use super::{assert_close, body, run, scene::Record, sphere};

const DENSITY: f64 = 2600.0;
const MODULUS: f64 = 1e8;

fn scene(
    friction: f64,
    damping: f64,
    bodies: &[Value],
    planes: &[Value],
    step: f64,
    steps: u64,
) -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": DENSITY, "youngs_modulus_pa": MODULUS, "stiffness_ratio": 0.3, "friction_angle_rad": friction}},
        "bodies": bodies, "planes": planes,
        "laws": {"local_damping": damping, "convention": "yade"},
        "time_step_s": step,
        "stages": [{"run": {"steps": steps}}],
        "record": {"every_steps": 1, "contacts": true}
    })
}

fn mass(radius: f64) -> f64 {
    DENSITY * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

/// A sphere on a spring leaves after half a period: t = π √(m/K), with its own speed.
#[test]
fn impact_takes_half_a_period_and_gives_the_speed_back() {
    let (radius, speed) = (0.01, 0.5);
    // sphere and plane in series: K = E r
    let half_period = std::f64::consts::PI * (mass(radius) / (MODULUS * radius)).sqrt();
    let step = half_period / 2000.0;
    let plane =
        json!({"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"});
    for friction in [0.0, 0.5] {
        let start = [0.0, 0.0, radius + 10.0 * speed * step];
        let falling = sphere("stone", radius, start, [0.0, 0.0, -speed]);
        let (_, record) = run(&scene(
            friction,
            0.0,
            &[falling],
            std::slice::from_ref(&plane),
            step,
            2100,
        ));
        let touching: Vec<u64> = record
            .table("contacts.csv")
            .iter()
            .map(|row| row[0] as u64)
            .collect();
        // the first and the last step are cut by the raster of steps
        assert_close(touching.len() as f64 * step, half_period, 2.0 * step);
        let [_, velocity, _] = body(&record, 2100, 0);
        // the speed is off by the part of a step that the first and last touch miss: (ω Δt)²/2
        assert_close(
            velocity[2],
            speed,
            speed * (std::f64::consts::PI / 2000.0_f64).powi(2),
        );
    }
}

pub(super) fn momenta(record: &Record, step: u64, radii: &[f64]) -> [f64; 6] {
    let mut sums = [0.0; 6];
    for (number, radius) in (0..).zip(radii) {
        let [x, v, w] = body(record, step, number);
        let m = mass(*radius);
        let inertia = 0.4 * m * radius * radius;
        let moment = [
            x[1] * v[2] - x[2] * v[1],
            x[2] * v[0] - x[0] * v[2],
            x[0] * v[1] - x[1] * v[0],
        ];
        for axis in 0..3 {
            sums[axis] += m * v[axis];
            sums[3 + axis] += m * moment[axis] + inertia * w[axis];
        }
    }
    sums
}

/// Both are kept to round-off. Angular momentum is taken with half-step velocities about the
/// positions they lead to; the torques act at the positions they come from, which differ by Δt v,
/// parallel to v, so that x × m v is the same.
#[test]
fn free_collisions_keep_momentum_and_angular_momentum() {
    let radii = [0.012, 0.01, 0.015];
    let mut bodies = vec![
        sphere("stone", radii[0], [-0.03, 0.001, 0.0], [1.0, 0.1, 0.0]),
        sphere("stone", radii[1], [0.0, 0.006, 0.002], [-0.8, 0.0, 0.2]),
        sphere("stone", radii[2], [0.03, -0.01, -0.004], [-1.1, 0.2, 0.0]),
    ];
    bodies[0]["angular_velocity_rad_per_s"] = json!([30.0, -20.0, 50.0]);
    let (_, record) = run(&scene(0.5, 0.0, &bodies, &[], 2e-7, 200_000 / 4));
    let contacts = record.table("contacts.csv");
    assert!(contacts.len() > 500, "they collide: {}", contacts.len());
    let before = momenta(&record, 0, &radii);
    let after = momenta(&record, 50_000, &radii);
    // sums of 5e4 steps of order 1e-2 (momentum) and 1e-4 (angular momentum)
    for axis in 0..3 {
        assert_close(after[axis], before[axis], 1e-14);
        assert_close(after[3 + axis], before[3 + axis], 1e-15);
    }
}
