//! Networks against closed forms.
use super::*;

/// Round-off of a direct solution of a few hundred unknowns whose stiffnesses differ by 1e4.
const ROUND_OFF: f64 = 1e-9;

/// A thin tube of 30 µm with a wall of 3 µm: sections of all tests.
pub(crate) fn tube() -> BeamSection {
    let (outer, inner) = (30.0_f64, 24.0_f64);
    let inertia = std::f64::consts::PI / 64.0 * (outer.powi(4) - inner.powi(4));
    BeamSection {
        area_um2: std::f64::consts::PI / 4.0 * (outer.powi(2) - inner.powi(2)),
        inertia_um4: inertia,
        polar_um4: 2.0 * inertia,
        youngs_modulus_gpa: 30.0,
        shear_modulus_gpa: 2.5,
        shear_coefficient: 2.6 / 4.9,
        strength_gpa: None,
        width_um: outer,
        line_density_ug_per_um: 1.5e-4,
        yielding: None,
    }
}

pub(crate) fn fibre(points: &[[f64; 3]]) -> FrameFibre {
    FrameFibre {
        centre_line_um: points.to_vec(),
        section: tube(),
    }
}

/// An unbreakable bond.
pub(crate) fn bond(fibres: [u32; 2], at_um: [f64; 2]) -> FrameBond {
    FrameBond {
        fibres,
        at_um,
        area_um2: 400.0,
        stiffness_mn_per_um3: 0.01,
        normal_strength_mn: None,
        shear_strength_mn: None,
    }
}

pub(crate) fn model(level: Level, length_um: f64) -> FrameModel {
    FrameModel {
        level,
        segment_um: None,
        attachment: Attachment::Node,
        length_um,
    }
}

pub(crate) fn close(found: f64, expected: f64, share: f64) {
    assert!(
        (found - expected).abs() <= share * expected.abs().max(1e-12),
        "{found} instead of {expected}"
    );
}

mod beams;
mod breaking;
mod iterative;
mod joints;
mod large;
mod moving;
mod refusals;
mod sheets;
mod taut;
mod together;
mod tubes;
