//! The points of a curve, kept beside the run in case it has no end that would write them.
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::path::Path;

use loadframe_physics::csv;
use tempfile::{SpooledTempFile, spooled_tempfile_in};

/// Bytes of points kept in memory: to make a file takes longer than most short jobs' curves.
const IN_MEMORY: usize = 1 << 16;

/// Points in memory, and if they are many in a file without a name, which is gone with the run.
#[derive(Debug)]
pub(crate) struct Spool {
    columns: Vec<String>,
    points: u64,
    file: BufWriter<SpooledTempFile>,
}

impl Spool {
    /// A curve that begins; its file, if it comes to need one, is in `folder`.
    pub(crate) fn begin(folder: &Path, columns: &[&str]) -> Self {
        Self {
            columns: columns.iter().map(|name| (*name).to_owned()).collect(),
            points: 0,
            file: BufWriter::new(spooled_tempfile_in(IN_MEMORY, folder)),
        }
    }

    pub(crate) fn point(&mut self, values: &[f64]) -> io::Result<()> {
        self.points += 1;
        let mut values = values.iter();
        values.try_for_each(|value| self.file.write_all(&value.to_le_bytes()))
    }

    /// Writes all points as a table.
    pub(crate) fn write(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.file.rewind()?;
        let names: Vec<&str> = self.columns.iter().map(String::as_str).collect();
        csv::header(out, &names)?;
        let mut input = BufReader::new(self.file.get_mut());
        let mut row = vec![0.0; names.len()];
        let mut bytes = [0; size_of::<f64>()];
        for _ in 0..self.points {
            for value in &mut row {
                input.read_exact(&mut bytes)?;
                *value = f64::from_le_bytes(bytes);
            }
            csv::row(out, &row)?;
        }
        Ok(())
    }
}
