//! A cell on its grids, the coarsest first.
use loadframe_api::spec::composite_cell::{Arrangement, CompositeCell};
use loadframe_harness::plan::Conclusion;
use loadframe_harness::{
    Interrupt, InterruptSource, Recorder, RunContext, SimulationError,
    checkpoint::{self, Fingerprint},
};

use super::results::{self, Strength, Values};
use crate::error::CompositeError;
use crate::homogenise::{Effective, Errors, Randomness, RoundFibre, UnitCell, fibre_places};
use crate::material::Material;

/// A cell that was brought to equilibrium.
pub(super) struct Tested {
    pub(super) cell: UnitCell,
    /// On the grid asked for, with errors by the coarser ones.
    pub(super) effective: Effective,
    pub(super) errors: Errors,
    /// Constants on the grids of a quarter and of half the cells along both sides, and on all.
    pub(super) grids: Vec<Values>,
    /// Stresses at which damage begins.
    pub(super) strengths: Vec<Strength>,
}

/// Cells along a side over those of the coarser grids and of the finest.
const DIVISORS: [u32; 3] = [4, 2, 1];
/// How far a test is before each grid.
const BEFORE: [f64; 3] = [0.0, 1.0 / 21.0, 5.0 / 21.0];

pub(super) fn conduct(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Conclusion<Tested>, SimulationError> {
    let fingerprint = Fingerprint::of(spec)?;
    // a cell takes seconds, so that one that was interrupted is begun anew
    if let Some(bytes) = context.checkpoint {
        fingerprint.check(checkpoint::unpack(bytes)?)?;
    }
    let cell = unit_cell(spec, context.interrupt)?;
    let cells = spec.cells();
    if context.checkpoint.is_none() {
        recorder.log(&format!(
            "{} fibres, {:.4} of the cell, on {} by {} cells of the grid",
            cell.fibres.len(),
            cell.fraction(),
            cells[0],
            cells[1]
        ));
    }
    let columns = results::columns();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    recorder.columns(&columns)?;
    let mut found = Vec::with_capacity(DIVISORS.len());
    let mut grids = Vec::with_capacity(DIVISORS.len());
    for (divisor, fraction) in DIVISORS.into_iter().zip(BEFORE) {
        recorder.progress(fraction, "grids");
        if let Some(interrupt) = context.interrupt.interrupt() {
            if interrupt == Interrupt::Suspend {
                recorder.checkpoint(&checkpoint::pack(&fingerprint)?)?;
            }
            return Ok(Conclusion::Interrupted(interrupt));
        }
        let effective = cell.effective(cells.map(|count| (count / divisor) as usize))?;
        let values = Values::of(&effective);
        recorder.point(&results::point(spec, &values))?;
        grids.push(values);
        found.push(effective);
    }
    let found: [Effective; 3] = found.try_into().map_err(|_| CompositeError::OtherSize)?;
    let [quarter, half, effective] = found;
    let errors = Errors::of(&effective, half, &quarter);
    let strengths = results::strengths(spec, &effective, &errors)?;
    Ok(Conclusion::Finished(Tested {
        cell,
        effective,
        errors,
        grids,
        strengths,
    }))
}

/// The cell that a spec describes.
///
/// # Errors
/// When there is no such cell; a cancel.
pub(super) fn unit_cell(
    spec: &CompositeCell,
    interrupt: &dyn InterruptSource,
) -> Result<UnitCell, CompositeError> {
    let matrix = material(spec, &spec.matrix)?;
    let fibre = material(spec, &spec.fibre)?;
    match &spec.arrangement {
        Arrangement::Square(given) => {
            UnitCell::square(matrix, fibre, given.fibre_fraction, given.diameter_mm)
        }
        Arrangement::Hexagonal(given) => {
            UnitCell::hexagonal(matrix, fibre, given.fibre_fraction, given.diameter_mm)
        }
        Arrangement::Random(random) => {
            let random = Randomness {
                fraction: random.fibre_fraction,
                count: random.fibres as usize,
                diameter_mm: random.diameter_mm,
                gap_mm: random.least_gap * random.diameter_mm,
                seed: spec.seed,
            };
            let (fibres, size_mm) = fibre_places(&random, interrupt)?;
            Ok(UnitCell {
                size_mm,
                matrix,
                fibre,
                fibres,
            })
        }
        Arrangement::Measured(measured) => Ok(UnitCell {
            size_mm: measured.size_mm,
            matrix,
            fibre,
            fibres: measured
                .fibres
                .iter()
                .map(|fibre| RoundFibre {
                    centre_mm: fibre.centre_mm,
                    diameter_mm: fibre.diameter_mm,
                })
                .collect(),
        }),
    }
}

fn material(spec: &CompositeCell, name: &str) -> Result<Material, CompositeError> {
    spec.materials
        .get(name)
        .and_then(|material| material.elastic())
        .ok_or(CompositeError::OutOfRange {
            quantity: "the number of sets of elastic constants of a material",
            given: 0.0,
            allowed: "1",
        })
}
