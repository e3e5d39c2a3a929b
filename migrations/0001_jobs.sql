-- Jobs and all that hangs on them. Moments are milliseconds since 1970 (UTC), ids are UUIDs in 16
-- bytes, words such as a status are the ones of the wire.

-- One row a job, small enough that a thousand are read in a moment: what is large or rarely wanted
-- (spec, result, curve, files) lies in tables of its own.
CREATE TABLE jobs (
    -- Order of submission, which is the order of the queue among equal priorities.
    seq          INTEGER PRIMARY KEY AUTOINCREMENT,
    id           BLOB    NOT NULL UNIQUE,
    kind         TEXT    NOT NULL,
    name         TEXT    NOT NULL,
    notes        TEXT    NOT NULL,
    -- A JSON array of texts.
    tags         TEXT    NOT NULL,
    priority     INTEGER NOT NULL,
    spec_sha256  TEXT    NOT NULL,
    -- Where the job is in its life. Only the queue's transition function decides these six.
    status       TEXT    NOT NULL DEFAULT 'queued'
                 CHECK (status IN ('queued', 'running', 'paused', 'finished')),
    outcome      TEXT    CHECK ((outcome IS NOT NULL) = (status = 'finished')),
    -- What a user has asked of the running attempt: 'cancel' or 'pause'.
    asked        TEXT    CHECK (asked IS NULL OR status = 'running'),
    -- Workers that fell silent over this job since it was last submitted or retried.
    losses       INTEGER NOT NULL DEFAULT 0,
    reason_code  TEXT    NOT NULL,
    reason       TEXT    NOT NULL,
    -- Number of the current or last attempt, 0 before the first.
    attempt      INTEGER NOT NULL DEFAULT 0,
    progress     REAL    NOT NULL DEFAULT 0,
    phase        TEXT    NOT NULL DEFAULT '',
    eta_s        REAL,
    created_at   INTEGER NOT NULL,
    started_at   INTEGER,
    finished_at  INTEGER,
    updated_at   INTEGER NOT NULL,
    -- Number of the last event of this job: it names the state that clients hold.
    version      INTEGER NOT NULL DEFAULT 0,
    -- Log lines ever written, the forgotten ones included.
    log_lines    INTEGER NOT NULL DEFAULT 0
) STRICT;

-- The queue itself: a claim walks this index from its start.
CREATE INDEX jobs_waiting ON jobs (priority DESC, seq) WHERE status = 'queued';

-- The normalised spec, all defaults written out.
CREATE TABLE specs (
    job   INTEGER PRIMARY KEY REFERENCES jobs (seq) ON DELETE CASCADE,
    json  TEXT    NOT NULL
) STRICT;

-- What a succeeded job has: its outcome.json, and the attempt whose files and curve are the result.
CREATE TABLE results (
    job      INTEGER PRIMARY KEY REFERENCES jobs (seq) ON DELETE CASCADE,
    attempt  INTEGER NOT NULL,
    summary  TEXT    NOT NULL,
    outcome  TEXT    NOT NULL
) STRICT;

-- A worker's go at a job. While `ended_at` is null the attempt holds the job's lease; the id and
-- the token together are the proof that every write of the worker carries.
CREATE TABLE attempts (
    seq            INTEGER PRIMARY KEY,
    id             BLOB    NOT NULL UNIQUE,
    token          BLOB    NOT NULL,
    job            INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
    number         INTEGER NOT NULL,
    worker         BLOB    NOT NULL,
    worker_name    TEXT    NOT NULL,
    host           TEXT    NOT NULL,
    started_at     INTEGER NOT NULL,
    -- The lease runs out at this moment unless the worker is heard of.
    lease_until    INTEGER NOT NULL,
    -- Whether the worker has ever used the lease. One it never used may be handed to it again:
    -- the answer to its claim was lost on the wire.
    heard          INTEGER NOT NULL DEFAULT 0,
    -- Wall time in seconds of the checkpoint this attempt went on from.
    resumed_wall_s REAL    NOT NULL DEFAULT 0,
    ended_at       INTEGER,
    end_reason     TEXT,
    -- SHA-256 of the worker's message that ended the attempt: a repetition of it is no news.
    ended_by       TEXT,
    -- The curve's columns as a JSON array, and how many points there are.
    columns        TEXT    NOT NULL DEFAULT '[]',
    points         INTEGER NOT NULL DEFAULT 0,
    UNIQUE (job, number)
) STRICT;

-- At most one live attempt a job; also what the sweeper walks.
CREATE UNIQUE INDEX attempts_live ON attempts (job) WHERE ended_at IS NULL;
CREATE INDEX attempts_of_worker ON attempts (worker) WHERE ended_at IS NULL;

-- The points of an attempt's curve in blocks: doubles, one column after the other, compressed.
CREATE TABLE curve_blocks (
    attempt  INTEGER NOT NULL REFERENCES attempts (seq) ON DELETE CASCADE,
    first    INTEGER NOT NULL,
    count    INTEGER NOT NULL,
    data     BLOB    NOT NULL,
    UNIQUE (attempt, first)
) STRICT;

-- The last lines of a job's log, numbered from 0 over all attempts.
CREATE TABLE log_lines (
    job      INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
    number   INTEGER NOT NULL,
    attempt  INTEGER NOT NULL,
    at       INTEGER NOT NULL,
    message  TEXT    NOT NULL,
    PRIMARY KEY (job, number)
) STRICT, WITHOUT ROWID;

-- Files an attempt has uploaded. The bytes lie beside the database under their SHA-256, written
-- before the row that names them; bytes no row names are removed.
CREATE TABLE attempt_files (
    attempt  INTEGER NOT NULL REFERENCES attempts (seq) ON DELETE CASCADE,
    name     TEXT    NOT NULL,
    bytes    INTEGER NOT NULL,
    sha256   TEXT    NOT NULL,
    PRIMARY KEY (attempt, name)
) STRICT, WITHOUT ROWID;
CREATE INDEX attempt_files_by_content ON attempt_files (sha256);

-- The newest checkpoint of a job, and the result files that belong to it.
CREATE TABLE checkpoints (
    job      INTEGER PRIMARY KEY REFERENCES jobs (seq) ON DELETE CASCADE,
    bytes    INTEGER NOT NULL,
    sha256   TEXT    NOT NULL,
    wall_s   REAL    NOT NULL,
    cpu_s    REAL    NOT NULL
) STRICT;
CREATE INDEX checkpoints_by_content ON checkpoints (sha256);

CREATE TABLE checkpoint_files (
    job      INTEGER NOT NULL REFERENCES checkpoints (job) ON DELETE CASCADE,
    name     TEXT    NOT NULL,
    bytes    INTEGER NOT NULL,
    sha256   TEXT    NOT NULL,
    PRIMARY KEY (job, name)
) STRICT, WITHOUT ROWID;
CREATE INDEX checkpoint_files_by_content ON checkpoint_files (sha256);

-- Submissions by the name a client gave them. The name outlives the job, so that a late repetition
-- does not submit it anew.
CREATE TABLE idempotency_keys (
    key          TEXT    PRIMARY KEY,
    body_sha256  TEXT    NOT NULL,
    job          BLOB    NOT NULL,
    created_at   INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
