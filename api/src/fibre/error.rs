//! What a fibre is refused for.
use thiserror::Error;

/// Why there is no such fibre, or no springs for it.
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
    /// Two rings next to one another would cut through each other.
    #[error(
        "the fibre turns too sharply {at_um:.4} µm from its start: rings of {diameter_um:.4} µm across would cut \
         through one another; allowed are longer segments or a smoother line"
    )]
    TooBent { at_um: f64, diameter_um: f64 },
    /// Diagonal springs would shorten in tension: nothing makes the tube contract as asked.
    #[error(
        "segments of {given_um:.4} µm are too short for any springs; allowed: more than {above_um:.4} µm"
    )]
    TooShort { given_um: f64, above_um: f64 },
}

impl FibreError {
    /// A value out of its range.
    pub fn out_of_range(
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
