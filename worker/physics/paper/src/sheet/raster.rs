//! The sheet's plane in square pixels, and which of them lie under a fibre.
use super::polyline::between;

/// Square pixels over a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Raster {
    pixel_um: f64,
    size: [usize; 2],
}

/// A pixel under a fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Under {
    pub(super) pixel: usize,
    /// Number of the segment it is under, and where along it, a share.
    pub(super) segment: usize,
    pub(super) share: f64,
    /// Height of the centre line there [µm].
    pub(super) height_um: f64,
}

impl Raster {
    pub(super) fn new(size_um: [f64; 2], pixel_um: f64) -> Self {
        let size = size_um.map(|side| ((side / pixel_um).ceil() as usize).max(1));
        Self { pixel_um, size }
    }

    /// Number of pixels.
    pub(super) fn pixels(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Pixels under a fibre, some of them several times; those under its axis when the width is 0.
    ///
    /// The fibre is looked at no more than 0.71 of a pixel apart across it and half a pixel along it, so
    /// that no pixel well under it is left out in any direction.
    pub(super) fn under(&self, points: &[[f64; 3]], width_um: f64, mut visit: impl FnMut(Under)) {
        let rows = (width_um / self.pixel_um * std::f64::consts::SQRT_2).ceil();
        let rows = (rows as usize).max(1);
        for (segment, ends) in points.windows(2).enumerate() {
            let [first, second] = [ends[0], ends[1]];
            let [x, y] = [second[0] - first[0], second[1] - first[1]];
            let length = x.hypot(y);
            if length <= 0.0 {
                continue;
            }
            let normal = [-y / length, x / length];
            // a segment of a pixel has a place in its middle, whatever its last digit
            let steps = (2.0 * length / self.pixel_um - 1e-6).ceil().max(2.0);
            for step in 0..=steps as usize {
                let share = step as f64 / steps;
                let centre = between(first, second, share);
                for row in 0..rows {
                    let offset = width_um * ((row as f64 + 0.5) / rows as f64 - 0.5);
                    let place = [0, 1].map(|axis| centre[axis] + offset * normal[axis]);
                    if let Some(pixel) = self.pixel(place) {
                        visit(Under {
                            pixel,
                            segment,
                            share,
                            height_um: centre[2],
                        });
                    }
                }
            }
        }
    }

    /// The pixel at a place, if it is in the sheet.
    fn pixel(&self, place_um: [f64; 2]) -> Option<usize> {
        let index = |axis: usize| {
            let place = place_um[axis] / self.pixel_um;
            // a cut end lies on the edge and belongs to the last pixel before it
            let is_inside = place >= 0.0 && place <= self.size[axis] as f64;
            is_inside.then(|| (place as usize).min(self.size[axis] - 1))
        };
        Some(index(1)? * self.size[0] + index(0)?)
    }
}
