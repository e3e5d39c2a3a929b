//! Beds that are loaded by a machine, by histories of blocks, in a square box, and made from a grid.
use serde_json::{Value, json};

use super::{run, small_oedometer, value};

/// A machine presses at its speed until the force is met and lifts until it is left; then a force swings.
#[test]
fn a_history_of_blocks_is_driven_by_a_machine_and_by_forces() {
    let mut job = small_oedometer();
    job["spec"]["test"] = json!({"smallest_force_n": 200, "peak_force_n": 5e3, "cycles": 2,
        "velocity_m_per_s": 0.02, "then": [{"peak_force_n": 20e3, "smallest_force_n": 400,
        "frequency_hz": 20, "cycles": 3}, {"cycles": 1}]});
    let (report, record) = run(&job);
    let [time, way, force, cycle, unloading] = [
        "time_s",
        "displacement_mm",
        "force_kn",
        "cycle",
        "unloading",
    ]
    .map(|name| record.column(name));
    assert_eq!(cycle.last(), Some(&6.0));
    // 20 mm/s down and up, whatever the bed does, once the plate has taken its seat
    let speed = |row: usize| (way[row + 1] - way[row]) / (time[row + 1] - time[row]);
    let machine = |row: &usize| cycle[*row] < 3.0 && cycle[*row + 1] < 3.0;
    let is_seated = |row: &usize| (speed(*row) - 20.0).abs() < 1e-6;
    let first = (0..force.len() - 1).find(is_seated).expect("it moves");
    assert!(force[first] < 1.0, "{}", force[first]);
    for row in (first..force.len() - 1).filter(machine) {
        let speed = speed(row);
        let is_turn = unloading[row].to_bits() != unloading[row + 1].to_bits();
        let expected = if unloading[row + 1] > 0.0 {
            -20.0
        } else {
            20.0
        };
        assert!(
            is_turn || (speed - expected).abs() < 1e-6,
            "{row}: {speed} {expected}"
        );
    }
    let blocks = record.table("blocks.csv");
    let spans: Vec<[f64; 2]> = blocks.iter().map(|row| [row[1], row[2]]).collect();
    assert_eq!(spans, [[1.0, 2.0], [3.0, 5.0], [6.0, 6.0]]);
    // the first swing of the force presses the bed by a millimetre in 25 ms: the plate's inertia adds to it
    for (block, peak, tolerance) in [(0, 5.0, 0.05), (1, 20.0, 0.1), (2, 20.0, 0.05)] {
        assert!(
            (blocks[block][7] / peak - 1.0).abs() < tolerance,
            "{blocks:?}"
        );
        let told = value(&report, &format!("settlement_after_block_{}", block + 1));
        assert!((told - blocks[block][5]).abs() < 1e-12, "{told} {blocks:?}");
    }
    assert!(blocks[1][6] > blocks[2][6].abs(), "{blocks:?}");
    // the unloading branch ends where the machine is told to turn
    let ends = (0..force.len() - 1).filter(|row| cycle[*row] < 2.0 && cycle[row + 1] > 1.0);
    for row in ends {
        assert!((force[row] - 0.2).abs() < 0.15, "{}", force[row]);
    }
    assert!(
        !report
            .warnings
            .iter()
            .any(|warning| warning.code == "load_not_reached"),
        "{:?}",
        report.warnings
    );
}

#[test]
fn a_machine_that_turns_too_early_says_so() {
    let mut job = small_oedometer();
    job["spec"]["test"] = json!({"smallest_force_n": 200, "peak_force_n": 20e3,
        "velocity_m_per_s": 0.02, "largest_displacement_m": 1e-4});
    let (report, _) = run(&job);
    let warned = |code: &str| report.warnings.iter().any(|warning| warning.code == code);
    assert!(warned("load_not_reached"), "{:?}", report.warnings);
}

/// Base and walls carry the load and the weight of the bed, in a cylinder and in a square.
#[test]
fn base_and_sides_carry_the_load_and_the_bed() {
    for section in ["circle", "square"] {
        let mut job = small_oedometer();
        job["spec"]["apparatus"]["section"] = json!(section);
        job["spec"]["materials"]["steel"] = json!({"density_kg_per_m3": 7850,
            "youngs_modulus_pa": 1e10, "stiffness_ratio": 0.25, "friction_angle_rad": 0.3});
        job["spec"]["test"]["cycles"] = json!(1);
        let (report, record) = run(&job);
        let weight = 9.81e-3 * value(&report, "total_mass");
        let [force, base, vertical, normal, lateral] = [
            "force_kn",
            "base_force_kn",
            "side_vertical_force_kn",
            "side_normal_force_kn",
            "bed_stress_xx_kpa",
        ]
        .map(|name| record.column(name));
        let across = record.column("bed_stress_yy_kpa");
        for row in (0..force.len()).filter(|row| force[*row] > 10.0) {
            let carried = base[row] + vertical[row];
            assert!(
                (carried - force[row] - weight).abs() < 0.02 * force[row],
                "{section}: {carried} {} {weight}",
                force[row]
            );
            // Coulomb on the steel
            assert!(
                vertical[row] < normal[row] * 0.3_f64.tan(),
                "{section} {row}"
            );
            // what presses the sides apart is the stress in the bed, 0.1 m high, in 0.2 m of width
            let around = if section == "circle" {
                std::f64::consts::PI
            } else {
                4.0
            };
            let pressure = normal[row] / (around * 0.2 * 0.1);
            // of some fifty grains the two ways differ by a third
            let stress = 0.5 * (lateral[row] + across[row]);
            assert!(
                (pressure / stress - 1.0).abs() < 0.35,
                "{section}: {pressure} {stress}"
            );
        }
        let [from_load, from_set_down] = ["peak_displacement", "peak_displacement_from_set_down"]
            .map(|name| value(&report, name));
        assert!(from_set_down > from_load, "{from_set_down} {from_load}");
    }
}

#[test]
fn grains_fall_from_a_grid_and_are_shaken_upright() {
    let mut job = small_oedometer();
    let member = |x: f64| json!({"offset_m": [x, 0, 0], "radius_m": 0.012});
    job["spec"]["grains"] = json!({"shape": {"clump": {"members": [member(-0.006), member(0.006)]}},
        "arrangement": "grid", "turned": false});
    job["spec"]["preparation"]["compaction"]["axes"] = json!(["z"]);
    job["spec"]["test"]["cycles"] = json!(1);
    let (report, record) = run(&job);
    let scene: Value = serde_json::from_slice(&record.files["scene.json"]).expect("JSON");
    let made = &scene["spec"]["generate"][0];
    assert_eq!(made["arrangement"], json!("grid"));
    assert_eq!(made["turned"], json!(false));
    // the cylinder is filled; grains that fall straight onto each other stand in columns, and are fewer
    let height = value(&report, "initial_height");
    assert!((height / 100.0 - 1.0).abs() < 0.1, "{height}");
    let porosity = value(&report, "initial_porosity");
    assert!((0.5..0.7).contains(&porosity), "{porosity}");
    let force = record.column("force_kn");
    let largest = force.iter().copied().fold(0.0, f64::max);
    assert!((largest / 20.0 - 1.0).abs() < 0.01, "{largest}");
}
