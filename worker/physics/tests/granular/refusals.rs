//! What peers compute without a word is refused, or told.
use loadframe_physics::SimulationError;
use serde_json::{Value, json};

use super::{body, codes, failure, one, run, sphere, submission};

fn scene(bodies: &[Value]) -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "bodies": bodies,
        "planes": [{"name": "base", "axis": "z", "position_m": 0, "facing": 1, "material": "stone"}],
        "laws": {"local_damping": 0.3},
        "stages": [{"run": {"steps": 1000}}]
    })
}

#[test]
fn bodies_inside_each_other_are_refused() {
    let at = |z: f64| sphere("stone", 0.01, [0.0, 0.0, z], [0.0; 3]);
    assert_eq!(
        codes(&scene(&[at(0.01), at(0.029)])),
        one("/spec/bodies/1/position_m", "overlap")
    );
    assert!(
        submission(&scene(&[at(0.01), at(0.0296)])).is_ok(),
        "4 % may overlap"
    );
    let mut soft = scene(&[at(0.01), at(0.029)]);
    soft["largest_overlap_at_start"] = json!(0.11);
    assert!(submission(&soft).is_ok(), "more where it is meant");
    soft["largest_overlap_at_start"] = json!(0.09);
    assert_eq!(codes(&soft), one("/spec/bodies/1/position_m", "overlap"));
    assert_eq!(
        codes(&scene(&[at(0.01), at(0.01)])),
        one("/spec/bodies/1/position_m", "equal_centres")
    );
    assert_eq!(
        codes(&scene(&[at(0.005)])),
        one("/spec/bodies/0/position_m", "overlap")
    );
    assert_eq!(
        codes(&scene(&[at(-0.5)])),
        one("/spec/bodies/0/position_m", "overlap")
    );
}

#[test]
fn an_unstable_step_is_refused_with_the_right_one() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    // 2√(m/K) with m = 4/3 π 2600 1e-6 kg and K = 1e8 · 0.01 N/m, or the shear mode's 3.5 · 0.3 K
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 2600.0 * 1e-6;
    let critical = 2.0 * (mass / (1.05 * 1e6_f64)).sqrt();
    spec["time_step_s"] = json!(1.01 * critical);
    assert_eq!(codes(&spec), one("/spec/time_step_s", "unstable"));
    spec["allow_unstable"] = json!(true);
    assert!(submission(&spec).is_ok());
    spec["allow_unstable"] = json!(false);
    spec["time_step_s"] = json!(0.99 * critical);
    assert!(submission(&spec).is_ok());
}

#[test]
fn a_body_that_would_tunnel_is_refused_or_stopped() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0, 0.0, -200.0])]);
    spec["time_step_s"] = json!(1e-5);
    assert_eq!(
        codes(&spec),
        one("/spec/bodies/0/velocity_m_per_s", "too_fast")
    );
    spec["time_step_s"] = json!("auto");
    let (_, record) = run(&spec);
    let [position, velocity, _] = body(&record, 1000, 0);
    assert!(
        position[2] > 0.01 && velocity[2] > 0.0,
        "it bounced: {position:?}"
    );
    // it becomes too fast only while it falls
    spec["bodies"] = json!([sphere("stone", 0.01, [0.0, 0.0, 1.0], [0.0; 3])]);
    spec["gravity_m_per_s2"] = json!([0, 0, -1e6]);
    spec["time_step_s"] = json!(1e-5);
    assert!(matches!(
        failure(&spec),
        SimulationError::TooFast { body: 0, .. }
    ));
}

#[test]
fn names_that_do_not_exist_are_all_told_at_once() {
    let mut spec = scene(&[sphere("chalk", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    spec["stages"] =
        json!([{"run": {}}, {"move_plane": {"name": "top", "velocity_m_per_s": -0.1, "steps": 5}}]);
    spec["record"] = json!({"bodies": [3], "planes": ["lid"]});
    let expected = [
        ("/spec/bodies/0/material", "no_such_material"),
        ("/spec/stages/0/run", "not_one_duration"),
        ("/spec/stages/1/move_plane/name", "no_such_plane"),
        ("/spec/record/planes/0", "no_such_plane"),
        ("/spec/record/bodies/0", "no_such_body"),
    ];
    let expected: Vec<(String, String)> = expected
        .iter()
        .map(|(p, c)| ((*p).to_owned(), (*c).to_owned()))
        .collect();
    assert_eq!(codes(&spec), expected);
}

#[test]
fn unknown_fields_are_refused() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    spec["cylinders"] = json!([]);
    spec["bodies"][0]["colour"] = json!("red");
    spec["stages"] = json!([{"explode": {"steps": 10}}]);
    let mut found = codes(&spec);
    found.sort();
    assert!(
        found
            .iter()
            .any(|(pointer, code)| pointer == "/spec/cylinders" && code == "unknown_field"),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|(pointer, _)| pointer == "/spec/bodies/0/colour"),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|(pointer, _)| pointer.starts_with("/spec/stages/0")),
        "{found:?}"
    );
}

#[test]
fn bodies_that_leave_are_told_of() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [10.0, 0.0, 0.0])]);
    spec["gravity_m_per_s2"] = json!([0, 0, 0]);
    spec["stages"] = json!([{"run": {"time_s": 0.1}}]);
    let (report, _) = run(&spec);
    assert_eq!(report.summary["escaped_bodies"].value, Some(1.0));
    assert!(
        report
            .warnings
            .iter()
            .any(|warning| warning.code == "escaped_bodies")
    );
}

#[test]
fn walls_that_are_no_surfaces_are_refused() {
    let plate = json!([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]);
    let wall = |key: &str, value: Value| {
        let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
        spec["facets"] = json!([{"name": "wall", "material": "stone", key: value}]);
        spec
    };
    // an open surface is a wall like any other
    assert!(
        submission(&wall(
            "triangles_m",
            json!([[[5, 5, 0], [6, 5, 0], [5, 6, 0]]])
        ))
        .is_ok()
    );
    for (key, value, pointer, code) in [
        (
            "triangles_m",
            json!([]),
            "/spec/facets/0/triangles_m",
            "wrong_length",
        ),
        (
            "triangles_m",
            json!([plate[0], [[0, 0, 0], [1, 1, 1], [2, 2, 2]]]),
            "/spec/facets/0/triangles_m/1",
            "no_area",
        ),
        (
            "triangles_m",
            json!([[[0, 0, 0], [0, 0, 0], [1, 0, 0]]]),
            "/spec/facets/0/triangles_m/0",
            "no_area",
        ),
        ("stl", json!("c29s*"), "/spec/facets/0/stl", "not_a_surface"),
        ("stl", json!("AAAA"), "/spec/facets/0/stl", "not_a_surface"),
        (
            "stl",
            json!("solid empty\nendsolid\n"),
            "/spec/facets/0/stl",
            "not_a_surface",
        ),
        (
            "stl",
            json!(
                "solid s\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 2 0 0\nendloop\nendfacet\nendsolid"
            ),
            "/spec/facets/0/stl",
            "no_area",
        ),
        ("scale", json!(2.0), "/spec/facets/0", "not_one_source"),
    ] {
        assert_eq!(codes(&wall(key, value)), one(pointer, code), "{key}");
    }
    let mut both = wall("triangles_m", plate.clone());
    both["facets"][0]["stl"] = json!("solid");
    assert_eq!(codes(&both), one("/spec/facets/0", "not_one_source"));
    let mut name = wall("triangles_m", plate);
    name["facets"][0]["name"] = json!("base");
    name["facets"][0]["material"] = json!("gold");
    assert_eq!(
        codes(&name),
        [
            one("/spec/facets/0/material", "no_such_material"),
            one("/spec/facets/0/name", "name_taken")
        ]
        .concat()
    );
}

#[test]
fn bodies_in_facets_are_refused() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    let at = |height: f64| json!([{"name": "wall", "material": "stone", "triangles_m": [[[-1, -1, height], [1, -1, height], [0, 1, height]]]}]);
    spec["facets"] = at(0.0104);
    assert!(submission(&spec).is_ok(), "4 % may overlap");
    spec["facets"] = at(0.0106);
    assert_eq!(codes(&spec), one("/spec/bodies/0/position_m", "overlap"));
}

#[test]
fn drives_of_nothing_are_refused() {
    let mut spec = scene(&[sphere("stone", 0.01, [0.0, 0.0, 0.02], [0.0; 3])]);
    spec["record"] = json!({"walls": ["lid"]});
    spec["stages"] = json!([{"drive": {"steps": 10,
        "walls": [
            {"name": "lid", "velocity_m_per_s": [0, 0, 1]},
            {"name": "base"},
            {"name": "base", "turn": {"angular_velocity_rad_per_s": [0, 0, 1]}},
            {"name": "floor", "force": {"mass_kg": 1, "force_n": [0, 0, 1], "period_s": 1, "free": ["z"]}}],
        "bodies": [
            {"body": 3, "force": {"force_n": [0, 0, 1]}},
            {"body": 0},
            {"body": 0, "velocity": {"velocity_m_per_s": [0, 0, 1]}, "force": {"force_n": [0, 0, 1], "peak_force_n": [0, 0, 2]}}]}}]);
    let at = |path: &str, code: &str| (format!("/spec/stages/0/drive/{path}"), code.to_owned());
    let expected = [
        at("walls/0/name", "no_such_wall"),
        at("walls/1", "not_one_drive"),
        at("walls/2/name", "driven_twice"),
        at("walls/2/turn", "plane_cannot_turn"),
        at("walls/3/name", "no_such_wall"),
        at("walls/3/force/period_s", "not_both"),
        at("bodies/0/body", "no_such_body"),
        at("bodies/1", "not_one_drive"),
        at("bodies/2/body", "driven_twice"),
        at("bodies/2", "not_one_drive"),
        at("bodies/2/force/period_s", "not_both"),
        ("/spec/record/walls/0".to_owned(), "no_such_wall".to_owned()),
    ];
    assert_eq!(codes(&spec), expected);
}
