//! What a single job may take, where it is to run.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::calibration::Estimate;
use crate::problem::Violation;

/// How many times its estimate a job may take unless it says another number. Estimates of time are off by
/// a factor of two, on a busy machine of four.
pub const OVERRUN_FACTOR: f64 = 10.0;
/// No job is paused before it has taken so much: wall time [s], memory and files [MB]. Below this the
/// process itself and other work on the machine weigh as much as the job.
const LEAST: JobLimits = JobLimits {
    wall_s: 600.0,
    memory_mb: 500.0,
    disk_mb: 100.0,
};

/// What a job may take; beyond it, it is paused with its checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JobLimits {
    /// Wall time over all attempts [s].
    pub wall_s: f64,
    /// Memory [MB].
    pub memory_mb: f64,
    /// Size of all result files [MB].
    pub disk_mb: f64,
}

impl JobLimits {
    /// `factor` times the estimate, and never less than what every job may take.
    pub fn beyond(estimate: &Estimate, factor: f64) -> Self {
        Self {
            wall_s: LEAST.wall_s.max(factor * estimate.wall_s),
            memory_mb: LEAST.memory_mb.max(factor * estimate.memory_mb),
            disk_mb: LEAST.disk_mb.max(factor * estimate.disk_mb),
        }
    }

    /// A sentence about the first limit that `used` exceeds.
    pub fn exceeded_by(&self, used: &Self) -> Option<String> {
        let all = [
            ("s of wall time", used.wall_s, self.wall_s),
            ("MB of memory", used.memory_mb, self.memory_mb),
            ("MB of files", used.disk_mb, self.disk_mb),
        ];
        let beyond = all.into_iter().find(|(_, used, limit)| used > limit);
        beyond.map(|(what, used, limit)| {
            format!("it has taken {used:.0} {what}, where {limit:.0} is its limit")
        })
    }
}

/// What a single job may take: of a server, or of a machine without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    pub wall_s: f64,
    pub memory_mb: f64,
    pub disk_mb: f64,
}

/// An estimate beyond its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// Of what: time, memory, disk.
    pub resource: &'static str,
    pub estimate: f64,
    pub limit: f64,
    pub unit: &'static str,
}

impl Limits {
    /// No limits.
    pub const NONE: Self = Self {
        wall_s: f64::INFINITY,
        memory_mb: f64::INFINITY,
        disk_mb: f64::INFINITY,
    };

    /// What of the estimate exceeds the limits.
    pub fn exceeded(&self, estimate: &Estimate) -> Vec<Excess> {
        let all = [
            ("time", estimate.wall_s, self.wall_s, "s"),
            ("memory", estimate.memory_mb, self.memory_mb, "MB"),
            ("disk", estimate.disk_mb, self.disk_mb, "MB"),
        ];
        let all = all.map(|(resource, estimate, limit, unit)| Excess {
            resource,
            estimate,
            limit,
            unit,
        });
        // an estimate that is not a number is beyond every limit
        let is_beyond =
            |excess: &Excess| excess.estimate.is_nan() || excess.estimate > excess.limit;
        all.into_iter().filter(is_beyond).collect()
    }

    /// Refuses a job whose estimate exceeds the limits.
    pub fn violations(&self, estimate: &Estimate) -> Vec<Violation> {
        let exceeded = self.exceeded(estimate).into_iter();
        let violation = |excess: Excess| {
            let Excess {
                resource,
                estimate,
                limit,
                unit,
            } = excess;
            let detail = format!(
                "the job would need about {estimate:.3e} {unit} of {resource}; make it smaller or ask for higher limits"
            );
            Violation::new("/spec", "too_expensive", detail)
                .value(estimate)
                .allowed(format!("≤ {limit}"))
                .unit(unit)
        };
        exceeded.map(violation).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_may_take_ten_times_its_estimate_and_a_little_is_always_free() {
        let estimate = Estimate {
            wall_s: 3600.0,
            memory_mb: 80.0,
            disk_mb: 0.1,
            calibrated: true,
            threads_wall_s: None,
            sharing: crate::Sharing::ALONE,
        };
        let limits = JobLimits::beyond(&estimate, OVERRUN_FACTOR);
        // 10 · 3600 s and 10 · 80 MB; 1 MB of files is less than the 100 that are free
        assert_eq!(
            limits,
            JobLimits {
                wall_s: 36_000.0,
                memory_mb: 800.0,
                disk_mb: 100.0
            }
        );
        assert_eq!(limits.exceeded_by(&limits), None);
        let used = JobLimits {
            memory_mb: 801.0,
            ..limits
        };
        assert_eq!(
            limits.exceeded_by(&used).expect("one MB more"),
            "it has taken 801 MB of memory, where 800 is its limit"
        );
    }

    #[test]
    fn only_what_is_beyond_its_limit_is_named() {
        let estimate = Estimate {
            wall_s: 10.0,
            memory_mb: 35_000.0,
            disk_mb: 1.0,
            calibrated: false,
            threads_wall_s: None,
            sharing: crate::Sharing::ALONE,
        };
        assert_eq!(Limits::NONE.exceeded(&estimate), []);
        let limits = Limits {
            memory_mb: 21_000.0,
            ..Limits::NONE
        };
        let exceeded = limits.exceeded(&estimate);
        assert_eq!(exceeded.len(), 1);
        assert_eq!(exceeded[0].resource, "memory");
        let violations = limits.violations(&estimate);
        assert_eq!(violations.len(), 1);
        assert!(violations[0].detail.contains("3.500e4 MB of memory"));
    }
}
