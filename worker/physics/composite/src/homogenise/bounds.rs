//! What is known of a composite without its geometry: bounds, and the formulas of handbooks.
//!
//! Symbols: f share of fibre; k plane-strain bulk modulus of the plane of 2 and 3, at ε₂₂ = ε₃₃ and
//! no ε₁₁; G₂₃ shear modulus of that plane, G₁₂ along the fibres. All moduli [MPa].
use std::fmt;

use super::constants::Constants;
use super::effective::{Effective, inverse};
use super::phase::Space;
use crate::error::CompositeError;
use crate::material::Material;

/// How far apart constants of a material may be that is called isotropic across the fibres.
const ALIKE: f64 = 1e-9;

/// Estimates beside a cell's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Companions {
    /// All strains alike in both phases: no stiffness is higher.
    pub voigt: Constants,
    /// All stresses alike: no stiffness is lower.
    pub reuss: Constants,
    /// Hashin-Shtrikman bounds of fibres whose places prefer no direction across them; `None` unless
    /// both phases are isotropic across the fibres. Of ν₂₃, which neither stiffness orders, the
    /// lowest and highest that moduli within the bounds allow.
    pub hashin_shtrikman_lower: Option<Constants>,
    pub hashin_shtrikman_upper: Option<Constants>,
    pub halpin_tsai: Estimate,
    pub chamis: Estimate,
}

/// Constants of a handbook's formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    pub e1_mpa: f64,
    pub e2_mpa: f64,
    pub nu12: f64,
    pub g12_mpa: f64,
    /// `None` where the formulas have none.
    pub g23_mpa: Option<f64>,
}

/// A material that is isotropic across the fibres.
#[derive(Debug, Clone, Copy)]
struct Transverse {
    e1: f64,
    nu12: f64,
    bulk: f64,
    g23: f64,
    g12: f64,
}

impl Transverse {
    fn of(space: &Space) -> Result<Option<Self>, CompositeError> {
        let constants = Constants::of_compliance(&inverse(space)?);
        let alike = |a: f64, b: f64| (a - b).abs() <= ALIKE * a.abs().max(b.abs());
        let is_transverse = alike(space[(1, 1)], space[(2, 2)])
            && alike(space[(0, 1)], space[(0, 2)])
            && alike(space[(4, 4)], space[(5, 5)])
            && alike(space[(3, 3)], 0.5 * (space[(1, 1)] - space[(1, 2)]));
        Ok(is_transverse.then(|| Self {
            e1: constants.e1_mpa,
            nu12: constants.nu12,
            bulk: 0.5 * (space[(1, 1)] + space[(1, 2)]),
            g23: space[(3, 3)],
            g12: space[(5, 5)],
        }))
    }
}

/// Bounds and estimates of fibres that fill a share `fraction` of a matrix.
///
/// # Errors
/// When a material is not one, or the fraction not between 0 and 1.
pub fn companions(
    fibre: &Material,
    matrix: &Material,
    fraction: f64,
) -> Result<Companions, CompositeError> {
    if !(0.0..=1.0).contains(&fraction) {
        return Err(CompositeError::OutOfRange {
            quantity: "the fraction of fibres",
            given: fraction,
            allowed: "from 0 to 1",
        });
    }
    let (fibre, _) = fibre.stiffness_of_space()?;
    let (matrix, _) = matrix.stiffness_of_space()?;
    let (soft, stiff) = (inverse(&matrix)?, inverse(&fibre)?);
    let shares = [1.0 - fraction, fraction];
    let voigt = inverse(&(matrix * shares[0] + fibre * shares[1]))?;
    let reuss = soft * shares[0] + stiff * shares[1];
    let of = [Transverse::of(&matrix)?, Transverse::of(&fibre)?];
    let bounds = match of {
        [Some(matrix), Some(fibre)] => Some(hashin_shtrikman([matrix, fibre], shares)),
        _ => None,
    };
    let (soft, stiff) = (
        Constants::of_compliance(&soft),
        Constants::of_compliance(&stiff),
    );
    Ok(Companions {
        voigt: Constants::of_compliance(&voigt),
        reuss: Constants::of_compliance(&reuss),
        hashin_shtrikman_lower: bounds.map(|[lower, _]| lower),
        hashin_shtrikman_upper: bounds.map(|[_, upper]| upper),
        halpin_tsai: halpin_tsai(&stiff, &soft, fraction),
        chamis: chamis(&stiff, &soft, fraction),
    })
}

/// Moduli k, G₂₃, G₁₂ on the lower or the upper side.
///
/// With a reference of the smaller or larger of each modulus, [Hill1964] and [Hashin1965] in the
/// form of [Walpole1969], which needs no phase to be the stiffer in everything:
///
/// k* = ⟨1/(k + G₀)⟩⁻¹ - G₀,  G₂₃* = ⟨1/(G₂₃ + H)⟩⁻¹ - H with H = k₀G₀/(k₀ + 2G₀),
/// G₁₂* = ⟨1/(G₁₂ + G₀₁₂)⟩⁻¹ - G₀₁₂.
fn moduli(phases: [Transverse; 2], shares: [f64; 2], pick: fn(f64, f64) -> f64) -> [f64; 3] {
    let [bulk, g23, g12] = [
        phases.map(|phase| phase.bulk),
        phases.map(|phase| phase.g23),
        phases.map(|phase| phase.g12),
    ];
    let mean = |values: [f64; 2], reference: f64| {
        1.0 / (shares[0] / (values[0] + reference) + shares[1] / (values[1] + reference))
            - reference
    };
    let (k, g) = (pick(bulk[0], bulk[1]), pick(g23[0], g23[1]));
    [
        mean(bulk, g),
        mean(g23, k * g / (k + 2.0 * g)),
        mean(g12, pick(g12[0], g12[1])),
    ]
}

/// Lower and upper bounds.
fn hashin_shtrikman(phases: [Transverse; 2], shares: [f64; 2]) -> [Constants; 2] {
    let sides = [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| {
        let [bulk, g23, g12] = moduli(phases, shares, pick);
        let reference = pick(phases[0].g23, phases[1].g23);
        let (e1, nu12) = along(phases, shares, reference);
        // stiffness under equal stresses across the fibres, with none along them
        let soft = 1.0 / bulk + 4.0 * nu12 * nu12 / e1;
        (bulk, g23, g12, e1, nu12, soft)
    });
    let of = |side: usize, other: usize| {
        let (_, g23, g12, e1, _, soft) = sides[side];
        let e2 = 4.0 / (1.0 / g23 + soft);
        // ν₂₃ = E₂/(2 G₂₃) - 1 falls with G₂₃ and rises with the other stiffness
        let nu23 = 2.0 / (1.0 + sides[other].1 * soft) - 1.0;
        let nu12 = [sides[side].4, sides[other].4];
        let nu12 = if side == 0 {
            nu12[0].min(nu12[1])
        } else {
            nu12[0].max(nu12[1])
        };
        Constants {
            e1_mpa: e1,
            e2_mpa: e2,
            e3_mpa: e2,
            nu12,
            nu13: nu12,
            nu23,
            g12_mpa: g12,
            g13_mpa: g12,
            g23_mpa: g23,
        }
    };
    [of(0, 1), of(1, 0)]
}

/// E₁ and ν₁₂ where k is at its bound with the reference G₀: [Hill1964],
///
/// E₁ = ⟨E₁⟩ + 4 f(1 - f)(ν_f - ν_m)²/D, ν₁₂ = ⟨ν₁₂⟩ + f(1 - f)(ν_f - ν_m)(1/k_m - 1/k_f)/D,
/// D = (1 - f)/k_f + f/k_m + 1/G₀.
fn along([matrix, fibre]: [Transverse; 2], [rest, share]: [f64; 2], reference: f64) -> (f64, f64) {
    let resistance = rest / fibre.bulk + share / matrix.bulk + 1.0 / reference;
    let difference = fibre.nu12 - matrix.nu12;
    let e1 = rest * matrix.e1
        + share * fibre.e1
        + 4.0 * share * rest * difference * difference / resistance;
    let nu12 = rest * matrix.nu12
        + share * fibre.nu12
        + share * rest * difference * (1.0 / matrix.bulk - 1.0 / fibre.bulk) / resistance;
    (e1, nu12)
}

/// M = M_m (1 + ξηf)/(1 - ηf), η = (M_f/M_m - 1)/(M_f/M_m + ξ), with ξ = 2 for E₂ and 1 for G₁₂;
/// along the fibres the mean by shares. Source: [HalpinKardos1976].
fn halpin_tsai(fibre: &Constants, matrix: &Constants, f: f64) -> Estimate {
    let modulus = |of_fibre: f64, of_matrix: f64, xi: f64| {
        let ratio = of_fibre / of_matrix;
        let eta = (ratio - 1.0) / (ratio + xi);
        of_matrix * (1.0 + xi * eta * f) / (1.0 - eta * f)
    };
    Estimate {
        e1_mpa: f * fibre.e1_mpa + (1.0 - f) * matrix.e1_mpa,
        e2_mpa: modulus(fibre.e2_mpa, matrix.e2_mpa, 2.0),
        nu12: f * fibre.nu12 + (1.0 - f) * matrix.nu12,
        g12_mpa: modulus(fibre.g12_mpa, matrix.g12_mpa, 1.0),
        g23_mpa: None,
    }
}

/// M = M_m/(1 - √f (1 - M_m/M_f)) across and in shear; along the fibres the mean by shares. Source:
/// [Chamis1984].
fn chamis(fibre: &Constants, matrix: &Constants, f: f64) -> Estimate {
    let modulus =
        |of_fibre: f64, of_matrix: f64| of_matrix / (1.0 - f.sqrt() * (1.0 - of_matrix / of_fibre));
    Estimate {
        e1_mpa: f * fibre.e1_mpa + (1.0 - f) * matrix.e1_mpa,
        e2_mpa: modulus(fibre.e2_mpa, matrix.e2_mpa),
        nu12: f * fibre.nu12 + (1.0 - f) * matrix.nu12,
        g12_mpa: modulus(fibre.g12_mpa, matrix.g12_mpa),
        g23_mpa: Some(modulus(fibre.g23_mpa, matrix.g23_mpa)),
    }
}

/// A modulus of a cell beyond a Hashin-Shtrikman bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// Symbol of the modulus.
    pub modulus: &'static str,
    pub value_mpa: f64,
    pub bound_mpa: f64,
    pub is_upper: bool,
}

impl fmt::Display for Beyond {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (side, bound) = if self.is_upper {
            ("above", "upper")
        } else {
            ("below", "lower")
        };
        write!(
            formatter,
            "{} of the cell, {} MPa, lies {side} the {bound} Hashin-Shtrikman bound of {} MPa by \
             more than its error: use more pixels",
            self.modulus, self.value_mpa, self.bound_mpa
        )
    }
}

/// Moduli of a cell that lie beyond Hashin-Shtrikman bounds by more than their errors [MPa].
///
/// A cell has directions of its own, and the bounds have none. Of its stiffness the mean over all
/// turns about 1 is no composite's modulus but no lower than one's, that of its compliance no higher;
/// these are held against the lower and the upper bound. Empty where there are no bounds.
///
/// # Errors
/// As [`companions`].
pub fn beyond(
    effective: &Effective,
    errors: Option<&Constants>,
    fibre: &Material,
    matrix: &Material,
) -> Result<Vec<Beyond>, CompositeError> {
    let (fibre, _) = fibre.stiffness_of_space()?;
    let (matrix, _) = matrix.stiffness_of_space()?;
    let [Some(matrix), Some(fibre)] = [Transverse::of(&matrix)?, Transverse::of(&fibre)?] else {
        return Ok(Vec::new());
    };
    let shares = [1.0 - effective.fraction, effective.fraction];
    let lower = moduli([matrix, fibre], shares, f64::min);
    let upper = moduli([matrix, fibre], shares, f64::max);
    let c = effective.matrix();
    // of plane strain: no strain along the fibres
    let plane = c.fixed_view::<3, 3>(1, 1).into_owned();
    let s = crate::stiffness::compliance(&plane);
    let of_stiffness = [
        0.25 * (c[(1, 1)] + c[(2, 2)] + 2.0 * c[(1, 2)]),
        0.125 * (c[(1, 1)] + c[(2, 2)] - 2.0 * c[(1, 2)]) + 0.5 * c[(3, 3)],
        0.5 * (c[(4, 4)] + c[(5, 5)]),
    ];
    let shears = crate::stiffness::compliance(&nalgebra::Matrix3::new(
        c[(4, 4)],
        c[(4, 5)],
        0.0,
        c[(5, 4)],
        c[(5, 5)],
        0.0,
        0.0,
        0.0,
        1.0,
    ));
    let of_compliance = [
        1.0 / (s[(0, 0)] + s[(1, 1)] + 2.0 * s[(0, 1)]),
        1.0 / (0.5 * (s[(0, 0)] + s[(1, 1)] - 2.0 * s[(0, 1)]) + 0.5 * s[(2, 2)]),
        2.0 / (shears[(0, 0)] + shears[(1, 1)]),
    ];
    let relative = errors.map_or([0.0; 3], |errors| {
        let of = effective.constants;
        let across = (errors.e2_mpa / of.e2_mpa).max(errors.e3_mpa / of.e3_mpa);
        let shear = (errors.g12_mpa / of.g12_mpa).max(errors.g13_mpa / of.g13_mpa);
        let plane = across.max(errors.g23_mpa / of.g23_mpa);
        [plane, plane, shear]
    });
    let mut found = Vec::new();
    for (place, modulus) in ["k₂₃", "G₂₃", "G₁₂"].into_iter().enumerate() {
        let slack = ALIKE + relative[place];
        if of_stiffness[place] < lower[place] * (1.0 - slack) {
            found.push(Beyond {
                modulus,
                value_mpa: of_stiffness[place],
                bound_mpa: lower[place],
                is_upper: false,
            });
        }
        if of_compliance[place] > upper[place] * (1.0 + slack) {
            found.push(Beyond {
                modulus,
                value_mpa: of_compliance[place],
                bound_mpa: upper[place],
                is_upper: true,
            });
        }
    }
    Ok(found)
}
