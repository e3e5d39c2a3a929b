//! The deflected section beside the line that Timoshenko's theory gives it.
use loadframe_api::spec::composite_bending::{Axis, Support, SupportWord, Way};
use loadframe_harness::{Recorder, SimulationError, csv};

use super::model::Model;
use super::tested::Tested;
use crate::error::CompositeError;
use crate::flexure::{Beam, End, PointForce, deflected_line, line_on_supports};
use crate::lattice::Geometry;
use crate::measure::column_mean_mm;

/// Length over height from which on a section is looked at as a beam: of shorter ones the theory, which
/// knows neither clamped faces nor loads that press, is off by more than it tells.
const SLENDER: f64 = 4.0;

/// Writes the deflected section and the beam's line, where there is one: of a stack of plies without fibres
/// of its own, slender, at rest in small displacements, held at its ends or lying on rollers, with forces
/// across it.
pub(super) fn write(
    model: &Model<'_>,
    tested: &Tested,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let Some(line) = of(model, tested)? else {
        return Ok(());
    };
    let grid = model.lattice.grid();
    recorder.file("beam_line.csv", &mut |out| {
        csv::header(out, &["x_mm", "uy_mm", "timoshenko_uy_mm"])?;
        for (column, (x, by_beam)) in grid.x_mm().iter().zip(&line).enumerate() {
            let own = column_mean_mm(grid, column, tested.displacements_mm())[1];
            csv::row(out, &[*x, own, *by_beam])?;
        }
        Ok(())
    })?;
    Ok(())
}

fn of(model: &Model<'_>, tested: &Tested) -> Result<Option<Vec<f64>>, CompositeError> {
    let (section, test) = (&model.section, &model.spec.test);
    let is_still = test.breaking.is_none() && test.history.is_none();
    let is_slender = section.length_mm >= SLENDER * section.height_mm;
    if !(is_still && is_slender && model.geometry() == Geometry::Linear) {
        return Ok(None);
    }
    let Some(beam) = Beam::of(section)? else {
        return Ok(None);
    };
    let places = model.lattice.grid().x_mm();
    if let (Some((flexure, _)), Some(bent)) = (model.flexure(), &tested.bent) {
        let forces = flexure.forces(section, bent.force_n());
        let (beneath, _) = flexure.rollers(section);
        let supports = beneath.map(|roller| roller.at_mm);
        return Ok(Some(line_on_supports(&beam, places, &forces, supports)));
    }
    let Some(Way::Held(supports)) = test.way() else {
        return Ok(None);
    };
    let is_free = |face: &Support| *face == Support::default();
    let [left, right] = [&supports.left, &supports.right].map(end);
    let (Some(left), Some(right)) = (left, right) else {
        return Ok(None);
    };
    let is_along = test
        .load
        .as_ref()
        .is_some_and(|load| load.force_n[0] != 0.0);
    if is_along || !is_free(&supports.top) || !is_free(&supports.bottom) {
        return Ok(None);
    }
    let forces = across(model);
    Ok(deflected_line(&beam, places, &forces, [left, right]))
}

/// How a face at an end holds a beam: along x it keeps the end from turning, along y from deflecting.
/// `None` of one that moves.
fn end(face: &Support) -> Option<End> {
    let [holds_turn, holds_deflection] = match face {
        Support::Word(SupportWord::Clamped) => [true; 2],
        Support::Word(SupportWord::Free) => [false; 2],
        Support::Word(SupportWord::Rolling) => [true, false],
        Support::PerAxis(axes) => axes.map(|axis| axis == Axis::Clamped),
        Support::Driven(_) => return None,
    };
    Some(End {
        holds_turn,
        holds_deflection,
    })
}

/// The load across the section, by columns of particles.
fn across(model: &Model<'_>) -> Vec<PointForce> {
    let grid = model.lattice.grid();
    let columns = grid.x_mm().iter().enumerate();
    columns
        .map(|(column, at_mm)| PointForce {
            at_mm: *at_mm,
            force_n: (0..=grid.rows())
                .map(|row| model.load[2 * grid.particle(column, row) + 1])
                .sum(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use loadframe_api::{JobSpec, Submission};
    use loadframe_harness::{RunContext, Uninterrupted};

    use super::super::comparison::Fineness;
    use super::super::conduct;
    use super::super::watch::Unwatched;
    use super::*;

    /// Largest distance of a strip 50 mm long from its beam's line, over the line's largest deflection.
    fn off_the_beam(height_mm: f64, test: &str) -> Option<f64> {
        let body = format!(
            r#"{{"kind": "composite_bending", "spec": {{"version": 1,
            "section": {{"length_mm": 50, "height_mm": {height_mm}, "thickness_mm": 2, "state": "plane_stress"}},
            "materials": {{"steel": {{"isotropic": {{"youngs_modulus_mpa": 1000, "poisson_ratio": 0.3}}}}}},
            "matrix": "steel", "grid": {{"cells": [200, 10]}}, "test": {{{test}}}}}}}"#
        );
        let submission = Submission::from_slice(body.as_bytes()).unwrap();
        let JobSpec::CompositeBending(spec) = submission.spec else {
            panic!("of another kind");
        };
        let finest = Fineness {
            grid: spec.grid(),
            contact_cells: 4,
            shrinks_to_corners: spec.shrinks_to_corners(),
        };
        let context = RunContext {
            threads: 1,
            interrupt: &Uninterrupted,
            checkpoint: None,
        };
        let model = Model::new(&spec, finest).unwrap();
        let Ok(tested) = conduct(&model, None, context, &mut Unwatched(context)) else {
            panic!("has no rest");
        };
        let line = of(&model, &tested).unwrap()?;
        let grid = model.lattice.grid();
        let (mut off, mut far) = (0.0_f64, 0.0_f64);
        for (column, by_beam) in line.iter().enumerate() {
            let own = column_mean_mm(grid, column, tested.displacements_mm())[1];
            off = off.max((own - by_beam).abs());
            far = far.max(by_beam.abs());
        }
        Some(off / far)
    }

    fn held(supports: &str, force_n: &str, on: &str) -> String {
        format!(r#""supports": {{{supports}}}, "load": {{"force_n": {force_n}, "on": {on}}}"#)
    }

    const BOTH: &str = r#""left": "clamped", "right": "clamped""#;
    const DOWN: &str = "[0, -1]";

    #[test]
    fn slender_sections_lie_on_the_line_of_the_beam_they_are() {
        let propped = r#""left": "clamped", "right": ["free", "clamped"]"#;
        let guided = r#""left": "rolling", "right": "clamped""#;
        let patch = r#"{"patch": {"face": "bottom", "from_mm": 0, "to_mm": 5}}"#;
        for test in [
            held(r#""left": "clamped""#, DOWN, r#"{"face": "right"}"#),
            held(BOTH, DOWN, r#"{"face": "top"}"#),
            held(propped, DOWN, r#""body""#),
            held(guided, DOWN, patch),
            // the less the section turns on its supports, the less contacts move inwards: R₂ FL²/(16 EI)
            r#""three_point": {"span_mm": 40, "force_n": 0.05}"#.to_owned(),
            r#""four_point": {"span_mm": 45, "force_n": 0.05}"#.to_owned(),
        ] {
            // what clamped faces and rollers do to a section a twentieth as high as long
            let off = off_the_beam(2.5, &test).unwrap();
            assert!(off < 0.01, "{test} {off}");
        }
    }

    #[test]
    fn what_is_no_beam_has_no_line() {
        let body = r#""body""#;
        for (height, test) in [
            (20.0, held(BOTH, DOWN, body)),
            (2.5, held(r#""bottom": "clamped""#, DOWN, body)),
            (2.5, held(BOTH, "[1, -1]", body)),
            (2.5, r#""tension": {"strain": 1e-4}"#.to_owned()),
        ] {
            assert!(off_the_beam(height, &test).is_none(), "{test}");
        }
    }
}
