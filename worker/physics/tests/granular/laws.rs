//! Laws of contact against closed forms.
use serde_json::{Value, json};

use super::{assert_close, body, contact, run, run_on, scene::Record, sphere, submission};

const DENSITY: f64 = 2600.0;
pub(super) const MODULUS: f64 = 1e8;
pub(super) const POISSON: f64 = 0.25;

pub(super) fn scene(
    contact: &str,
    material: &Value,
    bodies: &[Value],
    step: f64,
    steps: u64,
) -> Value {
    let mut stone = json!({"density_kg_per_m3": DENSITY, "youngs_modulus_pa": MODULUS,
                           "stiffness_ratio": 0.3, "poisson_ratio": POISSON, "friction_angle_rad": 0});
    for (name, value) in material.as_object().expect("fields") {
        stone[name] = value.clone();
    }
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0], "materials": {"stone": stone}, "bodies": bodies,
        "laws": {"contact": contact, "local_damping": 0.0},
        "time_step_s": step,
        "stages": [{"run": {"steps": steps}}],
        "record": {"every_steps": 1, "contacts": true}
    })
}

pub(super) fn mass(radius: f64) -> f64 {
    DENSITY * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

/// E* and R* of two spheres of this stone.
pub(super) fn hertz(radii: [f64; 2]) -> (f64, f64) {
    let modulus = MODULUS / (2.0 * (1.0 - POISSON * POISSON));
    (modulus, radii[0] * radii[1] / (radii[0] + radii[1]))
}

/// Two spheres that hit each other head-on at `speed`, ten steps from now.
fn head_on(radii: [f64; 2], speed: f64, step: f64) -> Vec<Value> {
    let away = radii[0] + radii[1] + 10.0 * speed * step;
    vec![
        sphere("stone", radii[0], [0.0; 3], [0.0; 3]),
        sphere("stone", radii[1], [0.0, 0.0, away], [0.0, 0.0, -speed]),
    ]
}

/// Speed at which two bodies part over that at which they met.
fn rebound(record: &Record, steps: u64, speed: f64) -> f64 {
    let [first, second] = [0, 1].map(|number| body(record, steps, number)[1][2]);
    (second - first) / speed
}

/// Duration 2.868 (m*²/(R* E*² v))^⅕, depth (15 m* v²/(16 E* √R*))^⅖ and the same speed back.
#[test]
fn an_impact_of_hertz_spheres_has_its_duration_and_depth() {
    let radii = [0.01, 0.015];
    let (modulus, radius) = hertz(radii);
    let [first, second] = radii.map(mass);
    let reduced = first * second / (first + second);
    for (speed, friction) in [(0.1, 0.0), (0.1, 0.5), (2.0, 0.5)] {
        let duration =
            2.868_3 * (reduced * reduced / (radius * modulus * modulus * speed)).powf(0.2);
        let depth = (15.0 * reduced * speed * speed / (16.0 * modulus * radius.sqrt())).powf(0.4);
        let step = duration / 2000.0;
        let spec = scene(
            "hertz_mindlin",
            &json!({"friction_angle_rad": friction}),
            &head_on(radii, speed, step),
            step,
            2200,
        );
        let (report, record) = run(&spec);
        let rows = record.table("contacts.csv");
        // cut by the raster of steps at both ends
        assert_close(rows.len() as f64 * step, duration, 2.0 * step);
        let deepest = rows.iter().fold(0.0_f64, |most, row| most.max(row[3]));
        assert_close(deepest, depth, 1e-5 * depth);
        assert_close(rebound(&record, 2200, speed), 1.0, 1e-5);
        assert!(report.quality["created_energy_ratio"].ok, "{report:?}");
    }
}

/// A sphere held at a depth in a plane, moved along it: k_T/k_N = 2(1 − ν)/(2 − ν), the tangent
/// k_N = 2 E* √(R δ). When the plane recedes, F_T follows k_T: F_T = k_T(δ) times the slip.
#[test]
fn shear_has_mindlins_stiffness_and_falls_with_the_overlap() {
    let (radius, depth, speed, step) = (0.01, 1e-4, 1e-3, 1e-6);
    let mut held = sphere(
        "stone",
        radius,
        [0.0, 0.0, radius - depth],
        [speed, 0.0, 0.0],
    );
    held["fixed"] = json!(["x", "z", "rx", "ry", "rz"]);
    let mut spec = scene(
        "hertz_mindlin",
        &json!({"friction_angle_rad": 1.5}),
        &[held],
        step,
        1000,
    );
    spec["planes"] =
        json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}]);
    spec["stages"] = json!([{"run": {"steps": 1000}},
        {"move_plane": {"name": "base", "velocity_m_per_s": -0.05, "steps": 1000}}]);
    let (_, record) = run(&spec);
    let (modulus, _) = hertz([radius; 2]);
    let tangent = |depth: f64| 2.0 * modulus * (radius * depth).sqrt();
    let ratio = 2.0 * (1.0 - POISSON) / (2.0 - POISSON);
    for (at, depth) in [(1000, depth), (2000, depth - 999.0 * 0.05 * step)] {
        let (overlap, [_, normal, shear]) = contact(&record, at, [0, 1]).expect("they touch");
        assert_close(overlap, depth, 1e-15);
        // F_N = ⅔ k_N δ
        let expected = 2.0 / 3.0 * tangent(depth) * depth;
        assert_close(normal[2], -expected, 1e-9 * expected);
        // slip is counted between the surfaces as if they just touched, 2r/(2r − δ) more
        let slip = speed * step * at as f64;
        let expected = ratio * tangent(depth) * slip;
        assert_close(shear[0].abs(), expected, 1e-2 * expected);
    }
}

/// A damped oscillator leaves after half a period with e of its speed, at any speed and under
/// springs that stiffen as Hertz's do.
#[test]
fn an_impact_gives_back_the_restitution_asked_for() {
    for law in ["linear", "logarithmic", "hertz_mindlin"] {
        for (restitution, friction) in [(0.95, 0.0), (0.5, 0.3), (0.1, 0.0), (0.02, 0.3)] {
            for speed in [0.02, 0.5] {
                let radii = [0.01, 0.02];
                // first order in the step: some parts of ω Δt = 2e-4; Hertz springs are softer
                let (step, steps) = match law {
                    "hertz_mindlin" => (5e-8, 200_000),
                    _ => (2e-8, 150_000),
                };
                let material = json!({"restitution": restitution, "friction_angle_rad": friction});
                let mut spec = scene(law, &material, &head_on(radii, speed, step), step, steps);
                spec["record"]["every_steps"] = json!(steps);
                let (_, record) = run(&spec);
                let found = rebound(&record, steps, speed);
                // the strain of 0.5 m/s is a hundredth, and its logarithm that much stiffer
                let strain = if law == "logarithmic" { 0.02 } else { 0.0 };
                let tolerance = restitution * (2e-3 + strain);
                assert!(
                    (found - restitution).abs() < tolerance,
                    "{law} {restitution} {speed}: {found}"
                );
            }
        }
    }
}

/// The same at a wall, for a sphere and for a clump with the mass of the whole.
#[test]
fn walls_and_clumps_give_back_the_same() {
    let (radius, speed, step, steps) = (0.01, 0.3, 1e-7, 60_000);
    let place = [0.0, 0.0, radius + 10.0 * speed * step];
    let mut clump = sphere("stone", radius, place, [0.0, 0.0, -speed]);
    let _ = clump.as_object_mut().expect("fields").remove("sphere");
    // the lower member alone touches the wall, below the centre of mass
    clump["clump"] = json!({"members": [{"offset_m": [0, 0, 0], "radius_m": radius},
                                        {"offset_m": [0, 0, 0.015], "radius_m": radius}]});
    for falling in [sphere("stone", radius, place, [0.0, 0.0, -speed]), clump] {
        for law in ["linear", "hertz_mindlin"] {
            let material = json!({"restitution": 0.6, "friction_angle_rad": 0.3});
            let mut spec = scene(law, &material, std::slice::from_ref(&falling), step, steps);
            spec["planes"] = json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}]);
            spec["record"]["every_steps"] = json!(steps);
            let (_, record) = run(&spec);
            assert_close(body(&record, steps, 0)[1][2] / speed, 0.6, 2e-3);
        }
    }
}

/// F_N = −k_N d₀ ln(d/d₀) (T 3.15) as far as the centres come together.
#[test]
fn spheres_of_logarithmic_strain_resist_until_their_centres_meet() {
    let (radius, speed, step) = (0.01, 1.0, 1e-6);
    let mut bodies = vec![
        sphere("stone", radius, [0.0; 3], [0.0; 3]),
        sphere(
            "stone",
            radius,
            [0.0, 0.0, 2.0 * radius],
            [0.0, 0.0, -speed],
        ),
    ];
    bodies[0]["fixed"] = json!(["x", "y", "z", "rx", "ry", "rz"]);
    // free along y, where nothing acts, so that the contact is looked at
    bodies[1]["fixed"] = json!(["x", "z", "rx", "ry", "rz"]);
    let spec = scene("logarithmic", &json!({}), &bodies, step, 19_900);
    let (_, record) = run(&spec);
    // K = E r for equal spheres
    let stiffness = MODULUS * radius;
    for at in [2, 100, 10_000, 19_000, 19_900_u64] {
        let (overlap, [_, normal, _]) = contact(&record, at, [0, 1]).expect("they touch");
        let closed = 2.0 * radius;
        let distance = closed - speed * step * (at - 1) as f64;
        let expected = -stiffness * closed * (distance / closed).ln();
        // places are rounded to 1e-18 m in each of the steps
        let rounding = stiffness * 1e-17 * at as f64 * closed / distance;
        assert_close(normal[2], expected, 1e-12 * expected + rounding);
        if at == 2 {
            // small strains are linear: δ/d₀ is 5e-5
            assert_close(normal[2] / (stiffness * overlap), 1.0, 5e-5);
        }
    }
}

#[test]
fn hertz_steps_are_chosen_for_the_impact_to_come() {
    let falling = sphere("stone", 0.01, [0.0, 0.0, 0.11], [0.0; 3]);
    let mut spec = scene("hertz_mindlin", &json!({}), &[falling], 1e-6, 1);
    spec["planes"] =
        json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}]);
    spec["gravity_m_per_s2"] = json!([0, 0, -9.81]);
    spec["time_step_s"] = json!("auto");
    spec["stages"] = json!([{"run": {"time_s": 0.3}}]);
    spec["record"]["every_steps"] = json!(10);
    let (report, record) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let deepest = record
        .table("bodies.csv")
        .iter()
        .fold(1.0_f64, |least, row| least.min(row[5]));
    assert!(deepest < 0.01, "it bounced: {deepest}");
    // a step that an impact at this speed makes unstable is refused
    spec["bodies"][0]["velocity_m_per_s"] = json!([0, 0, -10]);
    spec["time_step_s"] = json!(5e-4);
    let violations = submission(&spec).expect_err("an unstable step");
    assert_eq!(violations[0].code, "unstable");
    spec["bodies"][0]["velocity_m_per_s"] = json!([0, 0, 0]);
    assert!(submission(&spec).is_ok());
}

/// A heavy dashpot shortens the critical step; just below it a resting grain stays, just above it
/// the run is refused.
#[test]
fn a_dashpot_shortens_the_critical_step() {
    let resting = sphere("stone", 0.01, [0.0, 0.0, 0.01 - 1e-6], [0.0, 0.0, -1e-3]);
    let restitution: f64 = 0.01;
    let logarithm = -restitution.ln();
    let damping = logarithm / std::f64::consts::PI.hypot(logarithm);
    let critical = 2.0
        * (mass(0.01) / (MODULUS * 0.01)).sqrt()
        * ((1.0 + 4.0 * damping * damping).sqrt() - 2.0 * damping);
    for (part, is_stable) in [(0.98, true), (1.02, false)] {
        let mut spec = scene(
            "linear",
            &json!({"restitution": restitution}),
            std::slice::from_ref(&resting),
            part * critical,
            20_000,
        );
        spec["planes"] = json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}]);
        spec["gravity_m_per_s2"] = json!([0, 0, -9.81]);
        spec["record"]["every_steps"] = json!(1000);
        if is_stable {
            let (_, record) = run(&spec);
            let [_, velocity, _] = body(&record, 20_000, 0);
            assert_close(velocity[2], 0.0, 1e-9);
        } else {
            assert_eq!(submission(&spec).expect_err("unstable")[0].code, "unstable");
        }
    }
}

/// Momentum and angular momentum of three spheres that collide are kept to round-off by every law.
#[test]
fn every_law_keeps_momentum() {
    let radii = [0.012, 0.01, 0.015];
    for (law, restitution, shear_restitution) in [
        ("linear", 0.7, 1.0),
        ("linear", 1.0, 0.3),
        ("logarithmic", 1.0, 1.0),
        ("hertz_mindlin", 1.0, 1.0),
        ("hertz_mindlin", 0.4, 1.0),
        ("hertz_mindlin", 0.4, 0.2),
    ] {
        let mut bodies = vec![
            sphere("stone", radii[0], [-0.03, 0.001, 0.0], [1.0, 0.1, 0.0]),
            sphere("stone", radii[1], [0.0, 0.006, 0.002], [-0.8, 0.0, 0.2]),
            sphere("stone", radii[2], [0.03, -0.01, -0.004], [-1.1, 0.2, 0.0]),
        ];
        bodies[0]["angular_velocity_rad_per_s"] = json!([30.0, -20.0, 50.0]);
        let material = json!({"friction_angle_rad": 0.5, "restitution": restitution,
                              "shear_restitution": shear_restitution});
        let mut spec = scene(law, &material, &bodies, 2e-7, 50_000);
        spec["record"]["every_steps"] = json!(50);
        let (report, record) = run(&spec);
        assert!(
            record.table("contacts.csv").len() > 10,
            "{law}: they collide"
        );
        let before = super::collisions::momenta(&record, 0, &radii);
        let after = super::collisions::momenta(&record, 50_000, &radii);
        for axis in 0..3 {
            assert_close(after[axis], before[axis], 1e-14);
            assert_close(after[3 + axis], before[3 + axis], 1e-15);
        }
        assert!(
            report.quality["created_energy_ratio"].value < 1e-3,
            "{law}: {report:?}"
        );
    }
}

#[test]
fn laws_have_the_same_bits_on_any_number_of_threads() {
    for (law, restitution, shear_restitution) in [
        ("linear", Some(0.5), None),
        ("linear", None, Some(0.3)),
        ("logarithmic", None, None),
        ("hertz_mindlin", None, None),
        ("hertz_mindlin", Some(0.5), None),
        ("hertz_mindlin", Some(0.5), Some(0.3)),
    ] {
        let mut spec = super::determinism::rain(14, 0.5, 300, true);
        spec["laws"] = json!({"contact": law});
        let dashpots = [
            ("restitution", restitution),
            ("shear_restitution", shear_restitution),
        ];
        for (field, value) in dashpots {
            if let Some(value) = value {
                spec["materials"]["stone"][field] = json!(value);
            }
        }
        let (expected, record) = run(&spec);
        let (report, other) = run_on(&spec, 3);
        assert_eq!(report, expected, "{law}");
        assert!(other.files == record.files, "{law}");
        super::determinism::assert_resumes(&spec, 3);
    }
}

#[test]
fn bonds_and_other_springs_are_not_together() {
    let bodies = [sphere("stone", 0.01, [0.0; 3], [0.0; 3])];
    let cohesive = json!({"normal_cohesion_pa": 1e6, "restitution": 0.5, "shear_restitution": 0.5});
    let found = submission(&scene("hertz_mindlin", &cohesive, &bodies, 1e-7, 1));
    let found: Vec<String> = found
        .expect_err("three violations")
        .into_iter()
        .map(|violation| violation.pointer)
        .collect();
    assert_eq!(
        found,
        [
            "/spec/laws/contact",
            "/spec/materials/stone/restitution",
            "/spec/materials/stone/shear_restitution"
        ]
    );
}
