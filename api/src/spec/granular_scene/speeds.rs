//! How far bodies and walls move in a given step: what is faster passes through others unseen.
use super::{Body, GranularScene, Stage, WallDrive};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations};

/// Way of a body in one step over its radius, or of a wall over the smallest, at most.
pub const LARGEST_WAY: f64 = 0.1;

/// Checks the speeds that are known before anything moves, at a step [s].
pub(super) fn check(spec: &GranularScene, step: f64, violations: &mut Violations) {
    let bodies = spec.bodies.iter().enumerate();
    let bodies = bodies.map(|(index, body)| {
        let pointer = format!("/bodies/{index}/velocity_m_per_s");
        (pointer, size(body.velocity_m_per_s), body.smallest_radius())
    });
    let radii = spec.bodies.iter().map(Body::smallest_radius);
    let smallest = radii.fold(f64::INFINITY, f64::min);
    let stages = spec.stages.iter().enumerate();
    let walls = stages.flat_map(|(index, stage)| {
        let speeds = stage.wall_speeds(spec).into_iter();
        speeds.map(move |(pointer, speed)| (format!("/stages/{index}/{pointer}"), speed, smallest))
    });
    let fast = bodies
        .chain(walls)
        .filter(|(_, speed, radius)| speed * step > LARGEST_WAY * radius);
    violations.extend(fast.take(LISTED_OF_A_SORT).map(|(pointer, speed, radius)| {
        let detail = "this would move more than a tenth of the radius in a step, and could pass \
                      through others unseen";
        Violation::new(pointer, "too_fast", detail)
            .value(speed)
            .allowed(format!(
                "≤ {:e} at this time step, or a step ≤ {:e} s",
                LARGEST_WAY * radius / step,
                LARGEST_WAY * radius / speed
            ))
            .unit("m/s")
    }));
}

fn size(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

impl Stage {
    /// Largest speed [m/s] towards anything that each wall has whose motion is given, with the pointer to
    /// what gives it. How fast a turn is depends on the wall, and is found out in the run.
    pub(super) fn wall_speeds(&self, spec: &GranularScene) -> Vec<(String, f64)> {
        match self {
            Self::MovePlane(stage) => {
                let speed = stage.velocity_m_per_s.abs();
                vec![("move_plane/velocity_m_per_s".to_owned(), speed)]
            }
            Self::Drive(drive) => {
                let walls = drive.walls.iter().enumerate();
                let walls = walls.flat_map(|(index, wall)| {
                    let speeds = wall.speeds(spec).into_iter();
                    speeds
                        .map(move |(field, speed)| (format!("drive/walls/{index}/{field}"), speed))
                });
                let bodies = drive.bodies.iter().enumerate();
                let bodies = bodies.filter_map(|(index, drive)| {
                    let velocity = drive.velocity.as_ref()?;
                    let mut along = [0.0; 3];
                    for axis in &velocity.along {
                        along[axis.index()] = velocity.velocity_m_per_s[axis.index()];
                    }
                    let pointer = format!("drive/bodies/{index}/velocity/velocity_m_per_s");
                    Some((pointer, size(along)))
                });
                walls.chain(bodies).collect()
            }
            _ => Vec::new(),
        }
    }
}

impl WallDrive {
    fn speeds(&self, spec: &GranularScene) -> Vec<(&'static str, f64)> {
        // along itself a plane comes no closer to anything
        let plane = spec.planes.iter().find(|plane| plane.name == self.name);
        let towards = |vector: [f64; 3]| match plane {
            Some(plane) => vector[plane.axis.index()].abs(),
            None => size(vector),
        };
        let velocity = self.velocity_m_per_s.map(towards);
        let swing = self
            .sine
            .map(|sine| std::f64::consts::TAU * sine.frequency_hz * towards(sine.amplitude_m));
        let servo = self.servo.map(|servo| servo.largest_velocity_m_per_s);
        let speeds = [
            ("velocity_m_per_s", velocity),
            ("sine/frequency_hz", swing),
            ("servo/largest_velocity_m_per_s", servo),
        ];
        speeds
            .into_iter()
            .filter_map(|(field, speed)| Some((field, speed?)))
            .collect()
    }
}
