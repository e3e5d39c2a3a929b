//! Why a sheet cannot be laid.

/// A plan that no sheet can be laid from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SheetError {
    #[error("{quantity} is {value} {unit}; allowed is {allowed}")]
    OutOfRange {
        quantity: String,
        value: f64,
        unit: &'static str,
        allowed: String,
    },
    #[error("nobody wants the sheet any more")]
    GivenUp,
    #[error("a sheet is made of at least one pulp")]
    NoPulp,
    #[error("{quantity}: an empty list says nothing; give at least one entry")]
    Empty { quantity: String },
    #[error("the mass fractions of the pulps sum to {sum}; they must sum to 1")]
    MassFractions { sum: f64 },
    #[error(
        "pulp {pulp} has {length_um} um of fibre in the whole sheet, which is less than a fibre is wide ({width_um} um): use a larger sheet or a higher grammage"
    )]
    TooLittle {
        pulp: usize,
        length_um: f64,
        width_um: f64,
    },
    #[error(
        "the sheet would have about {fibres:.0} fibres and need {gigabytes:.1} GB; at most {most_gigabytes} GB are given to a sheet"
    )]
    TooLarge {
        fibres: f64,
        gigabytes: f64,
        most_gigabytes: f64,
    },
}

/// `value` when it lies within the range that `allowed` puts in words.
pub(super) fn check(
    is_allowed: bool,
    quantity: impl Into<String>,
    value: f64,
    unit: &'static str,
    allowed: impl Into<String>,
) -> Result<(), SheetError> {
    if is_allowed {
        return Ok(());
    }
    Err(SheetError::OutOfRange {
        quantity: quantity.into(),
        value,
        unit,
        allowed: allowed.into(),
    })
}
