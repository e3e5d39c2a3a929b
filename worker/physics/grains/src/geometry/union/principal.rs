//! Principal axes of an inertia tensor.
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Off-diagonal terms below this share of the trace are round-off: the axes of a body that is
/// symmetric in its frame stay those of the frame instead of turning with the last digit.
const NEGLIGIBLE: f64 = 1e-12;

/// The frame in which an inertia tensor is diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PrincipalAxes {
    /// Principal moments, unit as given, in the order of the axes: no particular order of size.
    pub(crate) moments: Vector3<f64>,
    /// Turns principal into given coordinates: its columns are the principal axes, right-handed,
    /// and R diag(moments) Rᵀ is the given tensor.
    pub(crate) rotation: Rotation3<f64>,
}

/// Principal moments and axes of a symmetric, positive tensor.
///
/// The axes are put in the order that brings them closest to x, y, z, each pointing along its
/// coordinate axis rather than against it (the third as right-handedness demands), so that equal
/// tensors give equal frames. Axes of equal moments are any at right angles.
pub(crate) fn principal_axes(inertia: &Matrix3<f64>) -> PrincipalAxes {
    let negligible = NEGLIGIBLE * inertia.trace();
    let mut tensor = (inertia + inertia.transpose()) * 0.5;
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        if tensor[(row, column)].abs() <= negligible {
            (tensor[(row, column)], tensor[(column, row)]) = (0.0, 0.0);
        }
    }
    let eigen = tensor.symmetric_eigen();
    // the order whose axes have the largest components along x, y, z
    let orders = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ];
    let closeness = |order: &[usize; 3]| -> f64 {
        let components = (0..3).map(|axis| eigen.eigenvectors[(axis, order[axis])].abs());
        components.sum()
    };
    let mut order = orders[0];
    for candidate in &orders[1..] {
        // not by round-off alone
        if closeness(candidate) > closeness(&order) + NEGLIGIBLE {
            order = *candidate;
        }
    }
    let axis = |number: usize| {
        let column = eigen.eigenvectors.column(order[number]).into_owned();
        if column[number] < 0.0 {
            -column
        } else {
            column
        }
    };
    let (x, y, z) = (axis(0), axis(1), axis(2));
    // an axis at right angles to its own coordinate axis may have either sign
    let z = if x.cross(&y).dot(&z) < 0.0 { -z } else { z };
    PrincipalAxes {
        moments: Vector3::from_fn(|number, _| eigen.eigenvalues[order[number]]),
        rotation: Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check(inertia: &Matrix3<f64>, frame: &PrincipalAxes) {
        let rotation = frame.rotation.matrix();
        let back = rotation * Matrix3::from_diagonal(&frame.moments) * rotation.transpose();
        let off = (back - inertia).norm() / inertia.norm();
        assert!(off < 1e-12, "off by {off}");
        assert!((rotation.determinant() - 1.0).abs() < 1e-12);
        assert!((rotation * rotation.transpose() - Matrix3::identity()).norm() < 1e-12);
    }

    #[test]
    fn a_diagonal_tensor_keeps_its_axes() {
        for moments in [[2.0, 2.0, 2.0], [1.0, 2.0, 2.0], [3.0, 2.0, 1.5]] {
            let moments = Vector3::from(moments);
            let frame = principal_axes(&Matrix3::from_diagonal(&moments));
            assert_eq!(frame.moments, moments);
            assert_eq!(*frame.rotation.matrix(), Matrix3::identity());
        }
    }

    #[test]
    fn round_off_does_not_turn_the_axes() {
        let noisy = Matrix3::new(2.0, 1e-15, -2e-15, 1e-15, 2.0, 0.0, -2e-15, 0.0, 1.0);
        let frame = principal_axes(&noisy);
        assert_eq!(*frame.rotation.matrix(), Matrix3::identity());
    }

    #[test]
    fn axes_stay_close_to_the_frame() {
        let turn = Rotation3::from_euler_angles(0.1, -0.2, 0.15);
        let moments = Matrix3::from_diagonal(&Vector3::new(3.0, 1.0, 2.0));
        let frame = principal_axes(&(turn * moments * turn.transpose()));
        assert!((frame.rotation.matrix() - turn.matrix()).norm() < 1e-12);
    }

    proptest! {
        #[test]
        fn every_tensor_is_made_diagonal(
            moments in prop::array::uniform3(0.5..2.0_f64),
            angles in prop::array::uniform3(-3.0..3.0_f64),
            equal in 0..3,
        ) {
            let [first, second, third] = moments;
            let moments = match equal {
                0 => Vector3::new(first, second, third),
                1 => Vector3::new(first, second, second),
                _ => Vector3::new(first, first, first),
            };
            let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let inertia = turn * Matrix3::from_diagonal(&moments) * turn.transpose();
            let frame = principal_axes(&inertia);
            check(&inertia, &frame);
            prop_assert_eq!(principal_axes(&inertia), frame);
        }
    }
}
