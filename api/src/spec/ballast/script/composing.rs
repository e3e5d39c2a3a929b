//! The script of a ballast test: materials and laws, what its apparatus sets up, load and record.
use std::collections::BTreeMap;

use super::{
    super::super::granular_scene::{Generate, GranularScene, Record, Settle},
    super::{Apparatus, Ballast, Knobs, Materials, materials::AGGREGATE},
    GRAVITY, Phase, Script, Slice,
};

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
        let mut scene = GranularScene {
            gravity_m_per_s2: [0.0, 0.0, -GRAVITY],
            materials,
            ..GranularScene::of_test(self.seed, law, damping, knobs.critical_step_fraction)
        };
        scene.laws.contact_friction = self.laws.contact_friction;
        scene.laws.bond_rest_length = self.laws.bond_rest_length;
        Script {
            scene,
            is_oedometer: A::IS_OEDOMETER,
            phases: Vec::new(),
            wall: String::new(),
            body: None,
            wall_height: 0.0,
            walls: self.apparatus.walls(),
            loaded_area: self.apparatus.loaded_area(),
            loads: BTreeMap::new(),
            weight: 0.0,
            slices: Vec::new(),
            bed: Slice::default(),
            template: Generate {
                grain: self.grains.shape.clone(),
                sizes: self.grains.sizes(),
                arrangement: self.grains.arrangement,
                turned: self.grains.turned,
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

    /// Rows and snapshots of the scene.
    fn record(&self, script: &mut Script) {
        let step = script.scene.expected_step() * self.softening().sqrt();
        let rows = self.output.rows_per_cycle;
        let times = self.blocks().into_iter();
        let shortest = times
            .map(|block| block.cycle_time())
            .fold(f64::INFINITY, f64::min);
        let every = (shortest / (f64::from(rows) * step)).floor().max(1.0) as u64;
        let snapshots = self.output.snapshots;
        let regions = script.slices.iter().chain([&script.bed]);
        script.scene.record = Record {
            every_steps: every,
            from_stage: script.stages_before(Phase::Seat),
            bodies: Some(Vec::new()),
            stage_ends: true,
            walls: [script.walls.base]
                .iter()
                .chain(script.walls.sides)
                .map(|name| (*name).to_owned())
                .collect(),
            normal_forces: script
                .walls
                .sides
                .iter()
                .map(|name| (*name).to_owned())
                .collect(),
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
