//! The one connection that writes, and the task that owns it.
//!
//! Making a commit durable takes the disk far longer than making a change. So the task takes all
//! commands that are waiting, runs each in a savepoint of its own inside one transaction, commits
//! once, and only then answers. A command alone does not wait for company.
//!
//! Of several servers on one database each has such a task, and one writes at a time; what it commits, it
//! tells the others.
//!
//! A command that panics, or a connection that fails, costs the transaction: the connection is opened anew,
//! as often as it takes, and the task goes on.
//!
//! One file, long as it is: what stays, what is told and what is answered are only right in the task's order.
use std::any::Any;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use loadframe_api::Timestamp;
use tokio::sync::{mpsc, oneshot, watch};
use uuid::Uuid;

use super::clock::Clock;
use super::collector::{Garbage, Moment, Reports};
use super::database::{self, Connection, Database, News, Query, Row, Undo, raise};
use super::error::{Result, StoreError};
use super::people::{Actor, Line};
use super::reserve::{Reserve, told_full};
use super::supervision::{Restarts, caught, until_done};
use crate::tasks;

/// Commands in one commit; beyond this, the first of them would wait too long for the last.
const LARGEST_BATCH: usize = 256;

/// A transaction that waits longer to begin finds the database held by somebody else.
const LONG_WAIT: Duration = Duration::from_secs(1);

/// A future of a command, which borrows the change it works on.
pub(super) type Work<'c, T> = Pin<Box<dyn Future<Output = Result<T>> + Send + 'c>>;

/// What a command returns, whatever it is: there is one road for all, not one compiled for each.
pub(super) type Answer = Box<dyn Any + Send>;

/// A command that returns an [`Answer`].
pub(super) type Run = Box<dyn for<'c> FnOnce(&'c mut Change) -> Work<'c, Answer> + Send>;

/// A command as the writer takes it.
pub(super) fn boxed<T, F>(command: F) -> Run
where
    T: Send + 'static,
    F: for<'c> FnOnce(&'c mut Change) -> Work<'c, T> + Send + 'static,
{
    Box::new(move |change| {
        let work = command(change);
        Box::pin(async move { Ok(Box::new(work.await?) as Answer) })
    })
}

/// What the command of [`boxed`] returned.
pub(super) fn unboxed<T: 'static>(answer: Answer) -> Result<T> {
    let answer = answer.downcast();
    answer.map_or(Err(StoreError::Unavailable), |value| Ok(*value))
}

/// How much a command changes at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    /// A few hundred rows.
    Usual,
    /// All jobs there are.
    Large,
}

/// What somebody wants to be done in a transaction.
struct Command {
    run: Run,
    actor: Option<Arc<Actor>>,
    size: Size,
    answer: oneshot::Sender<Result<Answer>>,
}

/// A command that has run, to be answered once its changes are safe.
struct Ended {
    answer: oneshot::Sender<Result<Answer>>,
    result: Result<Answer>,
}

/// The change that commands work on: the connection, and what is to follow the commit.
pub(super) struct Change {
    pub(super) connection: Connection,
    clock: Clock,
    /// The moment at which the command happens.
    pub(super) now: Timestamp,
    /// When a transaction last failed, or waited long to begin [ms since 1970]: nobody could be heard
    /// of until then.
    pub(super) last_trouble: i64,
    /// Who makes the change, where somebody does.
    pub(super) actor: Option<Arc<Actor>>,
    /// Why the disk is taken for full, where a command has found it so.
    full: Option<String>,
    effects: Effects,
}

/// What follows a commit.
#[derive(Debug, Default)]
struct Effects {
    last_event: Option<u64>,
    queued: bool,
    /// Files that may have lost the last row that names them.
    garbage: Vec<String>,
    /// Before they could lose it.
    moment: Moment,
    /// Lines for the audit log, which are part of the transaction.
    lines: Vec<Line>,
}

/// Types of events, see the table of that name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EventType {
    Job,
    Progress,
    Points,
    Deleted,
}

impl EventType {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Job => "job",
            Self::Progress => "progress",
            Self::Points => "points",
            Self::Deleted => "deleted",
        }
    }
}

impl Ended {
    /// Answers, if anybody still waits.
    fn tell(self) {
        let _ = self.answer.send(self.result);
    }
}

impl Change {
    /// Runs a command; whether its changes are to stay.
    async fn run(&mut self, command: Command, answers: &mut Vec<Ended>) -> bool {
        let answer = command.answer;
        if answer.is_closed() {
            return false;
        }
        self.actor = command.actor;
        let result = (command.run)(self).await;
        self.full = result.as_ref().err().and_then(told_full);
        let stays = result.is_ok();
        answers.push(Ended { answer, result });
        stays
    }

    /// Notes that a job has changed. The event's number becomes the version of the job.
    pub(super) async fn event(&mut self, job: Uuid, kind: EventType) -> Result<()> {
        self.event_after(Vec::new(), job, kind).await?;
        Ok(())
    }

    /// Runs `statements`, and notes that a job has changed by them; the rows of each. In one go, for others
    /// wait until it is done.
    pub(super) async fn event_after(
        &mut self,
        statements: Vec<Query>,
        job: Uuid,
        kind: EventType,
    ) -> Result<Vec<Vec<Row>>> {
        self.event_among(statements, job, kind, None).await
    }

    /// [`Self::event_after`], and then one more statement.
    pub(super) async fn event_among(
        &mut self,
        mut statements: Vec<Query>,
        job: Uuid,
        kind: EventType,
        last: Option<Query>,
    ) -> Result<Vec<Vec<Row>>> {
        let (at, place) = (self.now.as_millis(), statements.len());
        statements.push(self.connection.event(job, kind.name(), at));
        statements.extend(last);
        let mut rows = self.connection.run_all(statements).await?;
        if place >= rows.len() {
            return Err(sqlx::Error::RowNotFound.into());
        }
        let event = rows.remove(place);
        let number: i64 = event.first().ok_or(sqlx::Error::RowNotFound)?.get(0)?;
        self.effects.last_event = u64::try_from(number).ok();
        Ok(rows)
    }

    /// Notes that a job is waiting in the queue.
    pub(super) fn queued(&mut self) {
        self.effects.queued = true;
    }

    /// Notes a line for the audit log, which is written before the commit.
    pub(super) fn note_line(&mut self, line: Line) {
        self.effects.lines.push(line);
    }

    /// Notes files that may have lost the last row that names them.
    pub(super) fn garbage(&mut self, sha256: impl IntoIterator<Item = String>) {
        self.effects.garbage.extend(sha256);
    }
}

/// Sends commands to the task.
#[derive(Clone, Debug)]
pub(super) struct Writer {
    commands: mpsc::Sender<Command>,
}

/// What the task tells the world after each commit.
#[derive(Debug)]
pub(super) struct Announcements {
    pub(super) last_event: watch::Sender<u64>,
    pub(super) queued: watch::Sender<u64>,
    /// This server's name for others on its database.
    pub(super) server: Uuid,
    pub(super) garbage: Reports,
}

/// What is told of trouble.
#[derive(Debug)]
pub(super) struct Guards {
    pub(super) reserve: Arc<Reserve>,
    pub(super) restarts: Arc<Restarts>,
}

impl Writer {
    /// Starts the task; it ends when the last writer is dropped.
    pub(super) fn start(
        connection: Connection,
        database: Database,
        clock: Clock,
        announcements: Announcements,
        guards: Guards,
    ) -> Self {
        let (commands, waiting) = mpsc::channel(4 * LARGEST_BATCH);
        let change = Change {
            connection,
            now: clock.now(),
            clock,
            last_trouble: i64::MIN,
            actor: None,
            full: None,
            effects: Effects::default(),
        };
        tasks::spawn(run(change, database, waiting, announcements, guards));
        Self { commands }
    }

    /// Runs `command` in the next transaction and answers after its commit. A command whose caller
    /// has gone before its turn is not run; what it returns is kept until the commit.
    ///
    /// # Errors
    /// Those of the command, whose changes are then undone; [`StoreError::Unavailable`] when the
    /// transaction could not be committed.
    pub(super) async fn write(
        &self,
        size: Size,
        actor: Option<Arc<Actor>>,
        run: Run,
    ) -> Result<Answer> {
        let (answer, answered) = oneshot::channel();
        let command = Command {
            run,
            actor,
            size,
            answer,
        };
        let gone = |_| StoreError::Unavailable;
        self.commands.send(command).await.map_err(gone)?;
        answered.await.unwrap_or(Err(StoreError::Unavailable))
    }
}

async fn run(
    mut change: Change,
    database: Database,
    mut waiting: mpsc::Receiver<Command>,
    announcements: Announcements,
    guards: Guards,
) {
    let mut batch = Vec::with_capacity(LARGEST_BATCH);
    while waiting.recv_many(&mut batch, LARGEST_BATCH).await > 0 {
        let mut answers = Vec::new();
        let has_large = batch.iter().any(|command| command.size == Size::Large);
        let committing = commit(
            &mut change,
            batch.drain(..),
            has_large,
            &mut answers,
            &announcements,
        );
        let committed = caught("writer", &guards.restarts.writer, committing).await;
        // the answers are dropped where it failed, which tells every caller that nothing was kept; that the
        // disk is full has to be known by then
        let is_usable = match committed {
            Ok(Ok(effects)) => {
                announcements.announce(effects);
                answers.into_iter().for_each(Ended::tell);
                continue;
            }
            Ok(Err(error)) => {
                tracing::error!(error = %chain(&error), "a transaction was rolled back");
                let is_usable = !is_broken(&error);
                if !is_usable {
                    guards.restarts.writer.fetch_add(1, Ordering::Relaxed);
                }
                match change.full.take() {
                    Some(why) => guards.reserve.give_up(&why),
                    None => _ = guards.reserve.note(error),
                }
                is_usable
            }
            Err(_) => false,
        };
        change.last_trouble = change.clock.now().as_millis();
        change.effects = Effects::default();
        if is_usable {
            // the database may have rolled back by itself, and then there is nothing to undo
            let _ = change.connection.run("ROLLBACK").await;
            let _ = change.connection.keep_undo(Undo::InMemory).await;
        } else {
            change.connection = until_done("writer", || database.connect_for_commands()).await;
            change.last_trouble = change.clock.now().as_millis();
        }
    }
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}

/// Whether the connection itself has failed.
fn is_broken(error: &StoreError) -> bool {
    matches!(error, StoreError::Database(error) if database::is_broken(error))
}

/// Runs the commands in one transaction; `answers` are theirs, for when it is safe.
async fn commit(
    change: &mut Change,
    batch: impl Iterator<Item = Command>,
    has_large: bool,
    answers: &mut Vec<Ended>,
    announcements: &Announcements,
) -> Result<Effects> {
    let mut effects = Effects::default();
    if has_large {
        change.connection.keep_undo(Undo::InFile).await?;
    }
    let start = Instant::now();
    if let Some(moment) = change.connection.begin_commands().await? {
        change.clock.follow(moment);
    }
    if start.elapsed() > LONG_WAIT {
        change.last_trouble = change.clock.now().as_millis();
    }
    // what ends a command goes to the database together with what begins the next, or with the commit; what
    // begins the first, with what begins the transaction
    let mut begin = None;
    for command in batch {
        if let Some(begin) = begin {
            change.connection.run(begin).await?;
        }
        change.now = change.clock.now();
        let stays = change.run(command, answers).await;
        if change.full.is_some() {
            // the database may have undone the whole transaction by itself: nothing of it is kept
            return Err(StoreError::Full);
        }
        begin = Some(if stays {
            "RELEASE command; SAVEPOINT command"
        } else {
            let undo = "ROLLBACK TO command; RELEASE command";
            change.connection.run(undo).await?;
            "SAVEPOINT command"
        });
        let made = std::mem::take(&mut change.effects);
        if stays {
            effects.last_event = made.last_event.or(effects.last_event);
            effects.queued |= made.queued;
            effects.garbage.extend(made.garbage);
            effects.lines.extend(made.lines);
        }
    }
    if effects.last_event.is_some() || effects.queued {
        let (last_event, queued) = (effects.last_event, effects.queued);
        let news = News {
            server: announcements.server,
            last_event,
            queued,
        };
        change.connection.tell(news).await?;
    }
    // all files that the commands stored are named
    effects.moment = announcements.garbage.next_moment();
    match effects.lines.is_empty() {
        true => change.connection.commit().await?,
        false => Line::commit(&effects.lines, &mut change.connection).await?,
    }
    if has_large {
        change.connection.keep_undo(Undo::InMemory).await?;
    }
    Ok(effects)
}

impl Announcements {
    fn announce(&self, effects: Effects) {
        if let Some(event) = effects.last_event {
            // another server may have made later ones by now
            raise(&self.last_event, event);
        }
        if effects.queued {
            self.queued.send_modify(|count| *count += 1);
        }
        if !effects.garbage.is_empty() {
            // the collector outlives the writer; when it is gone, the next start collects
            let report = Garbage::Perhaps(effects.garbage, effects.moment);
            self.garbage.send(report);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::store::database::query_scalar;
    use crate::store::{Store, StoreError, StoreOptions};

    #[tokio::test(flavor = "multi_thread")]
    async fn a_command_that_panics_costs_its_transaction_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(StoreOptions::new(folder.path())).await;
        let store = store.expect("a store");
        for round in 1..=3 {
            let panicked = store
                .write(|_| Box::pin(async { panic!("of a test") }))
                .await;
            let panicked: Result<(), StoreError> = panicked;
            assert!(matches!(panicked, Err(StoreError::Unavailable)));
            store.try_write().await.expect("the writer goes on");
            let counts = store.counts().await.expect("counts");
            assert_eq!(counts.writer_restarts, round);
        }
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn what_undoes_a_command_is_in_a_file_only_where_it_may_be_much() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(StoreOptions::new(folder.path())).await;
        let store = store.expect("a store");
        macro_rules! place {
            ($write:ident) => {{
                let written = store.$write(|change| {
                    Box::pin(async {
                        let place = query_scalar("PRAGMA temp_store");
                        let place: i64 = place.fetch_one(&mut change.connection).await?;
                        Ok(place)
                    })
                });
                written.await.expect("it runs")
            }};
        }
        const DEFAULT: i64 = 0;
        const MEMORY: i64 = 2;
        assert_eq!(place!(write), MEMORY);
        assert_eq!(place!(write_large), DEFAULT);
        assert_eq!(place!(write), MEMORY);
        // a connection that is opened anew is as the first
        let panicked = store
            .write_large(|_| Box::pin(async { panic!("of a test") }))
            .await;
        let panicked: Result<(), StoreError> = panicked;
        assert!(panicked.is_err());
        assert_eq!(place!(write), MEMORY);
        let refused = store.write_large(|_| Box::pin(async { Err(StoreError::LeaseLost) }));
        let refused: Result<(), StoreError> = refused.await;
        assert!(matches!(refused, Err(StoreError::LeaseLost)));
        assert_eq!(place!(write), MEMORY);
    }
}
