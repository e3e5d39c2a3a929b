//! Lists of jobs: which statement finds a page quickly, whatever it is filtered by.
//!
//! A page walks one index from its newest entry on and looks at each job until it is full. Which one
//! decides how many jobs are looked at in vain. Where only some hundred have the status, outcome, kind
//! or tag asked for, these are walked; else what is searched for; else the tag; else the status,
//! outcome and kind; and without any of them the jobs themselves.
use loadframe_api::{JobKind, JobView, Page, Timestamp};
use uuid::Uuid;

use super::database::{Builder, Connection, Texts};
use super::encoding::{json, wire_name};
use super::error::{Result, StoreError};
use super::jobs::{JobRow, SELECT_JOBS, hex_names, readable};
use super::{JobFilter, Store};
use crate::access::Sight;

/// Longest page of a list.
pub(super) const LONGEST_PAGE: u32 = 1000;
/// So many jobs are looked at one by one: a page's work, whatever else is asked of them.
const FEW: i64 = 500;
/// Where a moment parts the jobs, so many are passed over without asking where it does.
const PASSED_OVER: i64 = 20_000;
/// Texts are found by any three neighbouring characters of theirs; shorter ones by looking at all.
const SHORTEST_FOUND: usize = 3;
/// So many hexadecimal digits may begin an id: fewer are those of the moment, which many share.
const SHORTEST_ID: usize = 8;

/// A filter in the database's words.
struct Words {
    status: Option<String>,
    outcome: Option<String>,
    kind: Option<&'static str>,
    tag: Option<String>,
    text: Option<Text>,
    after: Option<Moment>,
    before: Option<Moment>,
    sight: Option<Sight>,
    /// Projects whose jobs are seen, and those whose are not, as JSON.
    seen_projects: String,
    unseen_projects: String,
    /// Jobs that are seen one by one, as JSON.
    seen_jobs: String,
    project: Option<Uuid>,
}

/// A moment, and whether the numbers of the jobs after or before it are worth asking for.
#[derive(Clone, Copy)]
struct Moment {
    at: i64,
    bounds_numbers: bool,
}

/// What is searched for.
struct Text {
    /// As typed, in small letters.
    typed: String,
    /// For the index of texts, if it can find it.
    phrase: Option<String>,
    /// First and last id that begin so, if enough of it is given.
    ids: Option<[Uuid; 2]>,
    texts: &'static Texts,
}

/// What a page walks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Walk {
    /// The jobs themselves, by their status, outcome or kind where these are asked for.
    Jobs,
    Tag,
    Text,
}

impl Store {
    /// Jobs that pass the filter, newest first; `cursor` is the `next` of the page before.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] for a cursor that was never given out.
    pub async fn jobs(
        &self,
        filter: &JobFilter,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        let limit = limit.clamp(1, LONGEST_PAGE);
        let before = number_of(cursor)?;
        let rows = match &filter.sight {
            // a page of what one sees is merged from that of each part
            Some(sight) if !sight.everything && filter.narrows_nothing_else() => {
                let newest = self.newest_seen(sight, before.unwrap_or(i64::MAX), limit + 1);
                let mut query = Builder::new(SELECT_JOBS);
                query.push("jobs j WHERE j.seq IN (SELECT CAST(value AS BIGINT) FROM json_each(");
                query.push_bind(json(&newest.await?)?);
                query.push(")) ORDER BY j.seq DESC");
                query.build_query_as().fetch_all(self.reads()).await?
            }
            _ => self.filtered(filter, before, limit + 1).await?,
        };
        Ok(page_of(rows, limit))
    }

    /// Numbers of the next `limit` jobs before number `before` that pass the filter, newest first.
    pub(super) async fn numbers(
        &self,
        filter: &JobFilter,
        before: Option<i64>,
        limit: u32,
    ) -> Result<Vec<i64>> {
        if let Some(sight) = &filter.sight
            && !sight.everything
            && filter.narrows_nothing_else()
        {
            let before = before.unwrap_or(i64::MAX);
            return self.newest_seen(sight, before, limit).await;
        }
        let mut words = Words::of(filter, self.reads().texts())?;
        let mut connection = self.reads().acquire().await?;
        words.bound(&mut connection).await?;
        let walk = words.walk(&mut connection).await?;
        let query = words.statement("SELECT j.seq FROM ", walk, before, limit);
        Ok(query
            .build_query_scalar()
            .fetch_all(&mut connection)
            .await?)
    }

    async fn filtered(
        &self,
        filter: &JobFilter,
        before: Option<i64>,
        limit: u32,
    ) -> Result<Vec<JobRow>> {
        let mut words = Words::of(filter, self.reads().texts())?;
        let mut connection = self.reads().acquire().await?;
        words.bound(&mut connection).await?;
        let walk = words.walk(&mut connection).await?;
        let query = words.statement(SELECT_JOBS, walk, before, limit);
        Ok(query.build_query_as().fetch_all(&mut connection).await?)
    }
}

/// The number that a cursor holds.
pub(super) fn number_of(cursor: Option<&str>) -> Result<Option<i64>> {
    let number = cursor.map(|text| {
        text.parse().map_err(|_| {
            StoreError::Invalid("the cursor is not one that a page gave as `next`".to_owned())
        })
    });
    number.transpose()
}

/// A page of the first `limit` rows; one more of them says that another page follows.
pub(super) fn page_of(mut rows: Vec<JobRow>, limit: u32) -> Page<JobView> {
    let is_last = rows.len() <= limit as usize;
    rows.truncate(limit as usize);
    let next = rows
        .last()
        .filter(|_| !is_last)
        .map(|row| row.seq.to_string());
    let (items, unreadable) = readable(rows);
    Page {
        items,
        next,
        unreadable,
        stopped_after: None,
    }
}

impl Words {
    fn of(filter: &JobFilter, texts: &'static Texts) -> Result<Self> {
        let projects = |of: fn(&Sight) -> &Vec<Uuid>| {
            let named = filter.sight.as_ref().map(of);
            hex_names(named.map_or(&[], Vec::as_slice))
        };
        Ok(Self {
            status: filter.status.as_ref().map(wire_name).transpose()?,
            outcome: filter.outcome.as_ref().map(wire_name).transpose()?,
            kind: filter.kind.map(JobKind::name),
            tag: filter.tag.clone(),
            text: filter.q.as_deref().map(|typed| Text::of(typed, texts)),
            after: filter.created_after.map(Moment::of),
            before: filter.created_before.map(Moment::of),
            seen_projects: projects(|sight| &sight.projects)?,
            unseen_projects: projects(|sight| &sight.not_in)?,
            seen_jobs: projects(|sight| &sight.jobs)?,
            sight: filter.sight.clone(),
            project: filter.project,
        })
    }

    /// Finds out where numbers bound a page: numbers are given in the order of submission, but for a
    /// clock that was set. Few after a moment are soon found; so are those before it, unless many are not.
    async fn bound(&mut self, connection: &mut Connection) -> Result<()> {
        let after = "SELECT COUNT(*) FROM (SELECT 1 FROM jobs WHERE created_at > ";
        let from = "SELECT COUNT(*) FROM (SELECT 1 FROM jobs WHERE created_at >= ";
        if let Some(moment) = &mut self.after {
            let mut query = Builder::new(after);
            query.push_bind(moment.at);
            moment.bounds_numbers = is_few(query, PASSED_OVER, connection).await?;
        }
        if let Some(moment) = &mut self.before {
            let mut query = Builder::new(from);
            query.push_bind(moment.at);
            moment.bounds_numbers = !is_few(query, PASSED_OVER, connection).await?;
        }
        Ok(())
    }

    /// What to walk.
    async fn walk(&self, connection: &mut Connection) -> Result<Walk> {
        let has_state = self.status.is_some() || self.outcome.is_some() || self.kind.is_some();
        let is_found = self.text.as_ref().is_some_and(Text::is_indexed);
        if !is_found && self.tag.is_none() {
            return Ok(Walk::Jobs);
        }
        if has_state {
            let mut query = Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM jobs j WHERE TRUE");
            self.push_state(&mut query);
            if is_few(query, FEW, connection).await? {
                return Ok(Walk::Jobs);
            }
        }
        match &self.tag {
            Some(_) if !is_found => Ok(Walk::Tag),
            Some(tag) => {
                let mut query =
                    Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM job_tags WHERE tag = ");
                query.push_bind(tag.clone());
                let few = is_few(query, FEW, connection).await?;
                Ok(if few { Walk::Tag } else { Walk::Text })
            }
            None => Ok(Walk::Text),
        }
    }

    /// The statement for a page of `limit` jobs before number `before`; `select` says what of them.
    fn statement(&self, select: &str, walk: Walk, before: Option<i64>, limit: u32) -> Builder {
        let mut query = Builder::new(select);
        let number = match walk {
            Walk::Jobs => {
                query.push("jobs j WHERE TRUE");
                "j.seq"
            }
            // CROSS: in this order
            Walk::Tag => {
                query.push("job_tags t CROSS JOIN jobs j WHERE j.seq = t.job AND t.tag = ");
                query.push_bind(self.tag.clone());
                "t.job"
            }
            Walk::Text => {
                query.push(
                    "job_texts t CROSS JOIN jobs j WHERE j.seq = t.rowid AND t.job_texts MATCH ",
                );
                query.push_bind(self.text.as_ref().and_then(|text| text.phrase.clone()));
                "t.rowid"
            }
        };
        self.push_state(&mut query);
        self.push_sight(&mut query);
        if let (Some(tag), Walk::Jobs | Walk::Text) = (&self.tag, walk) {
            query.push(" AND EXISTS (SELECT 1 FROM job_tags o WHERE o.job = j.seq AND o.tag = ");
            query.push_bind(tag.clone()).push(")");
        }
        if let (Some(text), Walk::Jobs | Walk::Tag) = (&self.text, walk) {
            text.push(&mut query);
        }
        if let Some(Moment { at, bounds_numbers }) = self.after {
            query.push(" AND j.created_at > ").push_bind(at);
            if bounds_numbers {
                let first =
                    "(SELECT MIN(seq) FROM jobs INDEXED BY jobs_by_moment WHERE created_at > ";
                query.push(format!(" AND {number} >= {first}"));
                query.push_bind(at).push(")");
            }
        }
        if let Some(Moment { at, bounds_numbers }) = self.before {
            query.push(" AND j.created_at < ").push_bind(at);
            if bounds_numbers {
                let last =
                    "(SELECT MAX(seq) FROM jobs INDEXED BY jobs_by_moment WHERE created_at < ";
                query.push(format!(" AND {number} <= {last}"));
                query.push_bind(at).push(")");
            }
        }
        if let Some(before) = before {
            query.push(format!(" AND {number} < ")).push_bind(before);
        }
        query
            .push(format!(" ORDER BY {number} DESC LIMIT "))
            .push_bind(limit);
        query
    }

    /// What the caller may see, and the project asked for.
    fn push_sight(&self, query: &mut Builder) {
        if let Some(sight) = &self.sight {
            if !sight.everything {
                query.push(" AND (j.owner = ").push_bind(sight.owner);
                if !sight.jobs.is_empty() {
                    query.push(" OR j.id IN (SELECT unhex(value) FROM json_each(");
                    query.push_bind(self.seen_jobs.clone()).push("))");
                }
                query.push(" OR j.project IN (SELECT unhex(value) FROM json_each(");
                query.push_bind(self.seen_projects.clone()).push(")))");
            }
            if !sight.not_in.is_empty() {
                query.push(" AND (j.project IS NULL OR j.project NOT IN (SELECT unhex(value) FROM json_each(");
                query.push_bind(self.unseen_projects.clone()).push(")))");
            }
            if let Some(person) = sight.not_of {
                query
                    .push(" AND j.owner IS DISTINCT FROM ")
                    .push_bind(person);
            }
        }
        if let Some(project) = self.project {
            query.push(" AND j.project = ").push_bind(project);
        }
    }

    fn push_state(&self, query: &mut Builder) {
        if let Some(status) = &self.status {
            query.push(" AND j.status = ").push_bind(status.clone());
        }
        if let Some(outcome) = &self.outcome {
            query.push(" AND j.outcome = ").push_bind(outcome.clone());
        }
        if let Some(kind) = self.kind {
            query.push(" AND j.kind = ").push_bind(kind);
        }
    }
}

/// Whether the rows of a count that is still open are no more than `few`.
async fn is_few(mut query: Builder, few: i64, connection: &mut Connection) -> Result<bool> {
    query.push(" LIMIT ").push_bind(few + 1).push(") few");
    let count: i64 = query.build_query_scalar().fetch_one(connection).await?;
    Ok(count <= few)
}

impl Moment {
    fn of(moment: Timestamp) -> Self {
        Self {
            at: moment.as_millis(),
            bounds_numbers: false,
        }
    }
}

impl Text {
    fn of(typed: &str, texts: &'static Texts) -> Self {
        let typed = typed.to_lowercase();
        // a text of the database's index ends at its first zero
        let is_found = texts.has_index_of_texts
            && typed.chars().count() >= SHORTEST_FOUND
            && !typed.contains('\0');
        Self {
            phrase: is_found.then(|| format!("\"{}\"", typed.replace('"', "\"\""))),
            ids: ids_beginning_with(&typed),
            typed,
            texts,
        }
    }

    /// Whether walking the index of texts finds all of it.
    fn is_indexed(&self) -> bool {
        self.phrase.is_some() && self.ids.is_none()
    }

    /// The condition on a job that is at hand.
    fn push(&self, query: &mut Builder) {
        match (&self.phrase, self.ids) {
            (Some(phrase), None) => {
                query.push(" AND EXISTS (SELECT 1 FROM job_texts x WHERE x.rowid = j.seq AND x.job_texts MATCH ");
                query.push_bind(phrase.clone()).push(")");
            }
            // what reads like an id is in few texts
            (Some(phrase), Some([first, last])) => {
                query.push(" AND j.seq IN (SELECT rowid FROM job_texts WHERE job_texts MATCH ");
                query.push_bind(phrase.clone());
                query.push(" UNION SELECT seq FROM jobs WHERE id BETWEEN ");
                query
                    .push_bind(first)
                    .push(" AND ")
                    .push_bind(last)
                    .push(")");
            }
            (None, ids) => {
                query.push(" AND (FALSE");
                if let Some([first, last]) = ids {
                    query.push(" OR j.id BETWEEN ").push_bind(first);
                    query.push(" AND ").push_bind(last);
                }
                let folded = self.texts.folded;
                for column in ["j.name", "j.notes", "j.tags"] {
                    query.push(format!(" OR instr({folded}({column}), "));
                    query.push_bind(self.typed.clone()).push(") > 0");
                }
                query.push(")");
            }
        }
    }
}

/// The first and the last id that begin with these digits, with or without hyphens.
fn ids_beginning_with(typed: &str) -> Option<[Uuid; 2]> {
    let digits = typed.replace('-', "");
    let is_one = (SHORTEST_ID..=32).contains(&digits.len())
        && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !is_one {
        return None;
    }
    let id = |fill: &str| {
        let rest = fill.repeat(32 - digits.len());
        Uuid::try_parse(&format!("{digits}{rest}")).ok()
    };
    id("0").zip(id("f")).map(|(first, last)| [first, last])
}

#[cfg(test)]
mod tests {
    use super::super::database::TEXTS;
    use super::*;

    #[test]
    fn ids_are_known_by_eight_digits_or_more() {
        let [first, last] = ids_beginning_with("0192-abcd").expect("eight digits");
        assert_eq!(first.to_string(), "0192abcd-0000-0000-0000-000000000000");
        assert_eq!(last.to_string(), "0192abcd-ffff-ffff-ffff-ffffffffffff");
        let whole = "0192abcd-0000-7000-8000-00000000000a";
        let [first, last] = ids_beginning_with(whole).expect("a whole id");
        assert_eq!((first.to_string(), first), (whole.to_owned(), last));
        for no_id in ["0192abc", "series 192abcdef", "", &"0".repeat(33)] {
            assert!(ids_beginning_with(no_id).is_none(), "{no_id}");
        }
    }

    #[test]
    fn whatever_is_typed_is_one_phrase() {
        let phrase = |typed: &str| Text::of(typed, &TEXTS).phrase;
        assert_eq!(
            phrase("Wet\" OR \"dry").as_deref(),
            Some("\"wet\"\" or \"\"dry\"")
        );
        assert_eq!(phrase("ab"), None);
        assert_eq!(phrase("ab\0c"), None);
        assert_eq!(phrase("äöü").as_deref(), Some("\"äöü\""));
    }
}
