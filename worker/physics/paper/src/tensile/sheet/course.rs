//! The course of a pull: from break to break, what is kept of it, and how far it is.
//!
//! A machine drives the displacement: within an avalanche the force falls at one strain, between
//! avalanches the curve is a straight line towards zero, for the rest of a network of small displacements
//! is in proportion. So two points for each avalanche, before and after, are the whole curve.
use loadframe_api::spec::paper_tensile::{Level, SHEET_CURVE, equilibrium};
use serde::{Deserialize, Serialize};

use super::specimen::Specimen;
use crate::frame::{
    Bore, Broken, Event, FrameError, Means, PullEnd, PullState, PullTest, Pulling, Step, pull,
};

/// mN in N, and nJ in N mm.
const N: f64 = 1e-3;
const N_MM: f64 = 1e-6;

/// A test that has broken so many and goes on is nearly done.
const NEARLY: f64 = 0.95;

/// A point of the curve, in the order of [`SHEET_CURVE`].
pub(super) type Point = [f64; SHEET_CURVE.len()];

/// A break, and its place in its avalanche.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    pub(super) event: Event,
    pub(super) round: u32,
}

/// How a bond gave way: by what took the larger part of its strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Opened,
    Sheared,
}

/// What is kept of a pull under way; with the spec it is all that is needed to go on.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Kept {
    pub(super) pull: PullState,
    pub(super) points: Vec<Point>,
    pub(super) records: Vec<Record>,
    /// Parts that were broken when the force was largest.
    pub(super) broken_at_peak: usize,
    /// How far the test was, of 1.
    progress: f64,
}

/// A pull under way.
pub(super) struct Course<'n> {
    specimen: &'n Specimen,
    level: Level,
    pub(super) pull: Box<dyn Pulling + 'n>,
    test: PullTest,
    means: Means,
    pub(super) kept: Kept,
}

impl<'n> Course<'n> {
    /// Holds the specimen in its jaws, or goes on from what was kept.
    ///
    /// # Errors
    /// [`FrameError`].
    pub(super) fn new(
        (specimen, level): (&'n Specimen, Level),
        test: PullTest,
        means: Means,
        kept: Option<Kept>,
    ) -> Result<Self, FrameError> {
        let is_new = kept.is_none();
        let kept = kept.unwrap_or_default();
        let pull = pull(&specimen.network, test, kept.pull.clone(), &means)?;
        let mut course = Self {
            specimen,
            level,
            pull,
            test,
            means,
            kept,
        };
        if is_new {
            let residual = course.pull.state().measures.largest_residual;
            course.point(0.0, [0.0; 2], 0.0, residual);
        }
        Ok(course)
    }

    /// Goes to the next break or to the end.
    ///
    /// # Errors
    /// [`FrameError`].
    pub(super) fn advance(&mut self) -> Result<Option<PullEnd>, FrameError> {
        let before = self.pull.state().measures;
        let was_at_um = self.pull.elongation_um();
        let left_after = self.pull.jaw_force_mn();
        let step = self.pull.advance()?;
        let now = self.pull.state().measures;
        // breaks are at the elongation to which the pull has gone
        let at_um = self.pull.elongation_um();
        let has_moved = matches!(step, Step::Moved(_));
        if now.strain_at_peak > before.strain_at_peak || now.peak_force_mn > before.peak_force_mn {
            // of masses in motion it is the force of what broke on the way, too
            let at = if has_moved { &now } else { &before };
            self.kept.broken_at_peak = at.broken();
        }
        if at_um > was_at_um && was_at_um > 0.0 && !has_moved {
            // the avalanche before is over: where its last break left the force
            let residual = self
                .kept
                .records
                .last()
                .map_or(0.0, |last| last.event.residual);
            let stored = before.stored_nj;
            self.point_at(was_at_um, left_after, stored, residual, &before);
        }
        match step {
            Step::Broke(events) => {
                for event in events {
                    let last = self.kept.records.last();
                    let same = last.filter(|last| last.event.avalanche == event.avalanche);
                    let round = same.map_or(1, |last| last.round + 1);
                    if round == 1 {
                        let forces = [event.left_force_before_mn, event.force_before_mn];
                        let stored = event.stored_before_nj;
                        let residual =
                            last.map_or(before.largest_residual, |last| last.event.residual);
                        self.point_at(at_um, forces, stored, residual, &before);
                    }
                    self.kept.records.push(Record { event, round });
                }
                self.measure_progress(at_um / self.length_um());
                Ok(None)
            }
            Step::Moved(events) => {
                for event in events {
                    let last = self.kept.records.last();
                    let same = last.filter(|last| last.event.avalanche == event.avalanche);
                    let round = same.map_or(1, |last| last.round + 1);
                    self.kept.records.push(Record { event, round });
                }
                let at = self.pull.curve_point();
                self.point_at(at.at_um, at.forces_mn, at.stored_nj, at.residual, &now);
                self.measure_progress(at_um / self.length_um());
                Ok(None)
            }
            Step::Strained => {
                let forces = self.pull.jaw_force_mn();
                self.point_at(at_um, forces, now.stored_nj, now.largest_residual, &now);
                self.measure_progress(at_um / self.length_um());
                Ok(None)
            }
            Step::Ended(end) => {
                let residual = self
                    .kept
                    .records
                    .last()
                    .map_or(now.largest_residual, |last| last.event.residual);
                // the last point of masses in motion is told already
                if end != PullEnd::NoPath && self.pull.motion_report().is_none() {
                    let forces = self.pull.jaw_force_mn();
                    self.point_at(at_um, forces, now.stored_nj, residual, &now);
                }
                Ok(Some(end))
            }
        }
    }

    /// What is kept, with the pull as it is.
    pub(super) fn keep(&self) -> Kept {
        Kept {
            pull: self.pull.state().clone(),
            ..self.kept.clone()
        }
    }

    /// How far the test is, of 1: by its strain, its breaks, or how far the force has fallen.
    pub(super) fn progress(&self) -> f64 {
        self.kept.progress
    }

    /// The pull where the force was largest; none when there never was a force.
    ///
    /// # Errors
    /// [`FrameError`].
    pub(super) fn at_peak(&self) -> Result<Option<Box<dyn Pulling + 'n>>, FrameError> {
        let state = self.pull.state();
        let measures = state.measures;
        if measures.peak_force_mn <= 0.0 {
            return Ok(None);
        }
        let elongation_um = measures.strain_at_peak * self.length_um();
        let earlier = state.at_peak(self.kept.broken_at_peak, elongation_um);
        let network = &self.specimen.network;
        pull(network, self.test, earlier, &self.means).map(Some)
    }

    fn length_um(&self) -> f64 {
        self.specimen.network.model().length_um
    }

    fn measure_progress(&mut self, strain: f64) {
        let peak = self.pull.state().measures.peak_force_mn;
        let force = self.pull.jaw_force_mn()[1];
        let by_strain = strain / self.test.max_strain;
        let network = &self.specimen.network;
        let taken = |breaks: f64| {
            if self.pull.cost().iterations > 0 {
                // many of them together, few at first
                equilibrium::solutions(self.level, self.test.break_precision, breaks)
            } else {
                breaks
            }
        };
        // what a test takes goes by breaks; where fewer break than usual the force tells
        let broken = self.kept.records.len() as f64;
        let all = equilibrium::broken_share(self.level) * network.bonds() as f64;
        let by_breaks = taken(broken) / taken(all);
        // forces fall late, and rise again within the first breaks
        let by_force = (1.0 - force / peak) / (1.0 - self.test.stop_force_fraction);
        let by_force = by_force.clamp(0.0, 1.0).powi(2);
        let progress = [by_strain, by_breaks.min(NEARLY), by_force]
            .into_iter()
            .filter(|share| share.is_finite())
            .fold(0.0, f64::max);
        self.kept.progress = self.kept.progress.max(progress).min(1.0);
    }

    fn point(&mut self, at_um: f64, forces_mn: [f64; 2], stored_nj: f64, residual: f64) {
        let measures = self.pull.state().measures;
        self.point_at(at_um, forces_mn, stored_nj, residual, &measures);
    }

    fn point_at(
        &mut self,
        at_um: f64,
        [left_mn, right_mn]: [f64; 2],
        stored_nj: f64,
        residual: f64,
        counts: &crate::frame::PullMeasures,
    ) {
        let point = [
            at_um / self.length_um(),
            N * right_mn,
            N * left_mn,
            counts.broken_bonds as f64,
            residual / self.pull.residual_limit(),
            counts.broken_segments as f64,
            N_MM * stored_nj,
        ];
        // a place is told once, whatever its residual was told by
        let is_told = self.kept.points.last().is_some_and(|last| {
            let same = last.iter().zip(&point).enumerate();
            same.filter(|(column, _)| SHEET_CURVE[*column] != "residual_ratio")
                .all(|(_, (one, other))| one.to_bits() == other.to_bits())
        });
        if !is_told {
            self.kept.points.push(point);
        }
    }
}

impl Specimen {
    /// How a bond gave way that bore this; void bonds bear nothing.
    pub(super) fn mode(&self, bond: usize, bore: Bore) -> Option<Mode> {
        let Bore::Bond {
            normal_mn,
            shear_mn,
        } = bore
        else {
            return None;
        };
        let [normal, shear] = self.network.strengths(bond);
        let share = |force: f64, strength: f64| if force > 0.0 { force / strength } else { 0.0 };
        let is_opened = share(normal_mn, normal) >= share(shear_mn, shear);
        Some(if is_opened {
            Mode::Opened
        } else {
            Mode::Sheared
        })
    }
}

impl Record {
    /// The number of the bond or the segment, and which.
    pub(super) fn bond(&self) -> Option<usize> {
        match self.event.broken {
            Broken::Bond(bond) => Some(bond),
            Broken::Segment(_) => None,
        }
    }
}
