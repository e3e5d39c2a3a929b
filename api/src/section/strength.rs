//! What materials and their interfaces bear before they crack.

/// What is compared with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Criterion {
    /// Stresses [MPa].
    #[default]
    Stress,
    /// Strains; shears as angles.
    Strain,
}

/// Where a material or an interface begins to crack, and what the crack takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Stress [MPa] or strain, by the [`Criterion`].
    pub limit: f64,
    /// Energy per area of crack [N/mm = kJ/m²]. `None`: brittle, the cell is lost at once, and the energy
    /// of a crack is what its cells held, less the smaller they are.
    pub fracture_energy_n_per_mm: Option<f64>,
}

/// Limits of a material; what is `None` does not break.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strength {
    /// Largest principal stress of an isotropic material; along axis 1, the fibres, of an
    /// orthotropic one.
    pub tension: Option<Limit>,
    /// The same in compression.
    pub compression: Option<Limit>,
    /// Across the fibres of an orthotropic material: the matrix between them.
    pub across_tension: Option<Limit>,
    pub across_compression: Option<Limit>,
    /// Shear of an orthotropic material along its fibres.
    pub shear: Option<Limit>,
}

/// Limits of the face between a fibre and what it lies in. Tension across it and shear along it add
/// up as (σ/σ_n)² + (τ/τ_s)² = 1, compression across it does not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceStrength {
    pub normal: Limit,
    pub shear: Limit,
}

impl Strength {
    /// Whether nothing of it breaks.
    pub fn is_unbreakable(&self) -> bool {
        *self == Self::default()
    }
}
