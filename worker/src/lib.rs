//! Claims and runs jobs.
