//! Where the nodes are and how they are turned.
use nalgebra::{UnitQuaternion, Vector3};

use super::super::network::Network;

/// Positions [µm] and rotations of all nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) turns: Vec<UnitQuaternion<f64>>,
}

impl Shape {
    /// As built.
    pub(crate) fn of(network: &Network) -> Self {
        Self {
            positions: network.positions().to_vec(),
            turns: vec![UnitQuaternion::identity(); network.nodes()],
        }
    }

    /// Moves a node by a displacement and turns it by a rotation vector, both in the frame of the lab.
    pub(crate) fn step(&mut self, node: usize, shift: Vector3<f64>, turn: Vector3<f64>) {
        self.positions[node] += shift;
        let turned = UnitQuaternion::from_scaled_axis(turn) * self.turns[node];
        // a product of many drifts off the unit sphere by round-off
        self.turns[node] = UnitQuaternion::new_normalize(turned.into_inner());
    }
}
