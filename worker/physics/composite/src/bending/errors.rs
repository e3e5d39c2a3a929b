//! How wrong results are for their grid and their solver: the same test on coarser grids and by the
//! equations of equilibrium.
use loadframe_api::spec::composite_bending::Grid;
use loadframe_api::{ErrorBasis, ErrorPart};

use serde::{Deserialize, Serialize};

use super::model::Fineness;
use super::results::Measured;

/// Results by name.
pub(super) type Values = Vec<(String, f64)>;

/// The same test in other ways.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Finding {
    /// On coarser and coarser grids.
    pub(super) coarser: Vec<(Fineness, Values)>,
    /// By the equations of equilibrium on the same grid, where another solver was asked for.
    pub(super) by_static: Option<Values>,
    /// On the exact lattice and the same grid, where the paper's was asked for.
    pub(super) exact: Option<Values>,
}

/// Half and a quarter of the cells along both sides and in contacts, as far as there are cells.
pub(super) fn coarser(finest: Fineness) -> Vec<Fineness> {
    let mut all = Vec::new();
    let mut finer = finest;
    for _ in 0..2 {
        if finer.grid.cells.iter().any(|count| *count < 2) {
            break;
        }
        let grid = finer.grid;
        finer = Fineness {
            grid: Grid {
                cells: grid.cells.map(|count| count.div_ceil(2)),
                graded_cells_per_fibre: grid.graded_cells_per_fibre.map(|count| count.div_ceil(2)),
            },
            contact_cells: finer.contact_cells.div_ceil(2),
        };
        all.push(finer);
    }
    all
}

/// Order of convergence that is counted on at most, and at least: corners of supports and of loads
/// keep lattices and finite elements of this kind from the second.
const ORDERS: [f64; 2] = [0.5, 1.0];

impl Finding {
    /// A value by its name.
    pub(super) fn of(values: &Values, name: &str) -> f64 {
        let found = values.iter().find(|(known, _)| known == name);
        found.map_or(f64::NAN, |(_, value)| *value)
    }

    /// |f₁ − f₂| / (2ᵖ − 1) of a value and that of half the cells, p from a third one where the three
    /// approach a limit.
    pub(super) fn of_grid(&self, measured: &Measured) -> f64 {
        let coarse = |index: usize| {
            let grid = self.coarser.get(index);
            grid.map_or(f64::NAN, |(_, all)| Self::of(all, measured.name))
        };
        let (step, before) = (measured.value - coarse(0), coarse(0) - coarse(1));
        let ratio = before / step;
        let order = if ratio.is_nan() {
            ORDERS[1]
        } else if ratio > 0.0 {
            ratio.log2().clamp(ORDERS[0], ORDERS[1])
        } else {
            ORDERS[0]
        };
        step.abs() / (order.exp2() - 1.0)
    }

    fn of_solver(&self, measured: &Measured) -> f64 {
        let exact = self.by_static.as_ref();
        exact.map_or(f64::NAN, |all| {
            (measured.value - Self::of(all, measured.name)).abs()
        })
    }

    /// All that is known of how wrong a result is.
    pub(super) fn parts(&self, measured: &Measured) -> Vec<ErrorPart> {
        let part = |source: &str, value, basis| ErrorPart {
            source: source.to_owned(),
            value,
            basis,
        };
        let mut parts = vec![part("grid", self.of_grid(measured), ErrorBasis::TwoGrids)];
        if self.by_static.is_some() {
            parts.push(part(
                "solver",
                self.of_solver(measured),
                ErrorBasis::TwoSolvers,
            ));
        }
        parts
    }

    /// How many times stiffer the paper's lattice is than the exact one, by the test's main result.
    pub(super) fn stiffer(&self, measured: &[Measured]) -> Option<f64> {
        let exact = self.exact.as_ref()?;
        let main = main(measured)?;
        let ratio = main.value / Self::of(exact, main.name);
        Some(if main.unit == "mm" {
            1.0 / ratio
        } else {
            ratio
        })
    }
}

/// The result that stands for all, the first of these that a test has.
const MAIN: [&str; 4] = [
    "flexural_modulus",
    "effective_modulus",
    "effective_shear_modulus",
    "mean_top_deflection",
];

/// The result that stands for all.
pub(super) fn main(measured: &[Measured]) -> Option<&Measured> {
    MAIN.iter()
        .find_map(|name| measured.iter().find(|one| one.name == *name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(value: f64) -> Measured {
        Measured {
            name: "some",
            value,
            unit: "mm",
            description: "",
        }
    }

    fn fineness(cells: [u32; 2]) -> Fineness {
        Fineness {
            grid: Grid {
                cells,
                graded_cells_per_fibre: Some(2),
            },
            contact_cells: 4,
        }
    }

    fn finding(coarser: &[f64]) -> Finding {
        Finding {
            coarser: coarser
                .iter()
                .map(|value| (fineness([1, 1]), vec![("some".to_owned(), *value)]))
                .collect(),
            ..Finding::default()
        }
    }

    #[test]
    fn the_error_of_a_first_order_method_is_what_is_left_of_it() {
        // 1 + h at h = 1/4, 1/2, 1
        let error = finding(&[1.5, 2.0]).of_grid(&measured(1.25));
        assert!((error - 0.25).abs() < 1e-12, "{error}");
        // a faster one is counted as of first order
        let error = finding(&[1.25, 2.0]).of_grid(&measured(1.0625));
        assert!((error - 0.1875).abs() < 1e-12, "{error}");
        // one that has not begun to converge as of half an order
        let error = finding(&[1.0, 2.0]).of_grid(&measured(1.5));
        assert!(
            (error - 0.5 / (2.0_f64.sqrt() - 1.0)).abs() < 1e-12,
            "{error}"
        );
        assert!(finding(&[]).of_grid(&measured(1.0)).is_nan());
    }

    #[test]
    fn coarser_grids_have_half_the_cells() {
        let all = coarser(fineness([9, 3]));
        let cells: Vec<_> = all.iter().map(|one| one.grid.cells).collect();
        assert_eq!(cells, [[5, 2], [3, 1]]);
        assert_eq!(all[1].grid.graded_cells_per_fibre, Some(1));
        assert_eq!(all[1].contact_cells, 1);
        assert!(coarser(fineness([4, 1])).is_empty());
    }
}
