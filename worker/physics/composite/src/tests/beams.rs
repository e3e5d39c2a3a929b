//! Beams against Timoshenko's formulas, moduli against Voigt's and the laminate's.
use super::sections::{
    clamped_sides, forces, isotropic, orthotropic, papers, plain, pressed, uniform,
};
use crate::error::CompositeError;
use crate::lattice::{BondPattern, BondStiffness, Geometry, Lattice, PaperRule, Tangent};
use crate::load::LoadPlace;
use crate::measure::{face_force_n, face_mean_mm, point_mm};
use crate::section::Division;
use crate::solve::multigrid::Multigrid;
use crate::solve::{StaticOptions, equilibrium};
use crate::supports::{Face, FaceSupport, Supports};

/// Tip deflection of a cantilever whose root section is held as Timoshenko's solution has it, the
/// tip sheared by its parabolic stress: exact in plane stress, so that only the lattice errs.
///
/// u_x = -P y/(6EI) [(6L - 3x) x + (2 + ν)(y² - h²/4)],
/// u_y = P/(6EI) [3 ν y² (L - x) + (4 + 5ν) h² x / 4 + (3L - x) x²] with y from the middle.
/// Source: [TimoshenkoGoodier1970], art. 21, as written in [AugardeDeeks2008].
fn tip_error(cells: [usize; 2]) -> f64 {
    let (e, nu, length, height, p) = (1_000.0, 0.3, 8.0, 2.0, -1.0);
    let lattice = uniform(&plain([length, height], isotropic(e, nu), 0.0), cells);
    let grid = lattice.grid();
    let inertia = height.powi(3) / 12.0;
    let exact = |x: f64, y: f64| {
        let scale = p / (6.0 * e * inertia);
        [
            -scale
                * y
                * ((6.0 * length - 3.0 * x) * x + (2.0 + nu) * (y * y - height * height / 4.0)),
            scale
                * (3.0 * nu * y * y * (length - x)
                    + (4.0 + 5.0 * nu) * height * height * x / 4.0
                    + (3.0 * length - x) * x * x),
        ]
    };
    let mut supports = Supports::none(grid);
    let mut load = vec![0.0; lattice.displacements()];
    for line in 0..grid.y_mm().len() {
        let y = grid.y_mm()[line] - height / 2.0;
        let root = Face::Left.particle(grid, line);
        let at_root = exact(0.0, y);
        supports.hold(grid, root, 0, at_root[0]).unwrap();
        supports.hold(grid, root, 1, at_root[1]).unwrap();
    }
    // Consistent forces of τ = P/(2I) (h²/4 - y²): by Simpson's rule exact for cubics.
    for line in 0..grid.rows() {
        let (y0, y1) = (
            grid.y_mm()[line] - height / 2.0,
            grid.y_mm()[line + 1] - height / 2.0,
        );
        let shear = |y: f64| p / (2.0 * inertia) * (height * height / 4.0 - y * y);
        let (step, middle) = (y1 - y0, shear(0.5 * (y0 + y1)));
        let lower = Face::Right.particle(grid, line);
        let upper = Face::Right.particle(grid, line + 1);
        load[2 * lower + 1] += step / 6.0 * (shear(y0) + 2.0 * middle);
        load[2 * upper + 1] += step / 6.0 * (shear(y1) + 2.0 * middle);
    }
    let rest = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
    let tip = point_mm(grid, [length, height / 2.0], &rest.displacements_mm).unwrap()[1];
    assert!(rest.residual < 1e-11);
    (tip / exact(length, 0.0)[1] - 1.0).abs()
}

#[test]
fn a_cantilever_converges_to_timoshenkos_with_order_two() {
    let errors: Vec<f64> = [2, 4, 8, 16]
        .iter()
        .map(|&rows| tip_error([4 * rows, rows]))
        .collect();
    assert!(errors[0] < 5e-3, "two cells through the height: {errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.4).contains(&order), "{errors:?}");
    }
}

#[test]
fn a_clamped_strip_deflects_as_the_beam_formula_says() {
    // Slender: what the clamps do to the ends of the stress is a small part.
    let (e, length, height, force) = (1_000.0, 100.0, 4.0, -1.0);
    let lattice = uniform(&plain([length, height], isotropic(e, 0.3), 0.0), [200, 8]);
    let load = forces(&lattice, [0.0, force], LoadPlace::Face(Face::Top));
    let rest = equilibrium(
        &lattice,
        &clamped_sides(&lattice),
        &load,
        &StaticOptions::default(),
    )
    .unwrap();
    let middle = point_mm(lattice.grid(), [length / 2.0, 2.0], &rest.displacements_mm).unwrap()[1];
    let inertia = height.powi(3) / 12.0;
    let shear = 5.0 / 6.0 * e / 2.6 * height;
    let beam = force * length.powi(3) / (384.0 * e * inertia) + force * length / (8.0 * shear);
    assert!((middle / beam - 1.0).abs() < 5e-3, "{middle} {beam}");
    assert!(rest.reaction_error < 1e-12);
    let [left, right] = [Face::Left, Face::Right]
        .map(|face| face_force_n(lattice.grid(), face, &rest.reactions_n)[1]);
    assert!((left - 0.5).abs() < 1e-9 && (right - 0.5).abs() < 1e-9);
}

/// Modulus along x of a section pulled by its faces, free to contract.
fn modulus_along_x(lattice: &Lattice, height: f64, length: f64) -> f64 {
    let grid = lattice.grid();
    let mut supports = Supports::of_faces(
        grid,
        &[
            (Face::Left, FaceSupport::Rolling),
            (
                Face::Right,
                FaceSupport::PerAxis([Some(1e-4 * length), None]),
            ),
        ],
    )
    .unwrap();
    supports.hold(grid, grid.particle(0, 0), 1, 0.0).unwrap();
    let load = vec![0.0; lattice.displacements()];
    let rest = equilibrium(lattice, &supports, &load, &StaticOptions::default()).unwrap();
    face_force_n(grid, Face::Right, &rest.reactions_n)[0] / (height * 1e-4)
}

#[test]
fn moduli_along_and_across_fibres_are_voigts_and_the_laminates() {
    // Along: all layers share the strain, and each contracts by itself only so far as the others
    // let it; the laminate's C₁₁ - C₁₂²/C₂₂ is 1.2e-5 above Voigt's mean.
    let along = papers(0.0);
    let lattice = uniform(&along, [10, 10]);
    let fraction = 5.0 * 0.7 / 70.0;
    let voigt = fraction * 11_500.0 + (1.0 - fraction) * 85.0;
    let found = modulus_along_x(&lattice, 70.0, 70.0);
    assert!((found / voigt - 1.0).abs() < 1e-3, "{found} {voigt}");
    // Across, in rows that each hold the same share, the cells are in series: exactly the laminate.
    let mut across = papers(90.0);
    across
        .fibres
        .iter_mut()
        .enumerate()
        .for_each(|(place, fibre)| {
            fibre.through_mm[0] = 7.0 + 14.0 * place as f64;
        });
    let layout = across.layout(Division::Uniform { cells: [5, 5] }).unwrap();
    let laminate = crate::stiffness::compliance(&layout.stiffness()[0]);
    let lattice = Lattice::exact(&layout);
    let found = modulus_along_x(&lattice, 70.0, 70.0);
    assert!((found * laminate[(0, 0)] - 1.0).abs() < 1e-10);
}

#[test]
fn a_symmetric_section_deflects_symmetrically() {
    let section = papers(0.0);
    let lattice = uniform(&section, [20, 20]);
    let rest = pressed(&lattice, &StaticOptions::default());
    let grid = lattice.grid();
    let u = &rest.displacements_mm;
    for j in 0..=20 {
        for i in 0..=20 {
            let (here, there) = (grid.particle(i, j), grid.particle(20 - i, j));
            assert!((u[2 * here] + u[2 * there]).abs() < 1e-12);
            assert!((u[2 * here + 1] - u[2 * there + 1]).abs() < 1e-12);
        }
    }
    assert!(face_mean_mm(grid, Face::Top, u)[1] < 0.0);
}

#[test]
fn factors_and_conjugate_gradients_find_the_same() {
    for (section, cells) in [(papers(0.0), [50, 41]), (papers(90.0), [32, 32])] {
        let lattice = uniform(&section, cells);
        let found = pressed(&lattice, &StaticOptions::default());
        let supports = clamped_sides(&lattice);
        let load = forces(&lattice, [0.0, -10.0], LoadPlace::Face(Face::Top));
        let u = vec![0.0; load.len()];
        let mut matrix = lattice.matrix();
        lattice.tangent(Geometry::Linear, Tangent::Exact, &u, &mut matrix);
        let mut multigrid = Multigrid::new(lattice.grid(), &supports, 100).unwrap();
        multigrid.prepare(&matrix).unwrap();
        let mut solution = u;
        let iterations = multigrid
            .solve(&matrix, &load, &mut solution, 1e-11)
            .unwrap();
        assert!((5..60).contains(&iterations), "{iterations}");
        let size = solution.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        for (a, b) in found.displacements_mm.iter().zip(&solution) {
            assert!((a - b).abs() < 1e-8 * size);
        }
    }
}

#[test]
fn the_same_equations_give_the_same_bytes() {
    let lattice = uniform(&papers(0.0), [40, 40]);
    let [first, second] = [0, 1].map(|_| pressed(&lattice, &StaticOptions::default()));
    assert_eq!(first, second);
}

#[test]
fn the_papers_lattice_answers_three_times_too_stiffly() {
    let section = plain([70.0, 70.0], isotropic(85.0, 0.3), 0.0);
    let layout = section
        .layout(Division::Uniform { cells: [40, 40] })
        .unwrap();
    let top = |lattice: &Lattice| {
        let rest = pressed(lattice, &StaticOptions::default());
        face_mean_mm(lattice.grid(), Face::Top, &rest.displacements_mm)[1]
    };
    let exact = top(&Lattice::exact(&layout));
    let paper = |stiffness| {
        let rule = PaperRule {
            stiffness,
            pattern: BondPattern::Cross,
        };
        top(&Lattice::paper(&section, &layout, rule).unwrap())
    };
    let ratio = exact / paper(BondStiffness::PWave);
    assert!((2.7..3.1).contains(&ratio), "{ratio}");
    let ratio = exact / paper(BondStiffness::Bare);
    assert!((1.4..1.7).contains(&ratio), "{ratio}");
}

#[test]
fn edges_alone_fold_and_loose_sections_move() {
    let section = plain([70.0, 70.0], isotropic(85.0, 0.3), 0.0);
    let layout = section.layout(Division::Uniform { cells: [5, 5] }).unwrap();
    let rule = PaperRule {
        stiffness: BondStiffness::PWave,
        pattern: BondPattern::Edges,
    };
    let edges = Lattice::paper(&section, &layout, rule).unwrap();
    let load = forces(&edges, [0.0, -10.0], LoadPlace::Face(Face::Top));
    let error = equilibrium(
        &edges,
        &clamped_sides(&edges),
        &load,
        &StaticOptions::default(),
    );
    assert!(
        matches!(error, Err(CompositeError::Mechanism { .. })),
        "{error:?}"
    );
    let one = PaperRule {
        pattern: BondPattern::OneDiagonal,
        ..rule
    };
    let one = Lattice::paper(&section, &layout, one).unwrap();
    assert!(equilibrium(&one, &clamped_sides(&one), &load, &StaticOptions::default()).is_ok());
    let rolling = Supports::of_faces(one.grid(), &[(Face::Left, FaceSupport::Rolling)]).unwrap();
    assert_eq!(
        equilibrium(&one, &rolling, &load, &StaticOptions::default()),
        Err(CompositeError::Unsupported {
            motion: "move along y"
        })
    );
    let oblong = plain([70.0, 35.0], isotropic(85.0, 0.3), 0.0);
    let layout = oblong.layout(Division::Uniform { cells: [5, 5] }).unwrap();
    assert!(matches!(
        Lattice::paper(&oblong, &layout, rule),
        Err(CompositeError::NotSquare { .. })
    ));
}

#[test]
fn a_small_load_gives_the_same_in_both_geometries() {
    let lattice = uniform(&papers(90.0), [10, 10]);
    let load: Vec<f64> = forces(&lattice, [0.0, -1e-4], LoadPlace::Face(Face::Top));
    let [linear, large] = [Geometry::Linear, Geometry::Large].map(|geometry| {
        let options = StaticOptions {
            geometry,
            ..StaticOptions::default()
        };
        equilibrium(&lattice, &clamped_sides(&lattice), &load, &options).unwrap()
    });
    let means = [&linear, &large]
        .map(|rest| face_mean_mm(lattice.grid(), Face::Top, &rest.displacements_mm)[1]);
    assert!((means[0] / means[1] - 1.0).abs() < 1e-5, "{means:?}");
}

/// A strip bent by its end to a third of a circle: the elastica under an end moment.
#[test]
fn a_strip_bends_to_a_circle() {
    let (e, length, height) = (1_000.0, 50.0, 1.0);
    let lattice = uniform(&plain([length, height], isotropic(e, 0.0), 0.0), [100, 2]);
    let grid = lattice.grid();
    // Both ends turned by half the angle, as sections of a bent beam; the middle line's ends move
    // along the chord of the arc.
    let half_angle = 60.0_f64.to_radians();
    let chord = length * half_angle.sin() / half_angle;
    let mut supports = Supports::none(grid);
    for (face, sign) in [(Face::Left, 1.0), (Face::Right, -1.0)] {
        for line in 0..=2 {
            let particle = face.particle(grid, line);
            let y = grid.y_mm()[line] - height / 2.0;
            let turned = sign * half_angle;
            let shift = sign * (length - chord) / 2.0;
            supports
                .hold(grid, particle, 0, shift - turned.sin() * y)
                .unwrap();
            supports
                .hold(grid, particle, 1, y * (turned.cos() - 1.0))
                .unwrap();
        }
    }
    let load = vec![0.0; lattice.displacements()];
    let options = StaticOptions {
        geometry: Geometry::Large,
        load_steps: 4,
        ..StaticOptions::default()
    };
    let rest = equilibrium(&lattice, &supports, &load, &options).unwrap();
    let rise = point_mm(grid, [length / 2.0, height / 2.0], &rest.displacements_mm).unwrap()[1];
    let radius = length / (2.0 * half_angle);
    let circle = radius * (1.0 - half_angle.cos());
    assert!((rise / circle - 1.0).abs() < 2e-3, "{rise} {circle}");
    let bending = e * height.powi(3) / 12.0;
    let energy = 0.5 * bending * (2.0 * half_angle).powi(2) / length;
    assert!((rest.energy_n_mm / energy - 1.0).abs() < 5e-3);
    assert_eq!(lattice.inverted_cells(&rest.displacements_mm).count(), 0);
}

#[test]
fn a_load_that_would_turn_cells_inside_out_is_refused_with_the_place() {
    let lattice = uniform(&plain([10.0, 10.0], isotropic(85.0, 0.3), 0.0), [4, 4]);
    let grid = lattice.grid();
    let supports = Supports::of_faces(
        grid,
        &[
            (Face::Bottom, FaceSupport::Clamped),
            (Face::Top, FaceSupport::PerAxis([Some(0.0), Some(-11.0)])),
        ],
    )
    .unwrap();
    let load = vec![0.0; lattice.displacements()];
    let options = StaticOptions {
        geometry: Geometry::Large,
        load_steps: 10,
        ..StaticOptions::default()
    };
    let error = equilibrium(&lattice, &supports, &load, &options).unwrap_err();
    assert!(
        matches!(
            error,
            CompositeError::Inverted { load_fraction, .. } | CompositeError::NotConverged { load_fraction, .. }
                if load_fraction < 0.95
        ),
        "{error}"
    );
}

#[test]
fn an_off_axis_strip_pulled_between_free_ends_has_the_rotated_modulus() {
    for angle in [15.0, 45.0, 75.0] {
        let material = orthotropic(11_500.0, 643.0, 0.28, Some(355.0));
        let section = plain([20.0, 10.0], material, angle);
        let lattice = uniform(&section, [8, 4]);
        let grid = lattice.grid();
        // A uniform traction on both ends, held only against rigid motion.
        let mut load = forces(&lattice, [10.0, 0.0], LoadPlace::Face(Face::Right));
        for (sum, force) in
            load.iter_mut()
                .zip(forces(&lattice, [-10.0, 0.0], LoadPlace::Face(Face::Left)))
        {
            *sum += force;
        }
        let mut supports = Supports::none(grid);
        supports.hold(grid, 0, 0, 0.0).unwrap();
        supports.hold(grid, 0, 1, 0.0).unwrap();
        supports.hold(grid, grid.particle(8, 0), 1, 0.0).unwrap();
        let rest = equilibrium(&lattice, &supports, &load, &StaticOptions::default()).unwrap();
        let stretch = rest.displacements_mm[2 * grid.particle(8, 0)] / 20.0;
        let (c, s) = (angle.to_radians().cos(), angle.to_radians().sin());
        let compliance = c.powi(4) / 11_500.0
            + s.powi(4) / 643.0
            + c * c * s * s * (1.0 / 355.0 - 2.0 * 0.28 / 11_500.0);
        assert!((stretch / compliance - 1.0).abs() < 1e-10, "{angle}");
    }
}
