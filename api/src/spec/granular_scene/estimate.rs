//! What a granular scene takes: particle steps over measured speed.
use super::{
    Body, Clump, Grain, GranularScene, Insert, LARGEST_WAY, Replace, Stage, TimeStep, WallDrive,
};
use crate::{Calibration, Estimate, Sharing};

/// Particle steps in the time of one evaluation of a bond of the calibrating fabric. A step of a
/// sphere in a dense bed with friction is worth about 13 such evaluations.
const PARTICLE_STEPS_PER_BOND_EVALUATION: f64 = 1.0 / 13.0;
/// Cost of a clump over that of a sphere: what it has as a body of many contacts whose normals are kept, and
/// for each member, which touches fewer others than a sphere does. Measured in oedometers of clumps of two and
/// four, 2.4 and 2.7 spheres, and in a loose bed of clumps of eight, 4.6.
const CLUMP: f64 = 1.6;
const MEMBER: f64 = 0.35;
/// Particles from which threads gain anything by sharing a scene, and the share of its time that they divide
/// (the guide's table `threads`).
const SHARED_FROM: f64 = 3_000.0;
const SHARED: f64 = 0.75;
/// What resists rolling, with the dashpots that come with it, makes a step of a sphere longer by this. Measured
/// in triaxial and direct shear tests of 280 to 740 spheres, with and without: 1.3 to 1.5.
const RESISTING: f64 = 1.45;
/// Automatic step of spheres with several contacts over that with one. Measured in beds: 0.5 under
/// load to 0.9 in a loose heap; in a rod of bonds 0.67.
const PACKED: f64 = 0.6;
/// The same where servos press on the bed nearly all the time: 0.46 to 0.51 in triaxial and direct shear tests.
const PRESSED: f64 = 0.5;
/// Time in which grains that fell come to rest [s]: as measured in beds of decimetres. A stage's own
/// limit is what it may take, not what it takes.
const REST_S: f64 = 1.2;
/// A stage that ends by itself is never taken for less than this part of its own limit: nobody knows
/// that it will end, and one that does not takes no more than a hundred times its estimate.
const LEAST_OF_LIMIT: f64 = 0.01;
/// Part of the region that is grains when a batch is put in while earlier ones still fall.
const POURED: f64 = 0.06;
/// Reading the spec, building the scene, writing the files [s].
const START_S: f64 = 0.01;
/// A step of few particles takes this long whatever they are [s].
const SHORTEST_STEP_S: f64 = 3e-7;
/// And this much longer for each plane [s].
const PLANE_STEP_S: f64 = 1e-7;
/// And this much longer for each mesh of facets: a body on it costs what one on a plane does, and a
/// search is shared by some hundred steps [s].
const FACETS_STEP_S: f64 = 2.5e-7;
/// Memory of a triangle with its place in the search [MB].
const FACET_MB: f64 = 3e-4;
/// Memory of the process itself, and per particle with its contacts [MB].
const MEMORY_MB: [f64; 2] = [18.0, 1.0e-3];
/// A row of a table [MB], in memory and on disk.
const BODY_ROW_MB: f64 = 280e-6;
const CONTACT_ROW_MB: f64 = 220e-6;
const CURVE_ROW_MB: f64 = 150e-6;
/// And each of its numbers beyond those that every scene has [MB].
const CURVE_NUMBER_MB: f64 = 18e-6;
/// Measuring a region takes as long as so many steps: 18 of them at every step made a run 44 times as
/// long.
const REGION_STEPS: f64 = 2.4;
/// A place of a lattice that grains are put on, while they are [MB].
const PLACE_MB: f64 = 24e-6;
/// (1/m + arm²/I) m of a compact body.
const FREEDOM: f64 = 3.5;
/// Automatic step of a scene in which nothing can touch [s].
const FREE_STEP_S: f64 = 1e-3;
/// Contacts of a sphere in a dense bed.
const CONTACTS_PER_PARTICLE: f64 = 2.5;
/// Time of a snapshot's three files, and for each particle [s].
const SNAPSHOT_S: [f64; 2] = [0.01, 5e-6];
/// Compressed bytes of a particle and its contacts in a snapshot of a dense bed [MB].
const SNAPSHOT_MB_PER_PARTICLE: f64 = 245e-6;

impl GranularScene {
    /// Steps that all stages take together, as far as they are known beforehand.
    pub fn steps(&self) -> f64 {
        self.steps_by_stage().sum()
    }

    /// The same, stage by stage.
    fn steps_by_stage(&self) -> impl Iterator<Item = f64> {
        let is_automatic = matches!(self.time_step_s, TimeStep::Automatic(_));
        let packed = if is_automatic { self.packed() } else { 1.0 };
        let mut usual = packed * self.expected_step();
        let samples = self.samples();
        let radii = samples.iter().map(Body::smallest_radius);
        let smallest = radii.fold(f64::INFINITY, f64::min);
        let mut stiffness: f64 = 1.0;
        self.stages.iter().map(move |stage| {
            let duration = stage.duration();
            let likely = match stage {
                Stage::Settle(_) => REST_S,
                Stage::Insert(insert) => self.pouring_time(insert),
                _ => f64::INFINITY,
            };
            let time = duration.time_s;
            let time = time.map(|longest| longest.min(likely.max(LEAST_OF_LIMIT * longest)));
            let walls = stage.wall_speeds(self).into_iter();
            let fastest = walls.map(|(_, speed)| speed).fold(0.0, f64::max);
            let step = if is_automatic {
                usual.min(0.5 * LARGEST_WAY * smallest / fastest)
            } else {
                usual
            };
            let by_time = time.map(|time| (time / step).ceil().max(1.0));
            let given = duration.steps.map(|steps| steps as f64);
            match stage {
                Stage::Stiffen(stiffen) if is_automatic => {
                    // Δt ∝ 1/√k
                    usual /= stiffen.factor.sqrt();
                    stiffness *= stiffen.factor;
                }
                Stage::Replace(replace) if is_automatic => {
                    let fraction = self.accuracy.knobs().critical_step_fraction;
                    let step = self.step_of_replacing(replace, &samples);
                    usual = step.map_or(usual, |step| packed * fraction * step / stiffness.sqrt());
                }
                _ => {}
            }
            given.or(by_time).unwrap_or(0.0)
        })
    }

    /// Automatic step over that of one contact: of spheres with several.
    fn packed(&self) -> f64 {
        let has_servo = |wall: &WallDrive| wall.servo.is_some();
        let is_pressed = self
            .stages
            .iter()
            .any(|stage| matches!(stage, Stage::Drive(drive) if drive.walls.iter().any(has_servo)));
        let is_bonded = |body: &Body| {
            let breakable = body.breakable.as_ref();
            breakable.is_some_and(|clump| clump.expected_members() > 2)
        };
        match self.generators().next() {
            Some(_) if is_pressed => PRESSED,
            Some(_) => PACKED,
            None if self.given_bodies().iter().any(is_bonded) => PACKED,
            None => 1.0,
        }
    }

    /// About how long it takes until all are in [s].
    fn pouring_time(&self, insert: &Insert) -> f64 {
        let density = self.density_of(&insert.bodies.material);
        let by_room = insert.bodies.expected_solid_fraction(density) / POURED;
        let batch = insert.batch.map_or(f64::INFINITY, f64::from);
        let batches = by_room.max(insert.bodies.expected_grains(density) / batch);
        (batches.ceil() + 1.0) * insert.every_s
    }

    /// Spheres whose steps cost as much as those of all particles.
    fn work(&self) -> f64 {
        let given: f64 = (self.given_bodies().iter())
            .map(|body| match &body.clump {
                Some(clump) => work_of_clumps(1.0, clump.expected_members() as f64),
                None => body.particles() as f64,
            })
            .sum();
        let made = self.generators().map(|(_, generator)| {
            let density = self.density_of(&generator.material);
            let particles = generator.expected_particles(density) as f64;
            match generator.grain {
                Grain::Clump(_) => work_of_clumps(generator.expected_grains(density), particles),
                Grain::Sphere | Grain::Breakable(_) => particles,
            }
        });
        let resisting = if self.resists_rolling() {
            RESISTING
        } else {
            1.0
        };
        resisting * (given + made.sum::<f64>())
    }

    /// The same in each stage.
    fn work_by_stage(&self) -> impl Iterator<Item = f64> {
        let mut work = self.work();
        self.stages.iter().enumerate().map(move |(number, stage)| {
            if let Stage::Replace(replace) = stage {
                let members = replace.clump.expected_members() as f64;
                work +=
                    self.expected_replaced(number, replace) * (work_of_clumps(1.0, members) - 1.0);
            }
            work
        })
    }

    /// About the critical step of the smallest clump that takes the place of a sphere [s].
    fn step_of_replacing(&self, replace: &Replace, bodies: &[Body]) -> Option<f64> {
        let spheres = bodies.iter().filter(|body| replace.replaces(body));
        let smallest = spheres
            .map(Body::smallest_radius)
            .fold(f64::INFINITY, f64::min);
        let scale = smallest / replace.equal.radius(&replace.whole()?);
        self.step_of_clump(&replace.clump, &replace.material, scale)
    }

    /// About the time step that the scene begins with [s].
    pub fn expected_step(&self) -> f64 {
        if let TimeStep::Given(step) = self.time_step_s {
            return step;
        }
        let samples = self.samples();
        let speed = Self::first_speed(&samples);
        let critical = self.critical_step_of_one_contact(&samples, speed, &self.plates());
        let of_spheres = critical.map(|critical| critical.step);
        let steps = of_spheres.into_iter().chain(self.steps_of_clumps(&samples));
        let fraction = self.accuracy.knobs().critical_step_fraction;
        let step = fraction * steps.fold(f64::INFINITY, f64::min);
        if step.is_finite() { step } else { FREE_STEP_S }
    }

    /// About the critical step of each clump's smallest member at a rigid wall [s]: 2/√(k f) with
    /// k = 2 E r, mass as if members did not overlap, and f = 1/m + arm²/I as of a sphere. Of those
    /// that will be made, the smallest.
    fn steps_of_clumps<'a>(&'a self, bodies: &'a [Body]) -> impl Iterator<Item = f64> + 'a {
        let given = bodies.iter().filter_map(|body| {
            let clump = body.clump.as_ref()?;
            Some((clump, &body.material, 1.0))
        });
        let made = self.generators().filter_map(|(_, generator)| {
            let Grain::Clump(template) = &generator.grain else {
                return None;
            };
            Some((template, &generator.material, generator.smallest_scale()))
        });
        given
            .chain(made)
            .filter_map(|(clump, material, scale)| self.step_of_clump(clump, material, scale))
    }

    /// That of one, scaled.
    fn step_of_clump(&self, clump: &Clump, material: &str, scale: f64) -> Option<f64> {
        let material = self.materials.get(material)?;
        let mass = material.density_kg_per_m3 * clump.expected_volume();
        let stiffness = material.normal_stiffness(clump.radii()[0]);
        // k ∝ r, m ∝ r³
        Some(scale * 2.0 / (stiffness * FREEDOM / mass).sqrt())
    }
}

/// Spheres whose steps cost as much as those of clumps with this many members together.
fn work_of_clumps(clumps: f64, members: f64) -> f64 {
    CLUMP * clumps + MEMBER * members
}

pub(super) fn estimate(spec: &GranularScene, calibration: &Calibration) -> Estimate {
    let particles = spec.particles() as f64;
    let walls = spec.planes.len() as f64 * PLANE_STEP_S + spec.facets.len() as f64 * FACETS_STEP_S;
    let facets: usize = (spec.facets.iter())
        .map(|mesh| mesh.triangles().map_or(0, |triangles| triangles.len()))
        .sum();
    let speed = calibration.bond_evaluations_per_s * PARTICLE_STEPS_PER_BOND_EVALUATION;
    let first = spec.record.from_stage;
    let told: f64 = spec.steps_by_stage().skip(first).sum();
    let rows = told / spec.record.every_steps as f64 + first as f64 + 2.0;
    let contacts = if spec.record.contacts {
        CONTACTS_PER_PARTICLE * particles
    } else {
        0.0
    };
    let tables = rows
        * (CURVE_ROW_MB
            + CURVE_NUMBER_MB * ((spec.curve_columns().len() - super::curve::EVERY_SCENE) as f64)
            + BODY_ROW_MB * spec.recorded_bodies(spec.particles() as usize).len() as f64
            + CONTACT_ROW_MB * contacts);
    let snapshots = match spec.record.snapshot_every_steps {
        0 => 0.0,
        every => told / every as f64 + first as f64 + 2.0,
    };
    let places: f64 = spec
        .generators()
        .map(|(_, generator)| generator.places())
        .sum();
    let step_s = |work: f64| SHORTEST_STEP_S + walls + work / speed;
    let stages = spec.steps_by_stage().zip(spec.work_by_stage());
    let last = spec.work_by_stage().last().unwrap_or_default();
    Estimate {
        wall_s: START_S
            + stages
                .map(|(steps, work)| steps * step_s(work))
                .sum::<f64>()
            + rows * REGION_STEPS * spec.record.regions.len() as f64 * step_s(last)
            + snapshots * (SNAPSHOT_S[0] + particles * SNAPSHOT_S[1]),
        memory_mb: MEMORY_MB[0]
            + particles * MEMORY_MB[1]
            + facets as f64 * FACET_MB
            + tables
            + places * PLACE_MB,
        disk_mb: tables + snapshots * particles * SNAPSHOT_MB_PER_PARTICLE,
        calibrated: false,
        threads_wall_s: None,
        sharing: Sharing {
            tests: 1.0,
            within: if particles < SHARED_FROM { 0.0 } else { SHARED },
        },
    }
}

#[cfg(test)]
mod tests;
