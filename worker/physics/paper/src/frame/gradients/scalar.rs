//! Numbers of the preconditioner: it need not be exact, and half as long ones are read twice as fast.
use nalgebra::RealField;

/// Single or double precision.
pub(super) trait Scalar: RealField + Copy + Default {
    fn of(value: f64) -> Self;
    fn wide(self) -> f64;
}

impl Scalar for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn wide(self) -> f64 {
        self
    }
}

impl Scalar for f32 {
    #[allow(clippy::cast_possible_truncation, reason = "this rounds")]
    fn of(value: f64) -> Self {
        value as Self
    }

    fn wide(self) -> f64 {
        f64::from(self)
    }
}
