//! Bodies in contact: the discrete element method.
//!
//! **Model.** Bodies are spheres and rigid clumps of spheres; they move by Newton's and Euler's laws
//! under gravity and the forces of their contacts, with each other, with planes and with [`facets`]. SI units,
//! angles in radians, overlaps positive, forces of a contact on its second body.
//!
//! **Data road.** [`specimen`] lists every body, those that [`generate`] makes included; [`scene`]
//! resolves spec and specimen into a *model*, which nothing changes, and the first
//! *state*: [`particles`] (every sphere that collides, in arrays), clumps, walls. [`listing`] sorts
//! particles along a curve through space, cuts them into patches of some two thousand, and fills
//! each [`patch`] with candidates for contact from the search of [`neighbours`]; what contacts
//! remember is carried over. A step of the [`engine`] has two phases: [`contact`] turns positions
//! into forces, patch by patch; [`motion`] turns forces into new positions. [`run`] goes through
//! the stages, whose [`drives`] move walls and bodies; when something is due it observes the scene
//! between the phases ([`observe`], [`measure`], [`time_step`], [`inspect`], [`fragments`]) and keeps
//! it in the [`journal`], from which [`tables`], [`snapshot`] and [`report`] make files and results.
//! Between steps a stage may put bodies in ([`supply`]) or take them out ([`removal`]): arrays and
//! lists are made anew, bodies keep their numbers. It may set walls down ([`placing`]) and change
//! the moduli ([`stiffening`]).
//!
//! **Numbers.** Contacts are worked through in vectors of 8, 4 or 1 ([`lanes`], [`rows`]), each
//! lane a contact, with nothing fused: every machine gives the same bits. Forces on a particle are
//! summed in the order of the list, and what comes from other patches after that, in the order of
//! patches: any number of threads gives the same bits. What changes is in `State` and `Journal`,
//! which are the checkpoint.
//!
//! **Only what is used.** The law of contact is a type parameter of the lists of contacts, chosen once,
//! here; behind [`Lists`](contact::lists::Lists) nothing else knows of it. A scene without
//! cohesion has no bonds, one without restitution no dashpots, a frictionless one has
//! contacts without memory and particles without spin. Bodies without a degree of freedom have
//! no contacts among themselves, scenes without clumps or planes have empty lists of them.
//!
//! **To add.** A law is a file with an `impl Law` and an `impl Lanewise`, and a line here. A shape of wall
//! is a list beside `WallList`, a stage a variant of the spec's `Stage` and its arm in [`run`]. A test
//! in its own terms is a script of stages and a reader of their curve, as in [`ballast`].
mod ahead;
pub mod ballast;
mod breaks;
mod clump_geometry;
mod contact;
mod drives;
mod engine;
mod facets;
mod fragments;
mod generate;
mod inspect;
mod journal;
mod lanes;
mod listing;
mod measure;
mod motion;
mod neighbours;
mod observe;
mod particles;
mod patch;
mod placing;
mod removal;
mod report;
mod rows;
mod run;
mod scene;
mod shares;
mod snapshot;
mod solid_share;
mod specimen;
mod sphere;
mod stages;
mod stiffening;
mod supply;
mod survey;
mod tables;
mod time_step;

use contact::law::{
    Bonded, Chosen, Coulomb, Followed, Frictionless, Hertz, HertzMindlin, Kept, Law, Linear,
    Logarithmic, Viscous, ViscousShear,
};
use loadframe_api::spec::granular_scene::{ContactLaw, GranularScene, Material};
use loadframe_harness::{Ending, Recorder, RunContext, SimulationError};

/// A point or vector in space, SI.
type Vector = nalgebra::Vector3<f64>;

/// Runs the scene of `spec`.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &GranularScene,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    run::run(spec, law(spec), context, recorder)
}

/// The law of a scene.
fn law(spec: &GranularScene) -> Chosen {
    if spec.materials.values().any(Material::is_cohesive) {
        return Chosen::of::<Bonded>();
    }
    match spec.laws.contact {
        ContactLaw::Linear if normals_follow(spec) => {
            law_for::<Frictionless<Linear>, Coulomb<Linear, Followed>>(spec)
        }
        ContactLaw::Linear => law_for::<Frictionless<Linear>, Coulomb<Linear, Kept>>(spec),
        ContactLaw::Logarithmic => {
            law_for::<Frictionless<Logarithmic>, Coulomb<Logarithmic, Kept>>(spec)
        }
        ContactLaw::HertzMindlin => law_for::<Frictionless<Hertz>, HertzMindlin>(spec),
    }
}

/// Whether normals follow from velocities: only what moves as x + Δt v was where its velocity says, so
/// no member of a clump, no facet where it meets the next, and no body that a stage gives another
/// velocity.
fn normals_follow(spec: &GranularScene) -> bool {
    !spec.has_clumps() && spec.facets.is_empty() && spec.driven_bodies().is_empty()
}

/// The law for smooth or that for rough materials, with the dashpots that there are.
fn law_for<Smooth: Law, Rough: Law>(spec: &GranularScene) -> Chosen {
    let mut materials = spec.materials.values();
    let is_rough = materials.any(|material| material.friction_angle_rad > 0.0);
    match (is_rough, spec.is_viscous()) {
        (false, [false, _]) => Chosen::of::<Smooth>(),
        (false, [true, _]) => Chosen::of::<Viscous<Smooth>>(),
        (true, [false, false]) => Chosen::of::<Rough>(),
        (true, [true, false]) => Chosen::of::<Viscous<Rough>>(),
        // one across the normal alone is rare, and has an idle one along it
        (true, [_, true]) => Chosen::of::<Viscous<ViscousShear<Rough>>>(),
    }
}
