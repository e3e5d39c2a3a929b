//! What goes through the stages: an engine, its journal, and what stages need beside them.
use std::{borrow::Cow, collections::BTreeMap, ops::Range};

use loadframe_api::spec::granular_scene::{Body, GranularScene, TimeStep};
use loadframe_harness::{Halt, InterruptSource, checkpoint::Fingerprint};
use loadframe_numerics::Team;

use crate::{
    contact::chosen::law, output::journal::Journal, scene::specimen::Specimen, step::engine::Engine,
};

/// What goes through the stages.
pub(crate) struct Runner<'a> {
    pub(crate) spec: &'a GranularScene,
    pub(crate) engine: Engine,
    pub(crate) journal: Journal,
    /// Bodies that wait for a stage, by its number.
    pub(crate) reserved: BTreeMap<usize, Range<usize>>,
    /// Spheres whose places they take, by number of the stage.
    pub(crate) replaced: BTreeMap<usize, Vec<u32>>,
    /// All bodies as they are described.
    pub(super) bodies: Cow<'a, [Body]>,
    pub(super) recorded: Vec<u32>,
    /// Part of the critical step that an automatic one takes; `None` when the step is given.
    pub(super) automatic: Option<f64>,
    /// Critical step of contacts that may come, whether there are any now [s]: with the plates that there
    /// are now, and with walls that stand.
    pub(super) foreseen: [f64; 2],
    pub(super) smallest_radius: f64,
    pub(super) fingerprint: Fingerprint,
    pub(super) interrupt: &'a dyn InterruptSource,
}

impl<'a> Runner<'a> {
    /// # Errors
    /// An interrupt while the scene is made, or why it cannot be.
    pub(super) fn new(
        spec: &'a GranularScene,
        team: Team,
        interrupt: &'a dyn InterruptSource,
    ) -> Result<Self, Halt> {
        let specimen = Specimen::new(spec, interrupt)?;
        let engine = Engine::new(spec, law(spec), &specimen, team, interrupt)?;
        let speed = GranularScene::first_speed(&specimen.bodies);
        let foreseen = [engine.foreseen(spec, &specimen.bodies, speed, &[]); 2];
        // also of bodies that are held: others, and walls, may pass through them
        let radii = specimen.bodies.iter().map(|body| body.smallest_radius());
        let smallest_radius = radii.fold(f64::INFINITY, f64::min);
        let automatic = match spec.time_step_s {
            TimeStep::Given(_) => None,
            TimeStep::Automatic(_) => Some(spec.accuracy.knobs().critical_step_fraction),
        };
        Ok(Self {
            spec,
            engine,
            journal: Journal::default(),
            recorded: spec.recorded_bodies(specimen.numbers()),
            reserved: specimen.waiting,
            replaced: specimen.replaced,
            bodies: specimen.bodies,
            automatic,
            foreseen,
            smallest_radius,
            fingerprint: Fingerprint::of(spec)?,
            interrupt,
        })
    }
}
