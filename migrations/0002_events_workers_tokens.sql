-- Events: which job changed, in which order. An event is shown as its job is when it is read, so
-- of each type only the last one of a job is worth keeping: the table stays as small as the jobs,
-- and whoever comes back after a week is told of each job once. AUTOINCREMENT, because a number
-- that was given out must never come again.
CREATE TABLE events (
    seq   INTEGER PRIMARY KEY AUTOINCREMENT,
    job   BLOB    NOT NULL,
    type  TEXT    NOT NULL CHECK (type IN ('job', 'progress', 'points', 'deleted')),
    at    INTEGER NOT NULL,
    UNIQUE (job, type)
) STRICT;

-- For the last step any job has taken: the place of all others in the queue may change with it.
CREATE INDEX events_by_type ON events (type, seq);

-- Worker processes, for people and for the speed they measured. The queue does not look here.
CREATE TABLE workers (
    id                     BLOB    PRIMARY KEY,
    name                   TEXT    NOT NULL,
    host                   TEXT    NOT NULL,
    threads                INTEGER NOT NULL,
    engine_version         TEXT    NOT NULL,
    bond_evaluations_per_s REAL,
    last_seen_at           INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Access tokens. The secret itself is nowhere: it is shown once, and known again by its SHA-256.
CREATE TABLE tokens (
    id             BLOB    PRIMARY KEY,
    name           TEXT    NOT NULL,
    secret_sha256  TEXT    NOT NULL UNIQUE,
    created_at     INTEGER NOT NULL,
    revoked_at     INTEGER
) STRICT, WITHOUT ROWID;
