//! Large deflections on rollers against the elastica.
use super::tests::{bent_far, flexure};
use super::*;
use crate::section::Division;
use crate::tests::{isotropic, plain};

/// Three-point bending of an inextensible, shear-free beam on round supports without friction.
///
/// With the slope α at the contacts, whose force N is normal to the beam there, and φ = α - θ along
/// the beam from a contact to midspan: ½ EI θ'² = N sin φ, so that
///
/// x = √(EI/2N) ∫ cos(α - φ)/√(sin φ) dφ,  y = √(EI/2N) ∫ sin(α - φ)/√(sin φ) dφ,  φ from 0 to α
///
/// The beam's axis lies ρ = R₂ + h/2 from a support's, along the normal: L/2 = x + ρ sin α, and
/// midspan sinks by y + ρ (1 - cos α). F = 2 N cos α.
struct Elastica {
    force_n: f64,
    midspan_mm: f64,
    moment_n_mm: f64,
}

fn elastica(bending_n_mm2: f64, span_mm: f64, rho_mm: f64, slope: f64) -> Elastica {
    // φ = t² takes the root's singularity away; the midpoint rule then converges as its square
    const PARTS: usize = 20_000;
    let step = slope.sqrt() / PARTS as f64;
    let (mut x, mut y) = (0.0, 0.0);
    for part in 0..PARTS {
        let t = (part as f64 + 0.5) * step;
        let phi = t * t;
        let weight = 2.0 * t / phi.sin().sqrt() * step;
        x += weight * (slope - phi).cos();
        y += weight * (slope - phi).sin();
    }
    let length = (0.5 * span_mm - rho_mm * slope.sin()) / x;
    let normal_n = 0.5 * bending_n_mm2 / (length * length);
    Elastica {
        force_n: 2.0 * normal_n * slope.cos(),
        midspan_mm: length * y + rho_mm * (1.0 - slope.cos()),
        moment_n_mm: (2.0 * bending_n_mm2 * normal_n * slope.sin()).sqrt(),
    }
}

#[test]
fn the_elastica_is_the_beam_where_deflections_are_small() {
    // s = F L³/(48 EI), α = F L²/(16 EI), M = F L/4
    let found = elastica(100.0, 60.0, 3.0, 1e-4);
    let force = 1e-4 * 16.0 * 100.0 / 3600.0;
    assert!((found.force_n / force - 1.0).abs() < 1e-4);
    assert!((found.midspan_mm / (force * 60.0_f64.powi(3) / 4_800.0) - 1.0).abs() < 1e-4);
    assert!((found.moment_n_mm / (15.0 * force) - 1.0).abs() < 1e-4);
}

#[test]
fn the_standards_corrections_follow_the_elastica_on_edges() {
    // supports of no radius, as the corrections have them: ρ = h/2
    let (e, b, h, span) = (3_000.0, 15.0, 1.0, 60.0);
    let bending = e * b * h * h * h / 12.0;
    for slope in [0.15, 0.3, 0.45] {
        let found = elastica(bending, span, 0.5 * h, slope);
        let stress = 6.0 * found.moment_n_mm / (b * h * h);
        let test = Loading::ThreePoint;
        let corrected = test.outer_stress_far(span, [b, h], found.force_n, found.midspan_mm);
        let strain = test.outer_strain_far(span, h, found.midspan_mm);
        let plain = test.outer_stress(span, [b, h], found.force_n);
        assert!(
            (corrected / stress - 1.0).abs() < 0.01,
            "{slope}: {corrected} {stress}"
        );
        assert!(
            (strain * e / stress - 1.0).abs() < 0.02,
            "{slope}: {strain} {stress}"
        );
        // without them the stress is far off where slopes are large
        assert!(
            slope < 0.4 || (plain / stress - 1.0).abs() > 0.08,
            "{plain} {stress}"
        );
    }
}

/// Round-off aside, what is left is the shear of the beam, which the elastica does not have:
/// 12 EI/(kGA L²) = 2.4 (h/L)² = 7e-4 of the deflection, and what the rollers dent.
const SHEARED: f64 = 3e-3;

#[test]
fn three_point_bending_follows_the_elastica_far_beyond_small_displacements() {
    let mut section = plain([90.0, 1.0], isotropic(3_000.0, 0.0), 0.0);
    section.thickness_mm = 15.0;
    let test = flexure(Loading::ThreePoint, 60.0);
    let bending = 3_000.0 * 15.0 / 12.0;
    // deflections of a tenth and of a sixth of the span; measured, off by 6e-4 at the first
    for slope in [0.3, 0.5] {
        let expected = elastica(bending, 60.0, test.support_radius_mm + 0.5, slope);
        let found = bent_far(&section, test, Drive::Force(expected.force_n), [120, 2]);
        let deflection = found.midspan_deflection_mm;
        assert!((found.force_n / expected.force_n - 1.0).abs() < 1e-6);
        assert!(
            (deflection / expected.midspan_mm - 1.0).abs() < SHEARED,
            "{deflection} {}",
            expected.midspan_mm
        );
        // the beam of small displacements would bend less far
        let small = found.beam.unwrap().deflection.total_mm();
        assert!((small / deflection - 1.0).abs() > 0.03, "{small}");
        // the supports push inwards, against each other, along their normals
        assert!(found.contact.equilibrium.reaction_error < 1e-7);
        assert!(found.horizontal_reaction_n.abs() < 1e-6 * found.force_n);
    }
    // by the way also beyond the largest force, where the specimen slips through
    let largest = elastica(bending, 60.0, test.support_radius_mm + 0.5, 0.65).force_n;
    let expected = elastica(bending, 60.0, test.support_radius_mm + 0.5, 0.8);
    assert!(expected.force_n < 0.99 * largest);
    let found = bent_far(
        &section,
        test,
        Drive::Advance(expected.midspan_mm),
        [120, 2],
    );
    let share = found.force_n / expected.force_n;
    assert!((share - 1.0).abs() < SHEARED, "{share}");
    let share = found.midspan_deflection_mm / expected.midspan_mm;
    assert!((share - 1.0).abs() < SHEARED, "{share}");
}

#[test]
fn a_beam_that_slips_through_bears_no_larger_force() {
    // the elastica's force over its slope is largest near 0.75 for long spans
    let mut section = plain([120.0, 1.0], isotropic(3_000.0, 0.0), 0.0);
    section.thickness_mm = 15.0;
    let test = flexure(Loading::ThreePoint, 60.0);
    let bending = 3_000.0 * 15.0 / 12.0;
    let largest = (1..120)
        .map(|step| elastica(bending, 60.0, 2.5, 0.01 * f64::from(step)).force_n)
        .fold(0.0, f64::max);
    let options = StaticOptions {
        geometry: Geometry::Large,
        ..StaticOptions::default()
    };
    let layout = section
        .layout(crate::section::Division::Uniform { cells: [120, 1] })
        .unwrap();
    let lattice = Lattice::exact(&layout);
    let drive = Drive::Force(1.05 * largest);
    let found = test.bend(&section, &lattice, drive, &options);
    assert!(
        matches!(found, Err(CompositeError::SlipsThrough { largest_n, .. })
            if (largest_n / largest - 1.0).abs() < 0.02),
        "{largest} {found:?}"
    );
}

#[test]
fn small_deflections_are_those_of_small_displacements() {
    // so small that rotations do not count: what is left is where the contacts lie on their segments
    let mut section = plain([70.0, 2.0], isotropic(3_000.0, 0.35), 0.0);
    section.thickness_mm = 15.0;
    for loading in [Loading::ThreePoint, Loading::FourPoint] {
        let test = flexure(loading, 60.0);
        let drive = Drive::Force(0.05);
        let far = bent_far(&section, test, drive, [140, 4]);
        let layout = section
            .layout(crate::section::Division::Uniform { cells: [140, 4] })
            .unwrap();
        let lattice = Lattice::exact(&layout);
        let near = test
            .bend(&section, &lattice, drive, &StaticOptions::default())
            .unwrap();
        let ratio = far.midspan_deflection_mm / near.midspan_deflection_mm;
        assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
        assert!((far.outer_stress_mpa / near.outer_stress_mpa - 1.0).abs() < 1e-6);
        let corrected = far.far.unwrap().outer_stress_mpa;
        assert!((corrected / far.outer_stress_mpa - 1.0).abs() < 1e-3);
    }
}

/// Round-off of displacements of half of the span, times the stiffness of cells, is more than 1e-9 of the
/// rollers' force: no iteration makes less of it. And a strip that has gone so far that an end of it lies on
/// a support slips through a little later, where no more rest is found.
#[test]
fn rollers_go_as_far_as_half_of_the_span_and_say_when_the_strip_slips_through() {
    let mut section = plain([120.0, 2.0], isotropic(40_000.0, 0.0), 0.0);
    section.thickness_mm = 15.0;
    let test = flexure(Loading::ThreePoint, 40.0);
    let found = bent_far(&section, test, Drive::Advance(20.0), [120, 4]);
    let rest = &found.contact.equilibrium;
    assert!(rest.residual < 1e-8, "{}", rest.residual);
    assert!(rest.reaction_error < 1e-8, "{}", rest.reaction_error);
    section.length_mm = 60.0;
    let layout = section.layout(Division::Uniform { cells: [60, 2] });
    let options = StaticOptions {
        geometry: Geometry::Large,
        ..StaticOptions::default()
    };
    let lattice = Lattice::exact(&layout.unwrap());
    let refused = test.bend(&section, &lattice, Drive::Advance(30.0), &options);
    let told = refused.unwrap_err().to_string();
    assert!(told.contains("reaches a support"), "{told}");
}
