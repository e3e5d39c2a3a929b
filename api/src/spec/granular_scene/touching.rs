//! Which bodies and walls have contacts with each other.
//!
//! Whatever can feel a force has contacts. A body with a degree of freedom, or one that a stage sets
//! down, follows it. A body that is held in all of them does not, yet the force on it is told when a stage
//! drives it, and a wall follows its force (a plate) or tells it. Two that are held have contacts when one of
//! them feels a force and they can come closer: neighbours that stand, or move as one, never do.
use super::{Body, GranularScene, LoadPlane, MovePlane, Place, Stage};

/// Who may touch whom, by number: bodies, planes, meshes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Touching(Vec<u32>);

/// A body that forces move.
const FREE: u32 = u32::MAX;
/// Stands where it is in every stage.
const STANDS: u32 = 0;

/// What is held: how it moves, and whether it feels a force.
fn held(motion: u32, feels: bool) -> u32 {
    motion << 1 | u32::from(feels)
}

impl Touching {
    /// Whether forces move it.
    pub fn is_free(&self, number: usize) -> bool {
        self.0.get(number) == Some(&FREE)
    }

    /// Whether two have contacts when they overlap.
    #[inline]
    pub fn may_touch(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.0[a], self.0[b]);
        a == FREE || b == FREE || (a >> 1 != b >> 1 && (a | b) & 1 == 1)
    }
}

impl GranularScene {
    /// Who may touch whom among `bodies` and all walls.
    pub fn touching(&self, bodies: &[Body]) -> Touching {
        let driven = self.driven_bodies();
        let placed: Vec<u32> = self.placed_bodies().collect();
        let mut velocities: Vec<[u64; 3]> = vec![[0; 3]];
        let mut numbers = Vec::new();
        for body in bodies {
            for _ in 0..body.numbers() {
                let number = numbers.len() as u32;
                numbers.push(if !body.is_held() || placed.contains(&number) {
                    FREE
                } else if driven.binary_search(&number).is_ok() {
                    held(u32::MAX / 4 - number, true)
                } else {
                    // 0 and −0 alike
                    let velocity = body.velocity_m_per_s.map(|part| (part + 0.0).to_bits());
                    let known = velocities.iter().position(|known| *known == velocity);
                    let motion = known.unwrap_or(velocities.len());
                    if known.is_none() {
                        velocities.push(velocity);
                    }
                    held(motion as u32, false)
                });
            }
        }
        let walls = self.wall_names();
        let walls = (0_u32..).zip(walls).map(|(wall, name)| {
            let is_moved = self.stages.iter().any(|stage| stage.moves_wall(name));
            let motion = if is_moved {
                u32::MAX / 2 - 1 - wall
            } else {
                STANDS
            };
            held(motion, self.feels_force(name))
        });
        numbers.extend(walls.collect::<Vec<_>>());
        Touching(numbers)
    }

    /// Whether a wall follows the force on it, or tells it.
    fn feels_force(&self, wall: &str) -> bool {
        let is_plate = |stage: &Stage| match stage {
            Stage::LoadPlane(load) => load.name == wall,
            Stage::Place(place) => place.wall.as_deref() == Some(wall) && place.mass_kg.is_some(),
            _ => false,
        };
        self.record.planes.iter().any(|name| name == wall)
            || self.recorded_walls().contains(&wall)
            || self.stages.iter().any(is_plate)
    }

    /// Largest 1/m that a stage gives each wall to follow forces with [1/kg], planes before meshes; 0 of those
    /// that never do.
    pub(super) fn plates(&self) -> Vec<f64> {
        let masses = self.wall_names().map(|wall| self.mass_of_wall(wall));
        masses
            .map(|mass| mass.map_or(0.0, |mass| 1.0 / mass))
            .collect()
    }

    /// Smallest mass that a stage gives a wall to follow forces with [kg]; `None` for one that never does.
    pub fn mass_of_wall(&self, wall: &str) -> Option<f64> {
        let masses = self.stages.iter().filter_map(|stage| match stage {
            Stage::LoadPlane(load) if load.name == wall => Some(load.mass_kg),
            Stage::Place(place) if place.wall.as_deref() == Some(wall) => place.mass_kg,
            Stage::Drive(drive) => {
                let drive = drive.walls.iter().find(|drive| drive.name == wall)?;
                drive.force.as_ref().map(|force| force.mass_kg)
            }
            _ => None,
        });
        masses.reduce(f64::min)
    }
}

impl Stage {
    /// Whether it moves a wall, or lets it move.
    fn moves_wall(&self, wall: &str) -> bool {
        match self {
            Self::MovePlane(MovePlane { name, .. }) | Self::LoadPlane(LoadPlane { name, .. }) => {
                name == wall
            }
            Self::Drive(drive) => drive.walls.iter().any(|drive| drive.name == wall),
            Self::Place(Place { wall: name, .. }) => name.as_deref() == Some(wall),
            _ => false,
        }
    }
}
