//! What a fibre can be refused for.
use thiserror::Error;

/// Why there is no fibre, or no rest of it.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FibreError {
    /// A value that no fibre has.
    #[error("{quantity} is {given} {unit}; allowed: {allowed}")]
    OutOfRange {
        quantity: &'static str,
        unit: &'static str,
        given: f64,
        allowed: String,
    },
    /// The closed form gives a spring below 0 at this length of a segment.
    #[error(
        "segments of {given_um:.4} µm need springs of negative stiffness; allowed: {from_um:.4} to \
         {to_um:.4} µm"
    )]
    Inadmissible {
        given_um: f64,
        from_um: f64,
        to_um: f64,
    },
    /// No whole number of segments makes up the length.
    #[error(
        "no whole number of segments of {from_um:.4} to {to_um:.4} µm makes up a fibre of {length_um} µm"
    )]
    NoWholeNumber {
        length_um: f64,
        from_um: f64,
        to_um: f64,
    },
    /// Diagonal springs would shorten in tension: nothing makes the tube contract as asked.
    #[error(
        "segments of {given_um:.4} µm are too short for any springs; allowed: more than {above_um:.4} µm"
    )]
    TooShort { given_um: f64, above_um: f64 },
    /// The tube has no stable equilibrium under its supports.
    #[error("point {point} of the tube is held by nothing, or gives way")]
    Unstable { point: usize },
    /// The factor of the equations does not fit into memory.
    #[error("the equations of {points} points do not fit into memory")]
    TooLarge { points: usize },
    /// Forces could not be balanced.
    #[error(
        "no equilibrium at a displacement of {displacement_um} µm: residual {residual:e} of the largest \
         force after {rounds} rounds, allowed {limit:e}"
    )]
    NotConverged {
        displacement_um: f64,
        residual: f64,
        limit: f64,
        rounds: u32,
    },
    /// The tube does not buckle, or its mode was not found.
    #[error("no buckling load was found in {rounds} rounds; the last change was {change:e}")]
    NoBuckling { rounds: u32, change: f64 },
}

impl FibreError {
    pub(crate) fn out_of_range(
        quantity: &'static str,
        unit: &'static str,
        given: f64,
        allowed: impl Into<String>,
    ) -> Self {
        Self::OutOfRange {
            quantity,
            unit,
            given,
            allowed: allowed.into(),
        }
    }
}
