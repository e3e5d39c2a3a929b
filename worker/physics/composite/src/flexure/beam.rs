//! The beam a section of plies is, by classical laminate theory and Timoshenko's shear.
use crate::error::CompositeError;
use crate::section::{Section, faces_mm};
use crate::stiffness::compliance;

/// Stiffnesses of a layered beam over its whole width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// EA: force over the strain of the neutral axis [N].
    pub axial_n: f64,
    /// EI: moment over curvature about the neutral axis [N mm²]; width times D₁₁ of a laminate that
    /// is symmetric, seen in the plane.
    pub bending_n_mm2: f64,
    /// kGA: shear force over the mean shear angle that stores its energy [N].
    pub shear_n: f64,
    /// Height of the neutral axis above the bottom face [mm].
    pub neutral_mm: f64,
}

/// A layer between two heights [mm]: E along it and G [MPa].
#[derive(Debug, Clone, Copy)]
struct Layer {
    between: [f64; 2],
    modulus: f64,
    shear: f64,
}

/// Coupling of stretch and shear below this is round-off.
const COUPLED: f64 = 1e-9;

/// Gauss's points and weights on -1..1, exact to degree five: shear flow squared is of degree four.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

impl Beam {
    /// The beam a section is; `None` where it has fibres of its own, or a layer that couples
    /// stretch with shear, which this theory does not know.
    ///
    /// Layers carry σ_xx = E_x ε_xx alone, E_x = 1/S₁₁ and G_xy = 1/S₆₆ of the plane compliance. A
    /// shear force V flows as τ b = V q(y) / EI, q(y) = -b ∫ E_x (y' - y₀) dy' from the bottom face,
    /// and stores V² / (2 kGA) = ½ ∫ τ² b / G dy, so that
    ///
    /// 1 / kGA = ∫ q² / (G b) dy / EI²
    ///
    /// which is k = 5/6 for one material. Source: [Timoshenko1921] with the shear correction of
    /// [Whitney1973].
    ///
    /// # Errors
    /// What is wrong with the section's plies or materials.
    pub fn of(section: &Section) -> Result<Option<Self>, CompositeError> {
        if !section.fibres.is_empty() {
            return Ok(None);
        }
        let stack = section.stack()?;
        let faces = faces_mm(&stack, section.height_mm);
        let mut layers = Vec::with_capacity(stack.len());
        for (ply, pair) in stack.iter().zip(faces.windows(2)) {
            let s = compliance(&section.ply_stiffness(ply, section.state)?.0);
            if s[(0, 2)].abs() > COUPLED * (s[(0, 0)] * s[(2, 2)]).sqrt() {
                return Ok(None);
            }
            layers.push(Layer {
                between: [pair[0], pair[1]],
                modulus: 1.0 / s[(0, 0)],
                shear: 1.0 / s[(2, 2)],
            });
        }
        Ok(Some(Self::of_layers(&layers, section.thickness_mm)))
    }

    fn of_layers(layers: &[Layer], width: f64) -> Self {
        let (mut axial, mut moment) = (0.0, 0.0);
        for Layer {
            between: [a, b],
            modulus,
            ..
        } in layers
        {
            axial += modulus * (b - a);
            moment += modulus * 0.5 * (b * b - a * a);
        }
        let neutral = moment / axial;
        let bending: f64 = layers
            .iter()
            .map(|layer| {
                let [a, b] = layer.between.map(|y| y - neutral);
                layer.modulus * (b.powi(3) - a.powi(3)) / 3.0
            })
            .sum();
        // Per width: q / b and the integral of its square over G.
        let mut below = 0.0;
        let mut flexible = 0.0;
        for layer in layers {
            let [a, b] = layer.between.map(|y| y - neutral);
            let flow = |y: f64| below - layer.modulus * 0.5 * (y * y - a * a);
            let half = 0.5 * (b - a);
            for (place, weight) in GAUSS {
                let q = flow(0.5 * (a + b) + half * place);
                flexible += weight * half * q * q / layer.shear;
            }
            below = flow(b);
        }
        Self {
            axial_n: axial * width,
            bending_n_mm2: bending * width,
            shear_n: bending * bending / flexible * width,
            neutral_mm: neutral,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(between: [f64; 2], modulus: f64, shear: f64) -> Layer {
        Layer {
            between,
            modulus,
            shear,
        }
    }

    #[test]
    fn one_material_has_five_sixths_of_its_shear_stiffness() {
        let (e, g, h, b) = (1_000.0, 380.0, 3.0, 2.0);
        // Cut into layers it stays the same.
        for cuts in [vec![0.0, h], vec![0.0, 0.4, 1.9, h]] {
            let layers: Vec<Layer> = cuts
                .windows(2)
                .map(|pair| layer([pair[0], pair[1]], e, g))
                .collect();
            let beam = Beam::of_layers(&layers, b);
            assert!((beam.bending_n_mm2 / (e * b * h.powi(3) / 12.0) - 1.0).abs() < 1e-14);
            assert!((beam.shear_n / (5.0 / 6.0 * g * b * h) - 1.0).abs() < 1e-14);
            assert!((beam.axial_n / (e * b * h) - 1.0).abs() < 1e-14);
            assert!((beam.neutral_mm - 1.5).abs() < 1e-14);
        }
    }

    #[test]
    fn a_sandwich_shears_in_its_core() {
        // Thin stiff faces: EI ≈ E_f t d²/2, kGA ≈ G_c d²/c with d between the faces' middles.
        let (face, core, t, c) = (70_000.0, 1.0, 0.01, 10.0);
        let layers = [
            layer([0.0, t], face, face / 2.6),
            layer([t, t + c], core, 30.0),
            layer([t + c, 2.0 * t + c], face, face / 2.6),
        ];
        let beam = Beam::of_layers(&layers, 1.0);
        let d = c + t;
        let bending = face * t * d * d / 2.0 + face * t.powi(3) / 6.0 + core * c.powi(3) / 12.0;
        assert!((beam.bending_n_mm2 / bending - 1.0).abs() < 1e-12);
        // Off by the faces' own shear, of the order of t/c, and the core's modulus.
        assert!((beam.shear_n / (30.0 * d * d / c) - 1.0).abs() < 5e-3);
    }

    #[test]
    fn two_layers_bend_about_the_stiffer_one() {
        // E = 3 below and 1 above, each 1 high: y₀ = (3·0.5 + 1·1.5)/4 = 0.75,
        // EI = 3 (1/12 + 0.25²) + (1/12 + 0.75²) = 1.0833..
        let beam = Beam::of_layers(
            &[layer([0.0, 1.0], 3.0, 1.0), layer([1.0, 2.0], 1.0, 1.0)],
            1.0,
        );
        assert!((beam.neutral_mm - 0.75).abs() < 1e-15);
        let bending = 3.0 * (1.0 / 12.0 + 0.0625) + 1.0 / 12.0 + 0.5625;
        assert!((beam.bending_n_mm2 - bending).abs() < 1e-14);
    }
}
