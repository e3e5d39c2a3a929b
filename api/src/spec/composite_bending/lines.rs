//! Lines of particles of a spec's grid, as far as the spec alone tells them.
use super::rollers::beneath_rollers;
use super::{CompositeBending, Grid, Grips, Lattice, Solver, Support, Way};
use crate::section::fibre::{Band, Fibre, fine_at_ends, gaps_beside_ends};
use crate::section::lines::{
    Fine, Towards, even_lines, fitted_lines, graded_lines, has_one_cell, pass_through,
};
use crate::section::solving::stretch;

/// Lines are not laid through the faces of more fibres and plies than these, only to count particles.
const MOST_COUNTED: usize = 500;

/// Cells of the largest grid whose cells shrink towards corners: some 2.3 times as many are then left
/// below what is solved by a factor.
const MOST_SHRUNK: u64 = 400_000;

impl CompositeBending {
    /// Whether the cells of a graded grid shrink towards corners at which strains grow without bound:
    /// of tests that solve the equations of equilibrium.
    ///
    /// Small cells cost motion small time steps, and a corner's stress, which follows the size of its
    /// cells, must not say when something breaks. Grids of very many cells are fine enough everywhere,
    /// and conjugate gradients, which solve the largest, take far longer for stretched cells.
    pub fn shrinks_to_corners(&self) -> bool {
        let is_static = self.accuracy.knobs().solver == Solver::Static;
        let [columns, rows] = self.grid().cells.map(u64::from);
        let is_moderate = columns * rows <= MOST_SHRUNK;
        is_static && is_moderate && self.test.history.is_none() && self.test.breaking.is_none()
    }

    /// Corners of faces that are held along both axes with faces that are not, along x and along y.
    pub fn held_corners(&self) -> [Towards; 2] {
        let held = match self.test.way() {
            Some(Way::Held(supports)) => [
                &supports.left,
                &supports.right,
                &supports.bottom,
                &supports.top,
            ]
            .map(Support::holds_both_axes),
            Some(Way::Tension(tension)) if tension.grips == Grips::Clamped => {
                [true, true, false, false]
            }
            _ => [false; 4],
        };
        Towards::corners(self.sides_mm(), held)
    }

    fn sides_mm(&self) -> [f64; 2] {
        [self.section.length_mm, self.section.height_mm]
    }

    /// Particles of the lattice, those of a graded grid as far as they can be foreseen: what rollers add is
    /// about that of a beam on them, and of very many fibres or plies there are those of even cells.
    pub fn particles(&self) -> u64 {
        self.laid_on(self.grid()).particles
    }

    /// The grid and the others on which the same test is done to know its error, as far as they can be
    /// foreseen.
    pub(super) fn laid(&self) -> Vec<Laid> {
        let grid = self.grid();
        let first = self.laid_on(grid);
        if matches!(self.lattice, Lattice::Paper(_)) {
            // with the exact lattice beside it
            return vec![first, first];
        }
        let half = Grid {
            cells: grid.cells.map(|count| count.div_ceil(2)),
            ..grid
        };
        if self.is_cut(grid) || self.is_cut(half) || self.has_one_cell_beside_ends(grid) {
            // a graded grid stands for the truth there
            let graded = self.laid_on(Grid {
                equal_cells: false,
                graded_cells_per_fibre: Some(2),
                ..grid
            });
            return vec![first, graded, graded.halved()];
        }
        vec![first, first.halved(), first.halved().halved()]
    }

    fn laid_on(&self, grid: Grid) -> Laid {
        let lines = self.lines_mm(grid);
        let sides = lines.iter().flat_map(|lines| lines.windows(2));
        Laid {
            particles: lines.iter().map(|lines| lines.len() as u64).product(),
            smallest_mm: sides
                .map(|pair| pair[1] - pair[0])
                .fold(f64::INFINITY, f64::min),
            is_graded: grid.graded_cells_per_fibre.is_some(),
            stretch: stretch([&lines[0], &lines[1]]),
        }
    }

    /// Whether faces along an axis cut cells of a grid.
    fn is_cut(&self, grid: Grid) -> bool {
        if grid.graded_cells_per_fibre.is_some() {
            return false;
        }
        let lines = self.lines_mm(grid);
        let mut both = self.fine(1).into_iter().zip(lines);
        self.is_counted()
            && both.any(|(fine, lines)| {
                let faces: Vec<f64> = fine.iter().flat_map(|fine| fine.between).collect();
                !pass_through(&lines, &faces)
            })
    }

    /// Whether a narrow gap beside a fibre that ends is one cell wide.
    fn has_one_cell_beside_ends(&self, grid: Grid) -> bool {
        if !self.is_counted() {
            return false;
        }
        let (bands, sides) = (self.bands(), self.sides_mm());
        let is_slanted = bands.iter().any(Band::is_slanted);
        let mut both = self.lines_mm(grid).into_iter().enumerate();
        !is_slanted
            && both.any(|(axis, lines)| {
                let gaps = gaps_beside_ends(&bands, axis, sides);
                gaps.iter().any(|gap| has_one_cell(&lines, *gap))
            })
    }

    /// Whether there are few enough fibres and plies to lay lines through their faces.
    fn is_counted(&self) -> bool {
        self.fibres.len() + self.plies.len() <= MOST_COUNTED
    }

    /// Lines of particles along x and along y [mm].
    fn lines_mm(&self, grid: Grid) -> [Vec<f64>; 2] {
        let sides = self.sides_mm();
        let even = |axis: usize| even_lines(sides[axis], grid.cells[axis] as usize);
        let keeps = grid.equal_cells || matches!(self.lattice, Lattice::Paper(_));
        if keeps || !self.is_counted() {
            return [0, 1].map(even);
        }
        let across = grid.graded_cells_per_fibre;
        let fine = self.fine(across.unwrap_or(1));
        if across.is_some() {
            let corners = if self.shrinks_to_corners() {
                self.held_corners()
            } else {
                Default::default()
            };
            let beneath = beneath_rollers(self);
            let fine = [0, 1].map(|axis| [&fine[axis][..], &beneath[axis]].concat());
            return [0, 1].map(|axis| {
                let largest = sides[axis] / f64::from(grid.cells[axis]);
                graded_lines(sides[axis], &fine[axis], largest, &corners[axis])
            });
        }
        [0, 1].map(|axis| {
            let faces: Vec<f64> = fine[axis].iter().flat_map(|fine| fine.between).collect();
            let even = even(axis);
            if pass_through(&even, &faces) {
                return even;
            }
            let fitted = fitted_lines(sides[axis], &faces, grid.cells[axis] as usize);
            fitted.unwrap_or(even)
        })
    }

    /// The fibres that lie in the section.
    fn bands(&self) -> Vec<Band> {
        let sides = self.sides_mm();
        let mut bands = Vec::with_capacity(self.fibres.len());
        for (place, fibre) in self.fibres.iter().enumerate() {
            let fibre = Fibre {
                material: 0,
                through_mm: fibre.through_mm,
                angle_deg: fibre.angle_deg,
                thickness_mm: fibre.thickness_mm,
                length_mm: fibre.length_mm,
            };
            // what is outside is told of elsewhere
            if let Ok(band) = Band::new(place, &fibre, sides) {
                bands.push(band);
            }
        }
        bands
    }

    /// What fibres with their ends and plies ask of both axes, with so many cells across each.
    fn fine(&self, across: u32) -> [Vec<Fine>; 2] {
        let (bands, sides) = (self.bands(), self.sides_mm());
        let mut fine = [Vec::new(), Vec::new()];
        for (axis, fine) in fine.iter_mut().enumerate() {
            let through = bands.iter();
            fine.extend(through.filter_map(|band| band.fine_across(axis, across)));
            fine.extend(fine_at_ends(&bands, axis, sides, across));
        }
        let mut below = 0.0;
        for ply in &self.plies {
            let above = below + ply.thickness_mm;
            fine[1].push(Fine::through([below, above], across));
            below = above;
        }
        fine
    }
}

/// What of a grid decides how long a test on it takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laid {
    pub(super) particles: u64,
    /// The smallest side of a cell [mm].
    pub(super) smallest_mm: f64,
    pub(super) is_graded: bool,
    /// Of its cells, see [`stretch`].
    pub(super) stretch: f64,
}

impl Laid {
    /// With half of the cells along both sides.
    fn halved(self) -> Self {
        Self {
            particles: (self.particles / 4).max(4),
            smallest_mm: 2.0 * self.smallest_mm,
            ..self
        }
    }
}
