//! Lines of particles along one axis of a section's grid: even, on faces, or graded.
//!
//! Known are lengths only. What lies between the lines is the engine's; how many there are says what
//! a job takes.

/// A stretch of an axis with cells no larger than a size [mm].
#[derive(Debug, Clone, Copy)]
pub struct Fine {
    /// From and to [mm].
    pub between: [f64; 2],
    /// Largest cell in it [mm].
    pub size: f64,
}

impl Fine {
    /// What lies between two faces, with so many cells across.
    pub fn through([from, to]: [f64; 2], across: u32) -> Self {
        Self {
            between: [from, to],
            size: (to - from) / f64::from(across),
        }
    }

    /// The size it asks for at a distance from it.
    fn wanted(&self, at: f64) -> f64 {
        let outside = (self.between[0] - at).max(at - self.between[1]).max(0.0);
        self.size + (GROWTH - 1.0) * outside
    }
}

/// Places along one axis towards which cells shrink: corners at which strains grow without bound.
///
/// At a distance d from the nearest cells are h √(d / R) of the size h that they would have, R the
/// reach, down to h / 16: displacements that go as r^λ, λ some 0.7 beside a clamped face, are then followed
/// as well as smooth ones (second order, measured on clamped sections; even cells keep to the order
/// 2 λ). Source: [BabuskaKelloggPitkaranta1979].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Towards {
    /// Where [mm].
    pub places_mm: Vec<f64>,
    /// R [mm].
    pub reach_mm: f64,
}

/// The smallest share of a cell's size that is left at a corner.
const LEAST_SHARE: f64 = 1.0 / 16.0;
/// The reach of corners in the section's smaller side: 0.1 and 0.5 did no better for as many cells
/// (clamped sections of one material and with fibres).
const REACH: f64 = 0.25;

impl Towards {
    /// Corners of faces that are held along both axes with faces that are not, along x and along y.
    ///
    /// `held`: left, right, bottom, top.
    pub fn corners(sides_mm: [f64; 2], held: [bool; 4]) -> [Self; 2] {
        let mut found = [0, 1].map(|_| Self {
            places_mm: Vec::new(),
            reach_mm: REACH * sides_mm[0].min(sides_mm[1]),
        });
        for (i, x) in [0.0, sides_mm[0]].into_iter().enumerate() {
            for (j, y) in [0.0, sides_mm[1]].into_iter().enumerate() {
                // between two held faces nothing grows without bound, and between two free ones neither
                if held[i] != held[2 + j] {
                    for (towards, place) in found.iter_mut().zip([x, y]) {
                        if !towards.places_mm.contains(&place) {
                            towards.places_mm.push(place);
                        }
                    }
                }
            }
        }
        found
    }

    /// What is left of a cell's size at a place.
    fn share(&self, at: f64) -> f64 {
        let nearest = |share: f64, place: &f64| {
            let way = (at - place).abs() / self.reach_mm;
            // beyond the reach nothing is taken, and no root either
            if way >= 1.0 {
                share
            } else {
                share.min(way.sqrt().max(LEAST_SHARE))
            }
        };
        self.places_mm.iter().fold(1.0, nearest)
    }

    /// Whether cells shrink anywhere in a stretch.
    fn reach_into(&self, [from, to]: [f64; 2]) -> bool {
        let reach = self.reach_mm;
        let mut places = self.places_mm.iter();
        places.any(|place| from - reach < *place && *place < to + reach)
    }
}

/// How much larger a cell may be than its neighbour nearer to a fine stretch.
const GROWTH: f64 = 1.3;

/// Lines of so many equal cells along one axis.
pub fn even_lines(side: f64, cells: usize) -> Vec<f64> {
    let line = |line: usize| side * (line as f64) / (cells as f64);
    (0..=cells).map(line).collect()
}

/// So many cells along one axis, as equal as they can be with lines at all `faces`; `None` when there
/// are more intervals between faces than cells.
pub fn fitted_lines(side: f64, faces: &[f64], cells: usize) -> Option<Vec<f64>> {
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

/// Whether lines pass through all faces within the section.
pub fn pass_through(lines: &[f64], faces: &[f64]) -> bool {
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

/// Whether no line passes between two faces that lines pass through.
pub fn has_one_cell(lines: &[f64], [from, to]: [f64; 2]) -> bool {
    let slack = 1e-9 * lines[lines.len() - 1];
    let inside = lines.partition_point(|line| *line <= from + slack);
    lines.get(inside).is_none_or(|line| *line >= to - slack)
}

/// Lines along one axis: on both ends, on the ends of every fine stretch, and
/// between them cells that grow by at most [`GROWTH`] away from fine stretches up to `largest`, and
/// that shrink towards corners.
pub fn graded_lines(side: f64, fine: &[Fine], largest: f64, corners: &Towards) -> Vec<f64> {
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
        let ends = [wanted(pair[0]), wanted(pair[1])];
        let between = [pair[0], pair[1]];
        if corners.reach_into(between) {
            let limit = |at| within.min(largest * corners.share(at));
            fill(&mut lines, between, ends, limit);
        } else {
            fill(&mut lines, between, ends, |_| within);
        }
    }
    lines
}

/// Adds the lines after `from` up to and with `to`.
///
/// The wanted size at a distance d from an end is h + (g - 1) d, at most the `largest` there; lines
/// stand at equal steps of ∫ dx / size.
fn fill(
    lines: &mut Vec<f64>,
    [from, to]: [f64; 2],
    ends: [f64; 2],
    largest: impl Fn(f64) -> f64 + Copy,
) {
    const MOST_SAMPLES: f64 = 4_096.0;
    const LEAST_SAMPLES: f64 = 64.0;
    /// Of the integral, in the smallest cell.
    const IN_SMALLEST: f64 = 16.0;
    let length = to - from;
    let smallest = ends.into_iter().chain([from, to].map(largest));
    let smallest = smallest.fold(f64::INFINITY, f64::min);
    let samples = (IN_SMALLEST * length / smallest).ceil();
    let samples = samples.clamp(LEAST_SAMPLES, MOST_SAMPLES) as usize;
    let step = length / samples as f64;
    let size = |place: f64| {
        let rising = ends[0] + (GROWTH - 1.0) * place;
        let falling = ends[1] + (GROWTH - 1.0) * (length - place);
        rising.min(falling).min(largest(from + place))
    };
    let densities: Vec<f64> = (0..samples)
        .map(|sample| 1.0 / size((sample as f64 + 0.5) * step))
        .collect();
    let total: f64 = densities.iter().sum::<f64>() * step;
    // A share of a cell below round-off must not make a cell more.
    let cells = (total - 1e-9).ceil().max(1.0);
    let mut passed = 0.0;
    let mut next = 1.0;
    for (sample, density) in densities.iter().enumerate() {
        let gain = density * step * cells / total;
        while passed + gain >= next && next < cells {
            let share = (next - passed) / gain;
            lines.push(from + (sample as f64 + share) * step);
            next += 1.0;
        }
        passed += gain;
    }
    lines.push(to);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(lines: &[f64]) -> Vec<f64> {
        lines.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    #[test]
    fn cells_shrink_towards_the_corners_of_held_faces_with_free_ones() {
        let [x, y] = Towards::corners([8.0, 4.0], [true, false, false, false]);
        assert_eq!((x.places_mm, y.places_mm), (vec![0.0], vec![0.0, 4.0]));
        let [x, _] = Towards::corners([8.0, 4.0], [true, false, true, false]);
        assert_eq!(x.places_mm, [0.0, 8.0]);
        let none = Towards::corners([8.0, 4.0], [true; 4]);
        assert!(none.iter().all(|towards| towards.places_mm.is_empty()));
    }

    #[test]
    fn cells_that_shrink_go_with_the_root_of_the_distance() {
        let towards = Towards {
            places_mm: vec![0.0],
            reach_mm: 4.0,
        };
        let lines = graded_lines(8.0, &[], 1.0, &towards);
        // ∫ dx / √(x / 4) is 4 √x: 8 over the reach, less 1/4 beside the corner, where cells stay at 1/16
        // up to x = 1/64; and 4 cells of the full size. 11.75 make 12 cells
        assert_eq!(lines.len(), 13);
        for (n, line) in lines.iter().enumerate().take(8).skip(1) {
            let expected = ((n as f64 * 11.75 / 12.0 + 0.25) / 4.0).powi(2);
            assert!((line - expected).abs() < 1e-3, "{line} {expected}");
        }
        let after = &sizes(&lines)[8..];
        assert!(after.iter().all(|size| (size - 11.75 / 12.0).abs() < 1e-3));
    }
}
