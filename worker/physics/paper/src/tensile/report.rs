//! The report of a test of a fibre: what was measured beside what was put in, quality, warnings.
use loadframe_api::Report;
use loadframe_api::spec::paper_tensile::SingleFibreLoad;
use loadframe_harness::ReportBuilder;

use super::contradictions::warn_of_contradictions;
use super::fibre::{Loaded, Specimen};
use crate::fibre::measure::{Constants, column_load_mn, shear_stiffness_mn};
use crate::fibre::{Divided, Elasticity};

/// Constants further than this from what was put in are not to be believed.
const LARGEST_MISS: f64 = 0.005;
/// Unbalanced force over the largest force of a spring, at most.
const LARGEST_RESIDUAL: f64 = 1e-9;
/// A buckling load below this part of a column's is that of a dent in the wall.
const LEAST_OF_COLUMN: f64 = 0.9;

/// Measured over put in, largest distance from 1.
pub(super) fn miss(elasticity: &Elasticity, divided: &Divided, constants: &Constants) -> f64 {
    [
        constants.axial_modulus_gpa / elasticity.youngs_modulus_gpa(),
        constants.poisson_ratio / elasticity.poisson_ratio(),
        constants.shear_modulus_gpa / divided.springs.shear_modulus_gpa,
    ]
    .iter()
    .fold(0.0, |most: f64, ratio| most.max((ratio - 1.0).abs()))
}

/// Load at which a column of the measured stiffness buckles [mN].
fn column_mn(specimen: &Specimen<'_>, constants: &Constants) -> f64 {
    let shear = shear_stiffness_mn(
        &specimen.section,
        &specimen.elasticity,
        constants.shear_modulus_gpa,
    );
    let stiffness = constants.bending_stiffness_mn_um2;
    column_load_mn(stiffness, specimen.tube.length_um(), Some(shear))
}

pub(super) fn report(specimen: &Specimen<'_>, constants: &Constants, loaded: &Loaded) -> Report {
    let stop_reason = match specimen.single.load {
        SingleFibreLoad::Buckle => "buckled",
        _ => "max_strain",
    };
    let mut report = ReportBuilder::new(stop_reason);
    results(&mut report, specimen, constants, loaded);
    let miss = miss(&specimen.elasticity, &specimen.divided, constants);
    constants_check(&mut report, miss);
    report.check(
        "spring_residual",
        loaded.residual,
        LARGEST_RESIDUAL,
        "1",
        "Largest unbalanced force over the largest force of a spring, at any rest.",
    );
    warn(&mut report, specimen, constants, loaded);
    report.work("factorings", loaded.factorings);
    report.work("springs", specimen.springs().len() as u64);
    report.finish()
}

/// Says how far the constants of a tube are from those put in.
pub(super) fn constants_check(report: &mut ReportBuilder, miss: f64) {
    report.check(
        "fibre_constants_error",
        miss,
        LARGEST_MISS,
        "1",
        "Largest distance of E, ν and G of the tube from those put into its springs.",
    );
}

fn results(
    report: &mut ReportBuilder,
    specimen: &Specimen<'_>,
    constants: &Constants,
    loaded: &Loaded,
) {
    let (elasticity, divided) = (&specimen.elasticity, &specimen.divided);
    let wall_mn_um2 = elasticity.youngs_modulus_gpa() * specimen.section.inertia_um4();
    // mN µm² is 10⁻¹⁵ N m²
    let newton_m2 = 1e-15;
    let coarseness = specimen.pulp.coarseness_mg_per_m(&specimen.section);
    let mut rows: Vec<(&str, f64, &str, &str)> = vec![
        (
            "axial_modulus",
            constants.axial_modulus_gpa,
            "GPa",
            "E of the tube, pulled.",
        ),
        (
            "axial_modulus_given",
            elasticity.youngs_modulus_gpa(),
            "GPa",
            "E that was put in.",
        ),
        (
            "poisson_ratio",
            constants.poisson_ratio,
            "1",
            "ν of the tube, pulled.",
        ),
        (
            "poisson_ratio_given",
            elasticity.poisson_ratio(),
            "1",
            "ν that was put in.",
        ),
        (
            "shear_modulus",
            constants.shear_modulus_gpa,
            "GPa",
            "G of the tube, twisted.",
        ),
        (
            "shear_modulus_given",
            elasticity.shear_modulus_gpa(),
            "GPa",
            "G that was put in.",
        ),
        (
            "bending_stiffness",
            newton_m2 * constants.bending_stiffness_mn_um2,
            "N m2",
            "E I of the tube, bent by moments.",
        ),
        (
            "bending_stiffness_of_wall",
            newton_m2 * wall_mn_um2,
            "N m2",
            "E I of the wall. The springs are not made for it, and the tube has less.",
        ),
        (
            "buckling_load",
            loaded.buckling_load_mn,
            "mN",
            "Force at which the fibre, straight and pinned at both ends, buckles.",
        ),
        (
            "buckling_load_of_column",
            column_mn(specimen, constants),
            "mN",
            "The same of a column of the measured bending and shear stiffness, by Euler and Engesser.",
        ),
    ];
    if let Some(force_mn) = loaded.force_mn {
        let about = "Force at the largest strain.";
        rows.push(("max_force", force_mn, "mN", about));
    }
    if let Some(stiffness_mn) = loaded.stiffness_mn {
        let about = "Force over the strain of the chord, at the first touch.";
        rows.push(("initial_stiffness", stiffness_mn, "mN", about));
    }
    let window = &divided.window;
    rows.extend([
        (
            "segments",
            divided.segments as f64,
            "1",
            "Segments of the fibre.",
        ),
        (
            "segment_length",
            divided.segment.length_um(),
            "µm",
            "Length of a segment.",
        ),
        (
            "shortest_segment",
            window.from_um,
            "µm",
            "Shortest segment without springs of negative stiffness.",
        ),
        (
            "longest_segment",
            window.to_um,
            "µm",
            "Longest segment without springs of negative stiffness.",
        ),
        (
            "ring_diameter",
            divided.segment.diameter_um(),
            "µm",
            "Diameter of the rings of points.",
        ),
        (
            "wall_density",
            specimen.section.wall_density_kg_per_m3(coarseness),
            "kg/m3",
            "Coarseness over the area of the wall.",
        ),
    ]);
    for (name, value, unit, about) in rows {
        report.result(name, value, unit, about);
    }
}

fn warn(
    report: &mut ReportBuilder,
    specimen: &Specimen<'_>,
    constants: &Constants,
    loaded: &Loaded,
) {
    warn_of_contradictions(report, specimen.spec);
    let (spec, divided) = (specimen.spec, &specimen.divided);
    if divided.is_refined {
        report.warn(
            "refined_segment",
            format!(
                "segments of {} µm need springs of negative stiffness; {:.4} µm are taken, from a window \
                 of {:.4} to {:.4} µm",
                spec.model.segment_um.unwrap_or_default(),
                divided.segment.length_um(),
                divided.window.from_um,
                divided.window.to_um
            ),
        );
    }
    if divided.springs.is_robust {
        let given = specimen.elasticity.shear_modulus_gpa();
        let effective = divided.springs.shear_modulus_gpa;
        report.warn(
            "robust_springs",
            format!(
                "segments of {:.4} µm, outside the window of {:.4} to {:.4} µm, have springs around and \
                 along of unlike modulus; the shear modulus is {effective:.4} GPa, {:.1} % of the given \
                 {given} GPa",
                divided.segment.length_um(),
                divided.window.from_um,
                divided.window.to_um,
                100.0 * effective / given
            ),
        );
    }
    let mut unused = spec.test.unused_by_a_fibre();
    if spec.bond.is_some() {
        unused.insert(0, "bond");
    }
    if specimen.pulp.yielding.is_some() {
        unused.insert(0, "pulp.yielding");
    }
    if !unused.is_empty() {
        let names = unused.join(", ");
        report.warn(
            "unused_by_a_fibre",
            format!("a single fibre does not use: {names}"),
        );
    }
    if let (Some(force_mn), Some(strength_mpa)) = (loaded.force_mn, specimen.pulp.strength_mpa) {
        // mN/µm² is 1000 MPa
        let stress_mpa = 1e3 * force_mn / specimen.section.area_um2();
        if stress_mpa > strength_mpa {
            report.warn(
                "over_strength",
                format!(
                    "at the largest strain the mean stress of the wall is {stress_mpa:.0} MPa, above its \
                     strength of {strength_mpa} MPa; a single fibre does not break"
                ),
            );
        }
    }
    let column = column_mn(specimen, constants);
    if loaded.buckling_load_mn < LEAST_OF_COLUMN * column {
        report.warn(
            "wall_dents",
            format!(
                "the fibre buckles at {:.4} mN, below the {column:.4} mN of a column: its wall dents, \
                 which springs between few points tell only roughly",
                loaded.buckling_load_mn
            ),
        );
    }
}
