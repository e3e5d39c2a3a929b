//! What an accuracy study varies in a test of a section.
use super::accuracy::preset_grid;
use super::estimate;
use super::{
    BondStiffness, CompositeBending, Exact, Geometry, Grid, Knobs, Lattice, Paper, Solver,
};
use crate::accuracy::Preset;
use crate::spec_trait::Studied;
use crate::study::Knob;

/// Cells along both sides in those of the spec; the last is the reference.
const CELLS: [&str; 4] = ["0.25", "0.5", "1", "2"];
const FINEST: &str = "4";

/// Results that are compared: all that do not describe the grid itself.
const COMPARED: [&str; 14] = [
    "mean_top_deflection",
    "mean_bottom_deflection",
    "deflection_ratio",
    "strain_energy",
    "effective_modulus",
    "effective_poisson_ratio",
    "effective_shear_modulus",
    "flexural_modulus",
    "max_force",
    "deflection",
    "flexural_stress",
    "interlaminar_shear_stress",
    "natural_frequency",
    "peak_deflection",
];

impl Studied for CompositeBending {
    fn knobs(&self) -> Vec<Knob> {
        let accuracy = self.accuracy.knobs();
        let mut knobs = Vec::new();
        if matches!(self.lattice, Lattice::Exact(_)) {
            knobs.push(Knob::new(
                "preset",
                "the grid of a preset: draft, standard, reference, or finest with twice the cells of reference \
                 along both sides and through every fibre and ply",
                preset_word(self),
                &["draft", "standard", "reference"],
                "finest",
            ));
        }
        knobs.push(Knob::new(
            "cells",
            "cells along both sides in those of the spec, a number above 0",
            1,
            &CELLS,
            FINEST,
        ));
        if self.plies.is_empty() && self.grid().graded_cells_per_fibre.is_none() {
            knobs.push(Knob::new(
                "lattice",
                "what holds the particles together: exact, paper_p_wave or paper_bare",
                lattice_word(&self.lattice),
                &["paper_p_wave", "paper_bare"],
                "exact",
            ));
        }
        if self.test.history.is_none() && !is_bent(self) {
            knobs.push(Knob::new(
                "solver",
                "the way to rest: static, verlet, pbd or xpbd",
                solver_word(accuracy.solver),
                &["verlet", "pbd", "xpbd"],
                "static",
            ));
            knobs.push(Knob::new(
                "geometry",
                "how displacements are measured: linear or large",
                match accuracy.geometry {
                    Geometry::Linear => "linear",
                    Geometry::Large => "large",
                },
                &["linear"],
                "large",
            ));
        }
        if moves(self) {
            knobs.push(Knob::new(
                "time_step",
                "time step in that of the spec, or where it gives none in half of the time that a wave \
                 takes through a cell, about the automatic one",
                1,
                &["0.5", "0.25"],
                "0.125",
            ));
        } else if accuracy.geometry == Geometry::Large || is_bent(self) {
            knobs.push(Knob::new(
                "load_steps",
                "equal steps of the load",
                accuracy.load_steps,
                &["1", "2", "4"],
                "16",
            ));
        }
        knobs
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        match knob {
            "preset" => {
                let sides = [self.section.length_mm, self.section.height_mm];
                let finest = || times(preset_grid(Preset::Reference, sides), 2.0);
                let named = PRESETS.into_iter().find(|(name, _)| *name == value);
                self.grid = Some(match (named, value) {
                    (Some((_, preset)), _) => preset_grid(preset, sides),
                    (None, "finest") => finest(),
                    (None, GIVEN) => self.grid(),
                    _ => return None,
                });
            }
            "cells" => {
                let factor: f64 = value.parse().ok().filter(|factor| *factor > 0.0)?;
                self.grid = Some(times(self.grid(), factor));
            }
            "lattice" => {
                let paper = |stiffness| {
                    let bonds = match self.lattice {
                        Lattice::Paper(paper) => paper.bonds,
                        Lattice::Exact(_) => super::BondPattern::default(),
                    };
                    Lattice::Paper(Paper { stiffness, bonds })
                };
                self.lattice = match value {
                    "exact" => Lattice::Exact(Exact {}),
                    "paper_p_wave" => paper(BondStiffness::PWave),
                    "paper_bare" => paper(BondStiffness::Bare),
                    _ => return None,
                };
            }
            "solver" => {
                let solvers = [Solver::Static, Solver::Verlet, Solver::Pbd, Solver::Xpbd];
                let solver = solvers
                    .into_iter()
                    .find(|solver| solver_word(*solver) == value)?;
                self.change_knobs(|knobs| knobs.solver = solver);
            }
            "geometry" => {
                let geometry = match value {
                    "linear" => Geometry::Linear,
                    "large" => Geometry::Large,
                    _ => return None,
                };
                self.change_knobs(|knobs| knobs.geometry = geometry);
            }
            "time_step" => {
                let factor: f64 = value.parse().ok().filter(|factor| *factor > 0.0)?;
                let step = match self.accuracy.knobs().time_step_s {
                    Some(given) => Some(factor * given),
                    None if value == "1" => None,
                    None => {
                        let smallest_mm = self.laid().first()?.smallest_mm;
                        Some(factor * estimate::automatic_step_s(self, smallest_mm))
                    }
                };
                self.change_knobs(|knobs| knobs.time_step_s = step);
            }
            "load_steps" => {
                let steps = value.parse().ok()?;
                self.change_knobs(|knobs| knobs.load_steps = steps);
            }
            _ => return None,
        }
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.seed = seed;
        self.output.picture = false;
    }

    fn compares(result: &str) -> bool {
        COMPARED.contains(&result)
    }
}

/// Whether particles move in time steps.
fn moves(spec: &CompositeBending) -> bool {
    spec.test.history.is_some() || spec.accuracy.knobs().solver != Solver::Static
}

/// Says that a spec's grid is none of a preset.
const GIVEN: &str = "given";

const PRESETS: [(&str, Preset); 3] = [
    ("draft", Preset::Draft),
    ("standard", Preset::Standard),
    ("reference", Preset::Reference),
];

/// The preset whose grid a spec has.
fn preset_word(spec: &CompositeBending) -> &'static str {
    let sides = [spec.section.length_mm, spec.section.height_mm];
    let is_its = |(_, preset): &(&str, Preset)| preset_grid(*preset, sides) == spec.grid();
    PRESETS
        .into_iter()
        .find(is_its)
        .map_or(GIVEN, |(name, _)| name)
}

/// A grid with a multiple of its cells along both sides and through every fibre and ply.
fn times(grid: Grid, factor: f64) -> Grid {
    let scaled = |count: u32| (f64::from(count) * factor).round().max(1.0) as u32;
    Grid {
        cells: grid.cells.map(scaled),
        equal_cells: grid.equal_cells,
        graded_cells_per_fibre: grid.graded_cells_per_fibre.map(scaled),
    }
}

fn is_bent(spec: &CompositeBending) -> bool {
    spec.test.way().is_some_and(|way| way.flexure().is_some())
}

impl CompositeBending {
    /// Changes the knobs of accuracy; the grid stays what it was.
    fn change_knobs(&mut self, change: impl FnOnce(&mut Knobs)) {
        self.grid = Some(self.grid());
        self.accuracy.change(change);
    }
}

fn lattice_word(lattice: &Lattice) -> &'static str {
    match lattice {
        Lattice::Exact(_) => "exact",
        Lattice::Paper(paper) => match paper.stiffness {
            BondStiffness::PWave => "paper_p_wave",
            BondStiffness::Bare => "paper_bare",
        },
    }
}

fn solver_word(solver: Solver) -> &'static str {
    match solver {
        Solver::Static => "static",
        Solver::Verlet => "verlet",
        Solver::Pbd => "pbd",
        Solver::Xpbd => "xpbd",
    }
}

#[cfg(test)]
mod tests {
    use crate::{JobKind, JobSpec, Submission};
    use serde_json::{Value, json};

    fn example(change: impl FnOnce(&mut Value)) -> JobSpec {
        let body = JobKind::CompositeBending.examples()[0].body;
        let mut body: Value = serde_json::from_str(body).expect("JSON");
        change(&mut body["spec"]);
        let submission = Submission::from_slice(body.to_string().as_bytes());
        submission.expect("a valid job").spec
    }

    fn time_step(spec: &JobSpec) -> Option<f64> {
        let JobSpec::CompositeBending(spec) = spec else {
            panic!("it is a section");
        };
        spec.accuracy.knobs().time_step_s
    }

    #[test]
    fn motion_has_its_time_step_varied_and_large_rotations_their_steps_of_the_load() {
        let in_motion = |step: Value| {
            example(|spec| {
                for material in ["filler", "fibre"] {
                    spec["materials"][material]["density_kg_per_m3"] = json!(1500);
                }
                spec["test"]["history"] = json!({"duration_s": 1e-3});
                spec["accuracy"] = json!({"solver": "verlet"});
                if step.is_number() {
                    spec["accuracy"]["time_step_s"] = step;
                }
            })
        };
        for (given, half) in [(json!(4e-7), 2e-7), (Value::Null, f64::NAN)] {
            let spec = in_motion(given);
            let knob = spec
                .knobs()
                .into_iter()
                .find(|knob| knob.name == "time_step");
            let knob = knob.expect("motion has time steps");
            for value in knob.grid.iter().chain([&knob.reference[0].1]) {
                let mut turned = spec.clone();
                turned.turn("time_step", value).expect("a step");
                turned.check().expect("a valid spec");
            }
            let mut halved = spec.clone();
            halved.turn("time_step", "0.5").expect("a step");
            let found = time_step(&halved).expect("a step");
            // without one of its own: some part of the time a wave takes through a cell
            assert!(found > 0.0 && (half.is_nan() || (found / half - 1.0).abs() < 1e-12));
            let mut same = spec.clone();
            same.turn("time_step", "1").expect("its own");
            assert_eq!(same, spec);
        }
        let large = example(|spec| spec["accuracy"] = json!({"geometry": "large"}));
        let knobs = large.knobs();
        let named = |name: &str| knobs.iter().any(|knob| knob.name == name);
        assert!(named("load_steps") && !named("time_step"));
        let mut turned = large.clone();
        turned.turn("load_steps", "4").expect("steps");
        turned.check().expect("a valid spec");
    }
}
