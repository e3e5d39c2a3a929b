//! Lists by values that are kept of all jobs: what is found and its order are those of all jobs, not of the
//! newest.
//!
//! Where only some thousand jobs can be in the list, because the caller sees no more, or no more pass the
//! filter or one of the conditions ([`Looks::few`]), these are looked at, all at once. Else an index is walked: that of what is
//! sorted by, or of a value that is asked for, or the jobs themselves. A walk looks at [`Looks::walked`] jobs
//! and then gives what it has found and the place to go on from, and says so.
//!
//! One file, long as it is: the steps of a walk and where it ends are only right together.
use loadframe_api::{JobView, Page};

use super::super::database::{Builder, Connection};
use super::super::error::Result;
use super::super::key::Key;
use super::super::list::{LONGEST_PAGE, Walk as JobWalk, Words, is_few, number_of, page_of};
use super::super::pointer::{Comparison, Condition, Operand};
use super::super::{JobFilter, Looks, Store};
use super::condition::push_condition;

/// Jobs of a walk's first step, where not all of them are found; each further one has four times as many.
const FIRST_STEP: u64 = 1_000;

/// A list by kept values alone.
#[derive(Debug)]
pub(in super::super) struct KeptList<'a> {
    pub(in super::super) filter: &'a JobFilter,
    /// Conditions that hold together, and the fields that they are on.
    pub(in super::super) conditions: Vec<(i64, &'a Condition)>,
    /// The field that it is sorted by and whether it falls; else the newest come first.
    pub(in super::super) order: Option<(i64, bool)>,
    pub(in super::super) looks: Looks,
}

/// Where the few jobs come from that can be in a list.
#[derive(Clone, Copy, Debug)]
enum Few {
    /// All that the caller sees.
    Seen,
    /// All that pass the filter.
    Filtered,
    /// All that a condition holds for.
    Found(usize),
}

/// Part of a sorted list that is one walk.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Numbers,
    Texts,
    /// Jobs without a value.
    Others,
}

/// An index that is walked.
#[derive(Clone, Copy, Debug)]
struct Walk {
    field: i64,
    is_falling: bool,
}

impl Store {
    /// The jobs of the list after the cursor; nothing where only walking the jobs themselves would find
    /// them.
    ///
    /// # Errors
    /// [`super::super::StoreError::Invalid`] for a cursor that was never given out.
    pub(in super::super) async fn listed_by_kept(
        &self,
        list: &KeptList<'_>,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Option<Page<JobView>>> {
        let limit = limit.clamp(1, LONGEST_PAGE);
        let after = list.after(cursor)?;
        let mut words = self.words(list.filter).await?;
        let mut connection = self.reads().acquire().await?;
        words.bound(&mut connection).await?;
        let few = list.few(&mut words, &mut connection).await?;
        let found = match (few, list.walk()) {
            (Some(few), _) => {
                let of = words.walk(&mut connection).await?;
                let source = list.source(few, &words, of);
                let query = list.gathered(source, few, &words, after.as_ref(), limit + 1);
                let rows = query.build().fetch_all(&mut connection).await?;
                (Key::all(rows)?, None)
            }
            (None, Some(walk)) => {
                list.walked(walk, &words, after, limit + 1, &mut connection)
                    .await?
            }
            (None, None) => return Ok(None),
        };
        drop(connection);
        let (mut keys, stopped) = found;
        let is_more = keys.len() > limit as usize;
        keys.truncate(limit as usize);
        let numbers: Vec<i64> = keys.iter().map(|key| key.seq).collect();
        let mut page = page_of(self.rows(&numbers).await?, limit);
        // the place of the last that was looked at, where a walk stopped; else of the last that is shown
        let last = if is_more { keys.pop() } else { None };
        page.stopped_after = stopped.as_ref().map(|_| u64::from(list.looks.walked));
        page.next = last.or(stopped).map(|key| list.cursor(&key));
        Ok(Some(page))
    }
}

impl KeptList<'_> {
    fn after(&self, cursor: Option<&str>) -> Result<Option<Key>> {
        match (cursor, self.order) {
            (None, _) => Ok(None),
            (Some(cursor), Some(_)) => Key::of_cursor(cursor).map(Some),
            (Some(_), None) => Ok(number_of(cursor)?.map(|seq| Key {
                number: None,
                text: None,
                seq,
            })),
        }
    }

    fn cursor(&self, key: &Key) -> String {
        match self.order {
            Some(_) => key.cursor(),
            None => key.seq.to_string(),
        }
    }

    /// Where few jobs can be in the list, where they come from.
    async fn few(&self, words: &mut Words, connection: &mut Connection) -> Result<Option<Few>> {
        if words.sees_a_part() {
            let mut query = Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM (");
            words.push_seen(&mut query);
            query.push(") seen");
            if is_few(query, i64::from(self.looks.few), connection).await? {
                return Ok(Some(Few::Seen));
            }
        }
        if !self.filter.narrows_nothing_else() && words.leaves_few(self.looks, connection).await? {
            return Ok(Some(Few::Filtered));
        }
        for (place, (field, condition)) in self.conditions.iter().enumerate() {
            if condition.comparison == Comparison::NotEqual {
                continue;
            }
            let mut query =
                Builder::new("SELECT COUNT(*) FROM (SELECT 1 FROM kept_values v WHERE ");
            push_condition(&mut query, "v", *field, condition);
            if is_few(query, i64::from(self.looks.few), connection).await? {
                return Ok(Some(Few::Found(place)));
            }
        }
        Ok(None)
    }

    /// What is walked where many can be in the list: what is sorted by, or the jobs with a value, from the
    /// newest on.
    fn walk(&self) -> Option<Walk> {
        let equal = self
            .conditions
            .iter()
            .find(|(_, condition)| condition.comparison == Comparison::Equal);
        match (self.order, equal) {
            (Some((field, is_falling)), _) => Some(Walk { field, is_falling }),
            (None, Some((field, _))) => Some(Walk {
                field: *field,
                is_falling: true,
            }),
            (None, None) => None,
        }
    }

    /// More than few jobs are by now: so that the database knows it, which guesses far more.
    fn at_most(&self) -> u32 {
        self.looks.few.saturating_mul(2)
    }

    /// The numbers of the few jobs, as `seq`.
    fn source(&self, few: Few, words: &Words, walk: JobWalk<'_>) -> Builder {
        let mut source = Builder::default();
        match few {
            Few::Seen => words.push_seen(&mut source),
            Few::Filtered => {
                source = words.statement("SELECT j.seq FROM ", walk, None, self.at_most());
            }
            Few::Found(place) => {
                let (field, condition) = self.conditions[place];
                source.push("SELECT v.job AS seq FROM kept_values v WHERE ");
                push_condition(&mut source, "v", field, condition);
            }
        }
        source
    }

    /// The statement for the next `limit` of few jobs.
    fn gathered(
        &self,
        source: Builder,
        few: Few,
        words: &Words,
        after: Option<&Key>,
        limit: u32,
    ) -> Builder {
        // CROSS: in this order
        let mut query = match self.order {
            Some(_) => {
                Builder::new("SELECT n.seq, v.number, v.text FROM (SELECT DISTINCT seq FROM (")
            }
            None => Builder::new("SELECT n.seq, NULL, NULL FROM (SELECT DISTINCT seq FROM ("),
        };
        query.append(source);
        if !matches!(few, Few::Filtered) {
            query.push(" LIMIT ").push_bind(self.at_most());
        }
        query.push(") s) n CROSS JOIN jobs j");
        if let Some((field, _)) = self.order {
            query.push(" LEFT JOIN kept_values v ON v.job = n.seq AND v.field = ");
            query.push_bind(field);
        }
        query.push(" WHERE j.seq = n.seq");
        if !matches!(few, Few::Filtered) {
            words.push_filter(&mut query);
        }
        let known = match few {
            Few::Found(place) => Some(place),
            Few::Seen | Few::Filtered => None,
        };
        self.push_conditions(&mut query, |place, _| Some(place) != known);
        let Some((_, is_falling)) = self.order else {
            if let Some(after) = after {
                query.push(" AND n.seq < ").push_bind(after.seq);
            }
            query.push(" ORDER BY n.seq DESC LIMIT ").push_bind(limit);
            return query;
        };
        let [direction, sign] = directions(is_falling);
        match after {
            None => {}
            Some(Key {
                number: Some(number),
                seq,
                ..
            }) => {
                query.push(format!(
                    " AND (v.number IS NULL OR (v.number, n.seq) {sign} ("
                ));
                query
                    .push_bind(*number)
                    .push(", ")
                    .push_bind(*seq)
                    .push("))");
            }
            Some(Key {
                text: Some(text),
                seq,
                ..
            }) => {
                query.push(" AND v.number IS NULL AND (v.text IS NULL OR ");
                query.push(format!("(v.text, n.seq) {sign} ("));
                query
                    .push_bind(text.clone())
                    .push(", ")
                    .push_bind(*seq)
                    .push("))");
            }
            Some(Key { seq, .. }) => {
                query
                    .push(" AND v.field IS NULL AND n.seq < ")
                    .push_bind(*seq);
            }
        }
        query.push(" ORDER BY CASE WHEN v.number IS NOT NULL THEN 0 WHEN v.text IS NOT NULL THEN 1 ELSE 2 END");
        query.push(format!(", v.number {direction}, v.text {direction}"));
        query.push(format!(
            ", CASE WHEN v.field IS NULL THEN 0 ELSE n.seq END {direction}, n.seq DESC LIMIT "
        ));
        query.push_bind(limit);
        query
    }

    /// Walks until `limit` jobs are found; tells them, and where it stopped before that.
    async fn walked(
        &self,
        walk: Walk,
        words: &Words,
        mut after: Option<Key>,
        limit: u32,
        connection: &mut Connection,
    ) -> Result<(Vec<Key>, Option<Key>)> {
        let walked = u64::from(self.looks.walked);
        let mut found: Vec<Key> = Vec::new();
        let mut looked_at = 0;
        let only_own = self
            .conditions
            .iter()
            .all(|(field, _)| *field == walk.field);
        let all_pass = only_own && self.filter.narrows_nothing_else() && !words.sees_a_part();
        let step = if all_pass {
            u64::from(limit)
        } else if words.has_rare_text() {
            // what does not hold the text costs next to nothing
            walked
        } else {
            FIRST_STEP
        };
        let mut step = step.min(walked);
        for part in self.parts(walk, after.as_ref()) {
            loop {
                let wanted = limit - u32::try_from(found.len()).unwrap_or(limit);
                let source = self.step(walk, part, after.as_ref(), step);
                let query = self.passing(walk, part, &source, words, wanted);
                let rows = query.build().fetch_all(&mut *connection).await?;
                found.extend(Key::all(rows)?);
                if found.len() >= limit as usize {
                    return Ok((found, None));
                }
                let last = last_of(walk, part, source, step, connection).await?;
                looked_at += step;
                step = (4 * step).min(walked.saturating_sub(looked_at)).max(1);
                after = last;
                if after.is_none() {
                    break;
                }
                if looked_at >= walked {
                    return Ok((found, after));
                }
            }
        }
        Ok((found, None))
    }

    /// Parts of the list from the cursor on.
    fn parts(&self, walk: Walk, after: Option<&Key>) -> Vec<Part> {
        // what a condition on the field itself leaves
        let own = self
            .conditions
            .iter()
            .find(|(field, _)| *field == walk.field);
        let all = match own.map(|(_, condition)| &condition.operand) {
            Some(Operand::Text(_)) => vec![Part::Texts],
            Some(_) => vec![Part::Numbers],
            None => vec![Part::Numbers, Part::Texts, Part::Others],
        };
        let first = match (self.order, after) {
            (None, _)
            | (
                _,
                None
                | Some(Key {
                    number: Some(_), ..
                }),
            ) => Part::Numbers,
            (_, Some(Key { text: Some(_), .. })) => Part::Texts,
            (_, Some(_)) => Part::Others,
        };
        let rank = |part: &Part| match part {
            Part::Numbers => 0,
            Part::Texts => 1,
            Part::Others => 2,
        };
        all.into_iter()
            .filter(|part| rank(part) >= rank(&first))
            .collect()
    }

    /// The next entries of a part, as `seq` and `value`.
    fn step(&self, walk: Walk, part: Part, after: Option<&Key>, entries: u64) -> Builder {
        let entries = i64::try_from(entries).unwrap_or(i64::MAX);
        let column = match part {
            Part::Numbers => "number",
            Part::Texts => "text",
            Part::Others => {
                let mut query = Builder::new("SELECT seq, NULL AS value FROM jobs WHERE TRUE");
                if let Some(after) = after {
                    query.push(" AND seq < ").push_bind(after.seq);
                }
                query.push(" ORDER BY seq DESC LIMIT ").push_bind(entries);
                return query;
            }
        };
        let [direction, sign] = directions(walk.is_falling);
        let mut query = Builder::new("SELECT v.job AS seq, ");
        query.push(format!(
            "v.{column} AS value FROM kept_values v WHERE v.field = "
        ));
        query.push_bind(walk.field);
        query.push(format!(" AND v.{column} IS NOT NULL"));
        for (field, condition) in &self.conditions {
            if *field == walk.field {
                query.push(" AND ");
                push_condition(&mut query, "v", *field, condition);
            }
        }
        match (self.order, after) {
            (_, None) => {}
            // all have the same value
            (None, Some(after)) => {
                query.push(" AND v.job < ").push_bind(after.seq);
            }
            (Some(_), Some(after)) => {
                query.push(format!(" AND (v.{column}, v.job) {sign} ("));
                match part {
                    Part::Numbers => query.push_bind(after.number),
                    Part::Texts | Part::Others => query.push_bind(after.text.clone()),
                };
                query.push(", ").push_bind(after.seq).push(")");
            }
        }
        query.push(format!(
            " ORDER BY v.{column} {direction}, v.job {direction} LIMIT "
        ));
        query.push_bind(entries);
        query
    }

    /// The statement for those of a step that are in the list.
    fn passing(
        &self,
        walk: Walk,
        part: Part,
        step: &Builder,
        words: &Words,
        wanted: u32,
    ) -> Builder {
        let mut query = Builder::new(match part {
            Part::Numbers => "SELECT n.seq, n.value, NULL FROM (",
            Part::Texts => "SELECT n.seq, NULL, n.value FROM (",
            Part::Others => "SELECT n.seq, NULL, NULL FROM (",
        });
        query.append(step.clone());
        query.push(") n CROSS JOIN jobs j WHERE j.seq = n.seq");
        words.push_filter(&mut query);
        self.push_conditions(&mut query, |_, field| field != walk.field);
        if part == Part::Others {
            query.push(
                " AND NOT EXISTS (SELECT 1 FROM kept_values o WHERE o.job = n.seq AND o.field = ",
            );
            query.push_bind(walk.field).push(")");
        }
        push_order(&mut query, walk, part);
        query.push(" LIMIT ").push_bind(wanted);
        query
    }

    /// Conditions on the job `j`.
    fn push_conditions(&self, query: &mut Builder, which: impl Fn(usize, i64) -> bool) {
        for (place, (field, condition)) in self.conditions.iter().enumerate() {
            if which(place, *field) {
                query.push(" AND EXISTS (SELECT 1 FROM kept_values c WHERE c.job = j.seq AND ");
                push_condition(query, "c", *field, condition);
                query.push(")");
            }
        }
    }
}

/// The last entry of a step of so many, if it has as many.
async fn last_of(
    walk: Walk,
    part: Part,
    step: Builder,
    entries: u64,
    connection: &mut Connection,
) -> Result<Option<Key>> {
    let mut query = Builder::new(match part {
        Part::Numbers => "SELECT n.seq, n.value, NULL FROM (",
        Part::Texts => "SELECT n.seq, NULL, n.value FROM (",
        Part::Others => "SELECT n.seq, NULL, NULL FROM (",
    });
    query.append(step);
    query.push(") n");
    push_order(&mut query, walk, part);
    query.push(" LIMIT 1 OFFSET ");
    query.push_bind(i64::try_from(entries - 1).unwrap_or(i64::MAX));
    Ok(Key::all(query.build().fetch_all(connection).await?)?.pop())
}

/// The order of a step's entries.
fn push_order(query: &mut Builder, walk: Walk, part: Part) {
    let [direction, _] = directions(walk.is_falling);
    match part {
        Part::Others => query.push(" ORDER BY n.seq DESC"),
        Part::Numbers | Part::Texts => {
            query.push(format!(" ORDER BY n.value {direction}, n.seq {direction}"))
        }
    };
}

/// Which way an order goes, and the sign of what comes after.
fn directions(is_falling: bool) -> [&'static str; 2] {
    match is_falling {
        true => ["DESC", "<"],
        false => ["ASC", ">"],
    }
}
