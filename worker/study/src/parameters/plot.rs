//! `parameters.svg`: a panel for each of the first results, the cases side by side.
//!
//! A dot is a test, a mark with its bar the mean of a case with its 95 % interval. Labels that are
//! too long for the axis are numbers there, and words in the legend.
use std::fmt::Write;

use super::analysis::Study;
use super::case::{CaseResult, CaseRow};
use super::labels::Labels;
use crate::svg::{MARGIN, PANEL, escaped, frame, level, mark, middle, picture, text};
use crate::text::{Digits, sentence};

/// Panels at most.
const PANELS: usize = 4;
/// Lines across a panel, about.
const LEVELS: f64 = 5.0;
/// Width of a letter of the small text.
const LETTER: f64 = 6.2;
/// Height of a line of the legend.
const LINE: f64 = 18.0;
/// Half the width of the ends of a bar.
const CAP: f64 = 5.0;
/// Radius of a test's dot.
const DOT: f64 = 2.2;

/// The picture.
pub(super) fn plot(study: &Study) -> String {
    let names: Vec<&String> = study.findings.keys().take(PANELS).collect();
    let ticks = Ticks::of(study);
    let heading = match study.seeds.len() {
        1 => format!("{}: one specimen of each case", study.title),
        n => format!(
            "{}: means of {n} specimens with their 95 % intervals",
            study.title
        ),
    };
    let room = LINE * (ticks.legend.len() + 2) as f64;
    picture(
        &study.title,
        &heading,
        names.len(),
        room,
        |svg, index, corner| panel(svg, study, names[index], &ticks, corner),
        |svg, top| {
            for (index, line) in ticks.legend.iter().enumerate() {
                text(svg, MARGIN[0], top + LINE * index as f64, "muted", line);
            }
        },
    )
}

/// What stands under the cases.
struct Ticks {
    axis: Vec<String>,
    /// What they are values of.
    caption: String,
    legend: Vec<String>,
}

impl Ticks {
    fn of(study: &Study) -> Self {
        let labels = Labels::of(&study.cases);
        let shown = study.cases.iter().map(|case| labels.short(&case.label));
        let shown: Vec<&str> = shown.collect();
        let step = PANEL[0] / shown.len().max(1) as f64;
        let fits = |label: &&str| label.chars().count() as f64 * LETTER <= step;
        if shown.iter().all(fits) {
            let axis = shown.into_iter().map(str::to_owned).collect();
            return Self {
                axis,
                caption: sentence(labels.name()),
                legend: Vec::new(),
            };
        }
        let numbers: Vec<String> = (1..=shown.len()).map(|number| number.to_string()).collect();
        let legend = numbers.iter().zip(&study.cases);
        let legend = legend.map(|(number, case)| format!("{number}: {}", case.label));
        Self {
            legend: legend.collect(),
            axis: numbers,
            caption: "Case".to_owned(),
        }
    }
}

/// A linear axis upwards.
#[derive(Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    bottom: f64,
}

impl Axis {
    /// Around `values`, with some room; of equal values around them.
    fn around(values: impl Iterator<Item = f64>, bottom: f64) -> Option<Self> {
        let ends = values.fold(None, |ends: Option<[f64; 2]>, value| match ends {
            None => Some([value, value]),
            Some([low, high]) => Some([low.min(value), high.max(value)]),
        });
        let [low, high] = ends?;
        let span = high - low;
        let room = match span {
            0.0 if low == 0.0 => 1.0,
            0.0 => 0.1 * low.abs(),
            span => 0.06 * span,
        };
        Some(Self {
            low: low - room,
            high: high + room,
            bottom,
        })
    }

    fn place(&self, value: f64) -> f64 {
        self.bottom - PANEL[1] * (value - self.low) / (self.high - self.low)
    }

    /// Round numbers along it, 1, 2 or 5 times a power of ten apart.
    fn levels(&self) -> Vec<f64> {
        let rough = (self.high - self.low) / LEVELS;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
        let step = step
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(10.0 * power);
        let [first, last] = [(self.low / step).ceil(), (self.high / step).floor()];
        let count = (last - first).max(0.0) as u32;
        (0..=count)
            .map(|index| (first + f64::from(index)) * step)
            .collect()
    }
}

fn panel(svg: &mut String, study: &Study, name: &str, ticks: &Ticks, [left, top]: [f64; 2]) {
    let bottom = top + PANEL[1];
    let results = || study.cases.iter().map(|case| (case, &case.results[name]));
    text(svg, left, top - 10.0, "title", &sentence(&study.head(name)));
    frame(svg, [left, top]);
    let step = PANEL[0] / study.cases.len().max(1) as f64;
    for (index, label) in ticks.axis.iter().enumerate() {
        middle(
            svg,
            left + step * (index as f64 + 0.5),
            bottom + 16.0,
            &escaped(label),
        );
    }
    middle(
        svg,
        left + 0.5 * PANEL[0],
        bottom + 32.0,
        &escaped(&ticks.caption),
    );
    let shown = results().flat_map(|(case, result)| {
        let tests = values(case, name);
        tests
            .chain(result.interval.into_iter().flatten())
            .chain(result.mean)
    });
    let Some(axis) = Axis::around(shown, bottom) else {
        middle(
            svg,
            left + 0.5 * PANEL[0],
            top + 0.5 * PANEL[1],
            "not known",
        );
        return;
    };
    let levels = axis.levels();
    let digits = match levels.as_slice() {
        // to the digit that tells neighbours apart
        [first, second, ..] => {
            let largest = first.abs().max(levels[levels.len() - 1].abs());
            Digits::of(largest, Some(10.0 * (second - first)))
        }
        _ => Digits::of(axis.high, None),
    };
    for number in levels {
        level(svg, left, axis.place(number), &digits.show(number));
    }
    for (index, (case, result)) in results().enumerate() {
        let at = left + step * (index as f64 + 0.5);
        column(svg, case, result, values(case, name), axis, at);
    }
}

/// Values of a result by test.
fn values<'a>(case: &'a CaseRow, name: &str) -> impl Iterator<Item = f64> + use<'a> {
    let place = case.results.get_index_of(name);
    case.tests
        .iter()
        .filter_map(move |test| test.values[place?])
}

/// One case: its tests, its mean and the interval of that.
fn column(
    svg: &mut String,
    case: &CaseRow,
    result: &CaseResult,
    tests: impl Iterator<Item = f64>,
    axis: Axis,
    at: f64,
) {
    let Some(mean) = result.mean else {
        return;
    };
    let interval = result.interval_in_words().unwrap_or_default();
    let told = format!(
        "{}: {} {interval}",
        case.label,
        result.in_words(case.tests.len())
    );
    let _ = writeln!(
        svg,
        "<g style=\"fill: var(--c0); stroke: var(--c0)\"><title>{}</title>",
        escaped(told.trim_end())
    );
    for value in tests {
        let _ = writeln!(
            svg,
            "<circle class=\"open\" stroke=\"none\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{DOT}\"/>",
            at - 2.0 * CAP,
            axis.place(value)
        );
    }
    if let Some(ends) = result.interval {
        let [low, high] = ends.map(|end| axis.place(end));
        let [before, after] = [at - CAP, at + CAP];
        let _ = writeln!(
            svg,
            "<path class=\"path\" d=\"M{at:.1} {low:.1}V{high:.1}M{before:.1} {low:.1}H{after:.1}M{before:.1} {high:.1}H{after:.1}\"/>"
        );
    }
    let _ = writeln!(svg, "{}</g>", mark(0, [at, axis.place(mean)], ""));
}
