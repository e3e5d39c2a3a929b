//! The report of a test: results with their errors, what tells whether to believe them, warnings.
use loadframe_api::spec::composite_bending::{CompositeBending, Grid as Cells};
use loadframe_api::{ErrorBasis, ErrorPart, Report, Spec as _, Tenth};
use loadframe_harness::ReportBuilder;

use super::comparison::Comparison;
use super::errors::{self, Finding};
use super::measured::Measured;
use super::model::Model;
use super::tested::Tested;
use super::{failure, pictures};
use crate::lattice::{Geometry, gather};
use crate::measure::mean_gradient;
use crate::section::Grid;

/// Reactions and loads that do not balance better than this are not to be believed.
const LARGEST_REACTION_ERROR: f64 = 1e-6;
/// The same over the residual asked for, which of many particles adds up.
const REACTION_OVER_RESIDUAL: f64 = 100.0;
/// Unbalanced force over the largest force, at most.
const LARGEST_RESIDUAL: f64 = 1e-6;
/// Error for the grid over the value, at most.
const LARGEST_GRID_ERROR: f64 = 0.05;
/// Root mean square of the displacement gradient over the section, strains and turns together, beyond
/// which displacements are not small.
const SMALL: f64 = 0.1;
/// Fewer particles than this under a roller do not know its contact.
const LEAST_TOUCHING: usize = 3;

/// Limits of results on ever finer grids: their names, and what of.
const LIMITS: [(&str, &str, &str); 4] = [
    (
        "mean_top_deflection_limit",
        "mean_top_deflection",
        "What the mean deflection of the top face tends to on ever finer grids, from the three that were \
         tried (Richardson).",
    ),
    (
        "mean_bottom_deflection_limit",
        "mean_bottom_deflection",
        "What the mean deflection of the bottom face tends to on ever finer grids, from the three that \
         were tried (Richardson).",
    ),
    (
        "effective_modulus_limit",
        "effective_modulus",
        "What the effective modulus tends to on ever finer grids, from the three that were tried \
         (Richardson).",
    ),
    (
        "effective_shear_modulus_limit",
        "effective_shear_modulus",
        "What the effective shear modulus tends to on ever finer grids, from the three that were tried \
         (Richardson).",
    ),
];

/// Most cells along a side that a spec may ask for.
const MOST_CELLS: f64 = 32_768.0;

/// The same test with so many times as many cells along both sides.
fn finer(spec: &CompositeBending, times: f64) -> Option<Tenth> {
    let grid = spec.grid();
    let cells = grid.cells.map(|count| (f64::from(count) * times).round());
    if cells.iter().any(|count| *count > MOST_CELLS) {
        return None;
    }
    let cells = cells.map(|count| count as u32);
    let mut changed = spec.clone();
    changed.grid = Some(Cells { cells, ..grid });
    let [along, across] = cells;
    spec.tenth(format!("grid.cells [{along}, {across}]"), &changed)
}

pub(super) fn report(
    model: &Model<'_>,
    tested: &Tested,
    measured: &[Measured],
    finding: &Finding,
) -> Report {
    let mut report = ReportBuilder::new(match &tested.broken {
        Some(broken) => failure::stop_reason(broken.reason),
        None if tested.motion.is_some() => "duration",
        None => "full_load",
    });
    for one in measured {
        let parts = finding.parts(one, measured, model.comparison(), |times| {
            finer(model.spec, times)
        });
        report.result_with_error(one.name, one.value, one.unit, one.description, parts);
    }
    for (name, of, about) in LIMITS {
        let of = measured.iter().find(|one| one.name == of);
        let found = of.and_then(|of| Some((of, finding.limit(of, model.comparison())?)));
        if let Some((of, [value, error])) = found {
            let part = ErrorPart::new("grid", error, ErrorBasis::TwoGrids);
            report.result_with_error(name, value, of.unit, about, vec![part]);
        }
    }
    if let Some(stiffer) = finding.stiffer(measured) {
        let about =
            "How many times stiffer the paper's lattice is than the exact one on the same grid.";
        report.result("stiffness_over_exact", stiffer, "1", about);
    }
    let grid = model.lattice.grid();
    report.count("cells", grid.cells(), "Cells of the grid.");
    report.count("particles", grid.particles(), "Particles at their corners.");
    if model.spec.output.picture {
        let about = "Displacements in the pictures over true ones.";
        report.result(
            "deformation_factor",
            pictures::factor(model, tested),
            "1",
            about,
        );
    }
    checks(&mut report, model, tested, measured, finding);
    warn(&mut report, model, tested, measured, finding);
    for (name, count) in tested.work() {
        report.work(&name, count);
    }
    report.finish()
}

fn checks(
    report: &mut ReportBuilder,
    model: &Model<'_>,
    tested: &Tested,
    measured: &[Measured],
    finding: &Finding,
) {
    let rest = &tested.rest;
    report.check(
        "reaction_error",
        rest.reaction_error,
        LARGEST_REACTION_ERROR.max(REACTION_OVER_RESIDUAL * rest.residual),
        "1",
        "Sum of loads and reactions over the sum of their sizes, at rest.",
    );
    report.check(
        "residual",
        rest.residual,
        LARGEST_RESIDUAL,
        "1",
        "Largest unbalanced force over the largest force on a particle, at rest.",
    );
    report.check(
        "inverted_cells",
        inverted(model, tested) as f64,
        0.0,
        "1",
        "Cells that the displacements turn inside out, at the end; cells that broke are left out.",
    );
    // what buckles nothing has no such check
    if model.geometry() == Geometry::Large {
        report.check(
            "unstable_equilibrium",
            f64::from(u8::from(tested.unstable.is_some())),
            0.0,
            "1",
            "1 where at a rest on the way, or at the end, the least push would lead away, as on the straight \
             path beyond buckling.",
        );
    }
    if let Some(broken) = &tested.broken {
        report.check(
            "closed_cracks_overloaded",
            broken.totals.overloaded_cells as f64,
            0.0,
            "1",
            "Cells in which a crack has closed and its faces press on each other by more than the material \
             bears in compression, at the last event.",
        );
        report.check(
            "crack_overlap",
            broken.totals.overlap_share,
            failure::OVERLAPPING,
            "1",
            "Volume in which the faces of cracks overlap over that of all cracks, overlapping or open, at the \
             last event.",
        );
    }
    if let Some(main) = errors::main(measured) {
        let error = finding.of_grid(main, measured, model.comparison()) / main.value.abs();
        // a grid that cannot be coarser tells nothing of its error
        if error.is_finite() {
            report.check(
                "estimated_discretisation_error",
                error,
                LARGEST_GRID_ERROR,
                "1",
                "Error for the grid over the value, of the largest force of a test that breaks or in which faces \
                 are moved, else of the modulus or of the mean top deflection, from coarser grids.",
            );
        }
    }
}

fn warn(
    report: &mut ReportBuilder,
    model: &Model<'_>,
    tested: &Tested,
    measured: &[Measured],
    finding: &Finding,
) {
    for (material, note) in &model.notes {
        report.warn("assumed_constant", format!("material {material:?}: {note}"));
    }
    if let Some(stiffer) = finding.stiffer(measured) {
        report.warn(
            "paper_stiffness",
            format!(
                "the paper's rule of bond stiffness makes this section {stiffer:.3} times as stiff as \
                 its materials are; finer grids do not mend that, the exact lattice does"
            ),
        );
    }
    let grid_error = report.failed("estimated_discretisation_error");
    if let Some(error) = grid_error.map(|check| check.value) {
        report.warn(
            "coarse_grid",
            format!(
                "the grid adds an error of about {:.1} %; twice the cells along both sides halve it, \
                 or more, for about six times the time",
                100.0 * error
            ),
        );
    }
    if let Some(share) = tested.unstable {
        report.warn(
            "unstable_equilibrium",
            format!(
                "at {share} of the load the balance found is one that the least push ends, as that of a straight \
                 column beyond its buckling load; results are of such a balance, and how wrong they are is not \
                 known: push a little aside as well, and the section is followed to where it buckles"
            ),
        );
    }
    let knows_grid_error = report
        .checks()
        .any(|(name, _)| name == "estimated_discretisation_error");
    if !knows_grid_error && tested.unstable.is_none() && model.comparison() != Comparison::None {
        report.warn(
            "unknown_discretisation_error",
            "no coarser grid could be tried, so that the grid's error is not known".to_owned(),
        );
    }
    let is_linear = model.geometry() == Geometry::Linear;
    let gradient = rms_gradient(model.lattice.grid(), tested);
    if is_linear && gradient > SMALL {
        let advice = if tested.broken.is_some() {
            "breaks are found for small displacements only"
        } else {
            "geometry \"large\" in accuracy is for that"
        };
        report.warn(
            "large_displacements",
            format!(
                "strains and turns, {gradient:.3} in the root mean square, are not small, as the test \
                 takes them to be; {advice}"
            ),
        );
    }
    if let Some(touching) = tested.bent.as_ref().map(|bent| bent.touching)
        && touching < LEAST_TOUCHING
    {
        report.warn(
            "coarse_contact",
            format!(
                "a roller rests on {touching} particles: how far it dents the face is not known, the \
                 deflection is; graded_cells_per_fibre in the grid makes it finer at rollers"
            ),
        );
    }
    if let Some(broken) = &tested.broken {
        for (code, detail) in failure::warnings(broken) {
            report.warn(code, detail);
        }
    }
    for (name, advice) in [
        (
            "reaction_error",
            "loads and reactions do not balance: stiffnesses differ by more than double precision \
             resolves",
        ),
        (
            "residual",
            "forces are not balanced as well as they should be; a smaller residual in accuracy helps",
        ),
        (
            "inverted_cells",
            "cells are turned inside out: the load is far beyond what small displacements mean",
        ),
    ] {
        if let Some(check) = report.failed(name) {
            let detail = format!("{advice} ({:e})", check.value);
            report.warn(name, detail);
        }
    }
}

/// Root mean square over the section of the four derivatives of the displacements; where cells broke,
/// these are openings of cracks, and left out.
fn rms_gradient(grid: &Grid, tested: &Tested) -> f64 {
    let u = tested.displacements_mm();
    let mut sum = 0.0;
    let mut area = 0.0;
    for cell in (0..grid.cells()).filter(|cell| tested.is_whole(*cell)) {
        let sides = grid.sides_mm(cell);
        let gradient = mean_gradient(sides, &gather(u, grid.corners(cell)));
        let squares: f64 = gradient.iter().flatten().map(|part| part * part).sum();
        sum += squares * sides[0] * sides[1];
        area += sides[0] * sides[1];
    }
    if area > 0.0 { (sum / area).sqrt() } else { 0.0 }
}

/// Number of whole cells that displacements turn inside out.
fn inverted(model: &Model<'_>, tested: &Tested) -> usize {
    let cells = model.lattice.inverted_cells(tested.displacements_mm());
    cells.filter(|cell| tested.is_whole(*cell)).count()
}
