//! Scenes of a few spheres drawn at random: one that bounces, slides or rolls, and some that hit each other.
use loadframe_api::{JobSpec, Report, Submission};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::fabrics::decades;
use crate::run::value;
use crate::sort::{Knob, Sort};

/// Scenes of up to four spheres.
pub(crate) struct Scenes;

/// [m/s²].
const GRAVITY: f64 = 9.81;
/// [kg/m³].
const DENSITY: f64 = 2600.0;

impl Sort for Scenes {
    fn results(&self) -> &'static [&'static str] {
        &["kinetic_energy", "elastic_energy"]
    }

    /// The time step over the critical one.
    fn knobs(&self) -> Vec<Knob> {
        vec![Knob {
            source: "time_step",
            levels: vec![0.4, 0.2, 0.1, 0.05, 0.01],
        }]
    }

    fn base(&self) -> Vec<f64> {
        vec![0.2]
    }

    fn presets(&self, _: u64) -> Vec<Vec<f64>> {
        vec![vec![0.4], vec![0.2], vec![0.05]]
    }

    fn job(&self, seed: u64, setting: &[f64]) -> JobSpec {
        let (mut spec, _) = drawn(seed);
        spec["accuracy"] = json!({"critical_step_fraction": setting[0]});
        let body = json!({"kind": "granular_scene", "spec": spec}).to_string();
        let submission = Submission::from_slice(body.as_bytes());
        submission
            .unwrap_or_else(|error| panic!("{error}: {body}"))
            .spec
    }

    fn traits(&self, _: u64, found: &Report) -> Vec<(&'static str, f64)> {
        let check = |name: &str| {
            found
                .quality
                .get(name)
                .map_or(f64::NAN, |check| check.value)
        };
        let time = |name: &str| value(found, name).unwrap_or(f64::NAN);
        let critical = time("time_step") / check("step_over_critical");
        vec![
            ("critical_steps", time("simulated_time") / critical),
            ("largest_overlap_ratio", check("largest_overlap_ratio")),
        ]
    }

    /// Kinetic energy at the start or of the fall.
    fn scale(&self, seed: u64) -> Option<f64> {
        Some(drawn(seed).1)
    }
}

/// A scene without its accuracy, and its largest energy [J].
fn drawn(seed: u64) -> (Value, f64) {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let radius = decades(random, 1e-3, 0.1);
    let mass = DENSITY * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let friction: f64 = random.random_range(0.1..0.6);
    let bounces = seed.is_multiple_of(4);
    // of the fall, or at the start
    let fall = radius * decades(random, 1.0, 10.0);
    let speed = if bounces {
        (2.0 * GRAVITY * fall).sqrt()
    } else {
        decades(random, 0.1, 2.0)
    };
    // ρ v²/E, which makes the overlap over the radius
    let softness = decades(random, 1e-7, 3e-5);
    let mut material = json!({
        "density_kg_per_m3": DENSITY,
        "youngs_modulus_pa": DENSITY * speed * speed / softness,
        "stiffness_ratio": random.random_range(0.2..0.8),
        "friction_angle_rad": friction,
    });
    let (restitution, damping) = (
        random.random_range(0.3..0.95),
        random.random_range(0.0..0.3),
    );
    let laws = if random.random_bool(0.5) {
        material["restitution"] = json!(restitution);
        json!({})
    } else {
        json!({"local_damping": damping})
    };
    let sphere = |place: [f64; 3], velocity: [f64; 3], fixed: &[&str]| {
        json!({"sphere": {"radius_m": radius}, "material": "stone", "position_m": place,
            "velocity_m_per_s": velocity, "fixed": fixed})
    };
    // until friction has stopped what slides
    let sliding = speed / (GRAVITY * friction.tan());
    let part = random.random_range(0.3..1.5);
    let along = [speed, 0.0, 0.0];
    let (bodies, gravity, time) = match seed % 4 {
        0 => (
            vec![sphere([0.0, 0.0, radius + fall], [0.0; 3], &[])],
            GRAVITY,
            (0.8 + 3.0 * part) * (2.0 * fall / GRAVITY).sqrt(),
        ),
        1 => (
            vec![sphere([0.0, 0.0, radius], along, &["rx", "ry", "rz"])],
            GRAVITY,
            part * sliding,
        ),
        // a sphere rolls after two sevenths of that time
        2 => (
            vec![sphere([0.0, 0.0, radius], along, &[])],
            GRAVITY,
            part * sliding,
        ),
        _ => {
            let count = random.random_range(2..=4_u32);
            let bodies = (0..count).map(|number| {
                let aside = 0.3 * radius * f64::from(number) * random.random_range(-1.0..1.0);
                let place = [2.5 * radius * f64::from(number), aside, 10.0 * radius];
                let velocity = if number == 0 { along } else { [0.0; 3] };
                sphere(place, velocity, &[])
            });
            (bodies.collect(), 0.0, (1.0 + 4.0 * part) * radius / speed)
        }
    };
    let spec = json!({
        "version": 1, "seed": seed, "gravity_m_per_s2": [0.0, 0.0, -gravity],
        "materials": {"stone": material}, "laws": laws,
        "bodies": bodies,
        "planes": [{"name": "floor", "axis": "z", "position_m": 0.0, "facing": 1, "material": "stone"}],
        "stages": [{"run": {"time_s": time}}],
    });
    (spec, 0.5 * mass * speed * speed)
}
