-- Which store this is. The folder of its files carries the same name, so that neither is taken for
-- another's: files that a foreign database does not know would look forgotten.
CREATE TABLE store (
    only    INTEGER PRIMARY KEY CHECK (only = 1),
    id      BLOB    NOT NULL,
    -- Servers that were started on it. The folder counts along: where it is ahead, the database is
    -- an older one that was put back.
    starts  INTEGER NOT NULL
) STRICT;
