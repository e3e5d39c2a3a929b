//! How slowly a section swings, about: what says beforehand how long springs take to come to rest.
//!
//! Held at an end or both it is a beam of one material, the laminate average of what it holds, by
//! Timoshenko's bending and shear put together as Dunkerley does, 1/ω² = 1/ω_b² + 1/ω_s². Held otherwise
//! its slowest wave is one of shear, a quarter of its length between what is held and what is not. The engine finds
//! the frequency itself; this is for the estimate.
use super::{CompositeBending, Support, Way};
use crate::section::stiffness::{Stiffness, compliance, laminate, turned};

/// (k L)² of a beam's first bending vibration, and k L of its first one in shear: clamped at both ends, and at
/// one.
const CLAMPED: [f64; 2] = [22.373, std::f64::consts::PI];
const CANTILEVER: [f64; 2] = [3.516, std::f64::consts::FRAC_PI_2];
/// Shear correction of a rectangle of one material.
const SHEARED: f64 = 5.0 / 6.0;
/// 1 MPa over 1 kg/m³, in mm²/s².
const MPA_OVER_KG_PER_M3: f64 = 1e12;

/// The lowest frequency ω [1/s], about, with a density where a material has none [kg/m³]; `None` of materials
/// without constants.
pub(super) fn lowest_per_s(spec: &CompositeBending, any_density: f64) -> Option<f64> {
    let (stiffness, density) = average(spec, any_density)?;
    let compliance = compliance(&stiffness);
    let [along, shear] =
        [(0, 0), (2, 2)].map(|entry| MPA_OVER_KG_PER_M3 / compliance[entry] / density);
    let [length, height] = [spec.section.length_mm, spec.section.height_mm];
    let [left, right] = match spec.test.way() {
        Some(Way::Held(supports)) => {
            [&supports.left, &supports.right].map(Support::holds_both_axes)
        }
        _ => [false; 2],
    };
    let [bending, shearing] = match (left, right) {
        (true, true) => CLAMPED,
        (true, false) | (false, true) => CANTILEVER,
        (false, false) => {
            let quarter = std::f64::consts::FRAC_PI_2 / length.max(height);
            return Some(quarter * shear.sqrt());
        }
    };
    // EI / ρA of a rectangle is E h² / 12 ρ
    let bent = bending * height * (along / 12.0).sqrt() / (length * length);
    let sheared = shearing * (SHEARED * shear).sqrt() / length;
    Some(bent * sheared / bent.hypot(sheared))
}

/// Mean stiffness [MPa] and density [kg/m³] of what a section holds, as if all of it lay in layers.
pub(super) fn average(spec: &CompositeBending, any_density: f64) -> Option<(Stiffness, f64)> {
    let state = spec.section.state.into();
    let area = spec.section.length_mm * spec.section.height_mm;
    let mut layers: Vec<(f64, Stiffness)> = Vec::new();
    let mut density = 0.0;
    let mut add = |name: &str, share: f64, in_plane: f64, out_of_plane: f64| {
        let material = spec.materials.get(name)?;
        let own = material
            .elastic()?
            .stiffness_out_of_plane(state, out_of_plane);
        layers.push((share, turned(&own.ok()?.0, in_plane)));
        density += share * material.density_kg_per_m3.unwrap_or(any_density);
        Some(())
    };
    let mut left = 1.0_f64;
    for fibre in &spec.fibres {
        let side = [spec.section.length_mm, spec.section.height_mm];
        let [cosine, sine] = [
            fibre.angle_deg.to_radians().cos().abs(),
            fibre.angle_deg.to_radians().sin().abs(),
        ];
        // from edge to edge through the middle
        let whole = (side[0] / cosine).min(side[1] / sine);
        let length = fibre.length_mm.map_or(whole, |length| length.min(whole));
        let share = (fibre.thickness_mm * length / area).min(left);
        add(&fibre.material, share, fibre.angle_deg, 0.0)?;
        left -= share;
    }
    for ply in &spec.plies {
        let share = left * ply.thickness_mm / spec.section.height_mm;
        add(&ply.material, share, ply.in_plane_angle_deg, ply.angle_deg)?;
    }
    if let Some(matrix) = spec.matrix.as_ref().filter(|_| spec.plies.is_empty()) {
        add(matrix, left, spec.matrix_angle_deg, 0.0)?;
    }
    let along = spec.fibres.first().map_or(0.0, |fibre| fibre.angle_deg);
    let stiffness = laminate(&layers, along);
    (density > 0.0).then_some((stiffness, density))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{JobSpec, Submission};

    fn of(section: &str, supports: &str) -> f64 {
        let body = format!(
            r#"{{"kind": "composite_bending", "spec": {{"version": 1, "section": {section},
            "materials": {{"m": {{"isotropic": {{"youngs_modulus_mpa": 1000, "poisson_ratio": 0.25}}, "density_kg_per_m3": 1000}}}},
            "matrix": "m", "grid": {{"cells": [4, 4]}},
            "test": {{"supports": {supports}, "load": {{"force_n": [0, -1], "on": {{"face": "top"}}}}}}}}}}"#
        );
        let submission = Submission::from_slice(body.as_bytes()).expect("a job");
        let JobSpec::CompositeBending(spec) = submission.spec else {
            panic!("of another kind");
        };
        lowest_per_s(&spec, 1.0).expect("it has constants")
    }

    #[test]
    fn a_slender_cantilever_swings_as_a_beam_and_a_square_one_as_in_shear() {
        let slender =
            r#"{"length_mm": 100, "height_mm": 1, "thickness_mm": 1, "state": "plane_stress"}"#;
        // 3.516 h √(E / 12 ρ) / L², √(E/ρ) = 1e6 mm/s: 101.5; shear takes 0.04 %
        let found = of(slender, r#"{"left": "clamped"}"#);
        assert!((found / 101.5 - 1.0).abs() < 1e-3, "{found}");
        let square =
            r#"{"length_mm": 10, "height_mm": 10, "thickness_mm": 1, "state": "plane_stress"}"#;
        // bending 22.373 · 1e6 / √12 / 10 = 6.46e5; shear π √(5/6 · 0.4) · 1e6 / 10 = 1.814e5; both 1.746e5
        let found = of(square, r#"{"left": "clamped", "right": "clamped"}"#);
        assert!((found / 1.746e5 - 1.0).abs() < 1e-3, "{found}");
    }
}
