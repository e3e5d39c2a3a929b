//! How fine a test is, and other grids to compare it with.
use loadframe_api::spec::composite_bending::Grid;

use crate::section::Fit;

/// How fine a model is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fineness {
    pub(super) grid: Grid,
    /// Cells through half the width of a roller's contact, in a graded grid.
    pub(super) contact_cells: usize,
    /// Whether the cells of a graded grid shrink towards the corners of what is held.
    pub(super) shrinks_to_corners: bool,
}

/// The grids to compare with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    /// Half and a quarter of the cells: what converges is followed to its limit.
    Coarser {
        /// Faces of slanted fibres cut the cells of every grid in another way, so that results come
        /// and go on their way to the limit. Three grids may agree by chance; an eighth of the cells
        /// tells then how far results still moved before.
        wanders: bool,
    },
    /// None: the paper's lattice has fibres as thick as its cells, whatever they are, and no limit.
    None,
    /// The cells are cut by faces that other grids cut elsewhere: results on them have no common way
    /// to the limit. Or they agree on what none of them sees, a gap of one cell. A graded grid of as many cells, with lines on the faces, stands for the truth,
    /// and one of half of them tells its own error.
    Graded,
}

impl Comparison {
    /// How the errors of a lattice's grid are found.
    pub(super) fn of(fit: Fit, half_fit: Fit, is_paper: bool) -> Self {
        // half of the cells may be too few to follow the faces that all of them do
        let fit = if half_fit == Fit::Cut { half_fit } else { fit };
        match fit {
            _ if is_paper => Self::None,
            Fit::Exact => Self::Coarser { wanders: false },
            Fit::Slanted => Self::Coarser { wanders: true },
            Fit::Cut | Fit::OneCell => Self::Graded,
        }
    }

    /// The other grids: half, a quarter and where results wander an eighth of the cells along both sides
    /// and in contacts, as far as there are cells, or graded ones.
    pub(super) fn grids(self, finest: Fineness) -> Vec<Fineness> {
        match self {
            Self::None => Vec::new(),
            Self::Coarser { wanders } => {
                let coarser = std::iter::successors(halved(finest), |finer| halved(*finer));
                coarser.take(if wanders { 3 } else { 2 }).collect()
            }
            Self::Graded => {
                let graded = Fineness {
                    grid: Grid {
                        equal_cells: false,
                        graded_cells_per_fibre: Some(2),
                        ..finest.grid
                    },
                    ..finest
                };
                [graded].into_iter().chain(halved(graded)).collect()
            }
        }
    }
}

/// Half of the cells along both sides, in fibres and in contacts; `None` where there is one only.
pub(super) fn halved(finer: Fineness) -> Option<Fineness> {
    let grid = finer.grid;
    let has_half = grid.cells.iter().all(|count| *count > 1);
    has_half.then(|| Fineness {
        grid: Grid {
            cells: grid.cells.map(|count| count.div_ceil(2)),
            graded_cells_per_fibre: grid.graded_cells_per_fibre.map(|count| count.div_ceil(2)),
            ..grid
        },
        contact_cells: finer.contact_cells.div_ceil(2),
        ..finer
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fineness(cells: [u32; 2]) -> Fineness {
        Fineness {
            grid: Grid {
                cells,
                equal_cells: false,
                graded_cells_per_fibre: Some(2),
            },
            contact_cells: 4,
            shrinks_to_corners: false,
        }
    }

    #[test]
    fn coarser_grids_have_half_the_cells() {
        let steady = Comparison::Coarser { wanders: false };
        let all = steady.grids(fineness([9, 3]));
        let cells: Vec<_> = all.iter().map(|one| one.grid.cells).collect();
        assert_eq!(cells, [[5, 2], [3, 1]]);
        assert_eq!(all[1].grid.graded_cells_per_fibre, Some(1));
        assert_eq!(all[1].contact_cells, 1);
        assert!(steady.grids(fineness([4, 1])).is_empty());
        let wandering = Comparison::Coarser { wanders: true };
        let all = wandering.grids(fineness([200, 100]));
        let cells: Vec<_> = all.iter().map(|one| one.grid.cells).collect();
        assert_eq!(cells, [[100, 50], [50, 25], [25, 13]]);
    }
}
