//! What a tube does as a body: pulled, twisted, bent and pushed, read off as one reads a specimen.
//!
//! Constants are those of the wall's area and moments: E = F/(A ε), G = T/(J ϑ'). Strains, twist and
//! curvature are slopes of ring averages over the middle half of the tube, away from its ends.
use std::f64::consts::PI;

use super::equilibrium::{self, Buckling, Rest, Supports, small};
use super::{Divided, Elasticity, Section, Tube, TubeError};

/// Segments of the tube whose constants are measured; more change the bending stiffness by less than
/// 10⁻⁴, for what the ends do dies out within a few.
const MEASURED_SEGMENTS: usize = 40;
/// A strain, twist and curvature that is small; of linear equations any would do.
const SMALL: f64 = 1e-6;

/// How the rings at the ends are held in a pull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// Moved along x only.
    FreeToContract,
    /// Glued: no point of them moves but along x.
    Held,
}

/// Constants of a tube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// E [GPa].
    pub axial_modulus_gpa: f64,
    /// ν [-].
    pub poisson_ratio: f64,
    /// G [GPa].
    pub shear_modulus_gpa: f64,
    /// E I [mN µm²]; 1 mN µm² is 10⁻¹⁵ N m².
    pub bending_stiffness_mn_um2: f64,
    /// Largest unbalanced force over the largest force of a spring, in the three tests.
    pub residual: f64,
}

/// A tube pushed until it buckles, pinned at both ends.
#[derive(Debug, Clone)]
pub struct Pushed {
    /// Force between the ends at which it buckles [mN].
    pub load_mn: f64,
    pub buckling: Buckling,
    /// Rest under a force of 1 mN.
    pub prestress: Rest,
}

/// Constants of the wall as a straight tube of 40 segments shows them.
///
/// # Errors
/// Those of the equations.
pub fn constants(divided: &Divided, section: &Section) -> Result<Constants, TubeError> {
    let tube = Tube::straight(MEASURED_SEGMENTS, &divided.segment, &divided.springs);
    constants_of(&tube, section)
}

/// The same of a given straight tube.
///
/// # Errors
/// Those of the equations.
pub fn constants_of(tube: &Tube, section: &Section) -> Result<Constants, TubeError> {
    let (pulled, pulled_rest) = pull(tube, SMALL, Ends::FreeToContract)?;
    let (torque, twisted) = twist(tube, SMALL / tube.segment().diameter_um())?;
    let (moment, bent) = bend(tube, SMALL / tube.segment().diameter_um())?;
    let (strain, contraction) = strains(tube, &pulled_rest);
    let rest = [&pulled_rest, &twisted, &bent];
    Ok(Constants {
        axial_modulus_gpa: pulled / (section.area_um2() * strain),
        poisson_ratio: contraction / strain,
        shear_modulus_gpa: torque / (section.polar_um4() * twist_rate(tube, &twisted)),
        bending_stiffness_mn_um2: moment / curvature(tube, &bent),
        residual: rest.iter().fold(0.0, |most, rest| most.max(rest.residual)),
    })
}

/// Pulls a straight tube by a strain; force [mN] and rest.
///
/// # Errors
/// Those of the equations.
pub fn pull(tube: &Tube, strain: f64, ends: Ends) -> Result<(f64, Rest), TubeError> {
    let last = tube.segments();
    let mut supports = held_against_motion(tube);
    let across = match ends {
        Ends::FreeToContract => None,
        Ends::Held => Some(0.0),
    };
    for (ring, by) in [(0, 0.0), (last, strain * tube.length_um())] {
        match ends {
            Ends::FreeToContract => supports.move_ring(tube, ring, |_| [Some(by), None, None]),
            Ends::Held => supports.move_ring(tube, ring, |_| [Some(by), across, across]),
        }
    }
    let rest = small(tube, &supports)?;
    Ok((
        sum_of(tube, &rest.reactions_mn, last, |_, force| force[0]),
        rest,
    ))
}

/// Twists a straight tube by an angle over length [1/µm]; torque [mN µm] and rest.
///
/// # Errors
/// Those of the equations.
pub fn twist(tube: &Tube, rate_per_um: f64) -> Result<(f64, Rest), TubeError> {
    let last = tube.segments();
    let angle = rate_per_um * tube.length_um();
    let mut supports = Supports::none(tube);
    for (ring, angle) in [(0, 0.0), (last, angle)] {
        supports.move_ring(tube, ring, |[_, y, z]| {
            [Some(0.0), Some(-angle * z), Some(angle * y)]
        });
    }
    let rest = small(tube, &supports)?;
    let torque = sum_of(tube, &rest.reactions_mn, last, |[_, y, z], [_, fy, fz]| {
        y * fz - z * fy
    });
    Ok((torque, rest))
}

/// Bends a straight tube by turning its end rings, which are free to change their shape otherwise:
/// pure bending by a curvature [1/µm]; moment about z [mN µm] and rest.
///
/// # Errors
/// Those of the equations.
pub fn bend(tube: &Tube, curvature_per_um: f64) -> Result<(f64, Rest), TubeError> {
    let last = tube.segments();
    let half = 0.5 * curvature_per_um * tube.length_um();
    let mut supports = held_against_motion(tube);
    for (ring, angle) in [(0, -half), (last, half)] {
        supports.move_ring(tube, ring, |[_, y, _]| [Some(-angle * y), None, None]);
    }
    let rest = small(tube, &supports)?;
    let moment = sum_of(tube, &rest.reactions_mn, last, |[_, y, _], [fx, ..]| {
        -y * fx
    });
    Ok((moment, rest))
}

/// Loads a straight tube, glued at its first ring, by a force across at its last: deflection of that
/// ring's centre [µm] under a force of 1 mN, shared by its points, and rest.
///
/// # Errors
/// Those of the equations.
pub fn cantilever(tube: &Tube) -> Result<(f64, Rest), TubeError> {
    let last = tube.segments();
    let mut supports = Supports::none(tube);
    supports.move_ring(tube, 0, |_| [Some(0.0); 3]);
    // all points of the last ring move alike across: the force is what this takes
    supports.move_ring(tube, last, |_| [None, Some(SMALL), None]);
    let rest = small(tube, &supports)?;
    let force = sum_of(tube, &rest.reactions_mn, last, |_, force| force[1]);
    Ok((SMALL / force, rest))
}

/// Pushes a straight tube, whose end rings are pinned at their centres, until it buckles.
///
/// # Errors
/// Those of the equations, and [`TubeError::NoBuckling`].
pub fn push(tube: &Tube) -> Result<Pushed, TubeError> {
    let (force, mut prestress) = pull(tube, -SMALL, Ends::FreeToContract)?;
    let per_mn = 1.0 / force.abs();
    let all = [
        &mut prestress.displacements_um,
        &mut prestress.reactions_mn,
        &mut prestress.tensions_mn,
    ];
    for value in all.into_iter().flatten() {
        *value *= per_mn;
    }
    let last = tube.segments();
    let mut supports = Supports::none(tube);
    for ring in [0, last] {
        supports.move_ring(tube, ring, |_| [None, Some(0.0), Some(0.0)]);
    }
    // nothing pushes along x, so that one point may hold the tube there
    supports.move_point(0, 0, 0.0);
    let mut start = vec![0.0; prestress.displacements_um.len()];
    for ring in 1..last {
        for point in tube.ring(ring) {
            start[3 * point + 1] = (PI * ring as f64 / last as f64).sin();
        }
    }
    let buckling = equilibrium::buckling(tube, &supports, &prestress, &start)?;
    Ok(Pushed {
        load_mn: buckling.factor,
        buckling,
        prestress,
    })
}

/// Load [mN] at which a pinned column of stiffness E I [mN µm²] and length [µm] buckles, by Euler, and
/// with the shear stiffness κ G A [mN] by [Engesser1891]: P = P_E/(1 + P_E/(κ G A)).
pub fn column_load_mn(
    bending_stiffness_mn_um2: f64,
    length_um: f64,
    shear_stiffness_mn: Option<f64>,
) -> f64 {
    let euler = PI.powi(2) * bending_stiffness_mn_um2 / length_um.powi(2);
    shear_stiffness_mn.map_or(euler, |shear| euler / (1.0 + euler / shear))
}

/// κ G A [mN] of a thin round tube, κ = 2 (1 + ν)/(4 + 3 ν) [Cowper1966].
pub fn shear_stiffness_mn(
    section: &Section,
    elasticity: &Elasticity,
    shear_modulus_gpa: f64,
) -> f64 {
    let nu = elasticity.poisson_ratio();
    2.0 * (1.0 + nu) / (4.0 + 3.0 * nu) * shear_modulus_gpa * section.area_um2()
}

/// What of a rigid motion the load along x leaves free: two translations and a turn about x. No force
/// acts on these holds, and so they change nothing.
fn held_against_motion(tube: &Tube) -> Supports {
    let mut supports = Supports::none(tube);
    supports.move_point(0, 1, 0.0);
    supports.move_point(0, 2, 0.0);
    supports.move_point(tube.segment().points_on_ring() / 2, 2, 0.0);
    supports
}

/// Sum over a ring of something of places and vectors.
fn sum_of(
    tube: &Tube,
    vectors: &[f64],
    ring: usize,
    of: impl Fn([f64; 3], [f64; 3]) -> f64,
) -> f64 {
    let vectors = vectors.as_chunks::<3>().0;
    tube.ring(ring)
        .map(|point| of(tube.places_um()[point], vectors[point]))
        .sum()
}

/// Slope over x of a ring's value between the rings at a quarter and at three quarters.
fn slope(tube: &Tube, value: impl Fn(usize) -> f64) -> f64 {
    let (from, to) = middle(tube);
    (value(to) - value(from)) / ((to - from) as f64 * tube.segment().length_um())
}

/// Rings that bound the middle half.
fn middle(tube: &Tube) -> (usize, usize) {
    let segments = tube.segments();
    (segments / 4, segments - segments / 4)
}

/// Axial strain, and contraction of the rings' radius over it, in the middle half.
fn strains(tube: &Tube, rest: &Rest) -> (f64, f64) {
    let count = tube.segment().points_on_ring() as f64;
    let radius = tube.segment().diameter_um() / 2.0;
    let along = slope(tube, |ring| {
        sum_of(tube, &rest.displacements_um, ring, |_, [x, ..]| x) / count
    });
    let (from, to) = middle(tube);
    let mut contraction = 0.0;
    for ring in from..=to {
        // about the ring's own centre, which the holds let move
        let outward = |[_, y, z]: [f64; 3], [_, uy, uz]: [f64; 3]| (y * uy + z * uz) / radius;
        contraction -= sum_of(tube, &rest.displacements_um, ring, outward) / (count * radius);
    }
    (along, contraction / (to - from + 1) as f64)
}

/// Turn of the rings about x over length [1/µm].
fn twist_rate(tube: &Tube, rest: &Rest) -> f64 {
    let squares =
        tube.segment().points_on_ring() as f64 * (tube.segment().diameter_um() / 2.0).powi(2);
    slope(tube, |ring| {
        let turn = |[_, y, z]: [f64; 3], [_, uy, uz]: [f64; 3]| y * uz - z * uy;
        sum_of(tube, &rest.displacements_um, ring, turn) / squares
    })
}

/// Turn of the rings about z over length [1/µm].
fn curvature(tube: &Tube, rest: &Rest) -> f64 {
    let squares =
        0.5 * tube.segment().points_on_ring() as f64 * (tube.segment().diameter_um() / 2.0).powi(2);
    slope(tube, |ring| {
        sum_of(tube, &rest.displacements_um, ring, |[_, y, _], [ux, ..]| {
            -y * ux
        }) / squares
    })
}
