//! Several statements in one go: for SQLite every statement is a way to the connection's thread and back, which
//! takes longer than most statements.
use futures_util::stream::TryStreamExt;
use sqlx::sqlite::Sqlite;
use sqlx::{AssertSqlSafe, Either, Executor};

use super::backend::{Backend, Link};
use super::statement::Query;
use super::value::Row;

/// Runs statements one after the other; the rows of each.
///
/// # Errors
/// The database's; those after the one that failed are then not run.
pub(super) async fn run(
    link: &mut Link<Sqlite>,
    queries: Vec<Query>,
) -> sqlx::Result<Vec<Vec<Row>>> {
    let (mut text, mut values) = (String::new(), Vec::new());
    // where, among all statements, those of each text end
    let mut ends = Vec::with_capacity(queries.len());
    let mut statements = 0;
    for query in queries {
        let of_query = query.text.as_str();
        numbered(of_query, values.len(), &mut text);
        text.push_str(";\n");
        values.extend(query.values);
        statements += of_query.matches(';').count() + 1;
        ends.push(statements);
    }
    let arguments = Sqlite::arguments(values)?;
    let joined = sqlx::query_with(AssertSqlSafe(text), arguments);
    let mut answers = Sqlite::on(link.connection()).fetch_many(joined);
    let mut rows: Vec<Vec<Row>> = ends.iter().map(|_| Vec::new()).collect();
    let (mut at, mut done) = (0, 0);
    while let Some(answer) = answers.try_next().await? {
        match answer {
            Either::Left(_) => {
                done += 1;
                while ends.get(at).is_some_and(|end| *end <= done) {
                    at += 1;
                }
            }
            Either::Right(row) => {
                if let Some(rows) = rows.get_mut(at) {
                    rows.push(Row::from(row));
                }
            }
        }
    }
    Ok(rows)
}

/// Appends a statement with its places, `?` and `?1`, numbered after `before` others: as `$7`, which has no
/// places before it that the statement does not have, as `?7` would.
fn numbered(statement: &str, before: usize, to: &mut String) {
    let (mut rest, mut places) = (statement, 0);
    while let Some(at) = rest.find(['?', '\'']) {
        to.push_str(&rest[..at]);
        rest = &rest[at..];
        let taken = if let Some(after) = rest.strip_prefix('?') {
            let digits = after.bytes().take_while(u8::is_ascii_digit).count();
            places += 1;
            let place = after[..digits].parse().unwrap_or(places);
            to.push('$');
            to.push_str(&(before + place).to_string());
            1 + digits
        } else {
            let end = rest[1..].find('\'').map_or(rest.len(), |end| end + 2);
            to.push_str(&rest[..end]);
            end
        };
        rest = &rest[taken..];
    }
    to.push_str(rest);
}

#[cfg(test)]
mod tests {
    use super::super::{Database, DatabasePlace, query, query_scalar};
    use super::numbered;

    #[test]
    fn places_follow_those_before() {
        let mut text = String::new();
        numbered("SELECT ?2, '?', ?1", 3, &mut text);
        assert_eq!(text, "SELECT $5, '?', $4");
        text.clear();
        numbered("INSERT INTO t VALUES (?, ?)", 1, &mut text);
        assert_eq!(text, "INSERT INTO t VALUES ($2, $3)");
    }

    #[tokio::test]
    async fn each_statement_gets_its_values_and_gives_its_rows() {
        let folder = tempfile::tempdir().expect("a folder");
        let database = Database::at(&DatabasePlace::Folder, folder.path());
        let mut connection = database.connect().await.expect("a connection");
        let all = connection.run_all(vec![
            query("CREATE TABLE t (a INTEGER)"),
            query("INSERT INTO t VALUES (?2), (?1); UPDATE t SET a = a + ?1")
                .bind(10)
                .bind(2),
            query("SELECT a FROM t WHERE a > ? ORDER BY a").bind(0),
            query("SELECT a FROM t WHERE a = ?1").bind(20),
        ]);
        let rows = all.await.expect("they run");
        let numbers = |rows: &[super::Row]| -> Vec<i64> {
            rows.iter()
                .map(|row| row.get(0).expect("a number"))
                .collect()
        };
        let rows: Vec<_> = rows.iter().map(|rows| numbers(rows)).collect();
        assert_eq!(rows, [vec![], vec![], vec![12, 20], vec![20]]);
        let all = connection.run_all(vec![
            query("INSERT INTO t VALUES (1)"),
            query("INSERT INTO missing VALUES (1)"),
            query("DELETE FROM t"),
        ]);
        assert!(all.await.is_err());
        let left = query_scalar("SELECT COUNT(*) FROM t").fetch_one(&mut connection);
        let left: i64 = left.await.expect("it runs");
        assert_eq!(left, 3);
    }
}
