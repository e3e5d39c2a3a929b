//! Scatter of random cells: the same fibres at other places.
use loadframe_harness::statistics::Sample;

use super::UnitCell;
use super::constants::Constants;
use super::effective::{Effective, Load};
use super::onset::Strengths;
use super::places::{Randomness, fibre_places};
use crate::error::CompositeError;
use crate::material::Material;

/// Cells that differ in their seeds alone.
#[derive(Debug, Clone)]
pub struct RandomCells {
    pub matrix: Material,
    pub fibre: Material,
    /// Cell number n, from 0 on, has this seed + n.
    pub random: Randomness,
    /// Pixels along 2 and 3.
    pub grid: [usize; 2],
    /// Loads whose onset of damage is sought.
    pub loads: Vec<Load>,
    pub strengths: Strengths,
}

/// What random cells have in common, and how they differ.
#[derive(Debug, Clone)]
pub struct Ensemble {
    /// Constants of every cell.
    pub cells: Vec<Constants>,
    /// Of every load and every cell, the factor of the first onset; `None`: the load damages none.
    pub factors: Vec<Vec<Option<f64>>>,
}

impl RandomCells {
    /// Cell number `number`.
    ///
    /// # Errors
    /// As [`fibre_places`].
    pub fn cell(&self, number: usize) -> Result<UnitCell, CompositeError> {
        let (fibres, size_mm) = fibre_places(&Randomness {
            seed: self.random.seed.wrapping_add(number as u64),
            ..self.random
        })?;
        Ok(UnitCell {
            size_mm,
            matrix: self.matrix,
            fibre: self.fibre,
            fibres,
        })
    }
}

impl Ensemble {
    /// Solves `count` cells one after the other; `each` sees every one, and stops all by an error.
    ///
    /// # Errors
    /// As [`fibre_places`], [`UnitCell::effective`] and [`Effective::onset`]; what `each` returns.
    pub fn over_seeds(
        cells: &RandomCells,
        count: usize,
        mut each: impl FnMut(usize, &UnitCell, &Effective) -> Result<(), CompositeError>,
    ) -> Result<Self, CompositeError> {
        let mut ensemble = Self {
            cells: Vec::with_capacity(count),
            factors: vec![Vec::with_capacity(count); cells.loads.len()],
        };
        for number in 0..count {
            let cell = cells.cell(number)?;
            let effective = cell.effective(cells.grid)?;
            each(number, &cell, &effective)?;
            ensemble.cells.push(effective.constants);
            for (load, factors) in cells.loads.iter().zip(&mut ensemble.factors) {
                let onset = effective.onset(load, &cells.strengths)?;
                factors.push(onset.first().map(|(_, site)| site.factor));
            }
        }
        Ok(ensemble)
    }

    /// Mean, deviation and 95 % interval of each constant, in the order of [`Constants::NAMES`];
    /// `None` without cells.
    #[must_use]
    pub fn constants(&self) -> Option<[Sample; 9]> {
        let sample = |place: usize| {
            let values: Vec<f64> = self.cells.iter().map(|cell| cell.values()[place]).collect();
            Sample::of(&values)
        };
        let samples: Option<Vec<Sample>> = (0..9).map(sample).collect();
        samples?.try_into().ok()
    }

    /// The same of the onset of a load, by its number; `None` where a cell has no onset.
    #[must_use]
    pub fn onset(&self, load: usize) -> Option<Sample> {
        let factors: Option<Vec<f64>> = self.factors.get(load)?.iter().copied().collect();
        Sample::of(&factors?)
    }
}
