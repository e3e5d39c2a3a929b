//! Bonds of the paper's lattice: springs between two particles.
//!
//! U = ½ k δ², δ the change of length; for small displacements δ = d · (u₂ - u₁) with the direction d
//! of the bond as it was made.

use crate::lattice::Geometry;

/// A bond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bond {
    pub particles: [u32; 2],
    /// k [N/mm].
    pub stiffness_n_per_mm: f64,
    /// Vector from the first particle to the second, unloaded [mm].
    pub vector_mm: [f64; 2],
}

/// Forces of a bond on the displacements of its two particles.
pub(crate) type Ends = [f64; 4];

impl Bond {
    pub(crate) fn length(&self) -> f64 {
        self.vector_mm[0].hypot(self.vector_mm[1])
    }

    /// Elongation of small displacements [mm] and the bond's direction.
    pub(crate) fn linear_stretch(&self, u: &Ends) -> (f64, [f64; 2]) {
        let length = self.length();
        let d = [self.vector_mm[0] / length, self.vector_mm[1] / length];
        (d[0] * (u[2] - u[0]) + d[1] * (u[3] - u[1]), d)
    }

    /// Elongation of large displacements [mm] and the bond's present direction.
    pub(crate) fn large_stretch(&self, u: &Ends) -> (f64, [f64; 2]) {
        let [x, y] = self.vector_mm;
        let (dx, dy) = (u[2] - u[0], u[3] - u[1]);
        let (px, py) = (x + dx, y + dy);
        let (length, now) = (self.length(), px.hypot(py));
        // Difference of squares: exact for displacements far below the length.
        let stretch = (dx * (2.0 * x + dx) + dy * (2.0 * y + dy)) / (length + now);
        (stretch, [px / now, py / now])
    }

    /// Energy [N mm] and its derivatives [N].
    pub(crate) fn forces(&self, (stretch, d): (f64, [f64; 2])) -> (f64, Ends) {
        let tension = self.stiffness_n_per_mm * stretch;
        let (x, y) = (tension * d[0], tension * d[1]);
        (0.5 * tension * stretch, [-x, -y, x, y])
    }

    /// Block by which the ends' tangent is made [N/mm]: k d dᵀ, and with `across` the tension's part
    /// k δ / length (1 - d dᵀ).
    pub(crate) fn block(&self, (_, d): (f64, [f64; 2]), across: f64) -> [f64; 4] {
        let k = self.stiffness_n_per_mm - across;
        [
            k * d[0] * d[0] + across,
            k * d[0] * d[1],
            k * d[0] * d[1],
            k * d[1] * d[1] + across,
        ]
    }

    /// Force of the bond at displacements of all particles [N], tension positive.
    #[must_use]
    pub fn tension_n(&self, geometry: Geometry, u: &[f64]) -> f64 {
        let ends = ends(u, self);
        let (stretch, _) = match geometry {
            Geometry::Linear => self.linear_stretch(&ends),
            Geometry::Large => self.large_stretch(&ends),
        };
        self.stiffness_n_per_mm * stretch
    }

    /// k δ over the present length [N/mm].
    pub(crate) fn tension_over_length(&self, stretch: f64) -> f64 {
        self.stiffness_n_per_mm * stretch / (self.length() + stretch)
    }
}

/// Displacements of a bond's two particles.
pub(crate) fn ends(u: &[f64], bond: &Bond) -> Ends {
    let [first, second] = bond.particles.map(|particle| 2 * particle as usize);
    [u[first], u[first + 1], u[second], u[second + 1]]
}
