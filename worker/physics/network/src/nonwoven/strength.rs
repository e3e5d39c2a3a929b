//! Strength of bonds.
use loadframe_api::spec::nonwoven_tensile::StrengthDraw;
use loadframe_harness::{
    SimulationError,
    rng::{Purpose, Streams},
};
use rand_distr::{Distribution, StandardNormal};

/// Log-normal strength s = s_bave exp(σ N(0, 1)) (10), the factor drawn again while it exceeds 2; or
/// normal strength s = s_bave (1 + σ N(0, 1)), the factor drawn again while it is below 0 or exceeds 2.
///
/// Source: [Zilka2022] section 1.2.3, which calls σ the mechanical irregularity and can be read in both
/// ways; the limit of 2 is there to avoid bonds that are too strong.
#[derive(Clone, Debug)]
pub(super) struct StrengthDistribution {
    /// s_bave [N].
    scale: f64,
    /// σ [-].
    sigma: f64,
    draw: StrengthDraw,
    streams: Streams,
}

const LARGEST_FACTOR: f64 = 2.0;

impl StrengthDistribution {
    pub(super) fn new(scale: f64, sigma: f64, draw: StrengthDraw, seed: u64) -> Self {
        Self {
            scale,
            sigma,
            draw,
            streams: Streams::new(seed, Purpose::Strength),
        }
    }

    /// Strength of a bond [N], a function of its number alone.
    pub(super) fn of(&self, bond: usize) -> f64 {
        let mut generator = self.streams.of(bond);
        loop {
            let normal: f64 = StandardNormal.sample(&mut generator);
            let factor = match self.draw {
                StrengthDraw::LogNormal => (self.sigma * normal).exp(),
                StrengthDraw::Normal => 1.0 + self.sigma * normal,
            };
            if (0.0..=LARGEST_FACTOR).contains(&factor) {
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
        let distribution = StrengthDistribution::new(3.397, sigma, StrengthDraw::LogNormal, 1);
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
    fn the_mean_of_what_is_drawn_is_what_the_spec_says_of_it() {
        // exp(σ²/2) Φ(c − σ)/Φ(c) with c = ln 2/σ = 1.899: 1.0689 times 0.9375/0.9712; and 1
        for (draw, expected) in [
            (StrengthDraw::LogNormal, 1.0318),
            (StrengthDraw::Normal, 1.0),
        ] {
            let distribution = StrengthDistribution::new(1.0, 0.365, draw, 2);
            let drawn: Vec<f64> = (0..SAMPLES).map(|bond| distribution.of(bond)).collect();
            assert!(
                drawn
                    .iter()
                    .all(|factor| (0.0..=LARGEST_FACTOR).contains(factor))
            );
            let mean = drawn.iter().sum::<f64>() / SAMPLES as f64;
            // four standard errors of the mean
            assert!(
                (mean - expected).abs() < 4.0 * 0.365 / (SAMPLES as f64).sqrt(),
                "{mean}"
            );
        }
    }

    #[test]
    fn without_scatter_every_bond_has_the_mean() {
        let distribution = StrengthDistribution::new(2.0, 0.0, StrengthDraw::Normal, 9);
        assert_eq!(distribution.of(3).to_bits(), 2.0_f64.to_bits());
    }

    #[test]
    fn own_strengths_do_not_shift_those_drawn() {
        let distribution = StrengthDistribution::new(1.0, 0.5, StrengthDraw::LogNormal, 4);
        let drawn = |given: [Option<f64>; 3]| {
            strengths(given.into_iter().enumerate(), Some(&distribution), true)
                .expect("all are known")
        };
        let (all, some) = (drawn([None; 3]), drawn([None, Some(7.0), None]));
        assert_eq!([all[0], 7.0, all[2]], some[..]);
        assert!(strengths([(0, None)].into_iter(), None, true).is_err());
    }
}
