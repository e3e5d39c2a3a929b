-- Order in the house: what of old jobs is removed, what fills the disk, and who is told of what.

-- What a project's files are kept for [days]; NULL keeps them. Nothing is removed before the rule is in
-- force. A project without a row keeps everything.
CREATE TABLE retention (
    project         BLOB    PRIMARY KEY REFERENCES projects (id),
    snapshots_days  INTEGER CHECK (snapshots_days > 0),
    curves_days     INTEGER CHECK (curves_days > 0),
    set_at          INTEGER NOT NULL,
    in_force_at     INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- What was removed by such a rule is shown to nobody, and can be brought back until it is forgotten.
ALTER TABLE attempt_files ADD COLUMN removed_at INTEGER;
CREATE INDEX attempt_files_removed ON attempt_files (removed_at) WHERE removed_at IS NOT NULL;

-- How far a finished job has been cleared: 0 whole, 1 without snapshots, 2 without curves too.
ALTER TABLE jobs ADD COLUMN cleared INTEGER NOT NULL DEFAULT 0;
CREATE INDEX jobs_to_clear ON jobs (project, cleared, finished_at)
    WHERE finished_at IS NOT NULL AND project IS NOT NULL;
CREATE TRIGGER jobs_begun_anew AFTER UPDATE OF status ON jobs
WHEN OLD.status = 'finished' AND NEW.status <> 'finished' AND NEW.cleared > 0 BEGIN
    UPDATE jobs SET cleared = 0 WHERE seq = NEW.seq;
END;

-- Kinds of files, by their names, for rules and for what fills the disk; the first that fits.
ALTER TABLE attempt_files ADD COLUMN kind TEXT GENERATED ALWAYS AS (CASE
    WHEN name IN ('outcome.json', 'partial/outcome.json', 'partial/failure.json') THEN 'outcome'
    WHEN name GLOB '*.vtp' OR name GLOB '*.vtu' OR name GLOB '*.pvd'
        OR name GLOB 'snapshots/*' OR name GLOB 'partial/snapshots/*' THEN 'snapshots'
    WHEN name GLOB '*.csv' THEN 'curves'
    ELSE 'others' END) VIRTUAL;

-- Bytes of files by person, project and kind (x'' for none), without adding up all files each time.
CREATE TABLE disk_use (
    person   BLOB    NOT NULL,
    project  BLOB    NOT NULL,
    kind     TEXT    NOT NULL,
    files    INTEGER NOT NULL,
    bytes    INTEGER NOT NULL,
    PRIMARY KEY (person, project, kind)
) STRICT, WITHOUT ROWID;

INSERT INTO disk_use (person, project, kind, files, bytes)
SELECT COALESCE(j.owner, x''), COALESCE(j.project, x''), f.kind, COUNT(*), SUM(f.bytes)
FROM attempt_files f JOIN attempts a ON a.seq = f.attempt JOIN jobs j ON j.seq = a.job GROUP BY 1, 2, 3;

-- A row that is replaced fires no trigger of its end, so that is seen to here.
CREATE TRIGGER files_replaced BEFORE INSERT ON attempt_files BEGIN
    DELETE FROM attempt_files WHERE attempt = NEW.attempt AND name = NEW.name;
END;

CREATE TRIGGER files_counted AFTER INSERT ON attempt_files BEGIN
    INSERT INTO disk_use (person, project, kind, files, bytes)
    SELECT COALESCE(j.owner, x''), COALESCE(j.project, x''), NEW.kind, 1, NEW.bytes
    FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.seq = NEW.attempt
    ON CONFLICT DO UPDATE SET files = files + 1, bytes = bytes + excluded.bytes;
END;

CREATE TRIGGER files_counted_no_more AFTER DELETE ON attempt_files BEGIN
    UPDATE disk_use SET files = files - 1, bytes = bytes - OLD.bytes
    WHERE (person, project) = (SELECT COALESCE(j.owner, x''), COALESCE(j.project, x'')
            FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.seq = OLD.attempt)
      AND kind = OLD.kind;
END;

CREATE TRIGGER files_counted_otherwise AFTER UPDATE OF name ON attempt_files
WHEN NEW.kind <> OLD.kind BEGIN
    UPDATE disk_use SET files = files - 1, bytes = bytes - OLD.bytes
    WHERE (person, project) = (SELECT COALESCE(j.owner, x''), COALESCE(j.project, x'')
            FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.seq = OLD.attempt)
      AND kind = OLD.kind;
    INSERT INTO disk_use (person, project, kind, files, bytes)
    SELECT COALESCE(j.owner, x''), COALESCE(j.project, x''), NEW.kind, 1, NEW.bytes
    FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.seq = NEW.attempt
    ON CONFLICT DO UPDATE SET files = files + 1, bytes = bytes + excluded.bytes;
END;

-- Of a job that is deleted, at once: its files go after it, when nobody knows whose they were.
CREATE TRIGGER jobs_files_counted_no_more BEFORE DELETE ON jobs BEGIN
    UPDATE disk_use SET files = disk_use.files - u.files, bytes = disk_use.bytes - u.bytes
    FROM (SELECT f.kind, COUNT(*) AS files, SUM(f.bytes) AS bytes
          FROM attempts a JOIN attempt_files f ON f.attempt = a.seq WHERE a.job = OLD.seq
          GROUP BY f.kind) u
    WHERE disk_use.person = COALESCE(OLD.owner, x'') AND disk_use.project = COALESCE(OLD.project, x'')
      AND disk_use.kind = u.kind;
END;

CREATE TRIGGER jobs_files_moved AFTER UPDATE OF owner, project ON jobs
WHEN OLD.owner IS NOT NEW.owner OR OLD.project IS NOT NEW.project BEGIN
    UPDATE disk_use SET files = disk_use.files - u.files, bytes = disk_use.bytes - u.bytes
    FROM (SELECT f.kind, COUNT(*) AS files, SUM(f.bytes) AS bytes
          FROM attempts a JOIN attempt_files f ON f.attempt = a.seq WHERE a.job = OLD.seq
          GROUP BY f.kind) u
    WHERE disk_use.person = COALESCE(OLD.owner, x'') AND disk_use.project = COALESCE(OLD.project, x'')
      AND disk_use.kind = u.kind;
    INSERT INTO disk_use (person, project, kind, files, bytes)
    SELECT COALESCE(NEW.owner, x''), COALESCE(NEW.project, x''), f.kind, COUNT(*), SUM(f.bytes)
    FROM attempts a JOIN attempt_files f ON f.attempt = a.seq WHERE a.job = NEW.seq GROUP BY f.kind
    ON CONFLICT DO UPDATE SET files = files + excluded.files, bytes = bytes + excluded.bytes;
END;

-- Where people are told, by an address that takes signed messages. Its secret is nowhere here: it
-- follows from the key in the file `webhook-key` and the id.
CREATE TABLE webhooks (
    id           BLOB    PRIMARY KEY,
    person       BLOB    NOT NULL REFERENCES people (id),
    -- Jobs of this project, or else of the person.
    project      BLOB    REFERENCES projects (id),
    url          TEXT    NOT NULL,
    -- A JSON array of words.
    events       TEXT    NOT NULL,
    created_at   INTEGER NOT NULL,
    removed_at   INTEGER,
    -- Deliveries that failed since the last that did not, when the next is tried, and what was wrong.
    failures     INTEGER NOT NULL DEFAULT 0,
    next_at      INTEGER NOT NULL DEFAULT 0,
    told_at      INTEGER,
    last_error   TEXT
) STRICT, WITHOUT ROWID;
CREATE INDEX webhooks_of_person ON webhooks (person) WHERE removed_at IS NULL AND project IS NULL;
CREATE INDEX webhooks_of_project ON webhooks (project) WHERE removed_at IS NULL AND project IS NOT NULL;

-- What is to be told: written by the change that it tells of, removed when the other side has it.
CREATE TABLE outbox (
    number   INTEGER PRIMARY KEY AUTOINCREMENT,
    webhook  BLOB    NOT NULL REFERENCES webhooks (id),
    event    TEXT    NOT NULL,
    at       INTEGER NOT NULL,
    -- What it is about, as JSON.
    body     TEXT    NOT NULL
) STRICT;
CREATE INDEX outbox_of_webhook ON outbox (webhook, number);

CREATE TRIGGER ends_are_told AFTER UPDATE OF status ON jobs
WHEN NEW.status = 'finished' AND OLD.status <> 'finished' BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, e.value, NEW.finished_at, json_object('job', lower(hex(NEW.id)), 'name', NEW.name,
        'kind', NEW.kind, 'outcome', NEW.outcome, 'reason', NEW.reason)
    FROM webhooks w, json_each(w.events) e
    WHERE w.removed_at IS NULL
      AND ((w.project IS NULL AND w.person = NEW.owner) OR w.project = NEW.project)
      AND e.value = CASE NEW.outcome WHEN 'quarantined' THEN 'quarantined'
            WHEN 'failed' THEN 'failed' WHEN 'timed_out' THEN 'failed' ELSE 'ended' END;
END;

CREATE TRIGGER shares_are_told AFTER INSERT ON shares BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, 'shared', NEW.created_at, json_object('job', lower(hex(NEW.job)),
        'project', lower(hex(NEW.project)), 'link', lower(hex(NEW.id)), 'files', NEW.shows_files)
    FROM webhooks w
    WHERE w.removed_at IS NULL AND EXISTS (SELECT 1 FROM json_each(w.events) e WHERE e.value = 'shared')
      AND ((w.project IS NULL AND w.person = (SELECT j.owner FROM jobs j WHERE j.id = NEW.job))
        OR w.project = NEW.project
        OR w.project = (SELECT j.project FROM jobs j WHERE j.id = NEW.job));
END;
