//! Lateral contraction of the specimen.
use crate::{Network, Vector};

/// What the width strain is read from.
#[derive(Clone, Debug)]
pub(super) enum WidthGauge {
    /// End nodes of the rows in the middle third of a lattice, in every layer, and the sum of
    /// their initial distances along x [mm].
    Rows { ends: Vec<[u32; 2]>, initial: f64 },
    /// Free nodes of a network that lie in the middle third of the gauge length: x less the mean
    /// of x, and the sum of its squares.
    Slope {
        lever_arms: Vec<(u32, f64)>,
        square_sum: f64,
    },
}

impl WidthGauge {
    /// ε_x = mean width of the rows over mean initial width − 1 (11).
    ///
    /// Source: [Zilka2022] section 1.2.1 with the reading of the width as the mean end-to-end width
    /// of the rows in the middle third over all layers.
    pub(super) fn rows(positions: &[Vector], ends: Vec<[u32; 2]>) -> Option<Self> {
        let initial: f64 = ends.iter().map(|ends| along_x(positions, *ends)).sum();
        (initial > 0.0).then_some(Self::Rows { ends, initial })
    }

    /// ε_x = least-squares slope of the displacement along x against initial x (12), which needs no
    /// edges. `None` when the nodes do not spread along x.
    pub(super) fn slope(network: &Network, bottom: f64, gauge_length: f64) -> Option<Self> {
        let middle = bottom + gauge_length / 3.0..=bottom + gauge_length * (2.0 / 3.0);
        let is_inside = |node: &usize| {
            network.holds[*node].is_none() && middle.contains(&network.positions[*node].y)
        };
        let nodes: Vec<usize> = (0..network.positions.len()).filter(is_inside).collect();
        let sum: f64 = nodes.iter().map(|node| network.positions[*node].x).sum();
        let centre = sum / nodes.len() as f64;
        let lever_arm = |node: &usize| (*node as u32, network.positions[*node].x - centre);
        let lever_arms: Vec<(u32, f64)> = nodes.iter().map(lever_arm).collect();
        let square_sum: f64 = lever_arms.iter().map(|(_, arm)| arm * arm).sum();
        (square_sum > 0.0).then_some(Self::Slope {
            lever_arms,
            square_sum,
        })
    }

    /// ε_x [-] for these displacements of all nodes.
    pub(super) fn strain(&self, displacements: &[Vector]) -> f64 {
        match self {
            Self::Rows { ends, initial } => {
                let widening = ends.iter().map(|ends| along_x(displacements, *ends));
                widening.sum::<f64>() / initial
            }
            Self::Slope {
                lever_arms,
                square_sum,
            } => {
                let moments = lever_arms.iter();
                let moments = moments.map(|(node, arm)| arm * displacements[*node as usize].x);
                moments.sum::<f64>() / square_sum
            }
        }
    }
}

fn along_x(vectors: &[Vector], [first, last]: [u32; 2]) -> f64 {
    vectors[last as usize].x - vectors[first as usize].x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bonds;
    use crate::boundary::Set;

    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn rows_are_averaged_over_their_common_width() {
        let at = |x| Vector::new(x, 0.0, 0.0);
        let positions = [at(0.0), at(10.0), at(0.0), at(20.0)];
        let gauge = WidthGauge::rows(&positions, vec![[0, 1], [2, 3]]).expect("rows have width");
        let strain = gauge.strain(&[at(0.5), at(0.0), at(0.0), at(-1.0)]);
        assert!((strain - (9.5 + 19.0 - 30.0) / 30.0).abs() < ROUND_OFF);
    }

    #[test]
    fn a_uniform_contraction_has_its_own_slope() {
        let positions = [0.0, 1.0, 4.0, 2.0].map(|x| Vector::new(x, 1.5, 0.0));
        let network = Network {
            positions: positions.to_vec(),
            holds: vec![None; 4],
            bonds: Bonds::default(),
            sets: Set::jaws(),
            rows: Vec::new(),
        };
        let gauge = WidthGauge::slope(&network, 0.0, 3.0).expect("nodes spread along x");
        let displacements = positions.map(|p| Vector::new(3.0 - 0.2 * p.x, p.x, 0.0));
        assert!((gauge.strain(&displacements) + 0.2).abs() < ROUND_OFF);
    }

    #[test]
    fn a_single_file_of_nodes_has_no_width() {
        let positions = vec![Vector::zeros(), Vector::new(0.0, 1.0, 0.0)];
        assert!(WidthGauge::rows(&positions, vec![[0, 0], [1, 1]]).is_none());
        let network = Network {
            positions,
            holds: vec![None; 2],
            bonds: Bonds::default(),
            sets: Set::jaws(),
            rows: Vec::new(),
        };
        assert!(WidthGauge::slope(&network, -1.0, 3.0).is_none());
    }
}
