//! Values read off a test.
use loadframe_api::spec::composite_bending::Way;

use super::failure;
use super::measured::Measured;
use super::model::Model;
use super::tested::Tested;
use crate::measure::face_mean_mm;
use crate::solve::Equilibrium;
use crate::supports::Face;

/// N mm in J.
const J: f64 = 1e-3;

/// A point of the curve of a section at rest under a share of its load.
pub(super) fn point(model: &Model<'_>, rest: &Equilibrium, share: f64) -> [f64; 6] {
    let [deflection, force] = drive(model, rest, share);
    let [top, bottom] = faces(model, &rest.displacements_mm);
    [deflection, force, share, top, bottom, rest.energy_n_mm]
}

/// The way of what is loaded along its load, and the force: work is one times the other.
fn drive(model: &Model<'_>, rest: &Equilibrium, share: f64) -> [f64; 2] {
    if let Some(load) = &model.spec.test.load {
        let total = load.force_n[0].hypot(load.force_n[1]);
        let pairs = model.load.iter().zip(&rest.displacements_mm);
        let work: f64 = pairs.map(|(force, u)| force * u).sum();
        return [work / total, share * total];
    }
    let way_mm = model.supports.reach_mm();
    let mut work = 0.0;
    for (place, reaction) in rest.reactions_n.iter().enumerate() {
        if let Some(way) = model.supports.prescribed(place) {
            work += reaction * way;
        }
    }
    if way_mm > 0.0 {
        [share * way_mm, work / way_mm]
    } else {
        [0.0; 2]
    }
}

/// Mean deflections of the top and the bottom face, positive where they give way.
fn faces(model: &Model<'_>, u: &[f64]) -> [f64; 2] {
    [Face::Top, Face::Bottom].map(|face| {
        let mean = face_mean_mm(model.lattice.grid(), face, u);
        mean[0] * model.direction[0] + mean[1] * model.direction[1]
    })
}

/// All results.
pub(super) fn measure(model: &Model<'_>, tested: &Tested) -> Vec<Measured> {
    let whole = match &tested.bent {
        Some(bent) => bent.measured(),
        None => at_rest(model, tested),
    };
    let Some(broken) = &tested.broken else {
        return whole;
    };
    // under the load that was given nothing may be whole any more: what does not grow with it stays
    let mut all = failure::measure(model, broken);
    all.extend(whole.into_iter().filter(|one| failure::stays(one.name)));
    all
}

/// Results of a section that is held and loaded, or moves.
fn at_rest(model: &Model<'_>, tested: &Tested) -> Vec<Measured> {
    let mut all = Vec::new();
    let mut add = |name, value, unit, description| {
        all.push(Measured {
            name,
            value,
            unit,
            description,
        });
    };
    let rest = &tested.rest;
    let section = &model.spec.section;
    let [_, force] = drive(model, rest, 1.0);
    let area = section.height_mm * section.thickness_mm;
    match model.spec.test.way() {
        Some(Way::Tension(tension)) => {
            add(
                "effective_modulus",
                force * tension.strain.signum() / area / tension.strain,
                "MPa",
                "Force over the section's area and the strain of its length.",
            );
            let grid = model.lattice.grid();
            let across = |face| face_mean_mm(grid, face, &rest.displacements_mm)[1];
            let strain = (across(Face::Top) - across(Face::Bottom)) / section.height_mm;
            add(
                "effective_poisson_ratio",
                -strain / tension.strain,
                "1",
                "Mean contraction of the height over the strain of the length.",
            );
            add("max_force", force, "N", "Force of the grips.");
        }
        Some(Way::Shear(shear)) => {
            let volume = section.length_mm * area;
            add(
                "effective_shear_modulus",
                2.0 * rest.energy_n_mm / (volume * shear.strain * shear.strain),
                "MPa",
                "Twice the energy per volume over the square of the shear strain, all faces moved \
                 as in uniform shear: an upper bound of the shear modulus of a large piece.",
            );
        }
        _ => {}
    }
    if force != 0.0 {
        if let Some(Way::Held(_)) = model.spec.test.way() {
            let [top, bottom] = faces(model, &rest.displacements_mm);
            add(
                "mean_top_deflection",
                top,
                "mm",
                "Mean displacement of the top face along the load, at rest.",
            );
            add(
                "mean_bottom_deflection",
                bottom,
                "mm",
                "Mean displacement of the bottom face along the load, at rest.",
            );
            add(
                "deflection_ratio",
                top / bottom,
                "1",
                "Mean deflection of the top face over that of the bottom face.",
            );
            if model.spec.test.load.is_none() {
                add(
                    "max_force",
                    force,
                    "N",
                    "Force on the face that is moved, along its way; of several, their work under this force over \
                     how far they move apart, the root of the squares along x and along y.",
                );
            }
        }
        add(
            "strain_energy",
            rest.energy_n_mm * J,
            "J",
            "Elastic energy at rest under the whole load.",
        );
    }
    if let Some(moved) = &tested.motion {
        add(
            "peak_deflection",
            moved.swing.peak,
            "mm",
            "Largest mean displacement of the top face along the load, or the first velocity, in time.",
        );
        add(
            "time_of_peak_deflection",
            moved.swing.peak_s,
            "s",
            "When the top face's mean displacement was largest.",
        );
        add(
            "natural_frequency",
            moved.swing.frequency_hz().unwrap_or(f64::NAN),
            "Hz",
            "Swings of the top face about its rest over the time they took.",
        );
    }
    all
}
