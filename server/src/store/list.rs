//! Lists of jobs: which statement finds a page quickly, whatever it is filtered by.
//!
//! A page walks one index from its newest entry on and looks at each job until it is full. Which one
//! decides how many jobs are looked at in vain. Where only some hundred have the status, outcome, kind
//! or tag asked for, these are walked; else what is searched for; else the tag; else the status,
//! outcome and kind; and without any of them the jobs themselves.
//!
//! One file, long as it is: which statement is quick and what it says are chosen together.
use loadframe_api::{JobKind, JobView, Page, Timestamp};
use uuid::Uuid;

use super::database::{Builder, Connection, Texts};
use super::encoding::{json, wire_name};
use super::error::{Result, StoreError};
use super::jobs::{JobRow, SELECT_JOBS, hex_names, readable};
use super::texts::Text;
use super::{JobFilter, Looks, Store};
use crate::access::Sight;

/// Longest page of a list.
pub(super) const LONGEST_PAGE: u32 = 1000;
/// So many jobs are looked at one by one: a page's work, whatever else is asked of them.
const FEW: i64 = 500;
/// For a page of what one sees, so many times as many are looked at before it is merged from each part: that
/// takes a tenth of the time where it finds them, and little where it does not.
const LOOKED_AT: u32 = 4;
/// Where a moment parts the jobs, so many are passed over without asking where it does.
const PASSED_OVER: i64 = 20_000;

/// A filter in the database's words.
pub(super) struct Words {
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

/// What a page walks.
#[derive(Clone, Copy)]
pub(super) enum Walk<'a> {
    /// The jobs themselves, by their status, outcome or kind where these are asked for.
    Jobs,
    Tag(&'a str),
    Text(&'a Text),
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
            // a page of what one sees is often among the newest of all
            Some(sight) if !sight.everything && filter.narrows_nothing_else() => {
                let before = before.unwrap_or(i64::MAX);
                let rows = self.among_newest(filter, before, limit + 1).await?;
                match rows.is_empty() {
                    true => self.merged(sight, before, limit + 1).await?,
                    false => rows,
                }
            }
            _ => self.filtered(filter, before, limit + 1).await?,
        };
        Ok(page_of(self.with_names(rows, filter.access).await?, limit))
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
        let mut words = self.words(filter).await?;
        let mut connection = self.reads().acquire().await?;
        words.bound(&mut connection).await?;
        let walk = words.walk(&mut connection).await?;
        let query = words.statement("SELECT j.seq FROM ", walk, before, limit);
        Ok(query
            .build_query_scalar()
            .fetch_all(&mut connection)
            .await?)
    }

    /// The newest `count` jobs before number `before` that the caller sees, where they are found among not
    /// many more that are newer than all others; else none.
    async fn among_newest(
        &self,
        filter: &JobFilter,
        before: i64,
        count: u32,
    ) -> Result<Vec<JobRow>> {
        let words = self.words(filter).await?;
        let mut query = Builder::new(
            "WITH newest AS MATERIALIZED (SELECT j.seq
             FROM (SELECT seq, id, owner, project FROM jobs WHERE seq < ",
        );
        query.push_bind(before).push(" ORDER BY seq DESC LIMIT ");
        query.push_bind(LOOKED_AT * count).push(") j WHERE TRUE");
        words.push_sight(&mut query);
        query.push(" ORDER BY j.seq DESC LIMIT ").push_bind(count);
        query.push(") ").push(SELECT_JOBS);
        query.push("jobs j WHERE j.seq IN (SELECT seq FROM newest)");
        query.push(" AND (SELECT COUNT(*) FROM newest) = ");
        query.push_bind(count).push(" ORDER BY j.seq DESC");
        Ok(query.build_query_as().fetch_all(self.reads()).await?)
    }

    /// The same jobs, wherever they are, merged from each part of what is seen.
    async fn merged(&self, sight: &Sight, before: i64, count: u32) -> Result<Vec<JobRow>> {
        let newest = self.newest_seen(sight, before, count);
        let mut query = Builder::new(SELECT_JOBS);
        query.push("jobs j WHERE j.seq IN (SELECT CAST(value AS BIGINT) FROM json_each(");
        query.push_bind(json(&newest.await?)?);
        query.push(")) ORDER BY j.seq DESC");
        Ok(query.build_query_as().fetch_all(self.reads()).await?)
    }

    async fn filtered(
        &self,
        filter: &JobFilter,
        before: Option<i64>,
        limit: u32,
    ) -> Result<Vec<JobRow>> {
        let mut words = self.words(filter).await?;
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
        newest_only: false,
        gathering: false,
    }
}

impl Store {
    /// What a filter says, in the words of statements.
    ///
    /// # Errors
    /// What cannot be written down.
    pub(super) async fn words(&self, filter: &JobFilter) -> Result<Words> {
        let mut words = Words::of(filter, self.reads().texts())?;
        if let Some(text) = &mut words.text
            && let Err(error) = self.index_texts().await
        {
            tracing::warn!(%error, "texts of new jobs could not be indexed; a search looks at all");
            text.look_at_all();
        }
        Ok(words)
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
    pub(super) async fn bound(&mut self, connection: &mut Connection) -> Result<()> {
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
    pub(super) async fn walk(&self, connection: &mut Connection) -> Result<Walk<'_>> {
        let has_state = self.status.is_some() || self.outcome.is_some() || self.kind.is_some();
        let text = self.text.as_ref().filter(|text| text.is_indexed());
        if has_state && (text.is_some() || self.tag.is_some()) {
            let mut query = Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM jobs j WHERE TRUE");
            self.push_state(&mut query);
            if is_few(query, FEW, connection).await? {
                return Ok(Walk::Jobs);
            }
        }
        Ok(match (&self.tag, text) {
            (None, None) => Walk::Jobs,
            (None, Some(text)) => Walk::Text(text),
            (Some(tag), None) => Walk::Tag(tag),
            (Some(tag), Some(text)) => {
                let mut query =
                    Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM job_tags WHERE tag = ");
                query.push_bind(tag.clone());
                match is_few(query, FEW, connection).await? {
                    true => Walk::Tag(tag),
                    false => Walk::Text(text),
                }
            }
        })
    }

    /// The statement for a page of `limit` jobs before number `before`; `select` says what of them.
    pub(super) fn statement(
        &self,
        select: &str,
        walk: Walk<'_>,
        before: Option<i64>,
        limit: u32,
    ) -> Builder {
        let mut query = Builder::new(select);
        let number = match walk {
            Walk::Jobs => {
                query.push("jobs j WHERE TRUE");
                "j.seq"
            }
            // CROSS: in this order
            Walk::Tag(tag) => {
                query.push("job_tags t CROSS JOIN jobs j WHERE j.seq = t.job AND t.tag = ");
                query.push_bind(tag);
                "t.job"
            }
            Walk::Text(text) => {
                text.push_walk(&mut query);
                text.number()
            }
        };
        self.push_rest(&mut query, walk, Text::push);
        for (moment, sign, end) in [(self.after, '>', "MIN"), (self.before, '<', "MAX")] {
            if let Some(moment) = moment
                && moment.bounds_numbers
            {
                query.push(format!(
                    " AND {number} {sign}= (SELECT {end}(seq) FROM jobs INDEXED BY jobs_by_moment
                     WHERE created_at {sign} "
                ));
                query.push_bind(moment.at).push(")");
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

    /// Whether few jobs pass the filter. Finds out beside it whether its text is rare.
    pub(super) async fn leaves_few(
        &mut self,
        looks: Looks,
        connection: &mut Connection,
    ) -> Result<bool> {
        let [few, rare] = [looks.few, looks.rare].map(i64::from);
        if let Some(text) = &mut self.text
            && let Some(rows) = text.rows_found()
        {
            let mut query = Builder::new("SELECT COUNT(*) FROM (");
            query.append(rows);
            // an index that does not decide is slow to be counted
            let is_decided = text.is_decided();
            let most = if is_decided { rare } else { rare.min(2 * few) };
            let found = counted(query, few.max(most), connection).await?;
            if found <= most {
                text.set_rare();
            }
            if found <= few || (is_decided && self.has_text_alone()) {
                return Ok(found <= few);
            }
        }
        let walk = self.walk(connection).await?;
        let mut query = Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM (");
        query.append(self.statement("SELECT j.seq FROM ", walk, None, looks.few + 1));
        query.push(") passed");
        is_few(query, few, connection).await
    }

    /// Whether the text is all that the filter asks for.
    fn has_text_alone(&self) -> bool {
        let Self {
            status,
            outcome,
            kind,
            tag,
            text: _,
            after,
            before,
            sight,
            project,
            ..
        } = self;
        let sees_all = sight.as_ref().is_none_or(|sight| {
            sight.everything && sight.not_in.is_empty() && sight.not_of.is_none()
        });
        let has_moment = after.is_some() || before.is_some();
        let has_state = status.is_some() || outcome.is_some() || kind.is_some();
        sees_all && !has_moment && !has_state && tag.is_none() && project.is_none()
    }

    /// Whether all jobs with its text are looked up at once.
    pub(super) fn has_rare_text(&self) -> bool {
        self.text.as_ref().is_some_and(Text::is_rare)
    }

    /// The whole filter as a condition on the job `j` with the number `n.seq`.
    pub(super) fn push_filter(&self, query: &mut Builder) {
        self.push_rest(query, Walk::Jobs, Text::push_among_many);
    }

    /// The filter as a condition on the job `j` that a walk came to, of the text in this way.
    fn push_rest(&self, query: &mut Builder, walk: Walk<'_>, push_text: fn(&Text, &mut Builder)) {
        self.push_state(query);
        self.push_sight(query);
        if let (Some(tag), Walk::Jobs | Walk::Text(_)) = (&self.tag, walk) {
            query.push(" AND EXISTS (SELECT 1 FROM job_tags o WHERE o.job = j.seq AND o.tag = ");
            query.push_bind(tag.clone()).push(")");
        }
        if let (Some(text), Walk::Jobs | Walk::Tag(_)) = (&self.text, walk) {
            push_text(text, query);
        }
        for (moment, sign) in [(self.after, '>'), (self.before, '<')] {
            if let Some(Moment { at, .. }) = moment {
                query
                    .push(format!(" AND j.created_at {sign} "))
                    .push_bind(at);
            }
        }
    }

    /// Whether the caller sees some jobs only.
    pub(super) fn sees_a_part(&self) -> bool {
        self.sight.as_ref().is_some_and(|sight| !sight.everything)
    }

    /// The statement for the numbers of all jobs that the caller sees, some of them twice, and some that are
    /// not to be seen after all; of a caller who [`Self::sees_a_part`].
    pub(super) fn push_seen(&self, query: &mut Builder) {
        let owner = self.sight.as_ref().and_then(|sight| sight.owner);
        query
            .push("SELECT seq FROM jobs WHERE owner = ")
            .push_bind(owner);
        query.push(
            " UNION ALL SELECT seq FROM jobs WHERE project IN (SELECT unhex(value) FROM json_each(",
        );
        query.push_bind(self.seen_projects.clone());
        query.push(
            ")) UNION ALL SELECT seq FROM jobs WHERE id IN (SELECT unhex(value) FROM json_each(",
        );
        query.push_bind(self.seen_jobs.clone()).push("))");
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
pub(super) async fn is_few(query: Builder, few: i64, connection: &mut Connection) -> Result<bool> {
    Ok(counted(query, few, connection).await? <= few)
}

/// The rows of a count that is still open, or one more than `most`.
async fn counted(mut query: Builder, most: i64, connection: &mut Connection) -> Result<i64> {
    query.push(" LIMIT ").push_bind(most + 1).push(") few");
    Ok(query.build_query_scalar().fetch_one(connection).await?)
}

impl Moment {
    fn of(moment: Timestamp) -> Self {
        Self {
            at: moment.as_millis(),
            bounds_numbers: false,
        }
    }
}
