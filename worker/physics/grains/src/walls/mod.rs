//! Walls: where they are and how they move.
//!
//! A [`Face`] is a plane across an axis, [`facets`] are walls of triangles; [`motion`] moves both, at a
//! velocity or under a force. Which spheres are near a wall is asked of it; what a touch does is told in
//! [`contact`](crate::contact). Below: [`geometry`](crate::geometry), and of
//! [`motion`](crate::motion) what is felt in a step.
pub(crate) mod facets;
pub(crate) mod motion;

use serde::{Deserialize, Serialize};

use motion::WallMotion;

/// A plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Face {
    /// 0, 1, 2 for x, y, z.
    pub(crate) axis: usize,
    /// 1 when bodies are above along the axis, −1 when below.
    pub(crate) facing: f64,
    /// Where it crosses the axis [m].
    pub(crate) position: f64,
    /// Along any axis.
    pub(crate) motion: WallMotion,
}

impl Face {
    /// Into the wall.
    pub(crate) fn normal(&self) -> [f64; 3] {
        let mut normal = [0.0; 3];
        normal[self.axis] = -self.facing;
        normal
    }

    /// Height of a centre above the plane [m].
    pub(crate) fn height(&self, centre: &[f64]) -> f64 {
        (centre[self.axis] - self.position) * self.facing
    }
}
