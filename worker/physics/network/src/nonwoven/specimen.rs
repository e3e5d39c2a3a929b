//! From the spec of a nonwoven tensile test to the network and its dimensions.
use loadframe_api::spec::nonwoven_tensile as spec;
use loadframe_api::spec::nonwoven_tensile::{Breaking, Direction, Fabric, Jaw, NonwovenTensile};
use loadframe_harness::SimulationError;

use super::{
    lattice,
    strength::{StrengthDistribution, strengths},
    turned,
    width::WidthGauge,
};
use crate::{
    Bonds, Laws, Network, Vector,
    boundary::{BOTTOM, Hold, Set, TOP},
    law::{BondLaw, StrainLaw},
    load_path::{carries_load, parts},
};

/// A network ready to be tested, and what its results are related to.
#[derive(Clone, Debug)]
pub(super) struct Specimen {
    pub(super) network: Network,
    /// Initial distance of the jaws [mm].
    pub(super) gauge_length: f64,
    /// Height of the bottom jaw [mm].
    pub(super) bottom: f64,
    /// Width that forces are related to [mm].
    pub(super) width: f64,
    /// Thickness that stresses are related to [mm].
    pub(super) thickness: Option<f64>,
    /// Mass per area that strengths are related to [g/m²].
    pub(super) grammage: Option<f64>,
    /// Layers of a lattice.
    pub(super) layers: Option<u32>,
    /// How lateral contraction is measured, where it can be.
    pub(super) width_gauge: Option<WidthGauge>,
    /// The means over all bonds.
    pub(super) mean_law: BondLaw,
}

impl Specimen {
    /// Builds the specimen of a spec, along the first of its directions.
    ///
    /// # Errors
    /// [`SimulationError::Unbuildable`] for a spec its own validation would have refused.
    pub(super) fn new(spec: &NonwovenTensile) -> Result<Self, SimulationError> {
        match &spec.fabric {
            Fabric::Lattice(lattice) => Self::from_lattice(spec, lattice),
            Fabric::Network(network) => Self::from_network(spec, network),
        }
    }

    fn from_lattice(
        spec: &NonwovenTensile,
        lattice: &spec::Lattice,
    ) -> Result<Self, SimulationError> {
        check_size(lattice)?;
        let points = match spec.test.directions.first() {
            None | Some(Direction::Y) => lattice::points(lattice, spec.seed),
            Some(Direction::X) => turned::points(lattice, spec.seed),
        };
        let law = law(&spec.bond, None, None, None)
            .ok_or_else(|| unbuildable("the bonds have no modulus"))?;
        let count = points.ends.len();
        let given_strength = |bond| points.is_grip(bond).then_some(f64::INFINITY);
        let given_strengths = (0..count).map(|bond| (points.number(bond), given_strength(bond)));
        let bonds = Bonds {
            rest_lengths: distances(&points.positions, &points.ends),
            laws: Laws::Same(law),
            strengths: strengths(given_strengths, distribution(spec).as_ref(), breaks(spec))?,
            ends: points.ends,
        };
        let width_gauge = WidthGauge::rows(&points.positions, points.middle_rows);
        let network = Network {
            positions: points.positions,
            holds: points.holds,
            sets: Set::jaws(),
            bonds,
            rows: points.rows,
        };
        Ok(Self {
            gauge_length: points.gauge_length,
            bottom: jaw_height(&network, BOTTOM)?,
            width: points.width,
            thickness: lattice.thickness_mm,
            grammage: lattice.grammage_g_per_m2,
            layers: Some(lattice.layers),
            width_gauge,
            mean_law: law,
            network,
        })
    }

    fn from_network(
        spec: &NonwovenTensile,
        given: &spec::Network,
    ) -> Result<Self, SimulationError> {
        let nodes = given.nodes_mm.len();
        if given.jaws.len() != nodes {
            return Err(unbuildable("nodes_mm and jaws differ in length"));
        }
        let ends: Vec<[u32; 2]> = given.bonds.iter().map(|bond| bond.nodes).collect();
        if ends.iter().flatten().any(|node| *node as usize >= nodes) {
            return Err(unbuildable("a bond ends in a node that does not exist"));
        }
        let positions: Vec<Vector> = given.nodes_mm.iter().map(|p| Vector::from(*p)).collect();
        let mut laws = Vec::with_capacity(given.bonds.len());
        for (number, bond) in given.bonds.iter().enumerate() {
            let law = law(
                &spec.bond,
                bond.modulus_n,
                bond.friction_modulus_n,
                bond.compression_stiffness_n,
            );
            laws.push(law.ok_or_else(|| unbuildable(format!("bond {number} has no modulus")))?);
        }
        let mut rest_lengths = distances(&positions, &ends);
        for (length, bond) in rest_lengths.iter_mut().zip(&given.bonds) {
            *length = bond.rest_length_mm.unwrap_or(*length);
        }
        let mean_law = mean(&laws);
        let laws = match laws.split_first() {
            // what all bonds share is not read for each
            Some((first, others)) if others.iter().all(|law| law == first) => Laws::Same(*first),
            _ => Laws::Each(laws),
        };
        let given_strengths = given.bonds.iter().map(|bond| bond.strength_n).enumerate();
        let network = Network {
            holds: given.jaws.iter().map(hold).collect(),
            sets: Set::jaws(),
            bonds: Bonds {
                ends,
                rest_lengths,
                laws,
                strengths: strengths(given_strengths, distribution(spec).as_ref(), breaks(spec))?,
            },
            positions,
            rows: Vec::new(),
        };
        let bottom = jaw_height(&network, BOTTOM)?;
        let gauge_length = jaw_height(&network, TOP)? - bottom;
        if gauge_length <= 0.0 {
            return Err(unbuildable("the top jaw is not above the bottom jaw"));
        }
        let width_gauge = WidthGauge::slope(&network, bottom, gauge_length);
        Ok(Self {
            gauge_length,
            bottom,
            width: given.width_mm.unwrap_or_else(|| extent(&network.positions)),
            thickness: given.thickness_mm,
            grammage: given.grammage_g_per_m2,
            layers: None,
            width_gauge,
            mean_law,
            network,
        })
    }
}

impl Specimen {
    /// Bonds that carry no load from the start.
    pub(super) fn unloaded_bonds(&self) -> usize {
        let network = &self.network;
        let parts = parts(network, &vec![true; network.bonds.len()]);
        let ends = network.bonds.ends.iter();
        ends.filter(|ends| !carries_load(network, &parts, **ends))
            .count()
    }

    /// T [N] of the softest bond at a strain u ≥ 0, what the force limit (8) is a part of.
    ///
    /// Between soft parts a stiff bond turns and moves by forces that are theirs: a limit that rises
    /// with its modulus, as a mean does, leaves them where they happen to be.
    pub(super) fn softest_tension(&self, strain: f64) -> f64 {
        match &self.network.bonds.laws {
            // of these the mean is their own, but for rounding
            Laws::Same(_) => self.mean_law.tension(strain),
            Laws::Each(laws) => {
                let tensions = laws.iter().map(|law| law.tension(strain));
                tensions.fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Mean strength of the bonds that can break [N]; NaN where none can.
    pub(super) fn mean_strength(&self) -> f64 {
        let strengths = self.network.bonds.strengths.iter();
        let breakable = strengths.filter(|strength| strength.is_finite());
        let (sum, count) = breakable.fold((0.0, 0.0), |(sum, count), strength| {
            (sum + strength, count + 1.0)
        });
        sum / count
    }

    /// Strain at which a weak bond of the mean law along the pulling direction breaks: about where
    /// a network is torn. Infinite when no bond can break.
    ///
    /// A network tears long before its bond of mean strength would: by a fifth for polyester.
    /// Where a bond one deviation weaker than most breaks, 18 lattices from 15 x 17 x 3 to
    /// 49 x 51 x 1, with σ from 0 to 0.8, ended at 0.94 to 1.39 of it, for σ up to 0.365 at most
    /// 1.17.
    pub(super) fn expected_rupture_strain(&self) -> f64 {
        let strengths = self.network.bonds.strengths.iter().copied();
        let mut breakable: Vec<f64> = strengths.filter(|strength| strength.is_finite()).collect();
        if breakable.is_empty() {
            return f64::INFINITY;
        }
        let rank = (breakable.len() as f64 * WEAKER_BY_ONE_DEVIATION) as usize;
        let (_, strength, _) = breakable.select_nth_unstable_by(rank, f64::total_cmp);
        self.mean_law.strain(*strength)
    }
}

/// Part of a normal distribution below its mean less one standard deviation.
const WEAKER_BY_ONE_DEVIATION: f64 = 0.159;

/// Node and bond numbers are 32 bits wide.
fn check_size(lattice: &spec::Lattice) -> Result<(), SimulationError> {
    let points = (u64::from(lattice.points_per_row) + 1) * u64::from(lattice.rows);
    // at most four bonds begin in a node
    let bonds = 4 * points.saturating_mul(u64::from(lattice.layers));
    if bonds > u64::from(u32::MAX) {
        return Err(unbuildable(
            "the lattice has more bonds than can be numbered",
        ));
    }
    if lattice.layers == 0 || lattice.points_per_row == 0 || lattice.rows.is_multiple_of(2) {
        return Err(unbuildable(
            "the lattice has no points or an even number of rows",
        ));
    }
    Ok(())
}

fn unbuildable(reason: impl Into<String>) -> SimulationError {
    SimulationError::Unbuildable(reason.into())
}

/// The law of a bond: its own values where given, else those of the spec. `None` without modulus.
fn law(
    bond: &spec::Bond,
    modulus: Option<f64>,
    friction_modulus: Option<f64>,
    compression_stiffness: Option<f64>,
) -> Option<BondLaw> {
    Some(BondLaw {
        modulus: modulus.or(bond.modulus_n)?,
        friction_modulus: friction_modulus.unwrap_or(bond.friction_modulus_n),
        compression_stiffness: compression_stiffness.unwrap_or(bond.compression_stiffness_n),
    })
}

fn mean(laws: &[BondLaw]) -> BondLaw {
    let mean_of =
        |part: fn(&BondLaw) -> f64| laws.iter().map(part).sum::<f64>() / laws.len() as f64;
    BondLaw {
        modulus: mean_of(|law| law.modulus),
        friction_modulus: mean_of(|law| law.friction_modulus),
        compression_stiffness: mean_of(|law| law.compression_stiffness),
    }
}

fn distribution(spec: &NonwovenTensile) -> Option<StrengthDistribution> {
    let scale = spec.bond.mean_strength_n?;
    Some(StrengthDistribution::new(
        scale,
        spec.bond.strength_sigma,
        spec.bond.strength_draw,
        spec.seed,
    ))
}

fn breaks(spec: &NonwovenTensile) -> bool {
    spec.test.breaking != Breaking::None
}

fn hold(jaw: &Jaw) -> Hold {
    match jaw {
        Jaw::Free => None,
        Jaw::Bottom => Some(BOTTOM),
        Jaw::Top => Some(TOP),
    }
}

fn jaw_height(network: &Network, jaw: u16) -> Result<f64, SimulationError> {
    let height = network.jaw_height(jaw);
    height.ok_or_else(|| {
        unbuildable(format!(
            "no node is held by the {} jaw",
            network.sets[usize::from(jaw)].name
        ))
    })
}

fn distances(positions: &[Vector], ends: &[[u32; 2]]) -> Vec<f64> {
    let distance =
        |ends: &[u32; 2]| (positions[ends[1] as usize] - positions[ends[0] as usize]).norm();
    ends.iter().map(distance).collect()
}

/// Extent of the nodes along x [mm].
fn extent(positions: &[Vector]) -> f64 {
    let along_x = positions.iter().map(|position| position.x);
    along_x.clone().fold(f64::NEG_INFINITY, f64::max) - along_x.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "copied numbers are exact")]
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn bonds_have_the_same_strength_in_both_directions() {
        let loadframe_api::JobSpec::NonwovenTensile(mut spec) = crate::nonwoven::calibration_spec()
        else {
            panic!("the calibration pulls a nonwoven");
        };
        let upright = Specimen::new(&spec).expect("a lattice");
        spec.test.directions = vec![Direction::X];
        let turned = Specimen::new(&spec).expect("a lattice");
        let jaw_points = (upright.network.positions.len() - turned.network.positions.len()) / 2;
        let bonds = &upright.network.bonds;
        let ends = bonds.ends.iter().copied();
        let strengths: BTreeMap<[u32; 2], f64> =
            ends.zip(bonds.strengths.iter().copied()).collect();
        let bonds = &turned.network.bonds;
        assert!(bonds.len() > 26_000);
        for (ends, strength) in bonds.ends.iter().zip(&bonds.strengths) {
            let upright = ends.map(|node| node + jaw_points as u32);
            assert_eq!(strengths[&upright], *strength);
        }
    }
}
