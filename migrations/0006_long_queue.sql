-- What keeps a long queue quick: nothing that a request or a worker waits for counts or looks through
-- all jobs. What is kept here follows from the table of jobs by triggers, and could be made again from it.

-- Lists, newest first, by what they are filtered by; the row's number, `seq`, ends every index.
CREATE INDEX jobs_by_status ON jobs (status);
CREATE INDEX jobs_by_outcome ON jobs (outcome) WHERE outcome IS NOT NULL;
CREATE INDEX jobs_by_kind ON jobs (kind);
CREATE INDEX jobs_by_kind_and_status ON jobs (kind, status);
CREATE INDEX jobs_by_kind_and_outcome ON jobs (kind, outcome) WHERE outcome IS NOT NULL;
CREATE INDEX jobs_by_moment ON jobs (created_at);

-- A claim takes the first of each kind that its worker can do, and of these the first.
CREATE INDEX jobs_waiting_by_kind ON jobs (kind, priority DESC, seq) WHERE status = 'queued';
-- How long the oldest has been waiting.
CREATE INDEX jobs_waiting_since ON jobs (created_at) WHERE status = 'queued';

-- Attempts whose workers fell silent, which metrics count; they are few.
CREATE INDEX attempts_lost ON attempts (end_reason) WHERE end_reason = 'lost';

-- Old keys are forgotten.
CREATE INDEX idempotency_keys_by_moment ON idempotency_keys (created_at);

-- The number of the last event that changed name, notes, tags or priority: an edit that knows of it
-- overwrites nobody's.
ALTER TABLE jobs ADD COLUMN edited INTEGER NOT NULL DEFAULT 0;

-- A job's place in the queue, without counting all before it: how many jobs of a priority wait in every
-- block of 2^6, of 2^12 and of 2^18 neighbouring numbers.
CREATE TABLE waiting_counts (
    bits      INTEGER NOT NULL,
    priority  INTEGER NOT NULL,
    block     INTEGER NOT NULL,
    jobs      INTEGER NOT NULL,
    PRIMARY KEY (bits, priority, block)
) STRICT, WITHOUT ROWID;

INSERT INTO waiting_counts (bits, priority, block, jobs)
SELECT bits, priority, seq >> bits, COUNT(*)
FROM jobs, (SELECT 6 AS bits UNION SELECT 12 UNION SELECT 18)
WHERE status = 'queued' GROUP BY 1, 2, 3;

CREATE TRIGGER jobs_begin_to_wait AFTER INSERT ON jobs WHEN NEW.status = 'queued' BEGIN
    INSERT INTO waiting_counts (bits, priority, block, jobs)
    VALUES (6, NEW.priority, NEW.seq >> 6, 1), (12, NEW.priority, NEW.seq >> 12, 1),
        (18, NEW.priority, NEW.seq >> 18, 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
END;

CREATE TRIGGER jobs_wait_again AFTER UPDATE OF status, priority ON jobs
WHEN NEW.status = 'queued' AND (OLD.status <> 'queued' OR OLD.priority <> NEW.priority) BEGIN
    INSERT INTO waiting_counts (bits, priority, block, jobs)
    VALUES (6, NEW.priority, NEW.seq >> 6, 1), (12, NEW.priority, NEW.seq >> 12, 1),
        (18, NEW.priority, NEW.seq >> 18, 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
END;

CREATE TRIGGER jobs_wait_no_more AFTER UPDATE OF status, priority ON jobs
WHEN OLD.status = 'queued' AND (NEW.status <> 'queued' OR OLD.priority <> NEW.priority) BEGIN
    UPDATE waiting_counts SET jobs = jobs - 1
    WHERE (bits, priority, block) IN
        (VALUES (6, OLD.priority, OLD.seq >> 6), (12, OLD.priority, OLD.seq >> 12),
            (18, OLD.priority, OLD.seq >> 18));
    DELETE FROM waiting_counts WHERE jobs = 0 AND (bits, priority, block) IN
        (VALUES (6, OLD.priority, OLD.seq >> 6), (12, OLD.priority, OLD.seq >> 12),
            (18, OLD.priority, OLD.seq >> 18));
END;

CREATE TRIGGER jobs_deleted_while_waiting AFTER DELETE ON jobs WHEN OLD.status = 'queued' BEGIN
    UPDATE waiting_counts SET jobs = jobs - 1
    WHERE (bits, priority, block) IN
        (VALUES (6, OLD.priority, OLD.seq >> 6), (12, OLD.priority, OLD.seq >> 12),
            (18, OLD.priority, OLD.seq >> 18));
    DELETE FROM waiting_counts WHERE jobs = 0 AND (bits, priority, block) IN
        (VALUES (6, OLD.priority, OLD.seq >> 6), (12, OLD.priority, OLD.seq >> 12),
            (18, OLD.priority, OLD.seq >> 18));
END;

-- Jobs by outcome, and by status before they have one.
CREATE TABLE job_counts (
    state  TEXT    PRIMARY KEY,
    jobs   INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO job_counts (state, jobs)
SELECT COALESCE(outcome, status), COUNT(*) FROM jobs GROUP BY 1;

CREATE TRIGGER jobs_counted AFTER INSERT ON jobs BEGIN
    INSERT INTO job_counts (state, jobs) VALUES (COALESCE(NEW.outcome, NEW.status), 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
END;

CREATE TRIGGER jobs_counted_otherwise AFTER UPDATE OF status, outcome ON jobs
WHEN COALESCE(NEW.outcome, NEW.status) <> COALESCE(OLD.outcome, OLD.status) BEGIN
    UPDATE job_counts SET jobs = jobs - 1 WHERE state = COALESCE(OLD.outcome, OLD.status);
    INSERT INTO job_counts (state, jobs) VALUES (COALESCE(NEW.outcome, NEW.status), 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
END;

CREATE TRIGGER jobs_counted_no_more AFTER DELETE ON jobs BEGIN
    UPDATE job_counts SET jobs = jobs - 1 WHERE state = COALESCE(OLD.outcome, OLD.status);
END;

-- Jobs by tag.
CREATE TABLE job_tags (
    tag  TEXT    NOT NULL,
    job  INTEGER NOT NULL,
    PRIMARY KEY (tag, job)
) STRICT, WITHOUT ROWID;

INSERT OR IGNORE INTO job_tags (tag, job) SELECT value, seq FROM jobs, json_each(jobs.tags);

CREATE TRIGGER jobs_tagged AFTER INSERT ON jobs WHEN NEW.tags <> '[]' BEGIN
    INSERT OR IGNORE INTO job_tags (tag, job) SELECT value, NEW.seq FROM json_each(NEW.tags);
END;

CREATE TRIGGER jobs_tagged_otherwise AFTER UPDATE OF tags ON jobs WHEN NEW.tags <> OLD.tags BEGIN
    DELETE FROM job_tags WHERE job = OLD.seq AND tag IN (SELECT value FROM json_each(OLD.tags));
    INSERT OR IGNORE INTO job_tags (tag, job) SELECT value, NEW.seq FROM json_each(NEW.tags);
END;

CREATE TRIGGER jobs_tagged_no_more AFTER DELETE ON jobs WHEN OLD.tags <> '[]' BEGIN
    DELETE FROM job_tags WHERE job = OLD.seq AND tag IN (SELECT value FROM json_each(OLD.tags));
END;

-- What is searched: any three neighbouring characters of name, notes and tags lead to their jobs.
CREATE VIRTUAL TABLE job_texts USING fts5 (
    name, notes, tags, content = 'jobs', content_rowid = 'seq', tokenize = 'trigram', columnsize = 0
);

INSERT INTO job_texts (job_texts) VALUES ('rebuild');

CREATE TRIGGER jobs_searched AFTER INSERT ON jobs BEGIN
    INSERT INTO job_texts (rowid, name, notes, tags)
    VALUES (NEW.seq, NEW.name, NEW.notes, NEW.tags);
END;

CREATE TRIGGER jobs_searched_otherwise AFTER UPDATE OF name, notes, tags ON jobs BEGIN
    INSERT INTO job_texts (job_texts, rowid, name, notes, tags)
    VALUES ('delete', OLD.seq, OLD.name, OLD.notes, OLD.tags);
    INSERT INTO job_texts (rowid, name, notes, tags)
    VALUES (NEW.seq, NEW.name, NEW.notes, NEW.tags);
END;

CREATE TRIGGER jobs_searched_no_more AFTER DELETE ON jobs BEGIN
    INSERT INTO job_texts (job_texts, rowid, name, notes, tags)
    VALUES ('delete', OLD.seq, OLD.name, OLD.notes, OLD.tags);
END;
