//! Bending tests between rollers: three-point, four-point and short beam.
//!
//! A section rests on two rollers and is pressed by one or two from above, as the standards ISO 14125
//! (flexure, methods A and B, [ISO14125]) and ISO 14130 (short beam, [ISO14130]) have it. The specimen's width b is the
//! section's thickness, its thickness h the section's height, its span L the distance of the
//! supports. [`Flexure::bend`] gives what the laboratory would read and what its formulas make of it,
//! beside what the layers are by the theory of beams: so what the formulas leave out can be seen.
//!
//! Rollers have no friction. Displacements are small, or follow the rollers as far as they go
//! ([`Flexure::rolling`]); then the standards' corrections for large deflections are told too.
mod beam;
mod deflected;
#[cfg(test)]
mod elastica;
mod loading;
mod places;
mod reading;
#[cfg(test)]
mod tests;

pub use beam::Beam;
pub use deflected::{End, PointForce, deflected_line, line_on_supports};
pub use loading::Loading;
pub use reading::{BeamTest, Far, FlexureResult};

use loadframe_api::section::contact::{CONTACT_REACH, hertz_half_width_mm};
use places::middle;

use crate::error::{CompositeError, positive};
use crate::lattice::{Geometry, Lattice};
use crate::section::{Refinement, Section};
use crate::solve::{
    PressedRoller, Roller, Rolling, StaticOptions, contact_equilibrium, pressed_equilibrium,
};
use crate::supports::{Face, Supports};

/// A bending test, symmetric about the middle of the section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flexure {
    pub loading: Loading,
    /// Distance of the supports L [mm].
    pub span_mm: f64,
    /// R₁ of the rollers that press [mm]; 5 mm in the standards.
    pub loading_radius_mm: f64,
    /// R₂ of the rollers beneath [mm]; 2 mm or 5 mm in the standards.
    pub support_radius_mm: f64,
}

/// What is prescribed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// Total force F on the rollers that press [N].
    Force(f64),
    /// Their way down from where they touch the undeformed section [mm].
    Advance(f64),
}

/// Parts of a beam's deflection [mm].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamDeflection {
    pub bending_mm: f64,
    pub shear_mm: f64,
}

impl BeamDeflection {
    /// Both together.
    #[must_use]
    pub fn total_mm(&self) -> f64 {
        self.bending_mm + self.shear_mm
    }
}

impl Flexure {
    /// Midspan deflection of a beam by [Timoshenko1921] under the total force F [N]:
    /// F L³/(48 EI) + F L/(4 kGA), or 23 F L³/(1296 EI) + F L/(6 kGA) with two rollers.
    #[must_use]
    pub fn timoshenko_deflection(&self, beam: &Beam, force_n: f64) -> BeamDeflection {
        let (bending, shear) = match self.loading {
            Loading::ThreePoint => (1.0 / 48.0, 1.0 / 4.0),
            Loading::FourPoint => (23.0 / 1296.0, 1.0 / 6.0),
        };
        BeamDeflection {
            bending_mm: bending * force_n * self.span_mm.powi(3) / beam.bending_n_mm2,
            shear_mm: shear * force_n * self.span_mm / beam.shear_n,
        }
    }

    /// The rollers beneath, left and right, and those that press, from left to right.
    #[must_use]
    pub fn rollers(&self, section: &Section) -> ([Roller; 2], Vec<Roller>) {
        let middle = 0.5 * section.length_mm;
        let beneath = [-0.5, 0.5].map(|share| Roller {
            face: Face::Bottom,
            at_mm: middle + share * self.span_mm,
            radius_mm: self.support_radius_mm,
        });
        let shares: &[f64] = match self.loading {
            Loading::ThreePoint => &[0.0],
            Loading::FourPoint => &[-1.0 / 6.0, 1.0 / 6.0],
        };
        let above = shares
            .iter()
            .map(|share| Roller {
                face: Face::Top,
                at_mm: middle + share * self.span_mm,
                radius_mm: self.loading_radius_mm,
            })
            .collect();
        (beneath, above)
    }

    /// What a beam between the rollers bears under the total force F [N], at their own places, from left to
    /// right.
    #[must_use]
    pub fn forces(&self, section: &Section, force_n: f64) -> Vec<PointForce> {
        let (beneath, above) = self.rollers(section);
        let each = force_n / above.len() as f64;
        let resting = |roller: &Roller| PointForce {
            at_mm: roller.at_mm,
            force_n: 0.5 * force_n,
        };
        let mut forces = vec![resting(&beneath[0])];
        forces.extend(above.iter().map(|roller| PointForce {
            at_mm: roller.at_mm,
            force_n: -each,
        }));
        forces.push(resting(&beneath[1]));
        forces
    }

    /// Slope of a beam on its supports under the total force F [N], with bending alone:
    /// F L²/(16 EI), or F L²/(18 EI) with two rollers.
    #[must_use]
    pub fn support_slope(&self, beam: &Beam, force_n: f64) -> f64 {
        let share = match self.loading {
            Loading::ThreePoint => 1.0 / 16.0,
            Loading::FourPoint => 1.0 / 18.0,
        };
        share * force_n * self.span_mm * self.span_mm / beam.bending_n_mm2
    }

    /// Where a graded division must be fine for contacts under a total force to be resolved: `across`
    /// cells through each half width that Hertz's contact would have. Where the section turns on its
    /// supports, the contacts wander inward by R₂ times its slope.
    ///
    /// # Errors
    /// When the force is not above 0, or what is wrong with the test or the section.
    pub fn refinements(
        &self,
        section: &Section,
        force_n: f64,
        across: usize,
    ) -> Result<Vec<Refinement>, CompositeError> {
        positive("the force on the rollers [N]", force_n)?;
        self.checked(section)?;
        if across == 0 {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of cells across half a contact",
                given: 0.0,
                allowed: "at least 1",
            });
        }
        let stack = section.stack()?;
        let (beneath, above) = self.rollers(section);
        let wander = Beam::of(section)?.map_or(0.0, |beam| {
            self.support_radius_mm * self.support_slope(&beam, force_n)
        });
        let fine = |roller: &Roller, force: f64, wander: f64| {
            let (ply, y) = match roller.face {
                Face::Bottom => (&stack[0], 0.0),
                _ => (&stack[stack.len() - 1], section.height_mm),
            };
            let (stiffness, _) = section.ply_stiffness(ply, section.state)?;
            let half_width =
                hertz_half_width_mm(&stiffness, section.thickness_mm, roller.radius_mm, force);
            Ok::<_, CompositeError>(Refinement {
                at_mm: [roller.at_mm + wander, y],
                half_width_mm: CONTACT_REACH * half_width,
                cell_mm: half_width / across as f64,
            })
        };
        let each = force_n / above.len() as f64;
        let mut refinements = vec![
            fine(&beneath[0], 0.5 * force_n, wander)?,
            fine(&beneath[1], 0.5 * force_n, -wander)?,
        ];
        for roller in &above {
            refinements.push(fine(roller, each, 0.0)?);
        }
        Ok(refinements)
    }

    fn checked(&self, section: &Section) -> Result<(), CompositeError> {
        if !(self.span_mm > 0.0 && self.span_mm < section.length_mm) {
            return Err(CompositeError::OutOfRange {
                quantity: "the span [mm]",
                given: self.span_mm,
                allowed: "above 0 and below the section's length",
            });
        }
        positive("a loading roller's radius [mm]", self.loading_radius_mm)?;
        positive("a supporting roller's radius [mm]", self.support_radius_mm)?;
        Ok(())
    }

    /// Bends a section, given as its lattice too, between the rollers.
    ///
    /// # Errors
    /// When the span does not lie within the section, rollers overlap or run off its ends, the drive
    /// does not press; and as [`contact_equilibrium`].
    pub fn bend(
        &self,
        section: &Section,
        lattice: &Lattice,
        drive: Drive,
        options: &StaticOptions,
    ) -> Result<FlexureResult, CompositeError> {
        self.checked(section)?;
        if options.geometry == Geometry::Large {
            let (supports, still) = self.kept(section, lattice)?;
            let mut rolling = self.rolling(section, lattice, &supports, &still, options)?;
            match drive {
                Drive::Force(force_n) => rolling.press_to(force_n)?,
                Drive::Advance(advance_mm) => {
                    positive("the way of the rollers that press [mm]", advance_mm)?;
                    rolling.advance_to(advance_mm)?;
                }
            }
            let contact = rolling.equilibrium()?;
            return self.read(section, lattice, Geometry::Large, contact);
        }
        let (beneath, above) = self.rollers(section);
        let resting = beneath.map(|roller| PressedRoller {
            roller,
            advance_mm: 0.0,
        });
        let (supports, load) = self.kept(section, lattice)?;
        let contact = match drive {
            Drive::Force(force_n) => pressed_equilibrium(
                lattice, &supports, &load, &resting, &above, force_n, options,
            )?,
            Drive::Advance(advance_mm) => {
                positive("the way of the rollers that press [mm]", advance_mm)?;
                let rollers: Vec<PressedRoller> = resting
                    .into_iter()
                    .chain(
                        above
                            .iter()
                            .map(|&roller| PressedRoller { roller, advance_mm }),
                    )
                    .collect();
                contact_equilibrium(lattice, &supports, &load, &rollers, options)?
            }
        };
        self.read(section, lattice, Geometry::Linear, contact)
    }

    /// What keeps the section from sliding, which bears nothing, and a load of nothing.
    ///
    /// # Errors
    /// None but what [`Supports::hold`] has.
    pub fn kept(
        &self,
        section: &Section,
        lattice: &Lattice,
    ) -> Result<(Supports, Vec<f64>), CompositeError> {
        let mut supports = Supports::none(lattice.grid());
        supports.hold(lattice.grid(), middle(section, lattice.grid()), 0, 0.0)?;
        Ok((supports, vec![0.0; lattice.displacements()]))
    }

    /// The section between the rollers in large displacements, before anything presses; supports and
    /// load are those of [`Flexure::kept`].
    ///
    /// # Errors
    /// As [`Flexure::bend`].
    pub fn rolling<'a>(
        &self,
        section: &Section,
        lattice: &'a Lattice,
        supports: &'a Supports,
        still: &'a [f64],
        options: &'a StaticOptions,
    ) -> Result<Rolling<'a>, CompositeError> {
        self.checked(section)?;
        let (beneath, above) = self.rollers(section);
        Rolling::new(lattice, supports, still, &beneath, &above, options)
    }
}
