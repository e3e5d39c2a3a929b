//! Fibres at an angle to the grid, as bars that run through its cells.
//!
//! The mean stiffness of a cell, that of a laminate, lets a stiff fibre stretch wherever it passes from one
//! row of cells to the next, by way of cells that only a corner of it touches. So what a fibre is stiffer
//! along its axis t than what lies around it, ΔE, is borne by bars: side by side across the fibre, each from
//! where it enters a cell to where it leaves it, each with the one strain that these two points have in the
//! bilinear field of the cell's particles. Cells beside each other share these points, and the fibre's force
//! runs on, whatever the grid. With the mean strain ε̄, the hourglass amplitude q_t = t · q, and x, y from the
//! cell's middle to the middle of a bar, its strain is
//!
//! ε = t · ε̄ t + g q_t,  g = (t_x y + t_y x) / (a b)   (7)
//!
//! and bars store ½ ΔE ∫ ε² over the fibre's area in the cell, the mean strain's part of which the laminate has
//! already. Of fibres that are thin beside the cells this is embedded reinforcement, which finite
//! elements integrate along its path through their own field, without unknowns of its own [HartlHandel2002].
use loadframe_api::section::fibre::Band;
use loadframe_api::section::polygon::Polygon;

use crate::stiffness::{Stiffness, compliance};

/// The bars of a cell's fibres, which have one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bars {
    pub(crate) cell: u32,
    /// t of (7).
    pub(crate) axis: [f64; 2],
    /// Σ ΔE ∫ gᵏ dA for k = 0, 1, 2: [N], [N/mm], [N/mm²].
    pub(crate) moments: [f64; 3],
}

impl Bars {
    /// Those of the parts of a cell, given with the moments of their areas; none where fibres are no stiffer
    /// along their axis than what lies `around` them, or have more than one direction.
    pub(super) fn of<'a>(
        cell: u32,
        around: &Stiffness,
        fibres: impl Iterator<Item = (&'a Band, &'a Stiffness, [f64; 3])> + Clone,
    ) -> Option<Self> {
        let (first, ..) = fibres.clone().next()?;
        let [c, s] = first.axis;
        let mut moments = [0.0; 3];
        for (band, stiffness, areas) in fibres {
            let sine = c * band.axis[1] - s * band.axis[0];
            if !band.is_slanted() || sine.abs() > 1e-9 {
                return None;
            }
            let more = along(stiffness, [c, s]) - along(around, [c, s]);
            for (moment, area) in moments.iter_mut().zip(areas) {
                *moment += more.max(0.0) * area;
            }
        }
        (moments[0] > 0.0).then_some(Self {
            cell,
            axis: [c, s],
            moments,
        })
    }
}

/// Young's modulus along an axis [MPa].
pub(crate) fn along(stiffness: &Stiffness, [c, s]: [f64; 2]) -> f64 {
    let stress = nalgebra::Vector3::new(c * c, s * s, c * s);
    1.0 / stress.dot(&(compliance(stiffness) * stress))
}

/// ∫ gᵏ dA for k = 0, 1, 2 of the part of a cell that a fibre along `axis` fills, g of (7) taken in the middle
/// of each line along the fibre: [mm²], [mm], [1].
///
/// Between two corners, across the fibre, a line's ends go straight, so that the integrands are of the third
/// degree at most and two points of Gauss are exact.
pub(super) fn moments(
    part: &Polygon,
    [c, s]: [f64; 2],
    middle: [f64; 2],
    [a, b]: [f64; 2],
) -> [f64; 3] {
    let across = |p: [f64; 2]| p[1] * c - p[0] * s;
    let mut offsets: Vec<f64> = part.corners().iter().map(|&p| across(p)).collect();
    offsets.sort_by(f64::total_cmp);
    let mut moments = [0.0; 3];
    for pair in offsets.windows(2) {
        let half = 0.5 * (pair[1] - pair[0]);
        for sign in [-1.0, 1.0] {
            let offset = 0.5 * (pair[0] + pair[1]) + sign * half / 3.0_f64.sqrt();
            let Some([from, to]) = line(part, across, offset) else {
                continue;
            };
            let length = ((to[0] - from[0]) * c + (to[1] - from[1]) * s).abs();
            let [x, y] = [0, 1].map(|axis| 0.5 * (from[axis] + to[axis]) - middle[axis]);
            let g = (c * y + s * x) / (a * b);
            for (power, moment) in moments.iter_mut().enumerate() {
                *moment += half * length * g.powi(power as i32);
            }
        }
    }
    moments
}

/// Where a line at this offset enters and leaves a polygon.
fn line(part: &Polygon, across: impl Fn([f64; 2]) -> f64, offset: f64) -> Option<[[f64; 2]; 2]> {
    let corners = part.corners();
    let mut ends = (0..corners.len()).filter_map(|place| {
        let (from, to) = (corners[place], corners[(place + 1) % corners.len()]);
        let (before, after) = (across(from) - offset, across(to) - offset);
        ((before < 0.0) != (after < 0.0)).then(|| {
            let share = before / (before - after);
            [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
        })
    });
    Some([ends.next()?, ends.next()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_cut_cell_are_those_of_many_lines() {
        let (sides, middle) = ([0.7, 0.5], [2.35, 1.25]);
        let axis = [0.8, 0.6];
        let cell = Polygon::rectangle([2.0, 2.7], [1.0, 1.5]);
        // a band that leaves two corners
        let limit = |p: [f64; 2]| p[1] * axis[0] - p[0] * axis[1];
        let (low, high) = (limit(middle) - 0.11, limit(middle) + 0.19);
        let normal = [-axis[1], axis[0]];
        let part = cell
            .clipped(normal, high)
            .clipped([-normal[0], -normal[1]], -low);
        let found = moments(&part, axis, middle, sides);
        let (area, centroid) = part.area_and_centroid();
        assert!((found[0] - area).abs() < 1e-14, "{found:?} {area}");
        // g is linear in the place
        let g = (axis[0] * (centroid[1] - middle[1]) + axis[1] * (centroid[0] - middle[0]))
            / (sides[0] * sides[1]);
        assert!((found[1] - g * area).abs() < 1e-14, "{found:?}");
        let lines = 20_000;
        let width = (high - low) / f64::from(lines);
        let mut second = 0.0;
        for number in 0..lines {
            let offset = low + (f64::from(number) + 0.5) * width;
            let [from, to] = line(&part, limit, offset).unwrap();
            let [x, y] = [0, 1].map(|k| 0.5 * (from[k] + to[k]) - middle[k]);
            let g = (axis[0] * y + axis[1] * x) / (sides[0] * sides[1]);
            second += width * (to[0] - from[0]).hypot(to[1] - from[1]) * g * g;
        }
        assert!((found[2] / second - 1.0).abs() < 1e-6, "{found:?} {second}");
    }

    #[test]
    fn only_what_is_stiffer_along_a_slanted_axis_becomes_bars() {
        let isotropic = |e: f64| Stiffness::identity() * e;
        let along_45 = |e: f64| along(&isotropic(e), [0.5_f64.sqrt(), 0.5_f64.sqrt()]);
        // of C = E 1 the compliance is 1/E, and stress t t has the square (1 + 1 + 1)/4
        assert!((along_45(3.0) - 4.0).abs() < 1e-12);
    }
}
