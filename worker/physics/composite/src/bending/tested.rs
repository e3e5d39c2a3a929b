//! What a test has come to: a rest, a motion, what rollers did, what broke.
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::bent::Bent;
use super::swing::Swing;
use crate::breaking::{EndReason, Event, Totals};
use crate::flexure::FlexureResult;
use crate::motion::Motion;
use crate::solve::Equilibrium;

/// What a test has come to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tested {
    /// At rest under the whole load.
    pub(super) rest: Equilibrium,
    /// Part of the load at the first rest on the way from which the least push leads away.
    pub(super) unstable: Option<f64>,
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

/// A section at one moment of its breaking.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Look {
    /// Way of the drive [mm], and its force [N].
    pub(super) displacement_mm: f64,
    pub(super) force_n: f64,
    pub(super) displacements_mm: Vec<f64>,
    /// Lost part of every cell's stiffness.
    pub(super) damage: Vec<f64>,
    /// σ_xx, σ_yy and σ_xy of every cell [MPa].
    pub(super) stresses_mpa: Vec<[f64; 3]>,
}

/// What breaking has come to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Broken {
    pub(super) events: Vec<Event>,
    pub(super) reason: EndReason,
    pub(super) totals: Totals,
    /// At the largest force and at the end; none where nothing broke.
    pub(super) peak: Option<Look>,
    pub(super) end: Option<Look>,
}

impl Tested {
    pub(super) fn at_rest(rest: Equilibrium) -> Self {
        Self {
            rest,
            unstable: None,
            motion: None,
            bent: None,
            broken: None,
        }
    }

    pub(super) fn bent(found: FlexureResult) -> Self {
        let bent = Bent::of(&found);
        Self {
            rest: found.contact.equilibrium,
            unstable: None,
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
            unstable: None,
            motion: Some(motion),
            bent: None,
            broken: None,
        }
    }

    /// The same, with where it first was not stable.
    pub(super) fn unstable(self, unstable: Option<f64>) -> Self {
        Self { unstable, ..self }
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
