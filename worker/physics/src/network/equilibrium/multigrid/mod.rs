//! Corrections in long waves for the preconditioner of large networks.
//!
//! A node relaxed against its neighbours moves an error by one bond, so what is left after some
//! iterations are long waves. They are found on grids: the displacement of a node is interpolated
//! from the corners of its [`mesh`] cell, every cell has the stiffness of its bonds, and the
//! [`level`]s of ever coarser cells are solved by a V-cycle ([TrottenbergOosterleeSchuller2001]
//! chapter 2), the coarsest by a dense inverse. The correction is added to that of the nodes
//! themselves (the additive form of [BramblePasciakXu1990]), symmetric and positive as conjugate
//! gradients need it.
//!
//! The stiffness is the one at which the hierarchy was built; as the network moves on it serves
//! somewhat less well, and no result depends on it.
mod band;
mod dense;
mod level;
pub(crate) mod mesh;

use dense::Inverse;
use level::{Level, Vectors};
use mesh::{Mesh, Shares};

use crate::{
    network::{
        assembly::Assembly,
        field::{Field, Real, dot},
        stiffness::Stiffness,
    },
    parallel::Team,
};

/// Grids with at most this many corners are solved directly.
const DIRECT: usize = 128;

/// Grids over a network, from fine to coarse.
#[derive(Debug)]
pub(super) struct Multigrid<'a> {
    mesh: &'a Mesh,
    levels: Vec<Level>,
    coarsest: Inverse,
    /// Force at the corners of the finest cells.
    force: Vectors,
    forces_of_strips: Shares,
    /// 1 at the places of free nodes that carry load, else 0.
    shares: Vec<f32>,
}

impl<'a> Multigrid<'a> {
    /// `None` for a network too small to have waves worth a grid.
    pub(super) fn new<T: Real>(assembly: &'a Assembly, stiffness: &Stiffness<T>) -> Option<Self> {
        let mesh = assembly.mesh()?;
        let mut shares = vec![0.0; assembly.places()];
        for (slot, ends) in assembly.ends.iter().enumerate() {
            if assembly.acts(slot) {
                for end in ends.map(|end| end as usize) {
                    shares[end] = f32::from(u8::from(assembly.free().contains(&end)));
                }
            }
        }
        let mut level = Level::finest(mesh, assembly, stiffness);
        let mut levels = Vec::new();
        let coarsest = loop {
            if level.corners() <= DIRECT {
                break Inverse::new(&level);
            }
            let Some(next) = level.coarser() else {
                break Inverse::new(&level);
            };
            levels.push(level);
            level = next;
        };
        Some(Self {
            mesh,
            levels,
            coarsest,
            force: level::zeros(mesh.corners()),
            forces_of_strips: mesh.shares(),
            shares,
        })
    }

    /// Adds to `moved` what relieves the long waves of `forces`; returns the product of that with
    /// `forces`.
    pub(super) fn correct<T: Real>(
        &mut self,
        forces: &Field<T>,
        moved: &mut Field<T>,
        team: &Team,
    ) -> f64 {
        let parts = &mut self.forces_of_strips;
        self.mesh.restrict(forces, parts, &mut self.force, team);
        let corners = self.cycle(0, &self.force);
        self.mesh.prolong(&corners, &self.shares, moved, team);
        let pairs = self.force.iter().zip(&corners);
        pairs.map(|(force, moved)| dot(force, moved)).sum()
    }

    /// Displacements of a V-cycle on the grids from number `finest` on.
    fn cycle(&self, finest: usize, force: &Vectors) -> Vectors {
        let Some(level) = self.levels.get(finest) else {
            return self.coarsest.apply(force);
        };
        let mut moved = level.smooth_from_rest(force);
        let left = level.restrict(&level.residual(force, &moved));
        level.prolong(&self.cycle(finest + 1, &left), &mut moved);
        level.smooth(force, &mut moved);
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{
        Bonds, Hold, Laws, Network, Vector, configuration::Configuration, law::BondLaw,
        load_path::parts, strips::Spill,
    };

    /// Squares with one diagonal, so many nodes a side, under a little tension, held at two sides.
    fn net(side: u32) -> Assembly {
        let node = |column: u32, row: u32| row * side + column;
        let mut ends = Vec::new();
        for row in 0..side {
            for column in 0..side {
                for (right, up) in [(1, 0), (0, 1), (1, 1)] {
                    if column + right < side && row + up < side {
                        ends.push([node(column, row), node(column + right, row + up)]);
                    }
                }
            }
        }
        let place = |node: u32| Vector::new(f64::from(node % side), f64::from(node / side), 0.0);
        let positions: Vec<Vector> = (0..side * side).map(place).collect();
        let length = |ends: &[u32; 2]| (place(ends[1]) - place(ends[0])).norm();
        let law = BondLaw {
            modulus: 1.0,
            friction_modulus: 0.0,
            compression_stiffness: 1.0,
        };
        let network = Network {
            holds: (0..side * side)
                .map(|node| match node / side {
                    0 => Hold::Bottom,
                    row if row + 1 == side => Hold::Top,
                    _ => Hold::Free,
                })
                .collect(),
            bonds: Bonds {
                rest_lengths: ends.iter().map(|ends| 0.99 * length(ends)).collect(),
                strengths: vec![f64::INFINITY; ends.len()],
                laws: Laws::Same(law),
                ends,
            },
            positions,
            rows: Vec::new(),
        };
        let intact = vec![true; network.bonds.len()];
        let mut assembly = Assembly::new(&network);
        assembly.load(&network, &intact, &parts(&network, &intact));
        assembly
    }

    fn configuration(assembly: &Assembly) -> Configuration<f64> {
        let displacements = Field::zeros(assembly.places(), assembly.dimensions());
        Configuration::new(assembly, displacements, &Team::alone())
    }

    /// A wave at the free places.
    fn wave(assembly: &Assembly, along_x: f64, along_y: f64) -> Field<f64> {
        let of_place = |place: usize| {
            let free = assembly.free().contains(&place);
            let at = assembly.positions.at(place);
            let value = (along_x * at.x).cos() * (along_y * at.y).sin();
            Vector::new(0.3 * value, value, 0.0) * f64::from(u8::from(free))
        };
        let values: Vec<Vector> = (0..assembly.places()).map(of_place).collect();
        Field::of(&values, assembly.dimensions())
    }

    #[test]
    fn corrections_are_symmetric_and_positive() {
        let assembly = net(81);
        let stiffness = configuration(&assembly).stiffness;
        let mut grids = Multigrid::new(&assembly, &stiffness).expect("large enough");
        assert!(!grids.levels.is_empty());
        let forces = [wave(&assembly, 0.1, 0.08), wave(&assembly, 0.7, 1.1)];
        let mut moved = [0, 1].map(|_| Field::zeros(assembly.places(), 2));
        let own = [0, 1].map(|i| grids.correct(&forces[i], &mut moved[i], &Team::alone()));
        let across = [0, 1].map(|i: usize| forces[1 - i].dot(&moved[i], assembly.free()));
        assert!(own.iter().all(|work| *work > 0.0));
        // single precision, against the most that the product could be
        let most = (own[0] * own[1]).sqrt();
        let difference = (across[0] - across[1]).abs();
        assert!(difference < 1e-4 * most, "{across:?} {most}");
        for i in 0..2 {
            let work = forces[i].dot(&moved[i], assembly.free());
            assert!((work - own[i]).abs() < 1e-4 * own[i]);
        }
    }

    #[test]
    fn the_longest_wave_is_found_nearly_whole() {
        let assembly = net(81);
        let stiffness = configuration(&assembly).stiffness;
        let mut grids = Multigrid::new(&assembly, &stiffness).expect("large enough");
        let displacements = wave(&assembly, 0.0, std::f64::consts::PI / 80.0);
        let mut forces = Field::zeros(assembly.places(), 2);
        let energy = stiffness.multiply(
            &assembly,
            &displacements,
            &mut forces,
            &mut Spill::new(&assembly.strips, 2),
            &Team::alone(),
        );
        // forces at the jaws do no work
        for component in forces.components_mut().into_iter().take(2) {
            component[..assembly.free().start].fill(0.0);
            component[assembly.free().end..].fill(0.0);
        }
        let mut found = Field::zeros(assembly.places(), 2);
        let work = grids.correct(&forces, &mut found, &Team::alone());
        // all of the wave's energy but what cells of four bonds miss of it
        assert!(
            work > 0.9 * energy && work < 1.1 * energy,
            "{work} of {energy}"
        );
    }

    #[test]
    fn small_networks_have_no_grids() {
        let assembly = net(15);
        assert!(Multigrid::new(&assembly, &configuration(&assembly).stiffness).is_none());
    }
}
