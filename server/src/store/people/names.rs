//! Names of people and projects, for lists of what is theirs.
//!
//! They are few and stand in many rows, and hardly ever change: they are [`super::remembered`]. What renames one
//! ([`Store::change_project`]) is among the changes of access that are counted.
use std::collections::BTreeSet;

use uuid::Uuid;

use super::super::Store;
use super::super::database::query_as;
use super::super::error::Result;
use super::super::jobs::hex_names;
use super::remembered::Names;

impl Store {
    /// Names of these people and projects, where access has changed so often by now.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn names(&self, access: u64, of: &BTreeSet<Uuid>) -> Result<Names> {
        let mut names = self.access_state().names(access, of);
        let unknown = of.iter().filter(|id| !names.contains_key(id));
        let unknown: Vec<Uuid> = unknown.copied().collect();
        if unknown.is_empty() {
            return Ok(names);
        }
        let read: Vec<(Uuid, String)> = query_as(
            "SELECT id, name FROM people WHERE id IN (SELECT unhex(value) FROM json_each(?1))
             UNION ALL
             SELECT id, name FROM projects WHERE id IN (SELECT unhex(value) FROM json_each(?1))",
        )
        .bind(hex_names(&unknown)?)
        .fetch_all(self.reads())
        .await?;
        let read = read.into_iter().map(|(id, name)| (id, name.into()));
        let read: Names = read.collect();
        self.access_state().remember_names(access, &read);
        names.extend(read);
        Ok(names)
    }
}
