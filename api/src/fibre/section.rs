//! The wall of a fibre: a round hollow tube, and what it is made of.
use std::f64::consts::PI;

use super::FibreError;

/// Densities of a dry fibre wall [kg/m³]; cellulose itself has 1500 to 1600.
pub const WALL_DENSITY_KG_PER_M3: [f64; 2] = [1200.0, 1600.0];

/// A hollow tube of outer width W and wall WT, its lumen w = W - 2 WT wide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    width_um: f64,
    wall_um: f64,
}

/// Where in the wall the ring of mass points lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ring {
    /// On the radius of gyration of torsion, Φ = 2 √(J/A) = √((W² + w²)/2): area and torsion agree.
    Gyration,
    /// On the face of the lumen, Φ = W - 2 WT, as the patent has it.
    Patent,
}

/// Constants of the wall along the fibre; the shear modulus is free of the other two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    youngs_modulus_gpa: f64,
    poisson_ratio: f64,
    shear_modulus_gpa: f64,
}

impl Section {
    /// A tube of this width and wall [µm].
    ///
    /// # Errors
    /// [`FibreError::OutOfRange`] unless 0 < wall ≤ width/2.
    pub fn new(width_um: f64, wall_um: f64) -> Result<Self, FibreError> {
        if !(width_um.is_finite() && width_um > 0.0) {
            return Err(FibreError::out_of_range(
                "fibre width",
                "µm",
                width_um,
                "above 0",
            ));
        }
        if !(wall_um > 0.0 && 2.0 * wall_um <= width_um) {
            let allowed = format!("above 0, at most half the width, {} µm", width_um / 2.0);
            return Err(FibreError::out_of_range(
                "fibre wall",
                "µm",
                wall_um,
                allowed,
            ));
        }
        Ok(Self { width_um, wall_um })
    }

    /// Outer diameter W [µm].
    pub fn width_um(&self) -> f64 {
        self.width_um
    }

    /// Thickness of the wall WT [µm].
    pub fn wall_um(&self) -> f64 {
        self.wall_um
    }

    /// Inner diameter w = W - 2 WT [µm].
    pub fn lumen_um(&self) -> f64 {
        (self.width_um - 2.0 * self.wall_um).max(0.0)
    }

    /// Area of the wall A = π WT (W - WT) [µm²].
    pub fn area_um2(&self) -> f64 {
        PI * self.wall_um * (self.width_um - self.wall_um)
    }

    /// Second moment of area I = π/64 (W⁴ - w⁴) [µm⁴], equal about all axes.
    pub fn inertia_um4(&self) -> f64 {
        PI / 64.0 * (self.width_um.powi(4) - self.lumen_um().powi(4))
    }

    /// Torsion constant J = 2 I of a round tube [µm⁴].
    pub fn polar_um4(&self) -> f64 {
        2.0 * self.inertia_um4()
    }

    /// Diameter Φ of the ring of mass points [µm].
    ///
    /// # Errors
    /// [`FibreError::OutOfRange`] for the patent's ring in a fibre without lumen.
    pub fn ring_diameter_um(&self, ring: Ring) -> Result<f64, FibreError> {
        match ring {
            Ring::Gyration => Ok(2.0 * (self.polar_um4() / self.area_um2()).sqrt()),
            Ring::Patent if self.lumen_um() > 0.0 => Ok(self.lumen_um()),
            Ring::Patent => Err(FibreError::out_of_range(
                "lumen of the fibre",
                "µm",
                self.lumen_um(),
                "above 0 for the patent's ring, which lies on its face; the gyration ring takes any",
            )),
        }
    }

    /// Density of the wall that a coarseness stands for, ρ = c/A [kg/m³]: mg/m over µm² is 10⁶ kg/m³.
    pub fn wall_density_kg_per_m3(&self, coarseness_mg_per_m: f64) -> f64 {
        1e6 * coarseness_mg_per_m / self.area_um2()
    }

    /// Coarseness [mg/m] of this wall at a density [kg/m³], c = ρ A.
    pub fn coarseness_mg_per_m(&self, density_kg_per_m3: f64) -> f64 {
        1e-6 * density_kg_per_m3 * self.area_um2()
    }

    /// A sentence with both numbers when coarseness and wall contradict one another.
    pub fn contradiction(&self, coarseness_mg_per_m: f64) -> Option<String> {
        let density = self.wall_density_kg_per_m3(coarseness_mg_per_m);
        let [least, most] = WALL_DENSITY_KG_PER_M3;
        (!(least..=most).contains(&density)).then(|| {
            format!(
                "a coarseness of {coarseness_mg_per_m} mg/m and a wall of {:.1} µm² mean a wall density of \
                 {density:.0} kg/m³; walls have {least:.0} to {most:.0}, which is {:.3} to {:.3} mg/m",
                self.area_um2(),
                self.coarseness_mg_per_m(least),
                self.coarseness_mg_per_m(most),
            )
        })
    }
}

impl Elasticity {
    /// Young's modulus E along the fibre [GPa], Poisson's ratio ν [-] and shear modulus G [GPa].
    ///
    /// # Errors
    /// [`FibreError::OutOfRange`] unless E > 0, 0 < ν ≤ 0.5 and G > 0: springs cannot make a tube that
    /// does not contract.
    pub fn new(
        youngs_modulus_gpa: f64,
        poisson_ratio: f64,
        shear_modulus_gpa: f64,
    ) -> Result<Self, FibreError> {
        for (quantity, given) in [
            ("Young's modulus", youngs_modulus_gpa),
            ("shear modulus", shear_modulus_gpa),
        ] {
            if !(given.is_finite() && given > 0.0) {
                return Err(FibreError::out_of_range(quantity, "GPa", given, "above 0"));
            }
        }
        if !(poisson_ratio > 0.0 && poisson_ratio <= 0.5) {
            return Err(FibreError::out_of_range(
                "Poisson's ratio",
                "1",
                poisson_ratio,
                "above 0, at most 0.5",
            ));
        }
        Ok(Self {
            youngs_modulus_gpa,
            poisson_ratio,
            shear_modulus_gpa,
        })
    }

    /// E [GPa].
    pub fn youngs_modulus_gpa(&self) -> f64 {
        self.youngs_modulus_gpa
    }

    /// ν [-].
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// G [GPa].
    pub fn shear_modulus_gpa(&self) -> f64 {
        self.shear_modulus_gpa
    }
}
