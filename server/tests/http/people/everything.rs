//! All that a store has written down, for a test that looks for what must not be there.
use std::path::Path;

use sqlx::postgres::PgConnection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection};

use crate::database::address;

/// Fewer tables than any store has.
const TABLES: usize = 40;

/// All bytes of all files in a folder.
pub(super) fn bytes_of_files(folder: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => bytes.extend(bytes_of_files(&path)),
            false => bytes.extend(std::fs::read(&path).expect("a file")),
        }
    }
    bytes
}

/// Every value of every table of the database of a store in this folder, one in a line.
pub(super) async fn values_of_tables(folder: &Path) -> Vec<u8> {
    match address(folder) {
        None => in_sqlite(folder).await,
        Some(address) => in_postgres(&address).await,
    }
}

/// Reads all columns of a table by the statement that `text` makes of its name and that of a column.
macro_rules! values {
    ($connection:expr, $columns:expr, $text:expr) => {{
        let columns: Vec<(String, String)> = $columns;
        let mut tables: Vec<&String> = columns.iter().map(|(table, _)| table).collect();
        tables.dedup();
        assert!(tables.len() > TABLES, "{tables:?}");
        let mut bytes = Vec::new();
        for (table, column) in &columns {
            let text: fn(&str, &str) -> String = $text;
            let values: Vec<Option<Vec<u8>>> =
                sqlx::query_scalar(AssertSqlSafe(text(table, column)))
                    .fetch_all(&mut $connection)
                    .await
                    .expect("the values of a column");
            for value in values.into_iter().flatten() {
                bytes.extend(value);
                bytes.push(b'\n');
            }
        }
        bytes
    }};
}

async fn in_sqlite(folder: &Path) -> Vec<u8> {
    let file = SqliteConnectOptions::new()
        .filename(folder.join("loadframe.db"))
        .read_only(true);
    let mut connection: SqliteConnection = file.connect().await.expect("the database");
    // those that are hidden belong to virtual tables and hold nothing
    let columns = sqlx::query_as(
        "SELECT t.name, c.name FROM sqlite_schema t, pragma_table_xinfo(t.name) c
         WHERE t.type = 'table' AND c.hidden <> 1 ORDER BY 1, 2",
    )
    .fetch_all(&mut connection)
    .await
    .expect("its columns");
    values!(connection, columns, |table, column| format!(
        "SELECT CAST(\"{column}\" AS BLOB) FROM \"{table}\""
    ))
}

async fn in_postgres(address: &str) -> Vec<u8> {
    let mut connection = PgConnection::connect(address).await.expect("the database");
    let columns = sqlx::query_as(
        "SELECT table_name::TEXT,
            CASE data_type WHEN 'bytea' THEN quote_ident(column_name)
                ELSE 'convert_to(' || quote_ident(column_name) || '::TEXT, ''UTF8'')' END
         FROM information_schema.columns WHERE table_schema = current_schema() ORDER BY 1, 2",
    )
    .fetch_all(&mut connection)
    .await
    .expect("its columns");
    values!(connection, columns, |table, column| format!(
        "SELECT {column} FROM \"{table}\""
    ))
}
