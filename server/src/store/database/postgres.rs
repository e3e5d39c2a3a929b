//! PostgreSQL: a database that several servers share, reached over the network.
//!
//! What only PostgreSQL understands is here, and in `migrations/postgres/`, whose first file teaches it the
//! words of SQLite that statements use. Their texts are [`translated`] as far as the rest goes: places, the
//! empty bytes `x''`, and SQLite's hints, which it has no use for.
//!
//! A batch of the writer begins with one advisory lock of the whole store, which is what `BEGIN IMMEDIATE` is
//! for SQLite: of all servers one writes at a time and sees all that was written before, so that every
//! decision is made on the newest state, in one place. Claims by `SKIP LOCKED` would make a second such
//! place; what limits both is the disk's time for a commit, which a batch shares.
use sqlx::postgres::{
    PgArguments, PgConnectOptions, PgConnection, PgPool, PgPoolOptions, PgQueryResult, Postgres,
};
use sqlx::{AssertSqlSafe, ConnectOptions, Executor, SqlSafeStr, SqlStr};

use super::backend::{self, Backend};
use super::connection::Reading;
use super::own_words::Texts;
use super::value::{Done, Kind, Value};

/// Takes the store in this schema of this database for a transaction, and tells the moment.
const BEGIN: &str = "BEGIN ISOLATION LEVEL READ COMMITTED;
     SELECT pg_advisory_xact_lock(hashtext('loadframe'), hashtext(current_schema()));
     SELECT (1000 * extract(epoch FROM clock_timestamp()))::BIGINT";
/// Tells the text ?1 to the other servers on the store, when the transaction stays.
pub(super) const TELL: &str = "SELECT pg_notify('loadframe_' || md5(current_schema()), ?)";
/// Under which name that is told.
pub(super) const CHANNEL: &str = "SELECT 'loadframe_' || md5(current_schema())";
/// A transaction that sees the database as it is at one moment.
pub(super) const SNAPSHOT: &str = "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY";
/// Numbers an event and makes that its job's version: ?1 the job's id, ?2 the event's type, ?3 the moment.
pub(super) const EVENT: &str = "WITH event AS (
        INSERT INTO events (job, type, at) VALUES (?1, ?2, ?3)
        ON CONFLICT (job, type) DO UPDATE SET
            seq = nextval(pg_get_serial_sequence('events', 'seq')), at = excluded.at, owner = NULL, project = NULL
        RETURNING seq),
     told AS (UPDATE jobs SET version = (SELECT seq FROM event), updated_at = ?3 WHERE id = ?1)
     SELECT seq FROM event";
/// Whether a job was ever submitted.
pub(super) const HAS_HAD_JOBS: &str = "SELECT is_called FROM jobs_seq_seq";
/// Makes the index of texts anew.
pub(super) const INDEX_TEXTS: &str =
    "INSERT INTO job_texts (job, trigrams) SELECT seq, trigrams(name, notes, tags) FROM jobs";
/// Columns of the table ?1, other than those that follow from others.
pub(super) const COLUMNS: &str = "SELECT column_name::TEXT FROM information_schema.columns
     WHERE table_schema = current_schema() AND table_name = ? AND is_generated = 'NEVER'
     ORDER BY ordinal_position";
/// Texts of its own.
pub(super) const TEXTS: Texts = Texts {
    // the newest of each, of which the newest
    newest_seen: "SELECT s.seq FROM (
            SELECT p.seq FROM json_each(?2) e CROSS JOIN LATERAL (
                SELECT j.seq FROM jobs j WHERE j.project = unhex(e.value) AND j.seq < ?1
                    AND j.owner IS DISTINCT FROM ?4
                ORDER BY j.seq DESC LIMIT ?6) p
            UNION ALL
            SELECT o.seq FROM (
                SELECT j.seq FROM jobs j WHERE j.owner = ?3 AND j.seq < ?1
                    AND (j.project IS NULL OR j.project NOT IN (SELECT unhex(value) FROM json_each(?5)))
                ORDER BY j.seq DESC LIMIT ?6) o) s
         ORDER BY s.seq DESC LIMIT ?6",
    folded: "folded",
    number_of_text: "t.job",
    text_found: ["t.trigrams @> trigrams(", ")"],
    index_decides: false,
    new_texts: None,
};
/// Columns of the table ?1, other than those that follow from others, and their types.
pub(super) const KINDS: &str =
    "SELECT column_name::TEXT, data_type::TEXT FROM information_schema.columns
     WHERE table_schema = current_schema() AND table_name = ? AND is_generated = 'NEVER'
     ORDER BY ordinal_position";
/// A writer that stands still in a transaction for longer keeps all other servers from writing: its machine may
/// be gone, and the database ends it.
const STANDSTILL: &str = "10s";

/// Statements are many and short, and what they may cost at worst is far from what they do: compiling one takes
/// a thousand times as long as carrying it out.
const AS_IT_IS: (&str, &str) = ("jit", "off");
/// How lists are planned: for the values that they are asked with (of texts some are in all jobs and some in none),
/// by one process each, and for disks that read anywhere as fast as on. What is looked up by its name is planned
/// once: planning the reading of one job takes five times as long as reading it.
const OF_LISTS: [(&str, &str); 3] = [
    ("plan_cache_mode", "force_custom_plan"),
    ("max_parallel_workers_per_gather", "0"),
    ("random_page_cost", "1.1"),
];

/// A connection that writes.
pub(super) async fn connect(database: &PgConnectOptions) -> sqlx::Result<PgConnection> {
    let standstill = ("idle_in_transaction_session_timeout", STANDSTILL);
    let database = database.clone().options([standstill, AS_IT_IS]);
    database.connect().await
}

/// Begins a transaction that may write; tells the moment by the database's clock [ms since 1970].
pub(super) async fn begin_writing(connection: &mut PgConnection) -> sqlx::Result<i64> {
    let rows = sqlx::raw_sql(BEGIN).fetch_all(connection).await?;
    let moment = rows.last().ok_or(sqlx::Error::RowNotFound)?;
    sqlx::Row::try_get(moment, 0)
}

/// A type as the database names it.
pub(super) fn kind(name: &str) -> Kind {
    match name {
        "bigint" | "integer" => Kind::Integer,
        "double precision" => Kind::Real,
        "boolean" => Kind::Boolean,
        "bytea" => Kind::Bytes,
        _ => Kind::Text,
    }
}

/// Connections that cannot write.
pub(super) async fn reading(
    database: &PgConnectOptions,
    connections: u32,
    what: Reading,
) -> sqlx::Result<PgPool> {
    let read_only = ("default_transaction_read_only", "on");
    let mut read_only = database.clone().options([read_only, AS_IT_IS]);
    if what == Reading::Lists {
        read_only = read_only.options(OF_LISTS);
    }
    PgPoolOptions::new()
        .max_connections(connections)
        .connect_with(read_only)
        .await
}

impl Backend for Postgres {
    fn worded(text: SqlStr) -> SqlStr {
        AssertSqlSafe(translated(text.as_str())).into_sql_str()
    }

    fn arguments(values: Vec<Value>) -> sqlx::Result<PgArguments> {
        backend::arguments::<Self>(values)
    }

    fn on(connection: &mut PgConnection) -> impl Executor<'_, Database = Self> {
        connection
    }

    fn on_any(pool: &PgPool) -> impl Executor<'_, Database = Self> {
        pool
    }
}

impl From<PgQueryResult> for Done {
    fn from(done: PgQueryResult) -> Self {
        Self {
            rows_affected: done.rows_affected(),
        }
    }
}

/// A statement in PostgreSQL's words: `?` and `?1` are `$1`, `x''` is `''::bytea`, and `INDEXED BY` is left out.
fn translated(text: &str) -> String {
    const HINT: &str = "INDEXED BY ";
    let mut to = String::with_capacity(text.len() + 16);
    let (mut rest, mut places) = (text, 0_usize);
    while let Some(at) = rest.find(['?', '\'', '"', '-', 'I', 'x']) {
        to.push_str(&rest[..at]);
        rest = &rest[at..];
        let taken = match rest.as_bytes()[0] {
            b'?' => {
                let digits = rest[1..].bytes().take_while(u8::is_ascii_digit).count();
                to.push('$');
                if digits == 0 {
                    places += 1;
                    to.push_str(&places.to_string());
                }
                to.push_str(&rest[1..=digits]);
                1 + digits
            }
            b'x' if rest.starts_with("x''") && !ends_in_word(&to) => {
                to.push_str("''::bytea");
                3
            }
            b'I' if rest.starts_with(HINT) => HINT.len() + word(&rest[HINT.len()..]),
            quote @ (b'\'' | b'"') => {
                let end = rest[1..]
                    .find(quote as char)
                    .map_or(rest.len(), |end| end + 2);
                to.push_str(&rest[..end]);
                end
            }
            b'-' if rest.starts_with("--") => rest.find('\n').unwrap_or(rest.len()),
            _ => {
                to.push_str(&rest[..1]);
                1
            }
        };
        rest = &rest[taken..];
    }
    to.push_str(rest);
    to
}

/// Length of the word at the beginning.
fn word(text: &str) -> usize {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    text.bytes().take_while(is_part).count()
}

fn ends_in_word(text: &str) -> bool {
    text.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::translated;

    #[test]
    fn places_and_empty_bytes_are_written_as_postgresql_has_them() {
        assert_eq!(
            translated(
                "SELECT ? || '?x''''', x'' FROM jobs j INDEXED BY jobs_waiting WHERE a = ? -- why?\n AND max = ?12"
            ),
            "SELECT $1 || '?x''''', ''::bytea FROM jobs j  WHERE a = $2 \n AND max = $12"
        );
        assert_eq!(
            translated(r#"INSERT INTO store ("only") VALUES (x'')"#),
            r#"INSERT INTO store ("only") VALUES (''::bytea)"#
        );
    }
}
