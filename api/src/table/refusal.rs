//! Why a table is not understood, and where.

/// Why a table is not understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The field to which it is said.
    pub place: Place,
    /// Word for programs, as in [`crate::Violation`].
    pub code: &'static str,
    pub detail: String,
    /// What was found there.
    pub value: Option<String>,
    pub allowed: String,
}

/// What a refusal is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Text,
    /// The hint of abscissa (0) or ordinate (1).
    Column(usize),
    Unit(usize),
    Decimal,
    GaugeLength,
    Preload,
    Slack,
}

impl Refusal {
    pub(super) fn new(
        place: Place,
        code: &'static str,
        detail: impl Into<String>,
        allowed: &str,
    ) -> Self {
        Self {
            place,
            code,
            detail: detail.into(),
            value: None,
            allowed: allowed.to_owned(),
        }
    }

    pub(super) fn value(mut self, value: impl Into<String>) -> Self {
        self.value = Some(value.into());
        self
    }
}
