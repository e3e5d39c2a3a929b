-- How many points of the curve came before a checkpoint: whoever goes on from it finds them here and does not
-- send them again. Of older checkpoints nobody knows.
ALTER TABLE checkpoints ADD COLUMN points INTEGER NOT NULL DEFAULT 0;
