//! A cell on its grids, the coarsest first.
use loadframe_api::spec::composite_cell::{Arrangement, CompositeCell};
use loadframe_harness::plan::Conclusion;
use loadframe_harness::{
    Interrupt, Recorder, RunContext, SimulationError,
    checkpoint::{self, Fingerprint},
};
use serde::{Deserialize, Serialize};

use super::results::{self, Values};
use crate::error::CompositeError;
use crate::homogenise::{Effective, Randomness, RoundFibre, UnitCell, fibre_places};
use crate::material::Material;

/// A cell that was brought to equilibrium.
pub(super) struct Tested {
    pub(super) cell: UnitCell,
    /// On the grid asked for.
    pub(super) effective: Effective,
    /// Values on the grids of a quarter and of half the cells along both sides, and on all of them;
    /// of the coarser ones those that have enough.
    pub(super) grids: Vec<Values>,
}

/// What is known of the coarser grids.
#[derive(Serialize, Deserialize)]
struct Checkpoint {
    spec: Fingerprint,
    grids: Vec<Values>,
}

/// Work of grids over that of the finest, as far as progress tells.
const PARTS: [f64; 3] = [1.0 / 21.0, 5.0 / 21.0, 1.0];
/// Fewer cells along a side are no cell.
const FEWEST: u32 = 4;

pub(super) fn conduct(
    spec: &CompositeCell,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Conclusion<Tested>, SimulationError> {
    let fingerprint = Fingerprint::of(spec)?;
    let mut known = match context.checkpoint {
        Some(bytes) => {
            let checkpoint: Checkpoint = checkpoint::unpack(bytes)?;
            fingerprint.check(checkpoint.spec)?;
            checkpoint.grids
        }
        None => Vec::new(),
    };
    let cell = unit_cell(spec)?;
    let cells = spec.cells();
    let divisors = [4, 2, 1]
        .into_iter()
        .filter(|divisor| *divisor == 1 || cells.iter().all(|count| count / divisor >= FEWEST));
    let grids: Vec<[usize; 2]> = divisors
        .map(|divisor| cells.map(|count| (count / divisor) as usize))
        .collect();
    if context.checkpoint.is_none() {
        recorder.log(&format!(
            "{} fibres, {:.4} of the cell, on {} by {} cells of the grid",
            cell.fibres.len(),
            cell.fraction(),
            cells[0],
            cells[1]
        ));
    }
    recorder.columns(&results::columns())?;
    for values in &known {
        recorder.point(&results::point(spec, values))?;
    }
    let mut last = None;
    for (place, grid) in grids.iter().enumerate() {
        let is_last = place + 1 == grids.len();
        if place < known.len() && !is_last {
            continue;
        }
        match context.interrupt.interrupt() {
            Some(Interrupt::Suspend) => {
                known.truncate(grids.len() - 1);
                let state = Checkpoint {
                    spec: fingerprint,
                    grids: known,
                };
                recorder.checkpoint(&checkpoint::pack(&state)?)?;
                return Ok(Conclusion::Interrupted(Interrupt::Suspend));
            }
            Some(Interrupt::Cancel) => return Ok(Conclusion::Interrupted(Interrupt::Cancel)),
            None => {}
        }
        let effective = cell.effective(*grid)?;
        let values = results::values(spec, &effective)?;
        recorder.point(&results::point(spec, &values))?;
        known.push(values);
        recorder.progress(PARTS[place + PARTS.len() - grids.len()], "grids");
        if is_last {
            last = Some(effective);
        } else if recorder.checkpoint_due() {
            let state = Checkpoint {
                spec: fingerprint,
                grids: known.clone(),
            };
            recorder.checkpoint(&checkpoint::pack(&state)?)?;
        }
    }
    let effective = last.ok_or(CompositeError::OtherSize)?;
    Ok(Conclusion::Finished(Tested {
        cell,
        effective,
        grids: known,
    }))
}

/// The cell that a spec describes.
fn unit_cell(spec: &CompositeCell) -> Result<UnitCell, CompositeError> {
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
            let (fibres, size_mm) = fibre_places(&Randomness {
                fraction: random.fibre_fraction,
                count: random.fibres as usize,
                diameter_mm: random.diameter_mm,
                gap_mm: random.least_gap * random.diameter_mm,
                seed: spec.seed,
            })?;
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
