//! What an apparatus adds to a script: walls, layers of grains, the wall that loads.
use std::f64::consts::FRAC_PI_2;

use super::super::curve_columns;
use super::{
    super::super::granular_scene::{
        Arrangement, Axis, Body, Clump, Cut, DegreeOfFreedom, Drive, Equal, FacetMesh, Generate,
        Grain, Insert, Place, Plane, RaisedCohesion, Relax, Replace, Run, Settle, Sine, Stage,
        Stiffen, Vibrate, WallDrive,
    },
    super::{Tamper, Tilting},
    super::{
        materials::{AGGREGATE, RUBBER},
        shapes::shell,
    },
    BED, GRAVITY, Layer, Phase, Script, Slice,
};
use crate::surface::{Triangle, cuboid};

/// Solid fraction of a bed that amounts are reckoned with.
const SOLID_FRACTION: f64 = 0.6;
/// Time between batches of a later layer [s].
const BATCH_S: f64 = 0.15;
/// Batches it may take at most.
const BATCHES: f64 = 20.0;
/// Steps of a change of stiffness by a factor of two.
const STEPS_PER_DOUBLING: f64 = 200.0;
/// Steps that a bed may take to rest after that.
const STEPS_TO_REST: u64 = 20_000;
/// Unbalanced force ratio of a bed that is shaken next.
const BEFORE_SHAKING: f64 = 0.1;
/// Overlap over the smaller radius to which clumps that stand out of their spheres are taken apart, and
/// the steps that may take.
const TAKEN_APART: f64 = 0.02;
const STEPS_APART: u64 = 20_000;
/// Material of a sleeper of spheres, which has the mass it should.
const SLEEPER: &str = "sleeper";

impl Script {
    pub(in crate::spec::ballast) fn add(&mut self, phase: Phase, stage: Stage) {
        self.phases.push(phase);
        self.scene.stages.push(stage);
    }

    /// Adds a plane with the bed on its side `facing`.
    pub(in crate::spec::ballast) fn plane(
        &mut self,
        name: &str,
        axis: Axis,
        at: [f64; 2],
        material: &str,
    ) {
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

    /// Gives what lies on rubber its stiffness under a grain [N/m].
    pub(super) fn lay_on_mat(&mut self, stiffness: f64) {
        let planes = self.scene.planes.iter_mut();
        for plane in planes.filter(|plane| plane.material == RUBBER) {
            plane.contact_stiffness_n_per_m = Some(stiffness);
        }
    }

    /// Adds a wall of triangles.
    pub(in crate::spec::ballast) fn facets(
        &mut self,
        name: &str,
        material: &str,
        triangles: Vec<Triangle>,
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
    pub(in crate::spec::ballast) fn loads(&mut self, wall: &str, height: f64) {
        wall.clone_into(&mut self.wall);
        self.wall_height = height;
    }

    /// Adds a sleeper between two corners [m], the wall that loads: a box of facets, or of spheres of a
    /// radius [m] whose mass together is given [kg].
    pub(in crate::spec::ballast) fn sleeper(
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
            fixed: vec![D::X, D::Y, D::Z, D::Rx, D::Ry, D::Rz],
            ..Body::at(lower, SLEEPER)
        });
        self.body = Some(0);
        self.loads("body_0", lower[2]);
    }

    /// Lets the sleeper of spheres tilt.
    pub(in crate::spec::ballast) fn tilt(&mut self, tilting: Option<Tilting>) {
        let body = self.body.map(|body| body as usize);
        let body = body.and_then(|body| self.scene.bodies.get_mut(body));
        if let (Some(body), Some(Tilting { mut held, rail })) = (body, tilting) {
            // z is let go when it is set down
            held.push(DegreeOfFreedom::Z);
            body.fixed = held;
            self.rail = Some(rail);
        }
    }

    /// Solid volume that is poured for a layer [m³].
    fn poured_volume(&self, layer: &Layer) -> f64 {
        let kept = (self.spheres_first.as_ref()).map_or(1.0, |first| first.volume_ratio);
        SOLID_FRACTION * self.overfill * layer.volume / kept
    }

    /// How far a layer of spheres sinks when clumps have taken their places [m].
    fn sinking(&self, layer: &Layer, volume_ratio: f64) -> f64 {
        let bed = self.poured_volume(layer) / (SOLID_FRACTION * layer.area());
        bed * (1.0 - volume_ratio).max(0.0)
    }

    /// Height of the column in which a layer is poured [m].
    pub(in crate::spec::ballast) fn column(&self, layer: &Layer) -> f64 {
        let area = layer.area();
        let solid = self.poured_volume(layer);
        // a grain needs its own height too
        solid / (self.placed_fraction * area) + self.largest_diameter
    }

    /// Time in which grains fall from this height [m], slowed by local damping [s].
    fn fall(&self, height: f64) -> f64 {
        let damping = self.scene.laws.local_damping.unwrap_or_default();
        (2.0 * height / (GRAVITY * (1.0 - damping))).sqrt()
    }

    /// Diameter of the largest ball around a grain [m].
    pub(in crate::spec::ballast) fn largest_diameter(&self) -> f64 {
        self.largest_diameter
    }

    /// Pours a layer and lets it settle.
    pub(in crate::spec::ballast) fn pour(&mut self, layer: &Layer) {
        let density = self.scene.materials[AGGREGATE].density_kg_per_m3;
        let solid = self.poured_volume(layer);
        let pour = Generate {
            region: layer.footprint.with_height(self.column(layer)),
            mass_kg: Some(density * solid),
            ..self.template.clone()
        };
        if self.scene.stages.is_empty() {
            self.scene.generate.push(pour);
        } else {
            let insert = Insert {
                bodies: Generate {
                    arrangement: Arrangement::Random,
                    ..pour
                },
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
        if let Some(first) = &self.spheres_first {
            let equal = first.equal;
            let replace = Replace {
                material: AGGREGATE.to_owned(),
                clump: first.clump.clone(),
                equal,
            };
            let after = match equal {
                Equal::Mass => Stage::Relax(Relax {
                    largest_overlap_ratio: TAKEN_APART,
                    steps: STEPS_APART,
                }),
                // again most of them fall
                Equal::Size => Stage::Run(Run {
                    steps: None,
                    time_s: Some(self.fall(self.sinking(layer, first.volume_ratio))),
                }),
            };
            self.add(Phase::Replace, Stage::Replace(Box::new(replace)));
            self.add(Phase::Replace, after);
            self.add(Phase::Settle, Stage::Settle(settle));
        }
    }

    /// Shakes what has been poured, if the bed is to be compacted, and lets it rest.
    pub(in crate::spec::ballast) fn compact(&mut self) {
        if let Some(compaction) = &self.compaction {
            let vibrate = Vibrate {
                acceleration_m_per_s2: compaction.acceleration_m_per_s2,
                frequency_hz: compaction.frequency_hz,
                axes: compaction.axes.clone(),
                periods_per_axis: 1,
                friction_factor: compaction.friction_factor,
                steps: None,
                time_s: Some(compaction.time_s),
            };
            self.add(Phase::Compact, Stage::Vibrate(vibrate));
        }
        self.tamp();
        self.rest();
    }

    /// Beats the bed with the wall that loads, once that has been set down, or with its base.
    fn tamp(&mut self) {
        let Some(tamping) = self.tamping else { return };
        let period = tamping.frequency_hz.recip();
        let amplitude_m = [0.0, 0.0, tamping.amplitude_m];
        // down from where it is and back, or about where it is
        let (wall, phase_rad) = match tamping.by {
            Tamper::Plate if !self.phases.contains(&Phase::Place) => return,
            Tamper::Plate => (self.wall.as_str(), FRAC_PI_2),
            Tamper::Base => (self.walls.base, 0.0),
        };
        let swing = WallDrive {
            sine: Some(Sine {
                amplitude_m,
                frequency_hz: tamping.frequency_hz,
                phase_rad,
            }),
            ..WallDrive::of(wall)
        };
        // a hair less than a swing is round-off
        let swings = (tamping.time_s / period - 1e-9).ceil().max(1.0);
        let drive = Drive {
            walls: vec![swing],
            bodies: Vec::new(),
            // nobody asks of a bed that is beaten whether it is close to rest
            flow: true,
            friction_factor: tamping.friction_factor,
            until: None,
            steps: None,
            time_s: Some(swings * period),
        };
        self.add(Phase::Tamp, Stage::Drive(drive));
    }

    /// Multiplies cohesions until the last grains have been poured.
    pub(super) fn raise_cohesion(&mut self, factor: Option<f64>) {
        let last = self.phases.iter().rposition(|phase| *phase == Phase::Pour);
        self.scene.laws.raised_cohesion = factor.map(|factor| RaisedCohesion {
            factor,
            from_stage: 0,
            until_stage: last.map_or(1, |last| last + 1),
        });
    }

    /// Takes out what stands above a height [m].
    pub(in crate::spec::ballast) fn cut(&mut self, height: f64) {
        let cut = Cut {
            axis: Axis::Z,
            above_m: Some(height),
            below_m: None,
        };
        self.add(Phase::Cut, Stage::Cut(cut));
    }

    pub(in crate::spec::ballast) fn rest(&mut self) {
        self.add(Phase::Settle, Stage::Settle(self.settle));
    }

    /// Sets the loading wall down, where it rests with the weight of its mass [kg].
    pub(in crate::spec::ballast) fn place(&mut self, mass_kg: f64) {
        let place = Place {
            wall: self.body.is_none().then(|| self.wall.clone()),
            body: self.body,
            axis: Axis::Z,
            side: -1,
            mass_kg: self.body.is_none().then_some(mass_kg),
        };
        self.add(Phase::Place, Stage::Place(place));
    }

    /// Makes all materials stiffer, and lets the bed rest.
    pub(super) fn stiffen(&mut self, factor: f64) {
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
    pub(in crate::spec::ballast) fn slice(&mut self, count: u32, top: f64) {
        let slice = |name: String, heights: [f64; 2]| Slice { name, heights };
        let height = |index: u32| top * f64::from(index) / f64::from(count);
        let slices = (0..count).map(|index| {
            slice(
                format!("slice_{}", index + 1),
                [height(index), height(index + 1)],
            )
        });
        self.slices = slices.collect();
        // what stands out of the cut belongs to the bed
        self.bed = slice(BED.to_owned(), [0.0, top + self.largest_diameter]);
    }

    /// Number of stages before the first of a phase.
    pub(super) fn stages_before(&self, phase: Phase) -> usize {
        let phases = self.phases.iter();
        phases.take_while(|known| **known != phase).count()
    }

    /// Whether grains break.
    pub fn is_breakable(&self) -> bool {
        matches!(self.template.grain, Grain::Breakable(_))
    }

    /// Names of the curve's columns.
    pub fn columns(&self) -> Vec<&'static str> {
        curve_columns(self.rail.is_some(), self.is_breakable())
    }
}
