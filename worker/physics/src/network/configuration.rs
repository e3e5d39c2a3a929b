//! An assembly at some displacements: energy, bond states, resultants.
use super::{
    Vector,
    assembly::{Assembly, BondState},
};
use crate::parallel::Team;

/// What follows from the displacements of an assembly's nodes.
#[derive(Clone, Debug)]
pub(crate) struct Configuration {
    /// Of every node [mm]; those of held nodes are given.
    pub(crate) displacements: Vec<Vector>,
    /// E [N mm].
    pub(crate) energy: f64,
    pub(crate) bonds: Vec<BondState>,
    /// Sum of the bond forces on every node [N], held ones included.
    pub(crate) resultants: Vec<Vector>,
}

/// Roundings that separate a computed resultant from the exact one, in units of the machine
/// precision times the sum of what was rounded: about two for each bond's displacements, two for
/// its force, one for the sum.
const ROUNDINGS: f64 = 8.0;

/// How far an assembly is from equilibrium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    /// Largest resultant of a free node [N].
    pub(crate) largest: f64,
    /// The free node it acts on.
    pub(crate) node: usize,
    pub(crate) verdict: Verdict,
}

/// What a [`Residual`] means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Every resultant is within the limit.
    Balanced,
    /// Some exceed the limit, but only by what rounding alone explains: no arithmetic of this
    /// precision gets closer.
    RoundOff,
    Unbalanced,
}

impl Configuration {
    /// The assembly at `displacements`.
    pub(crate) fn new(assembly: &Assembly, displacements: Vec<Vector>, team: &Team) -> Self {
        let unset = BondState {
            direction: Vector::zeros(),
            tension: 0.0,
            axial: 0.0,
            transverse: 0.0,
        };
        let mut configuration = Self {
            displacements,
            energy: 0.0,
            bonds: vec![unset; assembly.bonds.len()],
            resultants: vec![Vector::zeros(); assembly.nodes()],
        };
        configuration.update(assembly, team);
        configuration
    }

    /// Makes everything follow the displacements, (4)-(7).
    pub(crate) fn update(&mut self, assembly: &Assembly, team: &Team) {
        let displacements = &self.displacements;
        self.energy = team.fill(&mut self.bonds, |start, states| {
            let mut energy = 0.0;
            for (offset, state) in states.iter_mut().enumerate() {
                let bond = start + offset;
                let shift = assembly.shift(bond, displacements);
                let (response, stored) = assembly.shapes[bond].respond(&shift);
                *state = response;
                energy += stored;
            }
            energy
        });
        let bonds = &self.bonds;
        assembly.sum_over_bonds(team, &mut self.resultants, |bond| {
            bonds[bond].direction * bonds[bond].tension
        });
    }

    /// H p for nodal vectors p (7), with every transverse stiffness b raised to at least
    /// `least_transverse`: 0 drops the part that makes H indefinite. p must vanish at held nodes.
    pub(crate) fn multiply(
        &self,
        assembly: &Assembly,
        team: &Team,
        least_transverse: f64,
        vector: &[Vector],
        product: &mut [Vector],
    ) {
        assembly.sum_over_bonds(team, product, |bond| {
            let state = &self.bonds[bond];
            let [first, second] = assembly.ends[bond];
            let apart = vector[first as usize] - vector[second as usize];
            let transverse = state.transverse.max(least_transverse);
            let along = (state.axial - transverse) * state.direction.dot(&apart);
            apart * transverse + state.direction * along
        });
    }

    /// The largest resultant, and whether `force_limit` [N] or round-off bounds all of them.
    pub(crate) fn residual(&self, assembly: &Assembly, force_limit: f64) -> Residual {
        let mut largest = 0.0;
        let mut node = 0;
        for (index, resultant) in self.resultants[..assembly.free()].iter().enumerate() {
            let magnitude = resultant.norm();
            // a NaN must not pass for a balanced node
            if magnitude > largest || magnitude.is_nan() {
                (largest, node) = (magnitude, index);
            }
        }
        let verdict = if largest <= force_limit {
            Verdict::Balanced
        } else if self.is_within_round_off(assembly, force_limit, node) {
            Verdict::RoundOff
        } else {
            Verdict::Unbalanced
        };
        Residual {
            largest,
            node,
            verdict,
        }
    }

    /// Whether every resultant beyond the limit, the one of node `worst` above all, is within the
    /// rounding error of its bonds.
    fn is_within_round_off(&self, assembly: &Assembly, force_limit: f64, worst: usize) -> bool {
        // far from equilibrium the worst node alone answers, at little cost
        let of_worst = |bond: &usize| assembly.ends[*bond].contains(&(worst as u32));
        let bonds = 0..self.bonds.len();
        let rounding: f64 = bonds
            .clone()
            .filter(of_worst)
            .map(|bond| self.round_off(assembly, bond))
            .sum();
        let is_beyond = |node: usize, rounding: f64| {
            let resultant = self.resultants[node].norm();
            resultant > force_limit.max(rounding) || resultant.is_nan()
        };
        if is_beyond(worst, rounding) {
            return false;
        }
        let mut roundings = vec![0.0; assembly.nodes()];
        for bond in bonds {
            for node in assembly.ends[bond] {
                roundings[node as usize] += self.round_off(assembly, bond);
            }
        }
        (0..assembly.free()).all(|node| !is_beyond(node, roundings[node]))
    }

    fn round_off(&self, assembly: &Assembly, bond: usize) -> f64 {
        let [first, second] = assembly.ends[bond].map(|node| self.displacements[node as usize]);
        self.bonds[bond].round_off(first.amax() + second.amax())
    }
}

impl BondState {
    /// Error of the bond's force by rounding [N], its ends having moved by `moved` [mm] together.
    pub(crate) fn round_off(&self, moved: f64) -> f64 {
        let stiffness = self.axial.max(self.transverse.abs());
        ROUNDINGS * f64::EPSILON * (self.tension.abs() + stiffness * moved)
    }
}

impl Assembly {
    /// Sets every node's entry to the sum of `force(bond)` over the bonds it is the first end of,
    /// less the sum over those it is the second end of, both in ascending order.
    fn sum_over_bonds(
        &self,
        team: &Team,
        sums: &mut [Vector],
        force: impl Fn(usize) -> Vector + Sync,
    ) {
        if !team.is_parallel() {
            sums.fill(Vector::zeros());
            for (bond, [first, second]) in self.ends.iter().enumerate() {
                let force = force(bond);
                sums[*first as usize] += force;
                sums[*second as usize] -= force;
            }
            return;
        }
        // each bond is computed at both its ends, so that no two threads write to one node
        let incidence = self.incidence();
        team.fill(sums, |start, sums| {
            for (offset, sum) in sums.iter_mut().enumerate() {
                let node = start + offset;
                *sum = Vector::zeros();
                for bond in incidence.of(node) {
                    let bond = *bond as usize;
                    if self.ends[bond][0] as usize == node {
                        *sum += force(bond);
                    } else {
                        *sum -= force(bond);
                    }
                }
            }
            0.0
        });
    }
}
