//! Results of a run, and whether to believe them.
use loadframe_api::{BodyProperties, Report, spec::granular_scene::GranularScene};
use loadframe_harness::ReportBuilder;

use super::{
    journal::{Journal, Worst},
    warnings::{Fields, warn},
};
use crate::{numbers::Vector, step::engine::Engine};

/// δ/r beyond which a linear contact of stiff grains is not what it stands for.
const LARGEST_OVERLAP: f64 = 0.05;
/// Of the critical step; beyond it an undamped gas of grains gains 20 % energy in a minute's run.
const LARGEST_STEP_RATIO: f64 = 0.4;
/// The same where local damping takes what a step creates. A rail bed that asks for 0.6 of the critical step is
/// 39 % off, one that asks for 0.4 is not (guide, ballast). Between looks contacts stiffen: beds that ask for 0.4
/// come up to 0.52 to 0.67 for a moment, those that ask for 0.6 to 0.77 and more.
const LARGEST_DAMPED_STEP_RATIO: f64 = 0.7;
/// Created over largest energy.
const LARGEST_CREATION: f64 = 0.05;
/// I beyond which bodies that are driven do not follow at once ([GdrMidi2004]).
const LARGEST_INERTIAL_NUMBER: f64 = 1e-3;
/// Mean unbalanced force ratio of driven stages beyond which their forces are those of motion.
const LARGEST_UNBALANCED: f64 = 0.1;

pub(crate) fn report(
    spec: &GranularScene,
    engine: &Engine,
    journal: &Journal,
    fields: Fields,
) -> Report {
    let escaped = engine.escaped_bodies();
    let mut report = ReportBuilder::new("stages_done");
    results(&mut report, engine, journal, escaped.len());
    checks(&mut report, spec, engine, journal);
    warn(&mut report, spec, engine, journal, &escaped, fields);
    for (name, count) in [
        ("steps", engine.state.step),
        (
            "particle_steps",
            engine.state.step * engine.state.particles.len() as u64,
        ),
        ("candidate_steps", journal.candidate_steps),
        ("neighbour_searches", engine.state.lists),
        ("particle_bytes", engine.state.particles.bytes()),
        ("contact_bytes", engine.contact_bytes()),
    ] {
        report.work(name, count);
    }
    let describes_bodies = GranularScene::describes_bodies(engine.model.masses.len());
    Report {
        bodies: if describes_bodies {
            bodies(engine)
        } else {
            Vec::new()
        },
        ..report.finish()
    }
}

fn results(report: &mut ReportBuilder, engine: &Engine, journal: &Journal, escaped: usize) {
    let last = &journal.last;
    let mut masses: Vec<(u32, f64)> = engine
        .present_bodies()
        .map(|(body, mass, _)| (body, mass))
        .collect();
    // summed in the order of numbers
    masses.sort_unstable_by_key(|(body, _)| *body);
    let mass: f64 = masses.iter().map(|(_, mass)| mass).sum();
    let rows: [(&str, Option<f64>, &str, &str); 12] = [
        (
            "simulated_time",
            Some(engine.state.time),
            "s",
            "Time at the end.",
        ),
        (
            "steps",
            Some(engine.state.step as f64),
            "1",
            "Time steps done.",
        ),
        (
            "time_step",
            Some(journal.time_step),
            "s",
            "The last time step.",
        ),
        (
            "bodies",
            Some(masses.len() as f64),
            "1",
            "Bodies of the scene at the end; each sphere of a breakable one is one.",
        ),
        (
            "particles",
            Some(engine.state.particles.len() as f64),
            "1",
            "Spheres, members of clumps included.",
        ),
        (
            "total_mass",
            Some(mass),
            "kg",
            "Mass of all bodies at the end.",
        ),
        (
            "contacts",
            Some(last.contacts as f64),
            "1",
            "Touching contacts at the end.",
        ),
        (
            "coordination_number",
            last.coordination,
            "1",
            "Contacts per movable body at the end.",
        ),
        (
            "kinetic_energy",
            Some(last.kinetic),
            "J",
            "Of movable bodies at the end.",
        ),
        (
            "elastic_energy",
            Some(last.elastic),
            "J",
            "In the contacts at the end.",
        ),
        (
            "unbalanced_force_ratio",
            last.unbalanced,
            "1",
            "Mean resultant force on a movable body over the mean contact force, at the end: near 0 at rest.",
        ),
        (
            "escaped_bodies",
            Some(escaped as f64),
            "1",
            "Movable bodies behind a plane, or farther from the box of all bodies at the start and all walls than its diagonal; along a plane that gravity keeps them on they may go as far as they like.",
        ),
    ];
    for (name, value, unit, description) in rows {
        report.result(name, value, unit, description);
    }
    let made = engine.state.bonds_made;
    if made > 0 {
        let broken = engine.broken_bonds(last);
        report.count("bonds", made as usize, "Bonds made at the start.");
        report.count("broken_bonds", broken as usize, "Bonds that broke.");
    }
    if !journal.replacements.is_empty() {
        let done = &journal.replacements;
        let count: u64 = done.iter().map(|done| done.spheres).sum();
        let mass = |of: usize| done.iter().map(|done| done.masses[of]).sum();
        let overlap = done.iter().map(|done| done.overlap_ratio);
        let rows = [
            (
                "replaced_spheres",
                count as f64,
                "1",
                "Spheres that clumps took the places of.",
            ),
            (
                "mass_before_replacing",
                mass(0),
                "kg",
                "Mass of these spheres.",
            ),
            ("mass_after_replacing", mass(1), "kg", "Mass of the clumps."),
            (
                "overlap_after_replacing",
                overlap.fold(0.0, f64::max),
                "1",
                "Largest overlap over the smaller radius when clumps had just taken the places of spheres.",
            ),
        ];
        for (name, value, unit, description) in rows {
            report.result(name, value, unit, description);
        }
    }
    if journal.removed_bodies > 0 {
        let count = journal.removed_bodies as f64;
        report.result("removed_bodies", count, "1", "Bodies that stages took out.");
        report.result("removed_mass", journal.removed_mass, "kg", "Their mass.");
    }
}

fn checks(report: &mut ReportBuilder, spec: &GranularScene, engine: &Engine, journal: &Journal) {
    let worst = journal.worst.with(&engine.state.seen);
    report.check(
        "largest_overlap_ratio",
        worst.overlap_ratio,
        LARGEST_OVERLAP,
        "1",
        "Largest overlap of any step over the smaller radius: grains this soft are not stiff grains.",
    );
    report.check(
        "step_over_critical",
        worst.step_ratio,
        if spec.local_damping() > 0.0 {
            LARGEST_DAMPED_STEP_RATIO
        } else {
            LARGEST_STEP_RATIO
        },
        "1",
        &limit(engine, &worst),
    );
    if !engine.model.has_driven_bodies {
        report.check(
            "created_energy_ratio",
            journal.balance.created_ratio(),
            LARGEST_CREATION,
            "1",
            &format!(
                "Energy that the integration made, over the largest kinetic and elastic energy: by \
                     {} looks in {} steps, between which more may come and go.",
                journal.balance.looks, engine.state.step
            ),
        );
    }
    if let Some(worst) = journal.servo {
        report.check(
            "servo_force_error",
            worst.ratio,
            LARGEST_SERVO_ERROR,
            "1",
            &format!(
                "Largest error of the force on a servo when its stage ended, over the force asked for: \
                 of {:?} in stage {}.",
                engine.wall_name(worst.wall),
                worst.stage + 1
            ),
        );
    }
    if let Some([number, ratio]) = journal.driving.means() {
        report.check(
            "inertial_number",
            number,
            LARGEST_INERTIAL_NUMBER,
            "1",
            "Mean over the looks at stages that drive, weighed by pressure: above the bound the bodies' inertia shows.",
        );
        report.check(
            "driven_unbalanced_force_ratio",
            ratio,
            LARGEST_UNBALANCED,
            "1",
            "Mean resultant force on a body over the mean contact force, over the looks at stages that drive, weighed by pressure.",
        );
    }
}

/// Force error of servos at the end of their stages, over the force.
const LARGEST_SERVO_ERROR: f64 = 0.05;

/// What set the time step, and what softening it would save.
fn limit(engine: &Engine, worst: &Worst) -> String {
    let first = "Largest time step over the critical one: of the contacts of each body together \
                 when they were looked at, of any that may touch alone at every step.";
    let Some(critical) = worst.critical else {
        return format!("{first} Nothing touched.");
    };
    let factor = critical.median.map(|median| median / critical.step);
    let saving = if let Some(factor) = factor.filter(|factor| *factor > 1.01) {
        format!(
            "; half of the bodies would allow {factor:.1} times as much, so softening this contact \
             would save up to {:.0} % of the steps",
            100.0 * (1.0 - 1.0 / factor)
        )
    } else if factor.is_some() {
        "; most bodies are as critical, so only softening all of them would save steps: a hundredth \
         of the modulus takes a tenth"
            .to_owned()
    } else {
        String::new()
    };
    format!(
        "{first} That was {:.2e} s, set by {} and its contact with {}{saving}.",
        critical.step,
        engine.name_of(critical.body),
        engine.name_of(critical.partner)
    )
}

fn bodies(engine: &Engine) -> Vec<BodyProperties> {
    let state = &engine.state;
    let mut bodies = Vec::with_capacity(engine.model.masses.len());
    for (particle, owner) in state.particles.owners.iter().enumerate() {
        let inertia = engine.model.sphere_inertias[*owner as usize];
        if inertia > 0.0 {
            let diagonal = nalgebra::Matrix3::from_diagonal_element(inertia);
            bodies.push(properties(
                *owner,
                engine,
                state.particles.centres[particle].vector(),
                diagonal,
            ));
        }
    }
    for clump in &state.clumps {
        bodies.push(properties(
            clump.body,
            engine,
            clump.centre,
            clump.global_inertia(),
        ));
    }
    bodies.sort_by_key(|body| body.body);
    bodies
}

fn properties(
    body: u32,
    engine: &Engine,
    centre: Vector,
    inertia: nalgebra::Matrix3<f64>,
) -> BodyProperties {
    BodyProperties {
        body,
        mass_kg: engine.model.masses[body as usize],
        centre_m: centre.into(),
        inertia_kg_m2: std::array::from_fn(|row| {
            std::array::from_fn(|column| inertia[(row, column)])
        }),
    }
}
