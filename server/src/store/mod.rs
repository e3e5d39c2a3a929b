//! The store: jobs, attempts, curves, files, events, workers and tokens. Every SQL statement of
//! the system is in this folder; nothing outside it knows that there is a database.
//!
//! In `data` lie `loadframe.db` (SQLite: write-ahead log, durable at every commit), `blobs/` (files
//! under their SHA-256, with the name of the store), `incoming/` (files on their way), `set-aside/` (files
//! that were not what their names say), `reserve` (given up when the disk is full) and `lock` (one server
//! a folder, or several that share a database elsewhere). Where `files.json` says so ([`where_files`]),
//! `blobs/` and `set-aside/` are in a [`bucket`] instead; only [`storage`] knows. Whether the database is
//! SQLite's or on a PostgreSQL server, only [`database`] knows, through which every statement goes.
//!
//! A change goes `Store::…` → [`writer`] (one connection, group commit) → the command's method on
//! [`writer::Change`] → for steps of a job's lifecycle [`state`], which asks [`crate::queue`] → events →
//! commit → answer. Reads go to pools of connections that cannot write, beside it: one for lists and
//! results, one for what takes a moment and must not wait behind them.
//!
//! What was deleted lies in the [`trash`] for a while. Lists are [`list`], by values
//! of specs and results [`search`], which are [`kept`] and sorted by a [`key`]; jobs one by one [`jobs`], many side by side [`compared`]. The worker's side in the
//! order of a job: [`claim`], of what [`choice`] decides, [`lease`] (heartbeats in [`pulses`]) with [`curve`] and
//! [`log`], [`files`] and [`checkpoints`] over [`blobs`] and [`arriving`] on the [`disk`] (or sent [`directly`] to the bucket),
//! [`ending`]; if the worker falls silent by the [`clock`], [`sweep`]; if its machine is at fault, [`machines`]. Whose
//! things are, and what was done by whom: [`people`].
//!
//! That nothing is lost unseen: [`identity`] tells whether database and files belong together, the
//! [`collector`] removes what no row names, [`scrub`] finds what is missing or has changed, and [`backup`]
//! copies both in the right order; [`moving`] brings a lab from one database to another. That a full disk or a panic ends nothing: [`reserve`], [`supervision`].
mod arriving;
mod backlog;
mod backup;
mod blobs;
mod bucket;
mod calls;
mod checkpoints;
mod choice;
mod claim;
mod clock;
mod collector;
mod compared;
mod curve;
mod database;
mod directly;
mod disk;
mod encoding;
mod ending;
mod error;
mod events;
mod files;
mod folder;
mod handle;
mod identity;
mod jobs;
mod kept;
mod key;
mod lease;
mod list;
mod log;
mod machines;
mod moving;
mod open;
pub mod people;
mod place;
pub mod pointer;
mod private;
mod pulses;
mod removal;
mod reserve;
mod scrub;
mod search;
mod state;
mod storage;
mod submit;
mod supervision;
mod sweep;
mod texts;
pub mod trash;
mod types;
mod waiting;
mod where_files;
mod workers;
mod writer;

pub use backup::{BackupReport, backup, backup_from, restore, restore_to};
pub use bucket::{BucketKeys, BucketSettings};
pub use calls::Waiting;
pub use clock::Clock;
pub use compared::{Compared, CurvePart};
pub use database::{DatabaseAddress, DatabasePlace};
pub(crate) use error::chain;
pub use error::{Loss, StoreError};
pub use events::StoredEvent;
pub use handle::Store;
pub use moving::{MoveReport, move_store};
pub use scrub::{LostFile, ScrubReport};
pub use search::Wanted;
pub use storage::Content;
pub use types::*;
