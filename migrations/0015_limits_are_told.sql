-- Who wants to know is told when the files of a person come to nine tenths of the person's limit, and when
-- they come to all of it.
CREATE TRIGGER limits_are_told AFTER UPDATE OF file_bytes ON people
WHEN NEW.most_disk_gb IS NOT NULL
    AND ((OLD.file_bytes < 0.9e9 * NEW.most_disk_gb AND NEW.file_bytes >= 0.9e9 * NEW.most_disk_gb)
      OR (OLD.file_bytes < 1e9 * NEW.most_disk_gb AND NEW.file_bytes >= 1e9 * NEW.most_disk_gb))
BEGIN
    INSERT INTO outbox (webhook, event, at, body)
    SELECT w.id, 'quota', CAST(1000 * unixepoch('subsec') AS INTEGER),
        json_object('person', NEW.name, 'used_gb', NEW.file_bytes / 1e9, 'limit_gb', NEW.most_disk_gb)
    FROM webhooks w
    WHERE w.removed_at IS NULL AND w.project IS NULL AND w.person = NEW.id
      AND EXISTS (SELECT 1 FROM json_each(w.events) e WHERE e.value = 'quota');
END;
