//! `accuracy.svg`: a panel for each result, error over processor time, both on log axes.
//!
//! A line for each knob, with its own colour and mark; a ring marks the spec's own setting, a dashed
//! line the scatter between specimens; what is exact, the reference above all, lies on the bottom
//! edge.
use std::fmt::Write;

use super::analysis::{KnobStudy, Study};
use crate::svg::{COLOURS, MARGIN, PANEL, end, escaped, frame, level, mark, middle, picture, text};
use crate::text::{digits, sentence};

/// Room for the legend at the bottom.
const LEGEND: f64 = 64.0;
/// Errors below this [%] are drawn as zero.
const SMALLEST: f64 = 1e-5;
/// Radius of the ring around the spec's own setting.
const RING: f64 = 9.0;
/// A log axis from one power of ten to another.
#[derive(Clone, Copy)]
struct Axis {
    from: i32,
    to: i32,
    start: f64,
    length: f64,
}

impl Axis {
    /// The axis around positive values, `length` long from `start`; negative lengths go up.
    fn around(values: impl Iterator<Item = f64>, start: f64, length: f64) -> Self {
        let (low, high) = values
            .filter(|value| *value > 0.0)
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        if high == 0.0 {
            return Self {
                from: -1,
                to: 0,
                start,
                length,
            };
        }
        let from = low.log10().floor() as i32;
        let to = (high.log10().ceil() as i32).max(from + 1);
        Self {
            from,
            to,
            start,
            length,
        }
    }

    fn place(&self, value: f64) -> f64 {
        let lowest = f64::from(self.from);
        let way = (value.log10() - lowest) / f64::from(self.to - self.from);
        self.start + self.length * way.clamp(0.0, 1.0)
    }
}

/// The picture.
pub(super) fn plot(study: &Study) -> String {
    let heading = format!(
        "Error against processor time of one test, {} seeds",
        study.seeds.len()
    );
    let names: Vec<&String> = study.scatter.keys().collect();
    picture(
        "What exactness costs",
        &heading,
        names.len(),
        LEGEND,
        |svg, index, corner| panel(svg, study, names[index], corner),
        |svg, top| legend(svg, study, top + 12.0),
    )
}

fn panel(svg: &mut String, study: &Study, name: &str, [left, top]: [f64; 2]) {
    let [width, height] = PANEL;
    let bottom = top + height;
    let rows = || study.knobs.iter().flat_map(|knob| &knob.rows);
    let scatter = study.scatter[name].relative_deviation.map(|s| 100.0 * s);
    let errors = rows().filter_map(|row| percent(row.errors[name].as_ref()?.size()));
    let x = Axis::around(rows().map(|row| row.cpu_s), left, width);
    let y = Axis::around(errors.chain(scatter), bottom, -height);
    text(svg, left, top - 10.0, "title", &sentence(name));
    for power in x.from..=x.to {
        let at = x.place(10_f64.powi(power));
        let _ = writeln!(
            svg,
            "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{top}\" y2=\"{bottom}\"/>"
        );
        middle(svg, at, bottom + 16.0, &decimal(power, " s"));
    }
    for power in y.from..=y.to {
        level(
            svg,
            left,
            y.place(10_f64.powi(power)),
            &decimal(power, " %"),
        );
    }
    frame(svg, [left, top]);
    middle(
        svg,
        left + 0.5 * width,
        bottom + 32.0,
        "processor time of one test",
    );
    if let Some(scatter) = scatter.filter(|scatter| *scatter > 0.0) {
        let (at, right) = (y.place(scatter), left + width);
        let _ = writeln!(
            svg,
            "<line class=\"scatter\" x1=\"{left}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>"
        );
        end(
            svg,
            right - 4.0,
            at - 5.0,
            &format!("scatter {} %", digits(scatter)),
        );
    }
    for (index, knob) in study.knobs.iter().enumerate() {
        line(svg, knob, name, index, [x, y], bottom);
    }
}

/// One knob: its marks, each with its value, and a path through those of numbers.
fn line(
    svg: &mut String,
    knob: &KnobStudy,
    name: &str,
    index: usize,
    [x, y]: [Axis; 2],
    bottom: f64,
) {
    let mut way = Vec::<[f64; 2]>::new();
    let mut marks = String::new();
    for row in &knob.rows {
        let Some(error) = &row.errors[name] else {
            continue;
        };
        let shown = percent(error.size());
        let at = [
            x.place(row.cpu_s),
            shown.map_or(bottom, |shown| y.place(shown)),
        ];
        let is_number = row.value.parse::<f64>().is_ok();
        if is_number && shown.is_some() {
            way.push(at);
        }
        let class = match shown {
            Some(_) => "",
            None => " class=\"open\"",
        };
        let told = format!(
            "{} = {}: {:.3} % at {:.3} s",
            knob.knob,
            row.value,
            100.0 * error.size(),
            row.cpu_s
        );
        let [left, top] = at;
        let ring = match row.is_present {
            true => {
                format!("<circle class=\"present\" cx=\"{left:.1}\" cy=\"{top:.1}\" r=\"{RING}\"/>")
            }
            false => String::new(),
        };
        let symbol = mark(index, at, class);
        let _ = writeln!(
            marks,
            "<g><title>{}</title>{symbol}{ring}</g>",
            escaped(&told)
        );
        // words are long; their title tells them
        if is_number && shown.is_some() {
            text(&mut marks, left + 7.0, top - 6.0, "muted", &row.value);
        }
    }
    way.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let points = way.iter().map(|[x, y]| format!("{x:.1},{y:.1}"));
    let points: Vec<String> = points.collect();
    let colour = format!("var(--c{})", index % COLOURS);
    let _ = writeln!(
        svg,
        "<polyline class=\"path\" style=\"stroke: {colour}\" points=\"{}\"/>\n\
         <g style=\"fill: {colour}\">\n{marks}</g>",
        points.join(" ")
    );
}

fn legend(svg: &mut String, study: &Study, top: f64) {
    let mut left = MARGIN[0];
    for (index, knob) in study.knobs.iter().enumerate() {
        let symbol = mark(index, [left, top - 4.0], "");
        let _ = writeln!(
            svg,
            "<g style=\"fill: var(--c{})\">{symbol}</g>",
            index % COLOURS
        );
        text(svg, left + 10.0, top, "", knob.knob);
        left += 40.0 + 7.5 * knob.knob.len() as f64;
    }
    let words = "Ring: the spec's own setting. Dashed: standard deviation between specimens. On the \
                 bottom edge: no error, as the reference has none.";
    text(svg, MARGIN[0], top + 26.0, "muted", words);
}

/// In %, `None` for what counts as exact.
fn percent(error: f64) -> Option<f64> {
    Some(100.0 * error).filter(|error| *error >= SMALLEST)
}

/// A power of ten with its unit.
fn decimal(power: i32, unit: &str) -> String {
    let number = match power {
        -4..=4 => 10_f64.powi(power).to_string(),
        _ => format!("1e{power}"),
    };
    number + unit
}
