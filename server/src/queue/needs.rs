//! What a job needs of a machine, and what of it a machine lacks.
//!
//! Needs are rounded up to two digits, so that jobs alike wait in one line. Time is that of a core of the
//! reference speed ([`Calibration::default`]): a machine's own speed turns what it has left into it.
use loadframe_api::worker::ClaimRequest;
use loadframe_api::{Calibration, Estimate, JobKind};

/// Speeds that a core can have [bond evaluations/s]: a hundredth to a hundred times a core of 2020.
const SPEEDS: std::ops::RangeInclusive<f64> = 1e6..=1e10;
/// Rounded needs are at least this [MB].
const LEAST_MB: f64 = 10.0;
/// Beyond it, numbers are taken for this [MB, s].
const MOST: f64 = 1e12;
/// Checkpoints are at most so far apart [s]: who has less time left may work in vain.
pub const CHECKPOINTS_APART_S: f64 = 60.0;

/// What a worker must have for a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Needs {
    pub memory_mb: i64,
    /// Room for its files.
    pub disk_mb: i64,
    /// Time in one go on a core of the reference speed [s].
    pub core_s: i64,
    pub threads: u32,
    /// The version that wrote its spec down, as [`release`] gives it.
    pub release: u32,
}

/// What a worker has; `None` is not known, and lacks nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    pub kinds: Vec<JobKind>,
    pub memory_mb: Option<f64>,
    pub disk_mb: Option<f64>,
    /// Time left, on a core of the reference speed [s].
    pub core_s: Option<f64>,
    pub threads: u32,
    pub release: Option<u32>,
}

/// What a machine lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Lack {
    Kind,
    Release,
    Threads,
    Memory,
    Disk,
    Time,
}

impl Needs {
    /// Those of a job by its estimate, made at `speed`, on a machine with the threads it asks for.
    pub fn of(
        kind: JobKind,
        estimate: &Estimate,
        speed: Calibration,
        threads: Option<u32>,
        version: &str,
    ) -> Self {
        let slowness = speed.bond_evaluations_per_s / Calibration::default().bond_evaluations_per_s;
        let whole = estimate.threads_wall_s.unwrap_or(estimate.wall_s) * slowness;
        let in_one_go = if kind.is_resumable() {
            whole.min(CHECKPOINTS_APART_S)
        } else {
            whole
        };
        Self {
            memory_mb: rounded_up(estimate.memory_mb.max(LEAST_MB)),
            disk_mb: rounded_up(estimate.disk_mb.max(LEAST_MB)),
            core_s: rounded_up(in_one_go.max(1.0)),
            threads: threads.unwrap_or(1),
            release: release(version).unwrap_or(0),
        }
    }

    /// What a machine lacks for a job of this kind.
    pub fn lacks(&self, kind: JobKind, offer: &Offer) -> Vec<Lack> {
        let is_short = |has: Option<f64>, need: i64| has.is_some_and(|has| has < need as f64);
        let all = [
            (Lack::Kind, !offer.kinds.contains(&kind)),
            (
                Lack::Release,
                offer.release.is_some_and(|has| has < self.release),
            ),
            (Lack::Threads, offer.threads < self.threads),
            (Lack::Memory, is_short(offer.memory_mb, self.memory_mb)),
            (Lack::Disk, is_short(offer.disk_mb, self.disk_mb)),
            (Lack::Time, is_short(offer.core_s, self.core_s)),
        ];
        let lacking = all.into_iter().filter(|(_, is_lacking)| *is_lacking);
        lacking.map(|(lack, _)| lack).collect()
    }
}

impl Offer {
    /// What the worker of a claim has.
    pub fn of(claim: &ClaimRequest) -> Self {
        Self {
            kinds: claim.kinds.clone(),
            memory_mb: claim.memory_mb,
            disk_mb: claim.disk_mb,
            core_s: core_seconds(claim.time_left_s, believed(claim.calibration)),
            threads: claim.threads,
            release: release(&claim.engine_version),
        }
    }
}

/// What a machine says of its speed, where a machine can have it.
pub fn believed(speed: Option<Calibration>) -> Option<Calibration> {
    speed.filter(|speed| SPEEDS.contains(&speed.bond_evaluations_per_s))
}

/// Time left [s] of a machine of this speed, on a core of the reference speed.
pub fn core_seconds(time_left_s: Option<f64>, speed: Option<Calibration>) -> Option<f64> {
    let reference = Calibration::default();
    let speed = speed.unwrap_or(reference);
    let factor = speed.bond_evaluations_per_s / reference.bond_evaluations_per_s;
    time_left_s.map(|left| left.max(0.0) * factor)
}

/// Two digits, upwards: 14 321 is 15 000. What is no number needs more than any machine has.
fn rounded_up(value: f64) -> i64 {
    if !value.is_finite() || value >= MOST {
        return MOST as i64;
    }
    let mut unit = 1.0;
    while value > 99.0 * unit {
        unit *= 10.0;
    }
    ((value / unit).ceil() * unit) as i64
}

/// A version as a number that grows with it, without what follows `+` or `-`; `None` for a text that is none.
pub fn release(version: &str) -> Option<u32> {
    let numbers = version.split(['+', '-']).next()?;
    let mut parts = numbers.split('.').map(|part| part.parse::<u32>().ok());
    let (major, minor, patch) = (parts.next()??, parts.next()??, parts.next()??);
    let fits = major < 4000 && minor < 1000 && patch < 1000 && parts.next().is_none();
    fits.then_some(major * 1_000_000 + minor * 1_000 + patch)
}

/// The version of a [`release`].
pub fn version(release: u32) -> String {
    let (major, rest) = (release / 1_000_000, release % 1_000_000);
    format!("{major}.{}.{}", rest / 1_000, rest % 1_000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::Sharing;

    const ESTIMATE: Estimate = Estimate {
        wall_s: 7200.0,
        memory_mb: 14_321.0,
        disk_mb: 3.0,
        calibrated: true,
        threads_wall_s: None,
        sharing: Sharing::ALONE,
    };

    fn offer() -> Offer {
        Offer {
            kinds: JobKind::ALL.to_vec(),
            memory_mb: Some(16_000.0),
            disk_mb: Some(50.0),
            core_s: Some(90.0),
            threads: 4,
            release: Some(2_000),
        }
    }

    #[test]
    fn needs_are_rounded_up_and_time_is_that_between_checkpoints_where_there_are_any() {
        let fast = Calibration {
            bond_evaluations_per_s: 2.0e8,
        };
        let of = |kind| Needs::of(kind, &ESTIMATE, fast, Some(2), "0.2.0");
        let needs = of(JobKind::GranularScene);
        // 14 321 is 15 000 in two digits; 3 MB count as 10
        assert_eq!((needs.memory_mb, needs.disk_mb), (15_000, 10));
        assert_eq!((needs.core_s, needs.threads, needs.release), (60, 2, 2_000));
        // 2 h at twice the reference speed are 4 h of the reference core, 14 400 s
        assert_eq!(of(JobKind::CompositeCell).core_s, 15_000);
        assert_eq!(
            [10.0, 99.0, 99.1, 101.0].map(rounded_up),
            [10, 99, 100, 110]
        );
        assert_eq!([f64::NAN, 1e300].map(rounded_up), [1_000_000_000_000; 2]);
    }

    #[test]
    fn a_machine_lacks_exactly_what_it_has_too_little_of() {
        let kind = JobKind::GranularScene;
        let needs = Needs::of(kind, &ESTIMATE, Calibration::default(), None, "0.2.0");
        assert_eq!(needs.lacks(kind, &offer()), []);
        let poor = Offer {
            kinds: vec![JobKind::Calibrate],
            memory_mb: Some(14_999.0),
            disk_mb: Some(9.0),
            core_s: Some(59.0),
            threads: 0,
            release: Some(1_009),
        };
        let all = [
            Lack::Kind,
            Lack::Release,
            Lack::Threads,
            Lack::Memory,
            Lack::Disk,
            Lack::Time,
        ];
        assert_eq!(needs.lacks(kind, &poor), all);
        let unknown = Offer {
            memory_mb: None,
            disk_mb: None,
            core_s: None,
            release: None,
            ..offer()
        };
        assert_eq!(needs.lacks(kind, &unknown), []);
    }

    #[test]
    fn versions_grow_as_their_numbers_do() {
        assert_eq!(release("0.2.0+1234abc"), Some(2_000));
        assert_eq!(release("1.12.3-rc.1"), Some(1_012_003));
        assert!(release("0.10.0") > release("0.9.9"));
        assert_eq!(version(1_012_003), "1.12.3");
        for no_version in ["", "1", "bench", "1.2", "1.2.3.4", "1.1000.0"] {
            assert_eq!(release(no_version), None, "{no_version}");
        }
    }
}
