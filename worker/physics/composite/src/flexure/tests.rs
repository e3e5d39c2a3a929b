//! Bending tests against the theory of beams and the standards' formulas.
use super::places::shear_through;
use super::*;
use crate::material::Material;
use crate::section::{Division, Ply, Substance};
use crate::tests::{CARBON, isotropic, plain, stacked};

pub(super) fn flexure(loading: Loading, span_mm: f64) -> Flexure {
    Flexure {
        loading,
        span_mm,
        loading_radius_mm: 5.0,
        support_radius_mm: 2.0,
    }
}

/// Round-off of contact forces where the cells' sides differ a hundredfold, and their stiffness a
/// thousandfold in the sandwich.
const ROUND_OFF: f64 = 1e-6;

/// Bends a section in large displacements on equal cells.
pub(super) fn bent_far(
    section: &Section,
    test: Flexure,
    drive: Drive,
    cells: [usize; 2],
) -> FlexureResult {
    let layout = section.layout(Division::Uniform { cells }).unwrap();
    let options = StaticOptions {
        geometry: Geometry::Large,
        ..StaticOptions::default()
    };
    test.bend(section, &Lattice::exact(&layout), drive, &options)
        .unwrap()
}

/// Bends a section by a force on a grid refined at the rollers.
fn bent(section: &Section, test: Flexure, force_n: f64, rows: usize) -> FlexureResult {
    let columns = (2.0 * section.length_mm / section.height_mm).ceil() as usize;
    let graded = Division::Graded {
        cells: [columns, rows],
        across: 2,
    };
    let refinements = test.refinements(section, force_n, 1).unwrap();
    let layout = section
        .layout_refined(graded, &refinements, &Default::default())
        .unwrap();
    let lattice = Lattice::exact(&layout);
    let result = test
        .bend(
            section,
            &lattice,
            Drive::Force(force_n),
            &StaticOptions::default(),
        )
        .unwrap();
    assert!((result.force_n / force_n - 1.0).abs() < ROUND_OFF);
    assert!(result.horizontal_reaction_n.abs() < ROUND_OFF * force_n);
    let up: f64 = result.contact.rollers[..2]
        .iter()
        .map(|roller| roller.force_n)
        .sum();
    assert!(
        (up / force_n - 1.0).abs() < ROUND_OFF,
        "what presses is carried"
    );
    result
}

#[test]
fn slender_beams_deflect_by_timoshenkos_formula() {
    let mut section = plain([70.0, 2.0], isotropic(3_000.0, 0.35), 0.0);
    section.thickness_mm = 15.0;
    // So small that the supports' contacts stay where they are, see below.
    let force = 1.0;
    for (loading, factor) in [(Loading::ThreePoint, 1.5), (Loading::FourPoint, 1.0)] {
        let test = flexure(loading, 60.0);
        let result = bent(&section, test, force, 8);
        let beam = result.beam.unwrap();
        let expected = beam.deflection.total_mm();
        let found = result.midspan_deflection_mm;
        assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
        assert!((result.flexural_modulus_mpa / 3_000.0 - 1.0).abs() < 1e-2);
        let corrected = beam.corrected_modulus_mpa.unwrap();
        assert!((corrected / 3_000.0 - 1.0).abs() < 5e-3, "{corrected}");
        assert!((beam.true_modulus_mpa - 3_000.0).abs() < 1e-8);
        let stress = factor * force * 60.0 / (15.0 * 4.0);
        assert!((result.outer_stress_mpa / stress - 1.0).abs() < ROUND_OFF);
        // Formulas agree with each other: σ_f = E_f ε_f.
        let product = result.flexural_modulus_mpa * result.outer_strain;
        assert!((product / result.outer_stress_mpa - 1.0).abs() < 1e-12);
        assert!((result.span_to_depth - 30.0).abs() < 1e-12);
    }
}

#[test]
fn a_section_that_turns_on_its_supports_touches_them_further_in() {
    let mut section = plain([70.0, 2.0], isotropic(3_000.0, 0.35), 0.0);
    section.thickness_mm = 15.0;
    let test = flexure(Loading::ThreePoint, 60.0);
    let force = 20.0;
    let result = bent(&section, test, force, 8);
    // The slope F L²/(16 EI) times R₂, here 0.3 mm at either end; the span that is left is shorter.
    let beam = result.beam.unwrap().beam;
    let slope = force * 60.0_f64.powi(2) / (16.0 * 3_000.0 * 15.0 * 8.0 / 12.0);
    assert!((test.support_slope(&beam, force) / slope - 1.0).abs() < 1e-12);
    let inward = result.contact.rollers[0].centre_mm - 5.0;
    assert!((inward / (2.0 * slope) - 1.0).abs() < 0.05, "{inward}");
    let left = Flexure {
        span_mm: 60.0 - 2.0 * inward,
        ..test
    };
    // The section sinks against the rollers by what the contact has risen: inward²/(2 R₂) of the
    // circle, and slope times inward of the face.
    let expected = left.timoshenko_deflection(&beam, force).total_mm() + inward * inward / 4.0;
    let found = result.midspan_deflection_mm;
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
}

#[test]
fn a_given_way_of_the_rollers_gives_the_force_of_that_way() {
    let section = plain([50.0, 2.0], isotropic(3_000.0, 0.35), 0.0);
    let lattice = Lattice::exact(
        &section
            .layout(Division::Uniform { cells: [100, 8] })
            .unwrap(),
    );
    let test = flexure(Loading::FourPoint, 40.0);
    let options = StaticOptions::default();
    let by_force = test
        .bend(&section, &lattice, Drive::Force(3.0), &options)
        .unwrap();
    let way = Drive::Advance(by_force.roller_deflection_mm);
    let by_way = test.bend(&section, &lattice, way, &options).unwrap();
    assert!((by_way.force_n / 3.0 - 1.0).abs() < 1e-8);
    // Both loading rollers carry half of it.
    let [left, right] = [2, 3].map(|place| by_way.contact.rollers[place].force_n);
    assert!((left / right - 1.0).abs() < 1e-8);
    // Between them the beam goes on sinking by the circle's arrow M a²/(8 EI), a = L/3, M = F L/6;
    // the rollers' dents make up for little of it.
    let arrow = 0.5 * 40.0 * (40.0_f64 / 3.0).powi(2) / (8.0 * 3_000.0 * 8.0 / 12.0);
    let sunk = by_way.midspan_deflection_mm - by_way.roller_deflection_mm;
    assert!((sunk / arrow - 1.0).abs() < 0.03, "{sunk} {arrow}");
}

#[test]
fn a_cross_ply_bends_and_shears_as_its_layers() {
    for (span, tolerance) in [(80.0, 5e-3), (32.0, 2e-2)] {
        let mut section = stacked(span + 10.0, 2.0, &[0.0, 90.0, 90.0, 0.0]);
        section.thickness_mm = 15.0;
        let result = bent(&section, flexure(Loading::ThreePoint, span), 100.0, 8);
        let beam = result.beam.unwrap();
        let expected = beam.deflection.total_mm();
        let found = result.midspan_deflection_mm;
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{found} {expected}"
        );
        // D₁₁ by hand: E₁ in the outer quarters, E₃ inside.
        let bending = 140_000.0 * 0.875 + 10_000.0 * 0.125;
        assert!((beam.true_modulus_mpa / bending - 1.0).abs() < 1e-12);
        // At 16 depths the formula tells a modulus that is several per cent too low.
        let apparent = result.flexural_modulus_mpa / beam.true_modulus_mpa;
        assert!(span > 40.0 || apparent < 0.95, "{apparent}");
    }
}

#[test]
fn a_sandwich_deflects_by_the_shear_of_its_core() {
    let mut section = plain([340.0, 12.0], isotropic(70_000.0, 0.3), 0.0);
    section.thickness_mm = 30.0;
    section.materials.push(Substance {
        material: isotropic(70.0, 0.3),
        density_kg_per_m3: 60.0,
    });
    let ply = |material, thickness_mm| Ply {
        material,
        thickness_mm,
        angle_deg: 0.0,
        in_plane_angle_deg: 0.0,
    };
    section.plies = vec![ply(0, 1.0), ply(1, 10.0), ply(0, 1.0)];
    let result = bent(&section, flexure(Loading::FourPoint, 300.0), 100.0, 8);
    let beam = result.beam.unwrap();
    let BeamDeflection {
        bending_mm,
        shear_mm,
    } = beam.deflection;
    assert!(shear_mm > bending_mm, "{:?}", beam.deflection);
    // kGA of a thin-faced sandwich, b G d²/c.
    let sandwich = 30.0 * (70.0 / 2.6) * 121.0 / 10.0;
    assert!((beam.beam.shear_n / sandwich - 1.0).abs() < 0.01);
    let ratio = result.midspan_deflection_mm / beam.deflection.total_mm();
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

/// Largest shear stress halfway between the rollers over what ISO 14130 makes of the force.
fn shear_ratio(material: Material, span: f64) -> f64 {
    let mut section = plain([2.0 * span, 2.0], material, 0.0);
    section.thickness_mm = 10.0;
    let test = flexure(Loading::ThreePoint, span);
    let graded = Division::Graded {
        cells: [(2.0 * span) as usize, 20],
        across: 1,
    };
    let force = 20.0;
    let refinements = test.refinements(&section, force, 2).unwrap();
    let layout = section
        .layout_refined(graded, &refinements, &Default::default())
        .unwrap();
    let lattice = Lattice::exact(&layout);
    let options = StaticOptions::default();
    let result = test
        .bend(&section, &lattice, Drive::Force(force), &options)
        .unwrap();
    let apparent = result.apparent_shear_stress_mpa.unwrap();
    assert!((apparent / (3.0 * force / (4.0 * 10.0 * 2.0)) - 1.0).abs() < ROUND_OFF);
    // Whatever their distribution, the stresses carry half the force.
    let u = &result.contact.equilibrium.displacements_mm;
    let carried: f64 = shear_through(&lattice, Geometry::Linear, 0.75 * span, u)
        .iter()
        .map(|(height, stress)| height * stress)
        .sum();
    assert!(
        (-carried * 10.0 / (0.5 * force) - 1.0).abs() < ROUND_OFF,
        "{carried}"
    );
    result.shear_stress_mpa.unwrap() / apparent
}

/// The same ratio at mid-height of a long orthotropic strip under concentrated forces.
///
/// Airy's function Σ f(y) cos kx with S₁₁ f'''' - (2 S₁₂ + S₆₆) k² f'' + S₂₂ k⁴ f = 0, so f is made of
/// exp(± β k y) with S₁₁ β⁴ - (2 S₁₂ + S₆₆) β² + S₂₂ = 0; σ_yy = -k² f cos kx on the faces is the
/// forces' series over a period four spans long, σ_xy = k f' sin kx is 0 there.
fn strip_shear_ratio(stiffness: &crate::stiffness::Stiffness, h: f64, span: f64) -> f64 {
    use nalgebra::{Matrix4, Vector4};
    let s = crate::stiffness::compliance(stiffness);
    let (first, middle, last) = (s[(0, 0)], 2.0 * s[(0, 1)] + s[(2, 2)], s[(1, 1)]);
    let root = (middle * middle - 4.0 * first * last).sqrt();
    let [fast, slow] = [root, -root].map(|root| ((middle + root) / (2.0 * first)).sqrt());
    let (period, x) = (4.0 * span, 0.25 * span);
    let mut shear = 0.0;
    for term in 1..400 {
        let k = std::f64::consts::TAU * f64::from(term) / period;
        let top = 2.0 / period / (k * k);
        let bottom = top * (0.5 * k * span).cos();
        // Each falls off from one face: exponent, and where it starts.
        let parts = [(fast, 0.5), (slow, 0.5), (-fast, -0.5), (-slow, -0.5)];
        let value = |(beta, from): (f64, f64), y: f64| (beta * k * (y - from * h)).exp();
        let matrix = Matrix4::from_fn(|row, column| {
            let part = parts[column];
            let y = if row % 2 == 0 { 0.5 * h } else { -0.5 * h };
            let slope = if row < 2 { 1.0 } else { part.0 };
            slope * value(part, y)
        });
        let weights = matrix
            .lu()
            .solve(&Vector4::new(top, bottom, 0.0, 0.0))
            .unwrap();
        for (part, weight) in parts.into_iter().zip(weights.iter()) {
            shear += weight * part.0 * k * value(part, 0.0) * k * (k * x).sin();
        }
    }
    shear.abs() / (0.75 / h)
}

#[test]
fn the_short_beams_formula_holds_far_from_rollers_only() {
    // Five depths between supports. Isotropic, what the rollers disturb has died away halfway.
    let isotropic = shear_ratio(isotropic(3_000.0, 0.35), 10.0);
    assert!((isotropic - 1.0).abs() < 5e-3, "{isotropic}");
    // Along fibres it dies away √(E₁/G₁₂) = 5 times more slowly: halfway the stress is flatter than
    // the parabola, by a twentieth, and has its form only on a far longer span.
    let (stiffness, _) = CARBON
        .stiffness(crate::material::PlaneState::Stress)
        .unwrap();
    for (span, least, most) in [(10.0, 0.94, 0.96), (60.0, 0.995, 1.005)] {
        let expected = strip_shear_ratio(&stiffness, 2.0, span);
        assert!((least..most).contains(&expected), "{expected}");
        let found = shear_ratio(CARBON, span);
        assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    }
}

#[test]
fn tests_that_cannot_be_set_up_are_refused() {
    let section = plain([50.0, 2.0], isotropic(3_000.0, 0.35), 0.0);
    let lattice = Lattice::exact(
        &section
            .layout(Division::Uniform { cells: [50, 4] })
            .unwrap(),
    );
    let refused = |test: Flexure, drive| {
        test.bend(&section, &lattice, drive, &StaticOptions::default())
            .unwrap_err()
            .to_string()
    };
    let good = flexure(Loading::ThreePoint, 40.0);
    let force = Drive::Force(1.0);
    for span in [50.0, 60.0, 0.0, f64::NAN] {
        let told = refused(flexure(Loading::ThreePoint, span), force);
        assert!(told.contains("the span"), "{told}");
    }
    assert!(refused(flexure(Loading::ThreePoint, 3.0), force).contains("overlap"));
    // Thirds of 24 mm are 8 mm apart, less than two radii of 5 mm.
    assert!(refused(flexure(Loading::FourPoint, 24.0), force).contains("overlap"));
    let flat = Flexure {
        support_radius_mm: 0.0,
        ..good
    };
    assert!(refused(flat, force).contains("supporting roller's radius"));
    assert!(refused(good, Drive::Force(0.0)).contains("force"));
    assert!(refused(good, Drive::Advance(-1.0)).contains("way of the rollers"));
    // A support in the last cell: its contact reaches the end.
    assert!(refused(flexure(Loading::ThreePoint, 49.8), force).contains("overhang"));
}
