//! The schema of a world, where its database is PostgreSQL's.
use std::path::Path;

use sqlx::Connection;
use sqlx::postgres::PgConnection;

/// Removes it: ten thousand of them would fill the server, as folders would the disk.
pub(crate) async fn forget(folder: &Path) {
    let Some(address) = crate::database::address(folder) else {
        return;
    };
    let mut connection = PgConnection::connect(&address).await.unwrap();
    let text = "DO $$ BEGIN EXECUTE format('DROP SCHEMA %I CASCADE', current_schema()); END $$";
    sqlx::raw_sql(text).execute(&mut connection).await.unwrap();
    connection.close().await.unwrap();
}
