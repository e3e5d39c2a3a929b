//! Pairs of fibres that lie near one another.
use crate::sheet::SheetFibre;

use super::bounds::{Aligned, Bound as _};

/// Fibres in the square cells of a grid, each in all cells that its box meets.
#[derive(Debug)]
pub(super) struct Candidates {
    boxes: Vec<Aligned>,
    cell_um: f64,
    origin: [f64; 2],
    size: [usize; 2],
    /// First entry of each cell, and one more.
    starts: Vec<usize>,
    /// Fibres of each cell, in their order.
    entries: Vec<u32>,
}

impl Candidates {
    pub(super) fn new(fibres: &[SheetFibre], gap_um: f64) -> Self {
        let boxes: Vec<Aligned> = fibres
            .iter()
            .map(|fibre| Aligned::around(&fibre.centre_line_um, fibre.section, gap_um))
            .collect();
        let mut lower = [f64::INFINITY; 2];
        let mut upper = [f64::NEG_INFINITY; 2];
        let mut extents = 0.0;
        for bound in &boxes {
            for axis in 0..2 {
                lower[axis] = lower[axis].min(bound.lower[axis]);
                upper[axis] = upper[axis].max(bound.upper[axis]);
                extents += 0.5 * (bound.upper[axis] - bound.lower[axis]);
            }
        }
        // cells as large as a mean box: a fibre then lies in about four
        let mean = extents / boxes.len().max(1) as f64;
        let sides = [0, 1].map(|axis| (upper[axis] - lower[axis]).max(0.0));
        // no more cells than fibres, were one of them a needle in an empty sheet
        let fewest = (sides[0] * sides[1] / boxes.len().max(1) as f64).sqrt();
        let cell_um = mean.max(fewest).max(f64::MIN_POSITIVE);
        let size = sides.map(|side| (side / cell_um) as usize + 1);
        let mut grid = Self {
            boxes,
            cell_um,
            origin: lower,
            size,
            starts: vec![0; size[0] * size[1] + 1],
            entries: Vec::new(),
        };
        grid.fill();
        grid
    }

    fn fill(&mut self) {
        let mut starts = std::mem::take(&mut self.starts);
        for bound in &self.boxes {
            for cell in self.cells(bound) {
                starts[cell + 1] += 1;
            }
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![0; starts[starts.len() - 1]];
        for (fibre, bound) in self.boxes.iter().enumerate() {
            for cell in self.cells(bound) {
                entries[next[cell]] = fibre as u32;
                next[cell] += 1;
            }
        }
        (self.starts, self.entries) = (starts, entries);
    }

    fn index(&self, place: f64, axis: usize) -> usize {
        (((place - self.origin[axis]) / self.cell_um) as usize).min(self.size[axis] - 1)
    }

    fn cells(&self, bound: &Aligned) -> impl Iterator<Item = usize> + use<> {
        let columns = self.size[0];
        let [x, y] = [0, 1]
            .map(|axis| self.index(bound.lower[axis], axis)..=self.index(bound.upper[axis], axis));
        y.flat_map(move |row| x.clone().map(move |column| row * columns + column))
    }

    /// Fibres of higher number whose box meets that of `fibre`, in their order.
    pub(super) fn of(&self, fibre: usize, others: &mut Vec<u32>) {
        others.clear();
        let bound = &self.boxes[fibre];
        for cell in self.cells(bound) {
            let entries = &self.entries[self.starts[cell]..self.starts[cell + 1]];
            let behind = entries.partition_point(|other| *other as usize <= fibre);
            for &other in &entries[behind..] {
                let its = &self.boxes[other as usize];
                // two boxes may share several cells: the one with the corner of what they share counts
                let [x, y] =
                    [0, 1].map(|axis| self.index(bound.lower[axis].max(its.lower[axis]), axis));
                if y * self.size[0] + x == cell && bound.meets(its) {
                    others.push(other);
                }
            }
        }
        others.sort_unstable();
    }
}
