//! How wrong results are for their grid and their solver: the same test on coarser grids and by the
//! equations of equilibrium.
use loadframe_api::{ErrorBasis, ErrorPart, Tenth};

use serde::{Deserialize, Serialize};

use super::comparison::Comparison;
use super::measured::Measured;

/// Results by name.
pub(super) type Values = Vec<(String, f64)>;

/// The same test in other ways.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Finding {
    /// On other grids, in the order of [`Comparison::grids`].
    pub(super) others: Vec<Values>,
    /// By the equations of equilibrium on the same grid, where another solver was asked for.
    pub(super) by_static: Option<Values>,
    /// On the exact lattice and the same grid, where the paper's was asked for.
    pub(super) exact: Option<Values>,
}

/// Order of convergence that is counted on at most, and at least: corners of supports and of loads
/// keep lattices and finite elements of this kind from the second.
const ORDERS: [f64; 2] = [0.5, 1.0];

/// Orders of convergence that three grids may show, to be followed to their limit; of larger ones the
/// largest counts that the cells can have where nothing grows without bound.
const STEADY: [f64; 2] = [1.0, 3.0];
const LARGEST_ORDER: f64 = 2.0;

/// What counts of the steps between grids where results wander, the finest two first.
const STEPS: [f64; 3] = [1.0, 1.0, 0.5];

/// Results below this share of another one may be what larger ones cancel to, and say nothing of it.
const LEAST_BESIDE: f64 = 0.05;

/// The order that is counted on where steps from grid to grid have this ratio.
fn order(ratio: f64) -> f64 {
    if ratio.is_nan() {
        ORDERS[1]
    } else if ratio > 0.0 {
        ratio.log2().clamp(ORDERS[0], ORDERS[1])
    } else {
        ORDERS[0]
    }
}

impl Finding {
    /// A value by its name.
    pub(super) fn of(values: &Values, name: &str) -> f64 {
        let found = values.iter().find(|(known, _)| known == name);
        found.map_or(f64::NAN, |(_, value)| *value)
    }

    /// How far a value is from that of ever finer grids.
    ///
    /// From coarser grids |f₁ − f₂| / (2ᵖ − 1), p from the third one where the three approach a limit,
    /// else the least; where results wander, of the largest step ([`Self::largest_step`]) of all results
    /// `beside` that have the unit, over their size: one of them can be small by chance, as where a thin
    /// fibre comes to fill a cell. From graded grids g the distance |f − g₁| and the error |g₁ − g₂| of that.
    pub(super) fn of_grid(
        &self,
        measured: &Measured,
        beside: &[Measured],
        comparison: Comparison,
    ) -> f64 {
        let other = |index: usize| {
            let all = self.others.get(index);
            all.map_or(f64::NAN, |all| Self::of(all, measured.name))
        };
        let (step, before) = (measured.value - other(0), other(0) - other(1));
        let size = measured.value.abs();
        let shares = beside
            .iter()
            .filter(|one| one.unit == measured.unit && one.value.abs() > LEAST_BESIDE * size)
            .map(|one| self.largest_step(one) / one.value.abs());
        match comparison {
            Comparison::None => f64::NAN,
            Comparison::Graded => step.abs() + before.abs(),
            Comparison::Coarser { wanders: true } => {
                let slow = 1.0 / (ORDERS[0].exp2() - 1.0);
                let own = self.largest_step(measured);
                slow * shares.map(|share| share * size).fold(own, f64::max)
            }
            Comparison::Coarser { wanders: false } => {
                step.abs() / (order(before / step).exp2() - 1.0)
            }
        }
    }

    /// The largest step of a result between grids that follow each other, that of the coarsest two of
    /// four by half.
    ///
    /// Where fibres are cut, cells are too soft at the cut and too stiff in the matrix beside it. Both
    /// errors can cancel on three grids in a row, which then agree far from the truth: a fibre at 75° did
    /// on 50 to 200 cells, by a third of the error. The step before these three still shows them; two
    /// grids later half of it is left by the first order, the one that is counted on.
    fn largest_step(&self, measured: &Measured) -> f64 {
        let others = self.others.iter().map(|all| Self::of(all, measured.name));
        let all: Vec<f64> = std::iter::once(measured.value).chain(others).collect();
        let steps = all.windows(2).map(|pair| (pair[0] - pair[1]).abs());
        // max takes the number of a number and what is none
        steps
            .zip(STEPS)
            .map(|(step, part)| part * step)
            .fold(f64::NAN, f64::max)
    }

    /// What a result on ever finer grids tends to, with how far off that may be.
    ///
    /// Richardson's f₁ + (f₁ − f₂) / (2ᵖ − 1), p as the three grids show it; the error is what is added,
    /// on seven clamped sections 0.8 to 160 times the true one, 4 times in the median. `None` where they do not approach a limit steadily, as methods of the first to the third
    /// order do, and of other solvers, whose own error would grow with it.
    pub(super) fn limit(&self, measured: &Measured, comparison: Comparison) -> Option<[f64; 2]> {
        let (Comparison::Coarser { wanders: false }, None) = (comparison, &self.by_static) else {
            return None;
        };
        let [first, second] = [self.others.first()?, self.others.get(1)?]
            .map(|values| Self::of(values, measured.name));
        let step = measured.value - first;
        let ratio = (first - second) / step;
        let is_steady = (STEADY[0].exp2()..=STEADY[1].exp2()).contains(&ratio);
        is_steady.then(|| {
            let order = ratio.log2().min(LARGEST_ORDER);
            let rest = step / (order.exp2() - 1.0);
            [measured.value + rest, rest.abs()]
        })
    }

    /// How many times as many cells along a side make the error a tenth, by the order that is counted
    /// on; `None` where results wander or no other grids were looked at.
    fn finer_by(&self, measured: &Measured, comparison: Comparison) -> Option<f64> {
        let Comparison::Coarser { wanders: false } = comparison else {
            return None;
        };
        let [first, second] = [self.others.first()?, self.others.get(1)?]
            .map(|values| Self::of(values, measured.name));
        let order = order((first - second) / (measured.value - first));
        Some(10.0_f64.powf(1.0 / order))
    }

    fn of_solver(&self, measured: &Measured) -> f64 {
        let exact = self.by_static.as_ref();
        exact.map_or(f64::NAN, |all| {
            (measured.value - Self::of(all, measured.name)).abs()
        })
    }

    /// All that is known of how wrong a result is; nothing where nothing is known of its grid, for the solver's
    /// part alone, a thousandth of it, would pass for the whole.
    /// `tenth` tells what a grid that is so many times finer costs.
    pub(super) fn parts(
        &self,
        measured: &Measured,
        beside: &[Measured],
        comparison: Comparison,
        tenth: impl Fn(f64) -> Option<Tenth>,
    ) -> Vec<ErrorPart> {
        let grid = self.of_grid(measured, beside, comparison);
        if grid.is_nan() {
            return Vec::new();
        }
        let tenth = self.finer_by(measured, comparison).and_then(tenth);
        let grid = ErrorPart::new("grid", grid, ErrorBasis::TwoGrids).with_tenth(tenth);
        let mut parts = vec![grid];
        if self.by_static.is_some() {
            parts.push(ErrorPart::new(
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

/// The result that stands for all: the force of a test that breaks or in which faces are moved, else the first of
/// these that a test has.
const MAIN: [&str; 4] = [
    "flexural_modulus",
    "effective_modulus",
    "effective_shear_modulus",
    "mean_top_deflection",
];

/// The result that stands for all.
pub(super) fn main(measured: &[Measured]) -> Option<&Measured> {
    let find = |name: &str| measured.iter().find(|one| one.name == name);
    // where faces are moved their deflections are given, the same on every grid; the force is not
    let is_moved = find("mean_top_deflection").is_some() && find("max_force").is_some();
    if is_moved || find("first_crack_force").is_some() {
        return find("max_force");
    }
    MAIN.iter().find_map(|name| find(name))
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

    fn finding(coarser: &[f64]) -> Finding {
        Finding {
            others: coarser
                .iter()
                .map(|value| vec![("some".to_owned(), *value)])
                .collect(),
            ..Finding::default()
        }
    }

    const CONVERGING: Comparison = Comparison::Coarser { wanders: false };

    #[test]
    fn the_error_of_a_first_order_method_is_what_is_left_of_it() {
        // 1 + h at h = 1/4, 1/2, 1
        let error = finding(&[1.5, 2.0]).of_grid(&measured(1.25), &[], CONVERGING);
        assert!((error - 0.25).abs() < 1e-12, "{error}");
        // a faster one is counted as of first order
        let error = finding(&[1.25, 2.0]).of_grid(&measured(1.0625), &[], CONVERGING);
        assert!((error - 0.1875).abs() < 1e-12, "{error}");
        // one that has not begun to converge as of half an order
        let error = finding(&[1.0, 2.0]).of_grid(&measured(1.5), &[], CONVERGING);
        assert!(
            (error - 0.5 / (2.0_f64.sqrt() - 1.0)).abs() < 1e-12,
            "{error}"
        );
        assert!(
            finding(&[])
                .of_grid(&measured(1.0), &[], CONVERGING)
                .is_nan()
        );
    }

    #[test]
    fn the_solver_alone_is_no_error_of_a_result() {
        let by_static = Some(vec![("some".to_owned(), 1.5)]);
        let parts = |coarser: &[f64], comparison| {
            let found = Finding {
                by_static: by_static.clone(),
                ..finding(coarser)
            };
            let parts = found.parts(&measured(1.25), &[], comparison, |_| None);
            parts.len()
        };
        assert_eq!(parts(&[1.5, 2.0], CONVERGING), 2);
        // as on the paper's lattice, which has no limit, and where there are no coarser grids
        assert_eq!(parts(&[], Comparison::None), 0);
        assert_eq!(parts(&[], CONVERGING), 0);
    }

    #[test]
    fn where_results_wander_the_larger_step_counts() {
        let wandering = Comparison::Coarser { wanders: true };
        let slow = 2.0_f64.sqrt() - 1.0;
        let error = finding(&[1.01, 1.5]).of_grid(&measured(1.0), &[], wandering);
        assert!((error - 0.49 / slow).abs() < 1e-12, "{error}");
        // three that agree, after a larger step
        let error = finding(&[1.01, 1.02, 1.22]).of_grid(&measured(1.0), &[], wandering);
        assert!((error - 0.1 / slow).abs() < 1e-12, "{error}");
        let error = finding(&[1.01, 1.02]).of_grid(&measured(1.5), &[], Comparison::Graded);
        assert!((error - 0.5).abs() < 1e-12, "{error}");
    }

    #[test]
    fn three_grids_of_a_second_order_tell_the_limit() {
        // 1 + h² at h = 1/4, 1/2, 1
        let found = finding(&[1.25, 2.0]).limit(&measured(1.0625), CONVERGING);
        let [limit, error] = found.unwrap();
        assert!((limit - 1.0).abs() < 1e-12 && (error - 0.0625).abs() < 1e-12);
        // steps that fall too slowly, too fast or in turns tell none, and neither do two grids
        for coarser in [&[1.1, 1.12] as &[f64], &[1.07, 2.0], &[1.0, 1.2], &[1.25]] {
            assert!(
                finding(coarser)
                    .limit(&measured(1.0625), CONVERGING)
                    .is_none()
            );
        }
        let wandering = Comparison::Coarser { wanders: true };
        let found = finding(&[1.25, 2.0]);
        assert!(found.limit(&measured(1.0625), wandering).is_none());
    }
}
