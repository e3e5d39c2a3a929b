//! What rollers did to a bent specimen, and its results.
use serde::{Deserialize, Serialize};

use super::measured::Measured;
use crate::flexure::FlexureResult;

/// What rollers did to a bent specimen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Bent {
    force_n: f64,
    roller_mm: f64,
    midspan_mm: f64,
    span_to_depth: f64,
    modulus_mpa: f64,
    stress_mpa: f64,
    strain: f64,
    /// Stress [MPa] and strain with the corrections for large deflections.
    far: Option<[f64; 2]>,
    apparent_shear_mpa: Option<f64>,
    shear_mpa: Option<f64>,
    contact_mm: f64,
    /// Fewest particles that carry a roller.
    pub(super) touching: usize,
    beam: Option<Layered>,
}

/// The bent specimen by the theory of beams.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Layered {
    deflection_mm: f64,
    shear_share: f64,
    true_modulus_mpa: f64,
    corrected_modulus_mpa: Option<f64>,
}

impl Bent {
    pub(super) fn of(found: &FlexureResult) -> Self {
        let rollers = &found.contact.rollers;
        Self {
            force_n: found.force_n,
            roller_mm: found.roller_deflection_mm,
            midspan_mm: found.midspan_deflection_mm,
            span_to_depth: found.span_to_depth,
            modulus_mpa: found.flexural_modulus_mpa,
            stress_mpa: found.outer_stress_mpa,
            strain: found.outer_strain,
            far: found
                .far
                .map(|far| [far.outer_stress_mpa, far.outer_strain]),
            apparent_shear_mpa: found.apparent_shear_stress_mpa,
            shear_mpa: found.shear_stress_mpa,
            // two supports come before what presses
            contact_mm: rollers
                .get(2)
                .map_or(0.0, |roller| 2.0 * roller.half_width_mm),
            touching: rollers
                .iter()
                .map(|roller| roller.particles)
                .min()
                .unwrap_or(0),
            beam: found.beam.as_ref().map(|test| Layered {
                deflection_mm: test.deflection.total_mm(),
                shear_share: test.deflection.shear_mm / test.deflection.total_mm(),
                true_modulus_mpa: test.true_modulus_mpa,
                corrected_modulus_mpa: test.corrected_modulus_mpa,
            }),
        }
    }

    /// Force of the rollers that press [N].
    pub(super) fn force_n(&self) -> f64 {
        self.force_n
    }

    /// Its results.
    pub(super) fn measured(&self) -> Vec<Measured> {
        let mut all = Vec::new();
        let mut add = |name, value, unit, description| {
            all.push(Measured {
                name,
                value,
                unit,
                description,
            });
        };
        add(
            "flexural_modulus",
            self.modulus_mpa,
            "MPa",
            "Modulus that the standard's formula gives for force and midspan deflection; the deflection \
             by shear is in it.",
        );
        add(
            "max_force",
            self.force_n,
            "N",
            "Force of the rollers that press.",
        );
        add(
            "deflection",
            self.midspan_mm,
            "mm",
            "Deflection of the bottom face at midspan against the supports.",
        );
        add(
            "roller_displacement",
            self.roller_mm,
            "mm",
            "Way of the rollers that press, with what all rollers dent.",
        );
        add(
            "flexural_stress",
            self.stress_mpa,
            "MPa",
            "Stress of the outer fibre at midspan by the standard's formula, as of one material.",
        );
        add(
            "flexural_strain",
            self.strain,
            "1",
            "Strain of the outer fibre at midspan by the standard's formula.",
        );
        if let Some([stress, strain]) = self.far {
            add(
                "flexural_stress_large_deflection",
                stress,
                "MPa",
                "The same stress with the standard's correction for a large deflection.",
            );
            add(
                "flexural_strain_large_deflection",
                strain,
                "1",
                "The same strain with the standard's correction for a large deflection.",
            );
        }
        if let Some(shear) = self.apparent_shear_mpa {
            add(
                "interlaminar_shear_stress",
                shear,
                "MPa",
                "Apparent interlaminar shear stress 3F/(4bh) of ISO 14130.",
            );
        }
        if let Some(shear) = self.shear_mpa {
            add(
                "largest_shear_stress",
                shear,
                "MPa",
                "Largest shear stress of a cell halfway between a support and the next roller that presses.",
            );
        }
        if let Some(beam) = &self.beam {
            add(
                "bending_modulus",
                beam.true_modulus_mpa,
                "MPa",
                "Modulus that the layers have in pure bending by the theory of beams, 12 EI/(bh\u{b3}).",
            );
            if let Some(modulus) = beam.corrected_modulus_mpa {
                add(
                    "flexural_modulus_without_shear",
                    modulus,
                    "MPa",
                    "The formula's modulus after the deflection by shear, by the theory of beams, is \
                     taken away.",
                );
            }
            add(
                "beam_deflection",
                beam.deflection_mm,
                "mm",
                "Midspan deflection by the theory of beams under the same force, shear included.",
            );
            add(
                "shear_deflection_share",
                beam.shear_share,
                "1",
                "Part of that deflection that is by shear.",
            );
        }
        add(
            "span_to_depth",
            self.span_to_depth,
            "1",
            "Span over height.",
        );
        add(
            "contact_width",
            self.contact_mm,
            "mm",
            "Width of the contact of the first roller that presses.",
        );
        all
    }
}
