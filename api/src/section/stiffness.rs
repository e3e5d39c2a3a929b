//! Plane stiffness: three strains to three stresses, turned and averaged.
//!
//! Strains are (ε_xx, ε_yy, γ_xy) with γ = 2 ε_xy, stresses (σ_xx, σ_yy, σ_xy) [MPa]. A stiffness C is
//! a full symmetric 3 × 3 matrix: off-axis fibres couple stretch with shear.
use nalgebra::{Matrix2, Matrix3, RowVector2, Vector2};

/// What is known of the third direction, out of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneState {
    /// A thin sheet: no stress out of the plane.
    Stress,
    /// A long body: no strain out of the plane.
    Strain,
}

/// Plane stiffness C [MPa].
pub type Stiffness = Matrix3<f64>;

/// Cosine and sine of an angle in degrees, exact for multiples of 90°: a fibre along an axis must
/// not pick up a coupling of 1e-17.
#[must_use]
pub fn direction(angle_deg: f64) -> [f64; 2] {
    let turned = angle_deg.rem_euclid(360.0);
    let quarters = turned / 90.0;
    if (quarters - quarters.round()).abs() < f64::EPSILON {
        match quarters.round() as u8 % 4 {
            0 => [1.0, 0.0],
            1 => [0.0, 1.0],
            2 => [-1.0, 0.0],
            _ => [0.0, -1.0],
        }
    } else {
        let (sine, cosine) = turned.to_radians().sin_cos();
        [cosine, sine]
    }
}

/// The stiffness in the global frame of a material whose axis 1 lies at `angle_deg` to x.
///
/// C = Tᵀ C' T with the strains of the material's frame ε' = T ε,
/// T = [c², s², cs; s², c², -cs; -2cs, 2cs, c² - s²].
#[must_use]
pub fn turned(stiffness: &Stiffness, angle_deg: f64) -> Stiffness {
    turned_to(stiffness, direction(angle_deg))
}

/// As [`turned`], by cosine and sine.
pub fn turned_to(stiffness: &Stiffness, [c, s]: [f64; 2]) -> Stiffness {
    let strains = Matrix3::new(
        c * c,
        s * s,
        c * s,
        s * s,
        c * c,
        -c * s,
        -2.0 * c * s,
        2.0 * c * s,
        c * c - s * s,
    );
    symmetric(&(strains.transpose() * stiffness * strains))
}

/// Takes away the last bits by which round-off spoils the symmetry.
fn symmetric(matrix: &Stiffness) -> Stiffness {
    (matrix + matrix.transpose()) * 0.5
}

/// The stiffness of layers that lie along `angle_deg`, given with their fractions of the area.
///
/// Exact for any number of layers of any anisotropy under uniform far strain: all layers share the
/// strain along them and the two stresses across them. With the indices t (along) and n (across and
/// shear), ⟨·⟩ the mean by fractions:
///
/// C_nn = ⟨C_nn⁻¹⟩⁻¹, C_tn = ⟨C_tn C_nn⁻¹⟩ C_nn,
/// C_tt = ⟨C_tt - C_tn C_nn⁻¹ C_nt⟩ + ⟨C_tn C_nn⁻¹⟩ C_nn ⟨C_nn⁻¹ C_nt⟩.
#[must_use]
pub fn laminate(layers: &[(f64, Stiffness)], angle_deg: f64) -> Stiffness {
    if let [(_, only)] = layers {
        return *only;
    }
    let [c, s] = direction(angle_deg);
    let mut along = 0.0;
    let mut transfer = RowVector2::zeros();
    let mut compliance = Matrix2::zeros();
    let mut total = 0.0;
    for (fraction, stiffness) in layers {
        // Turned back into the frame of the layers.
        let local = turned_to(stiffness, [c, -s]);
        let across = Matrix2::new(local[(1, 1)], local[(1, 2)], local[(2, 1)], local[(2, 2)]);
        let coupling = RowVector2::new(local[(0, 1)], local[(0, 2)]);
        let inverse = inverted(&across);
        along += fraction * (local[(0, 0)] - (coupling * inverse).dot(&coupling));
        transfer += *fraction * (coupling * inverse);
        compliance += inverse * *fraction;
        total += fraction;
    }
    let across = inverted(&(compliance / total));
    let transfer = transfer / total;
    let coupling: RowVector2<f64> = transfer * across;
    let along = along / total + coupling.dot(&transfer);
    let coupled: Vector2<f64> = coupling.transpose();
    turned_to(
        &Matrix3::new(
            along,
            coupled[0],
            coupled[1],
            coupled[0],
            across[(0, 0)],
            across[(0, 1)],
            coupled[1],
            across[(1, 0)],
            across[(1, 1)],
        ),
        [c, s],
    )
}

fn inverted(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    let determinant = matrix[(0, 0)] * matrix[(1, 1)] - matrix[(0, 1)] * matrix[(1, 0)];
    Matrix2::new(
        matrix[(1, 1)],
        -matrix[(0, 1)],
        -matrix[(1, 0)],
        matrix[(0, 0)],
    ) / determinant
}

/// The compliance S = C⁻¹ [1/MPa], by cofactors.
#[must_use]
pub fn compliance(stiffness: &Stiffness) -> Stiffness {
    let m = stiffness;
    let cofactor = |a: usize, b: usize, c: usize, d: usize| m[(a, b)] * m[(c, d)];
    let c00 = cofactor(1, 1, 2, 2) - cofactor(1, 2, 1, 2);
    let c01 = cofactor(0, 2, 1, 2) - cofactor(0, 1, 2, 2);
    let c02 = cofactor(0, 1, 1, 2) - cofactor(0, 2, 1, 1);
    let c11 = cofactor(0, 0, 2, 2) - cofactor(0, 2, 0, 2);
    let c12 = cofactor(0, 1, 0, 2) - cofactor(0, 0, 1, 2);
    let c22 = cofactor(0, 0, 1, 1) - cofactor(0, 1, 0, 1);
    let determinant = m[(0, 0)] * c00 + m[(0, 1)] * c01 + m[(0, 2)] * c02;
    Matrix3::new(c00, c01, c02, c01, c11, c12, c02, c12, c22) / determinant
}

#[cfg(test)]
mod tests {
    use super::*;

    fn isotropic(e: f64, nu: f64) -> Stiffness {
        let d = e / (1.0 - nu * nu);
        Matrix3::new(
            d,
            d * nu,
            0.0,
            d * nu,
            d,
            0.0,
            0.0,
            0.0,
            d * (1.0 - nu) / 2.0,
        )
    }

    fn orthotropic() -> Stiffness {
        let (e1, e2, nu, g): (f64, f64, f64, f64) = (11_500.0, 6_430.0, 0.28, 3_555.2);
        let d = 1.0 - nu * nu * e2 / e1;
        Matrix3::new(
            e1 / d,
            nu * e2 / d,
            0.0,
            nu * e2 / d,
            e2 / d,
            0.0,
            0.0,
            0.0,
            g,
        )
    }

    #[test]
    fn an_isotropic_stiffness_does_not_change_when_turned() {
        let stiffness = isotropic(85.0, 0.3);
        for step in 0..24 {
            let difference = turned(&stiffness, f64::from(step) * 15.0) - stiffness;
            assert!(difference.amax() < 1e-13 * 85.0);
        }
    }

    #[test]
    fn quarter_turns_swap_the_axes_exactly() {
        let quarter = turned(&orthotropic(), 90.0);
        let c = orthotropic();
        let expected = Matrix3::new(
            c[(1, 1)],
            c[(0, 1)],
            0.0,
            c[(0, 1)],
            c[(0, 0)],
            0.0,
            0.0,
            0.0,
            c[(2, 2)],
        );
        assert_eq!(quarter, expected);
        assert_eq!(turned(&c, 180.0), c);
        assert_eq!(turned(&c, -90.0), expected);
    }

    #[test]
    fn turning_there_and_back_gives_the_same() {
        let there = turned(&orthotropic(), 37.0);
        assert!((turned(&there, -37.0) - orthotropic()).amax() < 1e-10);
        assert!(there[(0, 2)].abs() > 100.0, "off-axis fibres couple");
    }

    #[test]
    fn the_laminate_is_the_formula_of_layers_in_series_and_in_parallel() {
        let (fibre, matrix, f) = (orthotropic(), isotropic(85.0, 0.3), 0.1);
        let mean = laminate(&[(f, fibre), (1.0 - f, matrix)], 0.0);
        let c22 = 1.0 / (f / fibre[(1, 1)] + (1.0 - f) / matrix[(1, 1)]);
        let c66 = 1.0 / (f / fibre[(2, 2)] + (1.0 - f) / matrix[(2, 2)]);
        let r = f * fibre[(0, 1)] / fibre[(1, 1)] + (1.0 - f) * matrix[(0, 1)] / matrix[(1, 1)];
        let c12 = c22 * r;
        let alone = |c: &Stiffness| c[(0, 0)] - c[(0, 1)] * c[(0, 1)] / c[(1, 1)];
        let c11 = f * alone(&fibre) + (1.0 - f) * alone(&matrix) + c22 * r * r;
        let expected = Matrix3::new(c11, c12, 0.0, c12, c22, 0.0, 0.0, 0.0, c66);
        assert!((mean - expected).amax() < 1e-12 * c11);
        // Layers at an angle are the same laminate, turned.
        let angle = 30.0;
        let at_an_angle = laminate(
            &[
                (f, turned(&fibre, angle)),
                (1.0 - f, turned(&matrix, angle)),
            ],
            angle,
        );
        assert!((at_an_angle - turned(&expected, angle)).amax() < 1e-11 * c11);
    }

    #[test]
    fn layers_of_one_material_are_that_material() {
        let material = turned(&orthotropic(), 20.0);
        let mean = laminate(&[(0.3, material), (0.7, material)], 65.0);
        assert!((mean - material).amax() < 1e-11 * material.amax());
    }

    #[test]
    fn layers_of_layers_are_the_layers_at_once() {
        let (a, b, c) = (
            turned(&orthotropic(), 20.0),
            isotropic(85.0, 0.3),
            orthotropic(),
        );
        let at_once = laminate(&[(0.2, a), (0.3, b), (0.5, c)], 10.0);
        let inner = laminate(&[(0.4, a), (0.6, b)], 10.0);
        let nested = laminate(&[(0.5, inner), (0.5, c)], 10.0);
        assert!((at_once - nested).amax() < 1e-11 * at_once.amax());
    }

    #[test]
    fn compliance_is_the_inverse() {
        let stiffness = turned(&orthotropic(), 25.0);
        let unit = stiffness * compliance(&stiffness);
        assert!((unit - Matrix3::identity()).amax() < 1e-12);
    }
}
