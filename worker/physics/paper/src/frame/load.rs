//! The rest of a network under an elongation, and forces and moments at nodes.
use super::clusters::{Clusters, Standing};
use super::error::{FrameError, check};
use super::held::{Held, Means};
use super::input::NodeLoad;
use super::network::Network;

/// A network at rest under an elongation and loads.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// Displacement of each node [µm].
    pub displacement_um: Vec<[f64; 3]>,
    /// Rotation vector of each node [rad].
    pub rotation: Vec<[f64; 3]>,
    /// Force along x of the left and the right jaw, positive when it pulls [mN].
    pub jaw_force_mn: [f64; 2],
    /// Elastic energy [nJ].
    pub energy_nj: f64,
    /// Largest unbalanced force over the largest force.
    pub residual: f64,
    /// Solutions or iterations that it took.
    pub iterations: usize,
}

impl Network {
    /// Rest for small displacements: the right jaw goes by `elongation_um` along x, loads act.
    ///
    /// # Errors
    /// [`FrameError`] when a load is not on a held cluster or the network gives way.
    pub fn rest(&self, elongation_um: f64, loads: &[NodeLoad]) -> Result<Rest, FrameError> {
        self.rest_by(elongation_um, loads, &Means::default())
    }

    /// The same by the means that are given.
    ///
    /// # Errors
    /// As [`Network::rest`].
    pub fn rest_by(
        &self,
        elongation_um: f64,
        loads: &[NodeLoad],
        means: &Means,
    ) -> Result<Rest, FrameError> {
        self.check_loads(elongation_um, loads)?;
        if self.yields() {
            return Err(FrameError::Yields);
        }
        let pull = (elongation_um, loads);
        let none = (0.0, [].as_slice());
        let found = Held::new(self, Clusters::Held, pull, means, (&[], &[]), none)?;
        let nodes = &found.motion().nodes;
        let cost = found.cost();
        Ok(Rest {
            displacement_um: nodes.iter().map(|motion| motion[0].into()).collect(),
            rotation: nodes.iter().map(|motion| motion[1].into()).collect(),
            jaw_force_mn: found.forces().at_jaws(self.jaws()),
            energy_nj: found.forces().energy,
            residual: found.residual(),
            iterations: cost.iterations.max(cost.solutions),
        })
    }

    pub(crate) fn check_loads(
        &self,
        elongation_um: f64,
        loads: &[NodeLoad],
    ) -> Result<(), FrameError> {
        check(|| "elongation [um]".into(), elongation_um, true, "finite")?;
        for load in loads {
            let is_held = load.node < self.nodes() && self.standing(load.node) != Standing::Loose;
            check(
                || "node of a load".into(),
                load.node as f64,
                is_held,
                "a node of a cluster that a jaw holds",
            )?;
            for value in load.force_mn.into_iter().chain(load.moment_mn_um) {
                check(
                    || format!("load on node {}", load.node),
                    value,
                    true,
                    "finite",
                )?;
            }
        }
        Ok(())
    }
}
