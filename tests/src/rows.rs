//! How many rows the server's database holds, read beside the server.
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, query_scalar};
use std::collections::BTreeMap;
use std::path::Path;

/// Rows by table of the database in a server's data folder.
pub fn rows(data: &Path) -> BTreeMap<String, i64> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(count(data)).unwrap()
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
