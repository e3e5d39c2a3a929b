//! What a study tests.
use indexmap::IndexMap;
use loadframe_api::{Calibration, Estimate, JobSpec, Sharing};

/// The settings of a study, equal ones once, each with the same seeds.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The spec at each setting, by its SHA-256 with the study's first seed.
    specs: IndexMap<String, JobSpec>,
    seeds: Vec<u64>,
    /// Makes a spec that of a test with a seed.
    seeded: fn(&JobSpec, u64) -> JobSpec,
}

impl Settings {
    /// No settings yet, to be tested with so many seeds from that of `spec` on.
    pub(super) fn new(spec: &JobSpec, seeds: u32, seeded: fn(&JobSpec, u64) -> JobSpec) -> Self {
        let seeds = (0..u64::from(seeds.max(1))).map(|index| spec.seed().saturating_add(index));
        Self {
            specs: IndexMap::new(),
            seeds: seeds.collect(),
            seeded,
        }
    }

    /// The number of this setting, which is new or there already.
    pub(super) fn add(&mut self, spec: &JobSpec) -> usize {
        let spec = (self.seeded)(spec, self.seeds[0]);
        self.specs.insert_full(spec.sha256(), spec).0
    }

    pub(super) fn len(&self) -> usize {
        self.specs.len()
    }

    pub(super) fn seeds(&self) -> &[u64] {
        &self.seeds
    }

    /// SHA-256 and spec of a setting with the first seed.
    pub(super) fn get(&self, setting: usize) -> (&str, &JobSpec) {
        let found = self.specs.get_index(setting);
        let (sha256, spec) = found.unwrap_or_else(|| unreachable!("settings are numbered by add"));
        (sha256, spec)
    }

    /// The spec of the test of a setting with a seed.
    pub(super) fn test(&self, setting: usize, seed: u64) -> JobSpec {
        (self.seeded)(self.get(setting).1, seed)
    }

    /// What the study takes with so many tests side by side, each as large as the largest: time on
    /// one core, and memory.
    pub fn estimate(&self, threads: usize) -> Estimate {
        let calibration = Calibration::default();
        let tests = self.specs.values().map(|spec| spec.estimate(&calibration));
        let none = Estimate {
            wall_s: 0.0,
            memory_mb: 0.0,
            // a test of a study writes no files of its own
            disk_mb: 0.0,
            calibrated: false,
            threads_wall_s: None,
            sharing: Sharing::ALONE,
        };
        let seeds = self.seeds.len() as f64;
        let side_by_side = threads.clamp(1, self.tests().max(1)) as f64;
        tests.fold(none, |all, test| Estimate {
            wall_s: all.wall_s + seeds * test.wall_s,
            memory_mb: all.memory_mb.max(side_by_side * test.memory_mb),
            ..all
        })
    }

    /// Tests it takes.
    pub fn tests(&self) -> usize {
        self.specs.len() * self.seeds.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::{JobKind, Submission};

    #[test]
    fn a_study_needs_the_memory_of_the_largest_tests_that_run_side_by_side() {
        let [large, small] = [0, 1].map(|example| {
            let body = JobKind::NonwovenTensile.examples()[example].body;
            let submission = Submission::from_slice(body.as_bytes());
            submission.expect("a valid example").spec.single(1)
        });
        let mut settings = Settings::new(&small, 3, JobSpec::single);
        settings.add(&small);
        settings.add(&large);
        let alone = large.estimate(&Calibration::default()).memory_mb;
        for (threads, tests) in [(1, 1.0), (4, 4.0), (100, 6.0)] {
            let needed = settings.estimate(threads).memory_mb;
            assert!((needed / alone - tests).abs() < 1e-12, "{needed}");
        }
    }
}
