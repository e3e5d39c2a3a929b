//! Maps of what is solid.
use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{assert_close, codes, one, run, sphere};

/// A box around the origin in eight cells, and what is in it at the start and after a cut.
fn scene(bodies: &Value) -> Value {
    json!({
        "version": 1,
        "gravity_m_per_s2": [0, 0, 0],
        "materials": {
            "stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "friction_angle_rad": 0},
            "steel": {"density_kg_per_m3": 7850, "youngs_modulus_pa": 1e8, "friction_angle_rad": 0}
        },
        "bodies": bodies,
        "time_step_s": 1e-6,
        "stages": [{"run": {"steps": 1}}, {"cut": {"axis": "x", "above_m": 0.05}}, {"run": {"steps": 1}}],
        "record": {"voids": {"low_m": [-0.1, -0.1, -0.1], "high_m": [0.1, 0.1, 0.1], "cells": [2, 2, 2],
            "material": "stone", "at_ends_of": [0, 2]}}
    })
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

#[test]
fn each_cell_has_its_part_of_a_ball_in_the_middle() {
    let bodies = json!([
        sphere("stone", 0.04, [0.0; 3], [0.0; 3]),
        sphere("stone", 0.02, [0.06, 0.05, 0.05], [0.0; 3]),
        // not of the bed, and outside
        sphere("steel", 0.02, [-0.05, -0.05, -0.05], [0.0; 3]),
        sphere("stone", 0.02, [0.5, 0.0, 0.0], [0.0; 3])
    ]);
    let (_, record) = run(&scene(&bodies));
    let rows = record.table("voids.csv");
    assert_eq!(rows.len(), 16);
    let cell = 0.1_f64.powi(3);
    for (number, row) in rows.iter().enumerate() {
        let stage = if number < 8 { 1.0 } else { 3.0 };
        assert_close(row[0], stage, 0.0);
        for axis in 0..3 {
            let side = if number >> axis & 1 == 0 { -0.05 } else { 0.05 };
            assert_close(row[1 + axis], side, 1e-15);
        }
        // the small ball is in the last cell until it is cut away
        let mut solid = ball(0.04) / 8.0;
        if number == 7 {
            solid += ball(0.02);
        }
        assert_close(row[4], 1.0 - solid / cell, 1e-12);
    }
}

#[test]
fn a_clump_counts_what_its_members_share_once() {
    // two balls whose centres are a radius apart: 27/32 of two
    let member = |x: f64| json!({"offset_m": [x, 0, 0], "radius_m": 0.02});
    let bodies = json!([{"clump": {"members": [member(-0.01), member(0.01)]}, "material": "stone",
        "position_m": [0, 0, 0]}]);
    let (_, record) = run(&scene(&bodies));
    let rows = record.table("voids.csv");
    let solid: f64 = rows[..8].iter().map(|row| (1.0 - row[4]) * 1e-3).sum();
    assert_close(solid / (27.0 / 16.0 * ball(0.02)), 1.0, 1e-9);
}

#[test]
fn maps_of_nothing_and_of_too_much_are_refused() {
    let bodies = json!([sphere("stone", 0.04, [0.0; 3], [0.0; 3])]);
    for (field, value, pointer, code) in [
        ("high_m", json!([0.1, -0.2, 0.1]), "high_m", "empty"),
        ("cells", json!([100, 100, 100]), "cells", "too_large"),
        ("cells", json!([0, 1, 1]), "cells/0", "out_of_range"),
        ("material", json!("sand"), "material", "no_such_material"),
        ("at_ends_of", json!([0, 3]), "at_ends_of/1", "no_such_stage"),
    ] {
        let mut spec = scene(&bodies);
        spec["record"]["voids"][field] = value;
        let pointer = format!("/spec/record/voids/{pointer}");
        assert_eq!(codes(&spec), one(&pointer, code));
    }
}
