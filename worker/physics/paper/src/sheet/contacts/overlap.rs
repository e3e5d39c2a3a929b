//! The area two straight ribbons have in common.

/// A straight ribbon in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ribbon {
    /// A point of its middle line [µm].
    pub(super) at_um: [f64; 2],
    /// Unit vector.
    pub(super) along: [f64; 2],
    /// How far it reaches from the point [µm].
    pub(super) back_um: f64,
    pub(super) forth_um: f64,
    pub(super) width_um: f64,
}

impl Ribbon {
    /// Its corners in the frame of another, along and across that, about that one's point.
    fn corners_in(&self, frame: &Ribbon) -> [[f64; 2]; 4] {
        let half = 0.5 * self.width_um;
        let back = -self.back_um;
        let corners = [
            [back, -half],
            [self.forth_um, -half],
            [self.forth_um, half],
            [back, half],
        ];
        corners.map(|[along, across]| {
            let x = self.at_um[0] + along * self.along[0] - across * self.along[1] - frame.at_um[0];
            let y = self.at_um[1] + along * self.along[1] + across * self.along[0] - frame.at_um[1];
            [
                x * frame.along[0] + y * frame.along[1],
                y * frame.along[0] - x * frame.along[1],
            ]
        })
    }
}

/// Area [µm²] of what two ribbons have in common: W₁ W₂/sin θ where long ones cross at θ, less where
/// one ends. One is cut along the four sides of the other ([SutherlandHodgman1974]).
pub(super) fn common_area_um2([first, second]: [Ribbon; 2]) -> f64 {
    // four corners, and one more from each side that cuts
    let mut polygon = Polygon::default();
    for corner in second.corners_in(&first) {
        polygon.push(corner);
    }
    let half = 0.5 * first.width_um;
    polygon = polygon.below(0, first.forth_um, 1.0);
    polygon = polygon.below(0, -first.back_um, -1.0);
    polygon = polygon.below(1, half, 1.0);
    polygon = polygon.below(1, -half, -1.0);
    polygon.area()
}

/// A convex polygon of at most eight corners.
#[derive(Clone, Copy, Default)]
struct Polygon {
    corners: [[f64; 2]; 8],
    count: usize,
}

impl Polygon {
    fn push(&mut self, corner: [f64; 2]) {
        // rounding could make a ninth of a corner that lies on a side; it encloses nothing
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    /// What lies where (coordinate − limit) · sign ≤ 0.
    fn below(&self, axis: usize, limit: f64, sign: f64) -> Self {
        let mut kept = Self::default();
        for index in 0..self.count {
            let corner = self.corners[index];
            let next = self.corners[(index + 1) % self.count];
            let [here, there] = [corner, next].map(|corner| (corner[axis] - limit) * sign);
            if here <= 0.0 {
                kept.push(corner);
            }
            if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
                let share = here / (here - there);
                kept.push([0, 1].map(|axis| corner[axis] + share * (next[axis] - corner[axis])));
            }
        }
        kept
    }

    /// ½ |∑ (xᵢ yᵢ₊₁ − xᵢ₊₁ yᵢ)|
    fn area(&self) -> f64 {
        let crosses = (0..self.count).map(|index| {
            let [a, b] = self.corners[index];
            let [c, d] = self.corners[(index + 1) % self.count];
            a * d - b * c
        });
        0.5 * crosses.sum::<f64>().abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ribbon(degrees: f64, width_um: f64, back_um: f64, forth_um: f64) -> Ribbon {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Ribbon {
            at_um: [3.0, -7.0],
            along: [cosine, sine],
            back_um,
            forth_um,
            width_um,
        }
    }

    #[test]
    fn long_ribbons_share_the_product_of_their_widths_over_the_sine() {
        for degrees in [90.0_f64, 120.0, 45.0, 30.0, 10.0, 200.0] {
            let area = common_area_um2([
                ribbon(17.0, 30.0, 1e4, 1e4),
                ribbon(17.0 + degrees, 20.0, 1e4, 1e4),
            ]);
            let expected = 30.0 * 20.0 / degrees.to_radians().sin().abs();
            assert!((area / expected - 1.0).abs() < 1e-12, "{degrees}: {area}");
        }
    }

    #[test]
    fn a_ribbon_that_ends_on_another_shares_half() {
        let ending = ribbon(90.0, 20.0, 100.0, 0.0);
        let area = common_area_um2([ribbon(0.0, 30.0, 100.0, 100.0), ending]);
        assert!((area - 20.0 * 15.0).abs() < 1e-9);
    }

    #[test]
    fn parallel_ribbons_share_their_common_length() {
        let mut beside = ribbon(0.0, 20.0, 40.0, 60.0);
        beside.at_um[1] += 15.0;
        let first = ribbon(0.0, 20.0, 100.0, 10.0);
        assert!((common_area_um2([first, beside]) - 50.0 * 5.0).abs() < 1e-9);
        beside.at_um[1] += 5.0;
        assert!(common_area_um2([first, beside]) < 1e-9);
        beside.at_um[1] += 5.0;
        assert!(common_area_um2([first, beside]).abs() < f64::MIN_POSITIVE);
    }
}
