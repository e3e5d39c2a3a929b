//! Neighbouring pairs of segments that touch make one contact.
use loadframe_api::DisjointSets;

use super::overlap::{Ribbon, common_area_um2};
use super::segments::Touch;
use crate::sheet::{Contact, SheetFibre, polyline};

/// Nearnesses that differ by less are equal but for rounding.
const SAME_NEARNESS: f64 = 1e-9;

/// A fibre is taken for straight so far from a touch, in widths of both fibres together, even where
/// the region is smaller: what fibres cover together where they cross at more than 12° (sin = 0.2)
/// reaches no further, and on 140 µm a fibre with a shape factor of 0.92 and 2 mm bends aside by a
/// quarter of its width of 28 µm.
const STRAIGHT_WIDTHS: f64 = 2.5;

/// Splits touches into regions; keeps its memory.
#[derive(Debug, Default)]
pub(super) struct Regions {
    sets: DisjointSets,
    region: Vec<Touch>,
}

impl Regions {
    /// Gives the touches of each region, in the order of their segments. Touches belong together when
    /// their segments are the same or next to one another on both fibres, or no further apart on both
    /// than the fibres are wide together: a fibre that rests on both edges of another touches it in two
    /// places of one crossing, which have one area.
    pub(super) fn join(
        &mut self,
        touches: &mut [Touch],
        lines: [Line<'_, '_>; 2],
        mut visit: impl FnMut(&[Touch]),
    ) {
        let reach = lines[0].fibre.section.width_um + lines[1].fibre.section.width_um;
        touches.sort_unstable_by_key(|touch| touch.segments);
        self.sets.reset(touches.len());
        for index in 1..touches.len() {
            for before in (0..index).rev() {
                let pair = [&touches[before], &touches[index]];
                let is_near = lines[0].are_near(pair, 0, reach);
                // every earlier segment ends before this one
                let end = lines[0].arcs_um[pair[0].segments[0] as usize + 1];
                if !is_near && lines[0].at_um(pair[1], 0) - end > reach {
                    break;
                }
                if is_near && lines[1].are_near(pair, 1, reach) {
                    self.sets.join(before as u32, index as u32);
                }
            }
        }
        // a root is the first of its region
        for root in 0..touches.len() as u32 {
            if self.sets.root(root) != root {
                continue;
            }
            let mut region = std::mem::take(&mut self.region);
            region.clear();
            for (index, touch) in touches.iter().enumerate() {
                if self.sets.root(index as u32) == root {
                    region.push(*touch);
                }
            }
            visit(&region);
            self.region = region;
        }
    }
}

/// A fibre and the arc length [µm] of each of its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'fibre, 'arcs> {
    pub(super) fibre: &'fibre SheetFibre,
    pub(super) arcs_um: &'arcs [f64],
}

/// The contact of a region: where the fibres are nearest, in the middle of such places if there are
/// several. Nothing when they cover no area together, as fibres that touch side by side.
pub(super) fn contact(
    numbers: [u32; 2],
    lines: [Line<'_, '_>; 2],
    region: &[Touch],
) -> Option<Contact> {
    let nearnesses = region.iter().map(|touch| touch.nearness);
    let nearest = nearnesses.fold(f64::INFINITY, f64::min);
    let is_nearest = |touch: &&Touch| touch.nearness <= nearest + SAME_NEARNESS;
    let count = region.iter().filter(is_nearest).count();
    let touch = region.iter().filter(is_nearest).nth(count / 2)?;
    let widths = lines.map(|line| line.fibre.section.width_um);
    let at_um = [0, 1].map(|side| lines[side].at_um(touch, side));
    let ribbons = [0, 1].map(|side| {
        // a region of crossing fibres may be smaller than what they cover together
        let reach = STRAIGHT_WIDTHS * (widths[0] + widths[1]);
        let [from, to] = lines[side].span_um(region, side);
        let [back, forth] = [at_um[side] - from, to - at_um[side]].map(|far| far.max(reach));
        lines[side].ribbon(touch, side, [back, forth])
    });
    let area_um2 = common_area_um2(ribbons);
    (area_um2 > 0.0).then_some(Contact {
        fibres: numbers,
        at_um,
        area_um2,
    })
}

impl Line<'_, '_> {
    /// Arc length of a touch.
    fn at_um(&self, touch: &Touch, side: usize) -> f64 {
        let segment = touch.segments[side] as usize;
        let [from, to] = [self.arcs_um[segment], self.arcs_um[segment + 1]];
        from + touch.shares[side] * (to - from)
    }

    /// Whether two touches are next to one another or within a reach on this fibre.
    fn are_near(&self, touches: [&Touch; 2], side: usize, reach_um: f64) -> bool {
        let [one, other] = touches.map(|touch| touch.segments[side]);
        let [from, to] = touches.map(|touch| self.at_um(touch, side));
        one.abs_diff(other) <= 1 || (to - from).abs() <= reach_um
    }

    /// Arc lengths between which a region lies.
    fn span_um(&self, region: &[Touch], side: usize) -> [f64; 2] {
        let segments = region.iter().map(|touch| touch.segments[side] as usize);
        let (first, last) = segments.fold((usize::MAX, 0), |(first, last), segment| {
            (first.min(segment), last.max(segment))
        });
        [self.arcs_um[first], self.arcs_um[last + 1]]
    }

    /// The straight ribbon about a touch that reaches so far back and forth, and no further than the
    /// fibre.
    fn ribbon(&self, touch: &Touch, side: usize, [back, forth]: [f64; 2]) -> Ribbon {
        let points = &self.fibre.centre_line_um;
        let segment = touch.segments[side] as usize;
        let [from, to] = [points[segment], points[segment + 1]];
        let centre = polyline::between(from, to, touch.shares[side]);
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let length = x.hypot(y);
        // only a fibre that stands upright has none, and none that was laid does
        let along = if length > 0.0 {
            [x / length, y / length]
        } else {
            [1.0, 0.0]
        };
        let at = self.at_um(touch, side);
        let whole = self.arcs_um[self.arcs_um.len() - 1];
        Ribbon {
            at_um: [centre[0], centre[1]],
            along,
            back_um: back.min(at),
            forth_um: forth.min(whole - at),
            width_um: self.fibre.section.width_um,
        }
    }
}
