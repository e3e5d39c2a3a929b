//! What was measured.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the job's results are held against: single results, a curve, or both.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Measured {
    #[schemars(length(max = 100))]
    pub results: Vec<MeasuredResult>,
    pub curve: Option<MeasuredCurve>,
}

/// A measured result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredResult {
    /// Its name in the summary of the job: `max_force`.
    #[schemars(length(min = 1, max = 100))]
    pub result: String,
    /// In the unit that the summary has.
    pub value: f64,
    /// Standard deviation of the measured value, in its unit: residuals are then differences over
    /// it, and intervals know of it. Left out, residuals are differences over the value.
    #[schemars(range(min = 1e-300, max = 1e300))]
    pub deviation: Option<f64>,
    /// Given, it must be the one the summary has.
    #[schemars(length(max = 20))]
    pub unit: Option<String>,
}

/// A measured curve, which as a whole counts as one measured result: the residual of each of its n
/// points is the difference over √n and the largest measured ordinate, or over √n and `deviation`.
/// Between points, and past its end at its last value, the simulated curve is read at the measured
/// abscissae.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MeasuredCurve {
    /// Names of abscissa and ordinate among the columns of the job's curve; left out, the first two:
    /// nominal strain and force of a tensile test.
    pub columns: Option<[String; 2]>,
    /// Abscissa and ordinate of each point.
    #[schemars(length(max = 100_000))]
    pub rows: Vec<[f64; 2]>,
    /// The points as text instead: one a line, abscissa and ordinate in the first two columns, with
    /// or without a line of names. Columns end in a comma, semicolon or tab; where it is one of the
    /// last two, decimals may have a comma.
    #[schemars(length(max = 4_000_000))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub csv: Option<String>,
    /// Standard deviation of the measured ordinates, in their unit.
    #[schemars(range(min = 1e-300, max = 1e300))]
    pub deviation: Option<f64>,
}

impl Measured {
    /// Number of residuals.
    pub fn count(&self) -> usize {
        self.results.len() + self.curve.as_ref().map_or(0, |curve| curve.rows.len())
    }

    /// Puts rows in the place of text.
    pub(super) fn normalise(&mut self) {
        if let Some(curve) = &mut self.curve
            && let Some(Ok(rows)) = curve.csv.as_deref().map(rows)
        {
            curve.rows = rows;
            curve.csv = None;
        }
    }
}

impl MeasuredCurve {
    /// Its points, from rows or text.
    ///
    /// # Errors
    /// Number of the line, counted from 1, that is no point.
    pub(super) fn points(&self) -> Result<Vec<[f64; 2]>, usize> {
        match &self.csv {
            Some(text) => rows(text),
            None => Ok(self.rows.clone()),
        }
    }
}

/// The points of a table; empty lines and a first line without numbers are passed over.
fn rows(text: &str) -> Result<Vec<[f64; 2]>, usize> {
    let separator = [';', '\t', ',']
        .into_iter()
        .find(|mark| text.contains(*mark));
    let separator = separator.unwrap_or(',');
    let number = |cell: Option<&str>| {
        let cell = cell?.trim();
        let cell = if separator == ',' {
            cell.to_owned()
        } else {
            cell.replace(',', ".")
        };
        cell.parse::<f64>().ok().filter(|number| number.is_finite())
    };
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let mut rows = Vec::new();
    for (index, line) in lines {
        let mut cells = line.split(separator);
        match (number(cells.next()), number(cells.next())) {
            (Some(abscissa), Some(ordinate)) => rows.push([abscissa, ordinate]),
            _ if index == 0 => {}
            _ => return Err(index + 1),
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_testing_machines_are_read() {
        let expected = Ok(vec![[0.1, 8.5], [0.2, 30.0]]);
        assert_eq!(rows("nominal_strain,force_n\n0.1,8.5\n0.2,30\n"), expected);
        assert_eq!(
            rows("\u{feff}Dehnung;Kraft;Zeit\r\n0,1;8,5;1\r\n\r\n0,2;3e1;2\r\n"),
            expected
        );
        assert_eq!(rows("0.1\t8.5\n0.2\t30"), expected);
        assert_eq!(rows("a,b\n0.1,8.5\n0.2,x\n"), Err(3));
        assert_eq!(rows("a,b\n0.1\n"), Err(2));
        assert_eq!(rows("0.1,1\n0.2,inf"), Err(2));
        assert_eq!(rows(""), Ok(vec![]));
    }
}
