//! What equilibrium is found of, whatever it joins: sums of springs.
//!
//! A spring feels one combination of the motions of nodes, d = bᵀu, and pulls on them with c d b. A beam, a bar or
//! a bond of these is six springs between two nodes ([`Element`]); parts of tubes are springs over the points of rings
//! ([`PointSprings`]).
use std::borrow::Cow;

use super::balance::{Forces, Motion};
use super::element::{Element, Matrix12, PARTS};
use super::factor::Factor;
use super::network::Network;
use super::tubes::PointSprings;

/// A part of a network as springs.
pub(crate) trait SpringSum: Clone + std::fmt::Debug {
    /// Forces below this share of the largest since the factor was made are none: the jaws are parted. Round-off of a
    /// solution must be well below.
    const NOTHING: f64;

    /// Those of a network: segments by fibre, then bonds, then what never breaks.
    fn of(network: &Network) -> &[Self];

    /// A node that it joins; all of them hang together while it is whole.
    fn first_node(&self) -> u32;

    /// Nodes that have a block of the matrix with one another.
    fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + Clone;

    /// Gives its matrix, by pairs of nodes.
    fn matrices(&self, add: &mut dyn FnMut([u32; 2], &Matrix12));

    /// c of every spring [mN/µm or mN µm].
    fn stiffness(&self) -> &[f64];

    /// d of every spring.
    fn deformations(&self, motion: &Motion) -> Vec<f64>;

    /// b of a spring, by unknown.
    fn column(&self, spring: usize, factor: &Factor) -> Vec<(u32, f64)>;

    /// Its loads q, by which it breaks.
    fn loads(&self, motion: &Motion) -> [f64; PARTS];

    /// Adds what it does to its nodes; gives its loads q.
    fn push(&self, motion: &Motion, gyration: f64, forces: &mut Forces) -> [f64; PARTS];

    /// Whether others hold their nodes otherwise once this one is broken.
    fn tears(_network: &Network, _element: usize) -> bool {
        false
    }

    /// Makes all elements hold their nodes as they do with what is whole.
    fn tear(_network: &Network, _is_whole: &[bool], _elements: &mut Cow<'_, [Self]>) {}
}

impl SpringSum for Element {
    const NOTHING: f64 = 1e-9;

    fn of(network: &Network) -> &[Self] {
        network.elements()
    }

    fn first_node(&self) -> u32 {
        self.nodes[0]
    }

    fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + Clone {
        std::iter::once(self.nodes)
    }

    fn matrices(&self, add: &mut dyn FnMut([u32; 2], &Matrix12)) {
        add(self.nodes, &self.matrix());
    }

    fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    fn deformations(&self, motion: &Motion) -> Vec<f64> {
        self.deformation(&motion.ends(self)).to_vec()
    }

    fn column(&self, spring: usize, factor: &Factor) -> Vec<(u32, f64)> {
        factor.column(self.nodes, &self.part(spring))
    }

    fn loads(&self, motion: &Motion) -> [f64; PARTS] {
        Element::loads(self, &self.deformation(&motion.ends(self)))
    }

    fn push(&self, motion: &Motion, gyration: f64, forces: &mut Forces) -> [f64; PARTS] {
        forces.add(self, motion, gyration)
    }
}

impl SpringSum for PointSprings {
    /// Where nothing is left of the force some 1e-15 to 1e-14 of it are.
    const NOTHING: f64 = 1e-7;

    fn of(network: &Network) -> &[Self] {
        network.tubes().map_or(&[], |tubes| tubes.parts.as_slice())
    }

    fn first_node(&self) -> u32 {
        PointSprings::first_node(self)
    }

    fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + Clone {
        PointSprings::pairs(self)
    }

    fn matrices(&self, add: &mut dyn FnMut([u32; 2], &Matrix12)) {
        PointSprings::matrices(self, add);
    }

    fn stiffness(&self) -> &[f64] {
        PointSprings::stiffness(self)
    }

    fn deformations(&self, motion: &Motion) -> Vec<f64> {
        PointSprings::deformations(self, motion)
    }

    fn column(&self, spring: usize, factor: &Factor) -> Vec<(u32, f64)> {
        let free = self.spring(spring).iter();
        let free = free.filter_map(|(point, weight)| Some((factor.unknown(*point)?, weight)));
        free.flat_map(|(unknown, weight)| {
            (0..3).map(move |axis| ((unknown + axis) as u32, weight[axis]))
        })
        .filter(|(_, value)| *value != 0.0)
        .collect()
    }

    fn loads(&self, motion: &Motion) -> [f64; PARTS] {
        PointSprings::loads(self, motion)
    }

    fn push(&self, motion: &Motion, _gyration: f64, forces: &mut Forces) -> [f64; PARTS] {
        PointSprings::push(self, motion, forces)
    }

    fn tears(network: &Network, element: usize) -> bool {
        network
            .tubes()
            .is_some_and(|tubes| tubes.has_bonds.get(element) == Some(&true))
    }

    fn tear(network: &Network, is_whole: &[bool], elements: &mut Cow<'_, [Self]>) {
        let Some(tubes) = network.tubes() else { return };
        for (bond, joint) in tubes.joints.iter().enumerate() {
            let holds_whole = joint.holds.map(|hold| is_whole[hold.segment as usize]);
            if holds_whole != [true; 2] {
                elements.to_mut()[network.segments() + bond] =
                    joint.springs(network.positions(), tubes.points_on_ring, holds_whole);
            }
        }
    }
}
