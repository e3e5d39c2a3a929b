//! What equilibria of one assembly hand on to each other.
use loadframe_numerics::Team;

use super::{Settled, newton_cg::Memory};
use crate::{
    Vector,
    assembly::Assembly,
    configuration::{Configuration, energy_at},
    field::Field,
};

/// Memory that equilibria of one assembly use one after the other.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(super) memory: Option<Memory<f32>>,
    /// The start of the next equilibrium, if it is known already.
    pub(super) start: Option<Configuration>,
    pub(super) spare: Vec<Configuration>,
    /// Displacements of a guess.
    guess: Field<f64>,
}

impl Workspace {
    /// Takes back the memory of an equilibrium that is not needed any more.
    pub(crate) fn take_back(&mut self, settled: Settled) {
        self.spare.push(settled.configuration);
    }

    /// The next equilibrium must be searched from the `last` one, less the bonds that act no more.
    pub(crate) fn go_on(&mut self, assembly: &Assembly, last: Configuration) {
        let mut start = last;
        start.let_go(assembly);
        self.start = Some(start);
    }

    /// Whether the first of two guesses of the displacements of every node of the network has less
    /// energy than the second. The next equilibrium must be searched from the one that has less.
    pub(crate) fn choose(
        &mut self,
        assembly: &Assembly,
        guesses: [&[Vector]; 2],
        team: &Team,
    ) -> bool {
        let mut chosen = self.configuration(assembly, guesses[0], team);
        let mut second = std::mem::take(&mut self.guess);
        second.resize(assembly.places(), assembly.dimensions());
        assembly.pick_into(guesses[1], &mut second);
        let is_first = chosen.energy < energy_at(assembly, &second, team);
        if !is_first {
            std::mem::swap(&mut chosen.displacements, &mut second);
            chosen.update(assembly, team);
        }
        self.start = Some(chosen);
        self.guess = second;
        is_first
    }

    /// The assembly at these displacements of its places.
    pub(super) fn at(
        &mut self,
        assembly: &Assembly,
        displacements: &[Vector],
        team: &Team,
    ) -> Configuration {
        let displacements = Field::of(displacements, assembly.dimensions());
        let Some(mut configuration) = self.spare.pop() else {
            return Configuration::new(assembly, displacements, team);
        };
        configuration.displacements = displacements;
        configuration.update(assembly, team);
        configuration
    }

    /// The network at `displacements`.
    pub(super) fn configuration(
        &mut self,
        assembly: &Assembly,
        displacements: &[Vector],
        team: &Team,
    ) -> Configuration {
        let Some(mut configuration) = self.spare.pop() else {
            return Configuration::of(assembly, displacements, team);
        };
        assembly.pick_into(displacements, &mut configuration.displacements);
        configuration.update(assembly, team);
        configuration
    }
}
