//! Jobs from their specs: rollers in large displacements, and plies that part.
use loadframe_api::{JobSpec, Report, Submission};
use loadframe_harness::{Uninterrupted, Unrecorded};

use serde_json::json;
use std::io;

use super::*;

fn spec(body: &str) -> CompositeBending {
    match Submission::from_slice(body.as_bytes()).map(|submission| submission.spec) {
        Ok(JobSpec::CompositeBending(spec)) => *spec,
        other => panic!("{other:?}"),
    }
}

fn context<'a>() -> RunContext<'a> {
    RunContext {
        threads: 1,
        interrupt: &Uninterrupted,
        checkpoint: None,
    }
}

fn report(spec: &CompositeBending) -> Report {
    match run(spec, context(), &mut Unrecorded) {
        Ok(Ending::Finished(report)) => report,
        other => panic!("{other:?}"),
    }
}

fn value(report: &Report, name: &str) -> f64 {
    report.summary[name].value.unwrap()
}

/// A strip of 1 mm on supports 60 mm apart, bent by a way of its roller.
fn bent_far(way_mm: f64) -> CompositeBending {
    spec(&format!(
        r#"{{"kind": "composite_bending", "spec": {{"version": 1,
        "section": {{"length_mm": 90, "height_mm": 1, "thickness_mm": 15, "state": "plane_stress"}},
        "materials": {{"strip": {{"isotropic": {{"youngs_modulus_mpa": 3000, "poisson_ratio": 0}}}}}},
        "matrix": "strip", "grid": {{"cells": [120, 2]}},
        "test": {{"three_point": {{"span_mm": 60, "loading_radius_mm": 5, "support_radius_mm": 2,
                                   "displacement_mm": {way_mm}}}}},
        "accuracy": {{"geometry": "large", "load_steps": 4}}}}}}"#
    ))
}

#[test]
fn a_strip_bent_far_bears_what_the_elastica_says_and_the_correction_knows_its_stress() {
    // of the elastica on rollers of 2 mm, see flexure::elastica: slope 0.5 at the supports
    let (force, way, stress) = (6.989, 10.264, elastica_stress());
    let report = report(&bent_far(way));
    let share = value(&report, "max_force") / force;
    assert!((share - 1.0).abs() < 5e-3, "{share}");
    // the standard's correction leaves the radius of the supports out, 6 s R₂/L² = 3.4 %
    let corrected = value(&report, "flexural_stress_large_deflection") / stress;
    assert!((corrected - 1.034).abs() < 0.015, "{corrected}");
    let plain = value(&report, "flexural_stress") / stress;
    assert!((plain - 1.0).abs() > 0.08, "{plain}");
    assert!(!is_unstable(&report));
}

/// Outer stress [MPa] at midspan of the same elastica: M = √(2 EI N sin α), N = F/(2 cos α).
fn elastica_stress() -> f64 {
    let normal = 6.989 / (2.0 * 0.5_f64.cos());
    let moment = (2.0 * 3_000.0 * 15.0 / 12.0 * normal * 0.5_f64.sin()).sqrt();
    6.0 * moment / 15.0
}

/// A column pushed at its free end, or between grips, by its `test`; Euler's load π² EI/(4 L²) of it is 0.1285 N,
/// the strain at which it buckles between grips π² (h/L)²/3 = 0.206 %.
fn column(test: &str, solver: &str) -> CompositeBending {
    spec(&format!(
        r#"{{"kind": "composite_bending", "spec": {{"version": 1,
        "section": {{"length_mm": 40, "height_mm": 1, "thickness_mm": 1, "state": "plane_stress"}},
        "materials": {{"m": {{"isotropic": {{"youngs_modulus_mpa": 1000, "poisson_ratio": 0}}}}}},
        "matrix": "m", "grid": {{"cells": [40, 4]}}, "test": {test},
        "accuracy": {{"geometry": "large", "load_steps": 4, "solver": "{solver}"}}}}}}"#
    ))
}

fn is_unstable(report: &Report) -> bool {
    let is_told = |code: &str| report.warnings.iter().any(|warning| warning.code == code);
    let check = &report.quality["unstable_equilibrium"];
    assert_eq!(is_told("unstable_equilibrium"), !check.ok);
    assert!(!is_told("unknown_discretisation_error"));
    !check.ok
}

#[test]
fn a_straight_path_beyond_buckling_is_told_and_has_no_error() {
    let pushed = |force_n: f64| {
        format!(
            r#"{{"supports": {{"left": "clamped"}}, "load": {{"force_n": [{force_n}, 0], "on": {{"face": "right"}}}}}}"#
        )
    };
    let pressed =
        |strain: f64| format!(r#"{{"tension": {{"strain": {strain}, "grips": "clamped"}}}}"#);
    for (test, solver, expected) in [
        (pushed(-0.12), "static", false),
        (pushed(-0.14), "static", true),
        (pushed(-0.12), "verlet", false),
        (pushed(-0.14), "verlet", true),
        (pressed(-0.0019), "static", false),
        (pressed(-0.0022), "static", true),
    ] {
        let report = report(&column(&test, solver));
        assert_eq!(is_unstable(&report), expected, "{test} {solver}");
        let energy = &report.summary["strain_energy"];
        assert_eq!(energy.error.is_none(), expected, "{test} {solver}");
        let knows_grid = report
            .quality
            .contains_key("estimated_discretisation_error");
        assert_ne!(knows_grid, expected, "{test} {solver}");
    }
}

#[test]
fn a_strip_pressed_far_between_its_supports_is_held_by_the_rollers() {
    let spec = bent_far(18.0);
    let model = Model::new(&spec, finest(&spec)).unwrap();
    let Ok(tested) = conduct(&model, None, context(), &mut Kept::default()) else {
        panic!("it is bent");
    };
    assert_eq!(tested.unstable, None);
}

/// Keeps what a test tells.
#[derive(Default)]
struct Kept {
    states: Vec<Progress>,
    points: Vec<Vec<f64>>,
}

impl Watch for Kept {
    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        self.points.push(values.to_vec());
        Ok(())
    }

    fn look(&mut self, _fraction: f64, state: &mut dyn FnMut() -> Progress) -> Result<(), Halt> {
        self.states.push(state());
        Ok(())
    }

    fn halt(&mut self, interrupt: Interrupt, _state: &mut dyn FnMut() -> Progress) -> Halt {
        Halt::Interrupted(interrupt)
    }
}

#[test]
fn rollers_go_on_from_every_step_with_the_same_bytes() {
    let spec = bent_far(6.0);
    let finest = Fineness {
        grid: spec.grid(),
        contact_cells: CONTACT_CELLS,
        shrinks_to_corners: false,
    };
    let model = Model::new(&spec, finest).unwrap();
    let conducted = |progress: Option<Progress>| {
        let mut kept = Kept::default();
        match conduct(&model, progress, context(), &mut kept) {
            Ok(tested) => (tested, kept),
            Err(_) => panic!("it is bent"),
        }
    };
    let (whole, kept) = conducted(None);
    // unloaded and four steps; after the last there is nothing to keep
    assert_eq!((kept.points.len(), kept.states.len()), (5, 3));
    for (step, state) in kept.states.into_iter().enumerate() {
        let (tested, rest) = conducted(Some(state));
        assert_eq!(rest.points, kept.points[step + 2..]);
        // but for the work that was done
        assert_eq!(tested.bent, whole.bent);
        assert_eq!(tested.rest.displacements_mm, whole.rest.displacements_mm);
    }
}

#[test]
fn a_short_beam_fails_between_its_plies_at_their_shear_strength() {
    let spec = spec(
        r#"{"kind": "composite_bending", "spec": {"version": 1,
        "section": {"length_mm": 16, "height_mm": 2, "thickness_mm": 10, "state": "plane_stress"},
        "materials": {"ply": {"isotropic": {"youngs_modulus_mpa": 10000, "poisson_ratio": 0.3}}},
        "plies": [{"material": "ply", "thickness_mm": 1}, {"material": "ply", "thickness_mm": 1}],
        "ply_interface": {"normal": {"strength_mpa": 60, "fracture_energy_n_per_mm": 0.5},
                          "shear": {"strength_mpa": 40, "fracture_energy_n_per_mm": 0.5}},
        "grid": {"cells": [64, 8]},
        "test": {"short_beam": {"span_mm": 10, "displacement_mm": 0.2, "support_radius_mm": 2},
                 "breaking": {"stop_force_fraction": 0.7}}}}"#,
    );
    let finest = Fineness {
        grid: spec.grid(),
        contact_cells: CONTACT_CELLS,
        shrinks_to_corners: false,
    };
    let model = Model::new(&spec, finest).unwrap();
    let Ok(tested) = conduct(&model, None, context(), &mut Kept::default()) else {
        panic!("it breaks");
    };
    let measured = results::measure(&model, &tested);
    let of = |name: &str| measured.iter().find(|one| one.name == name).unwrap().value;
    let broken = tested.broken.as_ref().unwrap();
    let first = broken.events[0];
    // τ = 3F/(4bh) of a parabola at mid-height, between support and roller
    assert_eq!(first.part, crate::breaking::BrokenPart::PlyFace(0));
    assert_eq!(first.mode, crate::breaking::Mode::Shear);
    let apparent = 0.75 * of("first_crack_force") / 20.0;
    assert!((apparent / 40.0 - 1.0).abs() < 0.1, "{apparent}");
    assert!(of("interlaminar_shear_strength") >= apparent);
    let between = of("dissipated_between_plies") / of("dissipated_energy");
    assert!((between - 1.0).abs() < 1e-12, "{between}");
}

#[test]
fn an_end_notched_laminate_slides_apart_where_beams_say() {
    // the example on half of its cells
    let body = include_str!("../../../../../api/examples/composite_bending_delaminate.json");
    let mut spec = spec(body);
    if let Some(grid) = &mut spec.grid {
        grid.cells = [110, 4];
    }
    let report = report(&spec);
    // G = 9 P² a² / (16 E b² h³) with the notch of 36 mm inside the span, h = 1.5 mm
    let force =
        (16.0 * 171_420.0 * 25.0_f64.powi(2) * 1.5_f64.powi(3) * 0.7879 / 9.0).sqrt() / 36.0;
    let share = value(&report, "max_force") / force;
    // the zone in which a crack opens in slender arms, √(E h G)/f = 15 mm, is not short beside the notch: the
    // force of a sharp crack is not reached. Measured 0.758 here, 0.76 on twice the cells.
    assert!((0.72..0.8).contains(&share), "{share}");
    assert!(report.quality.contains_key("crack_overlap"));
    assert!(value(&report, "dissipated_between_plies") > 0.0);
}

/// Measured: released 1.029 and taken 1.039 of the fracture energy. The arms are 0.776 times as stiff as their
/// beams, as if longer by 1.76 of their height; [Williams1989]'s 2.0 has their shear in it, which the beams
/// have here.
#[test]
fn a_laminate_peels_apart_at_its_fracture_energy() {
    // the example on two thirds of its cells
    let body = include_str!("../../../../../api/examples/composite_bending_peel.json");
    let mut spec = spec(body);
    if let Some(grid) = &mut spec.grid {
        grid.cells = [120, 4];
    }
    let report = report(&spec);
    let of = |name| value(&report, name);
    // two cantilevers, a³/(3 EI) + a/(kGA) each, without their root, whose rotation makes them softer
    let (e, g, b, h, a) = (171_420.0, 5_290.0, 25.0, 1.5_f64, 30.0_f64);
    let arm = a.powi(3) / (3.0 * e * b * h.powi(3) / 12.0) + a / (5.0 / 6.0 * g * b * h);
    assert!((of("beam_stiffness") * 2.0 * arm - 1.0).abs() < 1e-9);
    let root = of("initial_stiffness") / of("beam_stiffness");
    assert!((0.75..1.0).contains(&root), "{root}");
    let given = 0.2774;
    let (released, taken) = (of("release_rate"), of("energy_per_crack_area"));
    assert!((released / given - 1.0).abs() < 0.15, "{released}");
    assert!((released / taken - 1.0).abs() < 0.05, "{released} {taken}");
    assert!(of("crack_length") > 45.0);
    // all of it in tension, and between the plies
    let between = of("dissipated_between_plies") / of("dissipated_energy");
    assert!((between - 1.0).abs() < 1e-12, "{between}");
}

/// Thin stiff fibres at 45°, 30°, 20° and 75° against quadratic finite elements that follow their faces (limits
/// of three nested meshes of CalculiX 2.20, known to 0.1 %, by `tests/composite/beside_ccx`): deflections of
/// the top and of the bottom [mm], with presets, and with even cells of two and four times their thickness. At
/// 75°, where CalculiX' limit is known to 0.45 % only (0.028 32 mm), what grids of 400 and 800 even cells tend to
/// by the first order, which finds the others to 0.01 %: there the three grids of `standard` agree to a third of
/// the error.
#[test]
fn fibres_at_an_angle_lie_near_finite_elements_and_within_their_errors() {
    let cases = [
        (
            include_str!("../../../../../tests/composite/cases/slanted_45_top.json"),
            [0.032_781_3, 0.005_109_58],
        ),
        (
            include_str!("../../../../../tests/composite/cases/slanted_30_top.json"),
            [0.045_642_2, 0.010_138_6],
        ),
        (
            include_str!("../../../../../tests/composite/cases/slanted_20_top.json"),
            [0.052_138_3, 0.014_446_2],
        ),
        (
            include_str!("../../../../../tests/composite/cases/slanted_75_body.json"),
            [0.028_307_6, 0.028_307_6],
        ),
    ];
    for (case, truth) in cases {
        for grid in [
            json!({"accuracy": "draft"}),
            json!({"accuracy": "standard"}),
            json!({"grid": {"cells": [50, 50]}}),
        ] {
            let mut body: serde_json::Value = serde_json::from_str(case).unwrap();
            let fields = body["spec"].as_object_mut().unwrap();
            fields.remove("grid");
            fields.remove("accuracy");
            fields.extend(grid.as_object().unwrap().clone());
            let report = report(&spec(&body.to_string()));
            for (face, truth) in ["top", "bottom"].into_iter().zip(truth) {
                let found = &report.summary[&format!("mean_{face}_deflection")];
                let off = (found.value.unwrap() - truth).abs();
                let said = found.error.as_ref().unwrap().value;
                let share = off / truth;
                assert!(share < 0.02, "{} {grid} {face}: {share}", body["name"]);
                assert!(
                    off < 2.0 * said,
                    "{} {grid} {face}: {off} {said}",
                    body["name"]
                );
            }
        }
    }
}

/// A clamped block whose top is moved along both axes.
fn moved_top(displacement_mm: &str) -> CompositeBending {
    spec(&format!(
        r#"{{"kind": "composite_bending", "spec": {{"version": 1,
        "section": {{"length_mm": 20, "height_mm": 20, "thickness_mm": 2, "state": "plane_stress"}},
        "materials": {{"m": {{"isotropic": {{"youngs_modulus_mpa": 1000, "poisson_ratio": 0.3}}}}}},
        "matrix": "m", "grid": {{"cells": [8, 8]}},
        "test": {{"supports": {{"bottom": "clamped", "top": {{"displacement_mm": {displacement_mm}}}}}}}}}}}"#
    ))
}

#[test]
fn the_force_on_a_moved_face_is_that_along_its_whole_way() {
    let [slanted, along, across] =
        ["[0.01, -0.01]", "[0.01, 0]", "[0, -0.01]"].map(|way| report(&moved_top(way)));
    // U = F s / 2 of what is proportional (Clapeyron), s the length of the way
    for (report, way_mm) in [
        (&slanted, 0.01 * 2.0_f64.sqrt()),
        (&along, 0.01),
        (&across, 0.01),
    ] {
        let twice_n_mm = 2e3 * value(report, "strain_energy");
        let work_n_mm = value(report, "max_force") * way_mm;
        assert!((twice_n_mm / work_n_mm - 1.0).abs() < 1e-9);
    }
    // x and y do not couple in a block that is the same to left and right
    let sum = value(&along, "max_force") + value(&across, "max_force");
    let share = value(&slanted, "max_force") * 2.0_f64.sqrt() / sum;
    assert!((share - 1.0).abs() < 1e-9, "{share}");
    // the top's deflection is given; what the grid does not know is the force
    let error = slanted.quality["estimated_discretisation_error"].value;
    let force = &slanted.summary["max_force"];
    let stated = force.error.as_ref().unwrap().value / force.value.unwrap();
    assert!(error > 1e-3 && (error - stated).abs() < 1e-12, "{error}");
}

#[test]
fn an_impact_begins_with_the_kinetic_energy_of_its_velocity() {
    let spec = spec(
        r#"{"kind": "composite_bending", "spec": {"version": 1,
        "section": {"length_mm": 20, "height_mm": 20, "thickness_mm": 2, "state": "plane_stress"},
        "materials": {"m": {"isotropic": {"youngs_modulus_mpa": 1000, "poisson_ratio": 0.3},
                            "density_kg_per_m3": 1200}},
        "matrix": "m", "grid": {"cells": [8, 8]},
        "test": {"supports": {"bottom": "clamped"},
                 "history": {"velocity_mm_per_s": [300, -400], "duration_s": 1e-6, "points": 2}},
        "accuracy": {"solver": "verlet"}}}"#,
    );
    let model = Model::new(&spec, finest(&spec)).unwrap();
    let mut kept = Kept::default();
    assert!(conduct(&model, None, context(), &mut kept).is_ok());
    // ½ m v² of 1.2e-9 t/mm³ over 800 mm³, but for half of the lowest row of cells, which is held; 500 mm/s
    let moving_t = 1.2e-9 * 800.0 * (1.0 - 1.0 / 16.0);
    let [time_s, _, _, kinetic, elastic] = kept.points[0][..] else {
        panic!("{:?}", kept.points);
    };
    assert!(time_s.abs() + elastic.abs() < f64::MIN_POSITIVE);
    let given = 0.5 * moving_t * 500.0_f64.powi(2);
    assert!((kinetic / given - 1.0).abs() < 1e-12, "{kinetic} {given}");
}

#[test]
fn a_gap_between_two_short_fibres_is_known_within_the_error() {
    let spec = spec(
        r#"{"kind": "composite_bending", "spec": {"version": 1,
        "section": {"length_mm": 20, "height_mm": 5, "thickness_mm": 1, "state": "plane_stress"},
        "materials": {"m": {"isotropic": {"youngs_modulus_mpa": 3500, "poisson_ratio": 0.35}},
                      "f": {"isotropic": {"youngs_modulus_mpa": 70000, "poisson_ratio": 0.2}}},
        "matrix": "m",
        "fibres": [{"material": "f", "through_mm": [4.95, 2.5], "angle_deg": 0, "thickness_mm": 1, "length_mm": 9.9},
                   {"material": "f", "through_mm": [15.05, 2.5], "angle_deg": 0, "thickness_mm": 1, "length_mm": 9.9}],
        "test": {"tension": {"strain": 0.01}}, "accuracy": "draft"}}"#,
    );
    let report = report(&spec);
    let modulus = &report.summary["effective_modulus"];
    let error = modulus.error.as_ref().unwrap().value;
    // of biquadratic finite elements with lines on the ends, graded to 0.006 mm; 15 046.7 on half of them. One
    // fibre without a gap makes it 16 630
    let of_elements_mpa = 15_046.5;
    let off = modulus.value.unwrap() - of_elements_mpa;
    assert!(
        off.abs() < error && error < 0.05 * of_elements_mpa,
        "{off} {error}"
    );
}

/// Two stiff fibres in a soft matrix, 0.3 mm apart side by side and overlapping by 1 mm, and what is asked of the
/// grid.
fn overlapping(asked: &str) -> CompositeBending {
    spec(&format!(
        r#"{{"kind": "composite_bending", "spec": {{"version": 1,
        "section": {{"length_mm": 20, "height_mm": 5, "thickness_mm": 1, "state": "plane_stress"}},
        "materials": {{"m": {{"isotropic": {{"youngs_modulus_mpa": 300, "poisson_ratio": 0.4}}}},
                      "f": {{"isotropic": {{"youngs_modulus_mpa": 70000, "poisson_ratio": 0.2}}}}}},
        "matrix": "m",
        "fibres": [{{"material": "f", "through_mm": [5.25, 3.05], "angle_deg": 0, "thickness_mm": 0.8, "length_mm": 10.5}},
                   {{"material": "f", "through_mm": [14.75, 1.95], "angle_deg": 0, "thickness_mm": 0.8, "length_mm": 10.5}}],
        "test": {{"tension": {{"strain": 0.01}}}}, {asked}}}}}"#
    ))
}

#[test]
fn matrix_between_faces_of_fibres_that_end_is_known_within_the_error() {
    // of biquadratic finite elements with lines on the faces and ends. One row between the faces on a grid
    // and on half and a quarter of it made it 2 131 ± 11
    let of_elements_mpa = 2_099.66;
    for asked in [
        r#""accuracy": "draft""#,
        r#""grid": {"cells": [100, 17]}"#,
        r#""grid": {"cells": [50, 13], "graded_cells_per_fibre": 1}"#,
    ] {
        let report = report(&overlapping(asked));
        let modulus = &report.summary["effective_modulus"];
        let error = modulus.error.as_ref().unwrap().value;
        let off = modulus.value.unwrap() - of_elements_mpa;
        assert!(
            off.abs() < error && error < 0.05 * of_elements_mpa,
            "{asked}: {off} {error}"
        );
    }
}
