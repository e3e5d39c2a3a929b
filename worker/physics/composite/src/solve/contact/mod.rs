//! Rollers pressed against faces: rigid, without friction.
//!
//! In small displacements a roller that has advanced by a into the section stands in the way of every particle of its face:
//! the particle's displacement w along the inward normal and the force p on it obey
//!
//! w ≥ a - g,  p ≥ 0,  p (w - a + g) = 0,  g = R - √(R² - d²)   (8)
//!
//! with the distance d of the particle from the roller's place along the face, both in the
//! undeformed section. The circle is exact; (8) itself is of first order, as all small displacements
//! are: it leaves out the turn of the normal and the way a particle travels along the face.
//! [`Rolling`] has both: there (9) of [`circles`] holds instead.
//!
//! [`Condensed`] finds what touches. It is at last given to [`equilibrium`] as supports, and (8) is
//! checked against what comes back.
mod circles;
mod condensed;
mod reach;
mod rolling;
mod trial;

pub(crate) use circles::Circles;
pub(crate) use reach::{Point, points};
pub use rolling::{Rolling, RollingState};

use self::condensed::{Condensed, Touch};
use crate::error::{CompositeError, finite, positive};
use crate::lattice::Lattice;
use crate::section::{Grid, within};
use crate::solve::equilibrium::{Equilibrium, StaticOptions};
use crate::solve::load_path::equilibrium;
use crate::stiffness::{Stiffness, compliance};
use crate::supports::{Face, Supports};

/// A rigid cylinder whose axis crosses the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roller {
    /// The face it lies against.
    pub face: Face,
    /// Where along the face [mm].
    pub at_mm: f64,
    pub radius_mm: f64,
}

/// A roller that has advanced from where it just touches the undeformed face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressedRoller {
    pub roller: Roller,
    /// Along the inward normal, positive into the section [mm].
    pub advance_mm: f64,
}

/// What a roller does to the section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollerContact {
    /// Along the inward normal [mm].
    pub advance_mm: f64,
    /// Pressing, along the inward normal [N].
    pub force_n: f64,
    /// Number of particles that carry it.
    pub particles: usize,
    /// The first and the last of them along the face [mm]; none where it does not touch.
    pub between_mm: Option<[f64; 2]>,
    /// Mean place of the force along the face [mm]; the roller's own where it does not touch.
    pub centre_mm: f64,
    /// Twice the root mean square distance of the force from its mean place [mm]: the half width of
    /// a contact under Hertz's pressure, known better than to a particle.
    pub half_width_mm: f64,
}

/// A lattice at rest between rollers.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEquilibrium {
    /// Its reactions hold the forces of rollers beside those of supports.
    pub equilibrium: Equilibrium,
    /// In the order of the rollers given.
    pub rollers: Vec<RollerContact>,
    /// Sets of touching particles that were tried.
    pub rounds: u64,
}

/// How well the equilibrium must obey (8), as a share of the largest force or displacement. A thin
/// sandwich with a core a thousand times softer, on cells from 0.01 mm to 1 mm, reaches 2e-7.
const OBEYED: f64 = 1e-5;

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

/// Half width [mm] of the contact of a rigid cylinder with a half-space, b² = 4 F R / (π E* t), for
/// the force F over the thickness t.
///
/// The half-space has a plane stiffness with the axes of its face: 1/E* =
/// ½ √(S₂₂ (2 S₁₂ + S₆₆ + 2 √(S₁₁S₂₂))) with 2 along the normal, which is 1/E in isotropic plane stress
/// and (1 - ν²)/E in plane strain. Source: [Johnson1985] (4.43), E* by the characteristic equation of
/// [Lekhnitskii1968]. Coupling of stretch and shear is left out.
#[must_use]
pub fn hertz_half_width_mm(
    stiffness: &Stiffness,
    thickness_mm: f64,
    radius_mm: f64,
    force_n: f64,
) -> f64 {
    let s = compliance(stiffness);
    let sum = 2.0 * s[(0, 1)] + s[(2, 2)] + 2.0 * (s[(0, 0)] * s[(1, 1)]).sqrt();
    let flexible = 0.5 * (s[(1, 1)] * sum).sqrt();
    (4.0 * force_n * radius_mm * flexible / (std::f64::consts::PI * thickness_mm)).sqrt()
}

impl Roller {
    /// The axis across its face.
    fn normal(&self) -> usize {
        1 - self.face.along()
    }

    /// The inward normal's component along [`Roller::normal`].
    fn inward(&self) -> f64 {
        match self.face {
            Face::Bottom | Face::Left => 1.0,
            Face::Top | Face::Right => -1.0,
        }
    }

    /// Distance of the roller from a place along its face while it just touches [mm]; `None` out of
    /// its reach.
    fn gap(&self, at_mm: f64) -> Option<f64> {
        let distance = at_mm - self.at_mm;
        let radius = self.radius_mm;
        let square = (radius - distance) * (radius + distance);
        // R - √(R² - d²) without cancellation.
        (square > 0.0).then(|| distance * distance / (radius + square.sqrt()))
    }

    fn checked(&self, grid: &Grid) -> Result<(), CompositeError> {
        positive("a roller's radius [mm]", self.radius_mm)?;
        finite("a roller's place [mm]", self.at_mm)?;
        if within(self.face.lines_mm(grid), self.at_mm).is_none() {
            let mut place = grid.place_mm(self.face.particle(grid, 0));
            place[self.face.along()] = self.at_mm;
            return Err(CompositeError::OutsideSection {
                what: "a roller",
                x_mm: place[0],
                y_mm: place[1],
            });
        }
        Ok(())
    }
}

fn obeyed(share: f64) -> Result<(), CompositeError> {
    if share <= OBEYED {
        Ok(())
    } else {
        Err(CompositeError::ContactUnsettled { share })
    }
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
