//! Lists by what specs and results say: filtered, sorted, and with values of specs beside them.
//!
//! There is no index of all that a spec may say, and reading every spec of a million jobs takes a minute.
//! So a search looks at the newest jobs that the indexed filters leave, some thousand at a time, and after
//! [`LOOKED_AT`] it stops and says so: what follows is found from there on, and what is sorted is the
//! newest of them.
use std::cmp::Ordering;
use std::collections::HashMap;

use loadframe_api::{JobView, Page, ShownValue, unit_of_field};
use serde_json::Value;
use uuid::Uuid;

use super::database::{Builder, Row, query_scalar};
use super::encoding::{json, parsed};
use super::error::{Result, StoreError};
use super::jobs::{JobRow, SELECT_JOBS, hex_names};
use super::list::{LONGEST_PAGE, number_of, page_of};
use super::pointer::{Condition, Operand, Order, Pointer, Root};
use super::{JobFilter, Store};

/// Jobs that a search looks at before it stops.
pub const LOOKED_AT: u64 = 20_000;
/// Jobs looked at by one statement: others read and write in between.
const AT_ONCE: u32 = 2_000;
/// Longer specs are not looked into [bytes].
const LONGEST_SPEC: i64 = 200_000;
/// What the cursor of a sorted list begins with.
const PLACE: &str = "from-";

/// What of specs and results a list is about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    pub conditions: Vec<Condition>,
    pub order: Option<Order>,
    /// Values of specs to be shown; results are in every list.
    pub shown: Vec<Pointer>,
}

/// What a job is sorted by: a number, else a text; neither comes last.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    number: Option<f64>,
    text: Option<String>,
    seq: i64,
}

impl Key {
    fn compare(&self, other: &Self, is_falling: bool) -> Ordering {
        let rank = |key: &Self| match (&key.number, &key.text) {
            (Some(_), _) => 0,
            (None, Some(_)) => 1,
            (None, None) => 2,
        };
        let rising = match (&self.number, &other.number) {
            (Some(mine), Some(theirs)) => mine.total_cmp(theirs),
            _ => self.text.cmp(&other.text),
        };
        let in_order = if is_falling { rising.reverse() } else { rising };
        rank(self)
            .cmp(&rank(other))
            .then(in_order)
            .then(other.seq.cmp(&self.seq))
    }
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
        let mut page = match &wanted.order {
            Some(order) => self.sorted(filter, wanted, order, cursor, limit).await?,
            None if wanted.conditions.is_empty() => self.jobs(filter, cursor, limit).await?,
            None => self.matching(filter, wanted, cursor, limit).await?,
        };
        self.show(&mut page.items, &wanted.shown).await?;
        Ok(page)
    }

    /// The next jobs that the conditions hold for, the newest first.
    async fn matching(
        &self,
        filter: &JobFilter,
        wanted: &Wanted,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        let (mut before, mut looked_at) = (number_of(cursor)?, 0);
        let mut found: Vec<i64> = Vec::new();
        let stopped_at = loop {
            let numbers = self.numbers(filter, before, AT_ONCE).await?;
            let keys = self.keys(&numbers, &wanted.conditions, None).await?;
            found.extend(keys.into_iter().map(|key| key.seq));
            looked_at += numbers.len() as u64;
            before = numbers.last().copied().or(before);
            if found.len() > limit as usize || numbers.len() < AT_ONCE as usize {
                break None;
            }
            if looked_at >= LOOKED_AT {
                break before;
            }
        };
        found.truncate(limit as usize + 1);
        let mut page = page_of(self.rows(&found).await?, limit);
        if let Some(last) = stopped_at {
            page.next = Some(last.to_string());
            page.stopped_after = Some(looked_at);
        }
        Ok(page)
    }

    /// The newest jobs that the conditions hold for, sorted.
    async fn sorted(
        &self,
        filter: &JobFilter,
        wanted: &Wanted,
        order: &Order,
        cursor: Option<&str>,
        limit: u32,
    ) -> Result<Page<JobView>> {
        let first = place_of(cursor)?;
        let (mut before, mut looked_at) = (None, 0);
        let mut keys: Vec<Key> = Vec::new();
        let is_all = loop {
            let numbers = self.numbers(filter, before, AT_ONCE).await?;
            let some = self.keys(&numbers, &wanted.conditions, Some(order)).await?;
            keys.extend(some);
            looked_at += numbers.len() as u64;
            before = numbers.last().copied();
            if numbers.len() < AT_ONCE as usize {
                break true;
            }
            if looked_at >= LOOKED_AT {
                break self.numbers(filter, before, 1).await?.is_empty();
            }
        };
        keys.sort_unstable_by(|a, b| a.compare(b, order.is_falling));
        let last = first.saturating_add(limit as usize);
        let numbers: Vec<i64> = keys.iter().map(|key| key.seq).collect();
        let shown = numbers.get(first..last.min(numbers.len())).unwrap_or(&[]);
        let mut page = page_of(self.rows(shown).await?, limit);
        page.next = (last < numbers.len()).then(|| format!("{PLACE}{last}"));
        page.stopped_after = (!is_all).then_some(looked_at);
        Ok(page)
    }

    /// Of these jobs those that the conditions hold for, with what they are sorted by.
    async fn keys(
        &self,
        numbers: &[i64],
        conditions: &[Condition],
        order: Option<&Order>,
    ) -> Result<Vec<Key>> {
        let mut query = Builder::new("SELECT n.seq, ");
        match order {
            Some(order) => {
                // whole numbers as well
                query.push("CAST(");
                push_value(
                    &mut query,
                    &order.pointer,
                    "'integer', 'real', 'true', 'false'",
                );
                query.push(" AS DOUBLE PRECISION), ");
                push_value(&mut query, &order.pointer, "'text'");
            }
            None => {
                query.push("NULL, NULL");
            }
        }
        query.push(" FROM (SELECT key, CAST(value AS BIGINT) AS seq FROM json_each(");
        query.push_bind(json(&numbers)?);
        query.push(")) n WHERE TRUE");
        for condition in conditions {
            query.push(" AND ");
            let sign = condition.comparison.sql();
            match &condition.operand {
                Operand::Number(number) => {
                    query.push("CAST(");
                    push_value(&mut query, &condition.pointer, "'integer', 'real'");
                    query
                        .push(format!(" AS DOUBLE PRECISION) {sign} "))
                        .push_bind(*number);
                }
                Operand::Truth(truth) => {
                    query.push("CAST(");
                    push_value(&mut query, &condition.pointer, "'true', 'false'");
                    query
                        .push(format!(" AS BOOLEAN) {sign} "))
                        .push_bind(*truth);
                }
                Operand::Text(text) => {
                    push_value(&mut query, &condition.pointer, "'text'");
                    query.push(format!(" {sign} ")).push_bind(text.clone());
                }
            }
        }
        // in the order of the numbers, which fall
        query.push(" ORDER BY n.key");
        let rows: Vec<Row> = query.build().fetch_all(self.reads()).await?;
        let key = |row: Row| {
            Ok(Key {
                number: row.get(1)?,
                text: row.get(2)?,
                seq: row.get(0)?,
            })
        };
        rows.into_iter().map(key).collect()
    }

    /// These jobs, in this order.
    async fn rows(&self, numbers: &[i64]) -> Result<Vec<JobRow>> {
        let mut query = Builder::new(SELECT_JOBS);
        query.push("jobs j WHERE j.seq IN (SELECT CAST(value AS BIGINT) FROM json_each(");
        query.push_bind(json(&numbers)?).push("))");
        let mut rows: Vec<JobRow> = query.build_query_as().fetch_all(self.reads()).await?;
        let places = numbers.iter().enumerate();
        let places: HashMap<i64, usize> = places.map(|(place, seq)| (*seq, place)).collect();
        rows.sort_unstable_by_key(|row| places.get(&row.seq).copied());
        Ok(rows)
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
    query.push(format!(") IN ({types}))"));
}

fn place_of(cursor: Option<&str>) -> Result<usize> {
    let Some(cursor) = cursor else { return Ok(0) };
    let place = cursor
        .strip_prefix(PLACE)
        .and_then(|text| text.parse().ok());
    place.ok_or_else(|| StoreError::Invalid("the cursor is not one of this order".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_value_comes_last_either_way() {
        let key = |number, text: Option<&str>, seq| Key {
            number,
            text: text.map(str::to_owned),
            seq,
        };
        let keys = [
            key(None, None, 1),
            key(Some(2.0), None, 2),
            key(None, Some("b"), 3),
            key(Some(-1.0), None, 4),
            key(Some(2.0), None, 5),
            key(None, Some("a"), 6),
        ];
        for (is_falling, expected) in [(false, [4, 5, 2, 6, 3, 1]), (true, [5, 2, 4, 3, 6, 1])] {
            let mut sorted = keys.clone();
            sorted.sort_unstable_by(|a, b| a.compare(b, is_falling));
            assert_eq!(sorted.map(|key| key.seq), expected);
        }
    }
}
