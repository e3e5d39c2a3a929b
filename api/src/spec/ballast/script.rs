//! The scene that a test is, and what its stages are.
use std::collections::BTreeMap;

use super::super::granular_scene::{
    self, Axis, Body, BodyDrive, BodyForce, BondRestLength, Clump, Convention, Cut,
    DegreeOfFreedom, Drive, FacetMesh, Generate, Grain, GranularScene, Insert, Place, Plane,
    Record, Region, Run, Settle, Stage, Stiffen, TimeStep, Vibrate, Volume, WallDrive, WallForce,
};
use super::{
    Apparatus, Ballast, Compaction, Knobs, Materials,
    materials::AGGREGATE,
    shapes::{cuboid, shell},
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
    /// Height at which it is cut [m].
    pub top: f64,
}

/// A part of the bed in which porosity is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Name of the scene's region.
    pub name: String,
    /// Lower and upper height [m].
    pub heights: [f64; 2],
    /// Volume for grains in it [m³].
    pub volume: f64,
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
    template: Generate,
    placed_fraction: f64,
    largest_diameter: f64,
    settle: Settle,
    compaction: Option<Compaction>,
    overfill: f64,
}

/// Solid fraction of a bed that amounts are reckoned with.
const SOLID_FRACTION: f64 = 0.6;
/// Material of a sleeper of spheres, which has the mass it should.
const SLEEPER: &str = "sleeper";
/// Unbalanced force ratio of a bed that is shaken next.
const BEFORE_SHAKING: f64 = 0.1;
/// g [m/s²].
const GRAVITY: f64 = 9.81;
/// Time between batches of a later layer [s].
const BATCH_S: f64 = 0.15;
/// Batches it may take at most.
const BATCHES: f64 = 20.0;
/// Part of a period during which the smallest force acts before the first cycle.
const SEATING: f64 = 0.05;
/// Steps of a change of stiffness by a factor of two.
const STEPS_PER_DOUBLING: f64 = 200.0;
/// Steps that a bed may take to rest after that.
const STEPS_TO_REST: u64 = 20_000;
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
        self.test.period(
            self.accuracy.knobs().inertial_number,
            self.apparatus.loaded_area(),
            self.grains.mean_diameter(),
            self.materials.aggregate.density_kg_per_m3,
        )
    }

    /// The test as a scene.
    pub fn script(&self) -> Script {
        let knobs = self.accuracy.knobs();
        let materials = self.resolved_materials();
        let mut script = self.opening(&knobs, &materials);
        self.apparatus.set_up(&mut script);
        script.stiffen(1.0 / self.softening());
        if A::IS_OEDOMETER {
            // the bed has grown a hair as it became stiffer
            script.place(None);
        }
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
        let regions = script.slices.iter();
        script.scene.record = Record {
            every_steps: every,
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

impl Script {
    pub(super) fn add(&mut self, phase: Phase, stage: Stage) {
        self.phases.push(phase);
        self.scene.stages.push(stage);
    }

    /// Adds a plane with the bed on its side `facing`.
    pub(super) fn plane(&mut self, name: &str, axis: Axis, at: [f64; 2], material: &str) {
        let [position_m, facing] = at;
        self.scene.planes.push(Plane {
            name: name.to_owned(),
            axis,
            position_m,
            facing: if facing < 0.0 { -1 } else { 1 },
            material: material.to_owned(),
        });
    }

    /// Adds a wall of triangles.
    pub(super) fn facets(
        &mut self,
        name: &str,
        material: &str,
        triangles: Vec<crate::surface::Triangle>,
    ) {
        self.scene.facets.push(FacetMesh {
            name: name.to_owned(),
            material: material.to_owned(),
            triangles_m: Some(triangles),
            stl: None,
            scale: 1.0,
            position_m: [0.0; 3],
        });
    }

    /// The wall that loads, whose lower face is at this height [m] at the start.
    pub(super) fn loads(&mut self, wall: &str, height: f64) {
        wall.clone_into(&mut self.wall);
        self.wall_height = height;
    }

    /// Adds a sleeper between two corners [m], the wall that loads: a box of facets, or of spheres of a
    /// radius [m] whose mass together is given [kg].
    pub(super) fn sleeper(
        &mut self,
        [lower, upper]: [[f64; 3]; 2],
        material: &str,
        mass_kg: f64,
        member_radius: Option<f64>,
    ) {
        let Some(radius) = member_radius else {
            self.facets("sleeper", material, cuboid(lower, upper));
            self.loads("sleeper", lower[2]);
            return;
        };
        let members = shell(lower, upper, radius);
        let volume = members.len() as f64 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let mut own = self.scene.materials[material].clone();
        own.density_kg_per_m3 = mass_kg / volume;
        self.scene.materials.insert(SLEEPER.to_owned(), own);
        use DegreeOfFreedom as D;
        self.scene.bodies.push(Body {
            clump: Some(Clump {
                members,
                filled: None,
            }),
            // z is let go when it is set down
            fixed: vec![D::X, D::Y, D::Z, D::Rx, D::Ry],
            ..Body::at(lower, SLEEPER)
        });
        self.body = Some(0);
        self.loads("body_0", lower[2]);
    }

    /// Height of the column in which a layer is poured [m].
    pub(super) fn column(&self, layer: &Layer) -> f64 {
        let [lower, upper] = layer.footprint.bounds();
        let area = layer.footprint.volume() / (upper[2] - lower[2]);
        let solid = SOLID_FRACTION * self.overfill * layer.volume;
        // a grain needs its own height too
        solid / (self.placed_fraction * area) + self.largest_diameter
    }

    /// Time in which grains fall from this height [m], slowed by local damping [s].
    fn fall(&self, height: f64) -> f64 {
        let damping = self.scene.laws.local_damping.unwrap_or_default();
        (2.0 * height / (GRAVITY * (1.0 - damping))).sqrt()
    }

    /// Diameter of the largest ball around a grain [m].
    pub(super) fn largest_diameter(&self) -> f64 {
        self.largest_diameter
    }

    /// Pours a layer, lets it settle, compacts and cuts it.
    pub(super) fn layer(&mut self, layer: &Layer) {
        let density = self.scene.materials[AGGREGATE].density_kg_per_m3;
        let solid = SOLID_FRACTION * self.overfill * layer.volume;
        let pour = Generate {
            region: layer.footprint.with_height(self.column(layer)),
            mass_kg: Some(density * solid),
            ..self.template.clone()
        };
        if self.scene.stages.is_empty() {
            self.scene.generate.push(pour);
        } else {
            let insert = Insert {
                bodies: pour,
                every_s: BATCH_S,
                batch: None,
                steps: None,
                time_s: Some(BATCHES * BATCH_S),
            };
            self.add(Phase::Pour, Stage::Insert(Box::new(insert)));
        }
        // while most grains fall, forces do not tell whether they are at rest
        let fall = Run {
            steps: None,
            time_s: Some(self.fall(self.column(layer))),
        };
        self.add(Phase::Pour, Stage::Run(fall));
        let mut settle = self.settle;
        if self.compaction.is_some() {
            // what is shaken next need only have stopped falling
            settle.unbalanced_force_ratio = settle.unbalanced_force_ratio.max(BEFORE_SHAKING);
        }
        self.add(Phase::Settle, Stage::Settle(settle));
        if let Some(compaction) = &self.compaction {
            let vibrate = Vibrate {
                acceleration_m_per_s2: compaction.acceleration_m_per_s2,
                frequency_hz: compaction.frequency_hz,
                axes: vec![Axis::X, Axis::Y],
                periods_per_axis: 1,
                friction_factor: compaction.friction_factor,
                steps: None,
                time_s: Some(compaction.time_s),
            };
            self.add(Phase::Compact, Stage::Vibrate(vibrate));
            self.add(Phase::Settle, Stage::Settle(self.settle));
        }
        let cut = Cut {
            axis: Axis::Z,
            above_m: Some(layer.top),
            below_m: None,
        };
        self.add(Phase::Cut, Stage::Cut(cut));
        self.add(Phase::Settle, Stage::Settle(self.settle));
    }

    /// Sets the loading wall down; with a mass [kg] it rests there with its weight.
    pub(super) fn place(&mut self, mass_kg: Option<f64>) {
        let place = Place {
            wall: self.body.is_none().then(|| self.wall.clone()),
            body: self.body,
            axis: Axis::Z,
            side: -1,
            mass_kg: mass_kg.filter(|_| self.body.is_none()),
        };
        self.add(Phase::Place, Stage::Place(place));
    }

    /// Makes all materials stiffer, and lets the bed rest.
    fn stiffen(&mut self, factor: f64) {
        if factor <= 1.0 {
            return;
        }
        let steps = (factor.log2() * STEPS_PER_DOUBLING).ceil().max(1.0) as u64;
        self.add(Phase::Stiffen, Stage::Stiffen(Stiffen { factor, steps }));
        let settle = Settle {
            steps: Some(STEPS_TO_REST),
            time_s: None,
            ..self.settle
        };
        self.add(Phase::Settle, Stage::Settle(settle));
    }

    /// Slices of the bed under the wall between two heights [m], and the bed.
    pub(super) fn slice(&mut self, count: u32, top: f64) {
        let slice = |name: String, heights: [f64; 2]| Slice {
            name,
            heights,
            volume: self.loaded_area * (heights[1] - heights[0]),
        };
        let height = |index: u32| top * f64::from(index) / f64::from(count);
        let mut slices: Vec<Slice> = (0..count)
            .map(|index| {
                slice(
                    format!("slice_{}", index + 1),
                    [height(index), height(index + 1)],
                )
            })
            .collect();
        // what stands out of the cut belongs to the bed
        slices.push(slice(BED.to_owned(), [0.0, top + self.largest_diameter]));
        self.slices = slices;
    }

    /// Whether grains break.
    pub fn is_breakable(&self) -> bool {
        matches!(self.template.grain, Grain::Breakable(_))
    }
}

impl Slice {
    fn region(&self, apparatus: &impl Apparatus) -> Region {
        let [low, high] = apparatus.footprint();
        let [bottom, top] = self.heights;
        Region {
            name: self.name.clone(),
            low_m: Some([low[0], low[1], bottom]),
            high_m: Some([high[0], high[1], top]),
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
