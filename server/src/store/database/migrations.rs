//! The history of each database: every file of `migrations/` for SQLite, and of `migrations/postgres/`.
//!
//! Listed here instead of by `sqlx::migrate!`, whose crate of macros brings a second SQLite and a
//! second of everything below it into every build.
use sqlx::SqlSafeStr;
use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};

use super::super::error::StoreError;

/// A step: its version, what it is about, its file and the text of it.
type Step = (i64, &'static str, &'static str, &'static str);

macro_rules! steps {
    ($folder:literal: $($version:literal $description:literal $file:literal,)+) => {
        &[$((
            $version,
            $description,
            $file,
            include_str!(concat!("../../../../migrations/", $folder, $file)),
        ),)+]
    };
}

// A description is kept with the checksum of its file in every database: neither ever changes.
const SQLITE: &[Step] = steps! { "":
    1 "jobs" "0001_jobs.sql",
    2 "events workers tokens" "0002_events_workers_tokens.sql",
    3 "store" "0003_store.sql",
    4 "faults" "0004_faults.sql",
    5 "people" "0005_people.sql",
    6 "long queue" "0006_long_queue.sql",
    7 "matched work" "0007_matched_work.sql",
    8 "single sign-on" "0008_single_sign_on.sql",
    9 "order" "0009_order.sql",
    10 "comparisons" "0010_comparisons.sql",
    12 "resumed curves" "0012_resumed_curves.sql",
    13 "late checkpoints" "0013_late_checkpoints.sql",
    14 "trash" "0014_trash.sql",
    15 "limits are told" "0015_limits_are_told.sql",
    16 "mails" "0016_mails.sql",
    17 "kept values" "0017_kept_values.sql",
    18 "texts in bulk" "0018_texts_in_bulk.sql",
    19 "lighter submissions" "0019_lighter_submissions.sql",
    20 "received projects" "0020_received_projects.sql",
};

const POSTGRES: &[Step] = steps! { "postgres/":
    1 "words" "0001_words.sql",
    2 "tables" "0002_tables.sql",
    3 "triggers" "0003_triggers.sql",
    4 "texts" "0004_texts.sql",
    5 "kept values" "0005_kept_values.sql",
    6 "lighter submissions" "0006_lighter_submissions.sql",
    7 "received projects" "0007_received_projects.sql",
};

pub(super) fn of_sqlite() -> Migrator {
    migrator(SQLITE)
}

pub(super) fn of_postgres() -> Migrator {
    migrator(POSTGRES)
}

fn migrator(steps: &[Step]) -> Migrator {
    let migrations = steps.iter().map(|(version, description, _, text)| {
        let kind = MigrationType::Simple;
        let text = text.into_sql_str();
        Migration::new(*version, (*description).into(), kind, text, false)
    });
    Migrator::with_migrations(migrations.collect())
}

/// What a step of the schema that this version does not know means.
pub(super) fn newer(migrations: &Migrator, error: MigrateError) -> StoreError {
    let known = migrations.iter().map(|step| step.version).max();
    match error {
        MigrateError::VersionMissing(found) => StoreError::Newer {
            found,
            known: known.unwrap_or_default(),
        },
        error => error.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_listed() {
        for (folder, steps) in [("", SQLITE), ("/postgres", POSTGRES)] {
            let folder = format!("{}/../migrations{folder}", env!("CARGO_MANIFEST_DIR"));
            let files = std::fs::read_dir(folder).expect("the folder is in the repository");
            let files = files.map(|file| file.expect("its entries can be read").file_name());
            let is_step = |name: &std::ffi::OsString| name.as_encoded_bytes().ends_with(b".sql");
            let mut files: Vec<_> = files.filter(is_step).collect();
            files.sort();
            let names: Vec<_> = steps.iter().map(|(_, _, name, _)| *name).collect();
            assert_eq!(files, names);
        }
    }

    #[test]
    fn checksums_are_those_of_databases_in_use() {
        let migrator = of_sqlite();
        let first_bytes: Vec<String> = migrator
            .iter()
            .map(|migration| {
                let checksum = migration.checksum.iter().take(8);
                checksum.map(|byte| format!("{byte:02x}")).collect()
            })
            .collect();
        // the first bytes of `SELECT checksum FROM _sqlx_migrations` in a database of this version
        assert_eq!(
            first_bytes,
            [
                "113f34295d37f7b1",
                "7b1cc992a8fbe6cf",
                "1279b1c9613624d6",
                "0db3a0d1a44e743a",
                "123a8c73e88306c8",
                "c65afbc9fc6604c3",
                "0a197c6c762f4095",
                "b11dab88d99dde32",
                "75d99417d89a76b5",
                "ca4307289839b7bc",
                "3d56df3cc4285dd2",
                "1c81df07ed90fcb2",
                "06d67708710a1c1f",
                "944ffa9e1f350752",
                "1e60e7629c76ed2c",
                "4cb74f3addabd3d8",
                "0b311f71be1424ba",
                "18e39f0776760a48",
                "490499724f31b21e"
            ]
        );
    }

    #[tokio::test]
    async fn projects_of_before_that_their_person_did_not_make_are_received() {
        use sqlx::{Connection as _, Executor as _, Row as _, SqliteConnection};
        let mut database = SqliteConnection::connect("sqlite::memory:")
            .await
            .expect("a database");
        let (before, _) = SQLITE.split_at(SQLITE.partition_point(|step| step.0 < 20));
        let before = migrator(before);
        let before = before.run_direct(None, &mut database, false);
        before.await.expect("the schema of before");
        // B has the project of the account, one that B made, one of A's account, and one that A made
        let lab = "INSERT INTO people (id, name, folded, role, password, created_at)
            VALUES (x'0a', 'A', 'a', 'administrator', '', 100), (x'0b', 'B', 'b', 'member', '', 200);
            INSERT INTO groups (id, name, folded, created_at) VALUES (x'0c', 'G', 'g', 150);
            INSERT INTO projects (id, name, person, team, visibility, created_at)
            VALUES (x'01', 'of the account', x'0b', NULL, 'private', 200),
                   (x'02', 'made', x'0b', NULL, 'private', 300),
                   (x'03', 'of the account of A', x'0b', NULL, 'everyone', 100),
                   (x'04', 'made by A', x'0b', NULL, 'everyone', 150),
                   (x'05', 'of a group', NULL, x'0c', 'group', 160);
            INSERT INTO audit (at, who, person, action, object, detail, address)
            VALUES (150, 'A', x'0a', 'project.made', x'04', 'made by A', ''),
                   (160, 'A', x'0a', 'project.made', x'05', 'of a group', ''),
                   (300, 'B', x'0b', 'project.made', x'02', 'made', ''),
                   (400, 'B', x'0b', 'project.changed', x'04', 'made by A', '')";
        database.execute(lab).await.expect("a lab");
        let after = of_sqlite();
        let after = after.run_direct(None, &mut database, false);
        after.await.expect("the schema of now");
        let received = database.fetch_all("SELECT id FROM projects WHERE is_received ORDER BY id");
        let received = received.await.expect("projects");
        let ids: Vec<Vec<u8>> = received.iter().map(|row| row.get(0)).collect();
        assert_eq!(ids, [[3], [4]]);
    }
}
