-- Faults of machines, checkpoints before the newest, which build computed what, and limits of jobs.

-- Machines that could not carry out a job by a fault of their own: a worker's label on a host, which
-- outlive its process. No row for those that never failed so.
CREATE TABLE machines (
    host         TEXT    NOT NULL,
    worker_name  TEXT    NOT NULL,
    -- Faults since it last carried out a job.
    faults       INTEGER NOT NULL,
    -- It is given no jobs before this moment.
    until        INTEGER NOT NULL,
    code         TEXT    NOT NULL,
    reason       TEXT    NOT NULL,
    -- When it last carried out a job.
    worked_at    INTEGER NOT NULL DEFAULT 0,
    PRIMARY KEY (host, worker_name)
) STRICT, WITHOUT ROWID;

-- Machines that could not carry out a job, as far as it may be the job's own fault: one row a host,
-- and another when the host has carried out another job since.
CREATE TABLE job_faults (
    job      INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
    -- Number of the attempt.
    attempt  INTEGER NOT NULL,
    host     TEXT    NOT NULL,
    at       INTEGER NOT NULL,
    reason   TEXT    NOT NULL,
    PRIMARY KEY (job, attempt)
) STRICT, WITHOUT ROWID;

-- What the job was estimated to take when it was submitted (JSON; null for jobs before this was kept), and
-- how many times that it may take before it is paused.
ALTER TABLE jobs ADD COLUMN estimate TEXT;
ALTER TABLE jobs ADD COLUMN overrun_factor REAL NOT NULL DEFAULT 10;

-- The build of the worker, as it told with its claim; empty for attempts before this was noted.
ALTER TABLE attempts ADD COLUMN engine TEXT NOT NULL DEFAULT '';
-- Log lines its worker has brought: a repeated report brings them no second time.
ALTER TABLE attempts ADD COLUMN log_lines INTEGER NOT NULL DEFAULT 0;

-- The two newest checkpoints of a job: when one cannot be used, there is the one before. The table of
-- files is copied first, as dropping the one it refers to would empty it.
CREATE TABLE kept_checkpoints (
    seq     INTEGER PRIMARY KEY AUTOINCREMENT,
    job     INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
    bytes   INTEGER NOT NULL,
    sha256  TEXT    NOT NULL,
    wall_s  REAL    NOT NULL,
    cpu_s   REAL    NOT NULL,
    -- The build that made it; empty where that was not noted.
    engine  TEXT    NOT NULL DEFAULT ''
) STRICT;
CREATE TABLE kept_checkpoint_files (
    checkpoint  INTEGER NOT NULL REFERENCES kept_checkpoints (seq) ON DELETE CASCADE,
    name        TEXT    NOT NULL,
    bytes       INTEGER NOT NULL,
    sha256      TEXT    NOT NULL,
    PRIMARY KEY (checkpoint, name)
) STRICT, WITHOUT ROWID;
INSERT INTO kept_checkpoints (job, bytes, sha256, wall_s, cpu_s)
    SELECT job, bytes, sha256, wall_s, cpu_s FROM checkpoints ORDER BY job;
INSERT INTO kept_checkpoint_files (checkpoint, name, bytes, sha256)
    SELECT k.seq, f.name, f.bytes, f.sha256
    FROM checkpoint_files f JOIN kept_checkpoints k ON k.job = f.job;
DROP TABLE checkpoint_files;
DROP TABLE checkpoints;
ALTER TABLE kept_checkpoints RENAME TO checkpoints;
ALTER TABLE kept_checkpoint_files RENAME TO checkpoint_files;
CREATE INDEX checkpoints_of_job ON checkpoints (job, seq);
CREATE INDEX checkpoints_by_content ON checkpoints (sha256);
CREATE INDEX checkpoint_files_by_content ON checkpoint_files (sha256);
