-- What is searched: any three neighbouring characters of name, notes and tags lead to their jobs, as in SQLite's
-- index of the same name, and without an extension. The index says which jobs may hold a text; whether they do is
-- read in themselves.

-- Any three neighbouring characters of a text in small letters, each once.
CREATE FUNCTION trigrams(text_in TEXT) RETURNS TEXT[] LANGUAGE SQL IMMUTABLE AS $$
    SELECT COALESCE(array_agg(DISTINCT three COLLATE "C"), '{}')
    FROM (SELECT c || lead(c) OVER rest || lead(c, 2) OVER rest AS three
          FROM unnest(string_to_array(folded(text_in), NULL)) WITH ORDINALITY u(c, place)
          WINDOW rest AS (ORDER BY place)) t
    WHERE three IS NOT NULL
$$;
-- Those of a job.
CREATE FUNCTION trigrams(name TEXT, notes TEXT, tags TEXT) RETURNS TEXT[] LANGUAGE SQL IMMUTABLE AS $$
    SELECT trigrams(name || ' ' || notes || ' ' || tags)
$$;

CREATE TABLE job_texts (
    job BIGINT PRIMARY KEY,
    trigrams TEXT[] COLLATE "C" NOT NULL
);
CREATE INDEX job_texts_by_trigram ON job_texts USING GIN (trigrams);

INSERT INTO job_texts (job, trigrams)
SELECT seq, trigrams(name, notes, tags) FROM jobs;

CREATE FUNCTION jobs_searched() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'DELETE' THEN
        DELETE FROM job_texts WHERE job = OLD.seq;
    ELSE
        INSERT INTO job_texts (job, trigrams)
        VALUES (NEW.seq, trigrams(NEW.name, NEW.notes, NEW.tags))
        ON CONFLICT (job) DO UPDATE SET trigrams = excluded.trigrams;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_searched AFTER INSERT OR DELETE OR UPDATE OF name, notes, tags ON jobs
    FOR EACH ROW EXECUTE FUNCTION jobs_searched();
