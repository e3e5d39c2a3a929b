//! The saw: softening in steps, each of them linear.
//!
//! A crack band of width h [mm] in a material of modulus E [MPa] that cracks at the stress f [MPa] and
//! takes the energy G [N/mm] per area of crack follows the line
//!
//! σ(x) = f (1 - x) / (1 - x₀),  x = ε/ε_u,  x₀ = f / (E ε_u)   (1)
//!
//! from its strength to the strain ε_u at which it is open [BazantOh1983]. The saw replaces the line by
//! secants through its points at
//!
//! √x_k = √x₀ + (1 - √x₀) k/N,  k = 0 … N   (2)
//!
//! the spacing by which N teeth leave the least area between line and saw: that area is
//! ½ f ε_u Σ (x_{k+1} - x_k)²/x_{k+1} / (1 - x₀), and its minimum for given N has steps in proportion to
//! √x. A tooth ends on the line, so that the strength is met exactly; what it dissipates lies between
//! the saw, when neighbours hold the strain of the cell, and the line, when the cell alone goes on
//! to its next tooth:
//!
//! A_line = ½ f ε_u,  A_saw = A_line (1 - ρ),  ρ = Σ (x_{k+1} - x_k)²/x_{k+1} / (1 - x₀)   (3)
//!
//! ε_u is such that the mean of both is G/h, as the ripple of [RotsBelletti2008] lies on either side of
//! its curve; what is dissipated is then known within ± ρ/(2 - ρ) of G ([`Saw::error`]): 18 % for
//! ten teeth in a fine grid, and in inverse proportion to their number.
//!
//! Because a cell cannot give more than it holds, h ≤ 2 E G / f² ([`Saw::new`]).

/// What is left of a stiffness when nothing is left, so that equations keep a solution: at most this.
pub(crate) const RESIDUAL: f64 = 1e-6;
/// And at least this, lest round-off decide.
pub(crate) const LEAST_RESIDUAL: f64 = 1e-9;
/// What an open crack may still bear at ε_u, over its strength: of tough cracks in fine grids, whose
/// ε_u is more than a hundred times the strain of the strength, a millionth of the stiffness would bear more.
const OPEN: f64 = 1e-4;

/// Halvings of the interval in which √x₀ is looked for: down to round-off.
const HALVINGS: u32 = 60;

/// The teeth of one plane of one part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Saw {
    teeth: u16,
    /// √x₀.
    root: f64,
}

impl Saw {
    /// The saw of a band that could be `room` = 2 E G / (f² h) times as wide; `None` when it is too
    /// wide already, which is below 1.
    pub(crate) fn new(teeth: u16, room: f64) -> Option<Self> {
        // of a cell just as wide as it may be, round-off decides
        if room.is_nan() || room < 1.0 - 1e-12 {
            return None;
        }
        let at = |root| Self { teeth, root };
        // falls from infinity to 1 as √x₀ grows to 1
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if at(middle).room() > room {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(at(high))
    }

    /// From a root that was found before.
    pub(crate) fn of_root(teeth: u16, root: f64) -> Self {
        Self { teeth, root }
    }

    /// √x₀.
    pub(crate) fn root(self) -> f64 {
        self.root
    }

    /// √x_k (2).
    fn root_at(self, level: u16) -> f64 {
        self.root + (1.0 - self.root) * f64::from(level) / f64::from(self.teeth)
    }

    /// ρ of (3).
    fn spread(self) -> f64 {
        // (x' - x)²/x' / (1 - x₀) with 1 - √x₀ taken out, which may be 0
        let step = 1.0 / f64::from(self.teeth);
        let sum: f64 = (0..self.teeth)
            .map(|level| {
                let (here, next) = (self.root_at(level), self.root_at(level + 1));
                let share = (here + next) * step / next;
                share * share
            })
            .sum();
        sum * (1.0 - self.root) / (1.0 + self.root)
    }

    /// Mean area of line and saw over ½ f ε₀, which is 2 E G / (f² h).
    pub(crate) fn room(self) -> f64 {
        (1.0 - 0.5 * self.spread()) / (self.root * self.root)
    }

    /// Half the difference of line and saw over G (3).
    pub(crate) fn error(self) -> f64 {
        let spread = self.spread();
        spread / (2.0 - spread)
    }

    /// Stress at which a tooth ends, over the strength.
    pub(crate) fn peak_stress(self, level: u16) -> f64 {
        let left = 1.0 - f64::from(level) / f64::from(self.teeth);
        left * (1.0 + self.root_at(level)) / (1.0 + self.root)
    }

    /// Strain at which a tooth ends, over that of the first.
    pub(crate) fn peak_strain(self, level: u16) -> f64 {
        (self.root_at(level) / self.root).powi(2)
    }

    /// What is left of the stiffness.
    pub(crate) fn integrity(self, level: u16) -> f64 {
        let residual = (OPEN * self.root * self.root).clamp(LEAST_RESIDUAL, RESIDUAL);
        (self.peak_stress(level) / self.peak_strain(level)).max(residual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dissipated in units of ½ f ε₀, by the polygon of the line and by the saw.
    fn areas(saw: Saw) -> [f64; 2] {
        let (mut line, mut fallen) = (0.0, 0.0);
        for level in 0..saw.teeth {
            let (strain, next) = (saw.peak_strain(level), saw.peak_strain(level + 1));
            let (stress, after) = (saw.peak_stress(level), saw.peak_stress(level + 1));
            // triangles from the origin over two peaks; under a secant that falls at constant strain
            line += stress * next - after * strain;
            fallen += strain * (stress - after / next * strain);
        }
        [line, fallen]
    }

    #[test]
    fn line_and_saw_lie_on_either_side_of_the_fracture_energy() {
        for teeth in [1, 3, 10, 40] {
            for room in [1.0, 1.5, 4.0, 30.0, 1000.0] {
                let saw = Saw::new(teeth, room).unwrap();
                let [line, fallen] = areas(saw);
                assert!((0.5 * (line + fallen) / room - 1.0).abs() < 1e-9, "{room}");
                let error = 0.5 * (line - fallen) / room;
                assert!((error - saw.error()).abs() < 1e-9, "{error}");
            }
        }
        let error = |teeth| Saw::new(teeth, 1000.0).unwrap().error();
        assert!(error(10) < 0.18 && error(20) < 0.10 && error(40) < 0.05);
    }

    #[test]
    fn the_first_tooth_is_the_strength_and_the_last_leaves_nothing() {
        let saw = Saw::new(10, 7.0).unwrap();
        assert!((saw.peak_stress(0) - 1.0).abs() < 1e-15);
        assert!((saw.integrity(0) - 1.0).abs() < 1e-15);
        assert_eq!(saw.peak_stress(10).to_bits(), 0.0_f64.to_bits());
        assert_eq!(saw.integrity(10).to_bits(), RESIDUAL.to_bits());
        let tough = Saw::new(10, 1e4).unwrap();
        assert!(tough.integrity(10) * tough.peak_strain(10) < 2.0 * OPEN);
        for level in 0..10 {
            assert!(saw.integrity(level + 1) < saw.integrity(level));
            assert!(saw.peak_stress(level + 1) < saw.peak_stress(level));
        }
        assert_eq!(Saw::of_root(10, saw.root()), saw);
    }

    #[test]
    fn a_band_that_holds_more_than_its_crack_takes_has_no_saw() {
        assert_eq!(Saw::new(10, 0.99), None);
        assert_eq!(Saw::new(10, f64::NAN), None);
        // just as wide as allowed: the stress falls at the strain of the strength
        let steep = Saw::new(10, 1.0).unwrap();
        assert!((steep.peak_strain(9) - 1.0).abs() < 1e-9);
    }
}
