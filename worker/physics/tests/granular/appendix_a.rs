//! Appendix A of the thesis: two spheres of unlike materials, to all printed digits.
//!
//! The thesis counts the state before a step and the contact within it as one; here a row holds
//! the state after its step, so that its "step 82869" is body row 82868 and contact row 82869. Its
//! normal points from the falling sphere, ours from body 0. Two of its numbers are its author's
//! hand values; for these two, what Yade 2023.02a gives. A third, the last x, has lost a zero in
//! print: 0.01 m + Δt v is 0.0100000000122 m.
use serde_json::{Value, json};

use super::{assert_close, body, contact, run, scene::Record};

/// The contact begins in this step.
const FIRST: u64 = 82_869;

fn appendix() -> Value {
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {
            "zero": {"density_kg_per_m3": 1380, "youngs_modulus_pa": 2.5e9, "stiffness_ratio": 0.4, "friction_angle_rad": 1.0},
            "one": {"density_kg_per_m3": 7850, "youngs_modulus_pa": 2.1e8, "stiffness_ratio": 0.3, "friction_angle_rad": 1.0}},
        "bodies": [
            {"sphere": {"radius_m": 0.05}, "material": "zero", "position_m": [0, 0, 0], "fixed": ["x", "y", "z", "rx", "ry", "rz"]},
            {"sphere": {"radius_m": 0.03}, "material": "one", "position_m": [0.01, 0.01, 0.2]}],
        "laws": {"contact": "linear", "local_damping": 0.1, "convention": "yade"},
        "time_step_s": 2e-6,
        "stages": [{"run": {"steps": FIRST + 2}}],
        "record": {"every_steps": 1, "contacts": true}
    })
}

/// Half of the last printed digit of `printed`, or the round-off of a sum of 1e5 steps.
#[track_caller]
fn assert_printed(found: f64, printed: &str) {
    let value: f64 = printed.parse().expect("a number");
    let (digits, exponent) = printed.split_once('e').unwrap_or((printed, "0"));
    let decimals = digits
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let exponent: i32 = exponent.parse().expect("a whole number");
    let last_digit = 10_f64.powi(exponent - decimals as i32);
    // printed digits are cut or rounded
    assert_close(found, value, last_digit.max(1e-12 * value.abs()));
}

#[track_caller]
fn assert_vector(found: [f64; 3], printed: [&str; 3], sign: f64) {
    for (found, printed) in found.into_iter().zip(printed) {
        assert_printed(sign * found, printed);
    }
}

fn record() -> (loadframe_api::Report, Record) {
    run(&appendix())
}

#[test]
fn two_spheres_of_the_appendix_to_all_printed_digits() {
    let (report, record) = record();
    // masses and inertia
    assert_printed(report.bodies[0].mass_kg, "0.722566310326");
    assert_printed(report.bodies[1].mass_kg, "0.887814083904");
    assert_printed(report.bodies[0].inertia_kg_m2[0][0], "7.22566310326e-4");
    assert_printed(report.bodies[1].inertia_kg_m2[1][1], "3.19613070206e-4");
    // free fall
    let [position, velocity, _] = body(&record, 1, 1);
    assert_printed(velocity[2], "-1.7658e-5");
    assert_printed(position[2], "0.199999999965");
    let [position, velocity, _] = body(&record, 2, 1);
    assert_printed(velocity[2], "-3.5316e-5");
    assert_printed(position[2], "0.19999999989");
    // before the first contact
    assert_eq!(contact(&record, FIRST - 1, [0, 1]), None);
    let [position, velocity, spin] = body(&record, FIRST - 1, 1);
    assert_printed(velocity[2], "-1.4632831440");
    assert_printed(position[2], "0.0787391891400");
    assert!(spin.iter().all(|spin| *spin == 0.0), "nothing turned it");
    // first contact
    let (overlap, [normal, normal_force, shear_force]) =
        contact(&record, FIRST, [0, 1]).expect("the spheres touch");
    // cancellation leaves 1e-16 of a distance of 0.08 m
    assert_close(overlap, 8.755_896_644_26e-7, 1e-16);
    assert_vector(
        normal,
        ["-0.125001368124", "-0.125001368124", "-0.984250636746"],
        -1.0,
    );
    let stiffness = normal_force[2] / (overlap * normal[2]);
    assert_printed(stiffness, "11995430.3123");
    for (found, printed) in
        normal_force
            .into_iter()
            .zip([-1.312_898_719_73, -1.312_898_719_73, -10.337_658_061_4])
    {
        assert_close(-found, printed, 2e-9);
    }
    assert_vector(
        shear_force,
        ["1.31148015421", "1.31148015421", "-0.333120055853"],
        -1.0,
    );
    let shear_stiffness = shear_force[0] / -3.600_672_232_9e-7;
    assert_close(shear_stiffness, 3_642_320.292_93, 1e-3);
    let [position, velocity, spin] = body(&record, FIRST, 1);
    assert_vector(
        velocity,
        ["2.8760727941e-9", "2.8760727941e-9", "-1.46327828385"],
        1.0,
    );
    assert_vector(position, ["0.01", "0.01", "0.07873626258340"], 1.0);
    assert_vector(spin, ["-2.25122503494e-4", "2.25122503494e-4", "0"], 1.0);
    // the step after
    let (overlap, [normal, normal_force, shear_force]) =
        contact(&record, FIRST + 1, [0, 1]).expect("the spheres touch");
    assert_close(overlap, 3.756_053_155_31e-6, 1e-16);
    assert_vector(
        normal,
        ["-0.125005869109", "-0.125005869109", "-0.98424949346"],
        -1.0,
    );
    for (found, printed) in
        normal_force
            .into_iter()
            .zip([-5.632_198_669_68, -5.632_198_669_68, -44.345_827_337_7])
    {
        assert_close(-found, printed, 2e-9);
    }
    assert_vector(
        shear_force,
        ["2.6229989503", "2.6229989503", "-0.666274690781"],
        -1.0,
    );
    let [position, velocity, _] = body(&record, FIRST + 1, 1);
    assert_printed(velocity[0], "6.10388257076e-6");
    assert_printed(velocity[1], "6.10388257076e-6");
    assert_printed(velocity[2], "-1.46318832602835");
    assert_vector(
        position,
        ["0.0100000000122", "0.0100000000122", "0.0787333362068"],
        1.0,
    );
}
