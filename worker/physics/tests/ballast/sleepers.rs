//! What lies under a bed, and sleepers that tilt on it.
use loadframe_api::{JobSpec, spec::granular_scene::DegreeOfFreedom};
use serde_json::{Value, json};

use super::{run, small_oedometer, submission, value};

/// A box of some thirty spheres, under a sleeper of spheres.
fn small_box() -> Value {
    json!({"kind": "ballast_box", "spec": {
        "version": 1,
        "grains": {"sizes": {"radius_m": 0.03}},
        "materials": {"aggregate": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7,
            "stiffness_ratio": 0.3, "friction_angle_rad": 0.5}},
        "apparatus": {"length_m": 0.4, "width_m": 0.2, "height_m": 0.25, "height_below_m": 0.2,
            "sleeper": {"length_m": 0.2, "width_m": 0.2, "height_m": 0.1, "mass_kg": 10,
                "member_radius_m": 0.025}},
        "test": {"smallest_force_n": 50, "peak_force_n": 500},
        "preparation": {"compaction": null, "longest_settling_s": 0.5},
        "accuracy": {"critical_step_fraction": 0.4, "inertial_number": 1e-2},
        "output": {"rows_per_cycle": 50}
    }})
}

fn refused(job: &Value) -> Vec<(String, String)> {
    let violations = submission(job).expect_err("this must be refused");
    let pairs = violations.into_iter();
    pairs
        .map(|violation| (violation.pointer, violation.code))
        .collect()
}

fn one(pointer: &str, code: &str) -> Vec<(String, String)> {
    vec![(pointer.to_owned(), code.to_owned())]
}

#[test]
fn a_sleeper_leans_to_the_side_its_rail_stands_on() {
    let mut job = small_box();
    job["spec"]["apparatus"]["sleeper"]["tilts"] = json!(true);
    job["spec"]["apparatus"]["sleeper"]["rail_m"] = json!([0.08, 0]);
    let (report, record) = run(&job);
    let [tilt, about_x, about_y] =
        ["tilt_rad", "turn_about_x_rad", "turn_about_y_rad"].map(|name| record.column(name));
    for ((tilt, x), y) in tilt.iter().zip(&about_x).zip(&about_y) {
        // what is no turn about z is all tilt, but for what two turns together make of one about z
        assert!((tilt - x.hypot(*y)).abs() < 0.02 * tilt, "{tilt} {x} {y}");
    }
    let force = record.column("force_kn");
    let most = (0..force.len()).max_by(|a, b| force[*a].total_cmp(&force[*b]));
    let most = most.expect("rows");
    assert!((value(&report, "tilt_at_peak") - tilt[most]).abs() < 1e-15);
    assert!((value(&report, "tilt_at_end") - tilt[tilt.len() - 1]).abs() < 1e-15);
    assert!(value(&report, "tilt_before_loading") >= 0.0);
    // its middle is above the ballast that is cut off beside it, and it is still there
    assert!((force[most] / 0.5 - 1.0).abs() < 0.1, "{}", force[most]);
    // a force downward at +x turns about +y
    assert!(
        about_y[most] - about_y[0] > 1e-3,
        "{} {}",
        about_y[0],
        about_y[most]
    );
}

/// As one of flat faces; what sets it down lets it go along z.
#[test]
fn a_sleeper_of_spheres_that_is_not_to_tilt_cannot_turn_at_all() {
    use DegreeOfFreedom as D;
    let mut bed = small_box();
    bed["kind"] = json!("ballast_railbed");
    bed["spec"]["apparatus"] = json!({"sleeper_member_radius_m": 0.05});
    for job in [small_box(), bed] {
        let scene = match submission(&job).expect("a valid job") {
            JobSpec::BallastBox(spec) => spec.script().scene,
            JobSpec::BallastRailbed(spec) => spec.script().scene,
            other => panic!("another kind: {:?}", other.kind()),
        };
        for held in [D::X, D::Y, D::Z, D::Rx, D::Ry, D::Rz] {
            assert!(scene.bodies[0].fixed.contains(&held), "{held:?}");
        }
    }
}

#[test]
fn a_mat_is_the_stiffness_of_the_base_and_softened_with_the_rest() {
    let mut job = small_box();
    job["spec"]["materials"]["mat"] = json!({"contact_stiffness_n_per_m": 2.54e6});
    job["spec"]["accuracy"] = json!({"stiffness": 0.5, "preparation_modulus_pa": 1e6});
    let JobSpec::BallastBox(spec) = submission(&job).expect("a valid job") else {
        panic!("another kind");
    };
    let scene = spec.script().scene;
    let given = |name: &str| {
        let plane = scene.planes.iter().find(|plane| plane.name == name);
        plane.and_then(|plane| plane.contact_stiffness_n_per_m)
    };
    // half of it during the test, a tenth of the aggregate's modulus while it is prepared
    let softened = given("base").expect("a stiffness");
    assert!((softened / 2.54e5 - 1.0).abs() < 1e-12, "{softened}");
    assert_eq!(given("left"), None);
    // friction of rubber, unless given
    let rubber = &scene.materials["rubber"];
    assert_eq!(rubber.friction_angle_rad, Some(0.7));
    assert_eq!(rubber.stiffness_ratio.to_bits(), 0.5_f64.to_bits());
    // what a server writes down can be posted again
    let written = serde_json::to_value(&spec).expect("JSON");
    assert!(written["materials"].get("rubber").is_none(), "{written}");
    let again = json!({"kind": "ballast_box", "spec": written});
    assert_eq!(
        submission(&again).expect("valid"),
        JobSpec::BallastBox(spec)
    );
}

#[test]
fn what_sleepers_and_mats_cannot_do_is_refused_by_field() {
    let mut job = small_box();
    job["spec"]["materials"]["mat"] = json!({"contact_stiffness_n_per_m": 1e6});
    job["spec"]["materials"]["rubber"] = job["spec"]["materials"]["aggregate"].clone();
    let pointer = "/spec/materials/mat/contact_stiffness_n_per_m";
    assert_eq!(refused(&job), one(pointer, "not_both"));
    let mut job = small_oedometer();
    job["spec"]["materials"]["mat"] = json!({"contact_stiffness_n_per_m": 1e6});
    assert_eq!(refused(&job), one(pointer, "not_together"));
    let mut job = small_box();
    job["spec"]["materials"]["mat"] = json!({"contact_stiffness_n_per_m": 1e6});
    job["spec"]["laws"] = json!({"contact": "hertz_mindlin"});
    job["spec"]["accuracy"] = json!("reference");
    assert_eq!(refused(&job), one(pointer, "not_together"));

    let mut job = small_box();
    let sleeper = &mut job["spec"]["apparatus"]["sleeper"];
    sleeper["tilts"] = json!(true);
    sleeper
        .as_object_mut()
        .expect("a part")
        .remove("member_radius_m");
    let pointer = "/spec/apparatus/sleeper/tilts";
    assert_eq!(refused(&job), one(pointer, "not_together"));
    let mut job = small_box();
    job["spec"]["apparatus"]["sleeper"]["rail_m"] = json!([0.01, 0]);
    let pointer = "/spec/apparatus/sleeper/rail_m";
    assert_eq!(refused(&job), one(pointer, "not_together"));
    job["spec"]["apparatus"]["sleeper"]["tilts"] = json!(true);
    job["spec"]["apparatus"]["sleeper"]["rail_m"] = json!([0.2, 0]);
    assert_eq!(refused(&job), one(pointer, "too_large"));
}

#[test]
fn voids_below_a_sleeper_are_mapped_cell_by_cell() {
    let mut job = small_box();
    job["spec"]["output"] = json!({"rows_per_cycle": 50, "slices": 2, "void_cell_m": 0.09});
    let (_, record) = run(&job);
    // 0.2 x 0.2 x 0.2 m in cells of about 0.1 m
    let rows = record.table("void_map.csv");
    assert_eq!(rows.len(), 2 * 2 * 2);
    assert!(record.files.contains_key("void_map.vtp"));
    assert!(!record.files.contains_key("voids.csv"));
    // the cells of a layer together are the slice of the profile
    let profile = record.table("porosity_profile.csv");
    for (layer, slice) in profile.iter().enumerate() {
        let cells = &rows[4 * layer..4 * (layer + 1)];
        assert!(
            cells
                .iter()
                .all(|cell| slice[0] < cell[2] && cell[2] < slice[1])
        );
        for (column, of_slice) in [(3, slice[2]), (4, slice[4])] {
            let mean = cells.iter().map(|cell| cell[column]).sum::<f64>() / 4.0;
            assert!((mean - of_slice).abs() < 1e-9, "{layer}: {mean} {of_slice}");
        }
        for cell in cells {
            assert!((cell[5] - (cell[4] - cell[3])).abs() < 1e-15, "{cell:?}");
        }
    }
    let mut job = small_oedometer();
    job["spec"]["output"]["void_cell_m"] = json!(0.1);
    assert_eq!(
        refused(&job),
        one("/spec/output/void_cell_m", "not_together")
    );
    let mut job = small_box();
    job["spec"]["output"]["void_cell_m"] = json!(0.001);
    assert_eq!(refused(&job), one("/spec/output/void_cell_m", "too_large"));
}
