//! All that changes during a run, bodies, walls and time.
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    alone::{Seen, Through},
    patch::Patch,
};
use crate::{
    geometry::neighbours::skin::Skin,
    motion::clump::Clump,
    scene::particles::Particles,
    walls::{Face, facets::Pose},
};

/// What changes during a run, all of it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) particles: Particles,
    pub(crate) clumps: Vec<Clump>,
    pub(crate) faces: Vec<Face>,
    /// Of each mesh.
    pub(crate) poses: Vec<Pose>,
    pub(crate) patches: Vec<Patch>,
    pub(super) skin: Skin,
    /// Whether the lists hold for the next step.
    pub(crate) is_listed: bool,
    /// Steps done.
    pub(crate) step: u64,
    /// [s].
    pub(crate) time: f64,
    /// Δt of the last step [s].
    pub(super) last_step: f64,
    /// Lists made.
    pub(crate) lists: u64,
    /// Work that moving walls have done on the bodies [J].
    pub(crate) wall_work: f64,
    /// Bonds made, at the start and of bodies that were put in.
    pub(crate) bonds_made: u64,
    /// Intact bonds of bodies that were taken out.
    pub(crate) bonds_removed: u64,
    /// Of all steps that count.
    pub(crate) seen: Seen,
    /// By number of the wall, planes before meshes.
    pub(crate) through: BTreeMap<u32, Through>,
    /// Upper bound of the speeds after the last step [m/s].
    pub(crate) speed_bound: f64,
    /// What tan φ is multiplied with.
    pub(super) friction_factor: f64,
    /// What every modulus is multiplied with.
    pub(crate) stiffness_factor: f64,
    /// What cohesions are multiplied with.
    pub(crate) cohesion_factor: f64,
}
