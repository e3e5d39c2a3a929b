-- Comparisons: jobs that are looked at side by side, under a name; and links that show one.

CREATE TABLE comparisons (
    id          BLOB    PRIMARY KEY,
    name        TEXT    NOT NULL,
    -- How the page shows it, as the query of its address.
    view        TEXT    NOT NULL,
    owner       BLOB    REFERENCES people (id),
    -- Whose people see it, beside its owner.
    project     BLOB    REFERENCES projects (id),
    created_at  INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX comparisons_by_moment ON comparisons (created_at);

-- Its jobs by id, in order; a job that is deleted is missing from then on. They never change, so that a
-- link shows later what it showed when it was made.
CREATE TABLE comparison_jobs (
    comparison  BLOB    NOT NULL REFERENCES comparisons (id) ON DELETE CASCADE,
    place       INTEGER NOT NULL,
    job         BLOB    NOT NULL,
    PRIMARY KEY (comparison, place)
) STRICT, WITHOUT ROWID;

-- A link may show a comparison. A condition of a table is changed by making the table anew.
CREATE TABLE shares_of_three (
    id             BLOB    PRIMARY KEY,
    secret_sha256  TEXT    NOT NULL UNIQUE,
    -- What it shows. It ends with its job or comparison.
    job            BLOB,
    project        BLOB    REFERENCES projects (id),
    comparison     BLOB,
    shows_files    INTEGER NOT NULL,
    person         BLOB    NOT NULL REFERENCES people (id),
    created_at     INTEGER NOT NULL,
    expires_at     INTEGER NOT NULL,
    revoked_at     INTEGER,
    uses           INTEGER NOT NULL DEFAULT 0,
    last_used_at   INTEGER,
    CHECK ((job IS NOT NULL) + (project IS NOT NULL) + (comparison IS NOT NULL) = 1)
) STRICT, WITHOUT ROWID;
INSERT INTO shares_of_three (id, secret_sha256, job, project, shows_files, person, created_at, expires_at,
                             revoked_at, uses, last_used_at)
    SELECT id, secret_sha256, job, project, shows_files, person, created_at, expires_at, revoked_at, uses,
           last_used_at
    FROM shares;
DROP TABLE shares;
ALTER TABLE shares_of_three RENAME TO shares;
CREATE INDEX shares_of_job ON shares (job) WHERE job IS NOT NULL;
CREATE INDEX shares_of_comparison ON shares (comparison) WHERE comparison IS NOT NULL;
CREATE TRIGGER access_by_share AFTER UPDATE OF revoked_at ON shares
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER shares_are_told AFTER INSERT ON shares BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, 'shared', NEW.created_at, json_object('job', lower(hex(NEW.job)),
        'project', lower(hex(NEW.project)), 'comparison', lower(hex(NEW.comparison)),
        'link', lower(hex(NEW.id)), 'files', NEW.shows_files)
    FROM webhooks w
    WHERE w.removed_at IS NULL AND EXISTS (SELECT 1 FROM json_each(w.events) e WHERE e.value = 'shared')
      AND ((w.project IS NULL AND w.person IN (SELECT j.owner FROM jobs j WHERE j.id = NEW.job
                                               UNION ALL
                                               SELECT c.owner FROM comparisons c WHERE c.id = NEW.comparison))
        OR w.project = NEW.project
        OR w.project = (SELECT j.project FROM jobs j WHERE j.id = NEW.job)
        OR w.project = (SELECT c.project FROM comparisons c WHERE c.id = NEW.comparison));
END;
CREATE TRIGGER access_by_comparison AFTER DELETE ON comparisons
    BEGIN UPDATE access SET version = version + 1; END;
