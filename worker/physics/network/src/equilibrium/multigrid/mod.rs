//! Corrections in long waves for the preconditioner.
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
//! somewhat less well, and no result depends on it. To build one costs as much as dozens of
//! iterations, more than it saves in a network of few cells. Such a network has a single grid, built
//! once with the bonds [`at_rest`], and one number makes it as stiff as the network has become.
mod at_rest;
mod band;
mod corners;
mod dense;
mod level;
mod mesh;

use std::{borrow::Cow, sync::OnceLock};

use loadframe_numerics::Team;

use at_rest::AtRest;
use corners::{Vectors, zeros};
use dense::Inverse;
use level::Level;
use mesh::{Mesh, Shares};

use super::block_jacobi::BlockJacobi;
use crate::{
    assembly::Assembly,
    field::{Field, Real, dot},
    stiffness::Stiffness,
};

/// Grids with at most this many corners are solved directly.
const DIRECT: usize = 128;

/// What is known of the grids of one assembly whatever its bonds do, each found when first asked for.
#[derive(Debug, Default)]
pub(super) struct Cells {
    finest: OnceLock<Option<Mesh>>,
    at_rest: OnceLock<Option<AtRest>>,
}

impl Cells {
    /// Whether the network has waves worth a grid.
    pub(super) fn are_enough(&self, assembly: &Assembly) -> bool {
        self.finest(assembly).is_some()
    }

    /// The finest cells over the nodes; `None` when there would be too few.
    fn finest(&self, assembly: &Assembly) -> Option<&Mesh> {
        // corners would move nodes along axes in which they are held; no result depends on grids
        let has_guides = !assembly.guided().is_empty();
        let finest = || (!has_guides).then(|| Mesh::over(assembly, usize::MAX))?;
        self.finest.get_or_init(finest).as_ref()
    }

    /// The long waves of a network of few cells with all bonds at rest; `None` for others.
    fn at_rest(&self, assembly: &Assembly) -> Option<&AtRest> {
        let at_rest = || AtRest::new(assembly, self.finest(assembly)?);
        self.at_rest.get_or_init(at_rest).as_ref()
    }
}

/// Grids over a network, from fine to coarse.
#[derive(Debug)]
pub(super) struct Multigrid<'a> {
    mesh: &'a Mesh,
    levels: Vec<Level>,
    coarsest: Cow<'a, Inverse>,
    /// Where the coarsest grid is that of the network at rest.
    at_rest: Option<&'a AtRest>,
    /// Part of what the grids find that the network moves: less when it is stiffer than they are.
    share: f32,
    /// Force at the corners of the finest cells.
    force: Vectors,
    forces_of_strips: Shares,
}

impl<'a> Multigrid<'a> {
    /// The grids of a network with this stiffness; `None` for one too small to have waves worth a grid.
    pub(super) fn new<T: Real>(
        assembly: &Assembly,
        cells: &'a Cells,
        stiffness: &Stiffness<T>,
    ) -> Option<Self> {
        let mesh = cells.finest(assembly)?;
        let mut level = Level::finest(mesh, assembly, stiffness);
        let mut levels = Vec::new();
        let coarsest = loop {
            if level.corners() <= DIRECT {
                break Inverse::new(&level, 3);
            }
            let Some(next) = level.coarser() else {
                break Inverse::new(&level, 3);
            };
            levels.push(level);
            level = next;
        };
        Some(Self::of(mesh, levels, Cow::Owned(coarsest), None))
    }

    /// The grid of a network of few cells as it was at rest; `None` for others.
    pub(super) fn at_rest(assembly: &Assembly, cells: &'a Cells) -> Option<Self> {
        let at_rest = cells.at_rest(assembly)?;
        let inverse = Cow::Borrowed(&at_rest.inverse);
        Some(Self::of(&at_rest.mesh, Vec::new(), inverse, Some(at_rest)))
    }

    fn of(
        mesh: &'a Mesh,
        levels: Vec<Level>,
        coarsest: Cow<'a, Inverse>,
        at_rest: Option<&'a AtRest>,
    ) -> Self {
        Self {
            mesh,
            levels,
            coarsest,
            at_rest,
            share: 1.0,
            force: zeros(mesh.corners()),
            forces_of_strips: mesh.shares(),
        }
    }

    /// Makes the grid at rest as stiff as these nodes are.
    pub(super) fn follow<T: Real>(&mut self, nodes: &BlockJacobi<T>) {
        if let Some(at_rest) = self.at_rest {
            let share = at_rest.stiffness / nodes.stiffness();
            // nothing is left of a network without stiffness
            self.share = if share.is_finite() { share as f32 } else { 1.0 };
        }
    }

    /// Adds to `moved` what relieves the long waves of `forces` on these `nodes`; returns the product of
    /// that with `forces`.
    pub(super) fn correct<T: Real>(
        &mut self,
        nodes: &BlockJacobi<T>,
        forces: &Field<T>,
        moved: &mut Field<T>,
        team: &Team,
    ) -> f64 {
        if self.at_rest.is_some() || forces.axis(2).is_empty() {
            self.correct_in::<T, 2>(nodes, forces, moved, team)
        } else {
            self.correct_in::<T, 3>(nodes, forces, moved, team)
        }
    }

    /// The same, along so many axes.
    fn correct_in<T: Real, const C: usize>(
        &mut self,
        nodes: &BlockJacobi<T>,
        forces: &Field<T>,
        moved: &mut Field<T>,
        team: &Team,
    ) -> f64 {
        let (mesh, parts) = (self.mesh, &mut self.forces_of_strips);
        mesh.restrict::<T, C>(forces, parts, &mut self.force, team);
        let mut corners = self.cycle(0, &self.force);
        for moved in corners.iter_mut().flatten() {
            *moved *= self.share;
        }
        mesh.prolong::<T, C>(&corners, nodes.mobility(), moved, team);
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
    use crate::{
        Vector,
        configuration::Configuration,
        sample::{assembled, squares, stretch},
        strips::Spill,
    };

    /// So many nodes a side, under a little tension.
    fn net(side: u32) -> Assembly {
        let mut network = squares(side);
        stretch(&mut network, 0.99);
        assembled(&network)
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

    fn nodes(assembly: &Assembly, stiffness: &Stiffness<f64>) -> BlockJacobi<f64> {
        let mut nodes = BlockJacobi::zeros(assembly);
        nodes.follow(assembly, stiffness, &Team::alone());
        nodes
    }

    /// What grids find for a wave of forces.
    fn found(
        assembly: &Assembly,
        nodes: &BlockJacobi<f64>,
        grids: &mut Multigrid<'_>,
    ) -> Field<f64> {
        let mut found = Field::zeros(assembly.places(), 2);
        grids.correct(
            nodes,
            &wave(assembly, 0.1, 0.08),
            &mut found,
            &Team::alone(),
        );
        found
    }

    #[test]
    fn corrections_are_symmetric_and_positive() {
        let assembly = net(81);
        let cells = Cells::default();
        let stiffness = configuration(&assembly).stiffness;
        let grids = Multigrid::new(&assembly, &cells, &stiffness).expect("large enough");
        assert!(!grids.levels.is_empty());
        let at_rest = Multigrid::at_rest(&assembly, &cells).expect("few cells");
        assert!(at_rest.levels.is_empty());
        // a second wave that cells can still follow
        for (grids, short) in [(grids, [0.7, 1.1]), (at_rest, [0.2, 0.3])] {
            check_symmetry(&assembly, &stiffness, grids, short);
        }
    }

    fn check_symmetry(
        assembly: &Assembly,
        stiffness: &Stiffness<f64>,
        mut grids: Multigrid<'_>,
        [along_x, along_y]: [f64; 2],
    ) {
        let nodes = nodes(assembly, stiffness);
        grids.follow(&nodes);
        let forces = [wave(assembly, 0.1, 0.08), wave(assembly, along_x, along_y)];
        let mut moved = [0, 1].map(|_| Field::zeros(assembly.places(), 2));
        let own = [0, 1].map(|i| grids.correct(&nodes, &forces[i], &mut moved[i], &Team::alone()));
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
        let cells = Cells::default();
        let stiffness = configuration(&assembly).stiffness;
        let mut grids = Multigrid::new(&assembly, &cells, &stiffness).expect("large enough");
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
        let nodes = nodes(&assembly, &stiffness);
        let work = grids.correct(&nodes, &forces, &mut found, &Team::alone());
        // all of the wave's energy but what cells of four bonds miss of it
        assert!(
            work > 0.9 * energy && work < 1.1 * energy,
            "{work} of {energy}"
        );
    }

    #[test]
    fn a_grid_at_rest_is_as_stiff_as_the_network_has_become() {
        let assembly = net(41);
        let cells = Cells::default();
        let stiffness = configuration(&assembly).stiffness;
        let mut stiffer = stiffness.clone();
        for axial in stiffer.axial.iter_mut().flatten() {
            *axial *= 2.0;
        }
        for transverse in &mut stiffer.transverse {
            *transverse *= 4.0;
        }
        let mut grids = Multigrid::at_rest(&assembly, &cells).expect("few cells");
        let moved = [&stiffness, &stiffer].map(|stiffness| {
            let nodes = nodes(&assembly, stiffness);
            grids.follow(&nodes);
            found(&assembly, &nodes, &mut grids)
        });
        for place in assembly.free() {
            let [first, second] = moved.each_ref().map(|moved| moved.at(place));
            // some roundings of single precision
            assert!((first - 4.0 * second).norm() <= 1e-5 * first.norm());
        }
    }

    #[test]
    fn a_grid_at_rest_is_the_same_after_bonds_broke() {
        let whole = net(41);
        let mut broken = net(41);
        for bond in [300, 301, 700] {
            broken.release(bond);
        }
        let nodes = nodes(&whole, &configuration(&whole).stiffness);
        let [first, second] = [&whole, &broken].map(|assembly| {
            let cells = Cells::default();
            let mut grids = Multigrid::at_rest(assembly, &cells).expect("few cells");
            found(assembly, &nodes, &mut grids)
        });
        assert_eq!(first, second);
    }

    #[test]
    fn networks_of_many_cells_have_no_grid_at_rest() {
        assert!(Multigrid::at_rest(&net(141), &Cells::default()).is_none());
    }

    #[test]
    fn small_networks_have_no_grids() {
        let assembly = net(15);
        let cells = Cells::default();
        assert!(Multigrid::new(&assembly, &cells, &configuration(&assembly).stiffness).is_none());
        assert!(Multigrid::at_rest(&assembly, &cells).is_none());
    }
}
