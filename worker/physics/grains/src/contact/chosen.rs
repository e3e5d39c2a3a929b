//! The law of a scene, chosen once: from here on lists of contacts have it as a type, and nothing else
//! knows which it is.
use loadframe_api::spec::granular_scene::{ContactLaw, GranularScene, Material};
use loadframe_harness::checkpoint::CheckpointError;

use super::{
    law::{
        Across, Along, Bonded, Cemented, Coulomb, Followed, Frictionless, Hertz, HertzMindlin,
        Kept, Law, Linear, Logarithmic, Normal as _, Resisting, Spring, Viscous,
    },
    lists::{Lists, PatchLists},
    stiffness::{Side, Springs},
};

/// Lists that were read from a checkpoint, or why they cannot be.
pub(crate) type Unpacked = Result<Box<dyn Lists>, CheckpointError>;

/// A law as all see it that do not work through its blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chosen {
    /// Constants of the springs between two bodies.
    pub(crate) springs: fn(&Side, &Side) -> Springs,
    /// ∫ F_N dδ [J], given the square of F_N.
    pub(crate) energy: fn(&Spring, f64) -> f64,
    /// Tangents k_N, k_T [N/m].
    pub(crate) tangents: fn(&Spring) -> [f64; 2],
    /// What the constants of dashpots are multiplied with.
    pub(crate) dashpot: fn(&Spring) -> f64,
    /// Stiffness [N/m] of a contact that a body may come to, at a speed [m/s].
    pub(crate) foreseen: fn(&Side, f64) -> f64,
    /// The lists of a patch without contacts.
    pub(crate) lists: fn() -> Box<dyn Lists>,
    /// Reads what [`Lists::pack`] wrote.
    pub(crate) unpack: fn(&[u8]) -> Unpacked,
}

impl Chosen {
    pub(crate) fn of<F: Law>() -> Self {
        Self {
            springs: F::Normal::springs,
            energy: F::Normal::energy,
            tangents: Spring::tangents::<F::Normal>,
            dashpot: Spring::dashpot::<F::Normal>,
            foreseen: F::Normal::foreseen,
            lists: || Box::new(PatchLists::<F>::default()),
            unpack: |bytes| Ok(Box::new(PatchLists::<F>::unpack(bytes)?)),
        }
    }
}

/// A law with friction and both dashpots.
type Damped<Rough> = Viscous<Viscous<Rough, Across>, Along>;

/// The law of a scene.
pub(crate) fn law(spec: &GranularScene) -> Chosen {
    if spec.has_parallel_bonds() {
        return Chosen::of::<Cemented>();
    }
    if spec.materials.values().any(Material::is_cohesive) {
        return Chosen::of::<Bonded>();
    }
    if spec.resists_rolling() {
        // with dashpots, idle where there are none: every law takes seconds to compile
        return match spec.laws.contact {
            ContactLaw::Linear => Chosen::of::<Resisting<Damped<Coulomb<Linear, Kept>>>>(),
            ContactLaw::Logarithmic => {
                Chosen::of::<Resisting<Damped<Coulomb<Logarithmic, Kept>>>>()
            }
            ContactLaw::HertzMindlin => Chosen::of::<Resisting<Damped<HertzMindlin>>>(),
        };
    }
    match spec.laws.contact {
        ContactLaw::Linear if normals_follow(spec) => {
            law_for::<Frictionless<Linear>, Coulomb<Linear, Followed>>(spec)
        }
        ContactLaw::Linear => law_for::<Frictionless<Linear>, Coulomb<Linear, Kept>>(spec),
        ContactLaw::Logarithmic => {
            damped_law_for::<Frictionless<Logarithmic>, Coulomb<Logarithmic, Kept>>(spec)
        }
        ContactLaw::HertzMindlin => damped_law_for::<Frictionless<Hertz>, HertzMindlin>(spec),
    }
}

/// Whether normals follow from velocities: only what moves as x + Δt v was where its velocity says, so
/// no member of a clump, no facet where it meets the next, and no body that a stage gives another
/// velocity.
fn normals_follow(spec: &GranularScene) -> bool {
    !spec.has_clumps() && spec.facets.is_empty() && spec.driven_bodies().is_empty()
}

fn is_rough(spec: &GranularScene) -> bool {
    let mut materials = spec.materials.values();
    materials.any(|material| material.friction_angle() > 0.0)
}

/// The law for smooth or that for rough materials, with the dashpots that there are.
fn law_for<Smooth: Law, Rough: Law>(spec: &GranularScene) -> Chosen {
    match (is_rough(spec), spec.is_viscous()) {
        (false, [false, _]) => Chosen::of::<Smooth>(),
        (true, [false, false]) => Chosen::of::<Rough>(),
        _ => damped_law_for::<Smooth, Rough>(spec),
    }
}

/// The same with a dashpot along the normal, idle where there is none: scenes without any are rare but for springs
/// that are linear, and every law takes seconds to compile.
fn damped_law_for<Smooth: Law, Rough: Law>(spec: &GranularScene) -> Chosen {
    match (is_rough(spec), spec.is_viscous()) {
        (false, _) => Chosen::of::<Viscous<Smooth, Along>>(),
        (true, [_, false]) => Chosen::of::<Viscous<Rough, Along>>(),
        // one across the normal alone is rare, too
        (true, [_, true]) => Chosen::of::<Damped<Rough>>(),
    }
}
