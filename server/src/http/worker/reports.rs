//! The latest reports of allocations.
//!
//! They are kept in memory: they are news, repeated every half minute by whoever has them.
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use loadframe_api::Timestamp;
use loadframe_api::allocations::{AllocationReport, ReportedAllocations};

/// A report is forgotten after so long [ms].
const REMEMBERED: i64 = 600_000;
/// Sources whose reports are kept; beyond it the one silent for longest is forgotten.
const MOST_SOURCES: usize = 50;

/// The latest report of every source.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Reports(Arc<Mutex<BTreeMap<String, ReportedAllocations>>>);

impl Reports {
    pub(super) fn take(&self, report: AllocationReport, now: Timestamp) {
        let mut reports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let latest = ReportedAllocations {
            source: report.source.clone(),
            reported_at: now,
            allocations: report.allocations,
            trouble: report.trouble,
        };
        reports.insert(report.source, latest);
        if reports.len() > MOST_SOURCES
            && let Some(oldest) = reports.values().min_by_key(|report| report.reported_at)
        {
            let oldest = oldest.source.clone();
            reports.remove(&oldest);
        }
    }

    pub(super) fn latest(&self, now: Timestamp) -> Vec<ReportedAllocations> {
        let mut reports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        reports.retain(|_, report| now.0 - report.reported_at.0 < REMEMBERED);
        reports.values().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::allocations::AllocationView;

    fn report(source: &str, state: &str) -> AllocationReport {
        AllocationReport {
            source: source.to_owned(),
            allocations: vec![AllocationView {
                id: "7_0".to_owned(),
                state: state.to_owned(),
                reason: None,
            }],
            trouble: None,
        }
    }

    #[test]
    fn a_report_takes_the_place_of_the_one_before_and_is_forgotten_in_time() {
        let reports = Reports::default();
        reports.take(report("slurm on a", "PENDING"), Timestamp(0));
        reports.take(report("slurm on b", "PENDING"), Timestamp(1));
        reports.take(report("slurm on a", "RUNNING"), Timestamp(2));
        let latest = reports.latest(Timestamp(3));
        let states: Vec<&str> = latest
            .iter()
            .map(|report| report.allocations[0].state.as_str())
            .collect();
        assert_eq!(states, ["RUNNING", "PENDING"]);
        let later = reports.latest(Timestamp(REMEMBERED + 1));
        assert_eq!(later.len(), 1, "{later:?}");
    }

    #[test]
    fn sources_are_bounded() {
        let reports = Reports::default();
        for number in 0..200 {
            reports.take(report(&number.to_string(), "PENDING"), Timestamp(number));
        }
        let latest = reports.latest(Timestamp(200));
        assert_eq!(latest.len(), MOST_SOURCES);
        assert!(latest.iter().all(|report| report.reported_at.0 >= 150));
    }
}
