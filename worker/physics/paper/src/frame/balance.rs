//! Forces at the nodes of a network, and how well they balance.
use nalgebra::Vector3;

use super::element::{Element, Ends, PARTS};
use super::places::Jaw;

/// Displacement and rotation of every node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    pub(crate) nodes: Vec<[Vector3<f64>; 2]>,
}

impl Motion {
    pub(crate) fn rest(nodes: usize) -> Self {
        Self {
            nodes: vec![[Vector3::zeros(); 2]; nodes],
        }
    }

    pub(crate) fn ends(&self, element: &Element) -> Ends {
        let [first, second] = element.nodes.map(|node| self.nodes[node as usize]);
        [first[0], first[1], second[0], second[1]]
    }
}

/// What the elements do to the nodes, in one pass over them.
#[derive(Debug, Clone)]
pub(crate) struct Forces {
    /// Force and moment that must act on each node from outside.
    pub(crate) nodes: Vec<[Vector3<f64>; 2]>,
    /// Largest force of an element on a node, or its moment over the radius of gyration [mN].
    pub(crate) scale: f64,
    /// Largest stiffness times the largest displacement [mN]: round-off is a share of it.
    pub(crate) round_off: f64,
    /// ½ Σ c d² [nJ].
    pub(crate) energy: f64,
    /// Its share in what only keeps a truss in place.
    pub(crate) taut_energy: f64,
}

impl Forces {
    pub(crate) fn new(nodes: usize) -> Self {
        Self {
            nodes: vec![[Vector3::zeros(); 2]; nodes],
            scale: 0.0,
            round_off: 0.0,
            energy: 0.0,
            taut_energy: 0.0,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.nodes.fill([Vector3::zeros(); 2]);
        self.scale = 0.0;
        self.round_off = 0.0;
        self.energy = 0.0;
        self.taut_energy = 0.0;
    }

    /// Adds an element; gives its loads q.
    pub(crate) fn add(
        &mut self,
        element: &Element,
        motion: &Motion,
        gyration: f64,
    ) -> [f64; PARTS] {
        self.add_longer(element, motion, 0.0, gyration)
    }

    /// Adds an element that has become longer for good [µm]; gives its loads q.
    pub(crate) fn add_longer(
        &mut self,
        element: &Element,
        motion: &Motion,
        longer_um: f64,
        gyration: f64,
    ) -> [f64; PARTS] {
        let ends = motion.ends(element);
        let mut deformation = element.deformation(&ends);
        deformation[0] -= longer_um;
        let loads = element.loads(&deformation);
        self.energy += element.energy(&deformation);
        let forces = element.forces(&loads);
        self.add_ends(element.nodes, &forces, gyration);
        let farthest = ends[0].amax().max(ends[2].amax());
        self.round_off = self.round_off.max(element.stiffness[0] * farthest);
        loads
    }

    pub(crate) fn add_ends(&mut self, nodes: [u32; 2], forces: &Ends, gyration: f64) {
        for (end, node) in nodes.into_iter().enumerate() {
            let node = &mut self.nodes[node as usize];
            node[0] += forces[2 * end];
            node[1] += forces[2 * end + 1];
        }
        let moment = forces[1].amax().max(forces[3].amax());
        self.scale = self.scale.max(forces[2].amax()).max(moment / gyration);
    }

    /// Forces of the left and the right jaw along x, positive when they pull [mN], given the jaw of every node.
    pub(crate) fn at_jaws(&self, jaws: &[Option<Jaw>]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (jaw, [force, _]) in jaws.iter().zip(&self.nodes) {
            match jaw {
                Some(Jaw::Left) => sums[0] -= force.x,
                Some(Jaw::Right) => sums[1] += force.x,
                None => {}
            }
        }
        sums
    }
}
