//! The micromechanical spectrum: how the breaking of bonds spreads over force and strain, and in
//! which bursts it comes.
//!
//! Every breaking event is in `events.csv`, from which any other definition can be computed; the
//! tables here are the usual ones. With e for an event:
//!
//! - `breaking_by_force.csv`: events and released energy [N mm] in equal bins of the bond force
//!   at breaking [N], from the smallest to the largest;
//! - `breaking_by_strain.csv`: the same over nominal strain. A bin is a whole number of strain
//!   steps, because equal bins that cut through steps would hold now one, now two of them;
//! - `force_drops.csv`: for every step in which bonds broke, the jaw force after straining, the
//!   force once nothing breaks any more, and their difference, all at the same strain;
//! - `avalanches.csv`: in how many steps, and in how many rounds, exactly so many bonds broke. A
//!   round is what breaks at one equilibrium; the rounds of a step are one cascade.
//!
//! Source: the original definition of the spectrum is not available to us; these are our own.
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use loadframe_api::spec::nonwoven_tensile::{Breaking, NonwovenTensile};
use loadframe_harness::{Recorder, csv};

use super::{
    path::nominal_strain,
    state::{Event, Point, State},
};

/// Events between two bounds of what is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bin {
    lower: f64,
    upper: f64,
    bonds: u64,
    energy: f64,
}

impl Bin {
    fn between(lower: f64, upper: f64) -> Self {
        Self {
            lower,
            upper,
            ..Self::default()
        }
    }

    fn add(&mut self, event: &Event) {
        self.bonds += 1;
        self.energy += event.energy;
    }
}

/// Gives the tables to the recorder; none where bonds never break.
pub(super) fn write(
    spec: &NonwovenTensile,
    state: &State,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    if spec.test.breaking == Breaking::None {
        return Ok(());
    }
    let bins = spec.output.histogram_bins;
    recorder.file("breaking_by_force.csv", &mut |out| {
        write_bins(
            out,
            ["bin_lower_n", "bin_upper_n"],
            &by_force(&state.events, bins),
        )
    })?;
    recorder.file("breaking_by_strain.csv", &mut |out| {
        let columns = ["nominal_strain_from", "nominal_strain_to"];
        let strain = |step| nominal_strain(spec, step);
        let (events, last) = levels(spec, state);
        write_bins(out, columns, &by_strain(&events, last, bins, strain))
    })?;
    recorder.file("force_drops.csv", &mut |out| {
        force_drops(out, &state.points)
    })?;
    recorder.file("avalanches.csv", &mut |out| {
        csv::header(out, &["bonds", "steps", "rounds"])?;
        let sizes = avalanches(&state.events);
        let mut rows = sizes.iter();
        rows.try_for_each(|(bonds, [steps, rounds])| {
            csv::row(out, &[*bonds as f64, *steps as f64, *rounds as f64])
        })
    })
}

/// Equal bins of the force at breaking; an upper bound belongs to the last bin only. Equal forces
/// share one bin of no width.
fn by_force(events: &[Event], bins: u32) -> Vec<Bin> {
    let forces = || events.iter().map(|event| event.force);
    let lowest = forces().fold(f64::INFINITY, f64::min);
    let highest = forces().fold(f64::NEG_INFINITY, f64::max);
    if events.is_empty() {
        return Vec::new();
    }
    let bins = if lowest < highest { bins } else { 1 };
    let width = (highest - lowest) / f64::from(bins);
    let bound = |bin: u32| match bin == bins {
        true => highest,
        false => lowest + f64::from(bin) * width,
    };
    let empty = (0..bins).map(|bin| Bin::between(bound(bin), bound(bin + 1)));
    let mut histogram: Vec<Bin> = empty.collect();
    for event in events {
        // NaN for equal forces becomes bin 0
        let bin = ((event.force - lowest) / width) as usize;
        histogram[bin.min(bins as usize - 1)].add(event);
    }
    histogram
}

/// The events and the last step, by the steps of a pull without history to the same strain.
fn levels<'a>(spec: &NonwovenTensile, state: &'a State) -> (Cow<'a, [Event]>, u64) {
    if spec.test.history.is_empty() {
        return (Cow::Borrowed(&state.events), state.step);
    }
    let level = |strain: f64| {
        let below = (strain / spec.test.strain_step) as u64;
        let mut from_below = below.saturating_sub(1)..;
        let level = from_below.find(|step| nominal_strain(spec, *step) >= strain);
        level.unwrap_or(below)
    };
    let events = state.events.iter().map(|event| Event {
        step: level(event.nominal_strain),
        ..*event
    });
    (events.collect(), level(state.farthest))
}

/// Bins of equally many strain steps, the fewest that give no more than `bins` of them, from no
/// strain to that of step `last`; here the upper bound belongs to the bin. What breaks at step 0, without strain, is in the first bin.
fn by_strain(events: &[Event], last: u64, bins: u32, strain: impl Fn(u64) -> f64) -> Vec<Bin> {
    let steps_per_bin = last.div_ceil(u64::from(bins)).max(1);
    let count = last.div_ceil(steps_per_bin).max(1);
    let empty = (0..count).map(|bin| {
        let end = ((bin + 1) * steps_per_bin).min(last);
        Bin::between(strain(bin * steps_per_bin), strain(end))
    });
    let mut histogram: Vec<Bin> = empty.collect();
    for event in events {
        let bin = event.step.saturating_sub(1) / steps_per_bin;
        histogram[bin as usize].add(event);
    }
    histogram
}

fn write_bins(out: &mut dyn Write, bounds: [&str; 2], bins: &[Bin]) -> io::Result<()> {
    csv::header(
        out,
        &[bounds[0], bounds[1], "bonds", "energy_released_n_mm"],
    )?;
    let mut bins = bins.iter();
    bins.try_for_each(|bin| csv::row(out, &[bin.lower, bin.upper, bin.bonds as f64, bin.energy]))
}

fn force_drops(out: &mut dyn Write, points: &[Point]) -> io::Result<()> {
    let columns = [
        "step",
        "nominal_strain",
        "rounds",
        "bonds",
        "force_before_n",
        "force_after_n",
        "force_drop_n",
    ];
    csv::header(out, &columns)?;
    let mut broken_before = 0;
    // a step has a point for each fall that was found in it, and one at its end
    for point in points {
        let broken = point.broken - broken_before;
        broken_before = point.broken;
        if broken > 0 {
            let (before, after) = (point.force_before_breaking, point.force);
            let numbers = [
                point.step as f64,
                point.nominal_strain,
                f64::from(point.rounds),
                broken as f64,
                before,
                after,
                before - after,
            ];
            csv::row(out, &numbers)?;
        }
    }
    Ok(())
}

/// For each size that occurs, the steps and the rounds in which so many bonds broke.
fn avalanches(events: &[Event]) -> BTreeMap<usize, [u64; 2]> {
    let mut sizes = BTreeMap::<usize, [u64; 2]>::new();
    let steps = events.chunk_by(|one, next| one.step == next.step);
    for step in steps {
        sizes.entry(step.len()).or_default()[0] += 1;
        for round in step.chunk_by(|one, next| one.round == next.round) {
            sizes.entry(round.len()).or_default()[1] += 1;
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;

    fn event(step: u64, round: u32, force: f64) -> Event {
        Event {
            step,
            round,
            nominal_strain: step as f64 * 0.5,
            bond: 0,
            force,
            energy: 2.0 * force,
        }
    }

    fn counts(bins: &[Bin]) -> Vec<u64> {
        bins.iter().map(|bin| bin.bonds).collect()
    }

    #[test]
    fn forces_fall_into_equal_bins() {
        let events = [1.0, 2.0, 3.0, 3.5, 5.0].map(|force| event(1, 1, force));
        let bins = by_force(&events, 2);
        assert_eq!(counts(&bins), [2, 3]);
        assert_eq!(
            [bins[0].lower, bins[0].upper, bins[1].upper],
            [1.0, 3.0, 5.0]
        );
        assert_eq!([bins[0].energy, bins[1].energy], [6.0, 23.0]);
    }

    #[test]
    fn equal_forces_share_a_bin_and_no_events_have_none() {
        let bins = by_force(&[event(1, 1, 2.0), event(2, 1, 2.0)], 40);
        assert_eq!(
            (counts(&bins), bins[0].lower, bins[0].upper),
            (vec![2], 2.0, 2.0)
        );
        assert!(by_force(&[], 40).is_empty());
    }

    #[test]
    fn strain_bins_are_whole_numbers_of_steps() {
        let events = [0, 1, 3, 4, 6, 7].map(|step| event(step, 1, 1.0));
        let strain = |step: u64| step as f64 * 0.5;
        // 7 steps in at most 3 bins: 3 steps each, the last bin shorter
        let bins = by_strain(&events, 7, 3, strain);
        assert_eq!(counts(&bins), [3, 2, 1]);
        assert_eq!(
            bins.iter().map(|bin| bin.upper).collect::<Vec<_>>(),
            [1.5, 3.0, 3.5]
        );
        assert_eq!(counts(&by_strain(&events[..1], 0, 3, strain)), [1]);
    }

    #[test]
    fn avalanches_count_steps_and_rounds_of_each_size() {
        // step 1: rounds of 2 and 1; step 4: one round of 1; step 5: one round of 3
        let events = [(1, 1), (1, 1), (1, 2), (4, 1), (5, 1), (5, 1), (5, 1)];
        let sizes = avalanches(&events.map(|(step, round)| event(step, round, 1.0)));
        let expected = [(1, [1, 2]), (2, [0, 1]), (3, [2, 1])];
        assert_eq!(sizes, BTreeMap::from(expected));
    }
}
