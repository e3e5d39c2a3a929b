//! The walls of a scene by number, planes before meshes.
use loadframe_api::surface::Point;

use super::engine::Engine;
use crate::{contact::freedom::ROTATIONS, walls::motion::WallMotion};

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

    /// 1/m of each wall that follows forces now [1/kg], 0 of the others.
    pub(crate) fn plates(&self) -> Vec<f64> {
        let walls = 0..self.wall_count();
        let loads = walls.map(|wall| self.motion_of(wall).load);
        loads
            .map(|load| load.map_or(0.0, |load| 1.0 / load.mass))
            .collect()
    }

    /// Bits of the degrees of freedom that each wall does not follow forces along now.
    pub(crate) fn walls_held(&self) -> Vec<u8> {
        let walls = 0..self.wall_count();
        let loads = walls.map(|wall| self.motion_of(wall).load);
        loads
            .map(|load| {
                let is_held = |axis: usize| load.is_none_or(|load| !load.free[axis]);
                let bits = (0..3).map(|axis| u8::from(is_held(axis)) << axis);
                ROTATIONS + bits.sum::<u8>()
            })
            .collect()
    }

    /// Walls whose contacts are added up as they are listed: those that follow forces.
    pub(crate) fn followers(&self) -> Vec<bool> {
        let motions = (0..self.wall_count()).map(|wall| self.motion_of(wall));
        motions
            .map(|motion| motion.load.is_some() || motion.servo.is_some())
            .collect()
    }

    /// Tells servos what may touch them.
    pub(crate) fn tell_servos(&mut self) {
        let state = &mut self.state;
        for (wall, face) in state.faces.iter_mut().enumerate() {
            if let Some(servo) = &mut face.motion.servo {
                let parts = state.patches.iter();
                let parts = parts.filter_map(|patch| patch.at_plates.get(wall));
                servo.stiffness = parts.map(|[stiffness, _]| stiffness).sum();
            }
        }
    }

    /// Area that planes across the other axes enclose on a plane [m²]; infinite where they do not.
    pub(crate) fn area_of_plane(&self, plane: usize) -> f64 {
        let faces = &self.state.faces;
        let across = (0..3).filter(|axis| *axis != faces[plane].axis);
        let sides = across.map(|axis| {
            let places = |facing: f64| {
                let faces = faces.iter();
                let faces =
                    faces.filter(move |face| face.axis == axis && face.facing * facing > 0.0);
                faces.map(|face| face.position)
            };
            let low = places(1.0).fold(f64::NEG_INFINITY, f64::max);
            let high = places(-1.0).fold(f64::INFINITY, f64::min);
            (high - low).max(0.0)
        });
        sides.product()
    }

    /// ω_p² [1/s²] and D_p [1/s] (G.26) of the worst plate, if all touched it that are listed.
    pub(crate) fn plate_that_meets(&self) -> [f64; 2] {
        let plates = self.plates();
        let of_wall = |wall: usize| {
            let found = self
                .state
                .patches
                .iter()
                .filter_map(|patch| patch.at_plates.get(wall));
            found.fold([0.0; 2], |sum: [f64; 2], part| {
                [0, 1].map(|of: usize| sum[of] + plates[wall] * part[of])
            })
        };
        (0..plates.len())
            .map(of_wall)
            .fold([0.0; 2], |most, found| {
                [0, 1].map(|of: usize| f64::max(most[of], found[of]))
            })
    }

    /// A wall that moves: its number, its largest speed towards anything [m/s] and its acceleration [m/s²]
    /// by the force on it alone.
    pub(crate) fn moving_walls(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let pushed = |motion: &WallMotion, axes: std::ops::Range<usize>| {
            motion.load.map_or(0.0, |load| {
                let free = axes.filter(|axis| load.free[*axis]);
                free.map(|axis| load.force[axis].abs() / load.mass)
                    .fold(0.0, f64::hypot)
            })
        };
        let faces = self.state.faces.iter().enumerate();
        let faces = faces.filter(|(_, face)| face.motion.is_moving());
        let faces = faces.map(move |(wall, face)| {
            // along itself a plane comes no closer to anything
            let speed = face.motion.velocity[face.axis].abs();
            let servo = face
                .motion
                .servo
                .map_or(0.0, |servo| servo.largest_velocity);
            (
                wall,
                speed.max(servo),
                pushed(&face.motion, face.axis..face.axis + 1),
            )
        });
        let planes = self.state.faces.len();
        let meshes = self.state.poses.iter().zip(&self.model.facets.meshes);
        let meshes = (planes..).zip(meshes);
        let meshes = meshes.filter(|(_, (pose, _))| pose.motion.is_moving() || pose.is_turning());
        faces.chain(
            meshes.map(move |(wall, (pose, mesh))| {
                (wall, pose.speed(mesh), pushed(&pose.motion, 0..3))
            }),
        )
    }

    /// Name of a wall, planes before meshes.
    pub(crate) fn wall_name(&self, wall: usize) -> &str {
        let planes = self.model.planes.len();
        match self.model.planes.get(wall) {
            Some(plane) => &plane.name,
            None => &self.model.facets.meshes[wall - planes].name,
        }
    }

    /// What a number stands for: bodies first, then planes, then meshes.
    pub(crate) fn name_of(&self, number: u32) -> String {
        let bodies = self.model.masses.len();
        match (number as usize).checked_sub(bodies) {
            None => format!("body {number}"),
            Some(wall) if wall < self.model.planes.len() => {
                format!("plane {:?}", self.wall_name(wall))
            }
            Some(wall) => format!("facets {:?}", self.wall_name(wall)),
        }
    }

    pub(crate) fn motion_of(&self, wall: usize) -> &WallMotion {
        let planes = self.state.faces.len();
        match self.state.faces.get(wall) {
            Some(face) => &face.motion,
            None => &self.state.poses[wall - planes].motion,
        }
    }
}
