//! Numbers that options take.

/// A number of seconds or megabytes; a day in a thousand years is as good as none.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    const MOST: f64 = 1e11;
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number <= MOST => Ok(number),
        _ => Err(format!("a number above 0 and up to {MOST:e} is needed")),
    }
}
