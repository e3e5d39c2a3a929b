//! What an apparatus brings to a test.
use super::super::granular_scene::DegreeOfFreedom;
use super::{Loading, Materials, Script, Walls};
use crate::Violations;

/// How a sleeper is free to tilt, and where its rail stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Tilting {
    /// Degrees of freedom that stay held.
    pub held: Vec<DegreeOfFreedom>,
    /// Place of the rail's foot from the sleeper's middle [m].
    pub rail: [f64; 3],
}

/// A cylinder, a box, a track bed: walls, layers of grains, and the wall that loads them.
pub trait Apparatus: Clone + Default {
    /// Friction angle of steel where the spec gives none [rad].
    const STEEL_FRICTION: f64;

    /// Whether a plate without weight loads a bed that cannot give way sideways, so that there are
    /// a void ratio and a modulus. A sleeper presses with its weight, beside the load that is given.
    const IS_OEDOMETER: bool;

    /// The load that is meant when nothing is said.
    fn loading() -> Loading;

    /// Fills in the materials of walls that the spec does not give.
    fn materials(&self, given: &Materials) -> Materials {
        given.with_walls(Self::STEEL_FRICTION)
    }

    /// Writes its part of the scene: walls, layers, the wall that loads, into a script that has
    /// grains and materials.
    fn set_up(&self, script: &mut Script);

    /// The walls below and around the bed.
    fn walls(&self) -> Walls;

    /// Lower and upper corner of a rectangle around the area under the loading wall [m].
    fn footprint(&self) -> [[f64; 2]; 2];

    /// That area [m²].
    fn loaded_area(&self) -> f64;

    /// Height of the bed under the loading wall [m].
    fn bed_height(&self) -> f64;

    /// Mass of the loading wall [kg].
    fn loading_mass(&self, materials: &Materials) -> f64;

    /// How its sleeper tilts, if it does.
    fn tilting(&self) -> Option<Tilting> {
        None
    }

    /// What the schema cannot say about its dimensions, with pointers relative to the spec.
    fn check(&self, violations: &mut Violations);
}
