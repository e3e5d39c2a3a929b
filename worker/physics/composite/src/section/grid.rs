//! Where the particles stand: lines of a rectangular grid, even or graded.
use crate::error::{CompositeError, finite, positive};

/// How the section is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Division {
    /// So many equal cells along x and along y.
    Uniform { cells: [usize; 2] },
    /// So many cells along x and along y, as equal as they can be with particle lines on the faces of
    /// every ply and of every fibre along an axis; along an axis with too few cells for that, equal.
    Fitted { cells: [usize; 2] },
    /// Particle lines on the faces of every ply and of every fibre along an axis, and cells no
    /// larger than a uniform division would have; in a fibre and a ply as small as `across` cells
    /// through it, growing away from it.
    Graded { cells: [usize; 2], across: usize },
}

/// A place around which a graded division is finer: where a roller presses, say.
///
/// Cells within `half_width_mm` of it along either axis are no larger than `cell_mm`, and grow away
/// from there. A particle line passes through the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refinement {
    pub at_mm: [f64; 2],
    pub half_width_mm: f64,
    pub cell_mm: f64,
}

impl Refinement {
    pub(crate) fn checked(&self) -> Result<(), CompositeError> {
        for at in self.at_mm {
            finite("a refined place [mm]", at)?;
        }
        positive("the half width of a refined place [mm]", self.half_width_mm)?;
        positive("the size of cells at a refined place [mm]", self.cell_mm)?;
        Ok(())
    }

    /// The stretches on either side of the place.
    pub(crate) fn fine(&self, axis: usize) -> [Fine; 2] {
        let at = self.at_mm[axis];
        [[at - self.half_width_mm, at], [at, at + self.half_width_mm]].map(|between| Fine {
            between,
            size: self.cell_mm,
        })
    }
}

/// A stretch of an axis with cells no larger than a size [mm].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fine {
    pub(crate) between: [f64; 2],
    pub(crate) size: f64,
}

impl Fine {
    /// The size it asks for at a distance from it.
    fn wanted(&self, at: f64) -> f64 {
        let outside = (self.between[0] - at).max(at - self.between[1]).max(0.0);
        self.size + (GROWTH - 1.0) * outside
    }
}

/// Lines of particles along both axes [mm], from 0 to the section's sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    x_mm: Vec<f64>,
    y_mm: Vec<f64>,
}

/// How much larger a cell may be than its neighbour nearer to a fine stretch.
const GROWTH: f64 = 1.3;

impl Grid {
    /// Equal cells.
    #[must_use]
    pub fn uniform([length_mm, height_mm]: [f64; 2], [columns, rows]: [usize; 2]) -> Self {
        let lines = |side: f64, cells: usize| {
            (0..=cells)
                .map(|line| side * (line as f64) / (cells as f64))
                .collect()
        };
        Self {
            x_mm: lines(length_mm, columns),
            y_mm: lines(height_mm, rows),
        }
    }

    /// Cells between given lines [mm].
    ///
    /// # Errors
    /// When there are fewer than two lines along an axis, or they do not increase.
    pub fn of_lines(x_mm: Vec<f64>, y_mm: Vec<f64>) -> Result<Self, CompositeError> {
        for lines in [&x_mm, &y_mm] {
            if lines.len() < 2 || lines.iter().any(|line| !line.is_finite()) {
                return Err(CompositeError::OutOfRange {
                    quantity: "the number of grid lines along an axis",
                    given: lines.len() as f64,
                    allowed: "at least 2, all finite",
                });
            }
            if let Some(pair) = lines.windows(2).find(|pair| pair[1] <= pair[0]) {
                return Err(CompositeError::OutOfRange {
                    quantity: "the distance between neighbouring grid lines [mm]",
                    given: pair[1] - pair[0],
                    allowed: "above 0",
                });
            }
        }
        Ok(Self { x_mm, y_mm })
    }

    /// Lines of particles along x [mm].
    #[must_use]
    pub fn x_mm(&self) -> &[f64] {
        &self.x_mm
    }

    /// Lines of particles along y [mm].
    #[must_use]
    pub fn y_mm(&self) -> &[f64] {
        &self.y_mm
    }

    /// Cells along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.x_mm.len() - 1
    }

    /// Cells along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.y_mm.len() - 1
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.columns() * self.rows()
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.x_mm.len() * self.y_mm.len()
    }

    /// Number of the particle on line `i` along x and line `j` along y.
    #[must_use]
    pub fn particle(&self, i: usize, j: usize) -> usize {
        j * self.x_mm.len() + i
    }

    /// Place of a particle [mm].
    #[must_use]
    pub fn place_mm(&self, particle: usize) -> [f64; 2] {
        let per_row = self.x_mm.len();
        [self.x_mm[particle % per_row], self.y_mm[particle / per_row]]
    }

    /// The particles at a cell's corners, counterclockwise from the lower left.
    #[must_use]
    pub fn corners(&self, cell: usize) -> [usize; 4] {
        let (i, j) = (cell % self.columns(), cell / self.columns());
        let lower = self.particle(i, j);
        let upper = lower + self.x_mm.len();
        [lower, lower + 1, upper + 1, upper]
    }

    /// Width and height of a cell [mm].
    #[must_use]
    pub fn sides_mm(&self, cell: usize) -> [f64; 2] {
        let (i, j) = (cell % self.columns(), cell / self.columns());
        [
            self.x_mm[i + 1] - self.x_mm[i],
            self.y_mm[j + 1] - self.y_mm[j],
        ]
    }

    /// Middle of a cell [mm].
    #[must_use]
    pub fn middle_mm(&self, cell: usize) -> [f64; 2] {
        let (i, j) = (cell % self.columns(), cell / self.columns());
        [
            0.5 * (self.x_mm[i + 1] + self.x_mm[i]),
            0.5 * (self.y_mm[j + 1] + self.y_mm[j]),
        ]
    }

    /// The cell a point lies in, and where in it (0..1 along both sides); `None` outside.
    #[must_use]
    pub fn locate(&self, [x, y]: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let (i, along) = within(&self.x_mm, x)?;
        let (j, up) = within(&self.y_mm, y)?;
        Some((j * self.columns() + i, [along, up]))
    }
}

/// So many cells along one axis, as equal as they can be with lines at all `faces`; `None` when there
/// are more intervals between faces than cells.
pub(crate) fn fitted_lines(side: f64, faces: &[f64], cells: usize) -> Option<Vec<f64>> {
    let stations = stations(side, faces.iter().copied());
    let lengths: Vec<f64> = stations.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if lengths.len() > cells {
        return None;
    }
    let mut counts = vec![1_usize; lengths.len()];
    for _ in lengths.len()..cells {
        // one more where cells are longest; of equals the first
        let mut longest = 0;
        for place in 1..lengths.len() {
            let size = |place: usize| lengths[place] / counts[place] as f64;
            if size(place) > size(longest) * (1.0 + 1e-12) {
                longest = place;
            }
        }
        counts[longest] += 1;
    }
    let mut lines = vec![0.0];
    for (place, count) in counts.iter().enumerate() {
        let from = stations[place];
        for line in 1..*count {
            lines.push(from + lengths[place] * line as f64 / *count as f64);
        }
        lines.push(stations[place + 1]);
    }
    Some(lines)
}

/// Places along an axis in ascending order, each once, with both ends.
fn stations(side: f64, faces: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut stations: Vec<f64> = faces
        .map(|face| face.clamp(0.0, side))
        .chain([0.0, side])
        .collect();
    stations.sort_by(f64::total_cmp);
    stations.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * side);
    // of the end and a face beside it the end stays
    if let Some(last) = stations.last_mut() {
        *last = side;
    }
    stations
}

/// A thin row's height over that of the row it is cut from.
const THIN: f64 = 0.1;

/// Lines with another one closely above each that lies on one of these faces.
pub(crate) fn with_thin_rows(lines: &[f64], faces: &[f64]) -> Vec<f64> {
    let side = lines[lines.len() - 1];
    let mut all = Vec::with_capacity(lines.len() + faces.len());
    for pair in lines.windows(2) {
        all.push(pair[0]);
        if faces
            .iter()
            .any(|face| (pair[0] - face).abs() < 1e-9 * side)
        {
            all.push(pair[0] + THIN * (pair[1] - pair[0]));
        }
    }
    all.push(side);
    all
}

/// Whether lines pass through all faces within the section.
pub(crate) fn pass_through(lines: &[f64], faces: &[f64]) -> bool {
    let side = lines[lines.len() - 1];
    faces.iter().all(|face| {
        let after = lines.partition_point(|line| line < face);
        let near = |place: usize| {
            lines
                .get(place)
                .is_some_and(|line| (line - face).abs() < 1e-9 * side)
        };
        *face <= 0.0 || *face >= side || near(after) || (after > 0 && near(after - 1))
    })
}

/// Weights of a cell's four corners at a place inside it (0..1 along both sides).
pub(crate) fn corner_weights([a, b]: [f64; 2]) -> [f64; 4] {
    [(1.0 - a) * (1.0 - b), a * (1.0 - b), a * b, (1.0 - a) * b]
}

/// The interval between lines that holds a coordinate, and the share of the way through it.
pub(crate) fn within(lines: &[f64], coordinate: f64) -> Option<(usize, f64)> {
    let (first, last) = (*lines.first()?, *lines.last()?);
    // A point on an edge, written in decimals, may miss it by round-off.
    let slack = 1e-12 * (last - first);
    if !(coordinate >= first - slack && coordinate <= last + slack) {
        return None;
    }
    let after = lines.partition_point(|&line| line <= coordinate);
    let interval = after.clamp(1, lines.len() - 1) - 1;
    let share = (coordinate - lines[interval]) / (lines[interval + 1] - lines[interval]);
    Some((interval, share.clamp(0.0, 1.0)))
}

/// Lines along one axis: on both ends, on the ends of every fine stretch, and
/// between them cells that grow by at most [`GROWTH`] away from fine stretches up to `largest`.
pub(crate) fn graded_lines(side: f64, fine: &[Fine], largest: f64) -> Vec<f64> {
    let stations = stations(side, fine.iter().flat_map(|stretch| stretch.between));
    let wanted = |station: f64| {
        fine.iter()
            .map(|stretch| stretch.wanted(station))
            .fold(largest, f64::min)
    };
    let mut lines = vec![0.0];
    for pair in stations.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        let within = fine
            .iter()
            .filter(|stretch| stretch.between[0] <= middle && middle <= stretch.between[1])
            .map(|stretch| stretch.size)
            .fold(largest, f64::min);
        fill(
            &mut lines,
            pair[0],
            pair[1],
            [wanted(pair[0]), wanted(pair[1])],
            within,
        );
    }
    lines
}

/// Adds the lines after `from` up to and with `to`.
///
/// The wanted size at a distance d from an end is h + (g - 1) d, at most `largest`; lines stand at
/// equal steps of ∫ dx / size.
fn fill(lines: &mut Vec<f64>, from: f64, to: f64, ends: [f64; 2], largest: f64) {
    const SAMPLES: usize = 4_096;
    let length = to - from;
    let step = length / SAMPLES as f64;
    let size = |place: f64| {
        let rising = ends[0] + (GROWTH - 1.0) * place;
        let falling = ends[1] + (GROWTH - 1.0) * (length - place);
        rising.min(falling).min(largest)
    };
    let density = |sample: usize| 1.0 / size((sample as f64 + 0.5) * step);
    let total: f64 = (0..SAMPLES).map(density).sum::<f64>() * step;
    // A share of a cell below round-off must not make a cell more.
    let cells = (total - 1e-9).ceil().max(1.0);
    let mut passed = 0.0;
    let mut next = 1.0;
    for sample in 0..SAMPLES {
        let gain = density(sample) * step * cells / total;
        while passed + gain >= next && next < cells {
            let share = (next - passed) / gain;
            lines.push(from + (sample as f64 + share) * step);
            next += 1.0;
        }
        passed += gain;
    }
    lines.push(to);
}
