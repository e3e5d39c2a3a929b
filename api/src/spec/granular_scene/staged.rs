//! What the stages of a scene say about its walls and bodies.
use std::collections::BTreeSet;

use super::{Drive, GranularScene, Material, Stage};

impl GranularScene {
    /// The `drive` stages.
    fn drives(&self) -> impl Iterator<Item = &Drive> {
        self.stages.iter().filter_map(|stage| match stage {
            Stage::Drive(drive) => Some(drive),
            _ => None,
        })
    }

    /// Walls whose force and displacement are written as vectors: those of `record.walls` and those
    /// that some stage drives.
    pub fn recorded_walls(&self) -> Vec<&str> {
        let asked = self.record.walls.iter();
        let driven = self.drives().flat_map(|drive| &drive.walls);
        let mut seen = BTreeSet::new();
        let walls = asked.chain(driven.map(|wall| &wall.name));
        let walls = walls.map(String::as_str);
        walls.filter(|name| seen.insert(*name)).collect()
    }

    /// Bodies that some stage drives or sets down.
    pub fn driven_bodies(&self) -> Vec<u32> {
        let bodies = self.drives().flat_map(|drive| &drive.bodies);
        let bodies = bodies.map(|drive| drive.body);
        let mut bodies: Vec<u32> = bodies.chain(self.placed_bodies()).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    /// Names of all walls, planes before facets.
    pub fn wall_names(&self) -> impl Iterator<Item = &str> {
        let planes = self.planes.iter().map(|plane| plane.name.as_str());
        planes.chain(self.facets.iter().map(|mesh| mesh.name.as_str()))
    }

    /// Whether bodies of some material are bonded.
    pub fn is_cohesive(&self) -> bool {
        self.materials.values().any(Material::is_cohesive)
    }

    /// Whether bodies may sit in each other at the start.
    pub(super) fn is_relaxed_first(&self) -> bool {
        matches!(self.stages.first(), Some(Stage::Relax(_)))
    }
}
