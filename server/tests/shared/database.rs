//! Which database the tests of the store, the service and the simulation run on: SQLite, or PostgreSQL where
//! `LOADFRAME_TEST_POSTGRES` names a server (`tests/postgres` starts one of its own), with a schema for every
//! folder.
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::Path;

use loadframe_server::store::DatabasePlace;

/// The variable that names a server, without `?`.
const SERVER: &str = "LOADFRAME_TEST_POSTGRES";

/// The database of a store in this folder.
pub(crate) fn place(folder: &Path) -> DatabasePlace {
    match address(folder) {
        None => DatabasePlace::Folder,
        Some(address) => DatabasePlace::Server(address.parse().expect("PostgreSQL answers")),
    }
}

/// Its address, where it is not in the folder.
pub(crate) fn address(folder: &Path) -> Option<String> {
    let server = std::env::var(SERVER).ok()?;
    let mut hash = DefaultHasher::new();
    folder.hash(&mut hash);
    let schema = format!("test_{:016x}", hash.finish());
    make(&server, &schema);
    Some(format!("{server}?options[search_path]={schema}"))
}

/// Makes the schema where it is not there yet; callers are in the middle of other work of their runtime.
fn make(server: &str, schema: &str) {
    use sqlx::{AssertSqlSafe, Connection as _, postgres::PgConnection};
    let work = async {
        let mut connection = PgConnection::connect(server)
            .await
            .expect("PostgreSQL answers");
        let text = format!("CREATE SCHEMA IF NOT EXISTS {schema}");
        sqlx::query(AssertSqlSafe(text))
            .execute(&mut connection)
            .await
            .expect("PostgreSQL answers");
        connection.close().await.expect("PostgreSQL answers");
    };
    std::thread::scope(|scope| {
        let thread = scope.spawn(|| {
            let mut runtime = tokio::runtime::Builder::new_current_thread();
            runtime
                .enable_all()
                .build()
                .expect("PostgreSQL answers")
                .block_on(work);
        });
        thread.join().expect("PostgreSQL answers");
    });
}
