//! What the standards make of force and deflection: formulas of [ISO14125] and [ISO14130].
/// How many rollers press.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// One in the middle: ISO 14125 method A; on a short span ISO 14130.
    ThreePoint,
    /// Two that move together, at the thirds of the span: ISO 14125 method B.
    FourPoint,
}

impl Loading {
    /// E_f = L³/(4 b h³) F/s in three-point loading and 23 L³/(108 b h³) F/s in four-point loading,
    /// from s = F L³/(48 EI) and s = 23 F L³/(1296 EI). ISO 14125 prints 0.21 for 23/108 = 0.21296 and
    /// so tells 1.4 % less.
    #[must_use]
    pub fn flexural_modulus(self, span_mm: f64, [b, h]: [f64; 2], force_per_mm: f64) -> f64 {
        let factor = match self {
            Self::ThreePoint => 0.25,
            Self::FourPoint => 23.0 / 108.0,
        };
        factor * span_mm.powi(3) / (b * h.powi(3)) * force_per_mm
    }

    /// σ_f = 3FL/(2bh²) in three-point loading, FL/(bh²) in four-point loading.
    #[must_use]
    pub fn outer_stress(self, span_mm: f64, [b, h]: [f64; 2], force_n: f64) -> f64 {
        let factor = match self {
            Self::ThreePoint => 1.5,
            Self::FourPoint => 1.0,
        };
        factor * force_n * span_mm / (b * h * h)
    }

    /// ε_f = 6 s h/L² in three-point loading, 108/23 s h/L² in four-point loading (ISO 14125 prints
    /// 4.7 for 108/23 = 4.696).
    #[must_use]
    pub fn outer_strain(self, span_mm: f64, h: f64, deflection_mm: f64) -> f64 {
        let factor = match self {
            Self::ThreePoint => 6.0,
            Self::FourPoint => 108.0 / 23.0,
        };
        factor * deflection_mm * h / (span_mm * span_mm)
    }

    /// σ_f corrected for a large deflection s: the formula's times 1 + 6 (s/L)² - 3 s h/L² in three-point
    /// loading, times 1 + 8.78 (s/L)² - 7.04 s h/L² in four-point loading [ISO14125].
    ///
    /// The first correction is the moment of the supports' horizontal forces, F/2 times the slope 3 s/L,
    /// about midspan; the second the span lost as the contacts move inwards by that slope times h/2. How
    /// far contacts also move around the rollers themselves is left out: it takes 6 s R₂/L² more away.
    #[must_use]
    pub fn outer_stress_far(
        self,
        span_mm: f64,
        sides: [f64; 2],
        force_n: f64,
        deflection_mm: f64,
    ) -> f64 {
        let (moment, shift) = match self {
            Self::ThreePoint => (6.0, 3.0),
            Self::FourPoint => (8.78, 7.04),
        };
        let deflection = deflection_mm / span_mm;
        let factor =
            1.0 + moment * deflection * deflection - shift * deflection * sides[1] / span_mm;
        self.outer_stress(span_mm, sides, force_n) * factor
    }

    /// ε_f corrected for a large deflection s: h/L (6.00 s/L - 24.37 (s/L)³ + 62.17 (s/L)⁵) in three-point
    /// loading, h/L (4.70 s/L - 14.39 (s/L)³ + 27.70 (s/L)⁵) in four-point loading [ISO14125].
    ///
    /// These numbers, and those of [`Self::outer_stress_far`], are not read off the standard's own text. They
    /// are held against an inextensible strip on edges without friction: strains are its own within 0.3 % up
    /// to s/L = 0.13, stresses within 0.3 % (three-point) and 0.9 % (four-point, s/L = 0.1).
    #[must_use]
    pub fn outer_strain_far(self, span_mm: f64, h: f64, deflection_mm: f64) -> f64 {
        let [first, third, fifth] = match self {
            Self::ThreePoint => [6.0, -24.37, 62.17],
            Self::FourPoint => [4.70, -14.39, 27.70],
        };
        let x = deflection_mm / span_mm;
        let square = x * x;
        h / span_mm * x * (first + square * (third + square * fifth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mid curvature times L/2 and mid moment over that of small deflections, of an inextensible strip on two
    /// edges a distance L apart without friction, under one force or two at the thirds: integrated along
    /// the strip in 4 000 steps from shooting for slope and height at an edge.
    #[test]
    fn corrections_are_those_of_a_strip_on_edges() {
        for (loading, x, strain, moment) in [
            (Loading::ThreePoint, 0.0424, 0.2527, 1.0108),
            (Loading::ThreePoint, 0.1018, 0.5848, 1.0633),
            (Loading::FourPoint, 0.0361, 0.1687, 1.0122),
            (Loading::FourPoint, 0.1054, 0.4793, 1.1062),
        ] {
            // h = L tells the strain by its own, h = 0 leaves out the way of contacts on a thick strip
            let found = loading.outer_strain_far(1.0, 1.0, x);
            assert!((found / strain - 1.0).abs() < 3e-3, "{x} {found}");
            let thin = [1.0, 1e-9];
            let small = loading.outer_stress(1.0, thin, 1.0);
            let found = loading.outer_stress_far(1.0, thin, 1.0, x) / small;
            assert!((found / moment - 1.0).abs() < 1e-2, "{x} {found}");
        }
    }
}
