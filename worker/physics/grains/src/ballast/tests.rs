//! Readings of made-up curves.
#![allow(clippy::float_cmp, reason = "these numbers are exact")]
use loadframe_api::{
    JobSpec, Submission,
    spec::ballast::{Course, Load, Phase, Script},
};
use loadframe_harness::{Recorder, Unrecorded};

use super::{
    blocks::Block,
    cycles, oedometer,
    place::{Place, place},
    tester::Tester,
};

/// An oedometer test of two cycles of 1 s.
fn script() -> Script {
    let body = r#"{"kind": "ballast_oedometer", "spec": {"version": 1,
        "materials": {"aggregate": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8}},
        "test": {"peak_force_n": 1000, "cycles": 2, "period_s": 1}, "output": {"slices": 1}}}"#;
    match Submission::from_slice(body.as_bytes())
        .expect("a valid job")
        .spec
    {
        JobSpec::BallastOedometer(spec) => spec.script(),
        other => panic!("{other:?}"),
    }
}

/// Columns that a scene would have.
const COLUMNS: [&str; 11] = [
    "time_s",
    "stage",
    "plate_displacement_z_m",
    "plate_force_z_n",
    "coordination_number",
    "unbalanced_force_ratio",
    "step_over_critical",
    "bed_inertial_number",
    "bed_mean_stress_pa",
    "slice_1_porosity",
    "bed_porosity",
];

/// Hears a bed that follows F = 10⁶ u + 100 N going down, and half as stiff again coming up, from
/// where it came to rest at 0.2 m; the second cycle goes the way of the first unloading.
fn heard<'a>(script: &'a Script, recorder: &'a mut Unrecorded) -> Tester<'a> {
    let load = script.phases.iter().position(|phase| *phase == Phase::Load);
    let load = load.expect("it is loaded");
    let mut tester = Tester::new(script, recorder);
    tester.columns(&COLUMNS).expect("it keeps nothing");
    let mut hear = |time: f64, stage: usize, way: f64, force: f64| {
        let displacement = 0.2 - way - script.wall_height;
        let row = [
            time,
            (stage + 1) as f64,
            displacement,
            force,
            4.0,
            0.0,
            0.4,
            0.0,
            0.0,
            0.4,
            0.7,
        ];
        tester.point(&row).expect("it keeps nothing");
    };
    hear(5.0, load - 1, 0.0, 100.0);
    for cycle in [0.0, 1.0] {
        for part in 1..=100 {
            let time = f64::from(part) / 100.0;
            let force = 100.0 + 900.0 * (1.0 - (std::f64::consts::TAU * time).cos()) / 2.0;
            let going_down = cycle == 0.0 && part <= 50;
            let way = if going_down {
                (force - 100.0) / 1e6
            } else {
                9e-4 - (1000.0 - force) / 1.5e6
            };
            hear(5.0 + cycle + time, load, way, force);
        }
    }
    tester
}

#[test]
fn cycles_are_read_from_where_they_begin() {
    let script = script();
    let mut recorder = Unrecorded;
    let tester = heard(&script, &mut recorder);
    let cycles = cycles::of(&tester.heard);
    assert_eq!(cycles.len(), 2);
    let first = &cycles[0];
    assert_eq!(first.start, 0.0);
    assert!((first.peak - 9e-4).abs() < 1e-15, "{first:?}");
    assert!((first.end - 3e-4).abs() < 1e-15, "{first:?}");
    assert!((first.peak_force - 1000.0).abs() < 1e-9, "{first:?}");
    let stiffness = first.unloading_stiffness.expect("there is a branch");
    assert!((stiffness / 1.5e6 - 1.0).abs() < 1e-9, "{stiffness}");
    let stiffness = first.loading_stiffness.expect("there is a branch");
    assert!((stiffness / 1e6 - 1.0).abs() < 1e-9, "{stiffness}");
    // trapezium below the way down less the one below the way up
    let work = 0.5 * 1100.0 * 9e-4 - 0.5 * 1100.0 * 6e-4;
    assert!((first.dissipated - work).abs() < 1e-12, "{first:?}");
    let second = &cycles[1];
    assert!(
        (second.start - 3e-4).abs() < 1e-15 && second.dissipated.abs() < 1e-12,
        "{second:?}"
    );
}

#[test]
fn blocks_are_told_from_their_cycles() {
    let cycle = |block: usize, [start, peak, end]: [f64; 3]| cycles::Cycle {
        block,
        start,
        peak,
        end,
        peak_force: 10.0 * (block + 1) as f64,
        unloading_stiffness: Some(peak),
        ..cycles::Cycle::default()
    };
    let blocks = Block::of(&[
        cycle(0, [0.0, 3.0, 1.0]),
        cycle(0, [1.0, 3.5, 1.5]),
        cycle(1, [1.5, 9.0, 6.0]),
    ]);
    assert_eq!(blocks.len(), 2);
    // cycles 1 and 2: down by 1.5 m, 3.5 m at the deepest
    let row = [1.0, 1.0, 2.0, 0.0, 3500.0, 1500.0, 1500.0, 0.01, 3.0, 3.5];
    assert_eq!(blocks[0].row(1), row);
    let row = [
        2.0, 3.0, 3.0, 1500.0, 9000.0, 6000.0, 4500.0, 0.02, 9.0, 9.0,
    ];
    assert_eq!(blocks[1].row(2), row);
}

/// Columns by name of the curve that a tester writes.
fn curve(tester: &Tester<'_>) -> Vec<Vec<f64>> {
    let (rows, start) = tester.heard.loading();
    rows.map(|row| super::tables::curve_row(&tester.heard, row, start))
        .collect()
}

#[test]
fn cycles_and_their_way_back_are_told_from_where_they_begin() {
    let script = script();
    let mut recorder = Unrecorded;
    let tester = heard(&script, &mut recorder);
    let place = |name: &str| {
        let columns = script.columns();
        let place = columns.iter().position(|column| *column == name);
        place.expect("a column")
    };
    let rows = curve(&tester);
    let [way, back] = ["displacement_in_cycle_mm", "rebound_mm"].map(place);
    // the first cycle goes down by 0.9 mm and back by 0.6 mm, the second down by 0.6 mm from there
    for (row, [down, up]) in [
        (49, [0.9, 0.0]),
        (99, [0.3, 0.6]),
        (149, [0.6, 0.0]),
        (199, [0.0, 0.6]),
    ] {
        assert!(
            (rows[row][way] - down).abs() < 1e-12,
            "{row}: {:?}",
            rows[row]
        );
        assert!(
            (rows[row][back] - up).abs() < 1e-12,
            "{row}: {:?}",
            rows[row]
        );
    }
}

/// Keeps the names of files.
#[derive(Default)]
struct Files(Vec<String>);

impl Recorder for Files {
    fn columns(&mut self, _names: &[&str]) -> std::io::Result<()> {
        Ok(())
    }

    fn point(&mut self, _values: &[f64]) -> std::io::Result<()> {
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn std::io::Write) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        let rows = bytes.split(|byte| *byte == b'\n').count();
        self.0.push(format!("{name} of {rows} lines"));
        Ok(())
    }

    fn progress(&mut self, _fraction: f64, _phase: &str) {}

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _bytes: &[u8]) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_test_that_failed_keeps_how_its_bed_was_prepared() {
    let script = script();
    let mut files = Files::default();
    let mut tester = Tester::new(&script, &mut files);
    tester.columns(&COLUMNS).expect("it keeps nothing");
    for (stage, time) in [(1.0, 0.5), (2.0, 1.5)] {
        let row = [time, stage, 0.1, 0.0, 4.0, 0.0, 0.4, 0.0, 0.0, 0.4, 0.7];
        tester.point(&row).expect("it keeps nothing");
    }
    tester.keep();
    // a header, two stages, the end of the file
    assert_eq!(files.0, ["preparation.csv of 4 lines"]);
}

#[test]
fn an_end_of_a_cycle_belongs_to_it_and_a_step_beyond_the_last_too() {
    let load = Load {
        block: 1,
        cycle: 5,
        course: Course::Swing {
            period: 1.0,
            cycles: 2,
        },
    };
    for (time, cycle, is_unloading) in [
        (0.5, 5, false),
        (1.0, 5, true),
        (1.25, 6, false),
        (2.001, 6, true),
    ] {
        let expected = Place {
            block: 1,
            cycle,
            is_unloading,
        };
        assert_eq!(place(&load, time), expected, "{time}");
    }
}

#[test]
fn moduli_of_a_linear_bed_are_its_modulus() {
    let script = script();
    let mut recorder = Unrecorded;
    let tester = heard(&script, &mut recorder);
    let oedometer = oedometer::of(&tester.heard).expect("an oedometer");
    assert!((oedometer.height - 0.2).abs() < 1e-15);
    // E = k h/A
    let area = script.loaded_area;
    for step in &oedometer.steps {
        let expected = if step.is_loading { 1e6 } else { 1.5e6 } * 0.2 / area;
        assert!((step.modulus / expected - 1.0).abs() < 1e-6, "{step:?}");
    }
    // from an eighth of the peak: below it the bed was seated
    assert_eq!(
        oedometer
            .steps
            .iter()
            .filter(|step| step.is_loading)
            .count(),
        3
    );
    assert_eq!(
        oedometer
            .steps
            .iter()
            .filter(|step| !step.is_loading)
            .count(),
        3
    );
}
