//! How large grains are.
use std::f64::consts::PI;

use loadframe_api::spec::granular_scene::Sizes as SpecSizes;
use rand::{Rng, RngExt as _};
use rand_distr::{Distribution as _, StandardNormal};

/// A log-normal radius is drawn again beyond so many standard deviations: one grain as large as
/// the box would end the run, and 0.3 % of the grains do not.
const LOG_NORMAL_CUT: f64 = 3.0;

/// Distribution of grain sizes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Sizes {
    /// One radius [m].
    Single(f64),
    /// Radii [m] between two, equally likely: r (0.6..1.4) in the thesis.
    Uniform { lower: f64, upper: f64 },
    /// Radius median · exp(σ N(0, 1)) [m], cut at 3 σ.
    LogNormal { median: f64, sigma: f64 },
    /// What lies between sieves, shares of the mass; they are taken relative to their sum.
    Sieve(Vec<Fraction>),
}

/// Grains between two sieves.
///
/// Within it the curve of mass passing over diameter is straight, as between the points of a
/// measured curve: the number of grains falls with d⁻³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fraction {
    /// Openings of the sieves [m], 0 < lower ≤ upper.
    pub(crate) lower_diameter: f64,
    pub(crate) upper_diameter: f64,
    /// Share of the mass [-].
    pub(crate) mass_share: f64,
}

/// How much to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Amount {
    /// So many grains; from a sieve curve the volume that holds so many of mean size, so that each
    /// fraction has its share and their number a scatter of a few.
    Count(usize),
    /// Grains of so much volume together [m³], to within half a grain, of each fraction.
    Volume(f64),
}

impl From<&SpecSizes> for Sizes {
    fn from(sizes: &SpecSizes) -> Self {
        match sizes {
            SpecSizes::RadiusM(radius) => Self::Single(*radius),
            SpecSizes::Uniform {
                smallest_radius_m,
                largest_radius_m,
            } => Self::Uniform {
                lower: *smallest_radius_m,
                upper: *largest_radius_m,
            },
            SpecSizes::LogNormal {
                median_radius_m,
                sigma,
            } => Self::LogNormal {
                median: *median_radius_m,
                sigma: *sigma,
            },
            SpecSizes::SieveCurve(fractions) => {
                let fractions = fractions.iter().map(|fraction| Fraction {
                    lower_diameter: fraction.smallest_diameter_m,
                    upper_diameter: fraction.largest_diameter_m,
                    mass_share: fraction.mass_share,
                });
                Self::Sieve(fractions.collect())
            }
        }
    }
}

impl Sizes {
    /// Radii [m] of an amount of grains, in the order drawn; fractions one after the other.
    pub(crate) fn draw(&self, amount: Amount, random: &mut impl Rng) -> Vec<f64> {
        match *self {
            Self::Single(radius) => repeat(amount, || radius),
            Self::Uniform { lower, upper } => {
                repeat(amount, || lower + (upper - lower) * random.random::<f64>())
            }
            Self::LogNormal { median, sigma } => repeat(amount, || {
                loop {
                    let normal: f64 = StandardNormal.sample(random);
                    if normal.abs() <= LOG_NORMAL_CUT {
                        break median * (sigma * normal).exp();
                    }
                }
            }),
            Self::Sieve(ref fractions) => sieve(fractions, amount, random),
        }
    }
}

fn repeat(amount: Amount, mut radius: impl FnMut() -> f64) -> Vec<f64> {
    match amount {
        Amount::Count(count) => (0..count).map(|_| radius()).collect(),
        Amount::Volume(volume) => fill(volume, radius),
    }
}

/// Gives every fraction its share of the volume.
fn sieve(fractions: &[Fraction], amount: Amount, random: &mut impl Rng) -> Vec<f64> {
    let shares: f64 = fractions.iter().map(|fraction| fraction.mass_share).sum();
    let volume = match amount {
        Amount::Volume(volume) => volume,
        // grains per volume: ∑ share over mean grain
        Amount::Count(count) => {
            let grains = fractions
                .iter()
                .map(|fraction| fraction.mass_share / fraction.mean_volume());
            count as f64 * shares / grains.sum::<f64>()
        }
    };
    let mut radii = Vec::new();
    for fraction in fractions {
        let part = volume * fraction.mass_share / shares;
        radii.extend(fill(part, || fraction.radius(random)));
    }
    radii
}

/// Draws grains until the next one would lead further from a volume.
fn fill(volume: f64, mut radius: impl FnMut() -> f64) -> Vec<f64> {
    let mut radii = Vec::new();
    let mut missing = volume;
    loop {
        let radius = radius();
        let grain = 4.0 / 3.0 * PI * radius.powi(3);
        if grain > 2.0 * missing {
            return radii;
        }
        missing -= grain;
        radii.push(radius);
    }
}

impl Fraction {
    /// Inverts the number of grains below a diameter, (d₁⁻² − d⁻²)/(d₁⁻² − d₂⁻²).
    fn radius(&self, random: &mut impl Rng) -> f64 {
        let [lower, upper] = [self.lower_diameter, self.upper_diameter].map(|d| d.powi(-2));
        let drawn = lower - random.random::<f64>() * (lower - upper);
        0.5 * drawn
            .powf(-0.5)
            .clamp(self.lower_diameter, self.upper_diameter)
    }

    /// Mean volume of its grains [m³]: π/6 ∫ d³ d⁻³ dd / ∫ d⁻³ dd = π/6 · 2 d₁² d₂²/(d₁ + d₂).
    fn mean_volume(&self) -> f64 {
        let (lower, upper) = (self.lower_diameter, self.upper_diameter);
        PI / 3.0 * (lower * upper).powi(2) / (lower + upper)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

    fn draw(sizes: &Sizes, amount: Amount) -> Vec<f64> {
        sizes.draw(amount, &mut ChaCha8Rng::seed_from_u64(3))
    }

    fn volume(radii: impl IntoIterator<Item = f64>) -> f64 {
        radii
            .into_iter()
            .map(|radius| 4.0 / 3.0 * PI * radius.powi(3))
            .sum()
    }

    /// 60 % by mass of 25-37.5 mm and 40 % of 37.5-50 mm: the specified sample of the experiments.
    fn ballast() -> Sizes {
        let fraction = |lower_diameter, upper_diameter, mass_share| Fraction {
            lower_diameter,
            upper_diameter,
            mass_share,
        };
        Sizes::Sieve(vec![
            fraction(0.025, 0.0375, 60.0),
            fraction(0.0375, 0.05, 40.0),
        ])
    }

    #[test]
    fn counts_and_bounds_are_kept() {
        let uniform = Sizes::Uniform {
            lower: 0.6,
            upper: 1.4,
        };
        let radii = draw(&uniform, Amount::Count(10_000));
        assert_eq!(radii.len(), 10_000);
        assert!(radii.iter().all(|radius| (0.6..1.4).contains(radius)));
        // standard error of the mean of a uniform distribution: 0.8/√12/√n
        let mean = radii.iter().sum::<f64>() / 1e4;
        assert!((mean - 1.0).abs() < 4.0 * 0.8 / 12.0_f64.sqrt() / 1e2);
        assert_eq!(draw(&Sizes::Single(0.5), Amount::Count(3)), [0.5; 3]);
        let log_normal = Sizes::LogNormal {
            median: 2.0,
            sigma: 0.3,
        };
        let radii = draw(&log_normal, Amount::Count(10_000));
        let logs: Vec<f64> = radii
            .iter()
            .map(|radius| (radius / 2.0).ln() / 0.3)
            .collect();
        assert!(logs.iter().all(|log| log.abs() <= 3.0));
        assert!((logs.iter().sum::<f64>() / 1e4).abs() < 4e-2);
        // a normal distribution cut at 3 has the variance 0.9733
        let variance = logs.iter().map(|log| log * log).sum::<f64>() / 1e4;
        assert!(
            (variance - 0.9733).abs() < 4.0 * (2.0_f64 / 1e4).sqrt(),
            "{variance}"
        );
    }

    #[test]
    fn a_volume_is_met_within_half_a_grain() {
        let uniform = Sizes::Uniform {
            lower: 0.6,
            upper: 1.4,
        };
        let off = volume(draw(&uniform, Amount::Volume(1000.0))) - 1000.0;
        assert!(off.abs() <= 0.5 * volume([1.4]), "{off}");
        assert_eq!(draw(&Sizes::Single(1.0), Amount::Volume(42.0)).len(), 10);
    }

    #[test]
    fn sieve_fractions_have_their_mass_within_one_grain() {
        for amount in [Amount::Volume(0.01), Amount::Count(500)] {
            let radii = draw(&ballast(), amount);
            let total = match amount {
                Amount::Volume(total) => total,
                Amount::Count(count) => {
                    assert!(radii.len().abs_diff(count) <= 25, "{}", radii.len());
                    volume(radii.iter().copied())
                }
            };
            for (lower, upper, share) in [(0.025, 0.0375, 0.6), (0.0375, 0.05, 0.4)] {
                let inside = |radius: &f64| (lower..upper).contains(&(2.0 * radius));
                let part = volume(radii.iter().copied().filter(inside));
                let off = part - share * total;
                assert!(off.abs() <= volume([0.5 * upper]), "{lower}: {off}");
            }
        }
    }

    /// Half the mass of a fraction passes a sieve half-way between its own.
    #[test]
    fn mass_is_even_over_the_diameters_of_a_fraction() {
        let radii = draw(&ballast(), Amount::Count(50_000));
        for (lower, upper) in [(0.025, 0.0375), (0.0375, 0.05)] {
            let passing = |sieve: f64| {
                let inside = |radius: &f64| (lower..sieve).contains(&(2.0 * radius));
                volume(radii.iter().copied().filter(inside))
            };
            for share in [0.25, 0.5, 0.75] {
                let measured = passing(lower + share * (upper - lower)) / passing(upper);
                // about 10 000 grains and more in a fraction
                assert!((measured - share).abs() < 0.02, "{share}: {measured}");
            }
        }
    }
}
