//! Lists by what specs and results say: filtered, sorted, and with values of specs beside them.
//!
//! Values that lists were by before are [`kept`](super::kept) with an index. Of all else that a spec may say
//! there is none, and reading every spec of a million jobs takes a minute. So a search looks at the newest jobs
//! that the indexed filters leave, some thousand at a time, and after [`LOOKED_AT`] it stops and says so: what
//! follows is found from there on, and what is sorted is the newest of them. What it had to read is kept from
//! then on, so that the same list is one of all jobs some minutes later.
use std::cmp::Ordering;
use std::collections::HashMap;

use loadframe_api::{JobView, Page, ShownValue, unit_of_field};
use serde_json::Value;
use uuid::Uuid;

use super::database::{Builder, Row, query_scalar};
use super::encoding::{json, parsed};
use super::error::Result;
use super::jobs::{JobRow, SELECT_JOBS, hex_names};
use super::kept::condition::push_condition;
use super::kept::lists::KeptList;
use super::key::Key;
use super::list::{LONGEST_PAGE, number_of, page_of};
use super::pointer::{Condition, LONGEST_TEXT, Operand, Order, Pointer, Root};
use super::{JobFilter, Looks, Store};

/// Jobs looked at by one statement, at most: others read and write in between.
const AT_ONCE: u32 = 2_000;
/// Longer specs are not looked into [bytes].
const LONGEST_SPEC: i64 = 200_000;

/// What of specs and results a list is about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    pub conditions: Vec<Condition>,
    pub order: Option<Order>,
    /// Values of specs to be shown; results are in every list.
    pub shown: Vec<Pointer>,
}

impl Store {
    /// Jobs that pass the filter and the conditions, in the order wanted, with the values wanted.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] for a cursor that was never given out.
    pub async fn jobs_wanted(
        &self,
        filter: &JobFilter,
        wanted: &Wanted,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        let limit = limit.clamp(1, LONGEST_PAGE);
        let mut page = match wanted.is_by_values() {
            true => self.by_values(filter, wanted, cursor, limit).await?,
            false => self.jobs(filter, cursor, limit).await?,
        };
        self.show(&mut page.items, &wanted.shown).await?;
        Ok(page)
    }

    /// Jobs by their values: by what is kept of these, or else by what the newest jobs say.
    async fn by_values(
        &self,
        filter: &JobFilter,
        wanted: &Wanted,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        let known = Known::of(self, wanted).await?;
        if let Some(list) = known.kept_list(filter, wanted, self.options().looks)
            && let Some(page) = self.listed_by_kept(&list, cursor, limit).await?
        {
            return Ok(page);
        }
        let (mut page, looked_at) = match &wanted.order {
            Some(order) => {
                let sorted = self.sorted(filter, wanted, (order, &known), cursor, limit);
                sorted.await?
            }
            None => self.matching(filter, wanted, &known, cursor, limit).await?,
        };
        page.newest_only = wanted.order.is_some() && page.stopped_after.is_some();
        if looked_at >= u64::from(self.at_once()) {
            let are_kept = self.ask_to_keep(wanted, &known).await;
            page.gathering = are_kept && page.stopped_after.is_some() && !known.is_whole;
        }
        Ok(page)
    }

    fn at_once(&self) -> u32 {
        AT_ONCE.min(self.options().looks.read)
    }

    /// Keeps from now on what had to be read; tells whether all of it is. A list does not fail for it.
    async fn ask_to_keep(&self, wanted: &Wanted, known: &Known) -> bool {
        let mut are_kept = true;
        for pointer in wanted.pointers() {
            if known.fields.contains_key(pointer.text()) {
                continue;
            }
            are_kept &= self.keep_values(pointer).await.unwrap_or_else(|error| {
                tracing::warn!(%error, pointer = pointer.text(), "values cannot be kept");
                false
            });
        }
        are_kept
    }

    /// The next jobs that the conditions hold for, the newest first; and how many were looked at.
    async fn matching(
        &self,
        filter: &JobFilter,
        wanted: &Wanted,
        known: &Known,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<(Page<JobView>, u64)> {
        let (mut before, mut looked_at) = (number_of(cursor)?, 0);
        let at_once = self.at_once();
        let mut found: Vec<i64> = Vec::new();
        let stopped_at = loop {
            let numbers = self.numbers(filter, before, at_once).await?;
            let keys = self.keys(&numbers, &wanted.conditions, None, known).await?;
            found.extend(keys.into_iter().map(|key| key.seq));
            looked_at += numbers.len() as u64;
            before = numbers.last().copied().or(before);
            if found.len() > limit as usize || numbers.len() < at_once as usize {
                break None;
            }
            if looked_at >= u64::from(self.options().looks.read) {
                break before;
            }
        };
        found.truncate(limit as usize + 1);
        let mut page = page_of(self.rows(&found).await?, limit);
        if let Some(last) = stopped_at {
            page.next = Some(last.to_string());
            page.stopped_after = Some(looked_at);
        }
        Ok((page, looked_at))
    }

    /// The newest jobs that the conditions hold for, sorted; and how many were looked at.
    async fn sorted(
        &self,
        filter: &JobFilter,
        wanted: &Wanted,
        (order, known): (&Order, &Known),
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<(Page<JobView>, u64)> {
        let after = cursor.map(Key::of_cursor).transpose()?;
        let (mut before, mut looked_at) = (None, 0);
        let at_once = self.at_once();
        let mut keys: Vec<Key> = Vec::new();
        let is_all = loop {
            let numbers = self.numbers(filter, before, at_once).await?;
            let some = self.keys(&numbers, &wanted.conditions, Some(order), known);
            keys.extend(some.await?);
            looked_at += numbers.len() as u64;
            before = numbers.last().copied();
            if numbers.len() < at_once as usize {
                break true;
            }
            if looked_at >= u64::from(self.options().looks.read) {
                break self.numbers(filter, before, 1).await?.is_empty();
            }
        };
        keys.sort_unstable_by(|a, b| a.compare(b, order.is_falling));
        if let Some(after) = after {
            keys.retain(|key| key.compare(&after, order.is_falling) == Ordering::Greater);
        }
        let is_last = keys.len() <= limit as usize;
        keys.truncate(limit as usize);
        let numbers: Vec<i64> = keys.iter().map(|key| key.seq).collect();
        let mut page = page_of(self.rows(&numbers).await?, limit);
        page.next = keys.last().filter(|_| !is_last).map(Key::cursor);
        page.stopped_after = (!is_all).then_some(looked_at);
        Ok((page, looked_at))
    }

    /// Whether any of these jobs has what the list is sorted by.
    pub(super) async fn has_values(&self, numbers: &[i64], wanted: &Wanted) -> Result<bool> {
        let order = wanted.order.as_ref();
        let keys = self.keys(numbers, &[], order, &Known::default()).await?;
        Ok(keys
            .iter()
            .any(|key| key.number.is_some() || key.text.is_some()))
    }

    /// Of these jobs those that the conditions hold for, with what they are sorted by.
    async fn keys(
        &self,
        numbers: &[i64],
        conditions: &[Condition],
        order: Option<&Order>,
        known: &Known,
    ) -> Result<Vec<Key>> {
        let mut query = Builder::new("SELECT n.seq, ");
        match order {
            Some(order) => known.push_key(&mut query, &order.pointer),
            None => {
                query.push("NULL, NULL");
            }
        }
        query.push(" FROM (SELECT key, CAST(value AS BIGINT) AS seq FROM json_each(");
        query.push_bind(json(&numbers)?);
        query.push(")) n WHERE TRUE");
        for condition in conditions {
            query.push(" AND ");
            known.push_condition(&mut query, condition);
        }
        // in the order of the numbers, which fall
        query.push(" ORDER BY n.key");
        let rows: Vec<Row> = query.build().fetch_all(self.reads()).await?;
        Key::all(rows)
    }

    /// These jobs, in this order.
    pub(super) async fn rows(&self, numbers: &[i64]) -> Result<Vec<JobRow>> {
        let mut query = Builder::new(SELECT_JOBS);
        query.push("jobs j WHERE j.seq IN (SELECT CAST(value AS BIGINT) FROM json_each(");
        query.push_bind(json(&numbers)?).push("))");
        let mut rows: Vec<JobRow> = query.build_query_as().fetch_all(self.reads()).await?;
        let places = numbers.iter().enumerate();
        let places: HashMap<i64, usize> = places.map(|(place, seq)| (*seq, place)).collect();
        rows.sort_unstable_by_key(|row| places.get(&row.seq).copied());
        self.with_names(rows, None).await
    }

    /// Adds values of their specs to jobs.
    async fn show(&self, jobs: &mut [JobView], pointers: &[Pointer]) -> Result<()> {
        let pointers: Vec<(&Pointer, &str)> = pointers
            .iter()
            .filter_map(|pointer| Some((pointer, pointer.within_spec()?)))
            .collect();
        if pointers.is_empty() || jobs.is_empty() {
            return Ok(());
        }
        let ids: Vec<Uuid> = jobs.iter().map(|job| job.id).collect();
        let mut query = Builder::new("SELECT j.id");
        for (pointer, _) in &pointers {
            let path = || pointer.path().to_owned();
            query.push(", CASE json_type(s.json, ").push_bind(path());
            query.push(") WHEN 'array' THEN json_quote(json_array_length(s.json, ");
            query.push_bind(path()).push(") || ' entries') ");
            query.push("WHEN 'object' THEN '\"an object\"' ELSE s.json -> ");
            query.push_bind(path()).push(" END");
        }
        query.push(" FROM jobs j JOIN specs s ON s.job = j.seq WHERE octet_length(s.json) <= ");
        query.push_bind(LONGEST_SPEC);
        query.push(" AND j.id IN (SELECT unhex(value) FROM json_each(");
        query.push_bind(hex_names(&ids)?).push("))");
        let rows: Vec<Row> = query.build().fetch_all(self.reads()).await?;
        let mut found: HashMap<Uuid, Row> = HashMap::with_capacity(rows.len());
        for row in rows {
            found.insert(row.get(0)?, row);
        }
        for job in jobs {
            let Some(row) = found.get(&job.id) else {
                continue;
            };
            for (place, (pointer, within)) in pointers.iter().enumerate() {
                let text: Option<String> = row.get(place + 1)?;
                let Some(text) = text else { continue };
                let value: Value = parsed(&text, "spec")?;
                let unit = unit_of_field(job.kind, within).map(str::to_owned);
                let shown = ShownValue { value, unit };
                job.values.insert(pointer.text().to_owned(), shown);
            }
        }
        Ok(())
    }

    /// Specs of these jobs as JSON, but for those that are too long to be looked into.
    ///
    /// # Errors
    /// The database's.
    pub async fn specs_looked_into(&self, jobs: &[Uuid]) -> Result<Vec<String>> {
        let specs = query_scalar(
            "SELECT s.json FROM jobs j JOIN specs s ON s.job = j.seq
             WHERE j.id IN (SELECT unhex(value) FROM json_each(?)) AND octet_length(s.json) <= ?
             ORDER BY j.seq DESC",
        )
        .bind(hex_names(jobs)?)
        .bind(LONGEST_SPEC)
        .fetch_all(self.reads())
        .await?;
        Ok(specs)
    }
}

impl Wanted {
    /// Whether the list is by values at all.
    fn is_by_values(&self) -> bool {
        self.order.is_some() || !self.conditions.is_empty()
    }

    fn pointers(&self) -> impl Iterator<Item = &Pointer> {
        let order = self.order.iter().map(|order| &order.pointer);
        order.chain(self.conditions.iter().map(|condition| &condition.pointer))
    }
}

/// What of a list's values is kept.
#[derive(Debug, Default)]
struct Known {
    /// Fields by their pointers, and whether they are kept of all jobs.
    fields: HashMap<String, (i64, bool)>,
    /// Whether all of them are kept of all jobs.
    is_whole: bool,
}

impl Known {
    async fn of(store: &Store, wanted: &Wanted) -> Result<Self> {
        let mut known = Self {
            is_whole: true,
            ..Self::default()
        };
        for pointer in wanted.pointers() {
            let field = store.kept_field(pointer).await?;
            known.is_whole &= field.is_some_and(|field| field.is_whole);
            if let Some(field) = field {
                let text = pointer.text().to_owned();
                known.fields.insert(text, (field.id, field.is_whole));
            }
        }
        Ok(known)
    }

    /// The field at the pointer, where it is kept of all jobs.
    fn whole(&self, pointer: &Pointer) -> Option<i64> {
        let (field, is_whole) = self.fields.get(pointer.text())?;
        is_whole.then_some(*field)
    }

    /// The list, where all of its values are kept.
    fn kept_list<'a>(
        &self,
        filter: &'a JobFilter,
        wanted: &'a Wanted,
        looks: Looks,
    ) -> Option<KeptList<'a>> {
        let conditions = wanted.conditions.iter();
        let conditions = conditions.map(|of| Some((self.whole(&of.pointer)?, of)));
        let order = match &wanted.order {
            Some(order) => Some((self.whole(&order.pointer)?, order.is_falling)),
            None => None,
        };
        Some(KeptList {
            filter,
            conditions: conditions.collect::<Option<_>>()?,
            order,
            looks,
        })
    }

    /// Number and text of the job `n.seq` at the pointer.
    fn push_key(&self, query: &mut Builder, pointer: &Pointer) {
        if let Some(field) = self.whole(pointer) {
            for (column, end) in [("number", "), "), ("text", ")")] {
                query.push(format!(
                    "(SELECT v.{column} FROM kept_values v WHERE v.job = n.seq AND v.field = "
                ));
                query.push_bind(field).push(end);
            }
            return;
        }
        // whole numbers as well, and truths
        query.push("COALESCE(CAST(");
        push_value(query, pointer, "'integer', 'real'");
        query.push(" AS DOUBLE PRECISION), CAST(CAST(");
        push_value(query, pointer, "'true', 'false'");
        query.push(" AS BOOLEAN) AS INTEGER)), ");
        push_value(query, pointer, "'text'");
    }

    /// The condition on the job `n.seq`.
    fn push_condition(&self, query: &mut Builder, condition: &Condition) {
        if let Some(field) = self.whole(&condition.pointer) {
            query.push("EXISTS (SELECT 1 FROM kept_values c WHERE c.job = n.seq AND ");
            push_condition(query, "c", field, condition);
            query.push(")");
            return;
        }
        let sign = condition.comparison.sql();
        match &condition.operand {
            Operand::Number(number) => {
                query.push("CAST(");
                push_value(query, &condition.pointer, "'integer', 'real'");
                query
                    .push(format!(" AS DOUBLE PRECISION) {sign} "))
                    .push_bind(*number);
            }
            Operand::Truth(truth) => {
                query.push("CAST(");
                push_value(query, &condition.pointer, "'true', 'false'");
                query
                    .push(format!(" AS BOOLEAN) {sign} "))
                    .push_bind(*truth);
            }
            Operand::Text(text) => {
                push_value(query, &condition.pointer, "'text'");
                query.push(format!(" {sign} ")).push_bind(text.clone());
            }
        }
    }
}

/// The value of the job `n.seq` at the pointer, where it is of one of these types; else nothing.
fn push_value(query: &mut Builder, pointer: &Pointer, types: &str) {
    let (table, column) = match pointer.root() {
        Root::Spec => ("specs", "json"),
        Root::Results => ("results", "summary"),
    };
    query.push(format!("(SELECT json_extract(v.{column}, "));
    query.push_bind(pointer.path().to_owned());
    query.push(format!(
        ") FROM {table} v WHERE v.job = n.seq AND octet_length(v.{column}) <= "
    ));
    query.push_bind(LONGEST_SPEC);
    query.push(format!(" AND json_type(v.{column}, "));
    query.push_bind(pointer.path().to_owned());
    query.push(format!(") IN ({types})"));
    if types == "'text'" {
        query.push(format!(" AND octet_length(json_extract(v.{column}, "));
        query.push_bind(pointer.path().to_owned());
        query.push(format!(")) <= {LONGEST_TEXT}"));
    }
    query.push(")");
}
