//! Regular arrangements of points: members of a grain, grains in a box.
use nalgebra::Vector3;

pub use crate::spec::granular_scene::Lattice as Arrangement;

/// A lattice without bounds: rows and layers in line (`SimpleCubic`, solid fraction of touching spheres
/// π/6 = 0.52), or hexagonal close packing, layers ABAB along z (`Hexagonal`, π/√18 = 0.74).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    pub arrangement: Arrangement,
    /// Distance of neighbours [m], positive.
    pub spacing: f64,
    /// One of its points [m].
    pub anchor: Vector3<f64>,
}

/// Points this far beyond a bound, in spacings, still count: the bound may be a point plus a
/// multiple of the spacing, rounded.
const ROUND_OFF: f64 = 1e-9;

impl Lattice {
    /// Its points with lower ≤ x ≤ upper [m], layer by layer from below, each row along x.
    pub fn points_between(&self, lower: &Vector3<f64>, upper: &Vector3<f64>) -> Vec<Vector3<f64>> {
        let Self {
            spacing, anchor, ..
        } = *self;
        let (row_distance, layer_distance) = match self.arrangement {
            Arrangement::SimpleCubic => (spacing, spacing),
            Arrangement::Hexagonal => (spacing * 0.75_f64.sqrt(), spacing * (2.0_f64 / 3.0).sqrt()),
        };
        let mut points = Vec::new();
        let along = |axis: usize, start: f64, step: f64| {
            let slack = ROUND_OFF * spacing;
            let first = ((lower[axis] - slack - start) / step).ceil() as i64;
            let last = ((upper[axis] + slack - start) / step).floor() as i64;
            (first..=last).map(move |number| (number, start + number as f64 * step))
        };
        for (layer, z) in along(2, anchor.z, layer_distance) {
            // every other layer sits over the gaps of its neighbours
            let shift = match self.arrangement {
                Arrangement::Hexagonal if layer % 2 != 0 => {
                    Vector3::new(0.5, 0.5 / 3.0_f64.sqrt(), 0.0)
                }
                _ => Vector3::zeros(),
            } * spacing;
            for (row, y) in along(1, anchor.y + shift.y, row_distance) {
                let stagger = match self.arrangement {
                    Arrangement::Hexagonal if row % 2 != 0 => 0.5 * spacing,
                    _ => 0.0,
                };
                for (_, x) in along(0, anchor.x + shift.x + stagger, spacing) {
                    points.push(Vector3::new(x, y, z));
                }
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(arrangement: Arrangement) -> Lattice {
        let anchor = Vector3::new(0.3, -0.1, 0.2);
        Lattice {
            arrangement,
            spacing: 0.1,
            anchor,
        }
    }

    /// Number of points at the spacing from the anchor, and the distance of the nearest.
    fn neighbours(lattice: &Lattice) -> (usize, f64) {
        let reach = Vector3::repeat(0.15);
        let points = lattice.points_between(&(lattice.anchor - reach), &(lattice.anchor + reach));
        let distances = points.iter().map(|point| (point - lattice.anchor).norm());
        let others: Vec<f64> = distances.filter(|distance| *distance > 1e-9).collect();
        let nearest = others.iter().copied().fold(f64::INFINITY, f64::min);
        let count = others.iter().filter(|distance| **distance < 0.1 + 1e-9);
        (count.count(), nearest)
    }

    #[test]
    fn cubic_points_have_6_and_hexagonal_ones_12_neighbours() {
        for (arrangement, expected) in [(Arrangement::SimpleCubic, 6), (Arrangement::Hexagonal, 12)]
        {
            let (count, nearest) = neighbours(&lattice(arrangement));
            assert_eq!(count, expected);
            assert!((nearest - 0.1).abs() < 1e-12);
        }
    }

    #[test]
    fn bounds_on_points_include_them() {
        let lattice = lattice(Arrangement::SimpleCubic);
        let upper = lattice.anchor + Vector3::new(0.3, 0.2, 0.1);
        assert_eq!(
            lattice.points_between(&lattice.anchor, &upper).len(),
            4 * 3 * 2
        );
        let below = lattice.anchor - Vector3::repeat(0.05);
        assert!(lattice.points_between(&below, &below).is_empty());
    }

    #[test]
    fn a_close_packing_fills_0_74() {
        let lattice = lattice(Arrangement::Hexagonal);
        // whole periods of the lattice: 20 x 10 x 8 of 1 x √3 x √(8/3) spacings
        let side = Vector3::new(20.0, 10.0 * 3.0_f64.sqrt(), 8.0 * (8.0_f64 / 3.0).sqrt()) * 0.1;
        let lower = Vector3::repeat(0.01);
        let points = lattice.points_between(&lower, &(lower + side));
        let solid = points.len() as f64 * std::f64::consts::PI / 6.0 * 1e-3 / side.product();
        let expected = std::f64::consts::PI / 18.0_f64.sqrt();
        assert!((solid - expected).abs() < 1e-12, "{solid}");
    }
}
