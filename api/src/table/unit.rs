//! Units that testing machines write, and what they measure.

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// A pure number.
    Ratio,
    Length,
    Force,
    Time,
    Stress,
    ForcePerLength,
    Moment,
    Energy,
}

/// A unit as a multiple of the SI unit of its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) dimension: Dimension,
    pub(crate) factor: f64,
}

/// Standard acceleration of free fall [m/s²] (ISO 80000-3), and the pound [kg], inch [m]
/// (international yard and pound agreement of 1959), exact.
const GRAVITY: f64 = 9.806_65;
const POUND: f64 = 0.453_592_37;
const INCH: f64 = 0.0254;

/// The unit of this symbol. Masses are no forces here: `kg` may mean either.
pub(crate) fn of_symbol(symbol: &str) -> Option<Unit> {
    let symbol = symbol.trim().trim_end_matches('.');
    if let Some(unit) = of_width(symbol) {
        return Some(unit);
    }
    // `m·N` is no millinewton
    let words = symbol.split_whitespace();
    let are_letters = |word: &str| word.chars().all(char::is_alphabetic);
    let is_product = symbol.contains(['·', '*', '⋅', '.'])
        || words.clone().count() > 1 && words.clone().all(are_letters);
    of_bare(symbol).filter(|unit| !is_product || unit.dimension == Dimension::Moment)
}

/// A force of a strip: `N/15mm`, `N per 15 mm`, as paper is tested (ISO 1924-2).
fn of_width(symbol: &str) -> Option<Unit> {
    let (force, width) = symbol
        .split_once(" per ")
        .or_else(|| symbol.split_once('/'))?;
    let unit = width
        .trim()
        .trim_start_matches(|c: char| c.is_ascii_digit());
    let number = width.trim().strip_suffix(unit)?;
    let number: u32 = if number.is_empty() { "1" } else { number }
        .parse()
        .ok()
        .filter(|number| *number > 0)?;
    let (force, length) = (of_bare(force)?, of_bare(unit)?);
    let is_strip = force.dimension == Dimension::Force && length.dimension == Dimension::Length;
    is_strip.then(|| Unit {
        dimension: Dimension::ForcePerLength,
        factor: force.factor / (f64::from(number) * length.factor),
    })
}

fn of_bare(symbol: &str) -> Option<Unit> {
    use Dimension::{Energy, Force, ForcePerLength, Length, Moment, Ratio, Stress, Time};
    let symbol: String = symbol
        .trim()
        .chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '·' | '*' | '⋅' | '.'))
        .map(|c| match c {
            'μ' => 'µ',
            '²' => '2',
            c => c,
        })
        .collect();
    let symbol = symbol.replace('^', "");
    let (dimension, factor) = match symbol.as_str() {
        "1" | "-" | "mm/mm" | "m/m" | "in/in" => (Ratio, 1.0),
        "%" | "pct" | "percent" | "Prozent" => (Ratio, 1e-2),
        "‰" => (Ratio, 1e-3),
        "µm/m" | "µε" | "µstrain" | "microstrain" => (Ratio, 1e-6),
        "mm" | "MM" | "millimetre" | "millimeter" => (Length, 1e-3),
        "m" => (Length, 1.0),
        "cm" => (Length, 1e-2),
        "µm" | "um" | "micron" => (Length, 1e-6),
        "nm" => (Length, 1e-9),
        "in" | "inch" | "\"" => (Length, INCH),
        "ft" => (Length, 12.0 * INCH),
        "N" | "Newton" | "newton" => (Force, 1.0),
        "mN" => (Force, 1e-3),
        "µN" | "uN" => (Force, 1e-6),
        "cN" => (Force, 1e-2),
        "daN" => (Force, 10.0),
        "kN" | "KN" => (Force, 1e3),
        "MN" => (Force, 1e6),
        "kgf" | "kp" => (Force, GRAVITY),
        "gf" => (Force, 1e-3 * GRAVITY),
        "lbf" | "lbs-f" => (Force, POUND * GRAVITY),
        "ozf" => (Force, POUND / 16.0 * GRAVITY),
        "kip" | "klbf" => (Force, 1e3 * POUND * GRAVITY),
        "s" | "sec" | "Sec" | "SEC" | "sek" | "Sek" => (Time, 1.0),
        "ms" => (Time, 1e-3),
        "min" => (Time, 60.0),
        "h" => (Time, 3600.0),
        "Pa" => (Stress, 1.0),
        "kPa" | "KPa" => (Stress, 1e3),
        "MPa" | "MPA" | "Mpa" | "N/mm2" => (Stress, 1e6),
        "GPa" => (Stress, 1e9),
        "N/m2" => (Stress, 1.0),
        "N/cm2" => (Stress, 1e4),
        "kN/m2" => (Stress, 1e3),
        "bar" => (Stress, 1e5),
        "psi" => (Stress, POUND * GRAVITY / (INCH * INCH)),
        "ksi" => (Stress, 1e3 * POUND * GRAVITY / (INCH * INCH)),
        "N/m" => (ForcePerLength, 1.0),
        "kN/m" | "N/mm" => (ForcePerLength, 1e3),
        "N/cm" => (ForcePerLength, 1e2),
        "Nm" => (Moment, 1.0),
        "Nmm" => (Moment, 1e-3),
        "J" => (Energy, 1.0),
        "mJ" => (Energy, 1e-3),
        "kJ" => (Energy, 1e3),
        _ => return None,
    };
    Some(Unit { dimension, factor })
}

/// The unit in which a column of a job is, by the end of its name: `force_n`, `displacement_mm`;
/// `None` where its name ends in none that measurements come in.
pub(crate) fn of_column(name: &str) -> Option<Unit> {
    const ENDS: [(&str, &str); 18] = [
        ("_n_per_m", "N/m"),
        ("_kn_per_m", "kN/m"),
        ("_per_mm", ""),
        ("_per_s", ""),
        ("_n_mm", "N mm"),
        ("_n_m", "N m"),
        ("_kn", "kN"),
        ("_mn", "mN"),
        ("_n", "N"),
        ("_mm", "mm"),
        ("_um", "µm"),
        ("_m", "m"),
        ("_s", "s"),
        ("_kpa", "kPa"),
        ("_mpa", "MPa"),
        ("_pa", "Pa"),
        ("_j", "J"),
        ("strain", "1"),
    ];
    let (_, symbol) = ENDS.iter().find(|(end, _)| name.ends_with(end))?;
    of_symbol(symbol)
}

impl Dimension {
    /// What it is, and units it comes in.
    pub(super) fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Ratio => ("a pure number", "\"1\", \"%\", \"mm/mm\""),
            Self::Length => ("a length", "\"mm\", \"m\", \"in\", ..."),
            Self::Force => (
                "a force",
                "\"N\", \"mN\", \"kN\", \"cN\", \"kgf\", \"lbf\", ...",
            ),
            Self::Time => ("a time", "\"s\", \"min\", ..."),
            Self::Stress => ("a stress", "\"Pa\", \"kPa\", \"MPa\", \"psi\", ..."),
            Self::ForcePerLength => ("a force per length", "\"N/m\", \"kN/m\", \"N/mm\""),
            Self::Moment => ("a moment", "\"N m\", \"N mm\""),
            Self::Energy => ("an energy", "\"J\", \"mJ\""),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_columns_are_those_at_the_end_of_their_names() {
        let factor = |name| of_column(name).map(|unit| (unit.dimension, unit.factor));
        assert_eq!(factor("force_n"), Some((Dimension::Force, 1.0)));
        assert_eq!(factor("force_kn"), Some((Dimension::Force, 1e3)));
        assert_eq!(factor("top_displacement_m"), Some((Dimension::Length, 1.0)));
        assert_eq!(factor("nominal_strain"), Some((Dimension::Ratio, 1.0)));
        assert_eq!(factor("torque_n_mm"), Some((Dimension::Moment, 1e-3)));
        assert_eq!(factor("curvature_per_mm"), None);
        assert_eq!(factor("broken_bonds"), None);
    }

    #[test]
    fn a_force_of_a_strip_is_over_its_width_and_a_product_is_no_prefix() {
        // 3 N over 15 mm: 200 N/m
        for symbol in ["N/15mm", "N/15 mm", "N per 15 mm"] {
            let unit = of_symbol(symbol).expect("a unit");
            assert_eq!(unit.dimension, Dimension::ForcePerLength, "{symbol}");
            assert!(
                (3.0 * unit.factor - 200.0).abs() < 1e-12,
                "{unit:?} of {symbol}"
            );
        }
        for unknown in ["m·N", "m*N", "m N", "k.N", "N/0mm", "N/15", "N/1.5mm"] {
            assert_eq!(of_symbol(unknown), None, "{unknown}");
        }
        let dimension = |symbol| of_symbol(symbol).map(|unit| unit.dimension);
        for moment in ["N·m", "N*mm", "N mm", "N.m"] {
            assert_eq!(dimension(moment), Some(Dimension::Moment), "{moment}");
        }
        assert_eq!(dimension("sec."), Some(Dimension::Time));
        assert_eq!(dimension("N / mm²"), Some(Dimension::Stress));
    }

    #[test]
    fn symbols_keep_their_case_and_masses_are_no_forces() {
        let force = |symbol| of_symbol(symbol).map(|unit| unit.factor);
        assert_eq!(force("mN"), Some(1e-3));
        assert_eq!(force("MN"), Some(1e6));
        assert_eq!(force("N/mm²"), Some(1e6));
        assert_eq!(force("lbf"), Some(4.448_221_615_260_5));
        for unknown in ["kg", "g", "lb", "n", "mn", ""] {
            assert_eq!(force(unknown), None, "{unknown}");
        }
    }
}
