-- What was deleted lies in tables of its own until it is brought back or its time is over: no statement
-- that reads jobs meets it. A table of the trash has the columns of the one it mirrors.

CREATE TABLE trash (
    -- The number of the job, which no other gets.
    job           INTEGER PRIMARY KEY,
    id            BLOB    NOT NULL UNIQUE,
    kind          TEXT    NOT NULL,
    name          TEXT    NOT NULL,
    owner         BLOB    REFERENCES people (id),
    project       BLOB    REFERENCES projects (id),
    files         INTEGER NOT NULL,
    -- Files and checkpoints [bytes].
    bytes         INTEGER NOT NULL,
    deleted_at    INTEGER NOT NULL,
    deleted_by    TEXT    NOT NULL,
    -- Whether it went, and comes back, with its project.
    with_project  INTEGER NOT NULL
) STRICT;
CREATE INDEX trash_by_moment ON trash (deleted_at, id);
CREATE INDEX trash_of_owner ON trash (owner, deleted_at, id) WHERE owner IS NOT NULL;
CREATE INDEX trash_of_project ON trash (project) WHERE project IS NOT NULL;

CREATE TABLE trashed_jobs AS SELECT * FROM jobs WHERE FALSE;
CREATE TABLE trashed_specs AS SELECT * FROM specs WHERE FALSE;
CREATE TABLE trashed_results AS SELECT * FROM results WHERE FALSE;
CREATE TABLE trashed_attempts AS SELECT * FROM attempts WHERE FALSE;
CREATE TABLE trashed_curve_blocks AS SELECT * FROM curve_blocks WHERE FALSE;
CREATE TABLE trashed_log_lines AS SELECT * FROM log_lines WHERE FALSE;
CREATE TABLE trashed_attempt_files AS SELECT * FROM attempt_files WHERE FALSE;
CREATE TABLE trashed_checkpoints AS SELECT * FROM checkpoints WHERE FALSE;
CREATE TABLE trashed_checkpoint_files AS SELECT * FROM checkpoint_files WHERE FALSE;
CREATE TABLE trashed_job_faults AS SELECT * FROM job_faults WHERE FALSE;
-- follows from the name
ALTER TABLE trashed_attempt_files DROP COLUMN kind;

CREATE UNIQUE INDEX trashed_jobs_by_number ON trashed_jobs (seq);
CREATE INDEX trashed_specs_of_job ON trashed_specs (job);
CREATE INDEX trashed_results_of_job ON trashed_results (job);
CREATE INDEX trashed_attempts_of_job ON trashed_attempts (job);
CREATE UNIQUE INDEX trashed_attempts_by_number ON trashed_attempts (seq);
CREATE INDEX trashed_curve_blocks_of_attempt ON trashed_curve_blocks (attempt);
CREATE INDEX trashed_log_lines_of_job ON trashed_log_lines (job);
CREATE INDEX trashed_attempt_files_of_attempt ON trashed_attempt_files (attempt);
CREATE INDEX trashed_attempt_files_by_content ON trashed_attempt_files (sha256);
CREATE INDEX trashed_checkpoints_of_job ON trashed_checkpoints (job);
CREATE INDEX trashed_checkpoints_by_content ON trashed_checkpoints (sha256);
CREATE INDEX trashed_checkpoint_files_of_checkpoint ON trashed_checkpoint_files (checkpoint);
CREATE INDEX trashed_checkpoint_files_by_content ON trashed_checkpoint_files (sha256);
CREATE INDEX trashed_job_faults_of_job ON trashed_job_faults (job);

-- What a person keeps in the trash is still theirs to fit into their limit.
CREATE TRIGGER trash_counted AFTER INSERT ON trash WHEN NEW.owner IS NOT NULL BEGIN
    UPDATE people SET file_bytes = file_bytes + NEW.bytes WHERE id = NEW.owner;
END;
CREATE TRIGGER trash_counted_no_more AFTER DELETE ON trash WHEN OLD.owner IS NOT NULL BEGIN
    UPDATE people SET file_bytes = file_bytes - OLD.bytes WHERE id = OLD.owner;
END;
-- It is handed over with the jobs.
CREATE TRIGGER trash_changes_hands AFTER UPDATE OF owner ON trash WHEN OLD.owner IS NOT NEW.owner BEGIN
    UPDATE people SET file_bytes = file_bytes - OLD.bytes WHERE id = OLD.owner;
    UPDATE people SET file_bytes = file_bytes + NEW.bytes WHERE id = NEW.owner;
    UPDATE trashed_jobs SET owner = NEW.owner WHERE seq = NEW.job;
END;

-- A project that was deleted is seen by nobody; its row stays, for what names it.
ALTER TABLE projects ADD COLUMN deleted_at INTEGER;
ALTER TABLE projects ADD COLUMN deleted_by TEXT;
CREATE TRIGGER access_by_deleted_project AFTER UPDATE OF deleted_at ON projects
    BEGIN UPDATE access SET version = version + 1; END;
