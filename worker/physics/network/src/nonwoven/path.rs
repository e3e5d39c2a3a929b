//! The way of the jaw: legs of loading and unloading, each in strain steps from where the one before
//! it ended.
use loadframe_api::spec::nonwoven_tensile::{Leg, NonwovenTensile, Target};

use super::{
    readings::USUAL_STRAIN,
    state::{Place, Point},
};

/// Part of the largest force so far to which a force is reached: far below the force error of a
/// testing machine, far above the rounding of forces.
const FORCE_PRECISION: f64 = 1e-5;
/// Rounding of `step * strain_step` against the end of a leg, with a wide margin.
const LAST_STEP_SLACK: f64 = 1e-12;

/// Where the jaw goes.
#[derive(Clone, Debug)]
pub(super) struct Path {
    legs: Vec<Leg>,
    strain_step: f64,
    max_strain: f64,
    /// Nominal strains at which the first pull is read, ascending.
    readings: Vec<f64>,
}

impl Path {
    pub(super) fn new(spec: &NonwovenTensile) -> Self {
        let mut readings = spec.output.reading_strains.clone();
        readings.push(USUAL_STRAIN);
        readings.sort_by(f64::total_cmp);
        Self {
            readings,
            legs: spec.test.legs(),
            strain_step: spec.test.strain_step,
            max_strain: spec.test.max_strain,
        }
    }

    pub(super) fn leg(&self, place: Place) -> Leg {
        self.legs[place.leg]
    }

    pub(super) fn has_leg(&self, leg: usize) -> bool {
        leg < self.legs.len()
    }

    /// The force at which the leg ends, where it is one.
    pub(super) fn force(&self, place: Place) -> Option<f64> {
        match self.leg(place).target {
            Target::Strain(_) => None,
            Target::ForceN(force) => Some(force),
        }
    }

    /// Nominal strain at which the leg ends at the latest.
    pub(super) fn end(&self, place: Place) -> f64 {
        let leg = self.leg(place);
        match leg.target {
            Target::Strain(strain) => strain,
            Target::ForceN(_) if leg.unloads => 0.0,
            Target::ForceN(_) => self.max_strain,
        }
    }

    /// Nominal strain of a step of the leg: a product, because a sum would drift, and at most the end.
    pub(super) fn strain(&self, place: Place, step: u64) -> f64 {
        let way = (step - place.after_step) as f64 * self.strain_step;
        let end = self.end(place);
        // a hair before the end is the end: 0.1 must not be followed by 0.1 + 1e-17
        if self.leg(place).unloads {
            let strain = place.from - way;
            let is_end = strain < end + place.from * LAST_STEP_SLACK;
            if is_end { end } else { strain }
        } else {
            let strain = place.from + way;
            let is_end = strain > end * (1.0 - LAST_STEP_SLACK);
            if is_end { end } else { strain }
        }
    }

    /// Where the jaw rests next on its way from a strain to the end of its step: at the first strain between
    /// them at which the first pull is read, for the straight line from end to end is not the curve. One
    /// that is an end but for rounding is read there.
    pub(super) fn rest(&self, place: Place, from: f64, end: f64) -> f64 {
        if self.legs[..=place.leg].iter().any(|leg| leg.unloads) {
            return end;
        }
        let [after, before] = [
            from * (1.0 + LAST_STEP_SLACK),
            end * (1.0 - LAST_STEP_SLACK),
        ];
        let mut readings = self.readings.iter().copied();
        let between = readings.find(|strain| after < *strain && *strain < before);
        between.unwrap_or(end)
    }

    /// Whether a strain is one at which the first pull is read.
    pub(super) fn is_read(&self, place: Place, strain: f64) -> bool {
        let is_same = |reading: &f64| reading.total_cmp(&strain).is_eq();
        !self.leg(place).unloads && self.readings.iter().any(is_same)
    }

    /// Whether the leg comes to the one strain before it comes to the other.
    pub(super) fn is_before(&self, place: Place, one: f64, other: f64) -> bool {
        if self.leg(place).unloads {
            one > other
        } else {
            one < other
        }
    }

    /// Whether the force lies beyond that of the leg's end, the largest so far being `largest`, all
    /// in N.
    pub(super) fn is_force_beyond(&self, place: Place, force: f64, largest: f64) -> bool {
        self.beyond(place, force)
            .is_some_and(|beyond| beyond > precision(largest))
    }

    /// Whether the force is the one of the leg's end, or beyond it.
    pub(super) fn is_force_reached(&self, place: Place, force: f64, largest: f64) -> bool {
        self.beyond(place, force)
            .is_some_and(|beyond| beyond >= -precision(largest))
    }

    /// Whether the leg is at its end.
    pub(super) fn is_at_end(&self, place: Place, strain: f64, force: f64, largest: f64) -> bool {
        self.is_force_reached(place, force, largest)
            || !self.is_before(place, strain, self.end(place))
    }

    /// Whether `point`, the last of all, ends the leg and the cycle with it.
    pub(super) fn is_over(&self, place: Place, point: &Point, largest: f64) -> bool {
        let is_end = self.is_at_end(place, point.nominal_strain, point.force, largest);
        let next = self.legs.get(place.leg + 1);
        is_end && next.is_none_or(|next| next.cycle != point.cycle)
    }

    /// The part of the way between two states, of which the second is beyond the force of the leg's
    /// end, at which that force is to be looked for, after so many looks.
    pub(super) fn part(&self, place: Place, forces: [f64; 2], looks: u32) -> f64 {
        /// Nearest to an end: the secant of a bent curve would stay on one side for ever.
        const NEAREST: f64 = 0.01;
        let [before, after] = forces;
        let target = self.force(place).unwrap_or(after);
        let secant = (target - before) / (after - before);
        // every third look halves, whatever the curve is like
        if looks % 3 == 2 || !secant.is_finite() {
            0.5
        } else {
            secant.clamp(NEAREST, 1.0 - NEAREST)
        }
    }

    /// Whether the jaw does more than pull once.
    pub(super) fn turns(&self) -> bool {
        self.legs.len() > 1
    }

    /// Part of the way that is done where the leg has come to a strain: all legs count alike.
    pub(super) fn part_done(&self, place: Place, strain: f64) -> f64 {
        let way = self.end(place) - place.from;
        let part = if way == 0.0 {
            0.0
        } else {
            ((strain - place.from) / way).clamp(0.0, 1.0)
        };
        (place.leg as f64 + part) / self.legs.len() as f64
    }

    /// How far the force lies beyond that of the leg's end [N].
    fn beyond(&self, place: Place, force: f64) -> Option<f64> {
        let target = self.force(place)?;
        Some(if self.leg(place).unloads {
            target - force
        } else {
            force - target
        })
    }
}

fn precision(largest: f64) -> f64 {
    FORCE_PRECISION * largest
}

/// Nominal strain of a step of a pull without history.
pub(super) fn nominal_strain(spec: &NonwovenTensile, step: u64) -> f64 {
    let strain = step as f64 * spec.test.strain_step;
    if strain > spec.test.max_strain * (1.0 - LAST_STEP_SLACK) {
        spec.test.max_strain
    } else {
        strain
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;
    use loadframe_api::spec::nonwoven_tensile::Block;

    fn path(history: Vec<Block>) -> (Path, NonwovenTensile) {
        let loadframe_api::JobSpec::NonwovenTensile(mut spec) = crate::nonwoven::calibration_spec()
        else {
            panic!("the calibration pulls a nonwoven");
        };
        (spec.test.strain_step, spec.test.max_strain) = (0.1, 0.25);
        spec.test.history = history;
        (Path::new(&spec), *spec)
    }

    fn to_and_back(to: Target, back_to: Target) -> Vec<Block> {
        vec![Block {
            to,
            back_to: Some(back_to),
            repetitions: 1,
        }]
    }

    #[test]
    fn without_a_history_the_steps_are_multiples_to_the_largest_strain() {
        let (path, spec) = path(Vec::new());
        let place = Place::default();
        for step in 0..5 {
            assert_eq!(path.strain(place, step), nominal_strain(&spec, step));
        }
        assert_eq!(path.strain(place, 3), 0.25);
        assert!(path.is_at_end(place, 0.25, 0.0, 0.0));
    }

    #[test]
    fn the_jaw_rests_where_the_first_pull_is_read_between_steps() {
        let (_, mut spec) = path(Vec::new());
        spec.output.reading_strains = vec![0.17, 0.02, 0.05];
        let path = Path::new(&spec);
        let place = Place::default();
        let rest = |from, end| path.rest(place, from, end);
        assert_eq!(rest(0.0, 0.1), 0.02);
        assert_eq!(rest(0.02, 0.1), 0.05);
        // an end of a step is no place between, and neither is one that it misses by rounding
        assert_eq!(rest(0.05, 0.1), 0.1);
        assert_eq!(rest(0.05, 0.1 + 1e-16), 0.1 + 1e-16);
        assert_eq!(rest(0.1 - 1e-16, 0.15), 0.15);
        assert_eq!(rest(0.08, 0.12), 0.1);
        assert!(path.is_read(place, 0.17) && !path.is_read(place, 0.15));
    }

    #[test]
    fn a_pull_after_the_jaw_came_back_is_not_read() {
        let mut history = to_and_back(Target::Strain(0.05), Target::Strain(0.0));
        history.push(Block {
            to: Target::Strain(0.25),
            back_to: None,
            repetitions: 1,
        });
        let (path, _) = path(history);
        let again = Place {
            leg: 2,
            ..Place::default()
        };
        assert_eq!(path.rest(again, 0.08, 0.12), 0.12);
    }

    #[test]
    fn a_leg_back_starts_where_the_pull_ended_and_ends_at_its_strain() {
        let (path, _) = path(to_and_back(Target::Strain(0.25), Target::Strain(0.125)));
        let back = Place {
            leg: 1,
            from: 0.25,
            after_step: 3,
        };
        assert_eq!(path.strain(back, 4), 0.15);
        assert_eq!(path.strain(back, 5), 0.125);
        assert!(path.is_before(back, 0.2, 0.125));
        assert!(!path.is_at_end(back, 0.15, -1.0, 1.0));
        assert!(path.is_at_end(back, 0.125, 1.0, 1.0));
    }

    #[test]
    fn a_force_ends_a_leg_from_either_side() {
        let (path, _) = path(to_and_back(Target::ForceN(2.0), Target::ForceN(1.0)));
        let pull = Place::default();
        let back = Place { leg: 1, ..pull };
        assert!(!path.is_at_end(pull, 0.1, 1.9, 2.0));
        assert!(path.is_at_end(pull, 0.1, 2.0 - 1e-5, 2.0));
        assert!(path.is_force_beyond(pull, 2.1, 2.1) && !path.is_force_beyond(back, 2.1, 2.1));
        assert!(path.is_at_end(back, 0.1, 1.0 + 1e-5, 2.0));
        // halfway between 1.5 N and 2.5 N
        assert_eq!(path.part(pull, [1.5, 2.5], 0), 0.5);
        assert_eq!(path.part(pull, [1.0, 3.0], 0), 0.5);
        assert_eq!(path.part(back, [1.75, 0.75], 0), 0.75);
    }
}
