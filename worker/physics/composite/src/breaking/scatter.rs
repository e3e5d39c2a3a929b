//! Strengths that differ from place to place.
use loadframe_harness::rng::{Purpose, Streams};
use rand::Rng as _;
use statrs::distribution::{ContinuousCDF, LogNormal, Weibull};
use statrs::function::gamma::gamma;

use super::part::Part;
use crate::error::{CompositeError, positive};

/// How strengths scatter about their mean, which stays what was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ScatterLaw {
    /// By the weakest of many flaws, of modulus m from 0.5 to 1000 [Weibull1951].
    Weibull { modulus: f64 },
    /// The logarithm is normal with standard deviation σ, above 0 and at most 3.
    LogNormal { sigma: f64 },
}

/// Scatter of strengths: one factor for every part of every cell, a function of the seed and of the
/// cell's place.
///
/// All strengths of a part are multiplied by one factor X of mean 1. Its fracture energies are
/// multiplied by X²/⟨X²⟩: what is stronger is tougher alike, so that the mean energy is the given one
/// and a cell that is fine enough is so whatever it draws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    pub law: ScatterLaw,
    /// The volume V₀ [mm³] whose mean strength was given. Of a part of volume V the mean is then that
    /// times (V₀/V)^(1/m): the weakest link, for [`ScatterLaw::Weibull`] only. `None`: the given mean
    /// is that of a part of a cell, whatever its size, and the strength of the whole follows the grid.
    pub reference_volume_mm3: Option<f64>,
}

/// A scatter ready to be drawn from.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    streams: Streams,
    law: Option<(Distribution, f64)>,
    /// V₀ and 1/m.
    volume: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
enum Distribution {
    Weibull(Weibull),
    LogNormal(LogNormal),
}

impl Drawn {
    pub(crate) fn new(scatter: Option<&Scatter>, seed: u64) -> Result<Self, CompositeError> {
        let streams = Streams::new(seed, Purpose::CellStrength);
        let Some(scatter) = scatter else {
            return Ok(Self {
                streams,
                law: None,
                volume: None,
            });
        };
        let (distribution, mean_square, exponent) = match scatter.law {
            ScatterLaw::Weibull { modulus } => {
                let refused = CompositeError::OutOfRange {
                    quantity: "the Weibull modulus of strengths",
                    given: modulus,
                    allowed: "from 0.5 to 1000",
                };
                if !(0.5..=1000.0).contains(&modulus) {
                    return Err(refused);
                }
                let mean = gamma(1.0 + 1.0 / modulus);
                let law = Weibull::new(modulus, 1.0 / mean).map_err(|_| refused)?;
                let square = gamma(1.0 + 2.0 / modulus) / (mean * mean);
                (Distribution::Weibull(law), square, Some(1.0 / modulus))
            }
            ScatterLaw::LogNormal { sigma } => {
                let refused = CompositeError::OutOfRange {
                    quantity: "the standard deviation of the logarithm of strengths",
                    given: sigma,
                    allowed: "above 0 and at most 3",
                };
                if !(sigma > 0.0 && sigma <= 3.0) {
                    return Err(refused);
                }
                let law = LogNormal::new(-0.5 * sigma * sigma, sigma).map_err(|_| refused)?;
                (Distribution::LogNormal(law), (sigma * sigma).exp(), None)
            }
        };
        let volume = match (scatter.reference_volume_mm3, exponent) {
            (None, _) => None,
            (Some(volume), Some(exponent)) => Some([
                positive("the reference volume of strengths [mm³]", volume)?,
                exponent,
            ]),
            (Some(volume), None) => {
                return Err(CompositeError::OutOfRange {
                    quantity: "the reference volume of log-normal strengths [mm³]",
                    given: volume,
                    allowed: "absent: only Weibull strengths know how they follow the volume",
                });
            }
        };
        Ok(Self {
            streams,
            law: Some((distribution, mean_square)),
            volume,
        })
    }

    /// Gives each part of a cell its factors.
    pub(crate) fn draw(&self, cell: usize, volume_mm3: f64, parts: &mut [Part]) {
        let Some((distribution, mean_square)) = &self.law else {
            return;
        };
        let mut generator = self.streams.of(cell);
        for part in parts {
            // strictly between 0 and 1
            let uniform = ((generator.next_u64() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64;
            let factor = match distribution {
                Distribution::Weibull(law) => law.inverse_cdf(uniform),
                Distribution::LogNormal(law) => law.inverse_cdf(uniform),
            };
            part.toughness = factor * factor / mean_square;
            part.strength = factor;
            if let Some([reference, exponent]) = self.volume {
                part.strength *= (reference / (part.share * volume_mm3)).powf(exponent);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::breaking::part::BrokenPart;
    use crate::stiffness::Stiffness;

    fn factors(scatter: Scatter, volume_mm3: f64) -> Vec<[f64; 2]> {
        let drawn = Drawn::new(Some(&scatter), 11).unwrap();
        let part = Part {
            cell: 0,
            kind: BrokenPart::Matrix,
            law: 0,
            stage: 0,
            along: [1.0, 0.0],
            beside: [1.0, 0.0],
            share: 0.5,
            stiffness: Stiffness::identity(),
            bed: [0.0; 2],
            strength: 1.0,
            toughness: 1.0,
        };
        (0..20_000)
            .map(|cell| {
                let mut parts = [part];
                drawn.draw(cell, volume_mm3, &mut parts);
                [parts[0].strength, parts[0].toughness]
            })
            .collect()
    }

    #[test]
    fn drawn_strengths_have_the_mean_and_the_spread_of_their_law() {
        let weibull = ScatterLaw::Weibull { modulus: 5.0 };
        // of Weibull's law with modulus 5 the coefficient of variation is 0.2291, of the log-normal
        // one √(exp σ² - 1)
        let log_normal = ScatterLaw::LogNormal { sigma: 0.3 };
        for (law, variation) in [(weibull, 0.2291), (log_normal, 0.3069)] {
            let scatter = Scatter {
                law,
                reference_volume_mm3: None,
            };
            let drawn = factors(scatter, 1.0);
            let count = drawn.len() as f64;
            let mean = drawn.iter().map(|[strength, _]| strength).sum::<f64>() / count;
            let toughness = drawn.iter().map(|[_, toughness]| toughness).sum::<f64>() / count;
            let square = drawn.iter().map(|[s, _]| (s - mean).powi(2)).sum::<f64>() / count;
            // five standard errors of 20 000 draws
            let error = 5.0 * variation / count.sqrt();
            assert!((mean - 1.0).abs() < error, "{mean}");
            assert!((toughness - 1.0).abs() < 3.0 * error, "{toughness}");
            assert!((square.sqrt() / variation - 1.0).abs() < 0.04, "{square}");
        }
    }

    #[test]
    fn the_weakest_link_makes_small_parts_stronger() {
        let scatter = |reference_volume_mm3| Scatter {
            law: ScatterLaw::Weibull { modulus: 5.0 },
            reference_volume_mm3,
        };
        let plain = factors(scatter(None), 2.0);
        let scaled = factors(scatter(Some(32.0)), 2.0);
        // half of a cell of 2 mm³ is a 32nd of 32 mm³: 32^(1/5) = 2
        for (plain, scaled) in plain.iter().zip(&scaled).take(50) {
            assert!((scaled[0] / plain[0] - 2.0).abs() < 1e-12);
            assert_eq!(scaled[1].to_bits(), plain[1].to_bits());
        }
    }
}
