//! An element's energy, forces and stiffness in a shape of its nodes.
//!
//! The springs are those of small motions ([`Element::stiffness`]); the measures that they feel are those
//! of [`super::measure`].
use nalgebra::{Matrix3, Vector3};

use super::super::element::{Element, Ends, Matrix12, PARTS};
use super::super::input::Level;
use super::super::network::Network;
use super::measure::{
    Chord, Gradient, Hessian, TURN, add_block, add_difference, add_difference_block, add_rows,
    angles, twist,
};
use super::shape::Shape;

/// An element in a shape.
#[derive(Debug, Clone)]
pub(crate) struct Response {
    /// Loads q of its springs [mN, mN µm].
    pub(crate) loads: [f64; PARTS],
    /// Elastic energy [nJ].
    pub(crate) energy: f64,
    /// First derivative of the energy: forces on the nodes that keep it so.
    pub(crate) forces: Gradient,
    /// Second derivative.
    pub(crate) stiffness: Hessian,
}

impl Response {
    pub(crate) fn ends(&self) -> Ends {
        std::array::from_fn(|end| self.forces.fixed_rows::<3>(3 * end).into_owned())
    }

    pub(crate) fn matrix(&self) -> Matrix12 {
        std::array::from_fn(|row| std::array::from_fn(|column| self.stiffness[(row, column)]))
    }
}

/// An element of the network in a shape; none when it is bent or twisted beyond a right angle.
pub(crate) fn response(network: &Network, index: usize, shape: &Shape) -> Option<Response> {
    let element = &network.elements()[index];
    let is_segment = index < network.segments();
    match (is_segment, network.model().level) {
        (true, Level::Beam | Level::Tube) => beam(network, element, shape),
        (true, Level::Truss) => bar(network, element, shape),
        (false, level) => Some(bond(network, element, shape, level)),
    }
}

fn rest_length(network: &Network, element: &Element) -> f64 {
    let [a, b] = element.nodes.map(|node| network.positions()[node as usize]);
    (b - a).norm()
}

fn beam(network: &Network, element: &Element, shape: &Shape) -> Option<Response> {
    let [a, b] = element.nodes.map(|node| node as usize);
    let chord = Chord::new(shape.positions[a], shape.positions[b])?;
    let axes = element.axes.transpose();
    let triads = [a, b].map(|node| shape.turns[node].to_rotation_matrix().into_inner() * axes);
    let stretch = chord.stretch(rest_length(network, element));
    let about = |end: usize| {
        angles([
            chord.lean(end, triads[end].column(2).into_owned()),
            chord.lean(end, -triads[end].column(1)),
        ])
    };
    let [first, second] = [about(0)?, about(1)?];
    let twist = twist(&triads[0], &triads[1]).angle()?;

    // deformations in the order of the element's springs: sums and differences of the angles
    let pair = |axis: usize, sign: f64| {
        let value = second[axis].value + sign * first[axis].value;
        (value, second[axis].gradient + sign * first[axis].gradient)
    };
    let springs = [
        (stretch.value, stretch.gradient),
        pair(0, 1.0),
        pair(1, 1.0),
        (twist.value, twist.gradient),
        pair(0, -1.0),
        pair(1, -1.0),
    ];
    let deformation = springs.map(|(value, _)| value);
    let loads = element.loads(&deformation);
    let mut forces = Gradient::zeros();
    let mut stiffness = Hessian::zeros();
    for (part, (_, gradient)) in springs.iter().enumerate() {
        forces += gradient * loads[part];
        stiffness += element.stiffness[part] * gradient * gradient.transpose();
    }
    stiffness += stretch.hessian * loads[0] + twist.hessian * loads[3];
    for axis in 0..2 {
        let (changing, uniform) = (loads[1 + axis], loads[4 + axis]);
        stiffness += first[axis].hessian * (changing - uniform);
        stiffness += second[axis].hessian * (changing + uniform);
    }
    Some(Response {
        loads,
        energy: element.energy(&deformation),
        forces,
        stiffness,
    })
}

fn bar(network: &Network, element: &Element, shape: &Shape) -> Option<Response> {
    let [a, b] = element.nodes.map(|node| node as usize);
    let chord = Chord::new(shape.positions[a], shape.positions[b])?;
    let stretch = chord.stretch(rest_length(network, element));
    let axial = element.stiffness[0];
    let force = axial * stretch.value;
    // what keeps a loose bar in place acts in all directions, whatever the bar's
    let taut = element.stiffness[1];
    let moved = moved(network, element, shape);
    let mut forces = stretch.gradient * force;
    add_difference(&mut forces, &(moved * taut));
    let mut stiffness =
        axial * stretch.gradient * stretch.gradient.transpose() + stretch.hessian * force;
    add_difference_block(&mut stiffness, &(Matrix3::identity() * taut));
    Some(Response {
        loads: [force, 0.0, 0.0, 0.0, 0.0, 0.0],
        energy: 0.5 * (force * stretch.value + taut * moved.norm_squared()),
        forces,
        stiffness,
    })
}

/// A bond's displacement is that of its two points, in the frame of the lab; its rotation is the vector of
/// the rotation from one to the other. Across and along are as the first fibre has turned.
fn bond(network: &Network, element: &Element, shape: &Shape, level: Level) -> Response {
    let [a, b] = element.nodes.map(|node| node as usize);
    let (spring, turning) = (element.stiffness[0], element.stiffness[3]);
    let moved = moved(network, element, shape);
    let mut forces = Gradient::zeros();
    let mut stiffness = Hessian::zeros();
    add_difference(&mut forces, &(moved * spring));
    add_difference_block(&mut stiffness, &(Matrix3::identity() * spring));
    let mut energy = 0.5 * spring * moved.norm_squared();
    let axes = element.axes;
    let local = axes * shape.turns[a].inverse_transform_vector(&(moved * spring));
    let mut loads = [local.x, local.y, local.z, 0.0, 0.0, 0.0];
    if level == Level::Beam {
        let turn = (shape.turns[b] * shape.turns[a].inverse()).scaled_axis();
        let moment = turn * turning;
        energy += 0.5 * turning * turn.norm_squared();
        add_rows(&mut forces, TURN[0], &-moment);
        add_rows(&mut forces, TURN[1], &moment);
        // derivative of the vector of a rotation by one that follows it: 1 - ½ θ× + κ θ×²
        let angle = turn.norm();
        let kappa = if angle > 1e-4 {
            (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle)
        } else {
            1.0 / 12.0
        };
        let skew = turn.cross_matrix();
        let symmetric = (Matrix3::identity() + skew * skew * kappa) * turning;
        let cross = symmetric + skew * (0.5 * turning);
        add_block(&mut stiffness, TURN[0], TURN[0], &symmetric);
        add_block(&mut stiffness, TURN[1], TURN[1], &symmetric);
        add_block(&mut stiffness, TURN[1], TURN[0], &-cross);
        add_block(&mut stiffness, TURN[0], TURN[1], &-cross.transpose());
        let local = axes * shape.turns[a].inverse_transform_vector(&moment);
        loads[3..].copy_from_slice(local.as_slice());
    }
    Response {
        loads,
        energy,
        forces,
        stiffness,
    }
}

/// Displacement of the second node less that of the first.
fn moved(network: &Network, element: &Element, shape: &Shape) -> Vector3<f64> {
    let [a, b] = element.nodes.map(|node| node as usize);
    let rest = network.positions();
    (shape.positions[b] - rest[b]) - (shape.positions[a] - rest[a])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::{bond as a_bond, fibre, model};

    /// Derivatives against differences of the energy and the forces.
    #[test]
    fn forces_and_stiffness_are_derivatives_of_the_energy() {
        let fibres = [
            fibre(&[[1.0, 2.0, 3.0], [21.0, 12.0, -4.0]]),
            fibre(&[[5.0, 9.0, 0.0], [9.0, 0.0, 6.0]]),
        ];
        let bonds = [a_bond([0, 1], [0.0, 0.0])];
        for level in [Level::Beam, Level::Truss] {
            let network = Network::new(&fibres, &bonds, model(level, 1e4)).unwrap();
            let mut shape = Shape::of(&network);
            for node in 0..network.nodes() {
                let i = node as f64;
                let shift = Vector3::new(0.5 - i, 0.3 * i, 1.5 - 0.7 * i);
                let turn = Vector3::new(0.2 - 0.1 * i, 0.3 + 0.15 * i, -0.2 + 0.1 * i * i);
                shape.step(node, shift, turn);
            }
            for index in 0..network.elements().len() {
                compare(&network, index, &shape);
            }
        }
    }

    fn compare(network: &Network, index: usize, shape: &Shape) {
        let here = response(network, index, shape).unwrap();
        let nodes = network.elements()[index].nodes;
        let along = |row: usize, by: f64| {
            let mut shape = shape.clone();
            let mut step = [Vector3::zeros(), Vector3::zeros()];
            step[row % 6 / 3][row % 3] = by;
            shape.step(nodes[row / 6] as usize, step[0], step[1]);
            response(network, index, &shape).unwrap().energy
        };
        let second = |row: usize, column: usize, by: f64| {
            let corner = |a: f64, b: f64| {
                let mut moved = shape.clone();
                let mut steps = [[Vector3::zeros(); 2]; 2];
                steps[row / 6][row % 6 / 3][row % 3] += a;
                steps[column / 6][column % 6 / 3][column % 3] += b;
                for (node, step) in nodes.iter().zip(steps) {
                    moved.step(*node as usize, step[0], step[1]);
                }
                response(network, index, &moved).unwrap().energy
            };
            (corner(by, by) - corner(by, -by) - corner(-by, by) + corner(-by, -by))
                / (4.0 * by * by)
        };
        let (largest, stiffest) = (here.forces.amax(), here.stiffness.amax());
        for row in 0..12 {
            let slope = (along(row, 1e-5) - along(row, -1e-5)) / 2e-5;
            // central differences: 1e-10 of the third derivative, and round-off of the energy
            assert!(
                (slope - here.forces[row]).abs() < 1e-6 * largest,
                "{row}: {slope} {}",
                here.forces[row]
            );
            for column in 0..12 {
                let bend = second(row, column, 1e-3);
                let exact = here.stiffness[(row, column)];
                assert!(
                    (bend - exact).abs() < 2e-5 * stiffest,
                    "{index} {row} {column}: {bend} {exact}"
                );
            }
        }
    }
}
