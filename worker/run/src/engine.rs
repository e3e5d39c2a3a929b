//! Which build of loadframe computes.

/// Version and commit of the engine, as in `provenance`. The executable that puts everything
/// together knows them and hands them on; nothing else asks, so that a commit rebuilds nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Engine {
    /// Results of one job come from one version.
    pub version: &'static str,
    pub commit: &'static str,
}

impl Engine {
    /// Version and commit as one word, the commit as what semantic versions call build metadata.
    pub fn build(&self) -> String {
        format!("{}+{}", self.version, self.commit)
    }
}
