//! Walls and bodies that are driven.
use serde_json::{Value, json};

use super::{assert_close, body, determinism::assert_resumes, run, run_on, scene::Record, sphere};

const RADIUS: f64 = 0.01;
/// E r: two equal surfaces in series.
const STIFFNESS: f64 = 1e5;
const FLOOR: [[[f64; 3]; 3]; 2] = [
    [[-0.3, -0.3, 0.0], [0.3, -0.3, 0.0], [0.3, 0.3, 0.0]],
    [[-0.3, -0.3, 0.0], [0.3, 0.3, 0.0], [-0.3, 0.3, 0.0]],
];

/// One sphere that just touches a floor, of triangles or a plane.
fn scene(is_plane: bool, friction: f64, damping: f64, stages: &Value) -> Value {
    let plane =
        json!({"name": "floor", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"});
    let mesh = json!({"name": "floor", "material": "stone", "triangles_m": FLOOR});
    let (planes, facets) = if is_plane {
        (vec![plane], vec![])
    } else {
        (vec![], vec![mesh])
    };
    json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "stiffness_ratio": 0.3, "friction_angle_rad": friction}},
        "bodies": [sphere("stone", RADIUS, [0.0, 0.0, RADIUS], [0.0; 3])],
        "planes": planes, "facets": facets,
        "laws": {"local_damping": damping},
        "time_step_s": 1e-5,
        "stages": stages,
        "record": {"every_steps": 10}
    })
}

fn mass() -> f64 {
    2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3)
}

fn last(record: &Record, column: &str) -> f64 {
    *record.column(column).last().expect("rows")
}

#[test]
fn walls_move_at_their_velocity_and_drag_what_they_touch() {
    for is_plane in [true, false] {
        let stages = json!([{"run": {"steps": 20_000}},
            {"drive": {"walls": [{"name": "floor", "velocity_m_per_s": [0.2, -0.1, 0]}], "steps": 60_000}},
            {"run": {"steps": 100}}]);
        let mut spec = scene(is_plane, 0.6, 0.0, &stages);
        // a block cannot roll: it ends at the speed of the floor
        spec["bodies"][0]["fixed"] = json!(["rx", "ry", "rz"]);
        spec["laws"]["local_damping"] = json!(0.3);
        let (_, record) = run(&spec);
        for (axis, way) in [("x", 0.12), ("y", -0.06), ("z", 0.0)] {
            let column = format!("floor_displacement_{axis}_m");
            assert_close(last(&record, &column), way, 1e-12);
        }
        let [from, to] = [50_000, 80_000].map(|step| body(&record, step, 0)[0]);
        for axis in 0..3 {
            // it swings a little on its shear spring, undamped: damping knows no moving frame
            let mean = (to[axis] - from[axis]) / 0.3;
            assert_close(mean, [0.2, -0.1, 0.0][axis], 2e-5);
        }
    }
}

/// A sphere on a floor that swings is a spring's end that swings: for x the change of its height,
/// m x″ = −k (x − A sin ωt), so x = A/(1 − (ω/ω₀)²) (sin ωt − (ω/ω₀) sin ω₀t) as long as it touches.
#[test]
fn a_swinging_floor_shakes_a_sphere_as_the_forced_oscillator_has_it() {
    let (amplitude, frequency) = (2e-7, 100.0);
    let natural = (STIFFNESS / mass()).sqrt();
    let omega = std::f64::consts::TAU * frequency;
    for is_plane in [true, false] {
        let stages = json!([
            {"drive": {"walls": [{"name": "floor", "sine": {"amplitude_m": [0, 0, amplitude], "frequency_hz": frequency}}], "steps": 5000}}]);
        let mut spec = scene(is_plane, 0.0, 0.0, &stages);
        let rest = RADIUS - mass() * 9.81 / STIFFNESS;
        spec["bodies"][0]["position_m"] = json!([0, 0, rest]);
        spec["time_step_s"] = json!(1e-6);
        let (report, record) = run(&spec);
        for (row, time) in record
            .table("bodies.csv")
            .iter()
            .zip(record.column("time_s"))
        {
            let ratio = omega / natural;
            let expected = amplitude / (1.0 - ratio * ratio)
                * ((omega * time).sin() - ratio * (natural * time).sin());
            // second order in ω₀Δt = 3e-3, and half a step between place and force
            assert_close(row[5] - rest, expected, 5e-3 * amplitude);
        }
        let shown = record.column("floor_displacement_z_m");
        for (shown, time) in shown.iter().zip(record.column("time_s")) {
            assert_close(*shown, amplitude * (omega * time).sin(), 1e-15);
        }
        // what the floor gave is in the sphere: nothing is made, nothing is lost
        let created = report.quality["created_energy_ratio"].value;
        assert!(created < 1e-3, "{created}");
        let energy: Vec<f64> = (record.column("kinetic_energy_j").iter())
            .zip(record.column("elastic_energy_j"))
            .map(|(kinetic, elastic)| kinetic + elastic)
            .collect();
        assert!(energy.iter().all(|energy| *energy > 0.0));
    }
}

#[test]
fn a_plate_under_a_force_carries_the_weight_on_it() {
    for is_plane in [true, false] {
        let weight = mass() * 9.81;
        // free along z only, although the force is not along z only
        let stages = json!([
            {"drive": {"walls": [{"name": "floor", "force": {"mass_kg": 0.01, "force_n": [3, 0, weight], "free": ["z"]}}], "steps": 100_000}}]);
        let (_, record) = run(&scene(is_plane, 0.0, 0.5, &stages));
        assert_close(last(&record, "floor_force_z_n"), -weight, 1e-6 * weight);
        assert_close(last(&record, "floor_displacement_x_m"), 0.0, 0.0);
        // and under a larger one both rise together
        let force = 3.0 * weight;
        let stages = json!([
            {"drive": {"walls": [{"name": "floor", "force": {"mass_kg": 0.01, "force_n": [0, 0, force], "free": ["x", "z"]}}], "steps": 20_000}}]);
        let (_, record) = run(&scene(is_plane, 0.0, 0.0, &stages));
        // the plate has no weight, the sphere has; what oscillates between them averages out
        let momentum = (force - weight) * 0.2;
        let [_, velocity, _] = body(&record, 20_000, 0);
        let rows = record.column("floor_displacement_z_m");
        let plate = (rows[rows.len() - 1] - rows[rows.len() - 2]) / 1e-4;
        assert_close(
            0.01 * plate + mass() * velocity[2],
            momentum,
            1e-2 * momentum,
        );
    }
}

/// A sphere in a drum of triangles that turns: where it rests it rolls with the wall, its surface
/// as fast as the wall's.
#[test]
fn a_turning_drum_turns_what_is_in_it() {
    let (radius, sides) = (0.1, 48);
    let corner = |number: u32, y: f64| {
        let (sine, cosine) =
            (f64::from(number) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
        [radius * cosine, y, 0.2 + radius * sine]
    };
    let mut triangles = Vec::new();
    for number in 0..sides {
        let [a, b, c, d] = [
            corner(number, -0.05),
            corner(number + 1, -0.05),
            corner(number + 1, 0.05),
            corner(number, 0.05),
        ];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let omega = 1.5;
    let spec = json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "stiffness_ratio": 0.3, "friction_angle_rad": 0.6}},
        "bodies": [sphere("stone", RADIUS, [0.0, 0.0, 0.2 - 0.0895], [0.0; 3])],
        "facets": [{"name": "drum", "material": "stone", "triangles_m": triangles}],
        "laws": {"local_damping": 0.05},
        "stages": [{"drive": {"walls": [{"name": "drum", "turn": {"angular_velocity_rad_per_s": [0, omega, 0], "about_m": [0, 0, 0.2]}}], "flow": true, "time_s": 5.0}}],
        "record": {"every_steps": 200}
    });
    let (report, record) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let rows = record.table("bodies.csv");
    let half = &rows[rows.len() / 2..];
    let mean = half.iter().map(|row| row[10]).sum::<f64>() / half.len() as f64;
    // the polygon's facets make it bob; over turns it rolls without slip
    assert_close(
        mean,
        omega * radius / RADIUS,
        0.03 * omega * radius / RADIUS,
    );
}

#[test]
fn bodies_follow_velocities_and_forces() {
    let weight = mass() * 9.81;
    let stages = json!([
        {"drive": {"bodies": [{"body": 0, "velocity": {"velocity_m_per_s": [0.1, 9, 0.02], "along": ["x", "z"]}}], "steps": 1000}},
        {"drive": {"bodies": [{"body": 0, "force": {"force_n": [0, 0.5 * weight, weight]}}], "steps": 1000}},
        {"run": {"steps": 1000}}]);
    for members in [1, 2] {
        let mut spec = scene(false, 0.0, 0.0, &stages);
        let mut expected_mass = 1.0;
        if members == 2 {
            // two spheres in one place have the mass of one, and are a clump
            let member = json!({"offset_m": [0, 0, 0], "radius_m": RADIUS});
            spec["bodies"] = json!([{"clump": {"members": [member, member]}, "material": "stone", "position_m": [0, 0, RADIUS]}]);
            expected_mass = 1.001;
        }
        let (_, record) = run(&spec);
        let [position, velocity, _] = body(&record, 1000, 0);
        for (found, expected) in position.into_iter().zip([0.001, 0.0, RADIUS + 0.0002]) {
            assert_close(found, expected, 1e-12);
        }
        assert_close(velocity[0], 0.1, 1e-12);
        // its weight is carried: it goes on as it was, and is pushed along y
        let [_, velocity, _] = body(&record, 2000, 0);
        let tolerance = (expected_mass - 1.0) * 0.1 + 1e-12;
        for (found, expected) in velocity.into_iter().zip([0.1, 0.5 * 9.81 * 0.01, 0.02]) {
            assert_close(found, expected, tolerance);
        }
        let [_, velocity, _] = body(&record, 3000, 0);
        assert_close(velocity[2], 0.02 - 9.81 * 0.01, tolerance);
        assert_close(last(&record, "body_0_displacement_x_m"), 0.003, 1e-9);
        assert_close(last(&record, "body_0_force_z_n"), 0.0, 0.0);
    }
}

/// A body pressed on the floor at a velocity: the force on it is the spring's.
#[test]
fn the_force_on_a_driven_body_is_recorded() {
    let stages = json!([
        {"drive": {"bodies": [{"body": 0, "velocity": {"velocity_m_per_s": [0, 0, -0.001]}}], "steps": 10_000}}]);
    let (_, record) = run(&scene(false, 0.3, 0.0, &stages));
    let pressed = -last(&record, "body_0_displacement_z_m");
    assert_close(pressed, 1e-4, 1e-12);
    // the force is that of the step before the last way
    assert_close(
        last(&record, "body_0_force_z_n"),
        STIFFNESS * (pressed - 1e-8),
        1e-9,
    );
}

/// Grains on a floor of triangles between planes, with everything that drives.
fn shaken() -> Value {
    let mut bodies = Vec::new();
    for number in 0..15 * 15 * 15 {
        let place = [number % 15, number / 15 % 15, number / 225];
        let jitter = |axis: usize| ((number * 7919 + axis * 104_729) % 1000) as f64 * 1e-6;
        let position: Vec<f64> = (0..3)
            .map(|axis| 0.012 + place[axis] as f64 * 0.0215 + jitter(axis))
            .collect();
        bodies.push(json!({"sphere": {"radius_m": 0.01}, "material": "stone", "position_m": position, "velocity_m_per_s": [0.2, 0.1, -1.0]}));
    }
    let mut floor = Vec::new();
    for i in 0..20 {
        for j in 0..20 {
            let place = |i: i32, j: i32| {
                [
                    0.02 * f64::from(i) - 0.03,
                    0.02 * f64::from(j) - 0.03,
                    0.002 * f64::from((i * j) % 3) - 0.005,
                ]
            };
            let [a, b, c, d] = [
                place(i, j),
                place(i + 1, j),
                place(i + 1, j + 1),
                place(i, j + 1),
            ];
            floor.push([a, b, c]);
            floor.push([a, c, d]);
        }
    }
    let plane = |name: &str, axis: &str, position: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": position, "facing": facing, "material": "stone"});
    json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "bodies": bodies,
        "planes": [plane("left", "x", 0.0, 1), plane("right", "x", 0.33, -1), plane("front", "y", 0.0, 1), plane("back", "y", 0.33, -1), plane("lid", "z", 0.34, -1)],
        "facets": [{"name": "floor", "material": "stone", "triangles_m": floor}],
        "stages": [{"run": {"steps": 600}},
            {"drive": {"walls": [
                {"name": "floor", "sine": {"amplitude_m": [0.001, 0, 0.002], "frequency_hz": 40, "phase_rad": 0.3}},
                {"name": "left", "velocity_m_per_s": [0.05, 0.1, 0]},
                {"name": "lid", "force": {"mass_kg": 2, "force_n": [0, 0, -20], "peak_force_n": [0, 0, -200], "period_s": 0.02, "free": ["z"]}}],
              "bodies": [{"body": 5, "force": {"force_n": [0, 0, -1]}}, {"body": 7, "velocity": {"velocity_m_per_s": [0.1, 0, 0], "along": ["x"]}}],
              "steps": 400}},
            {"drive": {"walls": [{"name": "floor", "turn": {"angular_velocity_rad_per_s": [0, 0.5, 0.2], "about_m": [0.15, 0.15, 0]}}], "steps": 300}}],
        "record": {"every_steps": 100, "walls": ["floor"], "contacts": true, "bodies": [0, 5, 7], "snapshot_every_steps": 250}
    })
}

#[test]
fn driven_scenes_have_the_same_bits_on_any_threads_and_in_pieces() {
    let spec = shaken();
    let (expected, whole) = run(&spec);
    let contacts = &expected.summary["contacts"];
    assert!(contacts.value > Some(150.0), "{contacts:?}");
    assert!(
        whole
            .column("floor_force_z_n")
            .iter()
            .any(|force| *force < -1.0)
    );
    // walls are the second part of every picture
    let series = String::from_utf8(whole.files["snapshots.pvd"].clone()).expect("text");
    for file in whole.files.keys().filter(|file| file.contains("walls_")) {
        assert!(
            series.contains(&format!("part=\"1\" file=\"{file}\"")),
            "{series}"
        );
    }
    assert!(series.matches("part=\"1\"").count() > 3);
    for threads in [2, 3] {
        let (report, other) = run_on(&spec, threads);
        assert_eq!(report, expected, "{threads} threads");
        assert!(other.files == whole.files, "{threads} threads");
    }
    assert_resumes(&spec, 5);
}

/// A floor that rises at v under a sphere that is held presses on it with F = k v t: down to the last step.
#[test]
fn a_stage_ends_in_the_step_in_which_its_force_is_met() {
    let (speed, force) = (1e-3, 0.05);
    for is_plane in [true, false] {
        let rise = |speed: f64, until: Value| {
            json!({"drive": {"walls": [{"name": "floor", "velocity_m_per_s": [0, 0, speed]}],
                "until": until, "time_s": 0.1}})
        };
        // the floor is pressed downward
        let up = rise(
            speed,
            json!({"wall": "floor", "axis": "z", "at_most_n": -force}),
        );
        let down = rise(
            -speed,
            json!({"wall": "floor", "axis": "z", "at_least_n": -0.2 * force}),
        );
        let stages = json!([up, down, {"run": {"steps": 1}}]);
        let mut spec = scene(is_plane, 0.0, 0.0, &stages);
        // one free rotation, which nothing drives: pairs that cannot move are not looked at
        spec["bodies"][0]["fixed"] = json!(["x", "y", "z", "ry", "rz"]);
        spec["record"]["stage_ends"] = json!(true);
        spec["record"]["normal_forces"] = json!(["floor"]);
        spec["record"]["every_steps"] = json!(1_000_000);
        let (_, record) = run(&spec);
        let [stage, time, way, pressed, total] = [
            "stage",
            "time_s",
            "floor_displacement_z_m",
            "floor_force_z_n",
            "floor_normal_force_n",
        ]
        .map(|name| record.column(name));
        // F/k = 5e-7 m is 50 steps of 1e-8 m, and the force of a step is that of the place it begins at
        assert_eq!(stage, [1.0, 1.0, 2.0, 3.0]);
        for (row, steps) in [(1, 51.0), (2, 51.0 + 41.0)] {
            assert!((time[row] / 1e-5 - steps).abs() < 1.5, "{time:?}");
            assert_close(way[row], 1e-8 * (51.0 - (steps - 51.0)), 1.5e-8);
        }
        // the row holds the force at the place where the wall came to rest
        for row in 1..3 {
            assert_close(pressed[row], -STIFFNESS * way[row], 1e-9);
            assert_close(total[row], -pressed[row], 1e-12);
        }
    }
}

#[test]
fn a_stage_that_a_force_ends_resumes_to_the_same_bytes() {
    let stages = json!([
        {"drive": {"walls": [{"name": "floor", "velocity_m_per_s": [0, 0, 1e-3]}],
            "until": {"wall": "floor", "axis": "z", "at_most_n": -0.05}, "time_s": 0.1}},
        {"run": {"steps": 2000}}]);
    assert_resumes(&scene(true, 0.3, 0.1, &stages), 1);
}

/// A block that slides on a floor slows down by μg. It lands where nothing rubs: what it keeps of that is
/// the question.
#[test]
fn contacts_keep_the_friction_that_they_began_with_where_that_is_asked_for() {
    let (speed, friction) = (0.2, 0.4_f64);
    // touches from the first step on, and stays
    let smooth = json!({"drive": {"friction_factor": 0, "steps": 200}});
    for (law, stages, slows) in [
        ("renewed", json!([smooth, {"run": {"steps": 1000}}]), true),
        ("kept", json!([smooth, {"run": {"steps": 1000}}]), false),
        ("renewed", json!([{"run": {"steps": 1000}}, smooth]), false),
        ("kept", json!([{"run": {"steps": 1000}}, smooth]), true),
    ] {
        let mut spec = scene(true, friction, 0.0, &stages);
        spec["laws"]["contact_friction"] = json!(law);
        let body_ = &mut spec["bodies"][0];
        body_["fixed"] = json!(["rx", "ry", "rz"]);
        body_["position_m"] = json!([0, 0, RADIUS - mass() * 9.81 / STIFFNESS]);
        body_["velocity_m_per_s"] = json!([speed, 0, 0]);
        // the second stage, in which the first pair of laws differs, or the last
        let (from, to) = if stages[0]["drive"].is_object() {
            (300, 1100)
        } else {
            (1010, 1190)
        };
        let (_, record) = run(&spec);
        let velocity = |step| body(&record, step, 0)[1][0];
        let slowing = (velocity(from) - velocity(to)) / (1e-5 * f64::from((to - from) as u32));
        let expected = if slows { friction.tan() * 9.81 } else { 0.0 };
        assert!(
            (slowing - expected).abs() < 1e-3 * 9.81,
            "{law}: {slowing} {expected}"
        );
    }
}
