//! How many events a second: prints, for the table in the room's docs.
