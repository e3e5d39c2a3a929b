-- A submission by itself writes every page that it touches to the disk: here it touches two less.

-- The first of those that wait is found by their status: numbers are in the order of submission.
DROP INDEX jobs_waiting_since;

-- Jobs that wait are counted by the lines they stand in.
DROP TRIGGER jobs_counted;
DROP TRIGGER jobs_counted_otherwise;
DELETE FROM job_counts WHERE state = 'queued';

CREATE TRIGGER jobs_counted AFTER INSERT ON jobs WHEN NEW.status <> 'queued' BEGIN
    INSERT INTO job_counts (state, jobs) VALUES (COALESCE(NEW.outcome, NEW.status), 1)
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
END;

CREATE TRIGGER jobs_counted_otherwise AFTER UPDATE OF status, outcome ON jobs
WHEN COALESCE(NEW.outcome, NEW.status) <> COALESCE(OLD.outcome, OLD.status) BEGIN
    UPDATE job_counts SET jobs = jobs - 1 WHERE state = COALESCE(OLD.outcome, OLD.status);
    INSERT INTO job_counts (state, jobs)
    SELECT COALESCE(NEW.outcome, NEW.status), 1 WHERE NEW.status <> 'queued'
    ON CONFLICT DO UPDATE SET jobs = jobs + 1;
END;
