-- A submission touches less, as with SQLite (its step 19).
DROP INDEX jobs_waiting_since;

-- Jobs that wait are counted by the lines they stand in.
DELETE FROM job_counts WHERE state = 'queued';
CREATE OR REPLACE FUNCTION jobs_counted() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'UPDATE' AND COALESCE(NEW.outcome, NEW.status) = COALESCE(OLD.outcome, OLD.status) THEN
        RETURN NULL;
    END IF;
    IF TG_OP <> 'INSERT' AND OLD.status <> 'queued' THEN
        UPDATE job_counts SET jobs = jobs - 1 WHERE state = COALESCE(OLD.outcome, OLD.status);
    END IF;
    IF TG_OP <> 'DELETE' AND NEW.status <> 'queued' THEN
        INSERT INTO job_counts AS c (state, jobs) VALUES (COALESCE(NEW.outcome, NEW.status), 1)
        ON CONFLICT (state) DO UPDATE SET jobs = c.jobs + 1;
    END IF;
    RETURN NULL;
END $$;
