//! What happens in each block of cycles.
use super::cycles::Cycle;

/// Cycles under one load. Displacements are downward from where the first block began.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    /// Numbers of its first and its last cycle, from 0.
    pub(super) cycles: [usize; 2],
    /// At its start, at its deepest, at its end [m].
    pub(super) start: f64,
    pub(super) peak: f64,
    pub(super) end: f64,
    /// Largest force [N].
    pub(super) peak_force: f64,
    /// Of its first and its last cycle [N/m], if enough of them is known.
    pub(super) unloading_stiffnesses: [Option<f64>; 2],
}

impl Block {
    pub(super) const COLUMNS: [&'static str; 10] = [
        "block",
        "first_cycle",
        "last_cycle",
        "start_displacement_mm",
        "peak_displacement_mm",
        "end_displacement_mm",
        "settlement_in_block_mm",
        "peak_force_kn",
        "first_unloading_stiffness_n_per_m",
        "last_unloading_stiffness_n_per_m",
    ];

    /// All blocks of a test.
    pub(super) fn of(cycles: &[Cycle]) -> Vec<Self> {
        let mut first = 0;
        let blocks = cycles.chunk_by(|one, next| one.block == next.block);
        let block = |cycles: &[Cycle]| {
            let numbers = [first, first + cycles.len() - 1];
            first += cycles.len();
            let ends = [&cycles[0], &cycles[cycles.len() - 1]];
            let largest = |value: fn(&Cycle) -> f64| {
                let values = cycles.iter().map(value);
                values.fold(f64::NEG_INFINITY, f64::max)
            };
            Self {
                cycles: numbers,
                start: ends[0].start,
                peak: largest(|cycle| cycle.peak),
                end: ends[1].end,
                peak_force: largest(|cycle| cycle.peak_force),
                unloading_stiffnesses: ends.map(|cycle| cycle.unloading_stiffness),
            }
        };
        blocks.map(block).collect()
    }

    pub(super) fn row(&self, number: usize) -> Vec<f64> {
        let [first, last] = self
            .unloading_stiffnesses
            .map(|slope| slope.unwrap_or(f64::NAN));
        vec![
            number as f64,
            (self.cycles[0] + 1) as f64,
            (self.cycles[1] + 1) as f64,
            1e3 * self.start,
            1e3 * self.peak,
            1e3 * self.end,
            1e3 * (self.end - self.start),
            1e-3 * self.peak_force,
            first,
            last,
        ]
    }
}
