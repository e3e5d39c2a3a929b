//! Results of the test of a sheet in the words of ISO 1924 and ISO 15361.
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_harness::ReportBuilder;

use super::bonds_between_rings;
use super::bonds_inside;
use super::course::{Mode, Record};
use super::laid::Laid;
use super::specimen::Specimen;
use super::straight_parts;
use super::theory::Theory;
use super::together::{self, Of};
use crate::frame::{Broken, PullMeasures};

/// Standard gravity [m/s²], by which a breaking length is defined.
const GRAVITY: f64 = 9.806_65;
/// mN in N, nJ in J, m per mm, N m/g per kN m/g.
const N: f64 = 1e-3;
const J: f64 = 1e-9;
const M: f64 = 1e-3;
const PER_KILO: f64 = 1e3;

/// All results of a test.
pub(super) fn add(
    report: &mut ReportBuilder,
    spec: &PaperTensile,
    specimen: &Specimen,
    measures: &PullMeasures,
    records: &[Record],
    residual_strain: Option<f64>,
) {
    let is_zero_span = spec.test.is_zero_span();
    if is_zero_span {
        zero_span(report, specimen, measures);
    } else {
        strength(report, spec, specimen, measures);
    }
    yields(report, specimen, measures, residual_strain);
    counts(report, specimen, measures, records);
    structure(report, specimen);
    if let Some(laid) = &specimen.laid {
        theory(report, &laid.theory, is_zero_span);
    }
}

/// Index [N m/g] of a force per width [kN/m]; by the grammage [g/m²].
fn index(per_width: f64, grammage: f64) -> f64 {
    PER_KILO * per_width / grammage
}

fn strength(
    report: &mut ReportBuilder,
    spec: &PaperTensile,
    specimen: &Specimen,
    measures: &PullMeasures,
) {
    // straight parts of fibres, and bonds inside them or between the rings of tubes, make stiffness too large; of no other result was
    // that measured
    let errors = |stiffness: f64| {
        let parts = straight_parts::error(spec, stiffness).into_iter();
        parts
            .chain(bonds_inside::error(spec, &specimen.network, stiffness))
            .chain(bonds_between_rings::error(
                spec,
                &specimen.network,
                stiffness,
            ))
            .collect()
    };
    let (width, length) = (specimen.width_mm, specimen.length_mm);
    let grammage = specimen.grammage_g_per_m2;
    let max_force = N * measures.peak_force_mn;
    // N/mm is kN/m
    let per_width = max_force / width;
    let stiffness = N * measures.initial_stiffness_mn / width;
    let absorbed = J * measures.work_to_peak_nj / (M * width * M * length);
    let has_mass = grammage > 0.0;
    let of = |of: Of, value: f64| together::error(spec, of, value).into_iter().collect();
    let about = "Largest force on the moving jaw.";
    let error = of(Of::Force, max_force);
    report.result_with_error("max_force", max_force, "N", about, error);
    let about = "Largest force per width (ISO 1924-2).";
    let error = of(Of::Force, per_width);
    report.result_with_error("tensile_strength", per_width, "kN/m", about, error);
    if has_mass {
        let index = index(per_width, grammage);
        let about = "Tensile strength over grammage.";
        let error = of(Of::Force, index);
        report.result_with_error("tensile_index", index, "N m/g", about, error);
        let about = "Length of a strip that would break under its own weight.";
        let length = index / GRAVITY;
        let error = of(Of::Force, length);
        report.result_with_error("breaking_length", length, "km", about, error);
    }
    let stretch = measures.strain_at_peak;
    let about = "Nominal strain at the largest force: elongation over the distance of the jaws.";
    let error = of(Of::Stretch, stretch);
    report.result_with_error("stretch", stretch, "1", about, error);
    let about = "Work of the moving jaw up to the largest force, per area between the jaws.";
    let error = of(Of::Energy, absorbed);
    report.result_with_error("energy_absorption", absorbed, "J/m2", about, error);
    if has_mass {
        let about = "Energy absorption over grammage.";
        let (name, index) = ("energy_absorption_index", absorbed / grammage);
        report.result_with_error(name, index, "J/g", about, of(Of::Energy, index));
    }
    let about = "Force per width over strain before anything breaks.";
    let error = errors(stiffness);
    report.result_with_error("tensile_stiffness", stiffness, "kN/m", about, error);
    if has_mass {
        let about = "Tensile stiffness over grammage.";
        let (name, index) = ("tensile_stiffness_index", stiffness / grammage);
        report.result_with_error(name, index, "kN m/g", about, errors(index));
    }
    if let Some(thickness) = specimen.laid.as_ref().and_then(Laid::thickness_um) {
        // kN/m over µm is GPa
        let about = "Tensile stiffness over the thickness that was given, else over the mean one.";
        let modulus = stiffness / thickness;
        report.result_with_error("youngs_modulus", modulus, "GPa", about, errors(modulus));
    }
}

/// Of fibres that yield.
fn yields(
    report: &mut ReportBuilder,
    specimen: &Specimen,
    measures: &PullMeasures,
    residual_strain: Option<f64>,
) {
    if !specimen.network.yields() {
        return;
    }
    let area = M * specimen.width_mm * M * specimen.length_mm;
    report.result(
        "plastic_work",
        J * measures.dissipated_at_peak_nj / area,
        "J/m2",
        "Of the work up to the largest force that which yielding of fibres took, per area between the jaws.",
    );
    report.result(
        "yielded_share",
        measures.yielded_share_at_peak,
        "1",
        "Share of the length of all fibres that had yielded at the largest force.",
    );
    if let Some(strain) = residual_strain {
        let about = "Strain left were the sheet unloaded from the largest force, as far as that is elastic.";
        report.result("residual_strain", strain, "1", about);
    }
}

/// Of the pieces between closed jaws, over the grammage of the sheet.
fn zero_span(report: &mut ReportBuilder, specimen: &Specimen, measures: &PullMeasures) {
    let max_force = N * measures.peak_force_mn;
    let per_width = max_force / specimen.width_mm;
    let about = "Largest force on the moving jaw.";
    report.result("max_force", max_force, "N", about);
    let about =
        "Largest force per width, with jaws closed to the width of the widest fibre (ISO 15361).";
    report.result("zero_span_strength", per_width, "kN/m", about);
    let about = "Zero-span strength over the grammage of the sheet.";
    let index = index(per_width, specimen.grammage_g_per_m2);
    report.result("zero_span_index", index, "N m/g", about);
    report.result(
        "zero_span_strain",
        measures.strain_at_peak,
        "1",
        "Strain of a fibre along the pull at the largest force.",
    );
}

fn theory(report: &mut ReportBuilder, theory: &Theory, is_zero_span: bool) {
    if let Some(index) = theory.zero_span {
        report.result(
            "zero_span_index_of_fibres",
            index,
            "N m/g",
            "Zero-span index by the fibres of the whole sheet, each by direction, section and strength: 3/8 of \
             strength over density of the wall for uniform directions (Van den Akker 1958).",
        );
    }
    if is_zero_span {
        return;
    }
    if let Some(cox) = theory.cox {
        report.result(
            "cox_stiffness_index",
            cox.free,
            "kN m/g",
            "Tensile stiffness index of the same fibres, were all straight from edge to edge and strained \
             as the sheet is, and the sheet free to contract (Cox 1952): an upper bound.",
        );
    }
    if let Some(index) = theory.shear_lag {
        report.result(
            "shear_lag_stiffness_index",
            index,
            "kN m/g",
            "The same with every fibre's strain built up through its bonds, 1 - tanh(x)/x of it (Cox 1952): \
             an estimate, which knows no bending.",
        );
    }
    let Some(page) = theory.page else {
        return;
    };
    report.result(
        "page_tensile_index",
        page.index,
        "N m/g",
        "Tensile index by Page's equation (1969) from the zero-span index, coarseness, length, width, bonded \
         area and shear strength of bonds of this sheet; a strength not given is without limit. \
         Semi-empirical.",
    );
    report.result(
        "page_bond_share",
        page.bond_share,
        "1",
        "Share of bonds in 1/T of Page's equation: 1 where only they limit strength, 0 where only fibres do.",
    );
    if let Some(index) = report.value("tensile_index") {
        let about = "Tensile index over that by Page's equation.";
        report.result("tensile_index_over_page", index / page.index, "1", about);
    }
}

fn counts(
    report: &mut ReportBuilder,
    specimen: &Specimen,
    measures: &PullMeasures,
    records: &[Record],
) {
    let network = &specimen.network;
    let modes = records
        .iter()
        .filter_map(|record| specimen.mode(record.bond()?, record.event.bore));
    let (mut opened, mut sheared) = (0_u32, 0_u32);
    for mode in modes {
        match mode {
            Mode::Opened => opened += 1,
            Mode::Sheared => sheared += 1,
        }
    }
    let broken_segments = records
        .iter()
        .filter_map(|record| match record.event.broken {
            Broken::Segment(segment) => Some(network.segment_fibre(segment)),
            Broken::Bond(_) => None,
        });
    let mut torn: Vec<usize> = broken_segments.collect();
    torn.sort_unstable();
    torn.dedup();
    let void = (0..network.bonds())
        .filter(|&bond| network.is_void(bond))
        .count();
    for (name, count, about) in [
        ("broken_bonds", measures.broken_bonds, "Bonds that broke."),
        (
            "broken_bonds_opened",
            opened as usize,
            "Of them those that opening took more of than shear, by the strengths.",
        ),
        (
            "broken_bonds_sheared",
            sheared as usize,
            "Of them those that shear took more of than opening, by the strengths.",
        ),
        (
            "broken_fibres",
            torn.len(),
            "Fibres that broke at one place or more.",
        ),
        (
            "fibres",
            network.fibres(),
            "Fibres, or pieces of fibres that the edges cut.",
        ),
        ("bonds", network.bonds(), "Bonds before the test."),
        (
            "void_bonds",
            void,
            "Of them those without any strength, which never held.",
        ),
    ] {
        report.count(name, count, about);
    }
}

fn structure(report: &mut ReportBuilder, specimen: &Specimen) {
    report.result(
        "grammage",
        specimen.grammage_g_per_m2,
        "g/m2",
        "Mass of the fibres between the jaws, over their distance and the width.",
    );
    let Some(laid) = &specimen.laid else {
        return;
    };
    let Some(measured) = &laid.statistics else {
        return;
    };
    for (name, value, unit, about) in [
        (
            "contacts_per_fibre",
            measured.contacts_per_fibre,
            "1",
            "Contacts on a fibre, on average.",
        ),
        (
            "relative_bonded_area",
            measured.relative_bonded_area,
            "1",
            "Area of all contacts over that of one side of all fibres: the share of both their sides \
             that is bonded.",
        ),
        (
            "coverage",
            measured.coverage,
            "1",
            "Layers of fibres over a point, on average.",
        ),
        (
            "thickness",
            measured.mean_thickness_um,
            "µm",
            "From the lowest to the highest fibre over a point, on average over the sheet.",
        ),
        (
            "peak_thickness",
            measured.peak_thickness_um,
            "µm",
            "Between two planes beyond which one per cent of each surface stands; a gauge reads between \
             this and the mean.",
        ),
        (
            "density",
            measured.apparent_density_kg_per_m3,
            "kg/m3",
            "Grammage over mean thickness.",
        ),
        (
            "mean_fibre_length",
            1e-3 * measured.mean_length_um,
            "mm",
            "Mean length of fibres as the edges cut them.",
        ),
        (
            "mean_fibre_width",
            measured.mean_width_um,
            "µm",
            "Mean width of fibres, weighted by their length.",
        ),
        (
            "length_weighted_fibre_length",
            1e-3 * measured.length_weighted_um,
            "mm",
            "The same, each weighted by its length.",
        ),
        (
            "anisotropy",
            measured.anisotropy,
            "1",
            "Mean of cos 2θ over the length of the fibres, with the angle θ to the pull: 1 all along it, \
             0 without a direction, -1 all across.",
        ),
    ] {
        report.result(name, value, unit, about);
    }
    if let Some(free) = measured.free_length_um {
        let about = "Mean length of fibre between neighbouring contacts.";
        report.result("free_segment_length", free, "µm", about);
    }
}
