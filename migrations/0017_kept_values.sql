-- Values of specs and results that lists are sorted or filtered by, so that none of a million specs has to
-- be read for it. Of all that a spec may say only those fields are kept that somebody has asked for; what is
-- kept follows from `specs` and `results` by triggers, and could be made again from them.
CREATE TABLE kept_fields (
    id           INTEGER PRIMARY KEY,
    -- As lists are asked for it; NULL: it is given up, and its values are on their way out.
    pointer      TEXT    UNIQUE,
    source       TEXT    NOT NULL CHECK (source IN ('specs', 'results')),
    path         TEXT    NOT NULL,
    -- Jobs of this number and later ones have their values here; 0: all.
    filled_from  INTEGER NOT NULL,
    asked_at     INTEGER NOT NULL
) STRICT;

-- Numbers, texts, and truths as the numbers 0 and 1.
CREATE TABLE kept_values (
    field     INTEGER NOT NULL,
    job       INTEGER NOT NULL,
    number    REAL,
    text      TEXT,
    is_truth  INTEGER NOT NULL,
    PRIMARY KEY (field, job)
) STRICT, WITHOUT ROWID;
CREATE INDEX kept_numbers ON kept_values (field, number, job, is_truth) WHERE number IS NOT NULL;
CREATE INDEX kept_texts ON kept_values (field, text, job) WHERE text IS NOT NULL;

-- What the jobs say at these fields. Long specs are networks and scenes body by body; long texts are no
-- words to sort by.
CREATE VIEW found_values AS
SELECT f.source, f.id AS field, s.job,
    CASE WHEN json_type(s.json, f.path) <> 'text' THEN CAST(json_extract(s.json, f.path) AS REAL) END AS number,
    CASE json_type(s.json, f.path) WHEN 'text' THEN json_extract(s.json, f.path) END AS text,
    json_type(s.json, f.path) IN ('true', 'false') AS is_truth
FROM kept_fields f, specs s
WHERE f.source = 'specs' AND f.pointer IS NOT NULL AND octet_length(s.json) <= 200000
    AND json_type(s.json, f.path) IN ('integer', 'real', 'true', 'false', 'text')
    AND (json_type(s.json, f.path) <> 'text' OR octet_length(json_extract(s.json, f.path)) <= 500)
UNION ALL
SELECT f.source, f.id, r.job,
    CASE WHEN json_type(r.summary, f.path) <> 'text' THEN CAST(json_extract(r.summary, f.path) AS REAL) END,
    CASE json_type(r.summary, f.path) WHEN 'text' THEN json_extract(r.summary, f.path) END,
    json_type(r.summary, f.path) IN ('true', 'false')
FROM kept_fields f, results r
WHERE f.source = 'results' AND f.pointer IS NOT NULL AND octet_length(r.summary) <= 200000
    AND json_type(r.summary, f.path) IN ('integer', 'real', 'true', 'false', 'text')
    AND (json_type(r.summary, f.path) <> 'text' OR octet_length(json_extract(r.summary, f.path)) <= 500);

CREATE TRIGGER specs_kept AFTER INSERT ON specs BEGIN
    INSERT INTO kept_values (field, job, number, text, is_truth)
    SELECT field, job, number, text, is_truth FROM found_values WHERE source = 'specs' AND job = NEW.job;
END;
CREATE TRIGGER specs_kept_no_more AFTER DELETE ON specs BEGIN
    DELETE FROM kept_values
    WHERE job = OLD.job AND field IN (SELECT id FROM kept_fields WHERE source = 'specs');
END;
CREATE TRIGGER results_kept AFTER INSERT ON results BEGIN
    INSERT INTO kept_values (field, job, number, text, is_truth)
    SELECT field, job, number, text, is_truth FROM found_values WHERE source = 'results' AND job = NEW.job;
END;
CREATE TRIGGER results_kept_no_more AFTER DELETE ON results BEGIN
    DELETE FROM kept_values
    WHERE job = OLD.job AND field IN (SELECT id FROM kept_fields WHERE source = 'results');
END;
