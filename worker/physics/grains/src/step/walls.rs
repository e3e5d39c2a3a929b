//! The walls of a scene by number, planes before meshes.
use loadframe_api::surface::Point;

use super::engine::Engine;
use crate::walls::motion::WallMotion;

impl Engine {
    /// Number of a wall, planes before meshes.
    pub(crate) fn wall(&self, name: &str) -> Option<usize> {
        let planes = self.model.planes.iter().map(|plane| &plane.name);
        let meshes = self.model.facets.meshes.iter().map(|mesh| &mesh.name);
        planes.chain(meshes).position(|known| known == name)
    }

    /// Planes and meshes together.
    pub(crate) fn wall_count(&self) -> usize {
        self.state.faces.len() + self.state.poses.len()
    }

    pub(crate) fn wall_motion(&mut self, wall: usize) -> &mut WallMotion {
        let planes = self.state.faces.len();
        match self.state.faces.get_mut(wall) {
            Some(face) => &mut face.motion,
            None => &mut self.state.poses[wall - planes].motion,
        }
    }

    /// How far a wall has come [m], turning left out.
    pub(crate) fn wall_displacement(&self, wall: usize) -> Point {
        self.motion_of(wall).displacement
    }

    /// Velocity of a wall [m/s], turning left out.
    pub(crate) fn wall_velocity(&self, wall: usize) -> Point {
        self.motion_of(wall).velocity
    }

    fn motion_of(&self, wall: usize) -> &WallMotion {
        let planes = self.state.faces.len();
        match self.state.faces.get(wall) {
            Some(face) => &face.motion,
            None => &self.state.poses[wall - planes].motion,
        }
    }
}
