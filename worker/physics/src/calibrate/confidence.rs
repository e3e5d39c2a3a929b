//! What is known of the parameters: intervals, and which the data cannot tell apart.
use loadframe_harness::statistics::Sample;
use nalgebra::{DMatrix, DVectorView};

use super::trials::{Halt, Trials};

/// Condition index of derivatives, their columns scaled to length 1, from which parameters are not
/// told apart: the threshold of strong collinearity in [BelsleyKuhWelsch1980].
pub(super) const LARGEST_CONDITION: f64 = 30.0;
/// A parameter that changes no measured quantity's residual by more than this per factor of e (or over
/// its range) has no effect that could be told from chance.
const LEAST_EFFECT: f64 = 0.01;
/// Share of a direction from which a parameter takes part in it.
const PART: f64 = 0.2;
/// Standard deviations of a normal variable that hold 95 %.
const NORMAL_95: f64 = 1.959_964;

/// What the trials around the best one say.
#[derive(Debug)]
pub(super) struct Confidence {
    /// 95 % interval of each coordinate, half its width; unknown without scatter, or where the
    /// parameter is one of those below.
    pub(super) half_widths: Vec<Option<f64>>,
    /// Parameters without effect.
    pub(super) idle: Vec<usize>,
    /// Parameters of which only a combination is known.
    pub(super) entangled: Vec<usize>,
    /// Largest over smallest singular value of the scaled derivatives.
    pub(super) condition: f64,
}

/// Takes derivatives to both sides of the best trial and tells what they leave open.
///
/// To first order specimen j alone would have been fitted best by θ − G rⱼ, with its residuals rⱼ and
/// the pseudo-inverse G of the derivatives. The scatter of these over the specimens gives the
/// interval of their mean by Student's t; deviations of the measured values, where they are
/// given, come in quadrature.
///
/// # Errors
/// An interrupt or what made a result impossible.
pub(super) fn confidence(trials: &mut Trials<'_>, best: usize) -> Result<Confidence, Halt> {
    let jacobian = derivatives(trials, best)?;
    let (rows, count) = jacobian.shape();
    let lengths: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
    let results = trials.setting.spec.measured.results.len();
    let effect = |index: usize| effect(jacobian.column(index), results);
    let (moving, idle): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|index| effect(*index) > LEAST_EFFECT);
    let mut confidence = Confidence {
        half_widths: vec![None; count],
        idle,
        entangled: Vec::new(),
        condition: 1.0,
    };
    if moving.is_empty() {
        return Ok(confidence);
    }
    // rows of zeros change nothing and leave as many singular values as parameters
    let scaled = DMatrix::from_fn(rows.max(moving.len()), moving.len(), |row, column| {
        let column = moving[column];
        if row < rows {
            jacobian[(row, column)] / lengths[column]
        } else {
            0.0
        }
    });
    let svd = scaled.svd(true, true);
    let largest = svd.singular_values.max();
    confidence.condition = largest / svd.singular_values.min();
    let least = largest / LARGEST_CONDITION;
    let (Some(left), Some(right)) = (&svd.u, &svd.v_t) else {
        return Ok(confidence);
    };
    for (place, index) in moving.iter().enumerate() {
        let values = svd.singular_values.iter().enumerate();
        let mut open = values.filter(|(_, value)| **value <= least);
        if open.any(|(direction, _)| right[(direction, place)].abs() > PART) {
            confidence.entangled.push(*index);
            continue;
        }
        // the row of G that belongs to this parameter
        let weight = |row: usize| -> f64 {
            let values = svd.singular_values.iter().enumerate();
            let known = values.filter(|(_, value)| **value > least);
            let terms = known.map(|(k, value)| right[(k, place)] * left[(row, k)] / value);
            terms.sum::<f64>() / lengths[*index]
        };
        let weights: Vec<f64> = (0..rows).map(weight).collect();
        confidence.half_widths[*index] = half_width(trials, best, &weights);
    }
    Ok(confidence)
}

/// The largest change of a measured quantity's residual, from the derivatives of all residuals,
/// `results` of them of results and the rest of the points of a curve.
///
/// A curve is one quantity: its n points are divided by √n, so that √Σ (∂rᵢ/∂θ)² over them is their
/// root mean square and does not depend on how densely it was measured.
fn effect(derivatives: DVectorView<'_, f64>, results: usize) -> f64 {
    let curve = derivatives.rows_range(results..);
    derivatives.rows(0, results).amax().max(curve.norm())
}

/// Half the width of the interval of Σ wᵢ rᵢ.
fn half_width(trials: &Trials<'_>, best: usize, weights: &[f64]) -> Option<f64> {
    let targets = trials.setting.targets;
    let specimens = trials.all()[best].values.iter();
    let sums = specimens.map(|values| {
        let residuals = targets.residuals(values);
        weights.iter().zip(residuals).map(|(w, r)| w * r).sum()
    });
    let sums: Vec<f64> = sums.collect();
    let scatter = Sample::of(&sums)?
        .interval
        .map(|[low, high]| 0.5 * (high - low));
    let measured = targets.all.iter().zip(weights);
    let measured: f64 = measured.map(|(t, w)| (w * t.deviation).powi(2)).sum();
    let measured = NORMAL_95 * measured.sqrt();
    let half = scatter.unwrap_or(0.0).hypot(measured);
    (scatter.is_some() || measured > 0.0).then_some(half)
}

/// ∂r/∂θ at the best trial, from differences to both sides, or to one where the range ends or a
/// result is unknown.
fn derivatives(trials: &mut Trials<'_>, best: usize) -> Result<DMatrix<f64>, Halt> {
    let point = trials.all()[best].point.clone();
    let coordinates = trials.setting.coordinates;
    let step = trials.setting.spec.difference_step;
    let moved = |index: usize, sign: f64| {
        let [low, high] = coordinates[index].range();
        let mut moved = point.clone();
        let end = point[index] + sign * coordinates[index].difference(step);
        moved[index] = end.clamp(low, high);
        moved
    };
    let count = point.len();
    let points: Vec<Vec<f64>> = (0..count)
        .flat_map(|index| [moved(index, -1.0), moved(index, 1.0)])
        .collect();
    let found = trials.at(&points)?;
    let centre = trials.residuals(best);
    let mut jacobian = DMatrix::zeros(centre.len(), count);
    for (index, pair) in found.chunks(2).enumerate() {
        let side = |place: usize| {
            let residuals = trials.residuals(pair[place]);
            let is_known = residuals.iter().all(|residual| residual.is_finite());
            let x = points[2 * index + place][index];
            if is_known {
                (x, residuals)
            } else {
                (point[index], centre.clone())
            }
        };
        let (low, high) = (side(0), side(1));
        let step = high.0 - low.0;
        if step > 0.0 {
            for row in 0..centre.len() {
                jacobian[(row, index)] = (high.1[row] - low.1[row]) / step;
            }
        }
    }
    Ok(jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    #[test]
    fn the_effect_on_a_curve_does_not_depend_on_its_number_of_points() {
        // half of the points move by 0.3 of the largest ordinate, the others by 0.4, over √n each:
        // √((0.3² + 0.4²)/2)
        let expected = 0.125_f64.sqrt();
        for points in [2, 10, 1_000, 20_000] {
            let share = f64::from(points).sqrt();
            let change = |index: usize| if index.is_multiple_of(2) { 0.3 } else { -0.4 };
            let curve = (0..points as usize).map(|index| change(index) / share);
            let results = [0.001, -0.25];
            let all = results.into_iter().chain(curve);
            let all = DVector::from_iterator(2 + points as usize, all);
            let found = effect(all.as_view(), 2);
            assert!((found - expected).abs() < 1e-12, "{points}: {found}");
        }
        // results count each, and need no curve
        let results = DVector::from_vec(vec![0.008, -0.009, 0.007]);
        assert!((effect(results.as_view(), 3) - 0.009).abs() < 1e-15);
    }
}
