//! Where in its cycles a test is.
use loadframe_api::spec::ballast::{Course, Load};

/// A hair of a cycle that round-off may take.
const HAIR: f64 = 1e-9;

/// Where a row is in the cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    /// Number of the block and of the cycle, from 0.
    pub(super) block: usize,
    pub(super) cycle: usize,
    /// Whether the load goes back.
    pub(super) is_unloading: bool,
}

/// The place of a time [s] after a stage of the load began. The end of a cycle belongs to it.
pub(super) fn place(load: &Load, time: f64) -> Place {
    let (number, is_unloading) = match load.course {
        Course::Swing { period, cycles } => {
            let passed = time / period;
            // the last step may go a little beyond the end
            let last = f64::from(cycles) - 1.0;
            let number = (passed - HAIR).floor().clamp(0.0, last);
            (number as usize, passed - number > 0.5)
        }
        Course::Down { .. } => (0, false),
        Course::Up => (0, true),
    };
    Place {
        block: load.block,
        cycle: load.cycle + number,
        is_unloading,
    }
}
