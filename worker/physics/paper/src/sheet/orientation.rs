//! Which way fibres point in the plane.
use std::f64::consts::PI;

use rand::{Rng, RngExt as _};

use super::error::{SheetError, check};

/// Density of the angle between a fibre's chord and x, the machine direction; of period π, since a
/// fibre has no head. Weighted by length: what a sheet shows however its edges cut it.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Orientation {
    #[default]
    Uniform,
    /// ∝ exp(κ cos 2θ), about the machine direction: ⟨cos 2θ⟩ = I₁(κ)/I₀(κ).
    VonMises { kappa: f64 },
    /// Weights of equally wide bins of the angle from 0 to π, relative to their sum; even within
    /// each.
    Histogram { weights: Vec<f64> },
}

impl Orientation {
    pub(super) fn validate(&self) -> Result<(), SheetError> {
        match self {
            Self::Uniform => Ok(()),
            Self::VonMises { kappa } => {
                let is_allowed = (0.0..=1000.0).contains(kappa);
                check(is_allowed, "orientation: kappa", *kappa, "", "[0, 1000]")
            }
            Self::Histogram { weights } => {
                let name = "orientation: weights of the histogram";
                if weights.is_empty() {
                    let quantity = name.to_owned();
                    return Err(SheetError::Empty { quantity });
                }
                for weight in weights {
                    let is_weight = *weight >= 0.0 && weight.is_finite();
                    check(is_weight, name, *weight, "", "0 and above")?;
                }
                let sum: f64 = weights.iter().sum();
                let has_sum = sum > 0.0 && sum.is_finite();
                check(
                    has_sum,
                    "orientation: sum of the weights",
                    sum,
                    "",
                    "above 0",
                )
            }
        }
    }

    /// An angle [rad] within a range of π.
    pub(super) fn draw(&self, random: &mut impl Rng) -> f64 {
        match self {
            Self::Uniform => PI * random.random::<f64>(),
            Self::VonMises { kappa } if *kappa > 0.0 => 0.5 * von_mises(*kappa, random),
            Self::VonMises { .. } => PI * random.random::<f64>(),
            Self::Histogram { weights } => {
                let mut left = random.random::<f64>() * weights.iter().sum::<f64>();
                // rounding may leave something behind the last bin that has a weight
                let last = weights.iter().rposition(|weight| *weight > 0.0);
                let mut bin = 0;
                while Some(bin) != last && left >= weights[bin] {
                    left -= weights[bin];
                    bin += 1;
                }
                PI * (bin as f64 + random.random::<f64>()) / weights.len() as f64
            }
        }
    }
}

/// An angle of density ∝ exp(κ cos θ), −π..π, by rejection from a wrapped Cauchy distribution.
///
/// Source: [BestFisher1979]; the difference τ − √(2τ) is written so that small κ keep their digits.
fn von_mises(kappa: f64, random: &mut impl Rng) -> f64 {
    let root = (1.0 + 4.0 * kappa * kappa).sqrt();
    let tau = 1.0 + root;
    // τ − 2 = 4κ²/(1 + root)
    let over_two = 4.0 * kappa * kappa / tau;
    let rho = tau.sqrt() * over_two / (tau.sqrt() + 2.0_f64.sqrt()) / (2.0 * kappa);
    let r = (1.0 + rho * rho) / (2.0 * rho);
    loop {
        let cosine = (PI * random.random::<f64>()).cos();
        let f = (1.0 + r * cosine) / (r + cosine);
        let c = kappa * (r - f);
        let level = random.random::<f64>();
        if c * (2.0 - c) > level || (c / level).ln() + 1.0 >= c {
            let side = if random.random::<bool>() { 1.0 } else { -1.0 };
            return side * f.clamp(-1.0, 1.0).acos();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_harness::rng::{Purpose, Streams};

    const DRAWS: usize = 200_000;

    fn mean_cosine(orientation: &Orientation, multiple: f64) -> f64 {
        let mut random = Streams::new(3, Purpose::FibrePlaces).of(0);
        let cosines = (0..DRAWS).map(|_| (multiple * orientation.draw(&mut random)).cos());
        cosines.sum::<f64>() / DRAWS as f64
    }

    /// Iₙ(κ) = ∑ (κ/2)^(2k+n)/(k! (k+n)!)
    fn bessel(order: i32, kappa: f64) -> f64 {
        let mut term = (1..=order).fold(1.0, |term, k| term * 0.5 * kappa / f64::from(k));
        let mut sum = term;
        for k in 1..200 {
            term *= (0.5 * kappa).powi(2) / f64::from(k * (k + order));
            sum += term;
        }
        sum
    }

    #[test]
    fn moments_of_von_mises_are_ratios_of_bessel_functions() {
        for kappa in [1e-5, 0.1, 0.5, 1.0, 2.0, 5.0, 20.0] {
            let orientation = Orientation::VonMises { kappa };
            for order in [1, 2] {
                let expected = bessel(order, kappa) / bessel(0, kappa);
                let measured = mean_cosine(&orientation, 2.0 * f64::from(order));
                // the scatter of a cosine is at most 1/√2 about the mean of uniform angles, less
                // when they gather; four standard errors
                let bound = 4.0 * (0.5 / DRAWS as f64).sqrt();
                assert!(
                    (measured - expected).abs() < bound,
                    "{kappa} {order}: {measured} {expected}"
                );
            }
        }
    }

    #[test]
    fn uniform_angles_have_no_moments() {
        let bound = 4.0 * (0.5 / DRAWS as f64).sqrt();
        for multiple in [2.0, 4.0, 6.0] {
            assert!(mean_cosine(&Orientation::Uniform, multiple).abs() < bound);
        }
    }

    #[test]
    fn a_histogram_is_drawn_in_its_proportions() {
        let weights = vec![1.0, 0.0, 3.0, 4.0, 0.0];
        let orientation = Orientation::Histogram { weights };
        let mut random = Streams::new(3, Purpose::FibrePlaces).of(1);
        let mut counts = [0.0; 5];
        for _ in 0..DRAWS {
            let angle = orientation.draw(&mut random);
            assert!((0.0..PI).contains(&angle));
            counts[(angle / PI * 5.0) as usize] += 1.0 / DRAWS as f64;
        }
        for (count, share) in counts.iter().zip([0.125_f64, 0.0, 0.375, 0.5, 0.0]) {
            let scatter = (share * (1.0 - share) / DRAWS as f64).sqrt();
            assert!((count - share).abs() <= 4.0 * scatter, "{count} {share}");
        }
    }
}
