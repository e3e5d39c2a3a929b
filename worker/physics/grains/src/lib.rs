//! Bodies in contact: the discrete element method.
//!
//! **Model.** Bodies are spheres and rigid clumps of spheres; they move by Newton's and Euler's laws
//! under gravity and the forces of their contacts, with each other, with planes and with walls of
//! triangles. SI units, angles in radians, overlaps positive, forces of a contact on its second body.
//!
//! **Rooms**, from bottom to top; each uses only those above it in this list:
//!
//! | room | what it knows |
//! |---|---|
//! | [`numbers`] | vectors in space, and numbers side by side |
//! | [`geometry`] | spheres, their unions and neighbours |
//! | [`generate`] | sizes and places of grains that are made |
//! | [`motion`] | how bodies move under forces |
//! | [`walls`] | planes and triangles, where they are and how they move |
//! | [`contact`] | what touches, and the laws of it |
//! | [`scene`] | from a spec to a *model*, which nothing changes, and its first bodies |
//! | [`step`] | the *state*, its lists of contacts, and a step of it |
//! | [`observe`] | what is read off model and state |
//! | [`output`] | what a run keeps: journal, tables, snapshots, report |
//! | [`stages`] | what a run does, stage by stage |
//! | [`repeats`] | a test of several beds |
//! | [`ballast`] | tests of ballast: scenes, read in the terms of a test |
//! | [`soil`] | tests of soil, alike |
//!
//! **Data road.** [`scene::specimen`] lists every body, those that [`generate`] makes included;
//! [`scene::model`] resolves spec and specimen into a model and the first bodies: every sphere that
//! collides, in arrays ([`scene::particles`]), clumps, walls. [`step::listing`] sorts
//! particles along a curve through space, cuts them into patches of some two thousand, and fills
//! each [`step::patch`] with candidates for contact from the search of [`geometry::neighbours`]; what
//! contacts remember is carried over. A step of the [`step::engine`] has two phases: [`contact`] turns
//! positions into forces, patch by patch; [`motion`] turns forces into new positions. [`stages::run`]
//! goes through the stages, whose drives move walls and bodies; when something is due it looks at the
//! scene between the phases ([`observe`]) and keeps it in the [`output::journal`], of which
//! [`output`] makes files and results. Between steps a stage may put bodies in or take them out: arrays
//! and lists are made anew, bodies keep their numbers. It may set walls down and change the moduli.
//!
//! **Numbers.** Contacts are worked through in vectors of 8, 4 or 1 ([`numbers::lanes`]), each
//! lane a contact, with nothing fused: every machine gives the same bits. Forces on a particle are
//! summed in the order of the list, and what comes from other patches after that, in the order of
//! patches: any number of threads gives the same bits. What changes is in `State` and `Journal`,
//! which are the checkpoint.
//!
//! **Only what is used.** The law of contact is a type parameter of the lists of contacts, chosen once,
//! in [`contact::chosen`]; behind [`Lists`](contact::lists::Lists) nothing else knows of it. A scene
//! without cohesion has no bonds, one without restitution no dashpots, a frictionless one has
//! contacts without memory and particles without spin. Bodies without a degree of freedom have
//! contacts only with what follows its force or tells it, a plate for one; scenes without clumps or
//! planes have empty lists of them.
//!
//! **To add.** A law is a file with an `impl Law` and an `impl Lanewise`, and a line in
//! [`contact::chosen`]. A shape of wall is a list beside those of planes and facets, a stage a variant
//! of the spec's `Stage` and its arm in [`stages`]. A test in its own terms is a script of stages and a
//! reader of their curve, as in [`soil`].
pub mod ballast;
mod contact;
mod generate;
mod geometry;
mod motion;
mod numbers;
mod observe;
mod output;
mod repeats;
mod scene;
pub mod soil;
mod stages;
mod step;
mod walls;

pub use contact::WATCHES;
use loadframe_api::spec::granular_scene::{GranularScene, Stage};
use loadframe_harness::{Ending, Halt, Recorder, RunContext, SimulationError};

use output::warnings::Fields;

/// Draws the scene of `spec` as it is before its first step; returns what is shown.
///
/// # Errors
/// When there is no such scene, or the recorder fails.
pub fn preview(
    spec: &GranularScene,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<String, Halt> {
    stages::run::preview(spec, context, recorder)?;
    let words = "The scene before its first step.";
    let comes = |stage: &Stage| {
        matches!(
            stage,
            Stage::Insert(_) | Stage::Place(_) | Stage::Replace(_)
        )
    };
    Ok(match spec.stages.iter().any(comes) {
        true => format!("{words} What its stages put in later is not in it yet."),
        false => words.to_owned(),
    })
}

/// Runs the scene of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &GranularScene,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    let (ending, _) = stages::run::run(spec, Fields::Scene, context, recorder)?;
    Ok(ending)
}
