//! The order in which particles are eliminated: nested dissection of the grid.
//!
//! A rectangle of particles is cut by a line of particles across its longer side; what is on either
//! side comes first, the line last. On grids this keeps the factor as small as is known
//! ([George1973]), needs no graph, and does not depend on anything but the grid's size.

/// Rectangles of at most so many particles are not cut further.
const SMALLEST: usize = 12;

/// All particles in order of elimination.
pub(crate) fn nested_dissection(per_row: usize, rows: usize) -> Vec<u32> {
    let mut order = Vec::with_capacity(per_row * rows);
    dissect(per_row, [0, per_row], [0, rows], &mut order);
    order
}

fn dissect(per_row: usize, x: [usize; 2], y: [usize; 2], order: &mut Vec<u32>) {
    let (width, height) = (x[1] - x[0], y[1] - y[0]);
    if width * height <= SMALLEST || width.max(height) < 3 {
        for j in y[0]..y[1] {
            order.extend((x[0]..x[1]).map(|i| (j * per_row + i) as u32));
        }
    } else if width >= height {
        let line = x[0] + width / 2;
        dissect(per_row, [x[0], line], y, order);
        dissect(per_row, [line + 1, x[1]], y, order);
        order.extend((y[0]..y[1]).map(|j| (j * per_row + line) as u32));
    } else {
        let line = y[0] + height / 2;
        dissect(per_row, x, [y[0], line], order);
        dissect(per_row, x, [line + 1, y[1]], order);
        order.extend((x[0]..x[1]).map(|i| (line * per_row + i) as u32));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_particle_has_one_place() {
        for (per_row, rows) in [(2, 2), (2, 40), (17, 9), (64, 3)] {
            let mut order = nested_dissection(per_row, rows);
            order.sort_unstable();
            let all: Vec<u32> = (0..(per_row * rows) as u32).collect();
            assert_eq!(order, all);
        }
    }
}
