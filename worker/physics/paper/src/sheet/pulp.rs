//! What fibres a pulp has.
use std::f64::consts::PI;

use rand::{Rng, RngExt as _};
use rand_distr::{Distribution as _, StandardNormal};
use statrs::distribution::{ContinuousCDF as _, Normal};

use super::error::{SheetError, check};

/// A log-normal length is drawn again beyond so many standard deviations of its logarithm, as grain
/// sizes are: the sheet's surroundings must be as wide as the longest fibre, and 0.3 % of the fibres
/// would make them many times wider.
const LOG_NORMAL_CUT: f64 = 3.0;
/// Longest fibre [µm]: a hundred millimetres, more than flax or hemp has.
const LONGEST_UM: f64 = 1e5;

/// Fibres of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Pulp {
    /// Share of the sheet's mass [-].
    pub mass_fraction: f64,
    pub length: LengthDistribution,
    /// Outer width [µm].
    pub width_um: f64,
    /// Thickness of the wall [µm], at most half the width.
    pub wall_um: f64,
    /// Mass per length [µg/µm]; 1 mg/m = 1e-3 µg/µm.
    pub coarseness_ug_per_um: f64,
    /// Chord over arc of a fibre [-], 1 for straight ones.
    pub shape_factor: f64,
    pub lumen: Lumen,
}

/// How long the fibres of a pulp are.
#[derive(Clone, Debug, PartialEq)]
pub enum LengthDistribution {
    /// All the same [µm].
    Fixed { length_um: f64 },
    /// By number: the mean [µm] is that of the fibres, not weighted by their length, and exact; the
    /// variation (standard deviation over mean) [-] is that before the cut at 3 σ of the logarithm.
    LogNormal { mean_um: f64, variation: f64 },
    /// Fibres of a fibre analyser, each as likely as any other. Their own width, wall and shape
    /// factor replace those of the pulp; their coarseness is the pulp's times the ratio of the areas
    /// of the walls, since the wall's density is one.
    Measured(Vec<MeasuredFibre>),
}

/// One fibre as a fibre analyser saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredFibre {
    pub length_um: f64,
    pub width_um: f64,
    pub wall_um: f64,
    pub shape_factor: f64,
}

/// Whether the fibre is a tube or a ribbon when it lies in the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lumen {
    /// A round tube, as thick as it is wide.
    Open,
    /// Closed by drying and pressing: a flat ribbon of the same width and area.
    #[default]
    Collapsed,
}

/// The section of one fibre in the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreSection {
    /// Outer width [µm], in the sheet's plane.
    pub width_um: f64,
    /// Thickness of the wall [µm].
    pub wall_um: f64,
    /// Thickness of the fibre across the sheet [µm].
    pub thickness_um: f64,
    /// Mass per length [µg/µm].
    pub coarseness_ug_per_um: f64,
}

/// What one fibre is before it has a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FibreSize {
    pub(super) length_um: f64,
    pub(super) shape_factor: f64,
    pub(super) section: FibreSection,
}

/// Area of a round wall, A = π T (W − T) [µm²], with width W and wall thickness T.
pub fn wall_area_um2(width_um: f64, wall_um: f64) -> f64 {
    PI * wall_um * (width_um - wall_um)
}

impl Lumen {
    /// Thickness across the sheet [µm]: W of a tube, A/W of a ribbon that kept its width W and the
    /// area A of its wall.
    fn thickness_um(self, width_um: f64, wall_um: f64) -> f64 {
        match self {
            Self::Open => width_um,
            Self::Collapsed => wall_area_um2(width_um, wall_um) / width_um,
        }
    }
}

impl Pulp {
    /// The section [`Pulp::width_um`] and [`Pulp::wall_um`] make.
    pub fn section(&self) -> FibreSection {
        self.section_of(self.width_um, self.wall_um)
    }

    fn section_of(&self, width_um: f64, wall_um: f64) -> FibreSection {
        let walls = wall_area_um2(width_um, wall_um) / wall_area_um2(self.width_um, self.wall_um);
        FibreSection {
            width_um,
            wall_um,
            thickness_um: self.lumen.thickness_um(width_um, wall_um),
            coarseness_ug_per_um: self.coarseness_ug_per_um * walls,
        }
    }

    /// # Errors
    /// Names the first value that is out of its range; `index` is the pulp's place in the list.
    pub(super) fn validate(&self, index: usize) -> Result<(), SheetError> {
        let name = |quantity: &str| format!("pulp {index}: {quantity}");
        let fraction = self.mass_fraction;
        let is_share = fraction > 0.0 && fraction <= 1.0;
        check(is_share, name("mass fraction"), fraction, "", "(0, 1]")?;
        let coarseness = self.coarseness_ug_per_um;
        let is_mass = coarseness > 0.0 && coarseness.is_finite();
        check(is_mass, name("coarseness"), coarseness, "ug/um", "above 0")?;
        section_is_allowed(&name, self.width_um, self.wall_um)?;
        shape_is_allowed(&name, self.shape_factor)?;
        match &self.length {
            LengthDistribution::Fixed { length_um } => {
                length_is_allowed(name("length"), *length_um, self.width_um)
            }
            LengthDistribution::LogNormal { mean_um, variation } => {
                let is_allowed = (0.0..=2.0).contains(variation);
                check(
                    is_allowed,
                    name("length variation"),
                    *variation,
                    "",
                    "[0, 2]",
                )?;
                length_is_allowed(name("mean length"), *mean_um, self.width_um)?;
                let law = LogNormal::new(*mean_um, *variation);
                let [shortest, longest] = law.range_um();
                length_is_allowed(name("shortest length (3 sigma)"), shortest, self.width_um)?;
                length_is_allowed(name("longest length (3 sigma)"), longest, self.width_um)
            }
            LengthDistribution::Measured(fibres) => {
                if fibres.is_empty() {
                    let quantity = name("measured fibres");
                    return Err(SheetError::Empty { quantity });
                }
                fibres.iter().enumerate().try_for_each(|(number, fibre)| {
                    let name = |quantity: &str| name(&format!("fibre {number}: {quantity}"));
                    section_is_allowed(&name, fibre.width_um, fibre.wall_um)?;
                    shape_is_allowed(&name, fibre.shape_factor)?;
                    length_is_allowed(name("length"), fibre.length_um, fibre.width_um)
                })?;
                let longest = name("length of the longest fibre");
                length_is_allowed(longest, self.longest_um(), self.widest_um())
            }
        }
    }

    /// Number-weighted mean length [µm].
    pub fn mean_length_um(&self) -> f64 {
        match &self.length {
            LengthDistribution::Fixed { length_um } => *length_um,
            LengthDistribution::LogNormal { mean_um, .. } => *mean_um,
            LengthDistribution::Measured(fibres) => {
                fibres.iter().map(|fibre| fibre.length_um).sum::<f64>() / fibres.len() as f64
            }
        }
    }

    /// The sections its fibres may have.
    pub(super) fn sections(&self) -> Vec<FibreSection> {
        match &self.length {
            LengthDistribution::Measured(fibres) => {
                let sections = fibres.iter();
                sections
                    .map(|fibre| self.section_of(fibre.width_um, fibre.wall_um))
                    .collect()
            }
            _ => vec![self.section()],
        }
    }

    /// Width [µm] of its widest fibre.
    pub(super) fn widest_um(&self) -> f64 {
        let sections = self.sections().into_iter();
        sections.fold(0.0, |most, section| section.width_um.max(most))
    }

    /// Longest fibre [µm] that can be drawn.
    pub(super) fn longest_um(&self) -> f64 {
        match &self.length {
            LengthDistribution::Fixed { length_um } => *length_um,
            LengthDistribution::LogNormal { mean_um, variation } => {
                LogNormal::new(*mean_um, *variation).range_um()[1]
            }
            LengthDistribution::Measured(fibres) => {
                let lengths = fibres.iter().map(|fibre| fibre.length_um);
                lengths.fold(0.0, f64::max)
            }
        }
    }

    pub(super) fn draw(&self, random: &mut impl Rng) -> FibreSize {
        let of_length = |length_um| FibreSize {
            length_um,
            shape_factor: self.shape_factor,
            section: self.section(),
        };
        match &self.length {
            LengthDistribution::Fixed { length_um } => of_length(*length_um),
            LengthDistribution::LogNormal { mean_um, variation } => {
                of_length(LogNormal::new(*mean_um, *variation).draw(random))
            }
            LengthDistribution::Measured(fibres) => {
                let fibre = fibres[random.random_range(0..fibres.len())];
                FibreSize {
                    length_um: fibre.length_um,
                    shape_factor: fibre.shape_factor,
                    section: self.section_of(fibre.width_um, fibre.wall_um),
                }
            }
        }
    }
}

/// exp(μ + σ N(0, 1)), cut at 3 σ.
struct LogNormal {
    mu: f64,
    sigma: f64,
}

impl LogNormal {
    /// σ² = ln(1 + v²) and μ = ln m − σ²/2 − ln c, where the cut alone would change the mean by
    /// c = [Φ(3 − σ) − Φ(−3 − σ)]/[Φ(3) − Φ(−3)].
    fn new(mean_um: f64, variation: f64) -> Self {
        let variance = variation.powi(2).ln_1p();
        let sigma = variance.sqrt();
        let normal = Normal::standard();
        let within =
            |shift: f64| normal.cdf(LOG_NORMAL_CUT - shift) - normal.cdf(-LOG_NORMAL_CUT - shift);
        Self {
            mu: mean_um.ln() - 0.5 * variance - (within(sigma) / within(0.0)).ln(),
            sigma,
        }
    }

    fn range_um(&self) -> [f64; 2] {
        [-LOG_NORMAL_CUT, LOG_NORMAL_CUT].map(|z| (self.mu + self.sigma * z).exp())
    }

    fn draw(&self, random: &mut impl Rng) -> f64 {
        loop {
            let normal: f64 = StandardNormal.sample(random);
            if normal.abs() <= LOG_NORMAL_CUT {
                return (self.mu + self.sigma * normal).exp();
            }
        }
    }
}

fn section_is_allowed(
    name: &impl Fn(&str) -> String,
    width_um: f64,
    wall_um: f64,
) -> Result<(), SheetError> {
    let is_wide = (0.01..=1000.0).contains(&width_um);
    check(is_wide, name("width"), width_um, "um", "[0.01, 1000]")?;
    let is_wall = wall_um > 0.0 && wall_um <= 0.5 * width_um;
    let allowed = format!("above 0, up to half the width, {} um", 0.5 * width_um);
    check(is_wall, name("wall thickness"), wall_um, "um", allowed)
}

fn shape_is_allowed(name: &impl Fn(&str) -> String, shape: f64) -> Result<(), SheetError> {
    // below a tenth the ends of an arc come so near to one another that a fibre would be a ring
    let is_shape = (0.1..=1.0).contains(&shape);
    check(is_shape, name("shape factor"), shape, "", "[0.1, 1]")
}

fn length_is_allowed(name: String, length_um: f64, width_um: f64) -> Result<(), SheetError> {
    // a fibre has to have room for two pieces that are as long as they are wide
    let is_length = length_um >= 2.0 * width_um && length_um <= LONGEST_UM;
    let allowed = format!(
        "from twice the width, {} um, to {LONGEST_UM} um",
        2.0 * width_um
    );
    check(is_length, name, length_um, "um", allowed)
}
