//! Forces on the section, as forces on its particles.
//!
//! Spread forces are consistent with the cells: the work they do on any displacement that is linear
//! along a face is that of the spread force, part of a cell included.
use crate::error::{CompositeError, finite};
use crate::lattice::Lattice;
use crate::section::{corner_weights, within};
use crate::supports::Face;

/// A total force and where it acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Along x and y [N].
    pub force_n: [f64; 2],
    pub on: LoadPlace,
}

/// Where a load acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadPlace {
    /// Evenly along a face.
    Face(Face),
    /// Evenly along a part of a face.
    Patch {
        face: Face,
        from_mm: f64,
        to_mm: f64,
    },
    /// At a point.
    Point([f64; 2]),
    /// Evenly over the whole section.
    Body,
}

impl Load {
    /// Adds the load to the forces on the lattice's particles [N].
    ///
    /// # Errors
    /// When the force is not finite, or the place is outside the section.
    pub fn add_to(&self, lattice: &Lattice, forces: &mut [f64]) -> Result<(), CompositeError> {
        for force in self.force_n {
            finite("a load [N]", force)?;
        }
        let grid = lattice.grid();
        let mut push = |particle: usize, share: f64| {
            forces[2 * particle] += share * self.force_n[0];
            forces[2 * particle + 1] += share * self.force_n[1];
        };
        match self.on {
            LoadPlace::Face(face) => {
                let lines = face.lines_mm(grid);
                let side = lines[lines.len() - 1];
                for (line, share) in spread(lines, [0.0, side]) {
                    push(face.particle(grid, line), share);
                }
            }
            LoadPlace::Patch {
                face,
                from_mm,
                to_mm,
            } => {
                let lines = face.lines_mm(grid);
                let inside = |at: f64| {
                    within(lines, at).ok_or_else(|| {
                        let [x_mm, y_mm] = match face.along() {
                            0 => [at, grid.place_mm(face.particle(grid, 0))[1]],
                            _ => [grid.place_mm(face.particle(grid, 0))[0], at],
                        };
                        CompositeError::OutsideSection {
                            what: "an end of the loaded patch",
                            x_mm,
                            y_mm,
                        }
                    })
                };
                inside(from_mm)?;
                inside(to_mm)?;
                if to_mm <= from_mm {
                    return Err(CompositeError::OutOfRange {
                        quantity: "the length of the loaded patch [mm]",
                        given: to_mm - from_mm,
                        allowed: "above 0",
                    });
                }
                for (line, share) in spread(lines, [from_mm, to_mm]) {
                    push(face.particle(grid, line), share);
                }
            }
            LoadPlace::Point([x_mm, y_mm]) => {
                let (cell, place) =
                    grid.locate([x_mm, y_mm])
                        .ok_or(CompositeError::OutsideSection {
                            what: "the loaded point",
                            x_mm,
                            y_mm,
                        })?;
                for (particle, share) in grid.corners(cell).into_iter().zip(corner_weights(place)) {
                    push(particle, share);
                }
            }
            LoadPlace::Body => {
                let (columns, rows) = (grid.columns(), grid.rows());
                let area = grid.x_mm()[columns] * grid.y_mm()[rows];
                for cell in 0..grid.cells() {
                    let [a, b] = grid.sides_mm(cell);
                    for particle in grid.corners(cell) {
                        push(particle, 0.25 * a * b / area);
                    }
                }
            }
        }
        Ok(())
    }
}

/// The shares of lines in an even spread over a part of a face; they add up to 1.
///
/// Over the part s₀..s₁ of an interval the force's moment about its ends splits it: the mean share
/// of the way, (s₀ + s₁)/2, goes to the far end.
fn spread(lines: &[f64], [from, to]: [f64; 2]) -> Vec<(usize, f64)> {
    let mut shares = Vec::new();
    for (place, pair) in lines.windows(2).enumerate() {
        let (start, end) = (pair[0].max(from), pair[1].min(to));
        if end <= start {
            continue;
        }
        let length = pair[1] - pair[0];
        let middle = (0.5 * (start + end) - pair[0]) / length;
        let share = (end - start) / (to - from);
        shares.push((place, share * (1.0 - middle)));
        shares.push((place + 1, share * middle));
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_force_keeps_its_sum_and_its_moment() {
        let lines = [0.0, 1.0, 1.5, 4.0, 7.0];
        for part in [[0.0, 7.0], [0.25, 0.75], [0.5, 6.0], [1.5, 4.0]] {
            let shares = spread(&lines, part);
            let sum: f64 = shares.iter().map(|(_, share)| share).sum();
            let moment: f64 = shares
                .iter()
                .map(|(line, share)| lines[*line] * share)
                .sum();
            assert!((sum - 1.0).abs() < 1e-14);
            assert!((moment - 0.5 * (part[0] + part[1])).abs() < 1e-14);
        }
    }
}
