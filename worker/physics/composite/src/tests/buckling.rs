//! Rests that the least push ends, against Euler's column.
use super::sections::{forces, isotropic, plain, uniform};
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::load::LoadPlace;
use crate::solve::multigrid::Multigrid;
use crate::solve::{Equations, LoadPath, StaticOptions, equilibrium, is_stable};
use crate::supports::{Face, FaceSupport, Supports};

const OPTIONS: StaticOptions = StaticOptions {
    geometry: Geometry::Large,
    method: crate::solve::Method::Automatic,
    load_steps: 1,
    tolerance: 1e-9,
};

/// A column of 40 mm by 1 mm by 1 mm, E = 1000 MPa, clamped at its left end, and its buckling load
/// π² EI/(4 L²) [N] by [Euler1744], less what shear takes, P/(1 + P/kGA), which is 10⁻⁴ of it.
fn column(cells: [usize; 2]) -> (Lattice, Supports, f64) {
    let lattice = uniform(&plain([40.0, 1.0], isotropic(1_000.0, 0.0), 0.0), cells);
    let supports =
        Supports::of_faces(lattice.grid(), &[(Face::Left, FaceSupport::Clamped)]).unwrap();
    let pi = std::f64::consts::PI;
    (
        lattice,
        supports,
        pi * pi * 1_000.0 / 12.0 / (4.0 * 1_600.0),
    )
}

#[test]
fn a_column_is_unstable_beyond_eulers_load_and_stable_below_it() {
    let (lattice, supports, euler_n) = column([80, 8]);
    for (share, expected) in [(0.99, true), (1.01, false), (3.0, false)] {
        let push = forces(
            &lattice,
            [-share * euler_n, 0.0],
            LoadPlace::Face(Face::Right),
        );
        let rest = equilibrium(&lattice, &supports, &push, &OPTIONS).unwrap();
        let u = &rest.displacements_mm;
        assert_eq!(
            is_stable(&lattice, &supports, u).unwrap(),
            expected,
            "{share}"
        );
        // conjugate gradients find the same: a grid twice as coarse, which is factored, is stiffer and not
        // unstable before 1.03 of the load
        let mut matrix = lattice.matrix();
        lattice.tangent(Geometry::Large, Tangent::Exact, u, &mut matrix);
        let multigrid = Multigrid::new(lattice.grid(), &supports, 250).unwrap();
        let mut equations = Equations::Iterated(Box::new(multigrid));
        let is_prepared = equations.prepare(&matrix).is_ok();
        assert_eq!(is_prepared, share < 2.0, "{share}");
        if is_prepared {
            assert_eq!(equations.is_positive(&matrix), expected, "{share}");
        }
    }
}

#[test]
fn a_path_tells_from_which_load_on_its_rests_are_unstable() {
    let (lattice, supports, euler_n) = column([40, 4]);
    let push = forces(
        &lattice,
        [-1.25 * euler_n, 0.0],
        LoadPlace::Face(Face::Right),
    );
    let aside = forces(
        &lattice,
        [-1.25 * euler_n, 1e-4 * euler_n],
        LoadPlace::Face(Face::Right),
    );
    let pulled = forces(
        &lattice,
        [10.0 * euler_n, 0.0],
        LoadPlace::Face(Face::Right),
    );
    // 0.25 to 1.25 of Euler's load in five steps; a little aside it buckles, and is stable as it does
    for (load, expected) in [(push, Some(1.0)), (aside, None), (pulled, None)] {
        let options = StaticOptions {
            load_steps: 5,
            ..OPTIONS
        };
        let mut path = LoadPath::new(&lattice, &supports, &load, &options, &|| false).unwrap();
        while path.share() < 1.0 {
            path.advance().unwrap();
        }
        assert_eq!(path.unstable(), expected);
        let tip = lattice.displacements() - 1;
        let has_buckled = path.displacements_mm()[tip].abs() > 10.0;
        assert_eq!(has_buckled, load[tip] > 0.0);
    }
}
