//! Mean and scatter of repeated measurements.
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Confidence of the interval of the mean.
const CONFIDENCE: f64 = 0.95;

/// What a sample says about its population.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub count: u32,
    pub mean: f64,
    /// s = √(Σ (x − x̄)²/(n − 1)), from two values on.
    pub deviation: Option<f64>,
    /// x̄ ± t s/√n with Student's t at n − 1 degrees of freedom: holds the population's mean in
    /// 95 of 100 samples of a normal population. From two values on.
    pub interval: Option<[f64; 2]>,
}

impl Sample {
    /// The statistics of `values`, summed in their order; `None` without any.
    pub fn of(values: &[f64]) -> Option<Self> {
        let count = u32::try_from(values.len())
            .ok()
            .filter(|count| *count > 0)?;
        let size = f64::from(count);
        // about the first value: equal values then have exactly their mean and no deviation
        let origin = values[0];
        let mean = origin + values.iter().map(|value| value - origin).sum::<f64>() / size;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = (count > 1).then(|| (squares / (size - 1.0)).sqrt());
        let half_width = deviation.and_then(|s| Some(student_t(count - 1)? * s / size.sqrt()));
        Some(Self {
            count,
            mean,
            deviation,
            interval: half_width.map(|half| [mean - half, mean + half]),
        })
    }
}

/// Whether two populations have different means, by their samples.
///
/// t = (x̄₂ − x̄₁)/√(s₁²/n₁ + s₂²/n₂), held against Student's distribution with
/// ν = (v₁ + v₂)²/(v₁²/(n₁ − 1) + v₂²/(n₂ − 1)) degrees of freedom, vᵢ = sᵢ²/nᵢ: the populations are
/// normal, their variances need not be equal, and the samples are independent. Source: [Welch1947].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// x̄₂ − x̄₁, in the unit of the values.
    pub difference: f64,
    /// Probability [-] of a difference this large, to either side, between samples of populations
    /// of the same mean.
    pub p: f64,
}

impl Welch {
    /// The test of two samples; `None` unless both have two values.
    pub fn test(first: &Sample, second: &Sample) -> Option<Self> {
        let difference = second.mean - first.mean;
        let part = |sample: &Sample| {
            let count = f64::from(sample.count);
            Some((sample.deviation?.powi(2) / count, count - 1.0))
        };
        let ((first, first_freedom), (second, second_freedom)) = (part(first)?, part(second)?);
        let variance = first + second;
        // samples without scatter have the same mean or have not
        if variance == 0.0 {
            let p = if difference == 0.0 { 1.0 } else { 0.0 };
            return Some(Self { difference, p });
        }
        let (first, second) = (first / variance, second / variance);
        let freedom = 1.0 / (first * first / first_freedom + second * second / second_freedom);
        let distribution = StudentsT::new(0.0, 1.0, freedom).ok()?;
        let t = difference.abs() / variance.sqrt();
        Some(Self {
            difference,
            p: 2.0 * distribution.sf(t),
        })
    }
}

/// The t that a variable of Student's distribution stays within, on both sides, with
/// [`CONFIDENCE`].
fn student_t(degrees_of_freedom: u32) -> Option<f64> {
    let distribution = StudentsT::new(0.0, 1.0, f64::from(degrees_of_freedom)).ok()?;
    Some(distribution.inverse_cdf(0.5 * (1.0 + CONFIDENCE)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;

    /// Tables of t give three decimals.
    const LAST_DIGIT: f64 = 0.000_51;

    #[test]
    fn student_t_is_that_of_the_tables() {
        let table = [
            (1, 12.706),
            (2, 4.303),
            (4, 2.776),
            (9, 2.262),
            (29, 2.045),
            (999, 1.962),
        ];
        for (degrees_of_freedom, tabulated) in table {
            let t = student_t(degrees_of_freedom).expect("there is a degree of freedom");
            assert!(
                (t - tabulated).abs() < LAST_DIGIT,
                "{degrees_of_freedom}: {t}"
            );
        }
    }

    #[test]
    fn student_t_of_one_and_two_degrees_has_closed_forms() {
        // p = 0.975: t₁ = tan(π (p − 1/2)), t₂ = (2p − 1)/√(2 p (1 − p))
        let closed = [
            (std::f64::consts::PI * 0.475).tan(),
            0.95 / (2.0 * 0.975 * 0.025_f64).sqrt(),
        ];
        for (degrees, closed) in (1..).zip(closed) {
            let t = student_t(degrees).expect("there is a degree of freedom");
            // what the incomplete beta function's inverse is good for
            assert!((t / closed - 1.0).abs() < 1e-8, "{t} {closed}");
        }
    }

    #[test]
    fn three_values_by_hand() {
        let sample = Sample::of(&[1.0, 2.0, 6.0]).expect("there are values");
        // squares 4 + 1 + 9 over 2
        assert_eq!(
            (sample.count, sample.mean, sample.deviation),
            (3, 3.0, Some(7.0_f64.sqrt()))
        );
        let [low, high] = sample.interval.expect("three values scatter");
        let half = 4.302_653 * (7.0_f64 / 3.0).sqrt();
        assert!((low - (3.0 - half)).abs() < 1e-5 && (high - (3.0 + half)).abs() < 1e-5);
    }

    #[test]
    fn equal_variances_and_counts_give_students_own_test() {
        // mean 2 and 5, variance 1 each, n = 3: t = 3/√(2/3), ν = 4, whose tail is closed:
        // p = 1 − x (3 − x²)/2 with x = t/√(t² + ν)
        let [first, second] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]].map(|values| Sample::of(&values));
        let (first, second) = (first.expect("values"), second.expect("values"));
        let t = 3.0 / (2.0_f64 / 3.0).sqrt();
        let x = t / (t * t + 4.0).sqrt();
        let p = 1.0 - x * (3.0 - x * x) / 2.0;
        let test = Welch::test(&first, &second).expect("two samples");
        assert_eq!(test.difference, 3.0);
        // what the incomplete beta function is good for
        assert!((test.p - p).abs() < 1e-12, "{} {p}", test.p);
        let back = Welch::test(&second, &first).expect("two samples");
        assert_eq!((back.difference, back.p), (-3.0, test.p));
    }

    #[test]
    fn unequal_variances_lower_the_degrees_of_freedom() {
        // v₁ = 0: ν = n₂ − 1 = 2, whose tail is closed: p = 1 − t/√(t² + 2)
        let first = Sample::of(&[1.0, 1.0, 1.0, 1.0]).expect("values");
        let second = Sample::of(&[1.0, 2.0, 6.0]).expect("values");
        let t = 2.0 / (7.0_f64 / 3.0).sqrt();
        let test = Welch::test(&first, &second).expect("two samples");
        assert!((test.p - (1.0 - t / (t * t + 2.0).sqrt())).abs() < 1e-12);
    }

    #[test]
    fn samples_without_scatter_are_equal_or_not_and_single_values_are_not_tested() {
        let p = |first: &[f64], second: &[f64]| {
            let [first, second] = [first, second].map(|values| Sample::of(values).expect("values"));
            Welch::test(&first, &second).map(|test| test.p)
        };
        assert_eq!(p(&[3.0, 3.0], &[3.0, 3.0, 3.0]), Some(1.0));
        assert_eq!(p(&[3.0, 3.0], &[4.0, 4.0]), Some(0.0));
        assert_eq!(p(&[3.0], &[4.0, 5.0]), None);
    }

    #[test]
    fn equal_values_do_not_scatter_and_one_value_says_nothing_of_scatter() {
        let sample = Sample::of(&[0.1; 7]).expect("there are values");
        assert_eq!(
            (sample.mean, sample.deviation, sample.interval),
            (0.1, Some(0.0), Some([0.1; 2]))
        );
        let sample = Sample::of(&[5.0]).expect("there is a value");
        assert_eq!(
            (sample.mean, sample.deviation, sample.interval),
            (5.0, None, None)
        );
        assert_eq!(Sample::of(&[]), None);
    }
}
