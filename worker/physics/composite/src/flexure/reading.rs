//! What a laboratory would read of a bent section, and what its formulas make of it.
use super::places::{middle, shear_through};
use super::{Beam, BeamDeflection, Flexure, Loading};
use crate::error::{CompositeError, finite};
use crate::lattice::{Geometry, Lattice};
use crate::measure::point_mm;
use crate::section::{Grid, Section};
use crate::solve::ContactEquilibrium;

/// The test by the theory of beams, see [`Beam::of`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamTest {
    pub beam: Beam,
    /// Midspan deflection under the force of the test.
    pub deflection: BeamDeflection,
    /// 12 EI / (b h³) [MPa]: the modulus the formula looks for.
    pub true_modulus_mpa: f64,
    /// What the formula makes of the beam's deflection, shear included [MPa].
    pub apparent_modulus_mpa: f64,
    /// What the formula makes of the test's own deflection without the beam's shear [MPa]; none
    /// where shear is all there is.
    pub corrected_modulus_mpa: Option<f64>,
}

/// What the standards' corrections for large deflections make of stress and strain of the outer fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Far {
    /// [MPa].
    pub outer_stress_mpa: f64,
    pub outer_strain: f64,
}

/// What a bending test gives.
#[derive(Debug, Clone, PartialEq)]
pub struct FlexureResult {
    /// Total force F of the rollers that press [N].
    pub force_n: f64,
    /// Way of the rollers that press, as a machine's crosshead would tell it [mm]: with what all
    /// rollers dent.
    pub roller_deflection_mm: f64,
    /// Deflection s of the bottom face at midspan against the supporting rollers [mm]; formulas use
    /// this one.
    pub midspan_deflection_mm: f64,
    /// L / h [-].
    pub span_to_depth: f64,
    /// E_f [MPa], see [`Loading::flexural_modulus`].
    pub flexural_modulus_mpa: f64,
    /// Nominal stress σ_f of the outer fibre at midspan [MPa], see [`Loading::outer_stress`].
    pub outer_stress_mpa: f64,
    /// Nominal strain ε_f of the outer fibre at midspan [-], see [`Loading::outer_strain`].
    pub outer_strain: f64,
    /// σ_f [MPa] and ε_f [-] corrected for the large deflection, see [`Loading::outer_stress_far`]; none
    /// in small displacements.
    pub far: Option<Far>,
    /// Apparent interlaminar shear stress τ = 3F / (4 b h) [MPa] of ISO 14130; none in four-point
    /// loading.
    pub apparent_shear_stress_mpa: Option<f64>,
    /// Largest |σ_xy| of a cell halfway between the left support and the next roller that presses
    /// [MPa]; none in the paper's lattice.
    pub shear_stress_mpa: Option<f64>,
    /// What keeps the section from sliding [N]: 0 but for round-off, since rollers have no friction.
    pub horizontal_reaction_n: f64,
    /// The beam the section is; none where it is none.
    pub beam: Option<BeamTest>,
    /// Supports left and right, then what presses from left to right.
    pub contact: ContactEquilibrium,
}

impl Flexure {
    /// A contact that reaches an end of the section would go on beyond it.
    fn refuse_running_off(
        &self,
        grid: &Grid,
        contact: &ContactEquilibrium,
    ) -> Result<(), CompositeError> {
        let lines = grid.x_mm();
        let ends = [lines[0], lines[grid.columns()]];
        for between in contact
            .rollers
            .iter()
            .filter_map(|roller| roller.between_mm)
        {
            if between[0] <= ends[0] || between[1] >= ends[1] {
                return Err(CompositeError::OutOfRange {
                    quantity: "the section's overhang beyond a support [mm]",
                    given: 0.5 * (ends[1] - self.span_mm),
                    allowed: "more than half the width of the contact: choose a shorter span",
                });
            }
        }
        Ok(())
    }

    /// What the laboratory would read of a section between the rollers.
    ///
    /// # Errors
    /// When a contact has run off an end of the section.
    pub fn read(
        &self,
        section: &Section,
        lattice: &Lattice,
        geometry: Geometry,
        contact: ContactEquilibrium,
    ) -> Result<FlexureResult, CompositeError> {
        let grid = lattice.grid();
        self.refuse_running_off(grid, &contact)?;
        let (length, span) = (section.length_mm, self.span_mm);
        let sides = [section.thickness_mm, section.height_mm];
        let u = &contact.equilibrium.displacements_mm;
        let force_n: f64 = contact.rollers[2..]
            .iter()
            .map(|roller| roller.force_n)
            .sum();
        let deflection = -point_mm(grid, [0.5 * length, 0.0], u)?[1];
        let force_per_mm = finite("the force over the deflection [N/mm]", force_n / deflection)?;
        let modulus = |force_per_mm| self.loading.flexural_modulus(span, sides, force_per_mm);
        let beam = Beam::of(section)?.map(|beam| {
            let by_beam = self.timoshenko_deflection(&beam, force_n);
            let bent = deflection - by_beam.shear_mm;
            BeamTest {
                beam,
                deflection: by_beam,
                true_modulus_mpa: 12.0 * beam.bending_n_mm2 / (sides[0] * sides[1].powi(3)),
                apparent_modulus_mpa: modulus(force_n / by_beam.total_mm()),
                corrected_modulus_mpa: (bent > 0.0).then(|| modulus(force_n / bent)),
            }
        });
        // Halfway to the next roller that presses.
        let arm = match self.loading {
            Loading::ThreePoint => 0.5 * span,
            Loading::FourPoint => span / 3.0,
        };
        let shear = shear_through(lattice, geometry, 0.5 * (length - span) + 0.5 * arm, u);
        let far = (geometry == Geometry::Large).then(|| Far {
            outer_stress_mpa: self
                .loading
                .outer_stress_far(span, sides, force_n, deflection),
            outer_strain: self
                .loading
                .outer_strain_far(span, section.height_mm, deflection),
        });
        Ok(FlexureResult {
            force_n,
            roller_deflection_mm: contact.rollers[2].advance_mm,
            midspan_deflection_mm: deflection,
            span_to_depth: span / section.height_mm,
            flexural_modulus_mpa: modulus(force_per_mm),
            outer_stress_mpa: self.loading.outer_stress(span, sides, force_n),
            outer_strain: self
                .loading
                .outer_strain(span, section.height_mm, deflection),
            far,
            apparent_shear_stress_mpa: (self.loading == Loading::ThreePoint)
                .then(|| 0.75 * force_n / (sides[0] * sides[1])),
            shear_stress_mpa: shear
                .iter()
                .map(|&(_, stress)| stress.abs())
                .reduce(f64::max),
            horizontal_reaction_n: contact.equilibrium.reactions_n[2 * middle(section, grid)],
            beam,
            contact,
        })
    }
}
