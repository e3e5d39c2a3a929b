//! Curve points and log lines on their way to the server, gathered into reports.
use loadframe_api::worker::{CurveBlock, ProgressReport};

use loadframe_run::Progress;

/// A report goes out at the latest with so many numbers: some hundred kilobytes of JSON.
const NUMBERS: usize = 20_000;
/// and with so many points or log lines, which the server bounds.
const ENTRIES: usize = 1000;
/// Longest phase the server takes, in characters.
const PHASE_LENGTH: usize = 500;

/// What has not been reported yet.
#[derive(Debug, Default)]
pub(super) struct Batch {
    columns: Vec<String>,
    /// Points of the curve so far.
    points: u64,
    /// So many first points of a curve the server has already.
    known: u64,
    rows: Vec<Vec<f64>>,
    log: Vec<String>,
    /// Log lines reported before.
    logged: u64,
}

impl Batch {
    /// For an attempt of whose curve the server has so many points.
    pub(super) fn after(known: u64) -> Self {
        Self {
            known,
            ..Self::default()
        }
    }

    /// A curve begins, or begins anew.
    pub(super) fn columns(&mut self, columns: Vec<String>) {
        self.columns = columns;
        self.points = 0;
        self.rows.clear();
    }

    /// Takes in points, one after the other in one list of numbers.
    pub(super) fn points(&mut self, numbers: &[f64]) {
        for row in numbers.chunks(self.columns.len().max(1)) {
            if self.points >= self.known {
                self.rows.push(row.to_vec());
            }
            self.points += 1;
        }
    }

    pub(super) fn log(&mut self, message: String) {
        self.log.push(message);
    }

    /// Whether the next report should not wait.
    pub(super) fn is_full(&self) -> bool {
        self.rows.len() * self.columns.len() >= NUMBERS
            || self.rows.len().max(self.log.len()) >= ENTRIES
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.log.is_empty()
    }

    /// Everything gathered, as a report; what comes next starts where this ends.
    pub(super) fn take(&mut self, progress: &Progress) -> ProgressReport {
        let rows = std::mem::take(&mut self.rows);
        let first = self.points - rows.len() as u64;
        let log = std::mem::take(&mut self.log);
        let log_from = self.logged;
        self.logged += log.len() as u64;
        ProgressReport {
            progress: progress.fraction,
            phase: progress.phase.chars().take(PHASE_LENGTH).collect(),
            eta_s: progress.eta_s,
            points: (!rows.is_empty()).then(|| CurveBlock {
                columns: self.columns.clone(),
                first,
                rows,
            }),
            log,
            log_from: Some(log_from),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(columns: usize) -> Batch {
        let mut batch = Batch::default();
        batch.columns((0..columns).map(|column| format!("c{column}")).collect());
        batch
    }

    fn first_and_count(batch: &mut Batch) -> Option<(u64, usize)> {
        let block = batch.take(&Progress::default()).points?;
        Some((block.first, block.rows.len()))
    }

    #[test]
    fn blocks_follow_each_other_without_a_gap() {
        let mut batch = batch(1);
        (0..3).for_each(|index| batch.points(&[f64::from(index)]));
        assert_eq!(first_and_count(&mut batch), Some((0, 3)));
        assert_eq!(first_and_count(&mut batch), None);
        batch.points(&[3.0]);
        assert_eq!(first_and_count(&mut batch), Some((3, 1)));
    }

    #[test]
    fn a_curve_that_begins_anew_counts_from_zero_and_forgets_unsent_points() {
        let mut batch = batch(1);
        batch.points(&[0.0]);
        let _ = batch.take(&Progress::default());
        batch.points(&[1.0]);
        batch.columns(vec!["strain".to_owned()]);
        batch.points(&[0.0]);
        assert_eq!(first_and_count(&mut batch), Some((0, 1)));
    }

    #[test]
    fn points_that_the_server_has_are_not_sent_again() {
        let mut batch = Batch::after(3);
        batch.columns(vec!["strain".to_owned()]);
        batch.points(&[0.0, 1.0]);
        assert_eq!(first_and_count(&mut batch), None);
        batch.points(&[2.0, 3.0, 4.0]);
        assert_eq!(first_and_count(&mut batch), Some((3, 2)));
        batch.points(&[5.0]);
        assert_eq!(first_and_count(&mut batch), Some((5, 1)));
    }

    #[test]
    fn wide_points_fill_a_batch_sooner() {
        let mut wide = batch(200);
        (0..99).for_each(|_| wide.points(&[0.0; 200]));
        assert!(!wide.is_full());
        wide.points(&[0.0; 200]);
        assert!(wide.is_full());
        let mut narrow = batch(1);
        (0..ENTRIES).for_each(|_| narrow.points(&[0.0]));
        assert!(narrow.is_full());
    }

    #[test]
    fn a_report_carries_log_and_progress_once() {
        let mut batch = batch(1);
        batch.log("a".to_owned());
        let progress = Progress {
            fraction: 0.5,
            phase: "é".repeat(600),
            eta_s: Some(2.0),
        };
        let report = batch.take(&progress);
        assert_eq!(
            (report.log, report.log_from),
            (vec!["a".to_owned()], Some(0))
        );
        assert_eq!(report.phase.chars().count(), PHASE_LENGTH);
        assert!(report.points.is_none());
        let next = batch.take(&progress);
        assert_eq!((next.log, next.log_from), (vec![], Some(1)));
    }
}
