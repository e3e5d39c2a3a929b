-- Values of specs and results that lists are sorted or filtered by, as with SQLite (its step 17).
CREATE TABLE kept_fields (
    id BIGINT PRIMARY KEY,
    pointer TEXT COLLATE "C" UNIQUE,
    source TEXT COLLATE "C" NOT NULL CHECK (source IN ('specs', 'results')),
    path TEXT COLLATE "C" NOT NULL,
    filled_from BIGINT NOT NULL,
    asked_at BIGINT NOT NULL
);

CREATE TABLE kept_values (
    field BIGINT NOT NULL,
    job BIGINT NOT NULL,
    number DOUBLE PRECISION,
    text TEXT COLLATE "C",
    is_truth BIGINT NOT NULL,
    PRIMARY KEY (field, job)
);
CREATE INDEX kept_numbers ON kept_values (field, number, job, is_truth) WHERE number IS NOT NULL;
CREATE INDEX kept_texts ON kept_values (field, text, job) WHERE text IS NOT NULL;

-- What the jobs say at these fields.
CREATE VIEW found_values AS
SELECT d.source, d.field, d.job,
    CASE jsonb_typeof(d.part) WHEN 'number' THEN CAST(d.part AS DOUBLE PRECISION)
        WHEN 'boolean' THEN CAST(CAST(d.part AS BOOLEAN) AS INTEGER) END AS number,
    CASE jsonb_typeof(d.part) WHEN 'string' THEN d.part #>> '{}' END AS text,
    CAST(CASE jsonb_typeof(d.part) WHEN 'boolean' THEN 1 ELSE 0 END AS BIGINT) AS is_truth
FROM (
    SELECT f.source, f.id AS field, s.job, p.part
    FROM kept_fields f, specs s, LATERAL (SELECT json_at(s.json, f.path) AS part OFFSET 0) p
    WHERE f.source = 'specs' AND f.pointer IS NOT NULL AND octet_length(s.json) <= 200000
    UNION ALL
    SELECT f.source, f.id, r.job, p.part
    FROM kept_fields f, results r, LATERAL (SELECT json_at(r.summary, f.path) AS part OFFSET 0) p
    WHERE f.source = 'results' AND f.pointer IS NOT NULL AND octet_length(r.summary) <= 200000
) d
WHERE jsonb_typeof(d.part) IN ('number', 'boolean')
    OR (jsonb_typeof(d.part) = 'string' AND octet_length(d.part #>> '{}') <= 500);

-- The source is the name of the table, `specs` or `results`.
CREATE FUNCTION values_are_kept() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'DELETE' THEN
        DELETE FROM kept_values
        WHERE job = OLD.job AND field IN (SELECT id FROM kept_fields WHERE source = TG_TABLE_NAME);
    ELSE
        INSERT INTO kept_values (field, job, number, text, is_truth)
        SELECT field, job, number, text, is_truth FROM found_values
        WHERE source = TG_TABLE_NAME AND job = NEW.job;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER specs_kept AFTER INSERT OR DELETE ON specs FOR EACH ROW EXECUTE FUNCTION values_are_kept();
CREATE TRIGGER results_kept AFTER INSERT OR DELETE ON results FOR EACH ROW EXECUTE FUNCTION values_are_kept();
