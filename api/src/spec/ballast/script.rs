//! The scene that a test is, and what its stages are.
mod building;

use std::collections::BTreeMap;

use super::super::granular_scene::{
    self, Axis, BodyDrive, BodyForce, BondRestLength, Convention, Drive, Generate, GranularScene,
    Record, Region, Settle, Stage, TimeStep, Volume, WallDrive, WallForce,
};
use super::{
    Apparatus, Ballast, Compaction, Knobs, Materials, loading::Pace, materials::AGGREGATE,
};

/// What a stage of a test does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Pour,
    Settle,
    Compact,
    Cut,
    Place,
    Stiffen,
    /// The smallest force acts.
    Seat,
    Load,
}

/// A bed's layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Where grains are poured, from their lowest place on. The region is made as high as it must be.
    pub footprint: Volume,
    /// What is to be filled, between grains and with them [m³].
    pub volume: f64,
}

/// A part of the bed in which porosity is measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slice {
    /// Name of the scene's region.
    pub name: String,
    /// Lower and upper height [m].
    pub heights: [f64; 2],
}

/// A test as a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    pub scene: GranularScene,
    /// Whether a plate presses a bed that cannot give way sideways.
    pub is_oedometer: bool,
    /// What each stage does.
    pub phases: Vec<Phase>,
    /// What loads, by the name that its columns of the scene's curve begin with.
    pub wall: String,
    /// Its number when it is a body: a sleeper of spheres.
    pub body: Option<u32>,
    /// Height of its lower face at the start [m].
    pub wall_height: f64,
    /// Area under it [m²].
    pub loaded_area: f64,
    /// T of a cycle [s].
    pub period: f64,
    pub cycles: u32,
    /// Force of the wall's weight, beside the load [N].
    pub weight: f64,
    pub slices: Vec<Slice>,
    /// The slices together, and what stands out above them.
    pub bed: Slice,
    template: Generate,
    placed_fraction: f64,
    largest_diameter: f64,
    settle: Settle,
    compaction: Option<Compaction>,
    overfill: f64,
}

/// g [m/s²].
const GRAVITY: f64 = 9.81;
/// Part of a period during which the smallest force acts before the first cycle.
const SEATING: f64 = 0.05;
/// The region that holds the whole bed under the wall.
pub const BED: &str = "bed";

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
        let scene = GranularScene {
            version: 1,
            seed: self.seed,
            gravity_m_per_s2: [0.0, 0.0, -GRAVITY],
            materials,
            bodies: Vec::new(),
            import: Vec::new(),
            generate: Vec::new(),
            planes: Vec::new(),
            facets: Vec::new(),
            laws: granular_scene::Laws {
                contact: self.laws.contact,
                local_damping: Some(self.laws.local_damping),
                convention: Convention::Loadframe,
                bond_rest_length: BondRestLength::Initial,
            },
            time_step_s: TimeStep::default(),
            allow_unstable: false,
            stop_when_pushed_through: true,
            accuracy: granular_scene::Accuracy::Knobs(granular_scene::Knobs {
                critical_step_fraction: knobs.critical_step_fraction,
            }),
            stages: Vec::new(),
            record: Record::default(),
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
            regions: regions.map(|slice| slice.region(&self.apparatus)).collect(),
            snapshot_every_steps: match snapshots {
                0 => 0,
                _ => every * u64::from(rows.div_ceil(snapshots)),
            },
            ..Record::default()
        };
    }
}

impl Slice {
    /// Volume in it [m³] below a wall of an area [m²] at a height [m].
    pub fn room(&self, area: f64, height: f64) -> f64 {
        let [lower, upper] = self.heights;
        area * (upper.min(height) - lower).max(0.0)
    }

    fn region(&self, apparatus: &impl Apparatus) -> Region {
        let [low, high] = apparatus.footprint();
        let [bottom, top] = self.heights;
        Region {
            name: self.name.clone(),
            low_m: Some([low[0], low[1], bottom]),
            high_m: Some([high[0], high[1], top]),
            // a sleeper of spheres is none of the bed
            material: Some(AGGREGATE.to_owned()),
        }
    }
}

impl Phase {
    /// Word for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pour => "pour",
            Self::Settle => "settle",
            Self::Compact => "compact",
            Self::Cut => "cut",
            Self::Place => "place",
            Self::Stiffen => "stiffen",
            Self::Seat => "seat",
            Self::Load => "load",
        }
    }
}
