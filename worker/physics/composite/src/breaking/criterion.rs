//! At which load factor a part cracks next, and what it is afterwards.
use super::part::{Damage, Law, Part, PlaneDamage, PlaneLaw};
use super::saw::Saw;
use crate::strength::{Criterion, Limit};

/// A crack that could come next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// Load factor.
    pub(crate) factor: f64,
    pub(crate) plane: usize,
    /// Normal of the first plane.
    pub(crate) axis: [f64; 2],
    /// Whether the stress across the plane is pressure.
    pub(crate) is_pressed: bool,
    /// Shear's part of the criterion: 0 pure normal, 1 pure shear.
    pub(crate) shear_share: f64,
}

/// The first crack of a part as the load factor grows from 0, from stress [MPa] and strain at unit load
/// in the axes of its planes.
pub(crate) fn first_crack(
    part: &Part,
    law: &Law,
    damage: &Damage,
    teeth: u16,
    [stress, strain]: [[f64; 3]; 2],
) -> Option<Hit> {
    let by_strain = law.criterion == Criterion::Strain;
    let measured = if by_strain { strain } else { stress };
    if law.axis.is_none() && damage.is_none() {
        return first_principal(part, &law.planes[0], measured, by_strain);
    }
    let mut first: Option<Hit> = None;
    for (plane, limits) in law.planes.iter().enumerate() {
        let state = &damage.planes[plane];
        let (normal, shear) = (measured[plane], measured[2]);
        let Some((demand, shear_share)) =
            demand(part, limits, state, teeth, by_strain, [normal, shear])
        else {
            continue;
        };
        let factor = 1.0 / demand;
        if first.is_none_or(|hit| factor < hit.factor) {
            first = Some(Hit {
                factor,
                plane,
                axis: damage.axis,
                is_pressed: normal < 0.0,
                shear_share,
            });
        }
    }
    first
}

/// The square root of the quadratic sum on a plane at unit load, and shear's part of the sum.
fn demand(
    part: &Part,
    limits: &PlaneLaw,
    state: &PlaneDamage,
    teeth: u16,
    by_strain: bool,
    [normal, shear]: [f64; 2],
) -> Option<(f64, f64)> {
    if state.level >= teeth {
        return None;
    }
    let peak = |limit: Limit, kind: usize| {
        let of_saw = if state.level == 0 {
            1.0
        } else if by_strain {
            state.saw(teeth, kind).peak_strain(state.level)
        } else {
            state.saw(teeth, kind).peak_stress(state.level)
        };
        limit.limit * part.strength * of_saw
    };
    let across = if normal > 0.0 {
        limits.tension
    } else {
        limits.compression
    };
    // what was crushed and is pulled, or opened and is pressed, is not followed across the plane
    let is_other = state.opened > 0 && state.is_crushed != (normal < 0.0);
    let across = across
        .filter(|_| !is_other)
        .map_or(0.0, |limit| normal / peak(limit, 0));
    let along = limits.shear.map_or(0.0, |limit| shear / peak(limit, 1));
    let sum = across * across + along * along;
    (sum > 0.0).then(|| (sum.sqrt(), along * along / sum))
}

/// Of an isotropic part without a crack: across the largest or the smallest principal value.
fn first_principal(
    part: &Part,
    limits: &PlaneLaw,
    [xx, yy, xy]: [f64; 3],
    by_strain: bool,
) -> Option<Hit> {
    // γ = 2 ε_xy
    let xy = if by_strain { 0.5 * xy } else { xy };
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = half.hypot(xy);
    // the larger one's direction, half the angle of (half, xy)
    let largest = if radius > 0.0 {
        let cosine = (0.5 * (1.0 + half / radius)).max(0.0).sqrt();
        if cosine > 0.5 {
            [cosine, 0.5 * xy / (radius * cosine)]
        } else {
            let sine = (0.5 * (1.0 - half / radius)).max(0.0).sqrt();
            [0.5 * xy.abs() / (radius * sine), sine.copysign(xy)]
        }
    } else {
        [1.0, 0.0]
    };
    let mut first: Option<Hit> = None;
    for (limit, value, axis, is_pressed) in [
        (limits.tension, mean + radius, largest, false),
        (
            limits.compression,
            radius - mean,
            [-largest[1], largest[0]],
            true,
        ),
    ] {
        if let Some(limit) = limit
            && value > 0.0
        {
            let factor = limit.limit * part.strength / value;
            if first.is_none_or(|hit| factor < hit.factor) {
                first = Some(Hit {
                    factor,
                    plane: 0,
                    axis,
                    is_pressed,
                    shear_share: 0.0,
                });
            }
        }
    }
    first
}

/// What a part is after a crack: one more tooth of its plane, all of them of a brittle one.
///
/// # Errors
/// Width [mm] and the largest allowed one, when the cell holds more than the crack takes.
pub(crate) fn cracked(
    part: &Part,
    law: &Law,
    damage: &Damage,
    teeth: u16,
    sides: [f64; 2],
    thickness_mm: f64,
    hit: &Hit,
) -> Result<Damage, [f64; 2]> {
    let mut after = Damage {
        axis: hit.axis,
        ..*damage
    };
    let limits = &law.planes[hit.plane];
    let normal_limit = if hit.is_pressed {
        limits.compression
    } else {
        limits.tension
    };
    let normal = after.normal(hit.plane);
    let width_mm = part.width_mm(sides, normal);
    let plane = &mut after.planes[hit.plane];
    if plane.level == 0 {
        let root = |limit: Option<Limit>, is_shear: bool| -> Result<Option<f64>, [f64; 2]> {
            let Some(limit) = limit.filter(|limit| limit.fracture_energy_n_per_mm.is_some()) else {
                return Ok(None);
            };
            let modulus = part.modulus(hit.axis, hit.plane, is_shear);
            let room = part.room(law, limit, modulus, width_mm);
            let saw = Saw::new(teeth, room).ok_or([width_mm, width_mm * room])?;
            Ok(Some(saw.root()))
        };
        let is_crushed = hit.is_pressed && hit.shear_share <= 0.5;
        let opening = if is_crushed {
            limits.compression
        } else {
            limits.tension.or(limits.compression)
        };
        let first = root(opening, false)?;
        let second = root(limits.shear, true)?;
        // a brittle one breaks at once, and its root does not matter
        let any = first.or(second).unwrap_or(0.5);
        plane.roots = [first.unwrap_or(any), second.unwrap_or(any)];
        plane.area_mm2 = part.share * sides[0] * sides[1] * thickness_mm / width_mm;
    }
    let governing = if hit.shear_share > 0.5 {
        limits.shear
    } else {
        normal_limit
    };
    let is_brittle = governing.is_none_or(|limit| limit.fracture_energy_n_per_mm.is_none());
    let level = if is_brittle {
        teeth
    } else {
        (plane.level + 1).min(teeth)
    };
    plane.level = level;
    // under pressure a plane that slides keeps its normal stiffness, unless it is crushed
    let is_crushed = hit.is_pressed && hit.shear_share <= 0.5;
    if !hit.is_pressed || is_crushed {
        if plane.opened == 0 {
            plane.is_crushed = is_crushed;
        }
        if plane.is_crushed == is_crushed {
            plane.opened = level;
        }
    } else if level >= teeth && !plane.is_crushed && limits.tension.is_some() {
        // slid through: nothing but pressure holds its faces together
        plane.opened = teeth;
        plane.is_closed = true;
    }
    Ok(after)
}
