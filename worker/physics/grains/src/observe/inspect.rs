//! Bodies that a run must tell of: not finite, too fast, gone.
use nalgebra::UnitQuaternion;

use crate::{
    numbers::{Vector, rows::Row},
    scene::model::DrivenBody,
    step::engine::Engine,
    walls::facets::Pose,
};

impl Engine {
    /// Numbers of the bodies that are in the scene, with mass [kg] and centre of mass [m].
    pub(crate) fn present_bodies(&self) -> impl Iterator<Item = (u32, f64, Vector)> {
        let particles = &self.state.particles;
        let spheres = particles.owners.iter().zip(&particles.centres);
        let spheres =
            spheres.filter(|(owner, _)| self.model.sphere_inertias[**owner as usize] > 0.0);
        let spheres =
            spheres.map(|(owner, row)| (*owner, self.model.masses[*owner as usize], row.vector()));
        let clumps = self.state.clumps.iter();
        spheres.chain(clumps.map(|clump| (clump.body, clump.mass, clump.centre)))
    }

    /// How far a driven body has come [m].
    pub(crate) fn body_displacement(&self, driven: &DrivenBody) -> Vector {
        let clump = self
            .state
            .clumps
            .iter()
            .find(|clump| clump.body == driven.body);
        let particles = &self.state.particles;
        let centre = clump.map(|clump| clump.centre).or_else(|| {
            let place = particles
                .owners
                .iter()
                .position(|owner| *owner == driven.body)?;
            Some(particles.centres[place].vector())
        });
        centre.unwrap_or(driven.start) - driven.start
    }

    /// Rotation of a clump since the start; `None` of what is no clump, or not there.
    pub(crate) fn turn_of(&self, body: u32) -> Option<UnitQuaternion<f64>> {
        let mut clumps = self.state.clumps.iter();
        let clump = clumps.find(|clump| clump.body == body)?;
        Some(clump.orientation * self.model.orientations[body as usize].inverse())
    }

    /// The first body whose state is not finite, and what of it.
    pub(crate) fn first_not_finite(&self) -> Option<(usize, &'static str)> {
        let particles = &self.state.particles;
        for (rows, quantity) in [
            (&particles.centres, "position"),
            (&particles.velocities, "velocity"),
            (&particles.spins, "angular velocity"),
        ] {
            let is_bad = |row: &Row| !row.0.iter().all(|value| value.is_finite());
            if let Some(particle) = rows.iter().position(is_bad) {
                return Some((particles.owners[particle] as usize, quantity));
            }
        }
        None
    }

    /// Largest speed of a movable particle [m/s].
    pub(crate) fn largest_speed(&self) -> f64 {
        let particles = &self.state.particles;
        let speeds = particles
            .velocities
            .iter()
            .map(|velocity| velocity.vector().norm());
        speeds.fold(0.0, f64::max)
    }

    /// A body that moves more than `part` of its radius in a step: its number, speed
    /// [m/s] and radius [m].
    pub(crate) fn first_jump(&self, time_step: f64, part: f64) -> Option<(usize, f64, f64)> {
        let particles = &self.state.particles;
        for (particle, velocity) in particles.velocities.iter().enumerate() {
            let body = particles.owners[particle] as usize;
            let (speed, radius) = (velocity.vector().norm(), particles.centres[particle].0[3]);
            if speed * time_step > part * radius {
                return Some((body, speed, radius));
            }
        }
        None
    }

    /// Box of the scene at the start and of its walls now [m].
    pub(crate) fn box_of_walls(&self) -> (Vector, Vector) {
        let (mut low, mut high) = self.model.first_box;
        for face in &self.state.faces {
            low[face.axis] = low[face.axis].min(face.position);
            high[face.axis] = high[face.axis].max(face.position);
        }
        for (pose, mesh) in self.state.poses.iter().zip(&self.model.facets.meshes) {
            let (middle, radius) = mesh.ball;
            // the box itself while it stands where it was
            if *pose != Pose::default() {
                let middle = Vector::from(pose.to_global(&middle));
                low = low.inf(&middle.add_scalar(-radius));
                high = high.sup(&middle.add_scalar(radius));
            }
        }
        (low, high)
    }

    /// A movable body whose centre is behind a plane, and the plane.
    pub(crate) fn first_behind_plane(&self) -> Option<(u32, usize)> {
        let particles = &self.state.particles;
        let spheres = particles.centres.iter().zip(&particles.owners);
        let mut behind = spheres.filter_map(|(centre, body)| {
            let plane = self.plane_before(centre)?;
            self.model.is_movable[*body as usize].then_some((*body, plane))
        });
        behind.next()
    }

    /// The first plane that has this centre behind it.
    fn plane_before(&self, centre: &Row) -> Option<usize> {
        let mut faces = self.state.faces.iter();
        faces.position(|face| face.height(&centre.0) < 0.0)
    }

    /// Movable bodies behind a plane, or farther from the box of the scene than its diagonal. A plane has no
    /// end: what gravity keeps on one may roll along it as far as it likes.
    pub(crate) fn escaped_bodies(&self) -> Vec<u32> {
        let particles = &self.state.particles;
        let (low, high) = self.box_of_walls();
        let margin = Vector::repeat((high - low).norm());
        let mut escaped: Vec<u32> = Vec::new();
        for (centre, body) in particles.centres.iter().zip(&particles.owners) {
            let place = centre.vector();
            let is_behind = self.plane_before(centre).is_some();
            let mut faces = self.state.faces.iter();
            let ground = faces.find(|face| {
                let down = self.model.gravity[face.axis] * face.facing;
                down < 0.0 && face.height(&centre.0) >= 0.0
            });
            let axes = ground.map_or(0..3, |face| face.axis..face.axis + 1);
            let is_far = axes.into_iter().any(|axis| {
                place[axis] < low[axis] - margin[axis] || place[axis] > high[axis] + margin[axis]
            });
            if (is_behind || is_far) && self.model.is_movable[*body as usize] {
                escaped.push(*body);
            }
        }
        escaped.sort_unstable();
        escaped.dedup();
        escaped
    }
}
