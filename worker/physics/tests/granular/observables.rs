//! What is measured in regions, and what is said about the run, against closed forms.
use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    assert_close,
    determinism::{draw_together, rain},
    run,
    scene::Record,
    submission,
};

const RADIUS: f64 = 0.01;
const SIDE: usize = 4;

/// A cubic packing of spheres that overlap by `overlap`, in a box of its size.
fn packing(overlap: f64) -> Value {
    let spacing = 2.0 * RADIUS - overlap;
    let first = RADIUS - overlap / 2.0;
    let bodies: Vec<Value> = (0..SIDE * SIDE * SIDE)
        .map(|number| {
            let place = [number % SIDE, number / SIDE % SIDE, number / SIDE / SIDE];
            json!({"sphere": {"radius_m": RADIUS}, "material": "stone",
                   "position_m": place.map(|place| first + spacing * place as f64)})
        })
        .collect();
    let width = spacing * SIDE as f64;
    let plane = |name: &str, axis: &str, at: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": at, "facing": facing, "material": "stone"});
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.4}},
        "bodies": bodies,
        "planes": [plane("base", "z", 0.0, 1), plane("lid", "z", width, -1), plane("left", "x", 0.0, 1),
                   plane("right", "x", width, -1), plane("front", "y", 0.0, 1), plane("back", "y", width, -1)],
        "laws": {"local_damping": 0.5},
        "time_step_s": "auto",
        "stages": [{"run": {"steps": 1}}],
        "record": {"every_steps": 1, "planes": ["lid", "right"],
                   "regions": [{"name": "all"},
                               {"name": "part", "low_m": [0.013, 0.02, 0.005], "high_m": [0.049, 0.055, 0.06]}]}
    })
}

fn last(record: &Record, column: &str) -> f64 {
    *record.column(column).last().expect("rows")
}

/// The stress between spheres is the force on the walls over their area, in a part of the packing as
/// in all of it.
#[test]
fn love_weber_stress_is_the_pressure_on_the_walls() {
    let overlap = 1e-5;
    let mut spec = packing(overlap);
    // without friction every column of spheres carries the same; a region of two by two columns
    spec["materials"]["stone"]["friction_angle_rad"] = json!(0);
    let cell = 2.0 * RADIUS - overlap;
    spec["record"]["regions"][1] = json!({"name": "part", "low_m": [cell, cell, 0.005],
        "high_m": [3.0 * cell, 3.0 * cell, 0.005 + 2.0 * cell]});
    spec["stages"] =
        json!([{"load_plane": {"name": "lid", "mass_kg": 0.1, "force_n": -30, "time_s": 0.2}}]);
    spec["record"]["every_steps"] = json!(100_000);
    let (report, record) = run(&spec);
    let width = cell * SIDE as f64;
    let height = width + last(&record, "lid_displacement_m");
    let vertical = last(&record, "lid_force_n") / (width * width);
    let across = last(&record, "right_force_n") / (width * height);
    assert_close(vertical, 30.0 / (width * width), 1e-3 * vertical);
    for region in ["all", "part"] {
        // at rest to a thousandth
        let stress = |name: &str| last(&record, &format!("{region}_stress_{name}_pa"));
        assert_close(stress("zz"), vertical, 2e-3 * vertical);
        assert_close(stress("xx"), across, 2e-3 * vertical);
        assert_close(stress("yy"), across, 2e-3 * vertical);
        assert_close(stress("xy"), 0.0, 1e-3 * vertical);
        assert_close(stress("xz"), 0.0, 1e-3 * vertical);
        let mean = (stress("xx") + stress("yy") + stress("zz")) / 3.0;
        assert_close(
            last(&record, &format!("{region}_mean_stress_pa")),
            mean,
            1e-9 * mean,
        );
    }
    assert!(
        report.quality.contains_key("inertial_number"),
        "{:?}",
        report.quality
    );
}

#[test]
fn porosity_of_a_cubic_packing_is_that_of_its_cell() {
    let (_, record) = run(&packing(0.0));
    let cell = 1.0 - PI / 6.0;
    // spheres that touch the faces are sliced when rounding puts them across
    let sliced = 1e-6;
    assert_close(last(&record, "all_porosity"), cell, sliced);
    let mut spec = packing(0.0);
    // whole cells, and half ones: faces through the middle of spheres, edges through their centres
    spec["record"]["regions"] = json!([{"name": "cell", "low_m": [0.02, 0.02, 0.02], "high_m": [0.06, 0.06, 0.06]},
        {"name": "half", "low_m": [0.01, 0.01, 0.01], "high_m": [0.03, 0.03, 0.03]}]);
    let (_, record) = run(&spec);
    assert_close(last(&record, "cell_porosity"), cell, sliced);
    assert_close(last(&record, "half_porosity"), cell, 1e-5);
}

/// A region of one material knows the spheres of the other as walls, whichever are the first.
#[test]
fn a_material_is_measured_by_itself() {
    let overlap = 1e-5;
    let mut spec = packing(overlap);
    spec["materials"]["stone"]["friction_angle_rad"] = json!(0);
    spec["materials"]["chalk"] = spec["materials"]["stone"].clone();
    let bodies = spec["bodies"].as_array_mut().expect("bodies");
    let lower = bodies.len() / 2;
    for body in &mut bodies[lower..] {
        body["material"] = json!("chalk");
    }
    let width = (2.0 * RADIUS - overlap) * SIDE as f64;
    let region = |name: &str, material: Value, bottom: f64, top: f64| json!({"name": name, "material": material, "low_m": [0, 0, bottom * width], "high_m": [width, width, top * width]});
    spec["record"]["regions"] = json!([
        region("below", json!("stone"), 0.0, 0.5),
        region("above", json!("chalk"), 0.5, 1.0),
        region("lower_half", Value::Null, 0.0, 0.5),
        region("upper_half", Value::Null, 0.5, 1.0),
        region("both", json!("stone"), 0.0, 1.0)
    ]);
    let (_, record) = run(&spec);
    for (region, whole) in [("below", "lower_half"), ("above", "upper_half")] {
        // branches end where the two touch, in the plane that the boxes share
        for column in ["stress_zz_pa", "stress_xx_pa", "stress_xz_pa"] {
            let [own, all] = [region, whole].map(|name| last(&record, &format!("{name}_{column}")));
            assert_close(own, all, 1e-9 * last(&record, "lower_half_stress_zz_pa"));
        }
        let porosity = last(&record, &format!("{region}_porosity"));
        assert_close(porosity, 1.0 - PI / 6.0, 2e-3);
    }
    // stone is half of what there is
    assert_close(last(&record, "both_porosity"), 1.0 - PI / 12.0, 1e-3);
    spec["record"]["regions"][0]["material"] = json!("sand");
    let refused = submission(&spec).expect_err("no such material");
    assert_eq!(refused[0].pointer, "/spec/record/regions/0/material");
}

/// Overlapping members of a clump count once.
#[test]
fn a_clumps_union_fills_a_region_once() {
    let spec = json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e7}},
        "bodies": [{"clump": {"members": [{"offset_m": [0, 0, 0], "radius_m": RADIUS}, {"offset_m": [RADIUS, 0, 0], "radius_m": RADIUS}]},
                    "material": "stone", "position_m": [0, 0, 0]}],
        "stages": [{"run": {"steps": 1}}],
        "record": {"regions": [{"name": "box", "low_m": [-0.05, -0.05, -0.05], "high_m": [0.05, 0.05, 0.05]}]}
    });
    let (_, record) = run(&spec);
    // two spheres less their lens, π (4r + d)(2r − d)²/12 at distance d = r
    let union = (2.0 * 4.0 / 3.0 - 5.0 / 12.0) * PI * RADIUS.powi(3);
    assert_close(last(&record, "box_porosity"), 1.0 - union / 1e-3, 1e-12);
}

/// Held bodies that move as simple shear: γ̇ is that of the field, I = γ̇ d √(ρ/p).
#[test]
fn the_inertial_number_is_that_of_the_shear_and_the_pressure() {
    let rate = 0.7;
    let mut spec = packing(1e-4);
    for body in spec["bodies"].as_array_mut().expect("bodies") {
        let height = body["position_m"][2].as_f64().expect("a number");
        body["velocity_m_per_s"] = json!([rate * height, 0, 0]);
        body["fixed"] = json!(["x", "y", "z", "rx", "rz"]);
    }
    let (_, record) = run(&spec);
    for region in ["all", "part"] {
        let pressure = last(&record, &format!("{region}_mean_stress_pa"));
        assert!(pressure > 100.0, "{pressure}");
        let expected = rate * 2.0 * RADIUS * (2600.0 / pressure).sqrt();
        let found = last(&record, &format!("{region}_inertial_number"));
        assert_close(found, expected, 1e-6 * expected);
    }
    // six contacts each, at the walls too
    assert_close(last(&record, "all_coordination_number"), 6.0, 1e-12);
}

#[test]
fn fast_driving_is_told_of() {
    let mut spec = packing(1e-5);
    spec["stages"] =
        json!([{"move_plane": {"name": "lid", "velocity_m_per_s": -1, "time_s": 2e-3}}]);
    let (report, _) = run(&spec);
    let check = &report.quality["inertial_number"];
    assert!(!check.ok, "{check:?}");
    let told = |code: &str| report.warnings.iter().any(|warning| warning.code == code);
    assert!(told("inertial_number"), "{:?}", report.warnings);
    // a thousand times slower it is quasi-static
    spec["stages"] =
        json!([{"move_plane": {"name": "lid", "velocity_m_per_s": -1e-4, "time_s": 0.2}}]);
    spec["record"]["every_steps"] = json!(1000);
    let (report, _) = run(&spec);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

/// Of two pairs, one a million times stiffer: the run says which sets the step, and what it costs.
#[test]
fn the_pair_that_sets_the_step_is_named_with_what_softening_saves() {
    let pair = |at: f64, material: &str| {
        [0.0, 2.0 * RADIUS - 1e-9].map(|along| json!({"sphere": {"radius_m": RADIUS}, "material": material, "position_m": [along, at, 0]}))
    };
    let mut bodies: Vec<Value> = Vec::new();
    for row in 0..3 {
        bodies.extend(pair(0.1 * f64::from(row), "rubber"));
    }
    bodies.extend(pair(1.0, "steel"));
    let spec = json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"rubber": {"density_kg_per_m3": 1000, "youngs_modulus_pa": 1e5, "friction_angle_rad": 0},
                      "steel": {"density_kg_per_m3": 1000, "youngs_modulus_pa": 1e11, "friction_angle_rad": 0}},
        "bodies": bodies, "stages": [{"run": {"steps": 100}}]
    });
    let (report, _) = run(&spec);
    let check = &report.quality["step_over_critical"];
    assert_close(check.value, 0.2, 1e-9);
    for words in [
        "set by body 6 and its contact with body 7",
        "1000.0 times",
        "up to 100 %",
    ] {
        assert!(check.description.contains(words), "{}", check.description);
    }
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn regions_without_inside_or_with_a_taken_name_are_refused() {
    let mut spec = packing(0.0);
    spec["record"]["regions"] =
        json!([{"name": "lid"}, {"name": "b", "low_m": [0, 0, 0], "high_m": [1, 0, 1]}]);
    let found = submission(&spec).expect_err("two violations");
    let found: Vec<&str> = found
        .iter()
        .map(|violation| violation.pointer.as_str())
        .collect();
    assert_eq!(
        found,
        [
            "/spec/record/regions/0/name",
            "/spec/record/regions/1/high_m"
        ]
    );
}

/// A state that is recorded before it moves says what the step from there says: what acts on bodies
/// across the borders of patches counts in both. Without friction no force depends on the motion.
#[test]
fn a_still_state_is_as_unbalanced_as_the_step_from_it() {
    let mut spec = rain(17, 0.0, 1, false);
    draw_together(&mut spec, 0.88);
    spec["stages"] = json!([{"run": {"steps": 1}}, {"cut": {"axis": "z", "above_m": 0.3}}, {"run": {"steps": 1}}]);
    spec["record"] = json!({"every_steps": 1});
    let (_, record) = run(&spec);
    let ratios = record.column("unbalanced_force_ratio");
    assert_eq!(record.column("step"), [0.0, 1.0, 1.0, 2.0]);
    assert!(ratios[0] > 0.1, "{ratios:?}");
    assert!(record.column("contacts")[0] > 1000.0);
    for still in [0, 2] {
        assert_close(ratios[still], ratios[still + 1], 1e-12);
    }
}
