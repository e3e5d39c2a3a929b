-- Who works on what next: what jobs need of a machine, what machines have, who has used how much, and
-- how much each person may use.

-- What a worker must have for a job, rounded up, so that few rows serve many jobs. Row 0 needs nothing
-- that is known.
CREATE TABLE needs (
    id         INTEGER PRIMARY KEY,
    memory_mb  INTEGER NOT NULL,
    disk_mb    INTEGER NOT NULL,
    -- Time in one go on a core of the reference speed [s]; the time between checkpoints for what goes on
    -- from them.
    core_s     INTEGER NOT NULL,
    threads    INTEGER NOT NULL,
    -- The version that wrote the spec down, major · 1e6 + minor · 1e3 + patch: earlier ones may not know it.
    release    INTEGER NOT NULL,
    UNIQUE (memory_mb, disk_mb, core_s, threads, release)
) STRICT;
INSERT INTO needs VALUES (0, 0, 0, 0, 1, 0);

ALTER TABLE jobs ADD COLUMN needs INTEGER NOT NULL DEFAULT 0;
-- Threads that the submission asked for.
ALTER TABLE jobs ADD COLUMN threads INTEGER;

-- Jobs that may still run, as far as their estimates tell; how long they take in one go does not matter,
-- as nearly all kinds go on from checkpoints.
INSERT OR IGNORE INTO needs (memory_mb, disk_mb, core_s, threads, release)
SELECT DISTINCT (CAST(MIN(json_extract(estimate, '$.memory_mb'), 1e12) AS INTEGER) / 100 + 1) * 100,
    (CAST(MIN(json_extract(estimate, '$.disk_mb'), 1e12) AS INTEGER) / 100 + 1) * 100, 60, 1, 0
FROM jobs WHERE status <> 'finished' AND json_extract(estimate, '$.memory_mb') >= 0
    AND json_extract(estimate, '$.disk_mb') >= 0;
UPDATE jobs SET needs = COALESCE((SELECT id FROM needs
    WHERE memory_mb = (CAST(MIN(json_extract(estimate, '$.memory_mb'), 1e12) AS INTEGER) / 100 + 1) * 100
      AND disk_mb = (CAST(MIN(json_extract(estimate, '$.disk_mb'), 1e12) AS INTEGER) / 100 + 1) * 100), 0)
WHERE status <> 'finished' AND estimate IS NOT NULL;

-- What a machine offers; null and no kinds where its worker has not said so.
ALTER TABLE workers ADD COLUMN kinds TEXT NOT NULL DEFAULT '[]';
ALTER TABLE workers ADD COLUMN memory_mb REAL;
ALTER TABLE workers ADD COLUMN disk_mb REAL;
-- When it has to end.
ALTER TABLE workers ADD COLUMN ends_at INTEGER;
ALTER TABLE workers ADD COLUMN release INTEGER;
-- Threads of the worker, for what the attempt uses.
ALTER TABLE attempts ADD COLUMN threads INTEGER NOT NULL DEFAULT 1;

-- What a person has used lately, in a form that needs no decay: the logarithm to the base 2 of core
-- seconds, plus the moment in half-lives. Null: nothing yet.
ALTER TABLE people ADD COLUMN use_level REAL;
-- Limits; null has none.
ALTER TABLE people ADD COLUMN most_running INTEGER;
ALTER TABLE people ADD COLUMN most_queued_core_h REAL;
ALTER TABLE people ADD COLUMN most_disk_gb REAL;
-- Whether the person may submit with a priority above 0; administrators may.
ALTER TABLE people ADD COLUMN may_hurry INTEGER NOT NULL DEFAULT 0;
-- Files of the person's jobs [bytes].
ALTER TABLE people ADD COLUMN file_bytes INTEGER NOT NULL DEFAULT 0;

-- Files and checkpoints of a job [bytes].
ALTER TABLE jobs ADD COLUMN file_bytes INTEGER NOT NULL DEFAULT 0;
UPDATE jobs SET file_bytes =
    COALESCE((SELECT SUM(f.bytes) FROM attempts a JOIN attempt_files f ON f.attempt = a.seq WHERE a.job = jobs.seq), 0)
    + COALESCE((SELECT SUM(c.bytes) FROM checkpoints c WHERE c.job = jobs.seq), 0);
UPDATE people SET file_bytes = (SELECT COALESCE(SUM(file_bytes), 0) FROM jobs WHERE owner = people.id);

-- A file that is uploaded again replaces the one before, of which no trigger hears.
CREATE TRIGGER files_arrive BEFORE INSERT ON attempt_files BEGIN
    UPDATE jobs SET file_bytes = file_bytes + NEW.bytes
        - COALESCE((SELECT bytes FROM attempt_files WHERE attempt = NEW.attempt AND name = NEW.name), 0)
    WHERE seq = (SELECT job FROM attempts WHERE seq = NEW.attempt);
END;
CREATE TRIGGER files_go AFTER DELETE ON attempt_files BEGIN
    UPDATE jobs SET file_bytes = file_bytes - OLD.bytes
    WHERE seq = (SELECT job FROM attempts WHERE seq = OLD.attempt);
END;
CREATE TRIGGER checkpoints_arrive AFTER INSERT ON checkpoints BEGIN
    UPDATE jobs SET file_bytes = file_bytes + NEW.bytes WHERE seq = NEW.job;
END;
CREATE TRIGGER checkpoints_go AFTER DELETE ON checkpoints BEGIN
    UPDATE jobs SET file_bytes = file_bytes - OLD.bytes WHERE seq = OLD.job;
END;
CREATE TRIGGER jobs_grow AFTER UPDATE OF file_bytes ON jobs WHEN NEW.owner IS NOT NULL BEGIN
    UPDATE people SET file_bytes = file_bytes + NEW.file_bytes - OLD.file_bytes WHERE id = NEW.owner;
END;
CREATE TRIGGER jobs_change_hands AFTER UPDATE OF owner ON jobs
WHEN NEW.file_bytes <> 0 AND NEW.owner IS NOT OLD.owner BEGIN
    UPDATE people SET file_bytes = file_bytes - OLD.file_bytes WHERE id = OLD.owner;
    UPDATE people SET file_bytes = file_bytes + NEW.file_bytes WHERE id = NEW.owner;
END;
CREATE TRIGGER jobs_leave_no_files AFTER DELETE ON jobs
WHEN OLD.file_bytes <> 0 AND OLD.owner IS NOT NULL BEGIN
    UPDATE people SET file_bytes = file_bytes - OLD.file_bytes WHERE id = OLD.owner;
END;

-- A claim looks at lines, not at jobs: all that wait with one priority, person, kind and need, of which
-- only the first is looked at. There are as many as there are ways to wait.
CREATE TABLE waiting_lines (
    priority  INTEGER NOT NULL,
    -- Empty for nobody's.
    owner     BLOB    NOT NULL,
    kind      TEXT    NOT NULL,
    needs     INTEGER NOT NULL,
    jobs      INTEGER NOT NULL,
    -- What they are estimated to take [ms of one core].
    core_ms   INTEGER NOT NULL,
    PRIMARY KEY (priority, owner, kind, needs)
) STRICT, WITHOUT ROWID;
DROP INDEX jobs_waiting_by_kind;
CREATE INDEX jobs_waiting_alike ON jobs (priority, owner, kind, needs, seq) WHERE status = 'queued';

-- Places in the queue are counted by person, as people take turns.
DROP INDEX jobs_waiting;
CREATE INDEX jobs_waiting ON jobs (priority, owner, seq) WHERE status = 'queued';
DROP TRIGGER jobs_begin_to_wait;
DROP TRIGGER jobs_wait_again;
DROP TRIGGER jobs_wait_no_more;
DROP TRIGGER jobs_deleted_while_waiting;
DROP TABLE waiting_counts;
CREATE TABLE waiting_counts (
    bits      INTEGER NOT NULL,
    priority  INTEGER NOT NULL,
    owner     BLOB    NOT NULL,
    block     INTEGER NOT NULL,
    jobs      INTEGER NOT NULL,
    PRIMARY KEY (bits, priority, owner, block)
) STRICT, WITHOUT ROWID;

INSERT INTO waiting_counts (bits, priority, owner, block, jobs)
SELECT bits, priority, COALESCE(owner, x''), seq >> bits, COUNT(*)
FROM jobs, (SELECT 6 AS bits UNION SELECT 12 UNION SELECT 18)
WHERE status = 'queued' GROUP BY 1, 2, 3, 4;
INSERT INTO waiting_lines (priority, owner, kind, needs, jobs, core_ms)
SELECT priority, COALESCE(owner, x''), kind, needs, COUNT(*),
    SUM(CAST(1000 * MIN(COALESCE(json_extract(estimate, '$.wall_s'), 0), 1e9) AS INTEGER))
FROM jobs WHERE status = 'queued' GROUP BY 1, 2, 3, 4;

CREATE TRIGGER jobs_begin_to_wait AFTER INSERT ON jobs WHEN NEW.status = 'queued' BEGIN
    INSERT INTO waiting_counts (bits, priority, owner, block, jobs)
    VALUES (6, NEW.priority, COALESCE(NEW.owner, x''), NEW.seq >> 6, 1),
        (12, NEW.priority, COALESCE(NEW.owner, x''), NEW.seq >> 12, 1),
        (18, NEW.priority, COALESCE(NEW.owner, x''), NEW.seq >> 18, 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
    INSERT INTO waiting_lines (priority, owner, kind, needs, jobs, core_ms)
    VALUES (NEW.priority, COALESCE(NEW.owner, x''), NEW.kind, NEW.needs, 1,
        CAST(1000 * MIN(COALESCE(json_extract(NEW.estimate, '$.wall_s'), 0), 1e9) AS INTEGER))
    ON CONFLICT DO UPDATE SET jobs = jobs + 1, core_ms = core_ms + excluded.core_ms;
END;

CREATE TRIGGER jobs_wait_again AFTER UPDATE OF status, priority, owner ON jobs
WHEN NEW.status = 'queued' AND (OLD.status <> 'queued' OR OLD.priority <> NEW.priority OR OLD.owner IS NOT NEW.owner) BEGIN
    INSERT INTO waiting_counts (bits, priority, owner, block, jobs)
    VALUES (6, NEW.priority, COALESCE(NEW.owner, x''), NEW.seq >> 6, 1),
        (12, NEW.priority, COALESCE(NEW.owner, x''), NEW.seq >> 12, 1),
        (18, NEW.priority, COALESCE(NEW.owner, x''), NEW.seq >> 18, 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
    INSERT INTO waiting_lines (priority, owner, kind, needs, jobs, core_ms)
    VALUES (NEW.priority, COALESCE(NEW.owner, x''), NEW.kind, NEW.needs, 1,
        CAST(1000 * MIN(COALESCE(json_extract(NEW.estimate, '$.wall_s'), 0), 1e9) AS INTEGER))
    ON CONFLICT DO UPDATE SET jobs = jobs + 1, core_ms = core_ms + excluded.core_ms;
END;

CREATE TRIGGER jobs_wait_no_more AFTER UPDATE OF status, priority, owner ON jobs
WHEN OLD.status = 'queued' AND (NEW.status <> 'queued' OR OLD.priority <> NEW.priority OR OLD.owner IS NOT NEW.owner) BEGIN
    UPDATE waiting_counts SET jobs = jobs - 1
    WHERE (bits, priority, owner, block) IN
        (VALUES (6, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 6),
            (12, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 12),
            (18, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 18));
    DELETE FROM waiting_counts WHERE jobs = 0 AND (bits, priority, owner, block) IN
        (VALUES (6, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 6),
            (12, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 12),
            (18, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 18));
    UPDATE waiting_lines SET jobs = jobs - 1, core_ms = core_ms
        - CAST(1000 * MIN(COALESCE(json_extract(OLD.estimate, '$.wall_s'), 0), 1e9) AS INTEGER)
    WHERE priority = OLD.priority AND owner = COALESCE(OLD.owner, x'') AND kind = OLD.kind AND needs = OLD.needs;
    DELETE FROM waiting_lines WHERE jobs = 0
        AND priority = OLD.priority AND owner = COALESCE(OLD.owner, x'') AND kind = OLD.kind AND needs = OLD.needs;
END;

CREATE TRIGGER jobs_deleted_while_waiting AFTER DELETE ON jobs WHEN OLD.status = 'queued' BEGIN
    UPDATE waiting_counts SET jobs = jobs - 1
    WHERE (bits, priority, owner, block) IN
        (VALUES (6, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 6),
            (12, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 12),
            (18, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 18));
    DELETE FROM waiting_counts WHERE jobs = 0 AND (bits, priority, owner, block) IN
        (VALUES (6, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 6),
            (12, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 12),
            (18, OLD.priority, COALESCE(OLD.owner, x''), OLD.seq >> 18));
    UPDATE waiting_lines SET jobs = jobs - 1, core_ms = core_ms
        - CAST(1000 * MIN(COALESCE(json_extract(OLD.estimate, '$.wall_s'), 0), 1e9) AS INTEGER)
    WHERE priority = OLD.priority AND owner = COALESCE(OLD.owner, x'') AND kind = OLD.kind AND needs = OLD.needs;
    DELETE FROM waiting_lines WHERE jobs = 0
        AND priority = OLD.priority AND owner = COALESCE(OLD.owner, x'') AND kind = OLD.kind AND needs = OLD.needs;
END;
