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
    /// Index of the first row in the curve.
    first: u64,
    rows: Vec<Vec<f64>>,
    log: Vec<String>,
    /// Log lines reported before.
    logged: u64,
}

impl Batch {
    /// A curve begins, or begins anew.
    pub(super) fn columns(&mut self, columns: Vec<String>) {
        self.columns = columns;
        self.first = 0;
        self.rows.clear();
    }

    pub(super) fn point(&mut self, row: Vec<f64>) {
        self.rows.push(row);
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
        let first = self.first;
        self.first += rows.len() as u64;
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
        (0..3).for_each(|index| batch.point(vec![f64::from(index)]));
        assert_eq!(first_and_count(&mut batch), Some((0, 3)));
        assert_eq!(first_and_count(&mut batch), None);
        batch.point(vec![3.0]);
        assert_eq!(first_and_count(&mut batch), Some((3, 1)));
    }

    #[test]
    fn a_curve_that_begins_anew_counts_from_zero_and_forgets_unsent_points() {
        let mut batch = batch(1);
        batch.point(vec![0.0]);
        let _ = batch.take(&Progress::default());
        batch.point(vec![1.0]);
        batch.columns(vec!["strain".to_owned()]);
        batch.point(vec![0.0]);
        assert_eq!(first_and_count(&mut batch), Some((0, 1)));
    }

    #[test]
    fn wide_points_fill_a_batch_sooner() {
        let mut wide = batch(200);
        (0..99).for_each(|_| wide.point(vec![0.0; 200]));
        assert!(!wide.is_full());
        wide.point(vec![0.0; 200]);
        assert!(wide.is_full());
        let mut narrow = batch(1);
        (0..ENTRIES).for_each(|_| narrow.point(vec![0.0]));
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
