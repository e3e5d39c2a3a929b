//! The server's database beside the server: how many rows it holds, and rows made to say what a test needs.
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, query, query_scalar};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;
use uuid::Uuid;

/// Rows by table of the database in a server's data folder.
pub fn rows(data: &Path) -> BTreeMap<String, i64> {
    wait(count(data)).unwrap()
}

/// Carries out a statement about the one job `id`, and waits its turn among the server's.
///
/// # Panics
/// When it changes no row.
pub fn edit_rows(data: &Path, statement: &str, id: Uuid) {
    let changed = wait(async {
        let options = SqliteConnectOptions::new()
            .filename(data.join("loadframe.db"))
            .busy_timeout(Duration::from_secs(30));
        let mut database: SqliteConnection = options.connect().await?;
        let statement = query(AssertSqlSafe(statement.to_owned())).bind(id);
        statement.execute(&mut database).await
    });
    assert_ne!(changed.unwrap().rows_affected(), 0, "{statement}");
}

fn wait<T>(question: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(question)
}

async fn count(data: &Path) -> sqlx::Result<BTreeMap<String, i64>> {
    let options = SqliteConnectOptions::new()
        .filename(data.join("loadframe.db"))
        .read_only(true);
    let mut database: SqliteConnection = options.connect().await?;
    let tables: Vec<String> =
        query_scalar("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")
            .fetch_all(&mut database)
            .await?;
    let mut rows = BTreeMap::new();
    for table in tables {
        let query = AssertSqlSafe(format!("SELECT count(*) FROM \"{table}\""));
        rows.insert(table, query_scalar(query).fetch_one(&mut database).await?);
    }
    Ok(rows)
}
