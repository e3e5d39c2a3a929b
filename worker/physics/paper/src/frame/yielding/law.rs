//! The bilinear law of a segment along itself, with isotropic hardening.
//!
//! The force is q = c (d - p) with the elongation d, the stiffness c = E A/l and the plastic elongation p.
//! It yields where |q| = Y + H α, pulled or pushed, with Y = σ A for the yield stress σ and the sum α
//! of all |Δp|. With H = c cₜ/(c - cₜ) the slope of force over elongation beyond is cₜ = Eₜ A/l, Eₜ the
//! hardening modulus. Unloading is elastic. The work that it takes is Y α + ½ H α², all of it lost
//! [SimoHughes1998], chapter 1.
use super::super::element::Element;
use super::super::input::BeamSection;

/// Beyond what is said of its last step, a force this share of the limit above it flows.
const ROUND_OFF: f64 = 1e-12;

/// The law of one segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Law {
    /// c and cₜ [mN/µm].
    pub(crate) stiffness: f64,
    pub(crate) softened: f64,
    /// Y [mN] and H [mN/µm].
    yields_at: f64,
    hardening: f64,
}

/// Where a segment is on its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plastic {
    /// p and α [µm].
    pub(crate) longer_um: f64,
    pub(crate) hardened_um: f64,
    /// Whether it flows now.
    pub(crate) flows: bool,
}

impl Law {
    /// Of a segment; none when it never yields.
    pub(crate) fn new(section: &BeamSection, segment: &Element) -> Option<Self> {
        let yielding = section.yielding?;
        let stiffness = segment.stiffness[0];
        let softened = stiffness * yielding.hardening_modulus_gpa / section.youngs_modulus_gpa;
        Some(Self {
            stiffness,
            softened,
            yields_at: yielding.stress_gpa * section.area_um2,
            hardening: stiffness * softened / (stiffness - softened),
        })
    }

    /// Force at which it yields [mN].
    pub(crate) fn limit(&self, hardened_um: f64) -> f64 {
        self.yields_at + self.hardening * hardened_um
    }

    /// Work that yielding has taken [nJ].
    pub(crate) fn dissipated(&self, hardened_um: f64) -> f64 {
        (self.yields_at + 0.5 * self.hardening * hardened_um) * hardened_um
    }

    /// Share of an elongation that stays while it flows.
    pub(crate) fn lasting(&self) -> f64 {
        1.0 - self.softened / self.stiffness
    }

    /// Where it is at the elongation `elongation_um`, straight from `before`; on the limit it flows as
    /// `flows` says.
    pub(crate) fn reach(&self, elongation_um: f64, before: Plastic, flows: bool) -> Plastic {
        let force = self.stiffness * (elongation_um - before.longer_um);
        let limit = self.limit(before.hardened_um);
        let over = force.abs() - limit;
        let threshold = if flows { -ROUND_OFF } else { ROUND_OFF };
        if over <= threshold * limit {
            return Plastic {
                flows: false,
                ..before
            };
        }
        let more = over.max(0.0) / (self.stiffness + self.hardening);
        Plastic {
            longer_um: before.longer_um + more * force.signum(),
            hardened_um: before.hardened_um + more,
            flows: true,
        }
    }
}
