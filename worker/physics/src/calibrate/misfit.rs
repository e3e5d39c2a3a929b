//! Residuals: what was simulated against what was measured.
use loadframe_api::{
    Report,
    spec::calibrate::{Measured, MeasuredCurve},
};
use loadframe_harness::{SimulationError, curve::interpolate, plan::Curve};

/// A measured number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub(super) measured: f64,
    /// What a difference of one residual is.
    pub(super) scale: f64,
    /// Standard deviation of the residual that the measurement itself has; 0 where it is not given.
    pub(super) deviation: f64,
}

/// The measured numbers: results first, then the ordinates of the curve.
#[derive(Debug)]
pub(super) struct Targets<'a> {
    measured: &'a Measured,
    pub(super) all: Vec<Target>,
}

impl<'a> Targets<'a> {
    pub(super) fn new(measured: &'a Measured) -> Self {
        let results = measured.results.iter().map(|result| Target {
            measured: result.value,
            scale: result.deviation.unwrap_or(result.value.abs()),
            deviation: f64::from(u8::from(result.deviation.is_some())),
        });
        let curve = measured.curve.iter().flat_map(|curve| {
            // the whole curve counts as much as one result
            let share = (curve.rows.len() as f64).sqrt();
            let ordinates = curve.rows.iter().map(|[_, y]| y.abs());
            let largest = ordinates.fold(0.0, f64::max);
            let scale = share * curve.deviation.unwrap_or(largest);
            let deviation = curve.deviation.map_or(0.0, |_| 1.0 / share);
            curve.rows.iter().map(move |[_, y]| Target {
                measured: *y,
                scale,
                deviation,
            })
        });
        Self {
            measured,
            all: results.chain(curve).collect(),
        }
    }

    /// Measured quantities, of which a curve is one.
    pub(super) fn quantities(&self) -> usize {
        self.measured.results.len() + usize::from(self.measured.curve.is_some())
    }

    /// Whether residuals are parts of measured values, not of deviations.
    pub(super) fn is_relative(&self) -> bool {
        self.all.iter().all(|target| target.deviation == 0.0)
    }

    /// The simulated numbers of one specimen, NaN where it does not know them.
    ///
    /// # Errors
    /// When the job has no such result or column, or has it in another unit.
    pub(super) fn read(&self, report: &Report, curve: &Curve) -> Result<Vec<f64>, SimulationError> {
        let mut values = Vec::with_capacity(self.all.len());
        for measured in &self.measured.results {
            let name = &measured.result;
            let Some(quantity) = report.summary.get(name) else {
                let known: Vec<&str> = report.summary.keys().map(String::as_str).collect();
                return Err(SimulationError::Calibration(format!(
                    "the job has no result named {name:?}; it has: {}",
                    known.join(", ")
                )));
            };
            if measured
                .unit
                .as_ref()
                .is_some_and(|unit| *unit != quantity.unit)
            {
                let unit = measured.unit.as_deref().unwrap_or_default();
                return Err(SimulationError::Calibration(format!(
                    "{name} was measured in {unit:?}, but the job gives it in {:?}",
                    quantity.unit
                )));
            }
            values.push(quantity.value.unwrap_or(f64::NAN));
        }
        if let Some(measured) = &self.measured.curve {
            let points = points(measured, curve)?;
            let read = |[x, _]: &[f64; 2]| read_at(&points, *x);
            values.extend(measured.rows.iter().map(read));
        }
        Ok(values)
    }

    /// Residuals of means over specimens.
    pub(super) fn residuals(&self, means: &[f64]) -> Vec<f64> {
        let pairs = self.all.iter().zip(means);
        pairs
            .map(|(target, mean)| (mean - target.measured) / target.scale)
            .collect()
    }

    /// √(Σ r²/N) over the N measured quantities.
    pub(super) fn misfit(&self, residuals: &[f64]) -> f64 {
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        (squares / self.quantities().max(1) as f64).sqrt()
    }

    /// A misfit in words.
    pub(super) fn words(&self, misfit: f64) -> String {
        /// Below this, decimals would show zeros only.
        const SMALL: f64 = 1e-4;
        match (self.is_relative(), misfit > 0.0 && misfit < SMALL) {
            (true, false) => format!("{:.2} %", 100.0 * misfit),
            (true, true) => format!("{:.1e} %", 100.0 * misfit),
            (false, false) => format!("{misfit:.3}"),
            (false, true) => format!("{misfit:.1e}"),
        }
    }
}

/// The two columns of a simulated curve that were measured.
fn points(measured: &MeasuredCurve, curve: &Curve) -> Result<Vec<(f64, f64)>, SimulationError> {
    let known = || {
        let known = curve.columns.join(", ");
        SimulationError::Calibration(match &measured.columns {
            Some([x, y]) => {
                format!("the job's curve has no columns named {x:?} and {y:?}; it has: {known}")
            }
            None => "the job gives no curve".to_owned(),
        })
    };
    let [x, y] = match &measured.columns {
        Some(names) => names.each_ref().map(|name| curve.column(name)),
        None => [0, 1].map(|column| (column < curve.columns.len()).then_some(column)),
    };
    let (Some(x), Some(y)) = (x, y) else {
        return Err(known());
    };
    Ok(curve.rows().map(|row| (row[x], row[y])).collect())
}

/// Ordinate at `x`, where the curve first gets there; beyond its ends that of the end.
fn read_at(points: &[(f64, f64)], x: f64) -> f64 {
    let end = match points.first() {
        Some(first) if x < first.0 => Some(first),
        _ => points.last(),
    };
    let end = end.map_or(f64::NAN, |(_, y)| *y);
    interpolate(points, x).unwrap_or(end)
}

/// The mean of each number over specimens, NaN where one of them does not know it.
pub(super) fn means(specimens: &[Vec<f64>]) -> Vec<f64> {
    let count = specimens.first().map_or(0, Vec::len);
    let mean = |index: usize| {
        let values = specimens.iter().map(|values| values[index]);
        values.sum::<f64>() / specimens.len() as f64
    };
    (0..count).map(mean).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;
    use loadframe_api::spec::calibrate::MeasuredResult;

    fn measured() -> Measured {
        let result = |value: f64, deviation| MeasuredResult {
            result: "a".to_owned(),
            value,
            deviation,
            unit: None,
        };
        Measured {
            results: vec![result(-4.0, None), result(10.0, Some(0.5))],
            curve: Some(MeasuredCurve {
                rows: vec![[0.0, 0.0], [1.0, 8.0], [2.0, -2.0], [3.0, 1.0]],
                ..MeasuredCurve::default()
            }),
        }
    }

    #[test]
    fn residuals_are_parts_of_values_or_deviations_and_a_curve_counts_once() {
        let measured = measured();
        let targets = Targets::new(&measured);
        let residuals = targets.residuals(&[-5.0, 11.0, 0.0, 10.0, 0.0, 1.0]);
        // the curve's points over √4 and the largest ordinate, 8
        assert_eq!(residuals, [-0.25, 2.0, 0.0, 2.0 / 16.0, 2.0 / 16.0, 0.0]);
        let squares = 0.0625 + 4.0 + 2.0 / 64.0;
        assert_eq!(targets.misfit(&residuals), (squares / 3.0_f64).sqrt());
        assert!(!targets.is_relative());
    }

    #[test]
    fn curves_are_read_between_their_points_and_held_beyond_their_ends() {
        let points = [(1.0, 2.0), (2.0, 6.0)];
        let read = [0.0, 1.0, 1.25, 2.0, 9.0].map(|x| read_at(&points, x));
        assert_eq!(read, [2.0, 2.0, 3.0, 6.0, 6.0]);
        assert!(read_at(&[], 1.0).is_nan());
    }

    #[test]
    fn one_specimen_that_does_not_know_leaves_the_mean_unknown() {
        let found = means(&[vec![1.0, 2.0], vec![3.0, f64::NAN]]);
        assert_eq!(found[0], 2.0);
        assert!(found[1].is_nan());
    }
}
