//! The two problems of a pixel: in the plane of 2 and 3, and along the fibres.
//!
//! Displacements that are the same all along 1 fall into two problems that do not touch each other
//! as long as 1 is an axis of symmetry of all materials. Each has two unknowns at every node:
//!
//! - [`PlaneCells`]: u₂ and u₃, driven by ε₂₂, ε₃₃, γ₂₃ and ε₁₁ (generalised plane strain);
//! - [`ShearCells`]: u₁ of two load cases side by side, driven by γ₁₂ and γ₁₃.
//!
//! A pixel is one four-node cell: its mean strain carries the stiffness, and its hourglass motion
//! q = Σ h u, h = (1, -1, 1, -1), which no uniform strain knows, a stiffness of its own. Per volume
//! of the pixel, of sides a along 2 and b along 3:
//!
//! κ₂ = 1/(12 a² S₂₂), κ₃ = 1/(12 b² S₃₃), S the inverse of the plane's stiffness   (1)
//! κ₁ = C₁₂₁₂/(12 a²) + C₁₃₁₃/(12 b²)                                              (2)
//!
//! (1) is the rectangle of [PianSumihara1984] as in [`lattice`](crate::lattice), (2) the bilinear
//! element. Without them the cell is the rotated scheme of [Willot2015], whose checkerboards nothing
//! holds on grids of an even number of pixels.
use nalgebra::Matrix3;

use super::phase::Space;
use crate::stiffness::compliance;

/// Derivatives along 2, along 3, and the hourglass sum, of both unknowns.
pub(super) type Rates = [[f64; 2]; 3];

/// How the pixels answer to displacements.
pub(super) trait Cells {
    /// Derivatives of a pixel's energy per volume by its rates.
    fn answer(&self, kind: u32, rates: Rates) -> Rates;

    /// The symmetric matrix [p, q, r] over the two unknowns that a uniform body of `kind` has at a
    /// wave with |∂₂|², |∂₃|², the real ∂₂* ∂₃ and the |hourglass|² of these.
    fn symbol(&self, kind: u32, wave: [f64; 4]) -> [f64; 3];
}

/// (1) or (2) with pixels of these sides [mm].
const TWELVE: f64 = 12.0;

/// In-plane stiffnesses of every kind of pixel.
#[derive(Debug, Clone)]
pub(super) struct PlaneCells(Vec<PlaneCell>);

#[derive(Debug, Clone, Copy)]
struct PlaneCell {
    /// 22-22, 22-33, 22-23, 33-33, 33-23, 23-23 [MPa].
    stiffness: [f64; 6],
    /// κ₂ and κ₃ [MPa/mm²].
    hourglass: [f64; 2],
}

impl PlaneCells {
    pub(super) fn new(kinds: &[Space], sides_mm: [f64; 2], shares: impl Fn(usize) -> f64) -> Self {
        Self(
            kinds
                .iter()
                .enumerate()
                .map(|(kind, stiffness)| PlaneCell::new(stiffness, sides_mm, shares(kind)))
                .collect(),
        )
    }
}

impl PlaneCell {
    fn new(space: &Space, [a, b]: [f64; 2], share: f64) -> Self {
        let plane = Matrix3::from_fn(|i, j| space[(i + 1, j + 1)]);
        let compliant = compliance(&plane);
        Self {
            stiffness: [
                plane[(0, 0)],
                plane[(0, 1)],
                plane[(0, 2)],
                plane[(1, 1)],
                plane[(1, 2)],
                plane[(2, 2)],
            ],
            hourglass: [
                share / (TWELVE * a * a * compliant[(0, 0)]),
                share / (TWELVE * b * b * compliant[(1, 1)]),
            ],
        }
    }
}

impl Cells for PlaneCells {
    fn answer(&self, kind: u32, [along_2, along_3, hourglass]: Rates) -> Rates {
        let PlaneCell {
            stiffness: [c22, c23, c24, c33, c34, c44],
            hourglass: [k2, k3],
        } = self.0[kind as usize];
        let (e2, e3, e4) = (along_2[0], along_3[1], along_2[1] + along_3[0]);
        let s2 = c22 * e2 + c23 * e3 + c24 * e4;
        let s3 = c23 * e2 + c33 * e3 + c34 * e4;
        let s4 = c24 * e2 + c34 * e3 + c44 * e4;
        [[s2, s4], [s4, s3], [k2 * hourglass[0], k3 * hourglass[1]]]
    }

    fn symbol(&self, kind: u32, [d22, d33, d23, h]: [f64; 4]) -> [f64; 3] {
        let cell = &self.0[kind as usize];
        let [c22, c23, c24, c33, c34, c44] = cell.stiffness;
        [
            c22 * d22 + c44 * d33 + 2.0 * c24 * d23 + cell.hourglass[0] * h,
            (c23 + c44) * d23 + c24 * d22 + c34 * d33,
            c33 * d33 + c44 * d22 + 2.0 * c34 * d23 + cell.hourglass[1] * h,
        ]
    }
}

/// Stiffnesses along the fibres of every kind of pixel.
#[derive(Debug, Clone)]
pub(super) struct ShearCells(Vec<ShearCell>);

#[derive(Debug, Clone, Copy)]
struct ShearCell {
    /// 12-12, 12-13, 13-13 [MPa].
    stiffness: [f64; 3],
    /// κ₁ [MPa/mm²].
    hourglass: f64,
}

impl ShearCells {
    pub(super) fn new(kinds: &[Space], [a, b]: [f64; 2], shares: impl Fn(usize) -> f64) -> Self {
        let cell = |(kind, space): (usize, &Space)| {
            let stiffness = [space[(5, 5)], space[(5, 4)], space[(4, 4)]];
            ShearCell {
                stiffness,
                hourglass: shares(kind) / TWELVE
                    * (stiffness[0] / (a * a) + stiffness[2] / (b * b)),
            }
        };
        Self(kinds.iter().enumerate().map(cell).collect())
    }
}

impl Cells for ShearCells {
    fn answer(&self, kind: u32, [along_2, along_3, hourglass]: Rates) -> Rates {
        let ShearCell {
            stiffness: [c22, c23, c33],
            hourglass: k,
        } = self.0[kind as usize];
        let stress = |case: usize| {
            [
                c22 * along_2[case] + c23 * along_3[case],
                c23 * along_2[case] + c33 * along_3[case],
            ]
        };
        let (first, second) = (stress(0), stress(1));
        [
            [first[0], second[0]],
            [first[1], second[1]],
            [k * hourglass[0], k * hourglass[1]],
        ]
    }

    fn symbol(&self, kind: u32, [d22, d33, d23, h]: [f64; 4]) -> [f64; 3] {
        let ShearCell {
            stiffness: [c22, c23, c33],
            hourglass: k,
        } = self.0[kind as usize];
        let own = c22 * d22 + 2.0 * c23 * d23 + c33 * d33 + k * h;
        [own, 0.0, own]
    }
}
