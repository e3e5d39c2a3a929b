//! Four ways from displacements that are not in equilibrium to displacements that are.
//!
//! Equilibrium means that the resultant of every free node is within
//! F_lim = (e ε + f_r ε²)/A_cc (8) of [Zilka2022] eq. 3-4, or within what rounding alone explains. Bonds
//! are all alike there; where they differ, e and f_r are those of the softest.
//!
//! - [`newton_cg`] descends the energy of the whole network (default), its steps found by
//!   [`conjugate_gradients`] with [`block_jacobi`] for short waves and [`multigrid`] for long ones,
//!   the worst [`neighbourhoods`] first, by way of easier problems where it takes long
//!   ([`continuation`]);
//! - [`sequential`] moves node after node into its own balance, the thesis' relaxation;
//! - [`parallel`] computes all moves before it makes any, the thesis' variant;
//! - [`descent`] moves node after node against the gradient of the magnitude of its resultant, which the
//!   thesis tried and dropped.
//!
//! Which of them, and where it ends, says a [`Search`]; [`Settled`] is where it ended.
//!
//! The relaxations stop on the same limit, yet their error is larger: what they leave are long
//! waves with tiny resultants. The difference of the two jaw forces shows it.
mod block_jacobi;
mod conjugate_gradients;
mod continuation;
mod descent;
mod forcing;
mod line_search;
mod multigrid;
mod neighbourhoods;
mod newton_cg;
mod node_step;
mod parallel;
mod search;
mod sequential;
pub(crate) mod work;
mod workspace;

use loadframe_harness::Interrupt;
use loadframe_numerics::Team;

use super::{Vector, assembly::Assembly};
pub(crate) use neighbourhoods::calm;
pub(crate) use search::{Descent, Gradient, Method, Search, Settled};
use work::Meter;
pub(crate) use workspace::Workspace;

impl Search {
    /// Moves the free nodes of `assembly` from `displacements` of all nodes of its network towards
    /// equilibrium. A search that does not get there says so in the verdict of its residual.
    ///
    /// # Errors
    /// The interrupt that ended it early.
    pub(crate) fn run(
        &self,
        assembly: &Assembly,
        displacements: &[Vector],
        team: &Team,
        workspace: &mut Workspace,
        meter: &mut Meter<'_>,
    ) -> Result<Settled, Interrupt> {
        meter.work.equilibria += 1;
        match self.method {
            Method::NewtonCg if assembly.strips.count() > 1 => team.gather(|| {
                continuation::solve(self, assembly, displacements, team, workspace, meter)
            }),
            Method::NewtonCg => {
                continuation::solve(self, assembly, displacements, team, workspace, meter)
            }
            Method::Sequential => {
                let start = assembly.pick(displacements);
                let end = sequential::solve(self, assembly, start, meter)?;
                self.relaxed(assembly, &end, team, workspace, meter)
            }
            Method::Descent(descent) => {
                let start = assembly.pick(displacements);
                let end = descent::solve(self, descent, assembly, start, meter)?;
                self.relaxed(assembly, &end, team, workspace, meter)
            }
            Method::Parallel { relaxation_factor } => {
                let start = assembly.pick(displacements);
                let end = parallel::solve(self, relaxation_factor, assembly, start, team, meter)?;
                self.relaxed(assembly, &end, team, workspace, meter)
            }
        }
    }

    /// Where a relaxation ended with these displacements of every place.
    fn relaxed(
        &self,
        assembly: &Assembly,
        displacements: &[Vector],
        team: &Team,
        workspace: &mut Workspace,
        meter: &mut Meter<'_>,
    ) -> Result<Settled, Interrupt> {
        meter.spend(assembly.bonds())?;
        let configuration = workspace.at(assembly, displacements, team);
        let residual = configuration.residual(assembly, self.force_limit);
        Ok(Settled {
            configuration,
            residual,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Bonds, Laws, Network,
        boundary::{BOTTOM, Set, TOP},
        configuration::Verdict,
        law::BondLaw,
        load_path::parts,
        sample::{assembled, squares, stretch},
    };
    use loadframe_harness::{SimulationError, Uninterrupted};

    /// The mechanism found in a node just beside the line between two jaws 10 mm apart, not moved
    /// from there, between bonds of this rest length.
    fn mechanism(rest_length: f64) -> Result<Option<usize>, SimulationError> {
        let law = BondLaw {
            modulus: 1.0,
            friction_modulus: 0.0,
            compression_stiffness: 1.0,
        };
        let network = Network {
            positions: vec![
                Vector::zeros(),
                Vector::new(0.1, 5.0, 0.0),
                Vector::new(0.0, 10.0, 0.0),
            ],
            holds: vec![Some(BOTTOM), None, Some(TOP)],
            bonds: Bonds {
                ends: vec![[0, 1], [1, 2]],
                rest_lengths: vec![rest_length; 2],
                laws: Laws::Same(law),
                strengths: vec![f64::INFINITY; 2],
            },
            sets: Set::jaws(),
            rows: Vec::new(),
        };
        let intact = [true; 2];
        let mut assembly = Assembly::new(&network);
        assembly.load(&network, &intact, &parts(&network, &intact));
        let search = Search {
            method: Method::NewtonCg,
            iteration_limit: 0,
            force_limit: 1e-6,
            step_cap: 1.0,
            calm: calm(1e4),
        };
        let start = vec![Vector::zeros(); 3];
        let mut meter = Meter::new(work::Work::default(), &Uninterrupted);
        let settled = search
            .run(
                &assembly,
                &start,
                &Team::new(1)?,
                &mut Workspace::default(),
                &mut meter,
            )
            .expect("nothing interrupts");
        Ok(settled.mechanism(&assembly))
    }

    #[test]
    fn a_node_that_compressed_bonds_push_aside_is_a_mechanism() -> Result<(), SimulationError> {
        assert_eq!(mechanism(8.0)?, Some(1));
        Ok(())
    }

    #[test]
    fn a_node_that_stretched_bonds_pull_back_is_not() -> Result<(), SimulationError> {
        assert_eq!(mechanism(4.0)?, None);
        Ok(())
    }

    #[test]
    fn memory_does_not_grow_from_equilibrium_to_equilibrium() -> Result<(), SimulationError> {
        let mut network = squares(4);
        stretch(&mut network, 0.9);
        let assembly = assembled(&network);
        let team = Team::new(1)?;
        let start = vec![Vector::zeros(); network.positions.len()];
        let methods = [
            Method::NewtonCg,
            Method::Sequential,
            Method::Parallel {
                relaxation_factor: 0.3,
            },
            Method::Descent(Descent {
                gradient: Gradient::Exact,
                step: None,
                is_adaptive: true,
            }),
        ];
        for method in methods {
            let search = Search {
                method,
                iteration_limit: 1000,
                force_limit: 1e-6,
                step_cap: 1.0,
                calm: calm(1e4),
            };
            let mut workspace = Workspace::default();
            let mut meter = Meter::new(work::Work::default(), &Uninterrupted);
            let mut spare = Vec::new();
            for _ in 0..3 {
                let settled = search
                    .run(&assembly, &start, &team, &mut workspace, &mut meter)
                    .expect("nothing interrupts");
                // descents are slow: that they arrive is tested elsewhere
                if !matches!(method, Method::Descent(_)) {
                    assert_eq!(settled.residual.verdict, Verdict::Balanced);
                }
                workspace.take_back(settled);
                spare.push(workspace.spare.len());
            }
            assert_eq!(spare, [spare[0]; 3], "{method:?}");
        }
        Ok(())
    }
}
