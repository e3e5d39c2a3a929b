-- The attempt that made a checkpoint, and how many points of its curve came before it: whoever goes on from
-- the checkpoint gets them from here and does not send them again. Older checkpoints name none.
ALTER TABLE checkpoints ADD COLUMN attempt INTEGER;
ALTER TABLE checkpoints ADD COLUMN points INTEGER NOT NULL DEFAULT 0;
