-- Which attempt left a checkpoint: what comes from it once more, after a later one of the same attempt, is a
-- message that was under way for long, and must not be taken for the newest.
ALTER TABLE checkpoints ADD COLUMN attempt INTEGER;
