//! A table of numbers as a file.
use std::io::{self, Write};

use loadframe_harness::{Recorder, csv};

/// Gives rows, one after the other, to the recorder under these columns.
pub(super) fn write_table(
    recorder: &mut dyn Recorder,
    name: &str,
    columns: &[&str],
    rows: &[f64],
) -> io::Result<()> {
    recorder.file(name, &mut |out: &mut dyn Write| {
        csv::header(out, columns)?;
        let mut rows = rows.chunks_exact(columns.len());
        rows.try_for_each(|row| csv::row(out, row))
    })
}
