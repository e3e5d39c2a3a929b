//! The cycles of a history: what a specimen takes, gives back and keeps.
//!
//! With W the work of the moving jaw, E the energy stored in the bonds and L the energy that went
//! where bonds broke (what was stored before the first of them broke at a strain, less what is stored
//! once none breaks there any more), a cycle is accounted for as
//!
//!   W_loaded − W_recovered = ΔE + L + rest (10).
//!
//! The bonds are elastic, so the rest is what steps and solver are off, and what went where the
//! network snapped from one fold to another without breaking.
use std::collections::BTreeSet;
use std::io::{self, Write};

use loadframe_api::spec::nonwoven_tensile::{NonwovenTensile, Target};
use loadframe_harness::{ReportBuilder, csv};

use super::{
    experiment::StopReason,
    path::Path,
    state::{Point, State},
};

/// Largest rest in (10) over the work of all pulls that goes without warning: the force error that
/// ISO 7500-1 allows a testing machine of class 1.
const LARGEST_REST: f64 = 0.01;
/// Part of the largest force below which a specimen counts as unloaded, that to which a force is found.
const NO_FORCE: f64 = 1e-5;
/// N mm in J.
const J: f64 = 1e-3;

/// A cycle that was begun. Energies in N mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycle {
    pub(super) number: u32,
    /// Where it began, turned and ended.
    start: Point,
    turn: Point,
    end: Point,
    /// Whether the jaw came back all the way it should.
    pub(super) is_whole: bool,
    /// Strain on the way back at which no force was left.
    residual_strain: Option<f64>,
}

impl Cycle {
    fn loaded(&self) -> f64 {
        self.turn.work - self.start.work
    }

    /// Unknown where the jaw never came back.
    fn recovered(&self) -> Option<f64> {
        self.end
            .is_unloading
            .then_some(self.turn.work - self.end.work)
    }

    fn released(&self) -> f64 {
        self.end.lost_energy - self.start.lost_energy
    }

    fn stored(&self) -> f64 {
        self.end.stored_energy - self.start.stored_energy
    }

    /// Force over strain from the start of the pull to its end [N]; no number where it never ended.
    fn secant(&self) -> f64 {
        if !self.is_whole {
            return f64::NAN;
        }
        (self.turn.force - self.start.force)
            / (self.turn.nominal_strain - self.start.nominal_strain)
    }
}

/// The cycles that were begun.
pub(super) fn all(spec: &NonwovenTensile, state: &State) -> Vec<Cycle> {
    let path = Path::new(spec);
    let no_force = NO_FORCE * state.max_force;
    let mut cycles = Vec::new();
    let Some(mut start) = state.points.first().copied() else {
        return cycles;
    };
    for points in state.points.chunk_by(|one, next| one.cycle == next.cycle) {
        let (Some(first), Some(end)) = (points.first(), points.last()) else {
            continue;
        };
        let pulls = points.iter().take_while(|point| !point.is_unloading);
        // a pull that was over before it began has no points
        let turn = pulls.last().copied().unwrap_or(start);
        let back: Vec<Point> = std::iter::once(turn)
            .chain(points.iter().copied().filter(|point| point.is_unloading))
            .collect();
        // what the jaws differ by is not known to be force
        let unknown = |point: &Point| no_force.max((point.force - point.bottom_force).abs());
        let unloaded = back
            .windows(2)
            .find(|pair| pair[1].force <= unknown(&pair[1]));
        let residual_strain = unloaded.map(|pair| {
            let [before, after] = [pair[0], pair[1]];
            if after.force >= -unknown(&after) || before.force <= after.force {
                return after.nominal_strain;
            }
            let part = before.force / (before.force - after.force);
            before.nominal_strain + part * (after.nominal_strain - before.nominal_strain)
        });
        let is_last = end.step == state.step;
        cycles.push(Cycle {
            number: first.cycle,
            start,
            turn,
            end: *end,
            is_whole: !is_last || path.is_over(state.place, end, state.max_force),
            residual_strain,
        });
        start = *end;
    }
    cycles
}

/// `loops.csv`.
pub(super) fn write(out: &mut dyn Write, cycles: &[Cycle]) -> io::Result<()> {
    let columns = [
        "cycle",
        "largest_strain",
        "force_at_largest_strain_n",
        "end_strain",
        "end_force_n",
        "residual_strain",
        "secant_stiffness_n",
        "energy_loaded_j",
        "energy_recovered_j",
        "energy_dissipated_j",
        "energy_released_by_breaking_j",
        "energy_kept_j",
        "broken_bonds",
    ];
    csv::header(out, &columns)?;
    for cycle in cycles {
        let recovered = cycle.recovered().unwrap_or(f64::NAN);
        let row = [
            f64::from(cycle.number),
            cycle.turn.nominal_strain,
            cycle.turn.force,
            cycle.end.nominal_strain,
            cycle.end.force,
            cycle.residual_strain.unwrap_or(f64::NAN),
            cycle.secant(),
            J * cycle.loaded(),
            J * recovered,
            J * (cycle.loaded() - recovered),
            J * cycle.released(),
            J * cycle.stored(),
            (cycle.end.broken - cycle.start.broken) as f64,
        ];
        csv::row(out, &row)?;
    }
    Ok(())
}

/// Results over all whole cycles, and whether (10) closes.
pub(super) fn report(
    report: &mut ReportBuilder,
    spec: &NonwovenTensile,
    state: &State,
    stop_reason: StopReason,
) {
    let begun = all(spec, state);
    let whole: Vec<&Cycle> = begun.iter().filter(|cycle| cycle.is_whole).collect();
    // a pull that nothing follows is no loop
    let loops = || whole.iter().filter(|cycle| cycle.end.is_unloading);
    let total = |part: &dyn Fn(&Cycle) -> f64| loops().map(|cycle| part(cycle)).sum::<f64>();
    let last = loops().next_back();
    report.count("cycles", whole.len(), "Cycles that were finished.");
    report.result(
        "residual_strain",
        last.and_then(|cycle| cycle.residual_strain),
        "1",
        "Nominal strain at which no force was left on the way back of the last finished cycle.",
    );
    report.result(
        "energy_loaded",
        J * total(&Cycle::loaded),
        "J",
        "Work of the moving jaw on all pulls of finished cycles that came back.",
    );
    report.result(
        "energy_recovered",
        J * total(&|cycle| cycle.recovered().unwrap_or(0.0)),
        "J",
        "Work that came back on their ways back.",
    );
    report.result(
        "energy_dissipated",
        J * total(&|cycle| cycle.loaded() - cycle.recovered().unwrap_or(0.0)),
        "J",
        "Area of their loops: loaded less recovered.",
    );
    report.result(
        "energy_released_by_breaking",
        J * total(&Cycle::released),
        "J",
        "Energy that went in them where bonds broke: stored before, less stored after, at one strain.",
    );
    for (name, cycle, which) in [
        ("first_cycle_stiffness", loops().next(), "first"),
        ("last_cycle_stiffness", last, "last finished"),
    ] {
        report.result(
            name,
            cycle.map(|cycle| cycle.secant()),
            "N",
            &format!("Force over nominal strain along the pull of the {which} cycle, end to end."),
        );
    }
    check_energy(report, state, begun.iter().map(Cycle::loaded).sum());
    warn(report, spec, state, &begun, stop_reason);
}

/// Of a single pull that nothing follows, whether (10) closes.
///
/// This sees a network that its equilibria leave where it happens to be, also where symmetry keeps the
/// forces on the jaws alike.
pub(super) fn check_pull(report: &mut ReportBuilder, state: &State) {
    let (first, points) = (state.points.first(), state.points.iter());
    let before = first.map_or(0.0, |first| first.stored_energy);
    let stored = points.map(|point| (point.stored_energy - before).abs());
    let work = state.points.last().map_or(0.0, |last| last.work);
    // a jaw that first holds a compressed network back has done little work, or none
    check_energy(report, state, stored.fold(work, f64::max));
}

/// Checks (10) against the work of all `pulls` [N mm].
fn check_energy(report: &mut ReportBuilder, state: &State, pulls: f64) {
    let (Some(first), Some(last)) = (state.points.first(), state.points.last()) else {
        return;
    };
    let rest = last.work - (last.stored_energy - first.stored_energy) - last.lost_energy;
    let relative = if rest == 0.0 { 0.0 } else { rest.abs() / pulls };
    report.check(
        "unaccounted_energy",
        relative,
        LARGEST_REST,
        "1",
        "Work of the jaw that is neither stored nor went where bonds broke, over the work of all \
         pulls.",
    );
    if report.failed("unaccounted_energy").is_some() {
        report.warn(
            "unaccounted_energy",
            format!(
                "{:.2} % of the work of all pulls is neither stored nor went where bonds broke: the \
                 network snaps from fold to fold, or steps are long; a smaller strain_step or a higher \
                 force_accuracy tells which",
                100.0 * relative
            ),
        );
    }
}

fn warn(
    report: &mut ReportBuilder,
    spec: &NonwovenTensile,
    state: &State,
    begun: &[Cycle],
    stop_reason: StopReason,
) {
    let legs = spec.test.legs();
    let asked = legs.last().map_or(0, |leg| leg.cycle);
    let leg = legs[state.place.leg];
    let whole = begun.iter().filter(|cycle| cycle.is_whole).count();
    // of a test that went all its way, what is not whole had no way to go
    let is_finished = stop_reason == StopReason::HistoryFinished;
    let passed = if is_finished { asked } else { leg.cycle };
    let known = begun.iter().filter(|cycle| cycle.is_whole || !is_finished);
    let known: BTreeSet<u32> = known.map(|cycle| cycle.number).collect();
    let skipped: Vec<u32> = (1..=passed)
        .filter(|cycle| !known.contains(cycle))
        .collect();
    if let Some(first) = skipped.first() {
        let block = legs.iter().find(|leg| leg.cycle == *first);
        report.warn(
            "cycles_skipped",
            format!(
                "{} of {asked} cycles had no way to go, the first of them cycle {first} in \
                 /test/history/{}: the specimen was beyond the force that ends each of their ways before \
                 it began",
                skipped.len(),
                block.map_or(0, |leg| leg.block)
            ),
        );
    }
    // a last pull to a strain that lies beyond rupture is how a test is ended
    let is_last_pull = state.place.leg + 1 == legs.len()
        && !leg.unloads
        && matches!(leg.target, Target::Strain(_));
    if !is_finished && whole + skipped.len() < asked as usize && !is_last_pull {
        report.warn(
            "history_not_finished",
            format!(
                "the test ended in cycle {} of {asked}, in /test/history/{}: {whole} were \
                 finished; later ones would need a specimen that holds, or a larger max_strain",
                leg.cycle, leg.block
            ),
        );
    }
}
