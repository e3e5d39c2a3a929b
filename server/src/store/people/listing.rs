//! The newest jobs of somebody who does not see all of them, without a walk through all the others.
use uuid::Uuid;

use super::super::Store;
use super::super::database::query_scalar;
use super::super::error::Result;
use super::super::jobs::hex_names;
use crate::access::Sight;

impl Store {
    /// Numbers of the newest `count` jobs before the number `before` that `sight` shows, newest first.
    ///
    /// Every project, and the jobs of the person, are a stream that falls, and the database merges them: so a
    /// page takes as long among a million jobs as among a thousand.
    pub(in super::super) async fn newest_seen(
        &self,
        sight: &Sight,
        before: i64,
        count: u32,
    ) -> Result<Vec<i64>> {
        // a link to one job, or to those of a comparison
        if !sight.jobs.is_empty() {
            let seq = query_scalar(
                "SELECT seq FROM jobs WHERE id IN (SELECT unhex(value) FROM json_each(?)) AND seq < ?
                 ORDER BY seq DESC LIMIT ?",
            )
            .bind(hex_names(&sight.jobs)?)
            .bind(before)
            .bind(count)
            .fetch_all(self.reads())
            .await?;
            return Ok(seq);
        }
        let seen_projects = sight.projects.iter().copied();
        let projects: Vec<Uuid> = seen_projects
            .filter(|project| !sight.not_in.contains(project))
            .collect();
        let mut seen: Vec<i64> = query_scalar(self.reads().texts().newest_seen)
            .bind(before)
            .bind(hex_names(&projects)?)
            .bind(sight.owner)
            .bind(sight.not_of)
            .bind(hex_names(&sight.not_in)?)
            // one's own job in a project that one sees comes twice, one after the other
            .bind(2 * count)
            .fetch_all(self.reads())
            .await?;
        seen.dedup();
        seen.truncate(count as usize);
        Ok(seen)
    }
}
