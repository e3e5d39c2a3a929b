//! What a set of touching points leads to, and what is wrong with it.

/// Pull or overlap below this share of the largest is round-off of condensed equations.
pub(super) const ROUND_OFF: f64 = 1e-10;

/// What a set of touching points leads to.
pub(super) struct Trial {
    /// Along the inward normals [mm].
    pub(super) displacements: Vec<f64>,
    /// On points that touch [N].
    pub(super) forces: Vec<f64>,
    pub(super) advances: Vec<f64>,
    pub(super) shared_advance: f64,
}

impl Trial {
    /// The touching point that is pulled most.
    pub(super) fn pulled(&self, touching: &[bool]) -> Option<usize> {
        let pull = -ROUND_OFF * largest(&self.forces);
        (0..touching.len())
            .filter(|&point| touching[point] && self.forces[point] < pull)
            .min_by(|&a, &b| self.forces[a].total_cmp(&self.forces[b]))
    }

    /// Where on the way from given forces to these the first of them vanishes, and which.
    pub(super) fn first_released(&self, touching: &[bool], from: &[f64]) -> Option<(f64, usize)> {
        let pull = -ROUND_OFF * largest(&self.forces);
        (0..touching.len())
            .filter(|&point| touching[point] && self.forces[point] < pull)
            .map(|point| {
                let start = from[point].max(0.0);
                (start / (start - self.forces[point]), point)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |a, b| a.max(b.abs()))
}
