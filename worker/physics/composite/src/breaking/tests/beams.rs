//! Cracks that grow, against the energy release rate of beams.
use super::*;
use crate::section::Fibre;
use crate::tests::{isotropic, orthotropic, plain};

pub(super) const MODULUS: f64 = 10_000.0;
pub(super) const ARM_MM: f64 = 2.25;
pub(super) const LENGTH_MM: f64 = 24.0;
pub(super) const NOTCH_MM: f64 = 10.0;
pub(super) const STRENGTH: f64 = 30.0;
pub(super) const ENERGY: f64 = 0.2;

/// A double cantilever beam of an odd number of rows, the middle one of which cracks. It is notched at
/// the left, where the arms are pulled apart, and built in at the right. A cracked row still bears
/// along the beam, half of it with each arm; so does the notch.
fn double_cantilever(rows: usize, teeth: u32) -> Case {
    let height = 2.0 * ARM_MM;
    let row = height / rows as f64;
    let mut section = plain([LENGTH_MM, height], isotropic(MODULUS, 0.3), 0.0);
    let (mut second, mut third) = (section.materials[0], section.materials[0]);
    // the same elasticity, but it cracks along the beam only: ahead of the tip the stress along the
    // beam is larger than the one across it, and would crack it too
    second.material = orthotropic(MODULUS, MODULUS, 0.3, Some(MODULUS / 2.6));
    third.material = orthotropic(MODULUS, 1e-6 * MODULUS, 0.0, Some(1e-6 * MODULUS));
    section.materials.extend([second, third]);
    let band = |material, from: f64, to: f64| Fibre {
        material,
        through_mm: [0.5 * (from + to), 0.5 * height],
        angle_deg: 0.0,
        thickness_mm: row,
        length_mm: Some(to - from),
    };
    section.fibres = vec![band(2, 0.0, NOTCH_MM), band(1, NOTCH_MM, LENGTH_MM)];
    let columns = (LENGTH_MM / row / 12.0).round() as usize * 12;
    let cells = [columns, rows];
    let layout = section.layout(Division::Uniform { cells }).unwrap();
    let grid = layout.grid();
    let mut supports = Supports::of_faces(grid, &[(Face::Right, FaceSupport::Clamped)]).unwrap();
    let quarter = rows / 4;
    for (line, way) in [(quarter, -1.0), (rows - quarter, 1.0)] {
        supports.hold(grid, grid.particle(0, line), 1, way).unwrap();
    }
    let load_n = vec![0.0; 2 * grid.particles()];
    let across = MaterialStrength {
        bulk: Strength {
            across_tension: tough(STRENGTH, ENERGY),
            ..Strength::default()
        },
        interface: None,
    };
    let strengths = vec![UNBREAKABLE, across, UNBREAKABLE];
    let mut options = BreakingOptions {
        teeth,
        ..BreakingOptions::default()
    };
    options.stop.displacement_mm = Some(1.0);
    Case {
        layout,
        supports,
        load_n,
        strengths,
        options,
        between_plies: BetweenPlies::default(),
    }
}

/// Length of the arms [mm] and energy release rate [N/mm] of a point on the path: Timoshenko's beams,
/// w = P a³/(3 E I) + P a/(κ G A) each, and G b = P² a²/(E I) + P²/(κ G A) of both [Williams1989].
/// The length is that of the compliance, root rotation included.
pub(super) fn release_rate(event: &Event) -> [f64; 2] {
    // the drive's displacement is that of both arms
    let (pull, way) = (event.force_n, 0.5 * event.displacement_mm);
    let bending = MODULUS * ARM_MM.powi(3) / 12.0;
    let shear = 5.0 / 6.0 * MODULUS / 2.6 * ARM_MM;
    let mut length = (3.0 * bending * way / pull).cbrt();
    for _ in 0..50 {
        let value = pull * (length.powi(3) / (3.0 * bending) + length / shear) - way;
        length -= value / (pull * (length * length / bending + 1.0 / shear));
    }
    let rate = pull * pull * (length * length / bending + 1.0 / shear);
    [length, rate]
}

/// The process zone is l = E G / f² = 2.2 mm long. Measured, mean release rate over G while the crack
/// grows by 6 mm: 1.229, 1.173, 1.108, 1.085 with cells of l/3.5, l/4.4, l/6.4, l/8.4: what a coarse
/// cell stores in the gradient of its opening breaks with it, an error in proportion to its size
/// (0.8 h/l), as ten or thirty teeth show alike. Linearly extrapolated it is 0.99.
#[test]
fn a_double_cantilever_beam_splits_at_its_fracture_energy_as_the_grid_grows_finer() {
    let mut found = Vec::new();
    for rows in [7, 9, 13] {
        let case = double_cantilever(rows, 10);
        let mut breaking = case.breaking();
        let (events, reason) = broken(&mut breaking);
        assert_eq!(reason, EndReason::Displacement);
        // where the crack has grown far from the notch and is far from the end
        let rates: Vec<f64> = events
            .iter()
            .map(release_rate)
            .filter(|[length, _]| (14.0..20.0).contains(length))
            .map(|[_, rate]| rate / ENERGY)
            .collect();
        let mean = rates.iter().sum::<f64>() / rates.len() as f64;
        let coarseness = breaking.totals().coarseness;
        let expected = 2.0 * ARM_MM / rows as f64 / (MODULUS * ENERGY / STRENGTH.powi(2));
        assert!(
            (coarseness / expected - 1.0).abs() < 1e-9,
            "{coarseness} {expected}"
        );
        assert!((mean - 1.0).abs() < coarseness, "{rows} {mean}");
        assert!(imbalance(&events) < BALANCE, "{}", imbalance(&events));
        found.push([coarseness, mean]);
    }
    assert!(
        found.windows(2).all(|pair| pair[1][1] < pair[0][1]),
        "{found:?}"
    );
    // of the straight line through the finest and the coarsest
    let slope = (found[0][1] - found[2][1]) / (found[0][0] - found[2][0]);
    let limit = found[2][1] - slope * found[2][0];
    assert!((limit - 1.0).abs() < 0.05, "{limit}");
}
