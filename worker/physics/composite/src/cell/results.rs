//! Values read off a cell.
use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_harness::csv;
use serde::{Deserialize, Serialize};

use crate::error::CompositeError;
use crate::homogenise::Effective;

/// A result of a cell.
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) description: &'static str,
}

/// Elastic constants in the order of [`crate::homogenise::Constants::values`].
pub(super) const CONSTANTS: [Kind; 9] = [
    Kind {
        name: "modulus_1",
        unit: "MPa",
        description: "Young's modulus along the fibres.",
    },
    Kind {
        name: "modulus_2",
        unit: "MPa",
        description: "Young's modulus across the fibres, along axis 2.",
    },
    Kind {
        name: "modulus_3",
        unit: "MPa",
        description: "Young's modulus across the fibres, along axis 3.",
    },
    Kind {
        name: "poisson_ratio_12",
        unit: "1",
        description: "Contraction along 2 over the strain along 1 when pulled along the fibres.",
    },
    Kind {
        name: "poisson_ratio_13",
        unit: "1",
        description: "Contraction along 3 over the strain along 1 when pulled along the fibres.",
    },
    Kind {
        name: "poisson_ratio_23",
        unit: "1",
        description: "Contraction along 3 over the strain along 2 when pulled along 2.",
    },
    Kind {
        name: "shear_modulus_12",
        unit: "MPa",
        description: "Shear modulus along the fibres, in the plane of 1 and 2.",
    },
    Kind {
        name: "shear_modulus_13",
        unit: "MPa",
        description: "Shear modulus along the fibres, in the plane of 1 and 3.",
    },
    Kind {
        name: "shear_modulus_23",
        unit: "MPa",
        description: "Shear modulus across the fibres.",
    },
];

/// The values of a cell on one grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Values {
    /// Cells of the grid along axis 2.
    pub(super) columns: u32,
    /// In the order of [`CONSTANTS`].
    pub(super) constants: [f64; 9],
}

pub(super) fn values(_spec: &CompositeCell, effective: &Effective) -> Result<Values, CompositeError> {
    Ok(Values {
        columns: effective.grid()[0] as u32,
        constants: effective.constants.values(),
    })
}

/// Names of the curve's columns.
pub(super) fn columns() -> Vec<String> {
    let constants = CONSTANTS.iter();
    let constants = constants.map(|kind| csv::column(kind.name, kind.unit));
    ["cells_per_fibre".to_owned()]
        .into_iter()
        .chain(constants)
        .collect()
}

/// The curve's point of a grid.
pub(super) fn point(spec: &CompositeCell, values: &Values) -> Vec<f64> {
    let [width, _] = spec.arrangement.size_mm();
    let pixel = width / f64::from(values.columns);
    let mut point = vec![spec.arrangement.least_diameter_mm() / pixel];
    point.extend(values.constants);
    point
}
