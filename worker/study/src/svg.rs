//! Pictures of studies: a panel for each result, two in a row.
//!
//! Written by hand: colours that follow the reader's light or dark scheme are a style sheet inside
//! the picture, which plotting crates do not write.
use std::fmt::Write;

pub(super) const WIDTH: f64 = 960.0;
const COLUMNS: usize = 2;
pub(super) const PANEL: [f64; 2] = [400.0, 230.0];
pub(super) const MARGIN: [f64; 2] = [64.0, 60.0];
const GAP: [f64; 2] = [64.0, 74.0];
/// Radius of a mark.
pub(super) const MARK: f64 = 4.5;
/// Colours in the style sheet.
pub(super) const COLOURS: usize = 6;

const STYLE: &str = "
svg { --ink: #1d2630; --muted: #5b6672; --line: #d5dbe1; --paper: #ffffff;
  --c0: #0b63c5; --c1: #c2410c; --c2: #15803d; --c3: #8b2fc9; --c4: #a16207; --c5: #0e7490;
  background: var(--paper); font: 13px system-ui, sans-serif; }
@media (prefers-color-scheme: dark) { svg { --ink: #e6eaee; --muted: #9aa6b2; --line: #38424d; --paper: #12171c;
  --c0: #6db3ff; --c1: #ff9a66; --c2: #5fd38a; --c3: #cf9bff; --c4: #e5bd4f; --c5: #56cfe1; } }
text { fill: var(--ink); } .muted { fill: var(--muted); font-size: 11px; } .title { font-weight: 600; }
.grid { stroke: var(--line); } .frame { fill: none; stroke: var(--muted); }
.scatter { stroke: var(--ink); stroke-dasharray: 6 4; } .path { fill: none; stroke-width: 1.6; }
.present { fill: none; stroke: var(--ink); stroke-width: 1.6; } .open { fill-opacity: 0.35; }
";

/// A picture with so many panels and room for a legend of this height; `draw` gets the corner of
/// each panel, `legend` the top of the room below them.
pub(super) fn picture(
    title: &str,
    heading: &str,
    panels: usize,
    room: f64,
    mut draw: impl FnMut(&mut String, usize, [f64; 2]),
    legend: impl FnOnce(&mut String, f64),
) -> String {
    let rows = panels.div_ceil(COLUMNS).max(1);
    let height = MARGIN[1] + rows as f64 * (PANEL[1] + GAP[1]) + room;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" \
         width=\"{WIDTH}\" height=\"{height}\" role=\"img\">\n<title>{}</title>\n\
         <style>{STYLE}</style>\n",
        escaped(title)
    );
    text(&mut svg, MARGIN[0], 26.0, "title", heading);
    for index in 0..panels {
        let corner = [
            MARGIN[0] + (index % COLUMNS) as f64 * (PANEL[0] + GAP[0]),
            MARGIN[1] + (index / COLUMNS) as f64 * (PANEL[1] + GAP[1]),
        ];
        draw(&mut svg, index, corner);
    }
    legend(&mut svg, height - room);
    svg.push_str("</svg>\n");
    svg
}

/// The frame of a panel.
pub(super) fn frame(svg: &mut String, [left, top]: [f64; 2]) {
    let [width, height] = PANEL;
    let _ = writeln!(
        svg,
        "<rect class=\"frame\" x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>"
    );
}

/// A line across a panel with its number at the left.
pub(super) fn level(svg: &mut String, left: f64, at: f64, number: &str) {
    let right = left + PANEL[0];
    let _ = writeln!(
        svg,
        "<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>"
    );
    end(svg, left - 6.0, at + 4.0, number);
}

/// The mark number `index`: shapes tell apart without colours.
pub(super) fn mark(index: usize, [x, y]: [f64; 2], class: &str) -> String {
    let r = MARK;
    let points = |points: &[[f64; 2]]| {
        let points = points
            .iter()
            .map(|[dx, dy]| format!("{:.1},{:.1}", x + dx * r, y + dy * r));
        let points: Vec<String> = points.collect();
        format!("<polygon{class} points=\"{}\"/>", points.join(" "))
    };
    match index % 5 {
        0 => format!("<circle{class} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\"/>"),
        1 => points(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]),
        2 => points(&[[0.0, -1.3], [1.2, 0.9], [-1.2, 0.9]]),
        3 => points(&[[0.0, -1.4], [1.4, 0.0], [0.0, 1.4], [-1.4, 0.0]]),
        _ => points(&[[0.0, 1.3], [1.2, -0.9], [-1.2, -0.9]]),
    }
}

/// Words that begin here.
pub(super) fn text(svg: &mut String, x: f64, y: f64, class: &str, words: &str) {
    let _ = writeln!(
        svg,
        "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>",
        escaped(words)
    );
}

/// Small words around here.
pub(super) fn middle(svg: &mut String, x: f64, y: f64, words: &str) {
    let _ = writeln!(
        svg,
        "<text class=\"muted\" text-anchor=\"middle\" x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>"
    );
}

/// Small words that end here.
pub(super) fn end(svg: &mut String, x: f64, y: f64, words: &str) {
    let _ = writeln!(
        svg,
        "<text class=\"muted\" text-anchor=\"end\" x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>"
    );
}

/// Text as XML takes it.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
