-- Texts of new jobs come into the index many at a time, every second and before a search: one at a time, that
-- is a third of what storing a submission takes.
CREATE TABLE job_texts_known (
    -- Texts of jobs up to this number are in the index.
    up_to INTEGER NOT NULL
) STRICT;
INSERT INTO job_texts_known SELECT COALESCE(MAX(seq), 0) FROM jobs;

DROP TRIGGER jobs_searched;
DROP TRIGGER jobs_searched_otherwise;
DROP TRIGGER jobs_searched_no_more;

-- Jobs that come back from the trash.
CREATE TRIGGER jobs_searched AFTER INSERT ON jobs WHEN NEW.seq <= (SELECT up_to FROM job_texts_known) BEGIN
    INSERT INTO job_texts (rowid, name, notes, tags)
    VALUES (NEW.seq, NEW.name, NEW.notes, NEW.tags);
END;

CREATE TRIGGER jobs_searched_otherwise AFTER UPDATE OF name, notes, tags ON jobs
WHEN OLD.seq <= (SELECT up_to FROM job_texts_known) BEGIN
    INSERT INTO job_texts (job_texts, rowid, name, notes, tags)
    VALUES ('delete', OLD.seq, OLD.name, OLD.notes, OLD.tags);
    INSERT INTO job_texts (rowid, name, notes, tags)
    VALUES (NEW.seq, NEW.name, NEW.notes, NEW.tags);
END;

CREATE TRIGGER jobs_searched_no_more AFTER DELETE ON jobs WHEN OLD.seq <= (SELECT up_to FROM job_texts_known) BEGIN
    INSERT INTO job_texts (job_texts, rowid, name, notes, tags)
    VALUES ('delete', OLD.seq, OLD.name, OLD.notes, OLD.tags);
END;
