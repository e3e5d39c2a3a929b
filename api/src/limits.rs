//! What a single job may take, where it is to run.
use crate::calibration::Estimate;
use crate::problem::Violation;

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
    fn only_what_is_beyond_its_limit_is_named() {
        let estimate = Estimate {
            wall_s: 10.0,
            memory_mb: 35_000.0,
            disk_mb: 1.0,
            calibrated: false,
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
