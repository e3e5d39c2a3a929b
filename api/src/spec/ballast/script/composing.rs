//! The script of a ballast test: materials and laws, what its apparatus sets up, load and record.
use std::collections::BTreeMap;

use super::{
    super::super::granular_scene::{
        Axis, BodyDrive, BodyForce, Drive, Generate, GranularScene, Record, Settle, Stage,
        WallDrive, WallForce,
    },
    super::{Apparatus, Ballast, Knobs, Materials, loading::Pace, materials::AGGREGATE},
    GRAVITY, Phase, Script, Slice,
};

/// Part of a period during which the smallest force acts before the first cycle.
const SEATING: f64 = 0.05;

impl<A: Apparatus> Ballast<A> {
    /// Materials, walls included.
    pub fn resolved_materials(&self) -> Materials {
        self.apparatus.materials(&self.materials)
    }

    /// Moduli while the bed is prepared, over those during the test.
    fn softening(&self) -> f64 {
        let knobs = self.accuracy.knobs();
        let modulus = knobs.stiffness * self.materials.aggregate.youngs_modulus_pa;
        (knobs.preparation_modulus_pa / modulus).min(1.0)
    }

    /// T of a cycle [s].
    pub fn period(&self) -> f64 {
        let knobs = self.accuracy.knobs();
        let aggregate = &self.materials.aggregate;
        self.test.period(&Pace {
            inertial_number: knobs.inertial_number,
            area: self.apparatus.loaded_area(),
            diameter: self.grains.mean_diameter(),
            density: aggregate.density_kg_per_m3,
            modulus: knobs.stiffness * aggregate.youngs_modulus_pa,
        })
    }

    /// The test as a scene.
    pub fn script(&self) -> Script {
        let knobs = self.accuracy.knobs();
        let materials = self.resolved_materials();
        let mut script = self.opening(&knobs, &materials);
        self.apparatus.set_up(&mut script);
        script.stiffen(1.0 / self.softening());
        script.slice(self.output.slices, self.apparatus.bed_height());
        self.load(&mut script, &materials);
        self.record(&mut script);
        script
    }

    /// Materials and laws, before there is anything.
    fn opening(&self, knobs: &Knobs, materials: &Materials) -> Script {
        let softened = knobs.stiffness * self.softening();
        let materials: BTreeMap<_, _> = materials
            .named()
            .map(|(name, material)| {
                let mut material = material.clone();
                material.youngs_modulus_pa *= softened;
                (name.to_owned(), material)
            })
            .collect();
        let preparation = &self.preparation;
        let (law, damping) = (self.laws.contact, self.laws.local_damping);
        let scene = GranularScene {
            gravity_m_per_s2: [0.0, 0.0, -GRAVITY],
            materials,
            ..GranularScene::of_test(self.seed, law, damping, knobs.critical_step_fraction)
        };
        Script {
            scene,
            is_oedometer: A::IS_OEDOMETER,
            phases: Vec::new(),
            wall: String::new(),
            body: None,
            wall_height: 0.0,
            loaded_area: self.apparatus.loaded_area(),
            period: self.period(),
            cycles: self.test.cycles,
            weight: 0.0,
            slices: Vec::new(),
            bed: Slice::default(),
            template: Generate {
                grain: self.grains.shape.clone(),
                sizes: self.grains.sizes(),
                ..Generate::of(AGGREGATE)
            },
            placed_fraction: self.grains.placed_fraction(),
            largest_diameter: self.grains.largest_diameter(),
            settle: Settle {
                unbalanced_force_ratio: preparation.unbalanced_force_ratio,
                steps: None,
                time_s: Some(preparation.longest_settling_s),
            },
            compaction: preparation.compaction.clone(),
            overfill: preparation.overfill,
        }
    }

    /// The smallest force, then the cycles.
    fn load(&self, script: &mut Script, materials: &Materials) {
        let mass = self.apparatus.loading_mass(materials);
        if !A::IS_OEDOMETER {
            script.weight = mass * GRAVITY;
        }
        // gravity acts on a body, and must be given to a wall
        let own = if script.body.is_some() {
            0.0
        } else {
            script.weight
        };
        let [smallest, peak] = [self.test.smallest_force_n, self.test.peak_force_n]
            .map(|force| [0.0, 0.0, -(force + own)]);
        let drive = |peak, period, time| {
            let wall = || WallDrive {
                name: script.wall.clone(),
                velocity_m_per_s: None,
                sine: None,
                turn: None,
                force: Some(WallForce {
                    mass_kg: mass,
                    force_n: smallest,
                    peak_force_n: peak,
                    period_s: period,
                    free: vec![Axis::Z],
                }),
                servo: None,
            };
            let body = |body| BodyDrive {
                body,
                velocity: None,
                force: Some(BodyForce {
                    force_n: smallest,
                    peak_force_n: peak,
                    period_s: period,
                }),
            };
            Stage::Drive(Drive {
                walls: script.body.is_none().then(wall).into_iter().collect(),
                bodies: script.body.map(body).into_iter().collect(),
                flow: false,
                friction_factor: 1.0,
                steps: None,
                time_s: Some(time),
            })
        };
        let period = script.period;
        let seat = drive(None, None, SEATING * period);
        let cycles = f64::from(self.test.cycles) * period;
        let load = drive(Some(peak), Some(period), cycles);
        script.add(Phase::Seat, seat);
        script.add(Phase::Load, load);
    }

    /// Rows and snapshots of the scene.
    fn record(&self, script: &mut Script) {
        let step = script.scene.expected_step() * self.softening().sqrt();
        let rows = self.output.rows_per_cycle;
        let every = (script.period / (f64::from(rows) * step)).floor().max(1.0) as u64;
        let snapshots = self.output.snapshots;
        let regions = script.slices.iter().chain([&script.bed]);
        script.scene.record = Record {
            every_steps: every,
            from_stage: script.stages_before(Phase::Seat),
            bodies: Some(Vec::new()),
            stage_ends: true,
            regions: regions
                .map(|slice| slice.region(self.apparatus.footprint()))
                .collect(),
            snapshot_every_steps: match snapshots {
                0 => 0,
                _ => every * u64::from(rows.div_ceil(snapshots)),
            },
            ..Record::default()
        };
    }
}
