//! The force landscape of one node, and the law of the bonds: what every way to equilibrium goes by.
//!
//! The other nodes stay where they are; the node is displaced from its place in equilibrium, and the
//! magnitude of its resultant and the energy of its bonds are told there: on a grid over the directions
//! of width and pull, and on the three lines along the axes.
//!
//! Source: [Zilka2022] graphs 1 and 2.
use std::io::{self, Write};

use loadframe_api::spec::nonwoven_tensile::{ForceLandscape, NonwovenTensile};
use loadframe_harness::{Recorder, SimulationError, csv};

use super::{experiment::Experiment, specimen::Specimen};
use crate::{
    Vector,
    law::{BondLaw, StrainLaw},
};

/// Bond strains at which the law is told.
const LAW_POINTS: u32 = 201;
/// They go from here, where a bond is pressed to half its length, ...
const LAW_FROM: f64 = -0.5;
/// ... to this much beyond the strain of the mean strength; to twice the length where nothing breaks.
const LAW_BEYOND: f64 = 1.2;

/// # Errors
/// [`SimulationError::Unbuildable`] where the node that is asked for is held: it has no equilibrium.
pub(super) fn check(spec: &NonwovenTensile, specimen: &Specimen) -> Result<(), SimulationError> {
    let asked = spec.output.force_landscape.as_ref();
    let Some(node) = asked.and_then(|asked| asked.node) else {
        return Ok(());
    };
    match specimen.network.holds.get(node as usize) {
        Some(None) => Ok(()),
        _ => Err(SimulationError::Unbuildable(format!(
            "/output/force_landscape/node: node {node} is held"
        ))),
    }
}

/// Writes both for the step just recorded.
pub(super) fn take(
    asked: &ForceLandscape,
    experiment: &Experiment<'_>,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let specimen = &experiment.specimen;
    let node = asked
        .node
        .map_or_else(|| middle(specimen), |node| node as usize);
    let around = Around::new(experiment, node);
    let reach = asked.half_width * specimen.network.bonds.mean_rest_length();
    let half = asked.points / 2;
    let offset = |index: u32| (f64::from(index) - f64::from(half)) * reach / f64::from(half);
    recorder.log(&format!(
        "force landscape of node {node}, {} bonds, at a nominal strain of {:.6}",
        around.bonds.len(),
        experiment.nominal_strain()
    ));
    recorder.file("force_landscape.csv", &mut |out| {
        csv::header(
            out,
            &["offset_x_mm", "offset_y_mm", "resultant_n", "energy_n_mm"],
        )?;
        for row in 0..=2 * half {
            for column in 0..=2 * half {
                let moved = Vector::new(offset(column), offset(row), 0.0);
                let (resultant, energy) = around.at(moved);
                csv::row(out, &[moved.x, moved.y, resultant.norm(), energy])?;
            }
        }
        Ok(())
    })?;
    recorder.file("force_landscape_lines.csv", &mut |out| {
        let columns = [
            "offset_mm",
            "resultant_along_x_n",
            "resultant_along_y_n",
            "resultant_along_z_n",
            "energy_along_x_n_mm",
            "energy_along_y_n_mm",
            "energy_along_z_n_mm",
        ];
        csv::header(out, &columns)?;
        for index in 0..=2 * half {
            let moved = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * offset(index));
            let found = moved.map(|moved| around.at(moved));
            let mut row = vec![offset(index)];
            row.extend(found.iter().map(|(resultant, _)| resultant.norm()));
            row.extend(found.iter().map(|(_, energy)| energy));
            csv::row(out, &row)?;
        }
        Ok(())
    })?;
    recorder.file("bond_law.csv", &mut |out| bond_law(out, specimen))
}

/// The law of the mean bond.
fn bond_law(out: &mut dyn Write, specimen: &Specimen) -> io::Result<()> {
    let law = specimen.mean_law;
    let breaking = law.strain(specimen.mean_strength());
    let end = if breaking.is_finite() && breaking > 0.0 {
        LAW_BEYOND * breaking
    } else {
        1.0
    };
    csv::header(out, &["bond_strain", "bond_force_n", "energy_per_length_n"])?;
    for point in 0..LAW_POINTS {
        let part = f64::from(point) / f64::from(LAW_POINTS - 1);
        let strain = LAW_FROM + part * (end - LAW_FROM);
        csv::row(out, &[strain, law.tension(strain), law.energy(strain)])?;
    }
    Ok(())
}

/// The free node nearest to the middle of all nodes before the test; of several the first.
fn middle(specimen: &Specimen) -> usize {
    let network = &specimen.network;
    let sum: Vector = network.positions.iter().sum();
    let middle = sum / network.positions.len() as f64;
    let distance = |node: usize| (network.positions[node] - middle).norm_squared();
    let free = (0..network.holds.len()).filter(|node| network.holds[*node].is_none());
    free.min_by(|one, other| distance(*one).total_cmp(&distance(*other)))
        .unwrap_or(0)
}

/// A node at its place and its intact bonds.
struct Around {
    place: Vector,
    bonds: Vec<Neighbour>,
}

struct Neighbour {
    place: Vector,
    rest_length: f64,
    law: BondLaw,
}

impl Around {
    fn new(experiment: &Experiment<'_>, node: usize) -> Self {
        let network = &experiment.specimen.network;
        let moved = &experiment.state.displacements;
        let place = |node: usize| network.positions[node] + moved[node];
        let intact = experiment.loaded.intact.iter();
        let bonds = network.bonds.ends.iter().zip(intact).enumerate();
        let bonds = bonds.filter(|(_, (_, intact))| **intact);
        let bonds = bonds.filter_map(|(bond, (ends, _))| {
            let [first, second] = ends.map(|end| end as usize);
            let other = match (first == node, second == node) {
                (true, false) => second,
                (false, true) => first,
                _ => return None,
            };
            Some(Neighbour {
                place: place(other),
                rest_length: network.bonds.rest_lengths[bond],
                law: network.bonds.laws.of(bond),
            })
        });
        Self {
            place: place(node),
            bonds: bonds.collect(),
        }
    }

    /// Resultant [N] and energy of its bonds [N mm] where the node is moved so far.
    fn at(&self, moved: Vector) -> (Vector, f64) {
        let place = self.place + moved;
        let (mut resultant, mut energy) = (Vector::zeros(), 0.0);
        for bond in &self.bonds {
            let towards = bond.place - place;
            let length = towards.norm();
            let strain = (length - bond.rest_length) / bond.rest_length;
            if length > 0.0 {
                resultant += towards * (bond.law.tension(strain) / length);
            }
            energy += bond.rest_length * bond.law.energy(strain);
        }
        (resultant, energy)
    }
}
