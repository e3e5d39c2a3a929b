//! Chains of spheres whose bonds bend and twist are beams: deflections, turns and breaks of closed forms.
//!
//! A chain of n bonds of length L from a sphere that is held has a hinge of stiffness EI/L and a spring of
//! κEA/L in the middle of each bond. Under a force P across its end that sinks by
//! P Σ ((i − ½)²L³/EI + L/κEA) = P (nL)³/3EI (1 − 1/4n²) + P nL/κEA: Euler's beam but for 1/4n², with the
//! shear of Timoshenko's.
use serde_json::{Value, json};

use super::{body, codes, contact, determinism::assert_resumes, one, run, run_on};

const RADIUS: f64 = 0.01;
const LENGTH: f64 = 0.02;
const MODULUS: f64 = 1e9;
const RATIO: f64 = 0.4;
/// R̄ = r/2.
const BEAM: f64 = 0.005;

/// πR̄², πR̄⁴/4, πR̄⁴/2.
fn section() -> [f64; 3] {
    let square = BEAM * BEAM;
    let pi = std::f64::consts::PI;
    [
        pi * square,
        0.25 * pi * square * square,
        0.5 * pi * square * square,
    ]
}

/// A chain along x of `bonds` bonds, held at its first sphere.
fn chain(bonds: usize, strengths: [f64; 2], stages: &Value) -> Value {
    let spheres: Vec<Value> = (0..=bonds)
        .map(|place| {
            let held = ["x", "y", "z", "rx", "ry", "rz"];
            json!({"sphere": {"radius_m": RADIUS}, "material": "stone",
                "position_m": [LENGTH * place as f64, 0, 0],
                "fixed": if place == 0 { &held[..] } else { &[] }})
        })
        .collect();
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, 0],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8,
            "stiffness_ratio": 0.3, "friction_angle_rad": 0.5,
            "parallel_bond": {"radius_ratio": BEAM / RADIUS, "youngs_modulus_pa": MODULUS,
                "stiffness_ratio": RATIO, "tensile_strength_pa": strengths[0],
                "shear_strength_pa": strengths[1]}}},
        "bodies": spheres,
        "laws": {"local_damping": 0.7},
        "stages": stages,
        "record": {"every_steps": 1000, "contacts": true}
    })
}

fn pulled(bonds: usize, force: [f64; 3], time: f64) -> Value {
    let stages = json!([{"drive": {"bodies": [{"body": bonds, "force": {"force_n": force}}],
        "time_s": time}}]);
    chain(bonds, [1e15; 2], &stages)
}

#[test]
fn a_cantilever_of_bonded_spheres_bends_as_beams_do() {
    let [area, inertia, _] = section();
    for bonds in [1, 5] {
        // a hundred-thousandth of the length: nothing turns far
        let whole = LENGTH * bonds as f64;
        let force = 1e-5 * 3.0 * MODULUS * inertia / whole.powi(2);
        let (report, record) = run(&pulled(bonds, [0.0, -force, 0.0], 0.3));
        let end = record.column(&format!("body_{bonds}_displacement_y_m"));
        let count = bonds as f64;
        let bending = force * whole.powi(3) / (3.0 * MODULUS * inertia);
        let bending = bending * (1.0 - 0.25 / (count * count));
        let expected = -(bending + force * whole / (RATIO * MODULUS * area));
        let found = end.last().expect("rows");
        assert!(
            (found / expected - 1.0).abs() < 1e-4,
            "{bonds}: {found:e} {expected:e}"
        );
        assert_eq!(report.summary["broken_bonds"].value, Some(0.0));
        // the moment at the root is that of the force over the arm to the bond's middle
        let rows = record.table("contacts.csv");
        let last = rows.last().expect("rows")[0];
        let root = rows.iter().find(|row| row[0].to_bits() == last.to_bits());
        let moment = root.expect("a bond")[16];
        // on what hangs at it
        let expected = force * (whole - 0.5 * LENGTH);
        assert!(
            (moment / expected - 1.0).abs() < 1e-3,
            "{moment:e} {expected:e}"
        );
    }
}

#[test]
fn a_chain_that_is_pulled_or_pushed_is_as_stiff_as_its_beams_and_contacts() {
    let [area, _, _] = section();
    for (force, stiffness) in [
        (1.0, MODULUS * area / LENGTH),
        // the contact has E r
        (-1.0, MODULUS * area / LENGTH + 1e8 * RADIUS),
    ] {
        let (_, record) = run(&pulled(4, [force, 0.0, 0.0], 0.1));
        let found = record.column("body_4_displacement_x_m");
        let found = found.last().expect("rows");
        let expected = 4.0 * force / stiffness;
        assert!(
            (found / expected - 1.0).abs() < 1e-5,
            "{found:e} {expected:e}"
        );
    }
}

/// The end turns at a given rate: M_t = κEJ/(nL) times the angle, until τ = M_t R̄/J is the strength.
#[test]
fn a_chain_that_is_twisted_carries_and_breaks_as_shafts_do() {
    let [_, _, polar] = section();
    let (bonds, spin, strength) = (3, 0.006, 1e5);
    let mut spec = chain(bonds, [1e15, strength], &json!([{"run": {"time_s": 1.0}}]));
    let end = &mut spec["bodies"][bonds];
    end["fixed"] = json!(["x", "y", "z", "rx", "ry", "rz"]);
    end["angular_velocity_rad_per_s"] = json!([spin, 0, 0]);
    let (report, record) = run(&spec);
    let stiffness = RATIO * MODULUS * polar / (bonds as f64 * LENGTH);
    // M R̄/J = τ_c
    let most = strength * polar / BEAM;
    let breaks = most / stiffness / spin;
    assert!(0.3 < breaks && breaks < 0.9, "{breaks}");
    let time = record.column("time_s");
    let step = record.column("step");
    let rows = record.table("contacts.csv");
    let (rows, step) = (&rows, &step);
    let of = |row: usize| {
        rows.iter()
            .filter(move |found| found[0].to_bits() == step[row].to_bits())
    };
    // the jump to the given rate leaves a swing of the spheres between: M = ω √(kI) of a bond
    let bond = RATIO * MODULUS * polar / LENGTH;
    let inertia =
        0.4 * (4.0 / 3.0 * std::f64::consts::PI * 2600.0 * RADIUS.powi(3)) * RADIUS.powi(2);
    let swing = spin * (bond * inertia).sqrt();
    assert!(swing < 2e-3 * most, "{swing} {most}");
    let mut seen = 0;
    for row in (0..time.len()).filter(|row| time[*row] > 0.1 * breaks) {
        if time[row] < 0.999 * breaks {
            seen += 1;
            for found in of(row) {
                let expected = stiffness * spin * time[row];
                // on the second of the pair, which turns ahead
                assert!(
                    (found[14].abs() - expected).abs() < swing,
                    "{} {expected}",
                    found[14]
                );
            }
        } else if time[row] > 1.01 * breaks {
            assert!(of(row).any(|found| found[13] < 1.0) || of(row).count() < bonds);
        }
    }
    assert!(seen > 5, "{seen}");
    assert!(report.summary["broken_bonds"].value >= Some(1.0));
}

/// σ = 4 P (nL − L/2)/(πR̄³) at the root: just below its strength it holds, just above it breaks there.
#[test]
fn a_cantilever_breaks_at_its_root_by_the_stress_of_its_fibre() {
    let [_, inertia, _] = section();
    let bonds = 4;
    let arm = LENGTH * (bonds as f64 - 0.5);
    let force = 1e-4 * 3.0 * MODULUS * inertia / (LENGTH * bonds as f64).powi(2);
    let stress = force * arm * BEAM / inertia;
    for (factor, broken) in [(1.01, 0.0), (0.99, 1.0)] {
        // grown slowly: without a swing beyond the end
        let stages = json!([{"drive": {"bodies": [{"body": bonds, "force": {"force_n": [0, 0, 0],
            "peak_force_n": [0, -force, 0], "period_s": 1.0}}], "time_s": 0.5}}]);
        let (report, record) = run(&chain(bonds, [factor * stress, 1e15], &stages));
        assert_eq!(
            report.summary["broken_bonds"].value,
            Some(broken),
            "{factor}"
        );
        if broken > 0.0 {
            let rows = record.table("contacts.csv");
            let last = rows.last().expect("rows")[0] as u64;
            let root = contact(&record, last, [0, 1]);
            let rest = (1..4).all(|place| contact(&record, last, [place, place + 1]).is_some());
            assert!(rest, "only the root breaks");
            let still = root.is_some_and(|(_, [_, force, _])| force[0].abs() > 1e-3);
            assert!(!still, "{root:?}");
        }
    }
}

/// A bonded body that flies and turns keeps its momentum, its angular momentum and, undamped, its energy.
#[test]
fn a_body_of_beams_that_flies_and_turns_makes_nothing_of_nothing() {
    let mut spec = chain(3, [1e15; 2], &json!([{"run": {"time_s": 0.2}}]));
    spec["laws"]["local_damping"] = json!(0.0);
    for place in 0..4 {
        let sphere = &mut spec["bodies"][place];
        sphere["fixed"] = json!([]);
        // turns about z at 3/s, and is thrown
        sphere["velocity_m_per_s"] = json!([0.1, 3.0 * LENGTH * place as f64, 0.3]);
        sphere["angular_velocity_rad_per_s"] = json!([0, 0, 3.0]);
    }
    let (report, record) = run(&spec);
    let created = &report.quality["created_energy_ratio"];
    assert!(created.value < 1e-3, "{created:?}");
    let step = *record.column("step").last().expect("rows") as u64;
    let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3);
    let momenta = |step: u64| {
        let mut sums = [[0.0; 3]; 2];
        for place in 0..4 {
            let [at, velocity, spin] = body(&record, step, place);
            for axis in 0..3 {
                let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
                sums[0][axis] += mass * velocity[axis];
                sums[1][axis] += mass * (at[next] * velocity[last] - at[last] * velocity[next])
                    + 0.4 * mass * RADIUS * RADIUS * spin[axis];
            }
        }
        sums
    };
    let [before, after] = [momenta(0), momenta(step)];
    for axis in 0..3 {
        assert!((after[0][axis] - before[0][axis]).abs() < 1e-12 * mass);
    }
    let about = (before[1][2], after[1][2]);
    assert!((about.1 / about.0 - 1.0).abs() < 1e-3, "{about:?}");
}

#[test]
fn beams_are_the_same_on_any_threads_and_after_a_resume() {
    let [_, inertia, _] = section();
    let force = 1e-3 * MODULUS * inertia / LENGTH.powi(2);
    let mut spec = pulled(6, [0.0, -force, 0.3 * force], 0.05);
    let bond = &mut spec["materials"]["stone"]["parallel_bond"];
    bond["tensile_strength_pa"] = json!(5.0 * force * LENGTH * BEAM / inertia);
    let [one, two] =
        [1, 2].map(|threads| run_on(&spec, threads).1.column("body_6_displacement_y_m"));
    assert_eq!(one, two);
    assert_resumes(&spec, 2);
}

#[test]
fn bonds_that_bend_and_cohesion_are_not_for_one_scene() {
    let mut spec = chain(1, [1.0; 2], &json!([{"run": {"steps": 1}}]));
    spec["materials"]["stone"]["normal_cohesion_pa"] = json!(1e6);
    assert_eq!(codes(&spec), one("/spec/materials/stone", "not_together"));
}
