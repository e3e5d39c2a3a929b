//! Bodies that a scene makes or reads: as many, as large and as heavy as asked, clear of each other.
#![allow(
    clippy::float_cmp,
    reason = "counts, and numbers that are handed through"
)]
use loadframe_api::Report;
use loadframe_physics::SimulationError;
use serde_json::{Value, json};

use super::{failure, run, run_on, submission};

const DENSITY: f64 = 2600.0;

/// A scene in which nothing moves, so that its report shows the bodies as they were made.
fn still(generate: &Value) -> Value {
    json!({
        "version": 1, "seed": 3, "gravity_m_per_s2": [0, 0, 0],
        "materials": {
            "stone": {"density_kg_per_m3": DENSITY, "youngs_modulus_pa": 1e7, "friction_angle_rad": 0.5},
            "chalk": {"density_kg_per_m3": DENSITY, "youngs_modulus_pa": 1e7, "normal_cohesion_pa": 1e5}},
        "generate": generate,
        "stages": [{"run": {"steps": 1}}]
    })
}

fn cuboid(side: f64, height: f64) -> Value {
    json!({"box": {"lower_m": [0, 0, 0], "upper_m": [side, side, height]}})
}

/// Radius [m] of the ball of a body's mass, with its centre.
fn balls(report: &Report) -> Vec<(f64, [f64; 3])> {
    let bodies = report.bodies.iter();
    let radius = |mass: f64| (mass / DENSITY / (4.0 / 3.0 * std::f64::consts::PI)).cbrt();
    bodies
        .map(|body| (radius(body.mass_kg), body.centre_m))
        .collect()
}

fn assert_apart(balls: &[(f64, [f64; 3])]) {
    for (index, (radius, centre)) in balls.iter().enumerate() {
        for (other_radius, other) in &balls[..index] {
            let distance = (0..3)
                .map(|axis| (centre[axis] - other[axis]).powi(2))
                .sum::<f64>()
                .sqrt();
            assert!(
                distance >= (radius + other_radius) * (1.0 - 1e-9),
                "{centre:?} {other:?}"
            );
        }
    }
}

#[test]
fn so_many_spheres_of_such_sizes_lie_apart_in_their_region() {
    let sizes = json!({"uniform": {"smallest_radius_m": 0.006, "largest_radius_m": 0.014}});
    let regions = [
        cuboid(0.3, 0.2),
        json!({"cylinder": {"base_m": [0.1, 0.2, 0.3], "radius_m": 0.15, "height_m": 0.3}}),
        json!({"sphere": {"centre_m": [0.1, 0.2, 0.3], "radius_m": 0.16}}),
    ];
    for region in regions {
        let generate =
            json!([{"material": "stone", "region": region, "sizes": sizes, "count": 500}]);
        let (report, _) = run(&still(&generate));
        let balls = balls(&report);
        assert_eq!(balls.len(), 500);
        assert_apart(&balls);
        for (radius, centre) in &balls {
            assert!((0.006..0.014).contains(radius), "{radius}");
            let inside = match (
                &region["cylinder"]["radius_m"],
                &region["sphere"]["radius_m"],
            ) {
                (Value::Number(_), _) => (centre[0] - 0.1).hypot(centre[1] - 0.2) + radius - 0.15,
                (_, Value::Number(_)) => {
                    let away = (centre[0] - 0.1)
                        .hypot(centre[1] - 0.2)
                        .hypot(centre[2] - 0.3);
                    away + radius - 0.16
                }
                _ => centre.iter().fold(0.0, |out: f64, x| out.max(radius - x)),
            };
            assert!(inside <= 1e-12, "{centre:?}");
        }
    }
}

#[test]
fn a_sieve_curve_is_met_by_mass_whatever_the_shape_of_the_grains() {
    let fraction = |smallest: f64, largest: f64, share: f64| json!({"smallest_diameter_m": smallest, "largest_diameter_m": largest, "mass_share": share});
    let sizes =
        json!({"sieve_curve": [fraction(0.025, 0.0375, 60.0), fraction(0.0375, 0.05, 40.0)]});
    let pair = json!({"members": [{"offset_m": [0, 0, 0], "radius_m": 1}, {"offset_m": [1.2, 0, 0], "radius_m": 0.8}]});
    for (grain, side) in [(json!("sphere"), 0.5), (json!({"clump": pair}), 0.8)] {
        let generate = json!([{"material": "stone", "region": cuboid(side, side), "sizes": sizes,
                               "grain": grain, "mass_kg": 20.0}]);
        let (report, _) = run(&still(&generate));
        let balls = balls(&report);
        let mass = |from: f64, to: f64| {
            let inside = balls
                .iter()
                .filter(|(radius, _)| (from..to).contains(radius));
            inside
                .map(|(radius, _)| DENSITY * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3))
                .sum::<f64>()
        };
        // half a grain of the largest size in each fraction
        let grain = |radius: f64| 0.5 * DENSITY * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let [fine, coarse] = [mass(0.0, 0.01875), mass(0.01875, 1.0)];
        assert!((fine - 12.0).abs() <= grain(0.01875), "{fine}");
        assert!((coarse - 8.0).abs() <= grain(0.025), "{coarse}");
        assert_eq!(
            report.summary["contacts"].value,
            Some(0.0),
            "nothing touches"
        );
    }
}

#[test]
fn the_seed_and_nothing_else_makes_the_grains() {
    let rain = |count: u32, height: f64| {
        json!({"material": "stone", "region": {"box": {"lower_m": [0, 0, height], "upper_m": [0.2, 0.2, height + 0.1]}},
        "sizes": {"uniform": {"smallest_radius_m": 0.006, "largest_radius_m": 0.009}}, "count": count})
    };
    let mut spec = still(&json!([rain(100, 0.0), rain(50, 0.1)]));
    spec["stages"] = json!([{"run": {"steps": 300}}]);
    spec["gravity_m_per_s2"] = json!([0, 0, -9.81]);
    let (report, record) = run(&spec);
    for threads in [2, 3] {
        let (again, other) = run_on(&spec, threads);
        assert_eq!(again, report);
        assert!(other.files == record.files);
    }
    // another generator takes no numbers from the first
    spec["generate"] = json!([rain(100, 0.0)]);
    let (alone, _) = run(&spec);
    let masses = |report: &Report| {
        report.bodies[..100]
            .iter()
            .map(|body| body.mass_kg)
            .collect::<Vec<_>>()
    };
    assert_eq!(masses(&alone), masses(&report));
    spec["seed"] = json!(4);
    let (other, _) = run(&spec);
    assert_ne!(masses(&other), masses(&alone));
}

#[test]
fn a_lattice_is_filled_from_below() {
    let generate = json!([{"material": "stone", "region": cuboid(0.1, 0.1), "sizes": {"radius_m": 0.01},
                           "count": 30, "arrangement": "grid"}]);
    let (report, _) = run(&still(&generate));
    let heights: Vec<f64> = report.bodies.iter().map(|body| body.centre_m[2]).collect();
    // 5 x 5 in the first layer
    assert!(heights[..25].iter().all(|z| (z - 0.01).abs() < 1e-12));
    assert!(heights[25..].iter().all(|z| (z - 0.03).abs() < 1e-12));
}

#[test]
fn a_grading_that_cannot_fit_says_so() {
    let dense = |porosity: f64, arrangement: &str| {
        json!([{"material": "stone", "region": cuboid(0.2, 0.2), "sizes": {"radius_m": 0.01},
                           "porosity": porosity, "arrangement": arrangement}])
    };
    let violations = submission(&still(&dense(0.3, "random"))).expect_err("denser than any heap");
    assert_eq!(violations[0].pointer, "/spec/generate/0/region");
    assert_eq!(violations[0].code, "does_not_fit");
    let SimulationError::Unbuildable(text) = failure(&still(&dense(0.5, "random"))) else {
        panic!("it fits");
    };
    assert!(
        text.starts_with("/generate/0: placed ") && text.contains("use a taller region"),
        "{text}"
    );
    let few = json!([{"material": "stone", "region": cuboid(0.1, 0.1), "sizes": {"radius_m": 0.03}, "count": 2, "arrangement": "grid"}]);
    let SimulationError::Unbuildable(text) = failure(&still(&few)) else {
        panic!("it fits");
    };
    assert!(text.contains("1 free places for 2 grains"), "{text}");
}

#[test]
fn what_cannot_be_made_is_refused_at_the_door() {
    let good = json!({"material": "stone", "region": cuboid(0.2, 0.2), "sizes": {"radius_m": 0.01}, "count": 5});
    let bad = |field: &str, value: Value, pointer: &str, code: &str| {
        let mut generate = good.clone();
        generate[field] = value;
        let violations = submission(&still(&json!([generate]))).expect_err(code);
        let found = violations.iter().any(|violation| {
            violation.pointer == format!("/spec/generate/0{pointer}") && violation.code == code
        });
        assert!(found, "{code}: {violations:#?}");
    };
    bad("material", json!("glass"), "/material", "no_such_material");
    bad("mass_kg", json!(1.0), "", "not_one_amount");
    bad("sizes", Value::Null, "/sizes", "missing_field");
    bad(
        "grain",
        json!({"breakable": {"members": [{"offset_m": [0, 0, 0], "radius_m": 1}]}}),
        "/material",
        "not_cohesive",
    );
    bad(
        "grain",
        json!({"clump": {}}),
        "/grain/clump",
        "not_one_shape",
    );
    bad(
        "region",
        json!({"box": {"lower_m": [0, 0, 0], "upper_m": [1, 0, 1]}}),
        "/region/box/upper_m",
        "empty_region",
    );
    bad(
        "sizes",
        json!({"uniform": {"smallest_radius_m": 2, "largest_radius_m": 1}}),
        "/sizes/uniform/largest_radius_m",
        "out_of_order",
    );
    let mut behind = still(&json!([good]));
    behind["planes"] =
        json!([{"name": "base", "axis": "z", "position_m": 0.1, "facing": 1, "material": "stone"}]);
    let violations = submission(&behind).expect_err("behind a plane");
    assert_eq!(
        (violations[0].pointer.as_str(), violations[0].code.as_str()),
        ("/spec/generate/0/region", "behind_plane")
    );
}

/// Part of a settled bed of the peers, in both of its formats.
const YADE: &str = include_str!("bed.xyzr");
const LAMMPS: &str = include_str!("bed.data");

fn imported(import: &Value) -> Value {
    let mut spec = still(&json!([]));
    spec["import"] = json!([import]);
    spec["record"] = json!({"every_steps": 1});
    spec
}

#[test]
fn beds_of_other_programs_are_read_to_the_last_bit() {
    let (report, record) = run(&imported(
        &json!({"format": "yade", "text": YADE, "material": "stone"}),
    ));
    let lines: Vec<Vec<f64>> = YADE
        .lines()
        .map(|line| {
            line.split(' ')
                .map(|word| word.parse().expect("a number"))
                .collect()
        })
        .collect();
    let rows = record.table("bodies.csv");
    assert_eq!(report.bodies.len(), lines.len());
    for (row, line) in rows.iter().zip(&lines) {
        assert_eq!(row[3..6], line[..3]);
    }
    for (body, line) in report.bodies.iter().zip(&lines) {
        let mass = DENSITY * (4.0 / 3.0 * std::f64::consts::PI * line[3].powi(3));
        assert!((body.mass_kg / mass - 1.0).abs() < 1e-15);
    }
    let (same, other) = run(&imported(
        &json!({"format": "lammps", "text": LAMMPS, "material": "stone"}),
    ));
    assert_eq!(same, report);
    assert!(other.files == record.files);
}

#[test]
fn clumps_of_a_file_become_bodies_and_scales_are_kept() {
    let text = "#format x_y_z_r_clumpId\n0 0 0 1 7\n3 0 5 1 -1\n1.5 0 0 1 7\n";
    let import = json!({"format": "yade", "text": text, "material": "stone", "scale": 0.01, "shift_m": [0, 0, 1]});
    let (report, _) = run(&imported(&import));
    let centres: Vec<[f64; 3]> = report.bodies.iter().map(|body| body.centre_m).collect();
    assert_eq!(centres.len(), 2);
    for (centre, expected) in centres.iter().zip([[0.0075, 0.0, 1.0], [0.03, 0.0, 1.05]]) {
        for axis in 0..3 {
            assert!((centre[axis] - expected[axis]).abs() < 1e-15, "{centre:?}");
        }
    }
    // the same spheres bonded: overlapping ones may rest in their bond
    let mut breakable = import;
    breakable["breakable_clumps"] = json!(true);
    breakable["material"] = json!("chalk");
    let (report, _) = run(&imported(&breakable));
    assert_eq!(report.bodies.len(), 3);
    assert_eq!(report.summary["bonds"].value, Some(1.0));
}

#[test]
fn files_that_cannot_be_are_refused_with_their_line() {
    let refused = |import: Value| submission(&imported(&import)).expect_err("it is wrong");
    let violations =
        refused(json!({"format": "yade", "text": "0 0 0 1\n0 0 x 1", "material": "stone"}));
    assert_eq!(violations[0].pointer, "/spec/import/0/text");
    assert_eq!(
        violations[0].detail,
        "line 2: found \"x\", expected z, a finite number"
    );
    let violations =
        refused(json!({"format": "yade", "text": "0 0 0 1\n0 0 1.8 1", "material": "stone"}));
    assert_eq!(
        (violations[0].pointer.as_str(), violations[0].code.as_str()),
        ("/spec/import", "overlap")
    );
    let light = LAMMPS.replace(" 2600 ", " 2500 ");
    let violations = refused(json!({"format": "lammps", "text": light, "material": "stone"}));
    assert!(
        violations[0].detail.contains("2500 kg/m³"),
        "{violations:?}"
    );
}
