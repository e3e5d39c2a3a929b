//! Values read off a cell.
use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_harness::csv;

use crate::error::CompositeError;
use crate::homogenise::{Effective, Errors, Load, Part, PhaseStrength, Strengths};

/// A result of a cell.
#[derive(Clone, Copy, Debug)]
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

/// The constants of a cell on one grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Values {
    /// Cells of the grid along axis 2.
    columns: usize,
    /// In the order of [`CONSTANTS`].
    pub(super) constants: [f64; 9],
}

impl Values {
    pub(super) fn of(effective: &Effective) -> Self {
        Self {
            columns: effective.grid()[0],
            constants: effective.constants.values(),
        }
    }
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
    let cell = width / values.columns as f64;
    let mut point = vec![spec.arrangement.least_diameter_mm() / cell];
    point.extend(values.constants);
    point
}

/// A stress on the composite at which damage begins.
pub(super) struct Strength {
    pub(super) kind: Kind,
    pub(super) mpa: f64,
    /// How far it may be off for the grid [MPa].
    pub(super) error_mpa: f64,
    /// What is damaged first.
    pub(super) part: Part,
}

/// Stresses on the composite in the order 11, 22, 33, 23, 13, 12, and what the one that begins the
/// damage is called.
const LOADS: [([f64; 6], Kind); 5] = [
    (
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        Kind {
            name: "strength_along_tension",
            unit: "MPa",
            description: "Tension along the fibres at which damage begins",
        },
    ),
    (
        [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        Kind {
            name: "strength_along_compression",
            unit: "MPa",
            description: "Compression along the fibres at which damage begins, buckling left out",
        },
    ),
    (
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        Kind {
            name: "strength_across_tension",
            unit: "MPa",
            description: "Tension across the fibres, along axis 2, at which damage begins",
        },
    ),
    (
        [0.0, -1.0, 0.0, 0.0, 0.0, 0.0],
        Kind {
            name: "strength_across_compression",
            unit: "MPa",
            description: "Compression across the fibres, along axis 2, at which damage begins",
        },
    ),
    (
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        Kind {
            name: "strength_shear",
            unit: "MPa",
            description: "Shear along the fibres at which damage begins",
        },
    ),
];

/// Stresses at which damage begins; none where nothing has a strength.
pub(super) fn strengths(
    spec: &CompositeCell,
    effective: &Effective,
    errors: &Errors,
) -> Result<Vec<Strength>, CompositeError> {
    let limits = limits(spec);
    let mut all = Vec::new();
    if limits.are_none() {
        return Ok(all);
    }
    for (stress, kind) in LOADS {
        let load = Load::Stress(stress);
        let onset = effective.onset(&load, &limits)?;
        let Some((part, site)) = onset.first() else {
            continue;
        };
        let relative = errors.onset(&onset, &load, &limits)?[part as usize];
        all.push(Strength {
            kind,
            mpa: site.factor,
            error_mpa: relative.map_or(f64::NAN, |relative| relative * site.factor),
            part,
        });
    }
    Ok(all)
}

/// What begins damage, as far as materials have it.
fn limits(spec: &CompositeCell) -> Strengths {
    let strength = |name: &String| {
        let material = spec.materials.get(name);
        let limits = material.and_then(|material| material.strength);
        PhaseStrength {
            is_orthotropic: material.is_some_and(|material| material.orthotropic.is_some()),
            limits: limits.unwrap_or_default().into(),
        }
    };
    let fibre = spec.materials.get(&spec.fibre);
    Strengths {
        matrix: strength(&spec.matrix),
        fibre: strength(&spec.fibre),
        interface: fibre.and_then(|fibre| fibre.interface).map(Into::into),
    }
}
