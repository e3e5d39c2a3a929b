//! The rest of a section between rollers in small displacements, found and checked.
use super::condensed::{Condensed, Touch};
use super::roller::{ContactEquilibrium, PressedRoller, Roller, RollerContact, obeyed};
use crate::error::{CompositeError, finite, positive};
use crate::lattice::Lattice;
use crate::solve::equilibrium::StaticOptions;
use crate::solve::load_path::equilibrium;
use crate::supports::Supports;

/// Finds the rest of a lattice between rollers that have advanced by given amounts.
///
/// Displacements along the face's normal must not be prescribed where a roller reaches.
///
/// # Errors
/// When geometry is large; a roller has no radius, lies beside its face, over another or on a
/// support; when supports and rollers leave the section loose; or no equilibrium is found.
pub fn contact_equilibrium(
    lattice: &Lattice,
    supports: &Supports,
    load_n: &[f64],
    rollers: &[PressedRoller],
    options: &StaticOptions,
) -> Result<ContactEquilibrium, CompositeError> {
    let advances = rollers
        .iter()
        .map(|pressed| finite("a roller's advance [mm]", pressed.advance_mm).map(Some))
        .collect::<Result<Vec<_>, _>>()?;
    let rollers: Vec<Roller> = rollers.iter().map(|pressed| pressed.roller).collect();
    let mut condensed = Condensed::new(lattice, supports, load_n, &rollers, options)?;
    let touch = condensed.settle(&advances, 0.0)?;
    certified(&condensed, supports, load_n, &rollers, options, &touch)
}

/// As [`contact_equilibrium`], with further rollers that advance together until the sum of their
/// forces is `force_n` [N]. They come after the others in what is returned.
///
/// # Errors
/// As [`contact_equilibrium`], and when the force is not above 0 or no roller presses.
pub fn pressed_equilibrium(
    lattice: &Lattice,
    supports: &Supports,
    load_n: &[f64],
    resting: &[PressedRoller],
    pressing: &[Roller],
    force_n: f64,
    options: &StaticOptions,
) -> Result<ContactEquilibrium, CompositeError> {
    positive("the force on the rollers [N]", force_n)?;
    if pressing.is_empty() {
        return Err(CompositeError::OutOfRange {
            quantity: "the number of rollers that press",
            given: 0.0,
            allowed: "at least 1",
        });
    }
    let mut advances = Vec::with_capacity(resting.len() + pressing.len());
    for pressed in resting {
        advances.push(Some(finite("a roller's advance [mm]", pressed.advance_mm)?));
    }
    advances.resize(resting.len() + pressing.len(), None);
    let rollers: Vec<Roller> = resting
        .iter()
        .map(|pressed| pressed.roller)
        .chain(pressing.iter().copied())
        .collect();
    let mut condensed = Condensed::new(lattice, supports, load_n, &rollers, options)?;
    let touch = condensed.settle(&advances, force_n)?;
    let found = certified(&condensed, supports, load_n, &rollers, options, &touch)?;
    let pressed: f64 = found.rollers[resting.len()..]
        .iter()
        .map(|contact| contact.force_n)
        .sum();
    obeyed((pressed / force_n - 1.0).abs())?;
    Ok(found)
}

/// The equilibrium with touching particles held where the rollers want them, checked against (8).
fn certified(
    condensed: &Condensed,
    supports: &Supports,
    load: &[f64],
    rollers: &[Roller],
    options: &StaticOptions,
    touch: &Touch,
) -> Result<ContactEquilibrium, CompositeError> {
    let lattice = condensed.lattice;
    let grid = lattice.grid();
    let mut held = supports.clone();
    for (place, point) in condensed.points.iter().enumerate() {
        if touch.touching[place] {
            let value = point.inward * (touch.advances[point.roller] - point.gap_mm);
            held.hold(grid, point.displacement / 2, point.displacement % 2, value)?;
        }
    }
    let rest = equilibrium(lattice, &held, load, options)?;
    let mut contacts: Vec<RollerContact> = rollers
        .iter()
        .zip(&touch.advances)
        .map(|(roller, &advance_mm)| RollerContact {
            advance_mm,
            force_n: 0.0,
            particles: 0,
            between_mm: None,
            centre_mm: roller.at_mm,
            half_width_mm: 0.0,
        })
        .collect();
    let mut moments = vec![[0.0; 2]; rollers.len()];
    let (mut largest, mut pulled) = (0.0_f64, 0.0_f64);
    let (mut farthest, mut pierced) = (0.0_f64, 0.0_f64);
    for (place, point) in condensed.points.iter().enumerate() {
        let inward = point.inward * rest.displacements_mm[point.displacement];
        farthest = farthest.max(inward.abs());
        for (roller, advance) in rollers.iter().zip(&touch.advances) {
            if roller.face == rollers[point.roller].face
                && let Some(gap) = roller.gap(point.at_mm)
            {
                pierced = pierced.max(advance - gap - inward);
            }
        }
        if touch.touching[place] {
            let force = point.inward * rest.reactions_n[point.displacement];
            largest = largest.max(force);
            pulled = pulled.max(-force);
            let contact = &mut contacts[point.roller];
            contact.force_n += force;
            contact.particles += 1;
            let [from, to] = contact.between_mm.unwrap_or([point.at_mm; 2]);
            contact.between_mm = Some([from.min(point.at_mm), to.max(point.at_mm)]);
            let distance = point.at_mm - rollers[point.roller].at_mm;
            moments[point.roller][0] += force * distance;
            moments[point.roller][1] += force * distance * distance;
        }
    }
    if largest > 0.0 {
        obeyed(pulled / largest)?;
    }
    if farthest > 0.0 {
        obeyed(pierced / farthest)?;
    }
    for (contact, [first, second]) in contacts.iter_mut().zip(moments) {
        if contact.force_n > 0.0 {
            let mean = first / contact.force_n;
            contact.centre_mm += mean;
            let spread = second / contact.force_n - mean * mean;
            contact.half_width_mm = 2.0 * spread.max(0.0).sqrt();
        }
    }
    Ok(ContactEquilibrium {
        equilibrium: rest,
        rollers: contacts,
        rounds: touch.rounds,
    })
}
