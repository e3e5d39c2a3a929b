//! Where a break begins: strains between one at which no bond is over its strength and one at which
//! some are.
use loadframe_numerics::{Crossing, next_look};

use super::{Advance, Experiment, Loaded};
use crate::{
    Vector,
    equilibrium::Workspace,
    law::StrainLaw,
    nonwoven::state::{Point, Reached, Unresolved},
    rupture::Candidate,
};

/// Part of the maximum force by which a fall of the force may be overstepped without a warning, as the force
/// error that ISO 7500-1 allows a testing machine of class 1.
pub(crate) const LARGEST_OVERSTEP: f64 = 0.01;
/// Strains tried at most to find a break. Halving alone brings an interval to the last digits by then.
const MOST_LOOKS: u32 = 150;
/// Where the network snaps, forces jump at one strain and no division brings them nearer to each other:
/// a break is then placed to this part of the precision, of its strain.
const NARROW: f64 = 0.01;
/// Of bonds that are slack before the test two estimates of how far the force went on past a break differ by
/// the bend of their law, far less than this; of taut ones by any factor.
const BENT: f64 = 2.0;
/// Least part of the strain step that is looked at.
const SHORTEST: f64 = 1e-12;

impl Experiment<'_> {
    /// Part of the maximum force by which it must fall for the break to be looked for.
    fn smallest_fall(&self) -> f64 {
        self.knobs.break_precision.unwrap_or(LARGEST_OVERSTEP)
    }

    /// Whether the force, found after bonds broke that may be too far over their strength, shows that
    /// the break should have been found first.
    pub(super) fn has_fallen(&self, force: f64) -> bool {
        let before = self.state.before_breaking.map_or(0.0, |point| point.force);
        self.state.retreat.is_some() && self.is_fall(before, force)
    }

    fn is_fall(&self, before: f64, after: f64) -> bool {
        before - after > self.smallest_fall() * self.state.max_force.max(before)
    }

    /// Whether these bonds may break here: they are hardly over their strength, or there is nothing
    /// left to divide between here and the last state in which they were not.
    ///
    /// `before` are the displacements of that state. The force is taken to have grown with the tension of
    /// each bond over its strength. A bond that was taut before the test grows by hardly anything while the
    /// force rises: where the straight line from that state to this one, i being the index of the bond
    /// (tension over strength),
    ///
    ///   |F − F_r| (i − 1)/(i − i_r) (13),
    ///
    /// tells far more, it counts instead, and must be within the precision too. The bond for which the force
    /// went on farthest decides: it need not be the one that is farthest over its strength.
    pub(super) fn is_resolved(
        &mut self,
        over: &[Candidate],
        force: f64,
        before: &[Vector],
    ) -> bool {
        if over.is_empty() {
            return true;
        }
        let rise = (force - self.state.reached.force).abs();
        let (mut largest, mut excess_of_all, mut on_lines) = (0.0_f64, 0.0_f64, 0.0_f64);
        for candidate in over {
            let index = candidate.index();
            let excess = (1.0 - index.recip()) * force.abs();
            let way = index - self.index_of(candidate.bond, before);
            let on_line = rise * (index - 1.0) / way;
            // no bond is over its strength at the last state; the first has none before it
            if way > 0.0 && on_line > BENT * excess {
                on_lines = on_lines.max(on_line.min(rise));
            } else {
                excess_of_all = excess_of_all.max(excess.min(rise));
            }
            largest = largest.max(index);
        }
        self.state.overstep = on_lines.max(excess_of_all);
        let Some(precision) = self.knobs.break_precision else {
            return true;
        };
        let search = self.state.search.as_ref();
        let most = precision * self.state.max_force.max(force);
        let is_close = on_lines <= most;
        (largest <= 1.0 + precision && is_close)
            || search.is_some_and(|search| search.looks >= MOST_LOOKS)
            || self.is_indivisible(self.state.strain, force)
    }

    /// Whether nothing is gained by dividing what lies between the last state in which no bond was over
    /// its strength and this one.
    fn is_indivisible(&self, strain: f64, force: f64) -> bool {
        let (reached, precision) = (self.state.reached, self.smallest_fall());
        let width = (strain - reached.strain).abs();
        let rise = (force - reached.force).abs();
        let is_close = rise <= precision * self.state.max_force.max(force);
        (is_close && width <= precision * strain)
            || width <= NARROW * precision * strain
            || width <= SHORTEST * self.spec.test.strain_step
    }

    /// Goes back to the last state in which no bond was over its strength, and chooses a strain on the
    /// way to the one where some were.
    pub(super) fn retreat(&mut self) -> Advance {
        let state = &mut self.state;
        let Some(retreat) = state.retreat.take() else {
            return Advance::GoesOn;
        };
        state.displacements = retreat.displacements;
        state.worst_of_step = retreat.worst_of_step;
        state.search = Some(retreat.search);
        if state.round > state.rounds_before {
            state.events.truncate(retreat.events);
            state.round = state.rounds_before;
            self.settled = None;
            self.workspace = Workspace::default();
            let network = &self.specimen.network;
            let (intact, broken) = state.intact(network.bonds.len());
            self.loaded = Loaded::new(network, intact);
            if !broken.is_empty() {
                self.loaded.follow(network, broken);
            }
        }
        self.look_between();
        Advance::GoesOn
    }

    /// Chooses a strain between the last state in which no bond was over its strength and the first
    /// known in which some were.
    pub(super) fn look_between(&mut self) {
        let reached = self.state.reached.strain;
        let Some(mut search) = self.state.search.take() else {
            return;
        };
        let crossings: Vec<Crossing> = search
            .over
            .iter()
            .map(|(bond, index)| Crossing {
                before: self.index_of(*bond as usize, &self.state.displacements),
                after: *index,
            })
            .collect();
        let part = next_look(&crossings, self.smallest_fall(), search.looks);
        search.looks += 1;
        self.state.strain = reached + part * (search.strain - reached);
        if self.is_indivisible(search.strain, search.force) {
            // bonds break where they are known to
            search.looks = MOST_LOOKS;
            self.state.strain = search.strain;
        }
        self.state.search = Some(search);
    }

    /// Tension over strength of a bond at these displacements.
    fn index_of(&self, bond: usize, displacements: &[Vector]) -> f64 {
        let network = &self.specimen.network;
        let bonds = &network.bonds;
        let [first, second] = bonds.ends[bond]
            .map(|node| network.positions[node as usize] + displacements[node as usize]);
        let rest = bonds.rest_lengths[bond];
        let strain = ((second - first).norm() - rest) / rest;
        bonds.laws.of(bond).tension(strain) / bonds.strengths[bond]
    }

    /// Nothing is over its strength here any more.
    pub(super) fn reach(&mut self, force: f64) {
        self.state.reached = Reached {
            strain: self.state.strain,
            force,
        };
    }

    /// Keeps the state before a fall of the force that ends in `after`, if it is one.
    pub(super) fn record_fall(&mut self, after: &Point) -> bool {
        let Some(before) = self.state.before_breaking.filter(|_| !self.is_first()) else {
            return false;
        };
        if !self.is_fall(before.force, after.force) {
            return false;
        }
        let force = self.state.overstep.min(before.force - after.force);
        let state = &mut self.state;
        if state.unresolved.is_none_or(|worst| force > worst.force) {
            state.unresolved = Some(Unresolved {
                nominal_strain: state.strain,
                force,
            });
        }
        if self.knobs.break_precision.is_some() {
            self.record(before);
        }
        true
    }
}
