//! What the JSON Schema cannot say: names that must exist, materials that must be stable, fibres that
//! must not share a place, a section that must be held.
mod breaking;
mod filling;
mod flexure;
mod held;
mod materials;

use super::{BondPattern, CompositeBending, Geometry, Lattice, Solver, Way};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations};
pub(super) use materials::pointer_to;
pub(crate) use materials::{check_material, refused_interface, unknown_material};

/// More particles than this are refused.
const MOST_PARTICLES: u64 = 50_000_000;

pub(super) fn check(spec: &CompositeBending, violations: &mut Violations) {
    materials::check_materials(spec, violations);
    filling::check_filling(spec, violations);
    filling::check_fibres(spec, violations);
    check_grid(spec, violations);
    check_test(spec, violations);
    breaking::check_breaking(spec, violations);
    check_probes(spec, violations);
}

fn check_grid(spec: &CompositeBending, violations: &mut Violations) {
    let particles = spec.particles();
    if particles > MOST_PARTICLES {
        violations.push(
            Violation::new(
                "/grid/cells",
                "too_large",
                "the grid has too many particles",
            )
            .value(particles)
            .allowed(format!("at most {MOST_PARTICLES} particles")),
        );
    }
    let grid = spec.grid();
    if grid.equal_cells && grid.graded_cells_per_fibre.is_some() {
        violations.push(
            Violation::new(
                "/grid/equal_cells",
                "not_allowed",
                "cells of a graded grid are not equal",
            )
            .value(true)
            .allowed("equal_cells or graded_cells_per_fibre, not both"),
        );
    }
    let Lattice::Paper(paper) = spec.lattice else {
        return;
    };
    let knobs = spec.accuracy.knobs();
    let moves_far = knobs.geometry == Geometry::Large && knobs.solver != Solver::Static;
    if paper.bonds == BondPattern::Edges && !moves_far {
        violations.push(
            Violation::new(
                "/lattice/paper/bonds",
                "not_stiff",
                "bonds along edges alone do not keep the shape of a cell: the lattice folds without \
                 resistance, as the paper says itself, and has no rest near where it begins",
            )
            .value("edges")
            .allowed(
                "\"cross\" or \"one_diagonal\"; with edges the geometry \"large\" and a solver that moves \
                 the particles",
            ),
        );
    }
    let [width, height] = [
        spec.section.length_mm / f64::from(grid.cells[0]),
        spec.section.height_mm / f64::from(grid.cells[1]),
    ];
    let refused = |pointer: &str, code: &str, detail: String, allowed: &str| {
        Violation::new(pointer, code, detail).allowed(allowed)
    };
    if (width / height - 1.0).abs() > 1e-9 {
        violations.push(refused(
            "/grid/cells",
            "not_square",
            format!(
                "the paper's lattice needs square cells, and these are {width} mm by {height} mm"
            ),
            "numbers of cells in proportion to the section's sides",
        ));
    }
    if grid.graded_cells_per_fibre.is_some() {
        violations.push(refused(
            "/grid/graded_cells_per_fibre",
            "not_allowed",
            "the paper's lattice needs equal cells".to_owned(),
            "a grid given by its cells alone",
        ));
    }
    if !spec.plies.is_empty() {
        violations.push(refused(
            "/plies",
            "not_allowed",
            "the paper's lattice has a matrix and fibres, no plies".to_owned(),
            "a matrix, or the exact lattice",
        ));
    }
}

fn check_test(spec: &CompositeBending, violations: &mut Violations) {
    let test = &spec.test;
    let ways = test.ways();
    let [(name, way)] = ways.as_slice() else {
        let given: Vec<&str> = ways.iter().map(|(name, _)| *name).collect();
        violations.push(
            Violation::new("/test", "not_one_test", "a job does exactly one test")
                .value(given)
                .allowed(
                    "exactly one of: supports (with load), three_point, four_point, short_beam, \
                     double_cantilever, tension, shear",
                ),
        );
        return;
    };
    match way {
        Way::Held(supports) => held::check_held(spec, supports, violations),
        Way::ThreePoint(flexure) => flexure::check_flexure(spec, name, flexure, 1, violations),
        Way::ShortBeam(flexure) => flexure::check_flexure(spec, name, flexure, 1, violations),
        Way::FourPoint(flexure) => flexure::check_flexure(spec, name, flexure, 2, violations),
        Way::DoubleCantilever(_) => breaking::check_split(spec, violations),
        Way::Tension(tension) => check_strain(name, tension.strain, violations),
        Way::Shear(shear) => check_strain(name, shear.strain, violations),
    }
    if !matches!(way, Way::Held(_)) {
        for (field, given) in [
            ("load", test.load.is_some()),
            ("history", test.history.is_some()),
        ] {
            if given {
                violations.push(
                    Violation::new(
                        format!("/test/{field}"),
                        "not_allowed",
                        format!("{name} brings its own load"),
                    )
                    .allowed("with supports only"),
                );
            }
        }
    }
}

fn check_strain(name: &str, strain: f64, violations: &mut Violations) {
    if strain == 0.0 {
        violations.push(
            Violation::new(
                format!("/test/{name}/strain"),
                "out_of_range",
                "nothing is strained",
            )
            .value(strain)
            .allowed("other than 0")
            .unit("1"),
        );
    }
}

fn check_probes(spec: &CompositeBending, violations: &mut Violations) {
    let probes = spec.probes_mm.iter().enumerate();
    let wrong = probes
        .filter_map(|(index, point)| held::outside(spec, format!("/probes_mm/{index}"), *point));
    violations.extend(wrong.take(LISTED_OF_A_SORT));
}
