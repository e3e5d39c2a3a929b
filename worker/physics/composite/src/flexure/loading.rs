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
