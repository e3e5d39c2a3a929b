//! What servers on one database tell each other, and keep each other from doing at once.
//!
//! Rows say what is; beside them there are only news, so that nobody has to ask again and again, and locks.
//! News wake who waits and are no truth: a server whose connection broke, or who heard nothing for a while,
//! looks into the table of events. Locks are advisory ones, each in a transaction on a connection of its own,
//! that end with it, however the server ends.
use std::fmt;
use std::time::Duration;

use sqlx::Transaction;
use sqlx::postgres::{PgConnectOptions, PgListener, PgPool, PgPoolOptions, Postgres};
use tokio::sync::watch;
use uuid::Uuid;

use super::postgres::CHANNEL;

/// Connections for locks that are held a moment, one for every file that is being stored.
const FOR_FILES: u32 = 16;
/// Longest time that storing a file, or removing some, may take: whoever is not heard of for longer has lost
/// the lock.
const FILES_TAKE: &str = "15min";
/// How long the removal of files waits for those who store some, who wait behind it.
const REMOVAL_WAITS: &str = "SET LOCAL lock_timeout = '5s'";
/// Connections for what one server does for all, and for listening.
const FOR_DUTIES: u32 = 8;
/// When a duty is lost by who is not heard of.
const DUTY_ENDS: &str = "30s";
/// How often the connection that holds a duty is looked at, and the table of events without news.
const LOOK_EVERY: Duration = Duration::from_secs(5);
/// How long a server that waits for a duty waits before it asks again.
const ASK_EVERY: Duration = Duration::from_secs(2);

/// Whether there are others.
#[derive(Clone, Debug)]
pub(in super::super) enum Sharing {
    /// This server has the database for itself.
    Alone,
    Among {
        files: PgPool,
        duties: PgPool,
        /// This server's name for the others.
        server: Uuid,
    },
}

/// A lock, until it is dropped.
#[derive(Debug)]
pub(in super::super) struct Held(#[allow(dead_code)] Option<Transaction<'static, Postgres>>);

/// What a server tells the others after a commit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct News {
    pub(in super::super) server: Uuid,
    pub(in super::super) last_event: Option<u64>,
    /// Whether a job was put into the queue.
    pub(in super::super) queued: bool,
}

impl fmt::Display for News {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (server, event) = (self.server.simple(), self.last_event.unwrap_or_default());
        write!(f, "{server} {event} {}", u8::from(self.queued))
    }
}

impl News {
    /// Reads what a server wrote; of a later version's all but the first words is passed over.
    fn read(text: &str) -> Option<Self> {
        let mut words = text.split(' ');
        let server = Uuid::try_parse(words.next()?).ok()?;
        let event: u64 = words.next()?.parse().ok()?;
        Some(Self {
            server,
            last_event: (event > 0).then_some(event),
            queued: words.next()? == "1",
        })
    }
}

impl Sharing {
    pub(super) async fn among(database: &PgConnectOptions) -> sqlx::Result<Self> {
        // who holds a lock says nothing meanwhile; whose machine is gone must not hold it for ever
        let pool = |connections, silence| {
            let options = [("idle_in_transaction_session_timeout", silence)];
            PgPoolOptions::new()
                .max_connections(connections)
                .connect_with(database.clone().options(options))
        };
        Ok(Self::Among {
            files: pool(FOR_FILES, FILES_TAKE).await?,
            duties: pool(FOR_DUTIES, DUTY_ENDS).await?,
            server: Uuid::new_v4(),
        })
    }

    /// This server's name for the others.
    pub(in super::super) fn server(&self) -> Uuid {
        match self {
            Self::Alone => Uuid::nil(),
            Self::Among { server, .. } => *server,
        }
    }

    /// Keeps the collectors of all servers from their work.
    ///
    /// # Errors
    /// The database's.
    pub(in super::super) async fn storing_a_file(&self) -> sqlx::Result<Held> {
        let Self::Among { files, .. } = self else {
            return Ok(Held(None));
        };
        lock(files.begin().await?, "pg_advisory_xact_lock_shared").await
    }

    /// Waits until no server is storing a file, for a while, and keeps all from it.
    ///
    /// # Errors
    /// The database's; what is to be removed then stays until all files are looked through.
    pub(in super::super) async fn removing_files(&self) -> sqlx::Result<Held> {
        let Self::Among { files, .. } = self else {
            return Ok(Held(None));
        };
        let mut held = files.begin().await?;
        sqlx::query(REMOVAL_WAITS).execute(&mut *held).await?;
        lock(held, "pg_advisory_xact_lock").await
    }

    /// Does some work that never ends on one server at a time: waits until it is this one's, and stops when it
    /// cannot be told any more that it still is.
    pub(in super::super) async fn as_duty(
        &self,
        name: &'static str,
        work: impl Future<Output = ()>,
    ) {
        let Self::Among { duties, .. } = self else {
            return work.await;
        };
        let mut held = loop {
            match try_lock(duties, name).await {
                Ok(Some(held)) => break held,
                Ok(None) => {}
                Err(error) => tracing::warn!(%error, duty = name, "it is not known whose it is"),
            }
            tokio::time::sleep(ASK_EVERY).await;
        };
        tracing::info!(duty = name, "this server does it for all");
        let lost = async {
            loop {
                tokio::time::sleep(LOOK_EVERY).await;
                if let Err(error) = sqlx::query("SELECT 1").execute(&mut *held).await {
                    break error;
                }
            }
        };
        tokio::select! {
            () = work => {}
            error = lost => tracing::warn!(%error, duty = name, "another server may do it by now"),
        }
    }

    /// Follows what others do until nobody here wants to know any more.
    pub(in super::super) async fn keep_listening(
        self,
        last_event: watch::Sender<u64>,
        queued: watch::Sender<u64>,
    ) {
        let Self::Among { duties, server, .. } = self else {
            return;
        };
        let gone = last_event.clone();
        let listening = async {
            loop {
                if let Err(error) = listen(&duties, server, &last_event, &queued).await {
                    tracing::warn!(%error, "news of other servers are missed");
                }
                tokio::time::sleep(ASK_EVERY).await;
            }
        };
        tokio::select! {
            () = gone.closed() => {}
            () = listening => {}
        }
    }
}

async fn listen(
    pool: &PgPool,
    server: Uuid,
    last_event: &watch::Sender<u64>,
    queued: &watch::Sender<u64>,
) -> sqlx::Result<()> {
    let mut listener = PgListener::connect_with(pool).await?;
    let channel: String = sqlx::query_scalar(CHANNEL).fetch_one(pool).await?;
    listener.listen(&channel).await?;
    let wake = || queued.send_modify(|count| *count += 1);
    loop {
        // what was said before somebody listened, or while nobody could
        let last: Option<i64> = sqlx::query_scalar("SELECT MAX(seq) FROM events")
            .fetch_one(pool)
            .await?;
        if raise(last_event, last.unwrap_or_default().unsigned_abs()) {
            wake();
        }
        loop {
            let heard = match tokio::time::timeout(LOOK_EVERY, listener.try_recv()).await {
                Ok(heard) => heard?,
                Err(_) => None,
            };
            let Some(news) = heard else { break };
            let Some(news) = News::read(news.payload()).filter(|news| news.server != server) else {
                continue;
            };
            if let Some(event) = news.last_event {
                raise(last_event, event);
            }
            if news.queued {
                wake();
            }
        }
    }
}

/// Takes a later number; whether it is one.
pub(in super::super) fn raise(number: &watch::Sender<u64>, to: u64) -> bool {
    number.send_if_modified(|known| {
        let is_later = to > *known;
        *known = to.max(*known);
        is_later
    })
}

async fn lock(mut held: Transaction<'static, Postgres>, function: &str) -> sqlx::Result<Held> {
    let text =
        format!("SELECT {function}(hashtext('loadframe files'), hashtext(current_schema()))");
    sqlx::query(sqlx::AssertSqlSafe(text))
        .execute(&mut *held)
        .await?;
    Ok(Held(Some(held)))
}

async fn try_lock(
    pool: &PgPool,
    name: &str,
) -> sqlx::Result<Option<Transaction<'static, Postgres>>> {
    let mut held = pool.begin().await?;
    let is_ours: bool = sqlx::query_scalar(
        "SELECT pg_try_advisory_xact_lock(hashtext('loadframe ' || $1), hashtext(current_schema()))",
    )
    .bind(name)
    .fetch_one(&mut *held)
    .await?;
    Ok(is_ours.then_some(held))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn news_are_read_as_they_were_told() {
        for (last_event, queued) in [(Some(7), true), (None, false)] {
            let news = News {
                server: Uuid::from_u128(5),
                last_event,
                queued,
            };
            assert_eq!(News::read(&news.to_string()), Some(news));
        }
        assert_eq!(News::read("something else"), None);
    }

    #[test]
    fn numbers_only_rise() {
        let (number, _kept) = watch::channel(3);
        assert!(raise(&number, 5));
        assert!(!raise(&number, 4));
        assert_eq!(*number.borrow(), 5);
    }
}
