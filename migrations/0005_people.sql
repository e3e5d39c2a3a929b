-- People, and who shares what with whom. A server without people is one person's, as before; the
-- first administrator makes it a group's. Nobody and no project is ever deleted: what was done stays
-- somebody's.

CREATE TABLE people (
    id          BLOB    PRIMARY KEY,
    name        TEXT    NOT NULL,
    -- The name in small letters: no two people differ by case alone.
    folded      TEXT    NOT NULL UNIQUE,
    role        TEXT    NOT NULL CHECK (role IN ('administrator', 'member', 'guest')),
    -- Argon2id in the PHC form, salt and costs included.
    password    TEXT    NOT NULL,
    created_at  INTEGER NOT NULL,
    left_at     INTEGER
) STRICT, WITHOUT ROWID;

-- Secrets below are nowhere: each is shown once, and known again by its SHA-256.

CREATE TABLE invitations (
    id             BLOB    PRIMARY KEY,
    secret_sha256  TEXT    NOT NULL UNIQUE,
    role           TEXT    NOT NULL,
    -- A JSON array of ids.
    groups         TEXT    NOT NULL,
    created_at     INTEGER NOT NULL,
    expires_at     INTEGER NOT NULL,
    accepted_at    INTEGER,
    revoked_at     INTEGER
) STRICT, WITHOUT ROWID;

CREATE TABLE sessions (
    id             BLOB    PRIMARY KEY,
    secret_sha256  TEXT    NOT NULL UNIQUE,
    person         BLOB    NOT NULL REFERENCES people (id),
    -- Whether its cookie travels over TLS only.
    is_secure      INTEGER NOT NULL,
    client         TEXT    NOT NULL,
    created_at     INTEGER NOT NULL,
    last_used_at   INTEGER NOT NULL,
    expires_at     INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX sessions_of_person ON sessions (person);

-- A token without an owner is a worker's, or of a server without people.
ALTER TABLE tokens ADD COLUMN person BLOB REFERENCES people (id);
ALTER TABLE tokens ADD COLUMN scope TEXT NOT NULL DEFAULT 'everything'
    CHECK (scope IN ('read', 'submit', 'worker', 'everything'));
ALTER TABLE tokens ADD COLUMN expires_at INTEGER;
ALTER TABLE tokens ADD COLUMN last_used_at INTEGER;
-- The secret a server is started with was kept here, and stayed valid after it was changed. Now it is
-- valid as long as the server that was started with it runs.
UPDATE tokens SET revoked_at = COALESCE(revoked_at, created_at) WHERE name = 'environment';

CREATE TABLE groups (
    id          BLOB    PRIMARY KEY,
    name        TEXT    NOT NULL,
    folded      TEXT    NOT NULL UNIQUE,
    created_at  INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE members (
    team    BLOB NOT NULL REFERENCES groups (id),
    person  BLOB NOT NULL REFERENCES people (id),
    PRIMARY KEY (team, person)
) STRICT, WITHOUT ROWID;
CREATE INDEX members_by_person ON members (person);

CREATE TABLE projects (
    id           BLOB    PRIMARY KEY,
    name         TEXT    NOT NULL,
    -- Whose it is: a person's or a group's.
    person       BLOB    REFERENCES people (id),
    team         BLOB    REFERENCES groups (id),
    visibility   TEXT    NOT NULL CHECK (visibility IN ('private', 'group', 'everyone')),
    created_at   INTEGER NOT NULL,
    archived_at  INTEGER,
    CHECK ((person IS NULL) <> (team IS NULL))
) STRICT, WITHOUT ROWID;
CREATE INDEX projects_of_person ON projects (person, created_at);

ALTER TABLE jobs ADD COLUMN owner BLOB REFERENCES people (id);
ALTER TABLE jobs ADD COLUMN project BLOB REFERENCES projects (id);
CREATE INDEX jobs_of_owner ON jobs (owner, seq) WHERE owner IS NOT NULL;
CREATE INDEX jobs_of_project ON jobs (project, seq) WHERE project IS NOT NULL;

-- Whose a deleted job was, so that only who saw it is told that it is gone.
ALTER TABLE events ADD COLUMN owner BLOB;
ALTER TABLE events ADD COLUMN project BLOB;

CREATE TABLE shares (
    id             BLOB    PRIMARY KEY,
    secret_sha256  TEXT    NOT NULL UNIQUE,
    -- What it shows. It ends with its job.
    job            BLOB,
    project        BLOB    REFERENCES projects (id),
    shows_files    INTEGER NOT NULL,
    person         BLOB    NOT NULL REFERENCES people (id),
    created_at     INTEGER NOT NULL,
    expires_at     INTEGER NOT NULL,
    revoked_at     INTEGER,
    uses           INTEGER NOT NULL DEFAULT 0,
    last_used_at   INTEGER,
    CHECK ((job IS NULL) <> (project IS NULL))
) STRICT, WITHOUT ROWID;
CREATE INDEX shares_of_job ON shares (job) WHERE job IS NOT NULL;

-- What was done, by whom. It only grows: names are those of the moment.
CREATE TABLE audit (
    number      INTEGER PRIMARY KEY AUTOINCREMENT,
    at          INTEGER NOT NULL,
    who         TEXT    NOT NULL,
    person      BLOB,
    credential  BLOB,
    action      TEXT    NOT NULL,
    object      BLOB,
    detail      TEXT    NOT NULL,
    request     BLOB,
    address     TEXT    NOT NULL
) STRICT;
CREATE INDEX audit_by_object ON audit (object, number) WHERE object IS NOT NULL;
CREATE TRIGGER audit_is_not_changed BEFORE UPDATE ON audit
    BEGIN SELECT RAISE(ABORT, 'the audit log only grows'); END;
CREATE TRIGGER audit_is_not_deleted BEFORE DELETE ON audit
    BEGIN SELECT RAISE(ABORT, 'the audit log only grows'); END;

-- Counts what may change who sees what, whichever process does it: open streams look here.
CREATE TABLE access (
    only     INTEGER PRIMARY KEY CHECK (only = 1),
    version  INTEGER NOT NULL
) STRICT;
INSERT INTO access VALUES (1, 0);
CREATE TRIGGER access_by_people AFTER INSERT ON people
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_role AFTER UPDATE OF role, left_at ON people
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_session AFTER DELETE ON sessions
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_token AFTER UPDATE OF revoked_at, person ON tokens
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_member AFTER INSERT ON members
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_leaver AFTER DELETE ON members
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_project AFTER INSERT ON projects
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_owner AFTER UPDATE OF person, team, visibility, archived_at ON projects
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_share AFTER UPDATE OF revoked_at ON shares
    BEGIN UPDATE access SET version = version + 1; END;
CREATE TRIGGER access_by_job AFTER UPDATE OF owner, project ON jobs
    BEGIN UPDATE access SET version = version + 1; END;
