//! Stiffness of the springs of the tube, in closed form.
//!
//! A ring has N points on a circle of diameter Φ; l is the length of a segment, from ring to ring.
//! With β the half angle π/N between neighbours the springs at rest are long
//!
//! ```text
//! along    (patent: ST1)  (i,j)-(i+1,j)        l
//! around   (ST2)          (i,j)-(i,j+1)        c = Φ sin β
//! diagonal (SS)           (i,j)-(i+1,j±1)      s = √(l² + c²)
//! across   (CS)           (i,j)-(i,j+N/2)      Φ
//! second   (ours)         (i,j)-(i,j+2)        Φ sin 2β
//! ```
//!
//! Balance of one point, linearised, q = cos² β, and A_T = J/(Φ/2)² the area that gives the tube its
//! torsion (the numbers are those of the patent's lost formulas):
//!
//! ```text
//! (4) torsion       k_SS  = G A_T s²/(2 N l c² q)
//! (3) axial         k_ST1 = E A/(N l) - 2 k_SS (l² - ν c²)/s²
//! (5) structural    H     = k_ST1 l/c                          hoop stiffness, ST2 and second together
//! (3) radial        k_CS  = (2 c²/Φ²) (m k_SS (l² - ν c²)/(ν s²) - H)
//! ```
//!
//! with m = 2 on a ring between two segments and m = 1 on one at an end. The patent balances one
//! segment (m = 1 on all rings) and leaves q out, which makes ν 0.5 instead of 0.3 and G q times what
//! was put in.
//!
//! With these four the rings have N - 4 modes that cost nothing, ovalisation with an odd number of
//! waves. A part [`SECOND_PART`] of H therefore goes through springs between second neighbours,
//! k₂ = part H c²/c₂² with c₂ = 2 c cos β, which resist the contraction of a ring as the rest of H
//! does: E, ν, G and the signs of all constants stay what they are.
use super::{Elasticity, FibreError, Section};
use std::f64::consts::PI;

/// Part of the hoop stiffness that second neighbours carry. It need only be above 0: from 0.02 to 0.2
/// it moves the bending stiffness by less than 2 % of the wall's.
pub const SECOND_PART: f64 = 0.05;

/// Part η of a ring's radial stiffness that goes around it rather than across, in the robust form.
const AROUND_PART: f64 = 0.5;

/// h = 1 leaves nothing for the springs along the fibre; the robust form stops at this.
const MOST_ROBUST: f64 = 0.9;

/// The geometry of a ring and of the segment to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    points_on_ring: usize,
    diameter_um: f64,
    length_um: f64,
}

/// Stiffness of all springs [mN/µm]; pairs are of a ring between segments, and of one at an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Springs {
    pub along: f64,
    pub around: [f64; 2],
    pub diagonal: f64,
    pub across: [f64; 2],
    /// 0 where second neighbours are opposite ones, on rings of four.
    pub second: [f64; 2],
    /// What the springs make of G [GPa].
    pub shear_modulus_gpa: f64,
    /// Whether (5) was given up and G perhaps lowered.
    pub is_robust: bool,
}

impl Segment {
    /// Rings of N points on a circle of diameter Φ [µm], l [µm] apart.
    ///
    /// # Errors
    /// [`FibreError::OutOfRange`] unless N is even (springs across join opposite points) and 4 to 16
    /// (finer rings dent under loads that the fibre bears), and both lengths are above 0.
    pub fn new(
        points_on_ring: usize,
        diameter_um: f64,
        length_um: f64,
    ) -> Result<Self, FibreError> {
        if !(4..=16).contains(&points_on_ring) || points_on_ring % 2 == 1 {
            return Err(FibreError::out_of_range(
                "points on a ring",
                "1",
                points_on_ring as f64,
                "an even number from 4 to 16",
            ));
        }
        for (quantity, given) in [
            ("ring diameter", diameter_um),
            ("segment length", length_um),
        ] {
            if !(given.is_finite() && given > 0.0) {
                return Err(FibreError::out_of_range(quantity, "µm", given, "above 0"));
            }
        }
        Ok(Self {
            points_on_ring,
            diameter_um,
            length_um,
        })
    }

    /// N.
    pub fn points_on_ring(&self) -> usize {
        self.points_on_ring
    }

    /// Φ [µm].
    pub fn diameter_um(&self) -> f64 {
        self.diameter_um
    }

    /// l [µm].
    pub fn length_um(&self) -> f64 {
        self.length_um
    }

    /// c = Φ sin(π/N) [µm].
    pub fn chord_um(&self) -> f64 {
        self.diameter_um * (PI / self.points_on_ring as f64).sin()
    }

    /// q = cos²(π/N) [-], the projection of a chord on the tangent, squared.
    pub fn projection(&self) -> f64 {
        (PI / self.points_on_ring as f64).cos().powi(2)
    }

    /// r = l/c [-].
    pub fn slenderness(&self) -> f64 {
        self.length_um / self.chord_um()
    }

    /// A_T = J/(Φ/2)² [µm²].
    fn torsion_area_um2(&self, section: &Section) -> f64 {
        4.0 * section.polar_um4() / self.diameter_um.powi(2)
    }

    /// h = (G/E)(A_T/A)(r² - ν)/q [-]: the part of the axial stiffness that the diagonals take.
    pub fn diagonal_part(&self, section: &Section, elasticity: &Elasticity) -> f64 {
        let ratio = elasticity.shear_modulus_gpa() / elasticity.youngs_modulus_gpa();
        let area = self.torsion_area_um2(section) / section.area_um2();
        ratio * area * (self.slenderness().powi(2) - elasticity.poisson_ratio()) / self.projection()
    }

    /// The closed form (3) to (5), whatever its signs are.
    pub fn closed_form(&self, section: &Section, elasticity: &Elasticity) -> Springs {
        let (nu, chord) = (elasticity.poisson_ratio(), self.chord_um());
        let (along, diagonal, pull) = self.along_and_diagonal(section, elasticity, 1.0);
        let hoop = along * self.slenderness();
        let across = |segments: f64| {
            2.0 * (chord / self.diameter_um).powi(2) * (segments * pull / nu - hoop)
        };
        let (around, second) = self.shared_hoop(hoop);
        Springs {
            along,
            around: [around; 2],
            diagonal,
            across: [across(2.0), across(1.0)],
            second: [second; 2],
            shear_modulus_gpa: elasticity.shear_modulus_gpa(),
            is_robust: false,
        }
    }

    /// Springs that are never negative: (5) is given up, the radial stiffness that (3) asks for is
    /// shared between around and across, and G is lowered to what leaves a tenth of the axial
    /// stiffness to the springs along the fibre (h ≤ 0.9).
    ///
    /// # Errors
    /// [`FibreError::TooShort`] when l² ≤ ν c²: diagonals would shorten in tension.
    pub fn robust(
        &self,
        section: &Section,
        elasticity: &Elasticity,
    ) -> Result<Springs, FibreError> {
        let (nu, chord) = (elasticity.poisson_ratio(), self.chord_um());
        let above_um = chord * nu.sqrt();
        if self.length_um <= above_um {
            return Err(FibreError::TooShort {
                given_um: self.length_um,
                above_um,
            });
        }
        let lowered = (MOST_ROBUST / self.diagonal_part(section, elasticity)).min(1.0);
        let (along, diagonal, pull) = self.along_and_diagonal(section, elasticity, lowered);
        let radial = 2.0 * pull / nu;
        let across = (1.0 - AROUND_PART) * radial * 2.0 * (chord / self.diameter_um).powi(2);
        let (around, second) = self.shared_hoop(AROUND_PART * radial);
        Ok(Springs {
            along,
            around: [around, around / 2.0],
            diagonal,
            across: [across, across / 2.0],
            second: [second, second / 2.0],
            shear_modulus_gpa: lowered * elasticity.shear_modulus_gpa(),
            is_robust: true,
        })
    }

    /// k_ST1, k_SS and k_SS (l² - ν c²)/s², with G lowered by a factor.
    fn along_and_diagonal(
        &self,
        section: &Section,
        elasticity: &Elasticity,
        lowered: f64,
    ) -> (f64, f64, f64) {
        let count = self.points_on_ring as f64;
        let (length, chord) = (self.length_um, self.chord_um());
        let squared = length.powi(2) + chord.powi(2);
        let torsion = lowered * elasticity.shear_modulus_gpa() * self.torsion_area_um2(section);
        let diagonal =
            torsion * squared / (2.0 * count * length * chord.powi(2) * self.projection());
        let pull =
            diagonal * (length.powi(2) - elasticity.poisson_ratio() * chord.powi(2)) / squared;
        let axial = elasticity.youngs_modulus_gpa() * section.area_um2() / (count * length);
        (axial - 2.0 * pull, diagonal, pull)
    }

    /// Hoop stiffness as springs around and between second neighbours.
    fn shared_hoop(&self, hoop: f64) -> (f64, f64) {
        if self.points_on_ring == 4 {
            return (hoop, 0.0);
        }
        // c₂² = 4 q c²
        let second = SECOND_PART * hoop / (4.0 * self.projection());
        ((1.0 - SECOND_PART) * hoop, second)
    }
}

impl Springs {
    /// Whether no spring is negative, and those along the fibre are above 0.
    pub fn are_admissible(&self) -> bool {
        let rings = self.around.iter().chain(&self.across).chain(&self.second);
        self.along > 0.0 && self.diagonal > 0.0 && rings.into_iter().all(|&k| k >= 0.0)
    }
}
