//! Tables as CSV: one header row with units in the names, dot decimals, full digits.
use std::fmt;
use std::io::{self, Write};

use loadframe_api::csv_cell;

/// Writes the row of column names.
///
/// # Errors
/// When `out` does not take it.
pub fn header(out: &mut dyn Write, names: &[&str]) -> io::Result<()> {
    let names: Vec<_> = names.iter().map(|name| csv_cell(name)).collect();
    writeln!(out, "{}", names.join(","))
}

/// A number in the shortest form that reads back as the same number. Large and small magnitudes take an
/// exponent, so that no cell grows beyond about 24 characters. What is not known, NaN, leaves its cell
/// empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        let magnitude = value.abs();
        if value.is_nan() {
            Ok(())
        } else if magnitude != 0.0 && !(1e-5..1e15).contains(&magnitude) {
            write!(out, "{value:e}")
        } else {
            write!(out, "{value}")
        }
    }
}

/// Writes a row of numbers, each a [`Number`].
///
/// # Errors
/// When `out` does not take it.
pub fn row(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    for (column, value) in values.iter().enumerate() {
        let separator = if column == 0 { "" } else { "," };
        write!(out, "{separator}{}", Number(*value))?;
    }
    writeln!(out)
}

/// The name of a result with its unit, as a column: `max_force` and N give `max_force_n`.
pub fn column(name: &str, unit: &str) -> String {
    let suffix = unit.to_lowercase().replace('/', "_per_").replace(' ', "_");
    let (quantity, _) = name.split_once("_along_").unwrap_or((name, ""));
    if unit == "1" || quantity.ends_with(&format!("_{suffix}")) {
        return name.to_owned();
    }
    format!("{name}_{suffix}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(values: &[f64]) -> String {
        let mut bytes = Vec::new();
        row(&mut bytes, values).expect("a Vec takes everything");
        String::from_utf8(bytes).expect("numbers are ASCII")
    }

    #[test]
    fn numbers_keep_their_digits() {
        assert_eq!(text(&[0.1, 3.0, -1e-7, 2e20]), "0.1,3,-1e-7,2e20\n");
    }

    #[test]
    fn what_is_not_known_is_left_empty() {
        assert_eq!(text(&[1.0, f64::NAN, 2.0]), "1,,2\n");
    }

    #[test]
    fn columns_carry_their_unit_once() {
        assert_eq!(column("max_force", "N"), "max_force_n");
        assert_eq!(column("strength", "N/m"), "strength_n_per_m");
        assert_eq!(column("strength_pa", "Pa"), "strength_pa");
        assert_eq!(column("poisson_ratio", "1"), "poisson_ratio");
        assert_eq!(column("strength_pa_along_x", "Pa"), "strength_pa_along_x");
        assert_eq!(column("max_force_along_x", "N"), "max_force_along_x_n");
    }

    proptest! {
        #[test]
        fn every_number_reads_back(value in proptest::num::f64::NORMAL | proptest::num::f64::ZERO) {
            let read: f64 = text(&[value]).trim().parse().expect("a number");
            prop_assert_eq!(read.to_bits(), value.to_bits());
        }
    }
}
