//! What sheet is to be laid.
use super::error::{SheetError, check};
use super::orientation::Orientation;
use super::pulp::Pulp;

/// How far the mass fractions' sum may be from one: what a person writes with seven digits.
const FRACTION_TOLERANCE: f64 = 1e-6;
/// Most memory [GB] a sheet is given; a caller who has less compares [`SheetPlan::expected`] with it.
const MOST_GIGABYTES: f64 = 64.0;
/// Bytes of a point of a centre line while contacts are searched: the point, its arc length and its
/// share of the boxes of the tree, and what growing lists leave empty.
const BYTES_PER_POINT: f64 = 100.0;
/// Bytes of a contact, in the sheet and in the parts it was gathered from.
const BYTES_PER_CONTACT: f64 = 80.0;

/// A sheet to be laid.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetPlan {
    /// Length along x (machine direction) and width along y [µm].
    pub size_um: [f64; 2],
    /// Mass per area [µg/µm²]; 1 g/m² = 1e-6 µg/µm². The sheet has it exactly.
    pub grammage_ug_per_um2: f64,
    /// Their mass fractions sum to one; the sheet has them exactly.
    pub pulps: Vec<Pulp>,
    pub orientation: Orientation,
    pub placement: Placement,
    /// Length [µm] of a centre line's segments, and of the height map's pixels in a deposited sheet.
    /// By default a quarter of the narrowest fibre's width when deposited, the width otherwise.
    /// Coarser deposited sheets are thicker, since fibres cannot follow what is shorter than a
    /// segment; [`super::Sheet::coarsened`] thins the points afterwards and leaves the structure.
    pub segment_um: Option<f64>,
    /// Vertical gap [µm] up to which fibres touch. By default nothing when placed at random, and in
    /// a deposited sheet a quarter of a width times the flexibility: where the lower fibre climbs, the
    /// upper one rests on it up to half a width beside their crossing and hangs up to twice as much
    /// above it there. The number of contacts hardly depends on it between 0.5 and 3 µm.
    pub gap_um: Option<f64>,
}

/// Where fibres lie in the sheet's thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// Flat, each at any height so that it lies within the thickness [µm], through one another.
    Random3d { thickness_um: f64 },
    /// One after the other onto what lies below. Thickness and density are results.
    Deposition {
        /// Steepest slope [-] a fibre takes, dz/dx.
        flexibility: f64,
    },
}

impl Placement {
    /// Flexibility [-] that gives softwood of 28 µm by 2 µm at 60 g/m² the density of paper: 690 kg/m³,
    /// where 670 to 740 were measured of copy paper and liner. 0.2 gives 590, 0.5 gives 820 kg/m³.
    pub const FLEXIBILITY: f64 = 0.3;
}

/// About how much a sheet will be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Pieces of fibres.
    pub fibres: f64,
    /// Points of centre lines.
    pub points: f64,
    /// Pairs of fibres that cross when seen from above; contacts are fewer.
    pub crossings: f64,
    /// Memory at the peak of the making, from the above.
    pub bytes: f64,
}

impl SheetPlan {
    /// Refuses what cannot be laid.
    ///
    /// # Errors
    /// Names the first value out of its range.
    pub fn validate(&self) -> Result<(), SheetError> {
        if self.pulps.is_empty() {
            return Err(SheetError::NoPulp);
        }
        for (index, pulp) in self.pulps.iter().enumerate() {
            pulp.validate(index)?;
        }
        let sum: f64 = self.pulps.iter().map(|pulp| pulp.mass_fraction).sum();
        if (sum - 1.0).abs() > FRACTION_TOLERANCE {
            return Err(SheetError::MassFractions { sum });
        }
        self.orientation.validate()?;
        let sections = || self.pulps.iter().flat_map(Pulp::sections);
        let widths = self.pulps.iter().map(Pulp::widest_um);
        let least = 2.0 * widths.fold(0.0, f64::max);
        for (side, size) in ["length", "width"].iter().zip(self.size_um) {
            let is_size = size >= least && size <= 1e7;
            let allowed = format!("from twice the widest fibre, {least} um, to 1e7 um");
            check(is_size, format!("{side} of the sheet"), size, "um", allowed)?;
        }
        let grammage = self.grammage_ug_per_um2;
        let is_mass = grammage > 0.0 && grammage.is_finite();
        check(is_mass, "grammage", grammage, "ug/um2", "above 0")?;
        match self.placement {
            Placement::Random3d { thickness_um } => {
                let thickest = sections().fold(0.0, |most, section| section.thickness_um.max(most));
                let is_thick = thickness_um >= thickest && thickness_um <= 1e6;
                let allowed = format!("from the thickest fibre, {thickest} um, to 1e6 um");
                check(
                    is_thick,
                    "thickness of the sheet",
                    thickness_um,
                    "um",
                    allowed,
                )?;
            }
            Placement::Deposition { flexibility } => {
                let is_slope = (0.0..=10.0).contains(&flexibility);
                check(is_slope, "flexibility", flexibility, "", "[0, 10]")?;
            }
        }
        let narrowest = self.narrowest_um();
        if let Some(segment) = self.segment_um {
            let is_length = segment >= 0.01 * narrowest && segment.is_finite();
            let allowed = format!("from a hundredth of the narrowest fibre, {narrowest} um");
            check(is_length, "segment", segment, "um", allowed)?;
            if matches!(self.placement, Placement::Deposition { .. }) {
                let allowed = format!("up to half the narrowest fibre, {} um", 0.5 * narrowest);
                let is_fine = segment <= 0.5 * narrowest;
                check(
                    is_fine,
                    "segment of a deposited sheet",
                    segment,
                    "um",
                    allowed,
                )?;
            }
        }
        if let Some(gap) = self.gap_um {
            let is_gap = (0.0..=1e6).contains(&gap);
            check(is_gap, "gap of a contact", gap, "um", "[0, 1e6]")?;
        }
        let expected = self.expected();
        let gigabytes = expected.bytes / 1e9;
        if gigabytes > MOST_GIGABYTES {
            return Err(SheetError::TooLarge {
                fibres: expected.fibres,
                gigabytes,
                most_gigabytes: MOST_GIGABYTES,
            });
        }
        Ok(())
    }

    /// About how many fibres and how much memory, without laying them; of a plan that
    /// [`SheetPlan::validate`] does not refuse for other reasons.
    ///
    /// A pulp of fibre length ℓ and total length Λ on an area A of perimeter P makes
    /// Λ (1/ℓ + P/(π A)) pieces, straight and uniformly directed; fibres cross Λ²/(π A) times.
    pub fn expected(&self) -> Expected {
        let area = self.size_um[0] * self.size_um[1];
        let edges = 2.0 * (self.size_um[0] + self.size_um[1]) / (std::f64::consts::PI * area);
        let (mut total, mut fibres) = (0.0, 0.0);
        for pulp in &self.pulps {
            let mass = pulp.mass_fraction * self.grammage_ug_per_um2 * area;
            let length = mass / pulp.coarseness_ug_per_um;
            fibres += length * (1.0 / pulp.mean_length_um() + edges);
            total += length;
        }
        let segment = self.segment();
        let points = total / segment + 2.0 * fibres;
        let crossings = total * total / (std::f64::consts::PI * area);
        // a fibre has room for one contact per width on each of its faces
        let contacts = match self.placement {
            Placement::Random3d { .. } => crossings,
            Placement::Deposition { .. } => crossings.min(total / self.narrowest_um()),
        };
        let pixels = match self.placement {
            Placement::Random3d { .. } => 0.0,
            Placement::Deposition { .. } => area / (segment * segment),
        };
        Expected {
            fibres,
            points,
            crossings,
            bytes: BYTES_PER_POINT * points + BYTES_PER_CONTACT * contacts + 8.0 * pixels,
        }
    }

    /// Length of segments [µm], given or by default.
    pub fn segment(&self) -> f64 {
        let by_default = match self.placement {
            Placement::Random3d { .. } => self.narrowest_um(),
            Placement::Deposition { .. } => 0.25 * self.narrowest_um(),
        };
        self.segment_um.unwrap_or(by_default)
    }

    /// Largest gap of a contact [µm], given or by default.
    pub fn gap(&self) -> f64 {
        let by_default = match self.placement {
            Placement::Random3d { .. } => 0.0,
            Placement::Deposition { flexibility } => {
                // of the sheet's mean fibre: pulps may differ in width
                let widths = self.pulps.iter();
                let width: f64 = widths.map(|pulp| pulp.mass_fraction * pulp.width_um).sum();
                0.25 * width * flexibility
            }
        };
        self.gap_um.unwrap_or(by_default)
    }

    fn narrowest_um(&self) -> f64 {
        let sections = self.pulps.iter().flat_map(Pulp::sections);
        sections.fold(f64::INFINITY, |least, section| section.width_um.min(least))
    }
}
