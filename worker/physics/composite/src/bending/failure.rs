//! Values read off a section that broke.
use loadframe_api::spec::composite_bending::Way;

use super::measured::Measured;
use super::model::Model;
use super::split;
use super::tested::Broken;
use crate::breaking::{EndReason, Event};

/// N mm in J.
const J: f64 = 1e-3;

/// Results of the whole section that do not grow with its load.
const STAY: [&str; 8] = [
    "flexural_modulus",
    "bending_modulus",
    "flexural_modulus_without_shear",
    "shear_deflection_share",
    "span_to_depth",
    "effective_modulus",
    "effective_poisson_ratio",
    "effective_shear_modulus",
];

/// Whether a result of the whole section is one of a section that breaks, too.
pub(super) fn stays(name: &str) -> bool {
    STAY.contains(&name)
}

/// Why the test ended, as a word for programs.
pub(super) fn stop_reason(reason: EndReason) -> &'static str {
    match reason {
        EndReason::NothingBreaks => "nothing_breaks",
        EndReason::ForceFell => "force_dropped",
        EndReason::Events => "max_events",
        EndReason::Displacement => "max_displacement",
    }
}

pub(super) fn measure(model: &Model<'_>, broken: &Broken) -> Vec<Measured> {
    let mut all = Vec::new();
    let mut add = |name, value, unit, description| {
        all.push(Measured {
            name,
            value,
            unit,
            description,
        });
    };
    let peak = broken.peak.as_ref();
    let force = peak.map_or(f64::NAN, |peak| peak.force_n);
    add(
        "max_force",
        force,
        "N",
        "Largest force that the machine sees.",
    );
    add(
        "displacement_at_max_force",
        peak.map_or(f64::NAN, |peak| peak.displacement_mm),
        "mm",
        "Way of what is driven at the largest force, along the force; of rollers with what all dent.",
    );
    strengths(model, broken, force, &mut add);
    let first = broken.events.first();
    let of_first = |value: fn(&Event) -> f64| first.map_or(f64::NAN, value);
    add(
        "first_crack_force",
        of_first(|event| event.force_n),
        "N",
        "Force at which the first part of the section reaches its strength.",
    );
    add(
        "first_crack_displacement",
        of_first(|event| event.displacement_mm),
        "mm",
        "Way of what is driven at that moment.",
    );
    let stiffness = of_first(|event| event.force_n / event.displacement_mm);
    add(
        "initial_stiffness",
        stiffness,
        "N/mm",
        "Force over way before the first crack.",
    );
    let totals = &broken.totals;
    let dissipated = &totals.dissipated;
    for (name, value, description) in [
        (
            "dissipated_energy",
            dissipated.total_n_mm(),
            "Energy that all cracks took.",
        ),
        (
            "dissipated_in_matrix",
            dissipated.matrix_n_mm,
            "Energy that cracks of the matrix or of plies took.",
        ),
        (
            "dissipated_in_fibres",
            dissipated.fibres_n_mm,
            "Energy that breaks of fibres took.",
        ),
        (
            "dissipated_at_interfaces",
            dissipated.interfaces_n_mm,
            "Energy that fibres took to come off.",
        ),
        (
            "dissipated_between_plies",
            dissipated.ply_faces_n_mm,
            "Energy that plies took to come apart.",
        ),
    ] {
        add(name, value * J, "J", description);
    }
    add(
        "crack_area",
        totals.crack_area_mm2,
        "mm2",
        "Area of cracks that are open through.",
    );
    add(
        "cracks",
        totals.events as f64,
        "1",
        "Events: steps in which parts of cells lost stiffness.",
    );
    add(
        "broken_cells",
        totals.broken_cells as f64,
        "1",
        "Cells with a crack that is open through.",
    );
    all
}

/// Strengths as the standards word them, from the largest force.
fn strengths(
    model: &Model<'_>,
    broken: &Broken,
    force: f64,
    add: &mut impl FnMut(&'static str, f64, &'static str, &'static str),
) {
    let section = &model.spec.section;
    let sides = [section.thickness_mm, section.height_mm];
    let area = section.thickness_mm * section.height_mm;
    let way = model.spec.test.way();
    if let (Some((flexure, given)), Some(way)) = (model.flexure(), way) {
        if matches!(way, Way::ShortBeam(_)) {
            add(
                "interlaminar_shear_strength",
                0.75 * force / area,
                "MPa",
                "Apparent interlaminar shear strength 3F/(4bh) of ISO 14130.",
            );
        } else {
            add(
                "flexural_strength",
                flexure.loading.outer_stress(given.span_mm, sides, force),
                "MPa",
                "Stress of the outer fibre at midspan under the largest force by the standard's formula, as \
                 of one material.",
            );
        }
    } else if matches!(way, Some(Way::DoubleCantilever(_))) {
        if let Some(peeled) = split::peeled(model, broken) {
            add(
                "release_rate",
                peeled.release_rate,
                "N/mm",
                "Energy that the arms release per area while the crack grows, by the theory of beams from \
                 force and opening: G_I where the arms are alike.",
            );
            add(
                "energy_per_crack_area",
                peeled.energy_per_area,
                "N/mm",
                "Energy that the crack took per area while it grew.",
            );
            add(
                "beam_stiffness",
                peeled.beam_stiffness,
                "N/mm",
                "Force over opening of two cantilevers as long as the first crack, by the theory of beams.",
            );
            add(
                "crack_length",
                peeled.crack_length_mm,
                "mm",
                "Length of the crack at the end whose beams are as soft.",
            );
        }
    } else if matches!(way, Some(Way::Tension(_))) {
        add(
            "tensile_strength",
            force / area,
            "MPa",
            "Largest force over the section's area.",
        );
    }
}

/// Part of a fracture energy by which the steps of softening may miss it, beyond which it is told.
const SAW: f64 = 0.05;
/// Cells over the length of the zone in which a crack opens, beyond which it takes markedly too much.
const COARSE: f64 = 1.0 / 8.0;
/// What a crack that grows takes too much, over that ratio, see [`crate::breaking::Totals`].
const TOO_MUCH: f64 = 0.8;
/// Part of the volume of cracks in which their faces overlap, beyond which it is told.
pub(super) const OVERLAPPING: f64 = 0.1;

/// What a reader of the result should know.
pub(super) fn warnings(broken: &Broken) -> Vec<(&'static str, String)> {
    let totals = &broken.totals;
    let mut warnings = Vec::new();
    if totals.energy_follows_grid {
        warnings.push((
            "energy_follows_grid",
            "something that breaks has no fracture energy: what its cracks take, and how the force falls after \
             the peak, follow the size of the cells; give fracture_energy_n_per_mm"
                .to_owned(),
        ));
    }
    if totals.saw_error > SAW {
        warnings.push((
            "coarse_softening",
            format!(
                "the steps in which cracks open may miss their fracture energy by {:.0} %; more teeth in \
                 breaking make that less, in proportion",
                100.0 * totals.saw_error
            ),
        ));
    }
    if totals.coarseness > COARSE {
        warnings.push((
            "coarse_cracks",
            format!(
                "cells where cracks opened are {:.2} of the zone in which a crack opens, l = EG/f²: a crack that \
                 grows through them takes about {:.0} % more than its fracture energy; smaller cells make that \
                 less, in proportion",
                totals.coarseness,
                100.0 * TOO_MUCH * totals.coarseness
            ),
        ));
    }
    if totals.overlap_share > OVERLAPPING {
        warnings.push((
            "cracks_overlap",
            format!(
                "in {} cells the faces of a crack are pressed into each other, by up to {:.2e} mm and by {:.0} % \
                 of the volume of all cracks: which faces meet was not found, and in compression the section \
                 is stronger than it is told",
                totals.overlapping_cells,
                totals.overlap_mm,
                100.0 * totals.overlap_share
            ),
        ));
    }
    if totals.overlap_share <= OVERLAPPING && totals.turns_left > 0 {
        warnings.push((
            "cracks_overlap",
            format!(
                "{} times of {} events it was not found which faces of cracks meet, so that some overlapped \
                 until the next",
                totals.turns_left, totals.events
            ),
        ));
    }
    if totals.overloaded_cells > 0 {
        warnings.push((
            "closed_cracks_overloaded",
            format!(
                "in {} of {} cells in which cracks have closed, their faces press on each other by more than \
                 the material bears in compression, which does not crush it here: the section is weaker \
                 than it is told",
                totals.overloaded_cells, totals.closed_cells
            ),
        ));
    }
    if totals.contacts_kept > 0 {
        warnings.push((
            "contact_not_followed",
            format!(
                "{} times no contact of the rollers with the broken section was found, {} times there was one: \
                 where not, their forces kept the proportions they had",
                totals.contacts_kept, totals.contacts
            ),
        ));
    }
    match broken.reason {
        EndReason::Events => warnings.push((
            "max_events",
            format!(
                "the test ended after {} events, before its force fell; raise max_events in breaking",
                totals.events
            ),
        )),
        EndReason::NothingBreaks if totals.events == 0 => warnings.push((
            "nothing_breaks",
            "no part of the section reaches a strength under this load, however large".to_owned(),
        )),
        _ => {}
    }
    warnings
}
