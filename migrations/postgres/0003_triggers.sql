-- What follows from a change of a table is kept by triggers, each as with SQLite under the same name; they
-- share a function where they do the same.

CREATE FUNCTION audit_only_grows() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    RAISE EXCEPTION 'the audit log only grows';
END $$;
CREATE TRIGGER audit_is_not_changed BEFORE UPDATE OR DELETE ON audit FOR EACH ROW EXECUTE FUNCTION audit_only_grows();

-- Who may see what has changed.
CREATE FUNCTION access_changes() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    UPDATE access SET version = version + 1;
    RETURN NULL;
END $$;
CREATE TRIGGER access_by_people AFTER INSERT ON people FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_role AFTER UPDATE OF role, left_at ON people FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_session AFTER DELETE ON sessions FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_token AFTER UPDATE OF revoked_at, person ON tokens
    FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_member AFTER INSERT OR DELETE ON members FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_project AFTER INSERT ON projects FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_owner AFTER UPDATE OF person, team, visibility, archived_at, deleted_at ON projects
    FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_job AFTER UPDATE OF owner, project ON jobs FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_share AFTER UPDATE OF revoked_at ON shares FOR EACH ROW EXECUTE FUNCTION access_changes();
CREATE TRIGGER access_by_comparison AFTER DELETE ON comparisons FOR EACH ROW EXECUTE FUNCTION access_changes();

-- A job more, or one less, that waits with this priority, owner, kind and need.
CREATE FUNCTION wait_counted(job jobs, more BIGINT) RETURNS VOID LANGUAGE PLPGSQL AS $$ BEGIN
    INSERT INTO waiting_counts AS w (bits, priority, owner, block, jobs)
    SELECT b, job.priority, COALESCE(job.owner, ''), job.seq >> b, more FROM unnest(ARRAY[6, 12, 18]) b
    ON CONFLICT (bits, priority, owner, block) DO UPDATE SET jobs = w.jobs + more;
    INSERT INTO waiting_lines AS w (priority, owner, kind, needs, jobs, core_ms)
    VALUES (job.priority, COALESCE(job.owner, ''), job.kind, job.needs, more, more * core_ms(job.estimate))
    ON CONFLICT (priority, owner, kind, needs)
        DO UPDATE SET jobs = w.jobs + more, core_ms = w.core_ms + more * core_ms(job.estimate);
    IF more < 0 THEN
        DELETE FROM waiting_counts w USING unnest(ARRAY[6, 12, 18]) b
        WHERE w.jobs = 0 AND w.bits = b AND w.priority = job.priority AND w.owner = COALESCE(job.owner, '')
            AND w.block = job.seq >> b;
        DELETE FROM waiting_lines w
        WHERE w.jobs = 0 AND w.priority = job.priority AND w.owner = COALESCE(job.owner, '') AND w.kind = job.kind
            AND w.needs = job.needs;
    END IF;
END $$;
CREATE FUNCTION jobs_wait() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP <> 'INSERT' AND OLD.status = 'queued' AND (TG_OP = 'DELETE' OR NEW.status <> 'queued'
            OR OLD.priority <> NEW.priority OR OLD.owner IS DISTINCT FROM NEW.owner) THEN
        PERFORM wait_counted(OLD, -1);
    END IF;
    IF TG_OP <> 'DELETE' AND NEW.status = 'queued' AND (TG_OP = 'INSERT' OR OLD.status <> 'queued'
            OR OLD.priority <> NEW.priority OR OLD.owner IS DISTINCT FROM NEW.owner) THEN
        PERFORM wait_counted(NEW, 1);
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_wait AFTER INSERT OR DELETE OR UPDATE OF status, priority, owner ON jobs
    FOR EACH ROW EXECUTE FUNCTION jobs_wait();

-- Jobs by state.
CREATE FUNCTION jobs_counted() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'UPDATE' AND COALESCE(NEW.outcome, NEW.status) = COALESCE(OLD.outcome, OLD.status) THEN
        RETURN NULL;
    END IF;
    IF TG_OP <> 'INSERT' THEN
        UPDATE job_counts SET jobs = jobs - 1 WHERE state = COALESCE(OLD.outcome, OLD.status);
    END IF;
    IF TG_OP <> 'DELETE' THEN
        INSERT INTO job_counts AS c (state, jobs) VALUES (COALESCE(NEW.outcome, NEW.status), 1)
        ON CONFLICT (state) DO UPDATE SET jobs = c.jobs + 1;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_counted AFTER INSERT OR DELETE OR UPDATE OF status, outcome ON jobs
    FOR EACH ROW EXECUTE FUNCTION jobs_counted();

-- Jobs by tag.
CREATE FUNCTION jobs_tagged() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'UPDATE' AND NEW.tags = OLD.tags THEN
        RETURN NULL;
    END IF;
    IF TG_OP <> 'INSERT' THEN
        DELETE FROM job_tags WHERE job = OLD.seq AND tag IN (SELECT value FROM json_each(OLD.tags));
    END IF;
    IF TG_OP <> 'DELETE' THEN
        INSERT INTO job_tags (tag, job) SELECT value, NEW.seq FROM json_each(NEW.tags) ON CONFLICT DO NOTHING;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_tagged AFTER INSERT OR DELETE OR UPDATE OF tags ON jobs
    FOR EACH ROW EXECUTE FUNCTION jobs_tagged();

-- A finished job that begins anew has not been cleared.
CREATE FUNCTION jobs_begun_anew() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    UPDATE jobs SET cleared = 0 WHERE seq = NEW.seq;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_begun_anew AFTER UPDATE OF status ON jobs FOR EACH ROW
    WHEN (OLD.status = 'finished' AND NEW.status <> 'finished' AND NEW.cleared > 0)
    EXECUTE FUNCTION jobs_begun_anew();

-- A file that is uploaded again takes the place of the one before.
CREATE FUNCTION files_replaced() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    DELETE FROM attempt_files WHERE attempt = NEW.attempt AND name = NEW.name;
    RETURN NEW;
END $$;
CREATE TRIGGER files_replaced BEFORE INSERT ON attempt_files FOR EACH ROW EXECUTE FUNCTION files_replaced();

-- So many files and bytes more of a kind, of the job of an attempt.
CREATE FUNCTION files_counted(of_attempt BIGINT, of_kind TEXT, more BIGINT, more_bytes BIGINT) RETURNS VOID
LANGUAGE SQL AS $$
    INSERT INTO disk_use AS u (person, project, kind, files, bytes)
    SELECT COALESCE(j.owner, ''), COALESCE(j.project, ''), of_kind, more, more_bytes
    FROM attempts a JOIN jobs j ON j.seq = a.job WHERE a.seq = of_attempt
    ON CONFLICT (person, project, kind)
        DO UPDATE SET files = u.files + excluded.files, bytes = u.bytes + excluded.bytes
$$;

-- Files and checkpoints of a job in bytes, and files by whose they are.
CREATE FUNCTION files_change() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'UPDATE' THEN
        IF NEW.kind <> OLD.kind THEN
            PERFORM files_counted(OLD.attempt, OLD.kind, -1, -OLD.bytes);
            PERFORM files_counted(NEW.attempt, NEW.kind, 1, NEW.bytes);
        END IF;
    ELSIF TG_OP = 'INSERT' THEN
        UPDATE jobs SET file_bytes = file_bytes + NEW.bytes
        WHERE seq = (SELECT job FROM attempts WHERE seq = NEW.attempt);
        PERFORM files_counted(NEW.attempt, NEW.kind, 1, NEW.bytes);
    ELSE
        UPDATE jobs SET file_bytes = file_bytes - OLD.bytes
        WHERE seq = (SELECT job FROM attempts WHERE seq = OLD.attempt);
        PERFORM files_counted(OLD.attempt, OLD.kind, -1, -OLD.bytes);
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER files_change AFTER INSERT OR DELETE OR UPDATE OF name ON attempt_files
    FOR EACH ROW EXECUTE FUNCTION files_change();
CREATE FUNCTION checkpoints_change() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'INSERT' THEN
        UPDATE jobs SET file_bytes = file_bytes + NEW.bytes WHERE seq = NEW.job;
    ELSE
        UPDATE jobs SET file_bytes = file_bytes - OLD.bytes WHERE seq = OLD.job;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER checkpoints_change AFTER INSERT OR DELETE ON checkpoints
    FOR EACH ROW EXECUTE FUNCTION checkpoints_change();

-- Files of a person are those of the person's jobs.
CREATE FUNCTION jobs_grow() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP = 'UPDATE' AND OLD.owner IS NOT DISTINCT FROM NEW.owner THEN
        UPDATE people SET file_bytes = file_bytes + NEW.file_bytes - OLD.file_bytes
        WHERE id = NEW.owner AND NEW.file_bytes <> OLD.file_bytes;
        RETURN NULL;
    END IF;
    IF OLD.file_bytes <> 0 THEN
        UPDATE people SET file_bytes = file_bytes - OLD.file_bytes WHERE id = OLD.owner;
    END IF;
    IF TG_OP = 'UPDATE' AND NEW.file_bytes <> 0 THEN
        UPDATE people SET file_bytes = file_bytes + NEW.file_bytes WHERE id = NEW.owner;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_grow AFTER DELETE OR UPDATE OF file_bytes, owner ON jobs FOR EACH ROW EXECUTE FUNCTION jobs_grow();

-- Files go with their job: of one that is deleted at once, as its files go after it, when nobody knows whose
-- they were.
CREATE FUNCTION jobs_files_moved() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    UPDATE disk_use SET files = disk_use.files - u.files, bytes = disk_use.bytes - u.bytes
    FROM (SELECT f.kind, COUNT(*) AS files, SUM(f.bytes)::BIGINT AS bytes
          FROM attempts a JOIN attempt_files f ON f.attempt = a.seq WHERE a.job = OLD.seq
          GROUP BY f.kind) u
    WHERE disk_use.person = COALESCE(OLD.owner, '') AND disk_use.project = COALESCE(OLD.project, '')
      AND disk_use.kind = u.kind;
    IF TG_OP = 'DELETE' THEN
        RETURN OLD;
    END IF;
    INSERT INTO disk_use AS u (person, project, kind, files, bytes)
    SELECT COALESCE(NEW.owner, ''), COALESCE(NEW.project, ''), f.kind, COUNT(*), SUM(f.bytes)::BIGINT
    FROM attempts a JOIN attempt_files f ON f.attempt = a.seq WHERE a.job = NEW.seq GROUP BY f.kind
    ON CONFLICT (person, project, kind)
        DO UPDATE SET files = u.files + excluded.files, bytes = u.bytes + excluded.bytes;
    RETURN NULL;
END $$;
CREATE TRIGGER jobs_files_counted_no_more BEFORE DELETE ON jobs FOR EACH ROW EXECUTE FUNCTION jobs_files_moved();
CREATE TRIGGER jobs_files_moved AFTER UPDATE OF owner, project ON jobs FOR EACH ROW
    WHEN (OLD.owner IS DISTINCT FROM NEW.owner OR OLD.project IS DISTINCT FROM NEW.project)
    EXECUTE FUNCTION jobs_files_moved();

-- What a person keeps in the trash is still theirs to fit into their limit; it is handed over with the jobs.
CREATE FUNCTION trash_counted() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    IF TG_OP <> 'INSERT' THEN
        UPDATE people SET file_bytes = file_bytes - OLD.bytes WHERE id = OLD.owner;
    END IF;
    IF TG_OP <> 'DELETE' THEN
        UPDATE people SET file_bytes = file_bytes + NEW.bytes WHERE id = NEW.owner;
    END IF;
    IF TG_OP = 'UPDATE' THEN
        UPDATE trashed_jobs SET owner = NEW.owner WHERE seq = NEW.job;
    END IF;
    RETURN NULL;
END $$;
CREATE TRIGGER trash_counted AFTER INSERT OR DELETE ON trash FOR EACH ROW EXECUTE FUNCTION trash_counted();
CREATE TRIGGER trash_changes_hands AFTER UPDATE OF owner ON trash FOR EACH ROW
    WHEN (OLD.owner IS DISTINCT FROM NEW.owner) EXECUTE FUNCTION trash_counted();

-- Who wants to know is told: of ends, of links, and when the files of a person come to nine tenths of the
-- person's limit, and to all of it.
CREATE FUNCTION ends_are_told() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, e.value, NEW.finished_at, json_build_object('job', lower(hex(NEW.id)), 'name', NEW.name,
        'kind', NEW.kind, 'outcome', NEW.outcome, 'reason', NEW.reason)::TEXT
    FROM webhooks w CROSS JOIN json_each(w.events) e
    WHERE w.removed_at IS NULL
      AND ((w.project IS NULL AND w.person = NEW.owner) OR w.project = NEW.project)
      AND e.value = CASE NEW.outcome WHEN 'quarantined' THEN 'quarantined'
            WHEN 'failed' THEN 'failed' WHEN 'timed_out' THEN 'failed' ELSE 'ended' END;
    RETURN NULL;
END $$;
CREATE TRIGGER ends_are_told AFTER UPDATE OF status ON jobs FOR EACH ROW
    WHEN (NEW.status = 'finished' AND OLD.status <> 'finished') EXECUTE FUNCTION ends_are_told();

CREATE FUNCTION shares_are_told() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, 'shared', NEW.created_at, json_build_object('job', COALESCE(lower(hex(NEW.job)), ''),
        'project', COALESCE(lower(hex(NEW.project)), ''), 'comparison', COALESCE(lower(hex(NEW.comparison)), ''),
        'link', lower(hex(NEW.id)), 'files', NEW.shows_files::INTEGER)::TEXT
    FROM webhooks w
    WHERE w.removed_at IS NULL AND EXISTS (SELECT 1 FROM json_each(w.events) e WHERE e.value = 'shared')
      AND ((w.project IS NULL AND w.person IN (SELECT j.owner FROM jobs j WHERE j.id = NEW.job
                                               UNION ALL
                                               SELECT c.owner FROM comparisons c WHERE c.id = NEW.comparison))
        OR w.project = NEW.project
        OR w.project = (SELECT j.project FROM jobs j WHERE j.id = NEW.job)
        OR w.project = (SELECT c.project FROM comparisons c WHERE c.id = NEW.comparison));
    RETURN NULL;
END $$;
CREATE TRIGGER shares_are_told AFTER INSERT ON shares FOR EACH ROW EXECUTE FUNCTION shares_are_told();

CREATE FUNCTION limits_are_told() RETURNS TRIGGER LANGUAGE PLPGSQL AS $$ BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, 'quota', (1000 * extract(epoch FROM clock_timestamp()))::BIGINT,
        json_build_object('person', NEW.name, 'used_gb', NEW.file_bytes / 1e9::DOUBLE PRECISION,
            'limit_gb', NEW.most_disk_gb)::TEXT
    FROM webhooks w
    WHERE w.removed_at IS NULL AND w.project IS NULL AND w.person = NEW.id
      AND EXISTS (SELECT 1 FROM json_each(w.events) e WHERE e.value = 'quota');
    RETURN NULL;
END $$;
CREATE TRIGGER limits_are_told AFTER UPDATE OF file_bytes ON people FOR EACH ROW
    WHEN (NEW.most_disk_gb IS NOT NULL
        AND ((OLD.file_bytes < 0.9e9 * NEW.most_disk_gb AND NEW.file_bytes >= 0.9e9 * NEW.most_disk_gb)
          OR (OLD.file_bytes < 1e9 * NEW.most_disk_gb AND NEW.file_bytes >= 1e9 * NEW.most_disk_gb)))
    EXECUTE FUNCTION limits_are_told();
