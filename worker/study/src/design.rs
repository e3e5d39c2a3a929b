//! What a study is: settings to be tested, and what is made of the finished tests.
use std::io;
use std::path::Path;

use loadframe_run::Engine;
use serde::Serialize;

use crate::runs_file::Finished;
use crate::settings::Settings;

/// What a study tests, and what it makes of that.
pub trait Design {
    type Findings: Findings;

    fn settings(&self) -> &Settings;

    /// A setting in words, for messages.
    fn describe(&self, setting: usize) -> String;

    /// `finished`: the tests of each setting in the order of the seeds.
    fn findings(&self, engine: Engine, finished: &[Vec<Finished>]) -> Self::Findings;
}

/// The result of a study.
pub trait Findings: Serialize {
    /// Names of the files that [`Self::write`] leaves.
    const FILES: &[&str];

    /// What is in each of [`Self::FILES`].
    ///
    /// # Errors
    /// When something cannot be written as text.
    fn contents(&self) -> io::Result<Vec<Vec<u8>>>;

    /// Writes its files into `folder`.
    ///
    /// # Errors
    /// When a file cannot be written.
    fn write(&self, folder: &Path) -> io::Result<()> {
        let mut files = Self::FILES.iter().zip(self.contents()?);
        files.try_for_each(|(name, content)| std::fs::write(folder.join(name), content))
    }

    /// Tables and sentences for a terminal.
    fn text(&self) -> String;

    /// Processor time of all tests [s].
    fn total_cpu_s(&self) -> f64;
}
