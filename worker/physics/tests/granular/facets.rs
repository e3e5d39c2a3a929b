//! Walls of triangles: as planes where they are flat, each feature once.
use serde_json::{Value, json};

use super::{Record, assert_close, body, contact, run, run_on, sphere};

/// Round-off of some ten thousand steps, relative to the size of the numbers.
const ROUND_OFF: f64 = 1e-11;

const RADIUS: f64 = 0.01;
/// E r: two equal surfaces in series.
const STIFFNESS: f64 = 1e5;

fn scene(body: &Value, planes: &Value, facets: &Value, steps: u64) -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "stiffness_ratio": 0.3, "friction_angle_rad": 0.4}},
        "bodies": [body], "planes": planes, "facets": facets,
        "laws": {"local_damping": 0.0},
        "time_step_s": 1e-5,
        "stages": [{"run": {"steps": steps}}],
        "record": {"every_steps": 10, "contacts": true}
    })
}

fn base() -> Value {
    json!([{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}])
}

fn mesh(name: &str, triangles: &[[[f64; 3]; 3]]) -> Value {
    json!({"name": name, "material": "stone", "triangles_m": triangles})
}

/// The floor z = 0 from −0.1 to 0.2 in x and y, of two triangles for each of `side`² squares whose
/// inner corners are off the raster.
fn floor(side: usize) -> Vec<[[f64; 3]; 3]> {
    let place = |number: usize, other: usize| {
        let off = if number == 0 || number == side {
            0.0
        } else {
            ((number * 7919 + other * 104_729) % 100) as f64 * 0.004 - 0.2
        };
        -0.1 + 0.3 * (number as f64 + off) / side as f64
    };
    let corner = |i: usize, j: usize| [place(i, j), place(j, i + 31), 0.0];
    let mut triangles = Vec::new();
    for i in 0..side {
        for j in 0..side {
            let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[x, y]| corner(i + x, j + y));
            // triangles of either orientation: facets have two sides
            triangles.push([a, b, c]);
            triangles.push(if (i + j) % 2 == 0 {
                [a, c, d]
            } else {
                [a, d, c]
            });
        }
    }
    triangles
}

#[track_caller]
fn assert_same_motion(found: &Record, expected: &Record, tolerance: f64) {
    let [found, expected] = [found, expected].map(|record| record.table("bodies.csv"));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        for column in 0..12 {
            let scale = if column < 6 { 1.0 } else { 100.0 };
            assert_close(found[column], expected[column], tolerance * scale);
        }
    }
}

fn thrown(velocity: [f64; 3], spin: [f64; 3]) -> Value {
    let mut body = sphere("stone", RADIUS, [0.003, 0.002, 0.0101], velocity);
    body["angular_velocity_rad_per_s"] = json!(spin);
    body
}

#[test]
fn an_impact_on_a_facet_is_one_on_a_plane() {
    let body = thrown([0.3, -0.2, -1.0], [-10.0, 7.0, 15.0]);
    let plate = mesh(
        "plate",
        &[[[-9.0, -8.0, 0.0], [9.0, -7.0, 0.0], [0.0, 9.0, 0.0]]],
    );
    let (_, on_plane) = run(&scene(&body, &base(), &json!([]), 2000));
    let (_, on_facet) = run(&scene(&body, &json!([]), &json!([plate]), 2000));
    // it lasts a millisecond
    assert_eq!(on_plane.table("contacts.csv").len(), 10);
    assert_same_motion(&on_facet, &on_plane, ROUND_OFF);
}

#[test]
fn a_sphere_slides_and_rolls_over_many_triangles_as_over_a_plane() {
    // it begins to slide, spins against its way, and comes to roll: some hundred edges, and corners
    let body = thrown([0.8, 0.45, 0.0], [0.0, -60.0, 20.0]);
    let (_, on_plane) = run(&scene(&body, &base(), &json!([]), 20_000));
    let [position, ..] = super::body(&on_plane, 20_000, 0);
    assert!(position[0] > 0.05 && position[1] > 0.03, "{position:?}");
    for side in [1, 4, 30, 100] {
        let facets = json!([mesh("floor", &floor(side))]);
        let (_, on_facets) = run(&scene(&body, &json!([]), &facets, 20_000));
        assert_same_motion(&on_facets, &on_plane, 100.0 * ROUND_OFF);
    }
}

/// What a law remembers goes along, whatever law it is.
#[test]
fn every_law_feels_a_flat_wall_as_a_plane() {
    for (law, restitution, shear_restitution) in [
        ("hertz_mindlin", 0.6, 1.0),
        ("logarithmic", 0.8, 0.5),
        ("hertz_mindlin", 1.0, 1.0),
    ] {
        for friction in [0.4, 0.0] {
            let facets = json!([mesh("floor", &floor(30))]);
            let [expected, found] =
                [(base(), json!([])), (json!([]), facets)].map(|(planes, facets)| {
                    let mut spec = scene(
                        &thrown([0.8, 0.45, -0.1], [0.0, -60.0, 20.0]),
                        &planes,
                        &facets,
                        10_000,
                    );
                    spec["laws"]["contact"] = json!(law);
                    spec["materials"]["stone"]["friction_angle_rad"] = json!(friction);
                    if restitution < 1.0 {
                        spec["materials"]["stone"]["restitution"] = json!(restitution);
                        spec["materials"]["stone"]["shear_restitution"] = json!(shear_restitution);
                    }
                    run(&spec).1
                });
            assert_same_motion(&found, &expected, 100.0 * ROUND_OFF);
        }
    }
}

/// Triangles that meet with unequal edges, and in walls of two names.
#[test]
fn walls_that_go_on_in_other_walls_are_one_plane() {
    let body = thrown([0.8, 0.05, 0.0], [0.0, 30.0, 0.0]);
    let (_, on_plane) = run(&scene(&body, &base(), &json!([]), 15_000));
    let behind = [
        [[-1.0, -1.0, 0.0], [0.02, -1.0, 0.0], [0.02, 1.0, 0.0]],
        [[-1.0, -1.0, 0.0], [0.02, 1.0, 0.0], [-1.0, 1.0, 0.0]],
    ];
    // its edges end in the middle of the other's
    let mut before = Vec::new();
    for strip in 0..400 {
        let [low, high] = [strip, strip + 1].map(|strip| -1.0 + 0.005 * f64::from(strip));
        before.push([[0.02, low, 0.0], [1.0, 0.0, 0.0], [0.02, high, 0.0]]);
    }
    let facets = json!([mesh("behind", &behind), mesh("before", &before)]);
    let (_, on_facets) = run(&scene(&body, &json!([]), &facets, 15_000));
    assert_same_motion(&on_facets, &on_plane, 100.0 * ROUND_OFF);
}

/// A block that slides from where nearly nothing rubs: what its contact keeps of that goes along from triangle
/// to triangle, but not to another material.
#[test]
fn friction_that_is_kept_goes_from_triangle_to_triangle() {
    let mut block = sphere("stone", RADIUS, [0.003, 0.002, 0.0], [1.0, 0.0, 0.0]);
    let weight = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 9.81;
    block["position_m"][2] = json!(RADIUS - weight / STIFFNESS);
    block["fixed"] = json!(["rx", "ry", "rz"]);
    let half = |low: f64, high: f64| {
        [
            [[low, -1.0, 0.0], [high, -1.0, 0.0], [high, 1.0, 0.0]],
            [[low, -1.0, 0.0], [high, 1.0, 0.0], [low, 1.0, 0.0]],
        ]
    };
    let mut other = mesh("before", &half(0.02, 1.0));
    let halves = json!([mesh("behind", &half(-1.0, 0.02)), other.clone()]);
    other["material"] = json!("slab");
    let materials = json!([mesh("behind", &half(-1.0, 0.02)), other]);
    let (kept, renewed, slab) = (0.25 * 0.4_f64.tan(), 0.4_f64.tan(), 0.2_f64.tan());
    for (law, planes, facets, friction) in [
        ("kept", base(), json!([]), kept),
        ("kept", json!([]), json!([mesh("floor", &floor(30))]), kept),
        ("kept", json!([]), halves, kept),
        ("kept", json!([]), materials.clone(), slab),
        ("renewed", json!([]), materials, slab),
        (
            "renewed",
            json!([]),
            json!([mesh("floor", &floor(30))]),
            renewed,
        ),
    ] {
        let mut spec = scene(&block, &planes, &facets, 10_000);
        spec["materials"]["slab"] = spec["materials"]["stone"].clone();
        spec["materials"]["slab"]["friction_angle_rad"] = json!(0.2);
        spec["laws"]["contact_friction"] = json!(law);
        spec["stages"] = json!([
            {"drive": {"friction_factor": 0.25, "steps": 200}}, {"run": {"steps": 9800}}]);
        let (_, record) = run(&spec);
        let velocity = |step| super::body(&record, step, 0)[1][0];
        // from where it is on the second half
        let slowing = (velocity(5000) - velocity(10_000)) / 0.05;
        assert_close(slowing, 9.81 * friction, 1e-6 * 9.81);
    }
}

/// A light block so fast that its contact, 0.28 mm across, comes 0.4 mm far in a step: no step sees it on two
/// triangles.
#[test]
fn friction_that_is_kept_goes_along_with_a_fast_block() {
    let mut block = sphere("stone", RADIUS, [0.003, 0.002, 0.0], [3.0, 0.0, 0.0]);
    let weight = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 9.81;
    block["position_m"][2] = json!(RADIUS - weight / STIFFNESS);
    block["fixed"] = json!(["rx", "ry", "rz"]);
    let strips = (0..25).flat_map(|strip| {
        let low = 0.04 * f64::from(strip) - 0.02;
        let high = low + 0.04;
        [
            [[low, -1.0, 0.0], [high, -1.0, 0.0], [high, 1.0, 0.0]],
            [[low, -1.0, 0.0], [high, 1.0, 0.0], [low, 1.0, 0.0]],
        ]
    });
    let facets = json!([mesh("floor", &strips.collect::<Vec<_>>())]);
    let (first, last, step) = (20, 1500, 1.3e-4);
    for (law, factor) in [("kept", 0.1), ("renewed", 1.0)] {
        let mut spec = scene(&block, &json!([]), &facets, last);
        spec["time_step_s"] = json!(step);
        spec["laws"]["contact_friction"] = json!(law);
        spec["stages"] = json!([
            {"drive": {"friction_factor": 0.1, "steps": first}}, {"run": {"steps": last - first}}]);
        let (_, record) = run(&spec);
        let velocity = |step| super::body(&record, step, 0)[1][0];
        let slowing = (velocity(first) - velocity(last)) / (step * (last - first) as f64);
        assert_close(slowing, 9.81 * factor * 0.4_f64.tan(), 1e-6 * 9.81);
        super::determinism::assert_resumes(&spec, 1);
    }
}

/// Contacts of body 0 in the first recorded step.
fn first_contacts(
    position: [f64; 3],
    triangles: &[[[f64; 3]; 3]],
    convention: &str,
) -> Vec<Vec<f64>> {
    let mut spec = scene(
        &sphere("stone", RADIUS, position, [0.0; 3]),
        &json!([]),
        &json!([mesh("wall", triangles)]),
        1,
    );
    spec["laws"]["convention"] = json!(convention);
    let (_, record) = run(&spec);
    record.table("contacts.csv")
}

#[test]
fn ridges_hollows_and_peaks_are_touched_once_each() {
    let overlap = 0.0002;
    let above = RADIUS - overlap;
    // a ridge along y: both triangles give the same point
    let ridge = [
        [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, -1.0]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
    ];
    let contacts = first_contacts([0.0, 0.1, above], &ridge, "loadframe");
    assert_eq!(contacts.len(), 1);
    assert_close(contacts[0][3], overlap, 1e-15);
    assert_close(contacts[0][9], -STIFFNESS * overlap, 1e-9);
    // a peak of many triangles
    let rim = |number: u32| {
        let (sine, cosine) = (f64::from(number) * std::f64::consts::TAU / 12.0).sin_cos();
        [cosine, sine, -1.0]
    };
    let peak: Vec<_> = (0..12).map(|n| [[0.0; 3], rim(n), rim(n + 1)]).collect();
    assert_eq!(
        first_contacts([0.0, 0.0, above], &peak, "loadframe").len(),
        1
    );
    // in a hollow both sides carry, as two planes would
    let hollow = [
        [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 1.0]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    ];
    let contacts = first_contacts([0.0, 0.1, above * 2.0_f64.sqrt()], &hollow, "loadframe");
    assert_eq!(contacts.len(), 2);
    assert_close(contacts[0][3], overlap, 1e-15);
    // beside an edge of a flat wall the triangle below carries alone; by Yade's rule, all near ones do
    let flat = floor(1);
    let beside = [0.0501, 0.05, above];
    assert_eq!(first_contacts(beside, &flat, "loadframe").len(), 1);
    let contacts = first_contacts(beside, &flat, "yade");
    assert_eq!(contacts.len(), 2);
    // 2r for the facet: two springs E 2r and E 4r in series
    let stiffness = 2.0 / 1.5 * STIFFNESS;
    let largest = contacts
        .iter()
        .map(|contact| -contact[9])
        .fold(0.0, f64::max);
    assert_close(largest, stiffness * overlap, 1e-9);
}

/// What is on the other side is pushed to the other side.
#[test]
fn facets_have_two_sides() {
    let below = [0.0, 0.0, -(RADIUS - 0.0002)];
    let contacts = first_contacts(below, &floor(4), "loadframe");
    assert_eq!(contacts.len(), 1);
    assert_close(contacts[0][9], STIFFNESS * 0.0002, 1e-9);
}

const SLOPE: f64 = 0.4;

/// A block of four spheres on an inclined wall of many triangles.
fn block(friction: f64, damping: f64) -> Value {
    let (sine, cosine) = SLOPE.sin_cos();
    let turned = |[x, y, z]: [f64; 3]| [cosine * x + sine * z, y, cosine * z - sine * x];
    let foot = |x: f64, y: f64| json!({"offset_m": turned([x, y, 0.0]), "radius_m": 0.01});
    let slope: Vec<_> = floor(25)
        .iter()
        .map(|corners| corners.map(|[x, y, z]| turned([10.0 * x, 10.0 * y, z])))
        .collect();
    json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": friction}},
        "bodies": [{"clump": {"members": [foot(-0.1, -0.1), foot(0.1, -0.1), foot(-0.1, 0.1), foot(0.1, 0.1)]},
                    "material": "stone", "position_m": turned([0.0, 0.0, 0.01])}],
        "facets": [mesh("slope", &slope)],
        "laws": {"local_damping": damping},
        "time_step_s": 1e-5,
        "stages": [{"run": {"steps": 50_000}}],
        "record": {"every_steps": 10_000, "walls": ["slope"]}
    })
}

#[test]
fn a_block_on_a_slope_of_triangles_slides_above_the_angle_of_friction_only() {
    let friction: f64 = 0.3;
    let (_, record) = run(&block(friction, 0.0));
    let acceleration = 9.81 * (SLOPE.sin() - friction.tan() * SLOPE.cos());
    let [_, velocity, _] = body(&record, 50_000, 0);
    let along = SLOPE.cos() * velocity[0] - SLOPE.sin() * velocity[2];
    // it starts without load on its feet and bounces a little: friction follows the load
    assert_close(along, acceleration * 0.5, 0.01 * acceleration * 0.5);
    let (report, record) = run(&block(0.5, 0.3));
    let [_, velocity, _] = body(&record, 50_000, 0);
    assert!(velocity[0].abs() < 1e-9, "{velocity:?}");
    let last = record.points.len() - 1;
    let weight = report.summary["total_mass"].value.expect("a mass") * 9.81;
    assert_close(
        record.column("slope_force_z_n")[last],
        -weight,
        1e-6 * weight,
    );
    assert_close(record.column("slope_force_x_n")[last], 0.0, 1e-6 * weight);
}

/// STL text and binary, in millimetres and at another place, are the same wall.
#[test]
fn stl_is_read_scaled_and_placed() {
    use base64::{Engine as _, prelude::BASE64_STANDARD};
    let corners = [[-90.0, -80.0, 5.0], [90.0, -70.0, 5.0], [0.0, 90.0, 5.0]];
    let vertex = |c: &[f64; 3]| format!("vertex {} {} {}\n", c[0], c[1], c[2]);
    let ascii = format!(
        "solid plate\nfacet normal 0 0 1\nouter loop\n{}endloop\nendfacet\nendsolid\n",
        corners.iter().map(vertex).collect::<String>()
    );
    let mut binary = vec![0_u8; 80];
    binary.extend(1_u32.to_le_bytes());
    binary.extend([0; 12]);
    for value in corners.iter().flatten() {
        binary.extend((*value as f32).to_le_bytes());
    }
    binary.extend([0; 2]);
    let plain = corners.map(|[x, y, _]| [x * 1e-3, y * 1e-3, 0.0]);
    let body = thrown([0.3, -0.2, -1.0], [-10.0, 7.0, 15.0]);
    let (_, expected) = run(&scene(
        &body,
        &json!([]),
        &json!([mesh("plate", &[plain])]),
        500,
    ));
    for stl in [ascii, BASE64_STANDARD.encode(binary)] {
        let wall = json!([{"name": "plate", "material": "stone", "stl": stl, "scale": 1e-3, "position_m": [0, 0, -0.005]}]);
        let (_, found) = run(&scene(&body, &json!([]), &wall, 500));
        assert_same_motion(&found, &expected, ROUND_OFF);
    }
}

/// A fine wall costs its search, once, and a look at the few triangles near a sphere.
#[test]
fn thousands_of_triangles_are_hardly_looked_at() {
    let body = sphere("stone", RADIUS, [0.003, 0.002, RADIUS], [0.0; 3]);
    let spec = scene(&body, &json!([]), &json!([mesh("floor", &floor(60))]), 1000);
    let (report, record) = run_on(&spec, 1);
    // a square is half a radius wide, and some ten squares are below the sphere
    let looked = report.work["candidate_steps"] / report.work["steps"];
    assert!((1..60).contains(&looked), "{looked} of 7200");
    assert!(contact(&record, 1000, [0, 1]).is_some());
}

/// Beside an open wall a body falls for ever, and is told of.
#[test]
fn a_body_that_falls_off_a_wall_is_named() {
    let beside = sphere("stone", RADIUS, [0.0, 0.3, 0.05], [0.0; 3]);
    let mut spec = scene(&beside, &json!([]), &json!([mesh("floor", &floor(1))]), 1);
    spec["time_step_s"] = json!("auto");
    spec["stages"] = json!([{"run": {"time_s": 1.0}}]);
    let (report, _) = run(&spec);
    assert_eq!(report.summary["escaped_bodies"].value, Some(1.0));
    let warning = &report.warnings[0];
    assert_eq!(warning.code, "escaped_bodies");
    assert!(warning.detail.ends_with(": 0"), "{}", warning.detail);
}
