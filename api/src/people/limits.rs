//! How much a person may use, has used, and may still.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Estimate, Violation};

/// `PUT /v1/people/{id}/limits`: what a person may use; what is left out has no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PersonLimits {
    /// Jobs that run at once; further ones wait.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub running: Option<u32>,
    /// Estimated time of all queued jobs [core h].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub queued_core_h: Option<f64>,
    /// Files of all jobs [GB].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub disk_gb: Option<f64>,
    /// Whether the person may give jobs a priority above 0; administrators may in any case.
    pub may_hurry: bool,
}

/// What a person uses now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PersonUse {
    pub running: u32,
    /// Estimated time of all queued jobs [core h].
    pub queued_core_h: f64,
    /// Files and checkpoints of all jobs [GB].
    pub disk_gb: f64,
    /// What was computed lately [core h], of which half counts a day later: who has used less goes first.
    pub recent_core_h: f64,
}

/// Answer to `GET /v1/me/limits`, and part of a dry run: limits, use, and what is left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Allowance {
    pub limits: PersonLimits,
    pub used: PersonUse,
    pub left: PersonLeft,
}

/// What a person may still use; `null` has no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PersonLeft {
    pub running: Option<u32>,
    /// [core h]
    pub queued_core_h: Option<f64>,
    /// [GB]
    pub disk_gb: Option<f64>,
}

impl Allowance {
    /// Of these limits and this use.
    pub fn of(limits: PersonLimits, used: PersonUse) -> Self {
        let left = |limit: Option<f64>, used: f64| limit.map(|limit| (limit - used).max(0.0));
        Self {
            limits,
            used,
            left: PersonLeft {
                running: limits.running.map(|most| most.saturating_sub(used.running)),
                queued_core_h: left(limits.queued_core_h, used.queued_core_h),
                disk_gb: left(limits.disk_gb, used.disk_gb),
            },
        }
    }

    /// Why a job of this priority and estimate is not taken.
    pub fn violations(&self, priority: i32, estimate: &Estimate) -> Vec<Violation> {
        let mut violations: Vec<Violation> = self.hurry(priority).into_iter().collect();
        let asked = [
            (
                "queued_core_h",
                "queued jobs",
                self.limits.queued_core_h,
                self.used.queued_core_h,
                estimate.wall_s / 3600.0,
                "core h",
            ),
            (
                "disk_gb",
                "files",
                self.limits.disk_gb,
                self.used.disk_gb,
                estimate.disk_mb / 1000.0,
                "GB",
            ),
        ];
        for (name, what, limit, used, wanted, unit) in asked {
            let Some(limit) = limit else { continue };
            if used + wanted <= limit {
                continue;
            }
            let detail = format!(
                "the limit {name} of {limit} {unit} would be exceeded: your {what} take {used:.3} {unit}, and this job is estimated at {wanted:.3} {unit} more"
            );
            let left = (limit - used).max(0.0);
            violations.push(
                Violation::new("/spec", "person_limit", detail)
                    .value(wanted)
                    .allowed(format!("≤ {left:.3}"))
                    .unit(unit),
            );
        }
        violations
    }

    /// Why a job is not given this priority.
    pub fn hurry(&self, priority: i32) -> Option<Violation> {
        if priority <= 0 || self.limits.may_hurry {
            return None;
        }
        let detail = "a priority above 0 is a right that an administrator gives";
        Some(
            Violation::new("/priority", "no_right_to_hurry", detail)
                .value(priority)
                .allowed("≤ 0"),
        )
    }
}

impl PersonLimits {
    /// Why these limits are not set for somebody who uses so much.
    pub fn violations(&self, used: &PersonUse) -> Vec<Violation> {
        let Some(limit) = self.disk_gb.filter(|limit| *limit < used.disk_gb) else {
            return Vec::new();
        };
        let detail = format!(
            "{limit} GB are below the {:.3} GB that the person's files take; files have to be deleted first",
            used.disk_gb
        );
        let violation = Violation::new("/disk_gb", "below_use", detail).value(limit);
        vec![
            violation
                .allowed(format!("≥ {:.3}", used.disk_gb))
                .unit("GB"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const USED: PersonUse = PersonUse {
        running: 5,
        queued_core_h: 9.5,
        disk_gb: 2.0,
        recent_core_h: 1.0,
    };
    const ESTIMATE: Estimate = Estimate {
        wall_s: 3600.0,
        memory_mb: 10.0,
        disk_mb: 500.0,
        calibrated: true,
        threads_wall_s: None,
        sharing: crate::Sharing::ALONE,
    };

    #[test]
    fn a_job_beyond_a_limit_is_refused_with_limit_value_and_use() {
        let limits = PersonLimits {
            running: Some(4),
            queued_core_h: Some(10.0),
            disk_gb: Some(2.5),
            may_hurry: false,
        };
        let allowance = Allowance::of(limits, USED);
        assert_eq!(allowance.left.running, Some(0));
        assert_eq!(allowance.left.queued_core_h, Some(0.5));
        // 2 GB and 0.5 GB are the limit; 9.5 h and 1 h are beyond
        let violations = allowance.violations(0, &ESTIMATE);
        assert_eq!(violations.len(), 1);
        assert_eq!(
            violations[0].to_string(),
            "/spec: the limit queued_core_h of 10 core h would be exceeded: your queued jobs take 9.500 core h, and this job is estimated at 1.000 core h more (given 1.0); allowed: ≤ 0.500 core h"
        );
        assert_eq!(Allowance::default().violations(0, &ESTIMATE), []);
    }

    #[test]
    fn priority_above_normal_is_a_right() {
        let codes = |may_hurry, priority| {
            let limits = PersonLimits {
                may_hurry,
                ..PersonLimits::default()
            };
            let violations = Allowance::of(limits, USED).violations(priority, &ESTIMATE);
            violations.into_iter().map(|of| of.code).collect::<Vec<_>>()
        };
        assert_eq!(codes(false, 1), ["no_right_to_hurry"]);
        assert!(codes(false, 0).is_empty() && codes(false, -5).is_empty());
        assert!(codes(true, 1000).is_empty());
    }

    #[test]
    fn a_disk_limit_below_what_is_used_is_refused() {
        let of = |disk_gb| PersonLimits {
            disk_gb: Some(disk_gb),
            ..PersonLimits::default()
        };
        assert_eq!(of(2.0).violations(&USED), []);
        let refused = of(1.5).violations(&USED);
        assert_eq!(refused[0].pointer, "/disk_gb");
        assert!(refused[0].detail.contains("2.000 GB"), "{refused:?}");
    }
}
