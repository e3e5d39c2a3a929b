//! Grains that are made and put in beside walls of triangles, and grains whose shape is one.
use std::fmt::Write as _;

use serde_json::{Value, json};

use super::{assert_close, body, run};

const DENSITY: f64 = 2600.0;
/// Where a plate of two triangles stands across x [m].
const PLATE: f64 = 0.1;
/// Round-off, relative.
const ROUND_OFF: f64 = 1e-9;

/// A plate through the whole of a scene.
fn plate() -> Value {
    let corner = |y: f64, z: f64| [PLATE, y, z];
    let corners = [(-1.0, -1.0), (2.0, -1.0), (2.0, 2.0), (-1.0, 2.0)];
    let [a, b, c, d] = corners.map(|(y, z)| corner(y, z));
    json!([{"name": "plate", "material": "stone", "triangles_m": [[a, b, c], [a, c, d]]}])
}

fn grains(count: u32, grain: &Value, arrangement: &str) -> Value {
    json!({"material": "stone", "count": count, "grain": grain, "arrangement": arrangement,
           "sizes": {"radius_m": 0.01},
           "region": {"box": {"lower_m": [0, 0, 0], "upper_m": [0.21, 0.2, 0.2]}}})
}

fn scene(generate: &Value, stages: &Value) -> Value {
    json!({
        "version": 1, "seed": 5, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": DENSITY, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.5}},
        "generate": generate, "facets": plate(), "stages": stages
    })
}

/// Distances of bodies from the plate, to the left negative [m].
fn distances(spec: &Value) -> Vec<f64> {
    let (report, _) = run(spec);
    let overlap = report.quality["largest_overlap_ratio"].value;
    assert!(overlap <= ROUND_OFF, "{overlap}");
    let bodies = report.bodies.iter();
    bodies.map(|body| body.centre_m[0] - PLATE).collect()
}

/// As many as asked on both sides, none closer to the plate than its radius.
#[track_caller]
fn assert_clear(distances: &[f64], count: usize, radius: f64) {
    assert_eq!(distances.len(), count);
    for distance in distances {
        assert!(distance.abs() >= radius * (1.0 - ROUND_OFF), "{distance}");
    }
    let left = distances.iter().filter(|distance| **distance < 0.0).count();
    assert!(left > count / 4 && left < 3 * count / 4, "{left}");
}

#[test]
fn grains_are_made_clear_of_facets() {
    let still = json!([{"run": {"steps": 1}}]);
    // a fifth of the region's places reach into the plate
    let spheres = json!([grains(300, &json!("sphere"), "random")]);
    assert_clear(&distances(&scene(&spheres, &still)), 300, 0.01);
    // in a lattice it stands in one of ten rows
    let lattice = json!([grains(700, &json!("sphere"), "grid")]);
    assert_clear(&distances(&scene(&lattice, &still)), 700, 0.01);
    let pair = json!({"clump": {"members": [{"offset_m": [0, 0, 0], "radius_m": 1}, {"offset_m": [1, 0, 0], "radius_m": 1}]}});
    let clumps = json!([grains(60, &pair, "random")]);
    assert_clear(&distances(&scene(&clumps, &still)), 60, 0.01);
}

#[test]
fn grains_are_put_in_clear_of_facets() {
    let insert = json!([{"insert": {"every_s": 0.01, "time_s": 0.005, "bodies": grains(200, &json!("sphere"), "random")}}]);
    assert_clear(&distances(&scene(&json!([]), &insert)), 200, 0.01);
}

/// A cube as STL text, in millimetres, somewhere.
fn cube(side: f64) -> String {
    let mut text = "solid cube\n".to_owned();
    for axis in 0..3 {
        for end in [0.0, side] {
            let corner = |u: f64, v: f64| {
                let mut corner = [7.0; 3];
                corner[axis] += end;
                corner[(axis + 1) % 3] += u;
                corner[(axis + 2) % 3] += v;
                if end == 0.0 {
                    // seen from outside, corners go round to the left
                    corner.swap((axis + 1) % 3, (axis + 2) % 3);
                }
                corner
            };
            let [a, b, c, d] =
                [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(u, v)| corner(u, v));
            for triangle in [[a, b, c], [a, c, d]] {
                text += "facet normal 0 0 0\nouter loop\n";
                for [x, y, z] in triangle {
                    writeln!(text, "vertex {x} {y} {z}").expect("text grows");
                }
                text += "endloop\nendfacet\n";
            }
        }
    }
    text + "endsolid cube\n"
}

#[test]
fn a_scanned_shape_is_filled_with_spheres_and_comes_to_rest_on_them() {
    let (radius, height) = (0.005_f64, 0.027);
    // five rows of touching spheres along each edge, half a millimetre from the faces
    let shape = json!({"surface": {"stl": cube(51.0), "scale": 1e-3}});
    let filled = json!({"shape": shape, "member_radius_m": radius, "lattice": "simple_cubic"});
    let spec = json!({
        "version": 1,
        "materials": {"stone": {"density_kg_per_m3": DENSITY, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.5}},
        "bodies": [{"clump": {"filled": filled}, "material": "stone", "position_m": [0.2, 0.1, height]}],
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
        "laws": {"local_damping": 0.3},
        "stages": [{"settle": {"time_s": 1.0}}],
        "record": {"every_steps": 1_000_000, "planes": ["base"], "bodies": [0]}
    });
    let (report, record) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(report.summary["particles"].value, Some(125.0));
    let member = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * DENSITY;
    let found = &report.bodies[0];
    assert_close(found.mass_kg, 125.0 * member, ROUND_OFF * found.mass_kg);
    // rows at 0, 2 and 4 radii from the middle: their mean square is 8 r², along two axes
    let inertia = 125.0 * member * (0.4 + 16.0) * radius * radius;
    for row in 0..3 {
        for column in 0..3 {
            let expected = if row == column { inertia } else { 0.0 };
            assert_close(
                found.inertia_kg_m2[row][column],
                expected,
                ROUND_OFF * inertia,
            );
        }
    }
    // twenty-five springs E r between sphere and plane carry it
    let step = report.work["steps"];
    let [place, ..] = body(&record, step, 0);
    let weight = 9.81 * found.mass_kg;
    let sunk = weight / (25.0 * 1e7 * radius);
    assert_close(place[2], 5.0 * radius - sunk, 0.01 * sunk);
    let force = *record.column("base_force_n").last().expect("a row");
    assert_close(force, -weight, 0.01 * weight);
}
