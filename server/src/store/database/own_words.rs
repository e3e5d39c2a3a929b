//! What databases have no common words for, by names that all have.

/// What is said to each in words of its own.
#[derive(Debug)]
pub(in super::super) struct Texts {
    /// Numbers of the newest ?6 jobs before ?1 in the projects ?2 but for those of ?4, and those of ?3 but for
    /// projects ?5; newest first, with some twice.
    pub(in super::super) newest_seen: &'static str,
    /// The function that makes letters small.
    pub(in super::super) folded: &'static str,
    /// In the index of texts, `job_texts t`: the column with the numbers of jobs.
    pub(in super::super) number_of_text: &'static str,
    /// The condition on an entry of it for a text, which stands between these.
    pub(in super::super) text_found: [&'static str; 2],
    /// Whether it leads to jobs with that text alone, so that they need not be looked at.
    pub(in super::super) index_decides: bool,
    /// How texts of new jobs come into the index, where they do not by themselves.
    pub(in super::super) new_texts: Option<NewTexts>,
}

/// How texts of new jobs come into the index of texts.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct NewTexts {
    /// Whether there are any.
    pub(in super::super) are_there: &'static str,
    /// Takes in the next of them.
    pub(in super::super) index_some: &'static str,
}

/// A statement that a transaction may end with, ?1 its value.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct LastStatement {
    pub(in super::super) alone: &'static str,
    /// The same, and `COMMIT`.
    pub(in super::super) and_commit: &'static str,
}
