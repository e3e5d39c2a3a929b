//! Strength of bonds.
use loadframe_harness::{
    SimulationError,
    rng::{Purpose, Streams},
};
use rand_distr::{Distribution, StandardNormal};

/// Log-normal strength s = s_bave exp(σ N(0, 1)) (10), the factor drawn again while it exceeds 2.
///
/// Source: [Zilka2022] section 1.2.3, which calls σ the mechanical irregularity; the limit of 2 is
/// there to avoid bonds that are too strong.
#[derive(Clone, Debug)]
pub(super) struct StrengthDistribution {
    /// s_bave [N].
    scale: f64,
    /// σ [-].
    sigma: f64,
    streams: Streams,
}

const LARGEST_FACTOR: f64 = 2.0;

impl StrengthDistribution {
    pub(super) fn new(scale: f64, sigma: f64, seed: u64) -> Self {
        Self {
            scale,
            sigma,
            streams: Streams::new(seed, Purpose::Strength),
        }
    }

    /// Strength of a bond [N], a function of its number alone.
    pub(super) fn of(&self, bond: usize) -> f64 {
        let mut generator = self.streams.of(bond);
        loop {
            let normal: f64 = StandardNormal.sample(&mut generator);
            let factor = (self.sigma * normal).exp();
            if factor <= LARGEST_FACTOR {
                return self.scale * factor;
            }
        }
    }
}

/// The strength of every bond, given by its number and perhaps a strength of its own: that one, else
/// one drawn; infinite when nothing breaks.
///
/// # Errors
/// [`SimulationError::Unbuildable`] when a bond needs a drawn strength and none is described.
pub(super) fn strengths(
    given: impl Iterator<Item = (usize, Option<f64>)>,
    distribution: Option<&StrengthDistribution>,
    breaks: bool,
) -> Result<Vec<f64>, SimulationError> {
    let missing = |bond| SimulationError::Unbuildable(format!("bond {bond} has no strength"));
    let strength = |(bond, given): (usize, Option<f64>)| match (given, distribution) {
        (Some(strength), _) => Ok(strength),
        (None, Some(distribution)) => Ok(distribution.of(bond)),
        (None, None) if breaks => Err(missing(bond)),
        (None, None) => Ok(f64::INFINITY),
    };
    given.map(strength).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "these numbers are exact")]
    use super::*;

    const SAMPLES: usize = 20_000;

    #[test]
    fn factors_follow_the_cut_log_normal_distribution() {
        let sigma = 0.365;
        let distribution = StrengthDistribution::new(3.397, sigma, 1);
        let logs: Vec<f64> = (0..SAMPLES)
            .map(|bond| (distribution.of(bond) / 3.397).ln())
            .collect();
        assert!(logs.iter().all(|log| *log <= LARGEST_FACTOR.ln()));
        // a normal distribution cut at z = ln 2/σ = 1.899 has mean −σ φ(z)/Φ(z)
        let cut: f64 = LARGEST_FACTOR.ln() / sigma;
        let density = (-0.5 * cut * cut).exp() / std::f64::consts::TAU.sqrt();
        let expected = -sigma * density / 0.971_22;
        let mean = logs.iter().sum::<f64>() / SAMPLES as f64;
        // four standard errors of the mean
        assert!((mean - expected).abs() < 4.0 * sigma / (SAMPLES as f64).sqrt());
    }

    #[test]
    fn without_scatter_every_bond_has_the_mean() {
        let distribution = StrengthDistribution::new(2.0, 0.0, 9);
        assert_eq!(distribution.of(3).to_bits(), 2.0_f64.to_bits());
    }

    #[test]
    fn own_strengths_do_not_shift_those_drawn() {
        let distribution = StrengthDistribution::new(1.0, 0.5, 4);
        let drawn = |given: [Option<f64>; 3]| {
            strengths(given.into_iter().enumerate(), Some(&distribution), true)
                .expect("all are known")
        };
        let (all, some) = (drawn([None; 3]), drawn([None, Some(7.0), None]));
        assert_eq!([all[0], 7.0, all[2]], some[..]);
        assert!(strengths([(0, None)].into_iter(), None, true).is_err());
    }
}
