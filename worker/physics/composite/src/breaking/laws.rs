//! From the limits of materials to laws of what is made of them.
use super::part::{Law, PlaneLaw};
use crate::error::{CompositeError, finite, positive};
use crate::material::PlaneState;
use crate::section::Constituent;
use crate::stiffness::direction;
use crate::strength::{Criterion, InterfaceStrength, Limit, Strength};

/// A cosine below this is round-off of a right angle.
const RIGHT: f64 = 1e-12;

/// Checks limits: finite and above 0.
///
/// # Errors
/// Naming the limit.
pub(crate) fn check(strength: &Strength) -> Result<(), CompositeError> {
    for (limit, name, energy) in [
        (
            strength.tension,
            "a tensile strength",
            "a fracture energy in tension [N/mm]",
        ),
        (
            strength.compression,
            "a compressive strength",
            "a fracture energy in compression [N/mm]",
        ),
        (
            strength.across_tension,
            "a tensile strength across fibres",
            "a fracture energy in tension across fibres [N/mm]",
        ),
        (
            strength.across_compression,
            "a compressive strength across fibres",
            "a fracture energy in compression across fibres [N/mm]",
        ),
        (
            strength.shear,
            "a shear strength",
            "a fracture energy in shear [N/mm]",
        ),
    ] {
        check_limit(limit, name, energy)?;
    }
    Ok(())
}

/// As [`check`], of an interface.
pub(crate) fn check_interface(strength: &InterfaceStrength) -> Result<(), CompositeError> {
    check_limit(
        Some(strength.normal),
        "the normal strength of an interface",
        "the normal fracture energy of an interface [N/mm]",
    )?;
    check_limit(
        Some(strength.shear),
        "the shear strength of an interface",
        "the shear fracture energy of an interface [N/mm]",
    )
}

fn check_limit(
    limit: Option<Limit>,
    name: &'static str,
    energy_name: &'static str,
) -> Result<(), CompositeError> {
    if let Some(limit) = limit {
        positive(name, limit.limit)?;
        if let Some(energy) = limit.fracture_energy_n_per_mm {
            positive(energy_name, energy)?;
        }
    }
    Ok(())
}

/// The law of a ply or a fibre.
///
/// - Isotropic: the principal stresses in the section's plane, limits `tension` and `compression`.
/// - Orthotropic, axis 1 in the plane: along it `tension` and `compression`; across it
///   `across_tension` or `across_compression` together with `shear`, [Hashin1980]'s quadratic sum.
/// - Axis 1 out of the plane (90°): the principal stresses in the plane, limits `across_*`.
/// - Axis 1 at another angle out of the plane, cosine c and sine s, in plane stress: of the normal
///   stress along the section σ the fibres bear c² σ, and between them there are s² σ across and c s σ
///   in shear; the weaker of both cracks the ply. Across the section as with axis 1 in the plane.
///   The fracture energy is that of the crack's own area, which is larger than its projection.
///
/// # Errors
/// When limits across fibres are given for an isotropic material, or the angle out of the plane
/// has no rule in plane strain or for strains.
pub(crate) fn law_of(
    constituent: &Constituent,
    strength: &Strength,
    criterion: Criterion,
    state: PlaneState,
) -> Result<Law, CompositeError> {
    let material = constituent.material;
    let principal = |tension, compression| {
        let plane = PlaneLaw {
            tension,
            compression,
            shear: None,
            slides: true,
        };
        Law {
            material,
            axis: None,
            planes: [plane; 2],
            criterion,
        }
    };
    if !constituent.is_orthotropic {
        let across = [
            strength.across_tension,
            strength.across_compression,
            strength.shear,
        ];
        if let Some(limit) = across.into_iter().flatten().next() {
            return Err(CompositeError::OutOfRange {
                quantity: "a limit across fibres, or along them in shear, of an isotropic material",
                given: limit.limit,
                allowed: "absent: an isotropic material has tension and compression",
            });
        }
        return Ok(principal(strength.tension, strength.compression));
    }
    finite(
        "an angle out of the plane [°]",
        constituent.out_of_plane_deg,
    )?;
    let [c, s] = direction(constituent.out_of_plane_deg).map(f64::abs);
    if c < RIGHT {
        return Ok(principal(
            strength.across_tension,
            strength.across_compression,
        ));
    }
    let between = PlaneLaw {
        tension: strength.across_tension,
        compression: strength.across_compression,
        shear: strength.shear,
        slides: true,
    };
    let along = if s < RIGHT {
        PlaneLaw {
            tension: strength.tension,
            compression: strength.compression,
            shear: None,
            // decided by what lies beside it in the cell
            slides: false,
        }
    } else {
        if !strength.is_unbreakable()
            && (state == PlaneState::Strain || criterion == Criterion::Strain)
        {
            return Err(CompositeError::OutOfRange {
                quantity: "the angle out of the plane [°] of a ply that breaks in plane strain, or \
                           by strain",
                given: constituent.out_of_plane_deg,
                allowed: "0 or 90; other angles need plane stress and limits of stress",
            });
        }
        PlaneLaw {
            tension: oblique(
                [c, s],
                strength.tension,
                strength.across_tension,
                strength.shear,
            ),
            compression: oblique(
                [c, s],
                strength.compression,
                strength.across_compression,
                strength.shear,
            ),
            shear: None,
            slides: true,
        }
    };
    Ok(Law {
        material,
        axis: Some(direction(constituent.in_plane_deg)),
        planes: [along, between],
        criterion,
    })
}

/// The limit along the section of a ply whose fibres leave its plane.
fn oblique(
    [c, s]: [f64; 2],
    along: Option<Limit>,
    across: Option<Limit>,
    shear: Option<Limit>,
) -> Option<Limit> {
    let fibres = along.map(|limit| Limit {
        limit: limit.limit / (c * c),
        fracture_energy_n_per_mm: limit.fracture_energy_n_per_mm.map(|energy| energy / c),
    });
    let demand =
        |limit: Option<Limit>, share: f64| limit.map_or(0.0, |limit| (share / limit.limit).powi(2));
    let (normal, sliding) = (demand(across, s * s), demand(shear, c * s));
    let governing = if normal >= sliding { across } else { shear };
    let between = governing.map(|governing| Limit {
        limit: 1.0 / (normal + sliding).sqrt(),
        fracture_energy_n_per_mm: governing.fracture_energy_n_per_mm.map(|energy| energy / s),
    });
    match (fibres, between) {
        (Some(first), Some(second)) if second.limit < first.limit => Some(second),
        (first, second) => first.or(second),
    }
}

/// The law of the faces of a fibre whose axis is given.
pub(crate) fn law_of_faces(material: usize, axis: [f64; 2], strength: &InterfaceStrength) -> Law {
    let face = PlaneLaw {
        tension: Some(strength.normal),
        compression: None,
        shear: Some(strength.shear),
        slides: true,
    };
    Law {
        material,
        axis: Some(axis),
        planes: [PlaneLaw::default(), face],
        // a face has no thickness in which it could strain
        criterion: Criterion::Stress,
    }
}
