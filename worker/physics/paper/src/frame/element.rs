//! What joins two nodes: a beam, a bar or a bond, as six springs.
//!
//! Every element is a sum of six springs, each of which feels one combination of the motions of its two
//! nodes: with deformations d = Bᵀu and stiffnesses c its forces are B q, q = c d, its matrix is
//! Σ cₖ bₖ bₖᵀ, and its energy ½ Σ cₖ dₖ². What breaks is taken from a matrix by these six columns.
//!
//! With u the displacement, θ the rotation, Δ the second node less the first and e₁, e₂, e₃ the axes:
//!
//! | k | spring (bar, bond) | beam |
//! |---|---|---|
//! | 0 | e₁·Δu | e₁·Δu, stiffness E A/l |
//! | 1 | e₂·Δu | e₂·(θ₁ + θ₂) + 2 e₃·Δu/l, stiffness 3 E I/(l (1 + Φ)) |
//! | 2 | e₃·Δu | e₃·(θ₁ + θ₂) - 2 e₂·Δu/l, the same |
//! | 3 | e₁·Δθ | e₁·Δθ, stiffness G J/l |
//! | 4 | e₂·Δθ | e₂·Δθ, stiffness E I/l |
//! | 5 | e₃·Δθ | e₃·Δθ, the same |
//!
//! with Φ = 12 E I/(κ G A l²). The beam's are the modes of Timoshenko's element whose bending is uniform
//! (4, 5) and changes sign (1, 2): its matrix is the exact one of [Przemieniecki1968], chapter 5,
//! and a straight beam under forces at its nodes has no discretisation error.
use nalgebra::{Matrix3, Vector3};

use super::input::{BeamSection, FrameBond, Level};

/// Springs of an element.
pub(crate) const PARTS: usize = 6;

/// Motions or forces of two nodes: displacement and rotation of the first, then of the second.
pub(crate) type Ends = [Vector3<f64>; 4];

/// Transverse stiffness of a bar over its axial one: that of a string which is taut by this strain, unless a network
/// is told another. It keeps what a truss leaves loose in place; its share of the energy is measured. Forces of a truss
/// that is stiff by itself change by this share of a bar's stiffness over the truss's: a few 1e-8.
pub(crate) const TAUT: f64 = 1e-9;

/// Two nodes and the springs between them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Element {
    pub(crate) nodes: [u32; 2],
    /// Axes e₁, e₂, e₃ as rows.
    pub(crate) axes: Matrix3<f64>,
    /// 2/l of a beam, none for springs.
    bending: Option<f64>,
    /// cₖ [mN/µm or mN µm].
    pub(crate) stiffness: [f64; PARTS],
}

impl Element {
    /// A segment of a fibre from one node to the other, `along` [µm].
    pub(crate) fn segment(
        nodes: [u32; 2],
        along: Vector3<f64>,
        section: &BeamSection,
        level: Level,
    ) -> Self {
        let length = along.norm();
        let axial = section.youngs_modulus_gpa * section.area_um2 / length;
        let (bending, stiffness) = match level {
            Level::Truss => (None, [axial, TAUT * axial, TAUT * axial, 0.0, 0.0, 0.0]),
            Level::Beam | Level::Tube => {
                let bending = section.youngs_modulus_gpa * section.inertia_um4 / length;
                let shear =
                    section.shear_coefficient * section.shear_modulus_gpa * section.area_um2;
                let changing = 3.0 * bending / (1.0 + 12.0 * bending / (shear * length));
                let torsion = section.shear_modulus_gpa * section.polar_um4 / length;
                let stiffness = [axial, changing, changing, torsion, bending, bending];
                (Some(2.0 / length), stiffness)
            }
        };
        Self {
            nodes,
            axes: axes_along(along),
            bending,
            stiffness,
        }
    }

    /// The same bar, taut by this strain.
    pub(crate) fn taut(self, strain: f64) -> Self {
        let [axial, _, _, ..] = self.stiffness;
        Self {
            stiffness: [axial, strain * axial, strain * axial, 0.0, 0.0, 0.0],
            ..self
        }
    }

    /// A bond whose face is across `normal`.
    pub(crate) fn bond(
        nodes: [u32; 2],
        normal: Vector3<f64>,
        bond: &FrameBond,
        level: Level,
    ) -> Self {
        let force = bond.stiffness_mn_per_um3 * bond.area_um2;
        let moment = match level {
            Level::Beam | Level::Tube => force * bond.area_um2 / 12.0,
            Level::Truss => 0.0,
        };
        Self {
            nodes,
            axes: axes_along(normal),
            bending: None,
            stiffness: [force, force, force, moment, moment, moment],
        }
    }

    /// Φ of a beam; none for springs.
    pub(crate) fn shear_number(&self) -> Option<f64> {
        self.bending
            .map(|_| 3.0 * self.stiffness[4] / self.stiffness[1] - 1.0)
    }

    /// d = Bᵀu.
    pub(crate) fn deformation(&self, motion: &Ends) -> [f64; PARTS] {
        let shift = self.axes * (motion[2] - motion[0]);
        let turn = self.axes * (motion[3] - motion[1]);
        let (second, third) = match self.bending {
            None => (shift.y, shift.z),
            Some(bending) => {
                let sum = self.axes * (motion[1] + motion[3]);
                (sum.y + bending * shift.z, sum.z - bending * shift.y)
            }
        };
        [shift.x, second, third, turn.x, turn.y, turn.z]
    }

    /// B q: the forces and moments on the nodes that keep the element so deformed.
    pub(crate) fn forces(&self, q: &[f64; PARTS]) -> Ends {
        let mut shift = Vector3::new(q[0], q[1], q[2]);
        let mut sum = Vector3::zeros();
        if let Some(bending) = self.bending {
            shift = Vector3::new(q[0], -bending * q[2], bending * q[1]);
            sum = self.axes.tr_mul(&Vector3::new(0.0, q[1], q[2]));
        }
        let force = self.axes.tr_mul(&shift);
        let turn = self.axes.tr_mul(&Vector3::new(q[3], q[4], q[5]));
        [-force, sum - turn, force, sum + turn]
    }

    /// q = c d.
    pub(crate) fn loads(&self, deformation: &[f64; PARTS]) -> [f64; PARTS] {
        std::array::from_fn(|part| self.stiffness[part] * deformation[part])
    }

    /// ½ Σ c d² [nJ].
    pub(crate) fn energy(&self, deformation: &[f64; PARTS]) -> f64 {
        let twice: f64 = self
            .stiffness
            .iter()
            .zip(deformation)
            .map(|(c, d)| c * d * d)
            .sum();
        0.5 * twice
    }

    /// Column bₖ.
    pub(crate) fn part(&self, part: usize) -> Ends {
        let mut unit = [0.0; PARTS];
        unit[part] = 1.0;
        self.forces(&unit)
    }

    /// Σ cₖ bₖ bₖᵀ, rows and columns as in [`Ends`].
    pub(crate) fn matrix(&self) -> Matrix12 {
        let mut matrix = [[0.0; 12]; 12];
        for part in 0..PARTS {
            let stiffness = self.stiffness[part];
            if stiffness > 0.0 {
                let column = flat(&self.part(part));
                for (row, of_row) in matrix.iter_mut().zip(column) {
                    for (value, of_column) in row.iter_mut().zip(column) {
                        *value += stiffness * of_row * of_column;
                    }
                }
            }
        }
        matrix
    }
}

/// A matrix over the motions of two nodes.
pub(crate) type Matrix12 = [[f64; 12]; 12];

/// The twelve numbers in order.
pub(crate) fn flat(ends: &Ends) -> [f64; 12] {
    std::array::from_fn(|place| ends[place / 3][place % 3])
}

/// Three axes at right angles, the first along `along`. The two others may be anyhow, as sections are
/// the same about all axes.
pub(crate) fn axes_along(along: Vector3<f64>) -> Matrix3<f64> {
    let first = along.normalize();
    let least = first.iamin();
    let mut other = Vector3::zeros();
    other[least] = 1.0;
    let second = first.cross(&other).normalize();
    let third = first.cross(&second);
    Matrix3::from_rows(&[first.transpose(), second.transpose(), third.transpose()])
}

/// Normal and bending stress of a segment.
pub(crate) fn stress_gpa(section: &BeamSection, level: Level, q: &[f64; PARTS]) -> f64 {
    let axial = q[0] / section.area_um2;
    match level {
        Level::Truss => axial,
        // the moment at either end is that of uniform bending, with and without the other
        Level::Beam | Level::Tube => {
            let ends = [
                (q[4] - q[1]).hypot(q[5] - q[2]),
                (q[4] + q[1]).hypot(q[5] + q[2]),
            ];
            let moment = ends[0].max(ends[1]);
            axial + moment * 0.5 * section.width_um / section.inertia_um4
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::tube;

    fn beam(length: f64) -> Element {
        Element::segment([0, 1], Vector3::x() * length, &tube(), Level::Beam)
    }

    #[test]
    fn the_matrix_is_timoshenkos() {
        let section = tube();
        let length = 70.0;
        let (e, g) = (section.youngs_modulus_gpa, section.shear_modulus_gpa);
        let flexural = e * section.inertia_um4;
        let phi =
            12.0 * flexural / (section.shear_coefficient * g * section.area_um2 * length * length);
        let matrix = beam(length).matrix();
        let expected = |row: usize, column: usize, value: f64| {
            let found = matrix[row][column];
            assert!(
                (found - value).abs() <= 1e-12 * value.abs(),
                "{row} {column}: {found} {value}"
            );
        };
        // rows: u v w θx θy θz of the first node, then of the second
        let shear = 12.0 * flexural / (length.powi(3) * (1.0 + phi));
        let cross = 6.0 * flexural / (length.powi(2) * (1.0 + phi));
        expected(0, 0, e * section.area_um2 / length);
        expected(0, 6, -e * section.area_um2 / length);
        expected(1, 1, shear);
        expected(2, 8, -shear);
        expected(1, 5, cross);
        expected(7, 11, -cross);
        expected(2, 4, -cross);
        expected(2, 10, -cross);
        expected(3, 9, -g * section.polar_um4 / length);
        expected(4, 4, (4.0 + phi) * flexural / (length * (1.0 + phi)));
        expected(5, 11, (2.0 - phi) * flexural / (length * (1.0 + phi)));
    }

    #[test]
    fn forces_are_the_transpose_of_deformations() {
        let along = Vector3::new(3.0, -4.0, 12.0);
        let motion: Ends =
            std::array::from_fn(|i| Vector3::new(0.3 + i as f64, -1.1 * i as f64, 0.7));
        let q = [0.2, -1.0, 0.4, 2.0, -0.6, 1.5];
        for level in [Level::Beam, Level::Truss] {
            let element = Element::segment([0, 1], along, &tube(), level);
            let work: f64 = element
                .deformation(&motion)
                .iter()
                .zip(q)
                .map(|(d, q)| d * q)
                .sum();
            let other: f64 = element
                .forces(&q)
                .iter()
                .zip(motion)
                .map(|(f, u)| f.dot(&u))
                .sum();
            assert!((work - other).abs() < 1e-12 * work.abs(), "{work} {other}");
        }
    }

    #[test]
    fn a_rigid_motion_deforms_no_beam() {
        let along = Vector3::new(3.0, -4.0, 12.0);
        let turn = Vector3::new(0.1, 0.5, -0.2);
        let shift = Vector3::new(5.0, 6.0, 7.0);
        let element = Element::segment([0, 1], along, &tube(), Level::Beam);
        let motion = [shift, turn, shift + turn.cross(&along), turn];
        for d in element.deformation(&motion) {
            assert!(d.abs() < 1e-14, "{d}");
        }
    }

    #[test]
    fn stress_is_that_of_force_and_moment_at_the_worse_end() {
        let section = tube();
        // a cantilever: the moment falls from 12 at the first node to 0 at the second
        let q = [3.0, -6.0, 0.0, 0.0, 6.0, 0.0];
        let bending = 12.0 * 0.5 * section.width_um / section.inertia_um4;
        let stress = stress_gpa(&section, Level::Beam, &q);
        assert!((stress - (3.0 / section.area_um2 + bending)).abs() < 1e-15);
        let bar = stress_gpa(&section, Level::Truss, &q);
        assert!((bar - 3.0 / section.area_um2).abs() < 1e-15);
    }
}
