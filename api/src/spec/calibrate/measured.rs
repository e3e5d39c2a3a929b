//! What was measured.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::table::{self, ColumnHint, DecimalMark, Hints, Place, Reading, Refusal, Wanted};
use crate::{JobSpec, Violation};

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
    /// Abscissa and ordinate of each point, in the units of the job's columns.
    #[schemars(length(max = 100_000))]
    pub rows: Vec<[f64; 2]>,
    /// The points as a testing machine exports them instead: the text of its file, or the file itself
    /// in base64. Columns are found by name and unit and converted, whatever stands above them; what
    /// can be understood in two ways is refused. Without a line of names, two columns in the order
    /// and units of the job's.
    #[schemars(length(max = 4_000_000))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub csv: Option<String>,
    /// What the text leaves open, and where the curve begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reading: Option<CurveReading>,
    /// How `rows` were read from `csv`, a sentence each: written where a job with `csv` is accepted.
    #[schemars(length(max = 20), inner(length(max = 2000)))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub read_as: Vec<String>,
    /// Standard deviation of the measured ordinates, in their unit.
    #[schemars(range(min = 1e-300, max = 1e300))]
    pub deviation: Option<f64>,
}

/// How `csv` is read, where it does not say so itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CurveReading {
    /// Where the abscissa stands; left out, found by what it means.
    pub abscissa: TableColumn,
    /// Where the ordinate stands, likewise.
    pub ordinate: TableColumn,
    /// The mark before decimals; needed where every number has three of them: `1,027`.
    pub decimal: Option<DecimalMark>,
    /// Gauge length of the measured specimen, by which an extension becomes a strain.
    #[schemars(range(min = 1e-6, max = 1e9), extend("x-unit" = "mm"))]
    pub gauge_length_mm: Option<f64>,
    /// The abscissa counts from where the ordinate first is at this preload, in the unit of the job's
    /// column; what lies before is left out. A strain is then over the gauge length and what came
    /// before (ISO 13934-1, specimens mounted slack).
    #[schemars(range(min = 0.0, max = 1e300))]
    pub preload: Option<f64>,
    /// Slack is taken off: the straight line through the curve at these two ordinates, in the unit of
    /// the job's column, is drawn back to 0, where the abscissa begins to count.
    #[schemars(inner(range(min = 0.0, max = 1e300)))]
    pub slack_between: Option<[f64; 2]>,
}

/// A column of `csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TableColumn {
    /// Its name, with or without unit, or its number, counted from 1.
    #[schemars(length(min = 1, max = 200))]
    pub column: Option<String>,
    /// Its unit, where its title has none: `N`, `mN`, `%`, `mm`.
    #[schemars(length(min = 1, max = 20))]
    pub unit: Option<String>,
}

impl Measured {
    /// Number of residuals.
    pub fn count(&self) -> usize {
        self.results.len() + self.curve.as_ref().map_or(0, |curve| curve.rows.len())
    }

    /// Puts rows in the place of text, and what was understood in that of hints.
    pub(super) fn normalise(&mut self, job: &JobSpec) {
        if let Some(curve) = &mut self.curve
            && let Some(Ok(reading)) = curve.csv.as_deref().map(|text| curve.read(text, job))
        {
            curve.rows = reading.points;
            curve.read_as = reading.words;
            curve.csv = None;
            curve.reading = None;
        }
    }
}

impl MeasuredCurve {
    /// The columns of the job's curve that were measured.
    ///
    /// # Errors
    /// When the job's curve has no such columns, with a pointer into this.
    pub(super) fn wanted(&self, job: &JobSpec) -> Result<[String; 2], Violation> {
        if let JobSpec::NonwovenTensile(spec) = job
            && !spec.test.history.is_empty()
        {
            let detail =
                "the curve of a test with a history comes back: no value belongs to a strain";
            let violation = Violation::new("", "not_allowed", detail);
            return Err(violation
                .value("test.history")
                .allowed("results only, or a job without history"));
        }
        let known = job.curve_columns();
        let Some(names) = &self.columns else {
            return match &known[..] {
                [x, y, ..] => Ok([x.clone(), y.clone()]),
                _ => {
                    let violation = Violation::new("", "not_allowed", "the job gives no curve");
                    Err(violation.value(job.kind().name()).allowed("results only"))
                }
            };
        };
        match names.iter().position(|name| !known.contains(name)) {
            None => Ok(names.clone()),
            Some(index) => {
                let detail = "the job's curve has no column of this name";
                let violation = Violation::new(format!("/columns/{index}"), "not_allowed", detail);
                let allowed = format!("one of: {}", known.join(", "));
                Err(violation.value(names[index].as_str()).allowed(allowed))
            }
        }
    }

    /// Reads the text.
    ///
    /// # Errors
    /// What cannot be understood, with pointers into the curve.
    pub(super) fn read(&self, text: &str, job: &JobSpec) -> Result<Reading, Violation> {
        self.read_columns(text, self.wanted(job)?, job.largest_strain())
    }

    /// Reads the text as these two columns of jobs' curves, of which the first gets to `reach`.
    ///
    /// # Errors
    /// What cannot be understood, with pointers into the curve.
    pub fn read_columns(
        &self,
        text: &str,
        wanted: [String; 2],
        reach: Option<f64>,
    ) -> Result<Reading, Violation> {
        let none = CurveReading::default();
        let reading = self.reading.as_ref().unwrap_or(&none);
        let columns = [&reading.abscissa, &reading.ordinate].map(|column| ColumnHint {
            column: column.column.as_deref(),
            unit: column.unit.as_deref(),
        });
        let hints = Hints {
            columns,
            decimal: reading.decimal,
            gauge_length_mm: reading.gauge_length_mm,
            preload: reading.preload,
            slack: reading.slack_between,
            reach,
        };
        let wanted = wanted.map(|name| Wanted { name });
        table::read(text, &wanted, &hints).map_err(violation)
    }
}

/// A refusal of a table, said of the field that would help.
fn violation(refusal: Refusal) -> Violation {
    let side = |index: usize| ["abscissa", "ordinate"][index];
    let pointer = match refusal.place {
        Place::Text => "/csv".to_owned(),
        Place::Column(index) => format!("/reading/{}/column", side(index)),
        Place::Unit(index) => format!("/reading/{}/unit", side(index)),
        Place::Decimal => "/reading/decimal".to_owned(),
        Place::GaugeLength => "/reading/gauge_length_mm".to_owned(),
        Place::Preload => "/reading/preload".to_owned(),
        Place::Slack => "/reading/slack_between".to_owned(),
    };
    let violation = Violation::new(pointer, refusal.code, refusal.detail).allowed(refusal.allowed);
    match refusal.value {
        Some(value) => violation.value(value),
        None => violation,
    }
}
