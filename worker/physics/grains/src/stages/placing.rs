//! Walls and bodies that are set down on others.
use loadframe_api::spec::granular_scene::{Place, Stage};
use loadframe_harness::{Recorder, SimulationError};

use super::runner::Runner;
use crate::{
    numbers::rows::Row, scene::model::DrivenBody, step::engine::Engine, walls::motion::Load,
};

/// How far a wall moves along an axis until it touches spheres [m], from above when `side` is −1 and
/// from below when it is 1. The wall is a box between two corners, or a plane, a box without end;
/// `None` where no sphere is in its way.
///
/// A sphere whose centre is beside the box by h < r touches its edge √(r² − h²) from its own height.
fn way<'a>(
    axis: usize,
    side: f64,
    corners: [[f64; 3]; 2],
    spheres: impl IntoIterator<Item = &'a Row>,
) -> Option<f64> {
    way_of_rounded(axis, side, corners, 0.0, spheres)
}

/// The same for a box that is rounded, larger all around by a radius [m].
fn way_of_rounded<'a>(
    axis: usize,
    side: f64,
    [lower, upper]: [[f64; 3]; 2],
    rounding: f64,
    spheres: impl IntoIterator<Item = &'a Row>,
) -> Option<f64> {
    let face = if side < 0.0 { lower[axis] } else { upper[axis] };
    let reached = spheres.into_iter().filter_map(|Row([x, y, z, radius])| {
        let (centre, radius) = ([*x, *y, *z], radius + rounding);
        let beside = (0..3).filter(|other| *other != axis).map(|other| {
            let outside = (lower[other] - centre[other]).max(centre[other] - upper[other]);
            outside.max(0.0).powi(2)
        });
        let rest = radius * radius - beside.sum::<f64>();
        (rest > 0.0).then(|| centre[axis] - side * rest.sqrt() - face)
    });
    outermost(side, reached)
}

/// What comes from its own side ends at what is farthest out there.
fn outermost(side: f64, ways: impl Iterator<Item = f64>) -> Option<f64> {
    let farther = |first: f64, next: f64| {
        if side < 0.0 {
            first.max(next)
        } else {
            first.min(next)
        }
    };
    ways.reduce(farther)
}

impl Engine {
    /// Axis along which a wall is set down: a plane has its own.
    fn axis_of(&self, wall: usize, place: &Place) -> usize {
        let face = self.state.faces.get(wall);
        face.map_or(place.axis.index(), |face| face.axis)
    }

    /// Sets a wall down, where it stands; whether it met anything.
    fn place_wall(&mut self, wall: usize, place: &Place) -> bool {
        // one that was set down before may be falling
        self.wall_motion(wall).velocity = [0.0; 3];
        let state = &mut self.state;
        let spheres = &state.particles.centres;
        let side = f64::from(place.side);
        let planes = state.faces.len();
        if let Some(face) = state.faces.get_mut(wall) {
            let mut corners = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
            for corner in &mut corners {
                corner[face.axis] = face.position;
            }
            // a plane has bodies on the side that it faces
            let Some(way) = way(face.axis, face.facing, corners, spheres) else {
                return false;
            };
            face.position += way;
            face.motion.displacement[face.axis] += way;
        } else {
            let axis = place.axis.index();
            let pose = &mut state.poses[wall - planes];
            let corners = pose.bounds(&self.model.facets.meshes[wall - planes]);
            let Some(way) = way(axis, side, corners, spheres) else {
                return false;
            };
            pose.shift(axis, way);
        }
        self.drop_lists();
        true
    }

    /// Sets a body down; whether it met another.
    fn place_body(&mut self, body: u32, place: &Place) -> bool {
        let (axis, side) = (place.axis.index(), f64::from(place.side));
        let particles = &mut self.state.particles;
        let is_own = |(_, owner): &(&Row, &u32)| **owner == body;
        let pairs = || particles.centres.iter().zip(&particles.owners);
        let own: Vec<Row> = pairs().filter(is_own).map(|(row, _)| *row).collect();
        let others: Vec<Row> = (pairs().filter(|pair| !is_own(pair)))
            .map(|(row, _)| *row)
            .collect();
        let ways = own.iter().filter_map(|member| {
            // a sphere is a point that is rounded
            let point = [member.vector().into(); 2];
            way_of_rounded(axis, side, point, member.0[3], &others)
        });
        let Some(way) = outermost(side, ways) else {
            return false;
        };
        for (row, owner) in particles.centres.iter_mut().zip(&particles.owners) {
            if *owner == body {
                row.0[axis] += way;
            }
        }
        let mut clumps = self.state.clumps.iter_mut();
        if let Some(clump) = clumps.find(|clump| clump.body == body) {
            clump.centre[axis] += way;
        }
        self.drop_lists();
        true
    }
}

impl Runner<'_> {
    /// Gives walls that were set down their weight; a stage that drives them takes it away again.
    pub(crate) fn rest_walls(&mut self) {
        for stage in &self.spec.stages[..self.journal.stage] {
            let Stage::Place(place) = stage else { continue };
            let wall = place
                .wall
                .as_deref()
                .and_then(|wall| self.engine.wall(wall));
            let (Some(mass), Some(wall)) = (place.mass_kg, wall) else {
                continue;
            };
            let axis = self.engine.axis_of(wall, place);
            let mut force = [0.0; 3];
            force[axis] = mass * self.engine.model.gravity[axis];
            self.engine.wall_motion(wall).load = Some(Load {
                force,
                mass,
                free: [0, 1, 2].map(|other| other == axis),
            });
        }
    }

    /// Lets a body that was set down follow what acts along that axis.
    pub(crate) fn free_placed(&self, driven: &mut DrivenBody) {
        for stage in &self.spec.stages[..self.journal.stage] {
            if let Stage::Place(place) = stage
                && place.body == Some(driven.body)
            {
                driven.fixed[place.axis.index()] = false;
            }
        }
    }

    /// Sets a wall or a body down and records where it is.
    pub(crate) fn place(
        &mut self,
        place: &Place,
        recorder: &mut dyn Recorder,
    ) -> Result<(), SimulationError> {
        let wall = place
            .wall
            .as_deref()
            .and_then(|wall| self.engine.wall(wall));
        let met = match (wall, place.body) {
            (Some(wall), _) => self.engine.place_wall(wall, place),
            (None, Some(body)) => self.engine.place_body(body, place),
            (None, None) => false,
        };
        let how = if met {
            "was set down"
        } else {
            "met no bodies, and stays"
        };
        let what = match (&place.wall, place.body) {
            (Some(wall), _) => wall.clone(),
            (None, body) => format!("body {}", body.unwrap_or_default()),
        };
        recorder.log(&format!("stage {}: {what} {how}", self.journal.stage + 1));
        self.observe_still(recorder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLATE: [[f64; 3]; 2] = [[-1.0, -1.0, 5.0], [1.0, 1.0, 6.0]];

    #[test]
    fn a_box_comes_down_to_the_highest_sphere_below_it() {
        let spheres = [
            Row([0.0, 0.0, 1.0, 0.5]),
            Row([0.5, 0.0, 1.2, 0.1]),
            Row([3.0, 0.0, 4.0, 0.5]),
        ];
        let way = way(2, -1.0, PLATE, &spheres).expect("a sphere");
        assert!((way - (1.5 - 5.0)).abs() < 1e-15, "{way}");
    }

    #[test]
    fn a_sphere_beside_the_box_is_met_by_its_edge() {
        // 3-4-5: the centre is 0.3 outside, the radius 0.5
        let way = way(2, -1.0, PLATE, &[Row([1.3, 0.0, 1.0, 0.5])]).expect("a sphere");
        assert!((way - (1.4 - 5.0)).abs() < 1e-15, "{way}");
    }

    #[test]
    fn from_below_it_goes_up_and_nothing_leaves_it_where_it_is() {
        let way_up = way(2, 1.0, PLATE, &[Row([0.0, 0.0, 8.0, 0.5])]).expect("a sphere");
        assert!((way_up - 1.5).abs() < 1e-15, "{way_up}");
        assert_eq!(way(2, -1.0, PLATE, &[Row([9.0, 0.0, 1.0, 0.5])]), None);
    }
}
