//! What is kept of the curves of repeats.
use std::io;

use loadframe_harness::{Recorder, csv, plan::Curve};

/// The curves of all repeats in one direction.
pub(super) fn write_curves<'a>(
    name: &str,
    curves: impl Iterator<Item = &'a Curve> + Clone,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    recorder.file(name, &mut |out| {
        csv::header(out, &["repeat", "nominal_strain", "force_n"])?;
        for (index, curve) in curves.clone().enumerate() {
            for point in curve.rows() {
                let mut row = vec![(index + 1) as f64];
                row.extend(point);
                csv::row(out, &row)?;
            }
        }
        Ok(())
    })
}
