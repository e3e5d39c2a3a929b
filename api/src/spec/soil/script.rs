//! The scene that a test of soil is.
use std::collections::BTreeMap;

use super::super::granular_scene::{
    Axis, Drive, FacetMesh, Generate, GranularScene, Material, Plane, Record, Region, Servo, Stage,
    Volume, WallDrive,
};
use super::Soil;
use crate::{Violations, results::Named};

/// A test as a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    pub scene: GranularScene,
    /// Stages before the one that is measured.
    pub prepared: usize,
}

/// What speeds follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// γ̇ of the preparation [1/s].
    pub preparation: f64,
    /// γ̇ of the test where it gives no rate of its own [1/s].
    pub test: f64,
    /// Diameter of a mean grain [m].
    pub diameter: f64,
    /// Room that grains are placed in, over that of the specimen.
    pub expansion: f64,
}

/// What is done to a specimen.
pub trait Shearing: Clone {
    /// Columns of the curve.
    const COLUMNS: &'static [&'static str];

    /// Results, beside those of the scene.
    const RESULTS: &'static [Named];

    /// Stress at which the specimen comes to rest [Pa].
    fn stress(&self) -> f64;

    /// Sides of the specimen [m].
    fn sides(&self) -> [f64; 3];

    /// Sides of the box in which grains are placed [m], given its volume over that of the specimen.
    fn room(&self, expansion: f64) -> [f64; 3];

    /// γ̇ at which the specimen is sheared [1/s], where the test gives a rate of its own.
    fn given_shear_rate(&self, pace: &Pace) -> Option<f64>;

    /// Writes walls and stages; the last stage is the test, which lasts the returned time [s].
    fn set_up(&self, script: &mut Script, pace: &Pace, friction_factor: f64) -> f64;

    /// What the schema cannot say, with pointers relative to the spec.
    fn check(&self, violations: &mut Violations);
}

/// The region that holds the specimen.
pub const SAMPLE: &str = "sample";
/// Material of grains and rough walls, and of walls without friction.
pub(super) const SOIL: &str = "soil";
pub(super) const SMOOTH: &str = "smooth";
/// Solid fraction that a specimen is reckoned to have.
const SOLID_FRACTION: f64 = 0.6;
/// I at which walls move in on grains that hardly touch.
const PREPARATION: f64 = 1e-2;
/// Times 1/γ̇ of the preparation in which a specimen comes to its stress, and to rest under it.
const TO_STRESS: f64 = 0.3;
const TO_REST: f64 = 0.5;

impl<T: Shearing> Soil<T> {
    /// Diameter of a mean grain [m].
    pub fn mean_diameter(&self) -> f64 {
        self.grains.shape.mean_diameter(self.grains.sizes.as_ref())
    }

    /// Speeds that follow from inertial numbers.
    pub fn pace(&self) -> Pace {
        let diameter = self.mean_diameter();
        let rate = (self.test.stress() / self.soil.density_kg_per_m3).sqrt() / diameter;
        Pace {
            preparation: PREPARATION * rate,
            test: self.accuracy.knobs().inertial_number * rate,
            diameter,
            expansion: SOLID_FRACTION / self.grains.shape.placed_fraction(),
        }
    }

    /// The test as a scene.
    pub fn script(&self) -> Script {
        let pace = self.pace();
        let mut script = Script {
            scene: self.opening(&pace),
            prepared: 0,
        };
        let factor = self.preparation.friction_factor;
        let time = self.test.set_up(&mut script, &pace, factor);
        script.prepared = script.scene.stages.len() - 1;
        let every = |count: u32, least: u64| match count {
            0 => 0,
            _ => ((time / (f64::from(count) * script.scene.expected_step())) as u64).max(least),
        };
        let rows = every(self.output.rows, 1);
        let snapshots = every(self.output.snapshots, rows);
        let record = &mut script.scene.record;
        record.every_steps = rows;
        record.snapshot_every_steps = snapshots.div_ceil(rows) * rows;
        record.from_stage = script.prepared;
        script
    }

    /// Grains, materials and laws, before there are walls.
    fn opening(&self, pace: &Pace) -> GranularScene {
        let smooth = Material {
            friction_angle_rad: Some(0.0),
            rolling_resistance: None,
            parallel_bond: None,
            normal_cohesion_pa: 0.0,
            shear_cohesion_pa: 0.0,
            ..self.soil.clone()
        };
        let materials = [(SOIL, self.soil.clone()), (SMOOTH, smooth)];
        let materials = materials.map(|(name, material)| (name.to_owned(), material));
        let volume: f64 = self.test.sides().into_iter().product();
        let knobs = self.accuracy.knobs();
        let (law, damping) = (self.laws.contact, self.laws.local_damping);
        GranularScene {
            materials: BTreeMap::from(materials),
            generate: vec![Generate {
                grain: self.grains.shape.clone(),
                sizes: self.grains.sizes.clone(),
                mass_kg: Some(SOLID_FRACTION * volume * self.soil.density_kg_per_m3),
                region: Volume::Box {
                    lower_m: [0.0; 3],
                    upper_m: self.test.room(pace.expansion),
                },
                ..Generate::of(SOIL)
            }],
            record: Record {
                bodies: Some(Vec::new()),
                stage_ends: true,
                regions: vec![Region {
                    name: SAMPLE.to_owned(),
                    low_m: None,
                    high_m: None,
                    material: None,
                }],
                ..Record::default()
            },
            ..GranularScene::of_test(self.seed, law, damping, knobs.critical_step_fraction)
        }
    }
}

impl Script {
    /// Adds a plane with the specimen on its side `facing`.
    pub(super) fn plane(&mut self, name: &str, axis: Axis, at: [f64; 2], material: &str) {
        let [position_m, facing] = at;
        self.scene.planes.push(Plane {
            contact_stiffness_n_per_m: None,
            name: name.to_owned(),
            axis,
            position_m,
            facing: if facing < 0.0 { -1 } else { 1 },
            material: material.to_owned(),
        });
    }

    /// Adds a smooth wall of rectangles across y, each from one corner in x and z to the other [m].
    pub(super) fn facets(&mut self, name: &str, width: [f64; 2], walls: &[[[f64; 2]; 2]]) {
        let [front, back] = width;
        let triangles = walls.iter().flat_map(|[[x0, z0], [x1, z1]]| {
            let corners = [
                [*x0, front, *z0],
                [*x1, front, *z1],
                [*x1, back, *z1],
                [*x0, back, *z0],
            ];
            [
                [corners[0], corners[1], corners[2]],
                [corners[0], corners[2], corners[3]],
            ]
        });
        self.scene.facets.push(FacetMesh {
            name: name.to_owned(),
            material: SMOOTH.to_owned(),
            triangles_m: Some(triangles.collect()),
            stl: None,
            scale: 1.0,
            position_m: [0.0; 3],
        });
    }

    /// Adds stages in which servos press the specimen together and let it come to rest; `walls` has
    /// their largest velocities beside, and `way` is how far they move in over the specimen's sides.
    pub(super) fn compress(
        &mut self,
        walls: &[(WallDrive, f64)],
        way: f64,
        pace: &Pace,
        friction_factor: f64,
    ) {
        let rate = pace.preparation;
        for (factor, time_s, part) in [
            (friction_factor, (way + TO_STRESS) / rate, 1.0),
            (1.0, TO_REST / rate, 0.1),
        ] {
            let slower = |(wall, velocity): &(WallDrive, f64)| {
                let mut wall = wall.clone();
                if let Some(servo) = &mut wall.servo {
                    servo.largest_velocity_m_per_s = part * velocity;
                }
                wall
            };
            self.scene.stages.push(Stage::Drive(Drive {
                walls: walls.iter().map(slower).collect(),
                bodies: Vec::new(),
                // what is pressed together is not yet what is measured
                flow: true,
                friction_factor: factor,
                until: None,
                steps: None,
                time_s: Some(time_s),
            }));
        }
    }

    /// Adds the stage that is the test.
    pub(super) fn shear(&mut self, walls: Vec<WallDrive>, time_s: f64) {
        self.scene.stages.push(Stage::Drive(Drive {
            walls,
            bodies: Vec::new(),
            flow: false,
            friction_factor: 1.0,
            until: None,
            steps: None,
            time_s: Some(time_s),
        }));
    }
}

/// A wall that moves.
pub(super) fn moving(name: &str, velocity: [f64; 3]) -> WallDrive {
    WallDrive {
        velocity_m_per_s: Some(velocity),
        ..WallDrive::of(name)
    }
}

/// A wall that follows a stress [Pa] or a force [N].
pub(super) fn following(name: &str, aim: Aim, largest_velocity_m_per_s: f64) -> WallDrive {
    let (force_n, stress_pa) = match aim {
        Aim::Force(force) => (Some(force), None),
        Aim::Stress(stress) => (None, Some(stress)),
    };
    WallDrive {
        servo: Some(Servo {
            force_n,
            stress_pa,
            largest_velocity_m_per_s,
            gain: GAIN,
        }),
        ..WallDrive::of(name)
    }
}

/// What a wall follows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Aim {
    /// [N].
    Force(f64),
    /// [Pa].
    Stress(f64),
}

/// Part of the missing force that walls make good in a step: much, for a wall that has to move lags
/// behind its force by K Δt v/gain.
const GAIN: f64 = 0.8;
