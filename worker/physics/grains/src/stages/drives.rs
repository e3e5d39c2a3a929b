//! What a stage does to walls and bodies: at its start once, and before each of its steps.
use loadframe_api::{
    spec::granular_scene::{Axis, BodyDrive, Drive, LoadPlane, MovePlane, Stage, WallDrive},
    surface::Point,
};

use super::runner::Runner;
use crate::{
    numbers::Vector,
    scene::model::DrivenBody,
    step::{engine::Engine, patch::BodyLoad},
    walls::motion::{Load, Servo},
};

impl Runner<'_> {
    /// Sets walls and bodies going that this stage drives, and lets those of others stand, but for walls that
    /// rest on their weight. A stage that was begun goes on at the speeds it had.
    pub(crate) fn begin_drives(&mut self, stage: &Stage) {
        let goes_on = self.journal.stage_steps > 0;
        let plates = (self.engine.plates(), self.engine.walls_held());
        let before = self.journal.stage.checked_sub(1);
        let before = before.and_then(|before| self.spec.stages.get(before));
        let driven = before.into_iter().chain([stage]).flat_map(driven_walls);
        let driven: Vec<_> = driven.map(|name| self.engine.wall(name)).collect();
        // bodies come out of it without speed
        let is_halted = matches!(before, Some(Stage::Relax(_)));
        for wall in 0..self.engine.wall_count() {
            let motion = self.engine.wall_motion(wall);
            // one that nothing but its weight moved, and moves, goes on as it fell: stages are no stops
            let weight = motion.load.take();
            let rested = weight.filter(|_| !is_halted && !driven.contains(&Some(wall)));
            if !goes_on {
                let free = rested.map_or([false; 3], |load| load.free);
                for axis in (0..3).filter(|axis| !free[*axis]) {
                    motion.velocity[axis] = 0.0;
                }
                motion.servo = None;
            }
        }
        for pose in &mut self.engine.state.poses {
            pose.turn([0.0; 3], [0.0; 3]);
        }
        self.engine.loads.clear();
        self.rest_walls();
        self.hold_bodies(stage);
        match stage {
            Stage::MovePlane(MovePlane {
                name,
                velocity_m_per_s,
                ..
            }) => {
                if let Some(plane) = self.engine.wall(name) {
                    let axis = self.engine.state.faces[plane].axis;
                    let motion = self.engine.wall_motion(plane);
                    // what is moved does not rest on its weight
                    motion.load = None;
                    motion.velocity = along(axis, *velocity_m_per_s);
                }
            }
            Stage::LoadPlane(load) => self.begin_load(load),
            Stage::Drive(drive) => self.begin_drive(drive),
            _ => {}
        }
        if (self.engine.plates(), self.engine.walls_held()) != plates {
            // contacts are told what follows their forces when they are listed
            self.engine.drop_lists();
        }
    }

    fn begin_load(&mut self, load: &LoadPlane) {
        if let Some(plane) = self.engine.wall(&load.name) {
            let axis = self.engine.state.faces[plane].axis;
            self.engine.wall_motion(plane).load = Some(Load {
                force: along(axis, load.force_n),
                mass: load.mass_kg,
                free: [0, 1, 2].map(|other| other == axis),
            });
        }
    }

    fn begin_drive(&mut self, drive: &Drive) {
        for wall in &drive.walls {
            let Some(number) = self.engine.wall(&wall.name) else {
                continue;
            };
            let motion = self.engine.wall_motion(number);
            if let Some(velocity) = wall.velocity_m_per_s {
                motion.velocity = velocity;
            }
            // what is driven in another way does not rest on its weight
            motion.load = wall.force.as_ref().map(|force| Load {
                force: force.force_n,
                mass: force.mass_kg,
                free: are_among(&force.free),
            });
            // one that goes on knows what touches it
            if let Some(servo) = wall
                .servo
                .as_ref()
                .filter(|_| self.journal.stage_steps == 0)
            {
                let face = &mut self.engine.state.faces[number];
                face.motion.servo = Some(Servo {
                    axis: face.axis,
                    facing: face.facing,
                    force: 0.0,
                    gain: servo.gain,
                    largest_velocity: servo.largest_velocity_m_per_s,
                    stiffness: 0.0,
                });
                self.engine.drop_lists();
            }
            if let Some(turn) = &wall.turn {
                let mesh = number - self.engine.state.faces.len();
                let pose = &mut self.engine.state.poses[mesh];
                pose.turn(turn.angular_velocity_rad_per_s, turn.about_m);
            }
        }
    }

    /// Holds the bodies that this stage gives a velocity, and lets others go.
    fn hold_bodies(&mut self, stage: &Stage) {
        let drives: &[BodyDrive] = match stage {
            Stage::Drive(drive) => &drive.bodies,
            _ => &[],
        };
        for mut driven in self.engine.model.driven.clone() {
            self.free_placed(&mut driven);
            let drive = drives.iter().find(|drive| drive.body == driven.body);
            let velocity = drive.and_then(|drive| drive.velocity.as_ref());
            let held = velocity.map_or([false; 3], |held| are_among(&held.along));
            let velocity = velocity.map_or([0.0; 3], |held| held.velocity_m_per_s);
            self.engine.hold(&driven, held, velocity);
        }
    }

    /// Forces and velocities of this moment.
    pub(crate) fn drive(&mut self, stage: &Stage) {
        let time = self.engine.state.time - self.journal.stage_start;
        match stage {
            Stage::LoadPlane(load) => {
                // of this plane alone: others may rest on their weight
                if let Some(plane) = self.engine.wall(&load.name) {
                    let face = &mut self.engine.state.faces[plane];
                    if let Some(on_face) = &mut face.motion.load {
                        on_face.force = along(face.axis, load.force_at(time));
                    }
                }
            }
            Stage::Drive(drive) => {
                for wall in &drive.walls {
                    self.drive_wall(stage, wall, time);
                }
                self.engine.loads.clear();
                for drive in &drive.bodies {
                    let load = self.engine.load_on(drive, time);
                    self.engine.loads.extend(load);
                }
            }
            _ => {}
        }
    }

    fn drive_wall(&mut self, stage: &Stage, wall: &WallDrive, time: f64) {
        let time_step = self.next_step(stage);
        let Some(number) = self.engine.wall(&wall.name) else {
            return;
        };
        if let Some(servo) = &wall.servo {
            let pressed = |stress: f64| stress * self.engine.area_of_plane(number);
            let force = servo.force_n.or(servo.stress_pa.map(pressed));
            if let Some(known) = &mut self.engine.wall_motion(number).servo {
                known.force = force.unwrap_or(0.0);
            }
        }
        let motion = self.engine.wall_motion(number);
        if let Some(sine) = &wall.sine {
            // the velocity that brings it to where it has to be after the step
            let [now, then] = [time, time + time_step].map(|time| sine.way_at(time));
            motion.velocity = [0, 1, 2].map(|axis| (then[axis] - now[axis]) / time_step);
        }
        if let (Some(force), Some(load)) = (&wall.force, &mut motion.load) {
            load.force = force.force_at(time);
        }
    }
}

/// Names of the walls that a stage drives.
fn driven_walls(stage: &Stage) -> Vec<&str> {
    match stage {
        Stage::MovePlane(stage) => vec![&stage.name],
        Stage::LoadPlane(stage) => vec![&stage.name],
        Stage::Drive(stage) => stage.walls.iter().map(|wall| wall.name.as_str()).collect(),
        _ => Vec::new(),
    }
}

/// A vector along an axis.
fn along(axis: usize, value: f64) -> Point {
    let mut vector = [0.0; 3];
    vector[axis] = value;
    vector
}

/// Which of x, y, z are in a list.
fn are_among(axes: &[Axis]) -> [bool; 3] {
    [Axis::X, Axis::Y, Axis::Z].map(|axis| axes.contains(&axis))
}

impl Engine {
    /// The force on a body at a time [s] of the stage.
    fn load_on(&self, drive: &BodyDrive, time: f64) -> Option<BodyLoad> {
        let load = drive.force.as_ref()?;
        let force = Vector::from(load.force_at(time));
        let torque = load.at_m.and_then(|place| {
            let arm = self.turn_of(drive.body)? * Vector::from(place);
            Some(arm.cross(&force))
        });
        Some(BodyLoad {
            body: drive.body,
            force,
            torque,
        })
    }

    /// Holds a body to a velocity [m/s] along some axes, and leaves the others to its spec.
    fn hold(&mut self, driven: &DrivenBody, held: [bool; 3], velocity: Point) {
        let state = &mut self.state;
        let given = [0, 1, 2].map(|axis| match (held[axis], driven.fixed[axis]) {
            (true, _) => Some(velocity[axis]),
            (false, true) => Some(driven.velocity[axis]),
            (false, false) => None,
        });
        let mut clumps = state.clumps.iter_mut();
        if let Some(clump) = clumps.find(|clump| clump.body == driven.body) {
            let fixed = clump.fixed;
            for (axis, given) in given.into_iter().enumerate() {
                clump.fixed[axis] = given.is_some();
                clump.velocity[axis] = given.unwrap_or(clump.velocity[axis]);
            }
            if clump.fixed != fixed && self.model.is_viscous {
                // dashpots are made for the mass that is free to move
                self.drop_lists();
            }
            return;
        }
        let particles = &mut state.particles;
        let mut owners = particles.owners.iter();
        let Some(particle) = owners.position(|owner| *owner == driven.body) else {
            return;
        };
        let velocities = &mut particles.velocities[particle].0;
        let mut fixed = particles.fixed[particle] & !0b111;
        for (axis, given) in given.into_iter().enumerate() {
            fixed |= u8::from(given.is_some()) << axis;
            velocities[axis] = given.unwrap_or(velocities[axis]);
        }
        let mass = self.model.masses[driven.body as usize];
        velocities[3] = if fixed & 0b111 == 0b111 {
            0.0
        } else {
            1.0 / mass
        };
        if particles.fixed[particle] != fixed {
            particles.fixed[particle] = fixed;
            // patches know which of their spheres are fixed in part, dashpots what is free to move
            self.drop_lists();
        }
    }
}
