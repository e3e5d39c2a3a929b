//! What a study tests.
use indexmap::IndexMap;
use loadframe_api::JobSpec;

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

    /// Tests it takes.
    pub fn tests(&self) -> usize {
        self.specs.len() * self.seeds.len()
    }
}
