//! How far a job is: a bar on a terminal, now and then a line where there is none.
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use loadframe_api::printable;
use loadframe_run::Progress;

use super::terminal::{print_error, span};

/// Steps of the bar; finer than any terminal is wide.
const STEPS: u64 = 1000;
/// Time between lines where no bar can be drawn.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Shows progress on standard error.
#[derive(Debug)]
pub(crate) struct ProgressDisplay {
    bar: ProgressBar,
    /// The last line said where no bar can be drawn, and when.
    last_line: Option<(String, Instant)>,
}

impl ProgressDisplay {
    pub(crate) fn start(title: &str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template(
            "{prefix:.bold}\n{bar:40.cyan/dim} {percent:>3} %  {wide_msg}",
        );
        if let Ok(style) = style {
            bar.set_style(style.progress_chars("━━╌"));
        }
        bar.set_prefix(printable(title).into_owned());
        // a thread of its own, which a bar that nobody sees does not need
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(500));
        }
        Self {
            bar,
            last_line: None,
        }
    }

    pub(crate) fn show(&mut self, progress: &Progress) {
        let left = progress.eta_s.filter(|left| *left >= 1.0);
        let left = left.map_or(String::new(), |left| {
            format!(", about {} to go", span(left))
        });
        let message = format!("{}{left}", printable(&progress.phase));
        if self.bar.is_hidden() {
            let line = format!("{:3.0} %  {message}", (100.0 * progress.fraction).floor());
            let last = self.last_line.as_ref();
            let is_due =
                last.is_none_or(|(last, said)| said.elapsed() >= LINE_EVERY && *last != line);
            if is_due && !progress.phase.is_empty() {
                print_error(&line);
                self.last_line = Some((line, Instant::now()));
            }
            return;
        }
        self.bar
            .set_position((progress.fraction * STEPS as f64) as u64);
        self.bar.set_message(message);
    }

    /// A line above the bar.
    pub(crate) fn log(&self, message: &str) {
        if self.bar.is_hidden() {
            print_error(message);
        } else {
            self.bar.println(message);
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(self) {
        self.bar.finish_and_clear();
    }
}
