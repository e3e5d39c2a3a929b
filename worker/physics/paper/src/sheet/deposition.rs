//! Fibres that settle on what lies below them.
//!
//! The idea of KCL-PAKKA [Niskanen1997]: fibres fall one after the other, flat, and each bends down
//! as far as a bound on its slope allows. There the plane is a lattice of cells as wide as a fibre,
//! fibres run along its rows, and the fibre may step by T_f from cell to cell of width w_f: the slope
//! bound T_f/w_f. Here fibres run in all directions over a [`Bed`] of finer pixels, and the slope
//! bound itself is the parameter, so that it means the same on any pixel.
//!
//! A fibre's underside is the lowest line that is nowhere below the bed's surface and nowhere steeper
//! than the bound F: b(s) = max over s' of [h(s') − F |s − s'|], where h is the height of the bed under
//! the fibre's axis at s. It is found exactly by one sweep forth and one back. The axis alone is
//! carried, as in the lattice: a tube is lowest there, and a collapsed fibre is limp across its width
//! and twists. (A ribbon that is stiff across its width was tried; even without a bound on slopes it
//! leaves half of the sheet empty, and no sheet became denser than 400 kg/m³.) Its whole width carries
//! what comes later.
//!
//! F stands for bending stiffness, wet pressing and span together, so it is to be fitted to a measured
//! density. It is a bound on geometry: no force says how hard a fibre is pressed on which support.
use super::pulp::FibreSection;
use super::raster::Raster;

/// The surface of what has been laid, in pixels.
#[derive(Clone, Debug)]
pub(super) struct Bed {
    raster: Raster,
    /// Height [µm] of each pixel, row after row; the forming wire is at 0.
    heights_um: Vec<f64>,
    /// Steepest slope [-].
    flexibility: f64,
    /// Supports of the fibre at hand [µm], kept for their memory.
    supports_um: Vec<f64>,
}

impl Bed {
    pub(super) fn new(size_um: [f64; 2], pixel_um: f64, flexibility: f64) -> Self {
        let raster = Raster::new(size_um, pixel_um);
        Self {
            raster,
            heights_um: vec![0.0; raster.pixels()],
            flexibility,
            supports_um: Vec::new(),
        }
    }

    /// Sets the heights of a centre line so that the fibre lies on the bed.
    ///
    /// The support of a point is the highest pixel under the axis within the segments on both sides, but
    /// for their far ends: a centre line of straight segments then stays above the bed between its points
    /// as well.
    pub(super) fn settle(&mut self, points: &mut [[f64; 3]], section: FibreSection) {
        let mut supports = std::mem::take(&mut self.supports_um);
        supports.clear();
        supports.resize(points.len(), 0.0);
        self.raster.under(points, 0.0, |under| {
            let height = self.heights_um[under.pixel];
            let mut raise = |point: usize| supports[point] = height.max(supports[point]);
            if under.share < 1.0 {
                raise(under.segment);
            }
            if under.share > 0.0 {
                raise(under.segment + 1);
            }
        });
        bound_slopes(points, self.flexibility, &mut supports);
        for (point, support) in points.iter_mut().zip(&supports) {
            point[2] = support + 0.5 * section.thickness_um;
        }
        self.supports_um = supports;
    }

    /// Makes a settled fibre part of the bed.
    pub(super) fn cover(&mut self, points: &[[f64; 3]], section: FibreSection) {
        self.raster.under(points, section.width_um, |under| {
            let top = under.height_um + 0.5 * section.thickness_um;
            let height = &mut self.heights_um[under.pixel];
            *height = height.max(top);
        });
    }
}

/// Raises what is too far below its neighbours: the lowest heights that are nowhere below the given
/// ones and nowhere steeper than `flexibility`.
fn bound_slopes(points: &[[f64; 3]], flexibility: f64, heights: &mut [f64]) {
    let fall = |index: usize| {
        let [one, other] = [points[index - 1], points[index]];
        flexibility * (other[0] - one[0]).hypot(other[1] - one[1])
    };
    for index in 1..points.len() {
        heights[index] = heights[index].max(heights[index - 1] - fall(index));
    }
    for index in (1..points.len()).rev() {
        heights[index - 1] = heights[index - 1].max(heights[index] - fall(index));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTION: FibreSection = FibreSection {
        width_um: 20.0,
        wall_um: 2.0,
        thickness_um: 6.0,
        coarseness_ug_per_um: 1e-4,
    };

    fn line(from: [f64; 2], to: [f64; 2]) -> Vec<[f64; 3]> {
        let count = ((to[0] - from[0]).hypot(to[1] - from[1]) / 5.0) as usize;
        let share = |index: usize| index as f64 / count as f64;
        let point = |t: f64| [0, 1].map(|axis| from[axis] + t * (to[axis] - from[axis]));
        (0..=count)
            .map(|index| point(share(index)))
            .map(|[x, y]| [x, y, 0.0])
            .collect()
    }

    #[test]
    fn the_first_fibre_lies_on_the_wire() {
        let mut bed = Bed::new([400.0, 400.0], 5.0, 0.2);
        let mut first = line([0.0, 200.0], [400.0, 200.0]);
        bed.settle(&mut first, SECTION);
        assert!(first.iter().all(|point| (point[2] - 3.0).abs() < 1e-12));
    }

    /// On the first it lies 6 µm higher, and it comes down at a slope of 0.2 within 30 µm.
    #[test]
    fn the_second_climbs_over_the_first_at_the_allowed_slope() {
        let mut bed = Bed::new([400.0, 400.0], 5.0, 0.2);
        bed.cover(
            &settled(&mut bed.clone(), line([0.0, 200.0], [400.0, 200.0])),
            SECTION,
        );
        let second = settled(&mut bed, line([200.0, 0.0], [200.0, 400.0]));
        for point in &second {
            let beyond = ((point[1] - 200.0).abs() - 10.0).max(0.0);
            // pixels and half a segment on both sides carry as well
            let [lowest, highest] = [beyond, (beyond - 10.0).max(0.0)]
                .map(|distance| 3.0 + (6.0 - 0.2 * distance).max(0.0));
            assert!(
                point[2] >= lowest - 1e-9 && point[2] <= highest + 1e-9,
                "{point:?}"
            );
        }
    }

    #[test]
    fn a_rigid_fibre_stays_level_and_a_limp_one_touches_the_wire_beside_the_first() {
        for (flexibility, beside) in [(0.0, 9.0), (100.0, 3.0)] {
            let mut bed = Bed::new([400.0, 400.0], 5.0, flexibility);
            bed.cover(
                &settled(&mut bed.clone(), line([0.0, 200.0], [400.0, 200.0])),
                SECTION,
            );
            let second = settled(&mut bed, line([200.0, 0.0], [200.0, 400.0]));
            let outside = second
                .iter()
                .filter(|point| (point[1] - 200.0).abs() > 20.0);
            for point in outside {
                assert!((point[2] - beside).abs() < 1e-9, "{point:?}");
            }
        }
    }

    fn settled(bed: &mut Bed, mut points: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
        bed.settle(&mut points, SECTION);
        points
    }
}
