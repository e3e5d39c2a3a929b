//! Values read off a test.
use indexmap::IndexMap;
use loadframe_api::spec::composite_bending::Way;
use serde::{Deserialize, Serialize};

use super::bent::Bent;
use super::cracks::Broken;
use super::failure;
use super::history::Swing;
use super::model::Model;
use crate::flexure::FlexureResult;
use crate::measure::face_mean_mm;
use crate::motion::Motion;
use crate::solve::Equilibrium;
use crate::supports::Face;

/// N mm in J.
const J: f64 = 1e-3;

/// What a test has come to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tested {
    /// At rest under the whole load.
    pub(super) rest: Equilibrium,
    /// What was seen of a motion, and its displacements at the end.
    pub(super) motion: Option<Moved>,
    /// What rollers did.
    pub(super) bent: Option<Bent>,
    /// What broke.
    pub(super) broken: Option<Broken>,
}

/// What was seen of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Moved {
    pub(super) swing: Swing,
    pub(super) displacements_mm: Vec<f64>,
    pub(super) time_step_s: f64,
    pub(super) steps: u64,
}

/// A result.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Measured {
    pub(super) name: &'static str,
    /// Not a number where the test did not get so far.
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) description: &'static str,
}

impl Tested {
    pub(super) fn at_rest(rest: Equilibrium) -> Self {
        Self {
            rest,
            motion: None,
            bent: None,
            broken: None,
        }
    }

    pub(super) fn bent(found: FlexureResult) -> Self {
        let bent = Bent::of(&found);
        Self {
            rest: found.contact.equilibrium,
            motion: None,
            bent: Some(bent),
            broken: None,
        }
    }

    pub(super) fn in_time(rest: Equilibrium, motion: &Motion<'_>, swing: Swing) -> Self {
        let motion = Moved {
            swing,
            displacements_mm: motion.displacements_mm().to_vec(),
            time_step_s: motion.time_step_s(),
            steps: motion.steps(),
        };
        Self {
            rest,
            motion: Some(motion),
            bent: None,
            broken: None,
        }
    }

    /// Work done, by name.
    pub(super) fn work(&self) -> IndexMap<String, u64> {
        let particles = self.rest.displacements_mm.len() as u64 / 2;
        let moved = self.motion.as_ref().map_or(0, |moved| moved.steps);
        IndexMap::from([
            ("linear_solutions".to_owned(), self.rest.solutions),
            ("iterations".to_owned(), self.rest.iterations),
            ("particle_steps".to_owned(), particles * moved),
            (
                "events".to_owned(),
                self.broken
                    .as_ref()
                    .map_or(0, |broken| broken.totals.events),
            ),
        ])
    }

    /// Whether a cell has kept most of its stiffness to the end.
    pub(super) fn is_whole(&self, cell: usize) -> bool {
        const MOSTLY: f64 = 0.5;
        let end = self.broken.as_ref().and_then(|broken| broken.end.as_ref());
        end.is_none_or(|look| look.damage[cell] < MOSTLY)
    }

    /// Displacements at the end of the test [mm].
    pub(super) fn displacements_mm(&self) -> &[f64] {
        let moved = self.motion.as_ref().map(|moved| &moved.displacements_mm);
        let broken = self.broken.as_ref().and_then(|broken| broken.end.as_ref());
        moved
            .or(broken.map(|look| &look.displacements_mm))
            .unwrap_or(&self.rest.displacements_mm)
    }
}

/// A point of the curve of a section at rest under a share of its load.
pub(super) fn point(model: &Model<'_>, rest: &Equilibrium, share: f64) -> [f64; 6] {
    let [deflection, force] = drive(model, rest, share);
    let [top, bottom] = faces(model, &rest.displacements_mm);
    [deflection, force, share, top, bottom, rest.energy_n_mm]
}

/// The way of what is loaded along its load, and the force: work is one times the other.
fn drive(model: &Model<'_>, rest: &Equilibrium, share: f64) -> [f64; 2] {
    if let Some(load) = &model.spec.test.load {
        let total = load.force_n[0].hypot(load.force_n[1]);
        let pairs = model.load.iter().zip(&rest.displacements_mm);
        let work: f64 = pairs.map(|(force, u)| force * u).sum();
        return [work / total, share * total];
    }
    let mut largest = 0.0_f64;
    let mut work = 0.0;
    for (place, reaction) in rest.reactions_n.iter().enumerate() {
        if let Some(way) = model.supports.prescribed(place) {
            largest = largest.max(way.abs());
            work += reaction * way;
        }
    }
    if largest > 0.0 {
        [share * largest, work / largest]
    } else {
        [0.0; 2]
    }
}

/// Mean deflections of the top and the bottom face, positive where they give way.
fn faces(model: &Model<'_>, u: &[f64]) -> [f64; 2] {
    [Face::Top, Face::Bottom].map(|face| {
        let mean = face_mean_mm(model.lattice.grid(), face, u);
        mean[0] * model.direction[0] + mean[1] * model.direction[1]
    })
}

/// All results.
pub(super) fn measure(model: &Model<'_>, tested: &Tested) -> Vec<Measured> {
    let whole = match &tested.bent {
        Some(bent) => bent.measured(),
        None => at_rest(model, tested),
    };
    let Some(broken) = &tested.broken else {
        return whole;
    };
    // under the load that was given nothing may be whole any more: what does not grow with it stays
    let mut all = failure::measure(model, broken);
    all.extend(whole.into_iter().filter(|one| failure::stays(one.name)));
    all
}

/// Results of a section that is held and loaded, or moves.
fn at_rest(model: &Model<'_>, tested: &Tested) -> Vec<Measured> {
    let mut all = Vec::new();
    let mut add = |name, value, unit, description| {
        all.push(Measured {
            name,
            value,
            unit,
            description,
        });
    };
    let rest = &tested.rest;
    let section = &model.spec.section;
    let [_, force] = drive(model, rest, 1.0);
    let area = section.height_mm * section.thickness_mm;
    match model.spec.test.way() {
        Some(Way::Tension(tension)) => {
            add(
                "effective_modulus",
                force * tension.strain.signum() / area / tension.strain,
                "MPa",
                "Force over the section's area and the strain of its length.",
            );
            let grid = model.lattice.grid();
            let across = |face| face_mean_mm(grid, face, &rest.displacements_mm)[1];
            let strain = (across(Face::Top) - across(Face::Bottom)) / section.height_mm;
            add(
                "effective_poisson_ratio",
                -strain / tension.strain,
                "1",
                "Mean contraction of the height over the strain of the length.",
            );
            add("max_force", force, "N", "Force of the grips.");
        }
        Some(Way::Shear(shear)) => {
            let volume = section.length_mm * area;
            add(
                "effective_shear_modulus",
                2.0 * rest.energy_n_mm / (volume * shear.strain * shear.strain),
                "MPa",
                "Twice the energy per volume over the square of the shear strain, all faces moved \
                 as in uniform shear: an upper bound of the shear modulus of a large piece.",
            );
        }
        _ => {}
    }
    if force != 0.0 {
        if let Some(Way::Held(_)) = model.spec.test.way() {
            let [top, bottom] = faces(model, &rest.displacements_mm);
            add(
                "mean_top_deflection",
                top,
                "mm",
                "Mean displacement of the top face along the load, at rest.",
            );
            add(
                "mean_bottom_deflection",
                bottom,
                "mm",
                "Mean displacement of the bottom face along the load, at rest.",
            );
            add(
                "deflection_ratio",
                top / bottom,
                "1",
                "Mean deflection of the top face over that of the bottom face.",
            );
            if model.spec.test.load.is_none() {
                add(
                    "max_force",
                    force,
                    "N",
                    "Force on the faces that are moved, along their way.",
                );
            }
        }
        add(
            "strain_energy",
            rest.energy_n_mm * J,
            "J",
            "Elastic energy at rest under the whole load.",
        );
    }
    if let Some(moved) = &tested.motion {
        add(
            "peak_deflection",
            moved.swing.peak,
            "mm",
            "Largest mean displacement of the top face along the load, or the first velocity, in time.",
        );
        add(
            "time_of_peak_deflection",
            moved.swing.peak_s,
            "s",
            "When the top face's mean displacement was largest.",
        );
        add(
            "natural_frequency",
            moved.swing.frequency_hz().unwrap_or(f64::NAN),
            "Hz",
            "Swings of the top face about its rest over the time they took.",
        );
    }
    all
}
