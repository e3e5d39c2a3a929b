//! Fibres: bands through a point at an angle.
use crate::section::error::{CompositeError, finite, positive};
use crate::section::lines::Fine;
use crate::section::polygon::Polygon;
use crate::section::stiffness::direction;

/// A fibre: a straight band through a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fibre {
    /// Which of the section's materials it is of.
    pub material: usize,
    /// A point on its axis, the middle of it when it has a length [mm].
    pub through_mm: [f64; 2],
    /// Angle of its axis to x [°].
    pub angle_deg: f64,
    /// Thickness across the axis [mm].
    pub thickness_mm: f64,
    /// Length along the axis [mm]; `None`: from edge to edge of the section.
    pub length_mm: Option<f64>,
}

/// A fibre made ready for measuring: its band as a polygon, its axis as cosine and sine.
#[derive(Debug, Clone, Copy)]
pub struct Band {
    pub material: usize,
    pub angle_deg: f64,
    pub axis: [f64; 2],
    pub through_mm: [f64; 2],
    pub half_thickness_mm: f64,
    pub half_length_mm: f64,
    polygon: Polygon,
}

impl Band {
    /// Makes fibre number `place` of a section of the given sides ready.
    pub fn new(
        place: usize,
        fibre: &Fibre,
        [length_mm, height_mm]: [f64; 2],
    ) -> Result<Self, CompositeError> {
        positive("a fibre's thickness [mm]", fibre.thickness_mm)?;
        finite("a fibre's angle [°]", fibre.angle_deg)?;
        let [x, y] = fibre.through_mm;
        finite("x of a fibre's point [mm]", x)?;
        finite("y of a fibre's point [mm]", y)?;
        // Long enough to leave the section whatever the angle.
        let reach = length_mm + height_mm + x.abs() + y.abs();
        let half_length_mm = match fibre.length_mm {
            Some(length) => positive("a fibre's length [mm]", length)? / 2.0,
            None => reach,
        };
        let axis = direction(fibre.angle_deg);
        let half_thickness_mm = fibre.thickness_mm / 2.0;
        let section = Polygon::rectangle([0.0, length_mm], [0.0, height_mm]);
        let sides = [half_length_mm, half_thickness_mm];
        let polygon = turned(fibre.through_mm, axis, sides).within(&section);
        if polygon.area_and_centroid().0 <= 0.0 {
            return Err(CompositeError::FibreOutside { fibre: place });
        }
        Ok(Self {
            material: fibre.material,
            angle_deg: fibre.angle_deg,
            axis,
            through_mm: fibre.through_mm,
            half_thickness_mm,
            half_length_mm,
            polygon,
        })
    }

    /// Distances of a point from the fibre's middle, along and across its axis [mm].
    pub fn distances(&self, point: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = [point[0] - self.through_mm[0], point[1] - self.through_mm[1]];
        [
            dx * self.axis[0] + dy * self.axis[1],
            dy * self.axis[0] - dx * self.axis[1],
        ]
    }

    /// Whether all of another fibre lies on one side of this one: the boxes of slanted fibres meet
    /// long before they do.
    fn is_beside(&self, other: &Self) -> bool {
        let corners = other.polygon.corners().iter();
        let across = corners.map(|corner| self.distances(*corner)[1]);
        let [low, high] = across.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], one| {
            [low.min(one), high.max(one)]
        });
        low >= self.half_thickness_mm || high <= -self.half_thickness_mm
    }

    /// Whether it lies across an axis, 0 for x and 1 for y: what round-off leaves of its own along it counts
    /// for nothing.
    pub fn is_across(&self, axis: usize) -> bool {
        self.axis[axis].abs() < f64::EPSILON
    }

    /// Whether it lies at an angle to both axes.
    pub fn is_slanted(&self) -> bool {
        !self.is_across(0) && !self.is_across(1)
    }

    /// The stretch of an axis that it fills with so many cells, where it lies across that axis.
    pub fn fine_across(&self, axis: usize, across: u32) -> Option<Fine> {
        let middle = self.through_mm[axis];
        let half = self.half_thickness_mm;
        self.is_across(axis)
            .then(|| Fine::through([middle - half, middle + half], across))
    }

    /// Where it ends along an axis that it lies along, outside of the section where it runs through [mm].
    pub fn ends_along(&self, axis: usize) -> Option<[f64; 2]> {
        let middle = self.through_mm[axis];
        let half = self.half_length_mm;
        self.is_across(1 - axis)
            .then_some([middle - half, middle + half])
    }

    /// Whether another fibre of the same direction lies in its own line, if only in part.
    fn is_level_with(&self, other: &Self) -> bool {
        let apart = self.distances(other.through_mm)[1].abs();
        apart < self.half_thickness_mm + other.half_thickness_mm
    }

    /// The part of it inside the section.
    pub fn polygon(&self) -> &Polygon {
        &self.polygon
    }

    /// Smallest and largest x and y [mm].
    pub fn extent(&self) -> [[f64; 2]; 2] {
        extent(self.polygon.corners())
    }
}

/// An end of a fibre inside the section.
#[derive(Debug, Clone, Copy)]
struct End<'a> {
    at_mm: f64,
    band: &'a Band,
    /// Whether its fibre lies before it along the axis.
    is_last: bool,
}

/// Gaps along an axis between the faces of two fibres across it that lie beside each other over a part of their
/// lengths, from and to [mm]: those narrower than either fibre is thick, where one of the two ends inside the
/// section.
///
/// There one fibre hands its force to the other through the matrix. Grids that all have one cell through such a
/// gap are too stiff by the same, and their agreement says nothing. Two that run through hand nothing over.
pub fn gaps_beside_ends(bands: &[Band], axis: usize, sides: [f64; 2]) -> Vec<[f64; 2]> {
    let (slack, along) = (1e-9 * sides[axis], sides[1 - axis]);
    let inside = 1e-9 * along..along - 1e-9 * along;
    let mut beside: Vec<_> = bands
        .iter()
        .filter_map(|band| {
            Some((
                band,
                band.fine_across(axis, 1)?.between,
                band.ends_along(1 - axis)?,
            ))
        })
        .collect();
    beside.sort_by(|(_, a, _), (_, b, _)| a[0].total_cmp(&b[0]));
    let mut gaps = Vec::new();
    for (lower, [_, face], ends) in &beside {
        let from = beside.partition_point(|(_, between, _)| between[0] <= face + slack);
        let thickness = 2.0 * lower.half_thickness_mm;
        for (upper, [other, _], others) in &beside[from..] {
            let width = other - face;
            if width >= thickness {
                break;
            }
            let is_narrow = width < 2.0 * upper.half_thickness_mm;
            let common = [ends[0].max(others[0]), ends[1].min(others[1])];
            let is_beside = common[0].max(0.0) + inside.start < common[1].min(along);
            let has_end = common.iter().any(|end| inside.contains(end));
            if is_narrow && is_beside && has_end {
                gaps.push([*face, *other]);
            }
        }
    }
    // an array of fibres has the same ones many times
    gaps.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    gaps.dedup();
    gaps
}

/// What the ends of fibres along an axis ask of its lines.
///
/// A line through each end, with cells beside it as small as those across its fibre: there a stress of the size
/// of the fibre's thickness passes into the matrix. In a gap between two fibres in a line that is narrower than
/// they are thick, so many cells as across a fibre: nearly all of a broken fibre's stretch may be there. As many
/// in the narrow gaps beside fibres that end ([`gaps_beside_ends`]).
pub fn fine_at_ends(bands: &[Band], axis: usize, sides: [f64; 2], across: u32) -> Vec<Fine> {
    let side = sides[axis];
    let slack = 1e-9 * side;
    let mut ends: Vec<End<'_>> = Vec::new();
    for band in bands {
        for (at_mm, is_last) in band
            .ends_along(axis)
            .into_iter()
            .flatten()
            .zip([false, true])
        {
            // one on an edge or outside is none
            if slack < at_mm && at_mm < side - slack {
                ends.push(End {
                    at_mm,
                    band,
                    is_last,
                });
            }
        }
    }
    ends.sort_by(|a, b| a.at_mm.total_cmp(&b.at_mm));
    let mut fine = Vec::new();
    for (place, end) in ends.iter().enumerate() {
        let thickness = 2.0 * end.band.half_thickness_mm;
        fine.push(Fine {
            between: [end.at_mm; 2],
            size: thickness / f64::from(across),
        });
        if !end.is_last {
            continue;
        }
        let within = ends[place + 1..]
            .iter()
            .take_while(|other| other.at_mm < end.at_mm + thickness);
        let facing = within.filter(|other| !other.is_last && other.band.is_level_with(end.band));
        for other in facing {
            if other.at_mm > end.at_mm + slack {
                fine.push(Fine::through([end.at_mm, other.at_mm], across));
            }
        }
    }
    let gaps = gaps_beside_ends(bands, axis, sides);
    fine.extend(gaps.into_iter().map(|gap| Fine::through(gap, across)));
    fine
}

/// A rectangle around a middle, of half sides along an axis and across it.
fn turned([x, y]: [f64; 2], [c, s]: [f64; 2], [along, across]: [f64; 2]) -> Polygon {
    let corner = |along: f64, across: f64| [x + along * c - across * s, y + along * s + across * c];
    Polygon::of(&[
        corner(-along, -across),
        corner(along, -across),
        corner(along, across),
        corner(-along, across),
    ])
}

fn extent(corners: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for corner in corners {
        for axis in 0..2 {
            extent[axis][0] = extent[axis][0].min(corner[axis]);
            extent[axis][1] = extent[axis][1].max(corner[axis]);
        }
    }
    extent
}

/// Finds two fibres that share more than round-off of the thinner one's area.
///
/// Sorted by where they begin along x, each is held only against those that begin before it ends.
pub fn refuse_overlap(bands: &[Band]) -> Result<(), CompositeError> {
    let extents: Vec<_> = bands.iter().map(Band::extent).collect();
    let mut order: Vec<usize> = (0..bands.len()).collect();
    order.sort_by(|&a, &b| {
        extents[a][0][0]
            .total_cmp(&extents[b][0][0])
            .then(a.cmp(&b))
    });
    for (rank, &first) in order.iter().enumerate() {
        for &second in &order[rank + 1..] {
            if extents[second][0][0] >= extents[first][0][1] {
                break;
            }
            if extents[second][1][0] >= extents[first][1][1]
                || extents[first][1][0] >= extents[second][1][1]
            {
                continue;
            }
            let (smaller, larger) = (first.min(second), first.max(second));
            if bands[smaller].is_beside(&bands[larger]) || bands[larger].is_beside(&bands[smaller])
            {
                continue;
            }
            let common = bands[smaller].polygon.within(&bands[larger].polygon);
            let (area_mm2, [x_mm, y_mm]) = common.area_and_centroid();
            let smallest = bands[smaller]
                .polygon
                .area_and_centroid()
                .0
                .min(bands[larger].polygon.area_and_centroid().0);
            if area_mm2 > 1e-9 * smallest {
                return Err(CompositeError::Overlap {
                    first: smaller,
                    second: larger,
                    area_mm2,
                    x_mm,
                    y_mm,
                });
            }
        }
    }
    Ok(())
}
