//! Results of the test of a sheet in the words of ISO 1924, and whether to believe them.
use indexmap::IndexMap;
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_api::{QualityCheck, Quantity, Report};

use super::course::{Course, Mode, Record};
use super::specimen::Specimen;
use super::warnings::warnings;
use crate::frame::{Broken, PullEnd, PullMeasures};

/// Largest difference between the jaw forces, relative to the maximum force, that goes without
/// warning: the force error ISO 7500-1 allows a testing machine of class 1.
const LARGEST_IMBALANCE: f64 = 0.01;
/// Work that is neither stored nor set free, over the work.
const LARGEST_ENERGY_ERROR: f64 = 1e-6;
/// Standard gravity [m/s²], by which a breaking length is defined.
const GRAVITY: f64 = 9.806_65;
/// mN in N, nJ in J, m per mm, N m/g per kN m/g.
const N: f64 = 1e-3;
const J: f64 = 1e-9;
const M: f64 = 1e-3;
const PER_KILO: f64 = 1e3;

/// The report of a finished test.
pub(super) fn report(
    spec: &PaperTensile,
    specimen: &Specimen,
    course: &Course<'_>,
    end: PullEnd,
) -> Report {
    let measures = course.pull.state().measures;
    let cost = course.pull.cost();
    let mut rows = Rows::default();
    strength(&mut rows, specimen, &measures);
    counts(&mut rows, specimen, &measures, &course.kept.records);
    structure(&mut rows, specimen);
    Report {
        stop_reason: match end {
            PullEnd::MaxStrain => "max_strain",
            PullEnd::ForceFraction => "force_dropped",
            PullEnd::Parted => "parted",
            PullEnd::NoPath => "no_load_path",
        }
        .to_owned(),
        warnings: warnings(
            spec,
            specimen,
            course,
            end,
            rows.value("tensile_stiffness_index"),
        ),
        summary: rows.0,
        quality: quality(&measures, course.pull.residual_limit()),
        bodies: Vec::new(),
        work: IndexMap::from([
            ("factorings".to_owned(), cost.factors as u64),
            ("solutions".to_owned(), cost.solutions as u64),
            ("iterations".to_owned(), cost.iterations as u64),
            ("unknowns".to_owned(), cost.unknowns as u64),
            ("factor_entries".to_owned(), cost.stored as u64),
        ]),
    }
}

/// Results in order.
#[derive(Default)]
struct Rows(IndexMap<String, Quantity>);

impl Rows {
    fn add(&mut self, name: &str, value: f64, unit: &str, about: &str) {
        self.0
            .insert(name.to_owned(), Quantity::new(value, unit, about));
    }

    fn value(&self, name: &str) -> Option<f64> {
        self.0.get(name)?.value
    }
}

/// Index [N m/g] of a force per width [kN/m]; by the grammage [g/m²].
fn index(per_width: f64, grammage: f64) -> f64 {
    PER_KILO * per_width / grammage
}

fn strength(rows: &mut Rows, specimen: &Specimen, measures: &PullMeasures) {
    let (width, length) = (specimen.width_mm, specimen.length_mm);
    let grammage = specimen.grammage_g_per_m2;
    let max_force = N * measures.peak_force_mn;
    // N/mm is kN/m
    let per_width = max_force / width;
    let stiffness = N * measures.initial_stiffness_mn / width;
    let absorbed = J * measures.work_to_peak_nj / (M * width * M * length);
    let has_mass = grammage > 0.0;
    rows.add(
        "max_force",
        max_force,
        "N",
        "Largest force on the moving jaw.",
    );
    rows.add(
        "tensile_strength",
        per_width,
        "kN/m",
        "Largest force per width (ISO 1924-2).",
    );
    if has_mass {
        let index = index(per_width, grammage);
        let about = "Tensile strength over grammage.";
        rows.add("tensile_index", index, "N m/g", about);
        let about = "Length of a strip that would break under its own weight.";
        rows.add("breaking_length", index / GRAVITY, "km", about);
    }
    rows.add(
        "stretch",
        measures.strain_at_peak,
        "1",
        "Nominal strain at the largest force: elongation over the distance of the jaws.",
    );
    rows.add(
        "energy_absorption",
        absorbed,
        "J/m2",
        "Work of the moving jaw up to the largest force, per area between the jaws.",
    );
    if has_mass {
        let about = "Energy absorption over grammage.";
        rows.add("energy_absorption_index", absorbed / grammage, "J/g", about);
    }
    rows.add(
        "tensile_stiffness",
        stiffness,
        "kN/m",
        "Force per width over strain before anything breaks.",
    );
    if has_mass {
        let about = "Tensile stiffness over grammage.";
        rows.add(
            "tensile_stiffness_index",
            stiffness / grammage,
            "kN m/g",
            about,
        );
    }
    if let Some(thickness) = specimen
        .laid
        .as_ref()
        .and_then(super::laid::Laid::thickness_um)
    {
        // kN/m over µm is GPa
        let about = "Tensile stiffness over the thickness that was given, else over the mean one.";
        rows.add("youngs_modulus", stiffness / thickness, "GPa", about);
    }
}

fn counts(rows: &mut Rows, specimen: &Specimen, measures: &PullMeasures, records: &[Record]) {
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
        rows.add(name, count as f64, "1", about);
    }
}

fn structure(rows: &mut Rows, specimen: &Specimen) {
    rows.add(
        "grammage",
        specimen.grammage_g_per_m2,
        "g/m2",
        "Mass of the fibres between the jaws, over their distance and the width.",
    );
    let Some(laid) = &specimen.laid else {
        return;
    };
    if let Some(cox) = laid.cox {
        rows.add(
            "cox_stiffness_index",
            cox.free,
            "kN m/g",
            "Tensile stiffness index of the same fibres, were all straight from edge to edge and strained \
             as the sheet is, and the sheet free to contract (Cox 1952): an upper bound.",
        );
    }
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
        rows.add(name, value, unit, about);
    }
    if let Some(free) = measured.free_length_um {
        let about = "Mean length of fibre between neighbouring contacts.";
        rows.add("free_segment_length", free, "µm", about);
    }
}

fn quality(measures: &PullMeasures, residual_limit: f64) -> IndexMap<String, QualityCheck> {
    let mut checks = IndexMap::from([
        (
            "frame_residual".to_owned(),
            QualityCheck::at_most(
                measures.largest_residual,
                residual_limit,
                "1",
                "Largest unbalanced force on a node over the largest force of a beam or bond, at any rest.",
            ),
        ),
        (
            "jaw_force_imbalance".to_owned(),
            QualityCheck::at_most(
                measures.largest_jaw_imbalance,
                LARGEST_IMBALANCE,
                "1",
                "Largest difference between the forces on the two jaws, over the maximum force.",
            ),
        ),
        (
            "energy_balance_error".to_owned(),
            QualityCheck::at_most(
                measures.energy_error(),
                residual_limit.max(LARGEST_ENERGY_ERROR),
                "1",
                "Work of the jaw that is neither stored nor set free by breaks, over the work.",
            ),
        ),
    ]);
    if let Some(error) = measures.largest_index_error {
        let about = "Estimated error of the failure index of what broke next, over itself, at any rest: \
                     equilibrium was found by iterations.";
        let check = QualityCheck::at_most(error, residual_limit, "1", about);
        checks.insert("failure_index_error".to_owned(), check);
    }
    checks
}
