//! Where the jaw turns and where the test ends; a force at which it turns is found between steps.
use super::{Advance, Experiment, StopReason};
use crate::{
    Vector,
    nonwoven::state::{Aim, Place, Point, Worst},
};

/// Strains tried at most to find a force: halving brings a step to its last digits by then.
const MOST_LOOKS: u32 = 100;
/// Least part of the strain step that is looked at.
const SHORTEST: f64 = 1e-12;

impl Experiment<'_> {
    /// Goes on to the next step, perhaps on the next leg.
    pub(in crate::nonwoven) fn next_step(&mut self) {
        self.state.place = self.next_place();
        self.state.step += 1;
        let (place, reached) = (self.state.place, self.state.reached.strain);
        let end = self.path.strain(place, self.state.step);
        self.state.strain = self.path.rest(place, reached, end);
        self.state.round = 0;
        self.state.rounds_before = 0;
        self.state.worst_of_step = Worst::default();
    }

    /// Whether the leg ends with the step just recorded.
    pub(in crate::nonwoven) fn is_turning(&self) -> bool {
        self.state
            .points
            .last()
            .is_some_and(|point| self.is_at_end(point.force))
    }

    /// Nominal strain of the step being worked on, perhaps not reached yet.
    pub(super) fn step_end(&self) -> f64 {
        let state = &self.state;
        match state.aim {
            Some(aim) => aim.strain,
            None => self.path.strain(state.place, state.step),
        }
    }

    /// Whether the leg comes to the one strain before it comes to the other.
    pub(super) fn is_before(&self, one: f64, other: f64) -> bool {
        self.path.is_before(self.state.place, one, other)
    }

    /// Whether the leg ends in the present state.
    pub(super) fn is_at_end(&self, force: f64) -> bool {
        self.is_end_of(self.state.place, force)
    }

    fn is_end_of(&self, place: Place, force: f64) -> bool {
        let largest = self.state.max_force.max(force);
        self.path
            .is_at_end(place, self.state.strain, force, largest)
    }

    /// Where the way goes on from a recorded state: on this leg, or on the first that does not end
    /// where it begins. Beyond the last leg there is none.
    fn next_place(&self) -> Place {
        let force = self.state.points.last().map_or(0.0, |point| point.force);
        let mut place = self.state.place;
        while self.path.has_leg(place.leg) && self.is_end_of(place, force) {
            place = Place {
                leg: place.leg + 1,
                from: self.state.strain,
                after_step: self.state.step,
            };
        }
        place
    }

    /// Whether the force is beyond the one that ends the leg, and a strain between here and the last
    /// state is worth looking at.
    pub(super) fn oversteps_force(&self, force: f64) -> bool {
        let (state, largest) = (&self.state, self.state.max_force.max(force));
        let width = (state.strain - state.reached.strain).abs();
        let looks = state.aim.map_or(0, |aim| aim.looks);
        self.path.is_force_beyond(state.place, force, largest)
            && looks < MOST_LOOKS
            && width > SHORTEST * self.spec.test.strain_step
    }

    /// Goes back to `displacements`, the last state before the force that ends the leg, and chooses a
    /// strain on the way to the present one, which is beyond it.
    pub(super) fn look_for_force(
        &mut self,
        force: f64,
        displacements: Vec<Vector>,
        worst: Worst,
    ) -> Advance {
        let state = &mut self.state;
        state.displacements = displacements;
        state.worst_of_step = worst;
        // what is over its strength here is beyond the end of the leg
        state.search = None;
        let looks = state.aim.map_or(0, |aim| aim.looks);
        state.aim = Some(Aim {
            strain: state.strain,
            force,
            looks,
        });
        self.state.strain = self.next_strain(self.state.strain);
        Advance::GoesOn
    }

    /// The strain to go to: between the last state and the one known to be beyond the force that ends
    /// the leg; where there is none, `end`, or before it where the pull is read.
    pub(super) fn next_strain(&mut self, end: f64) -> f64 {
        let reached = self.state.reached;
        let Some(aim) = &mut self.state.aim else {
            return self.path.rest(self.state.place, reached.strain, end);
        };
        let way = aim.strain - reached.strain;
        if aim.looks >= MOST_LOOKS || way.abs() <= SHORTEST * self.spec.test.strain_step {
            // nothing is left to divide: the leg ends beyond its force
            aim.looks = MOST_LOOKS;
            return aim.strain;
        }
        let forces = [reached.force, aim.force];
        let part = self.path.part(self.state.place, forces, aim.looks);
        aim.looks += 1;
        reached.strain + part * way
    }

    /// Adds up the work of the jaw on the way to a state at which nothing breaks any more, and the
    /// energy that went when bonds broke there: what was stored before the first of them broke, less
    /// what is stored now, at one strain.
    ///
    /// The work of a step is the mean of the forces at its ends, before anything breaks, times the
    /// move of the jaw.
    pub(super) fn account(&mut self, point: &mut Point) {
        let state = &mut self.state;
        let way = (state.strain - state.reached.strain) * self.specimen.gauge_length;
        let before = state.before_breaking.unwrap_or(*point);
        if way != 0.0 {
            state.work_done += 0.5 * (state.reached.force + before.force) * way;
        }
        if let Some(before) = &mut state.before_breaking {
            before.work = state.work_done;
            before.lost_energy = state.energy_lost;
        }
        if state.round > state.rounds_before {
            state.energy_lost += before.stored_energy - point.stored_energy;
        }
        point.work = state.work_done;
        point.lost_energy = state.energy_lost;
    }

    /// Why the test ends with the step just recorded, if it does.
    pub(super) fn stop_reason(&self) -> Option<StopReason> {
        let test = &self.spec.test;
        let state = &self.state;
        let force = state.points.last().map_or(0.0, |point| point.force);
        // a force that falls although nothing broke is slack being taken up, not rupture; on a way that
        // was gone before it is below its maximum, and comes back to it; one that pushes the jaws apart is
        // no smaller part of the maximum than none
        let has_broken = !state.events.is_empty();
        let is_pulled = !self.path.leg(state.place).unloads && state.strain >= state.farthest;
        if has_broken && is_pulled && force.max(0.0) < test.stop_force_fraction * state.max_force {
            return Some(StopReason::ForceDropped);
        }
        if test.history.is_empty() {
            return (state.strain >= test.max_strain).then_some(StopReason::MaxStrain);
        }
        let place = state.place;
        let is_short = is_pulled
            && self.path.force(place).is_some()
            && !self.path.is_force_reached(place, force, state.max_force);
        if is_short && state.strain >= test.max_strain {
            return Some(StopReason::MaxStrain);
        }
        let next = self.next_place();
        (!self.path.has_leg(next.leg)).then_some(StopReason::HistoryFinished)
    }
}
