//! The script of a ballast test: materials and laws, what its apparatus sets up, load and record.
use std::collections::BTreeMap;

use super::{
    super::super::granular_scene::{Generate, GranularScene, Record, Settle, VoidMap},
    super::{Apparatus, Ballast, Knobs, Materials, grains::SpheresFirst, materials::AGGREGATE},
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
        if let Some(mat) = &materials.mat {
            let softened = knobs.stiffness * self.softening();
            script.lay_on_mat(softened * mat.contact_stiffness_n_per_m);
        }
        script.raise_cohesion(self.laws.raised_cohesion);
        script.stiffen(1.0 / self.softening());
        script.slice(self.output.slices, self.apparatus.bed_height());
        self.load(&mut script, &materials);
        self.record(&mut script);
        script
    }

    /// Spheres that clumps take the places of, if any do.
    pub(in crate::spec::ballast) fn spheres_first(&self) -> Option<SpheresFirst> {
        self.grains
            .spheres_first(self.preparation.poured_as_spheres?)
    }

    /// Materials and laws, before there is anything.
    fn opening(&self, knobs: &Knobs, materials: &Materials) -> Script {
        let softened = knobs.stiffness * self.softening();
        let materials: BTreeMap<_, _> = materials
            .named()
            .map(|(name, material)| (name.to_owned(), material.softened(softened)))
            .collect();
        let preparation = &self.preparation;
        let spheres_first = self.spheres_first();
        let poured = (spheres_first.as_ref()).map_or(&self.grains, |first| &first.spheres);
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
            rail: None,
            wall_height: 0.0,
            walls: self.apparatus.walls(),
            middle: {
                let [low, high] = self.apparatus.footprint();
                [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]))
            },
            loaded_area: self.apparatus.loaded_area(),
            loads: BTreeMap::new(),
            weight: 0.0,
            slices: Vec::new(),
            bed: Slice::default(),
            template: Generate {
                grain: poured.shape.clone(),
                sizes: poured.sizes(),
                arrangement: poured.arrangement,
                turned: poured.turned,
                ..Generate::of(AGGREGATE)
            },
            placed_fraction: poured.placed_fraction(),
            largest_diameter: (spheres_first.as_ref()).map_or_else(
                || self.grains.largest_diameter(),
                SpheresFirst::largest_diameter,
            ),
            spheres_first,
            settle: Settle {
                unbalanced_force_ratio: preparation.unbalanced_force_ratio,
                steps: None,
                time_s: Some(preparation.longest_settling_s),
            },
            compaction: preparation.compaction.clone(),
            tamping: preparation.tamping,
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
        let voids = self
            .output
            .void_cell_m
            .map(|edge| self.void_map(script, edge));
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
            // only a body of spheres tilts
            turns: script.rail.and(script.body).into_iter().collect(),
            normal_forces: script
                .walls
                .sides
                .iter()
                .map(|name| (*name).to_owned())
                .collect(),
            regions: regions
                .map(|slice| slice.region(self.apparatus.footprint()))
                .collect(),
            voids,
            snapshot_every_steps: match snapshots {
                0 => 0,
                _ => every * u64::from(rows.div_ceil(snapshots)),
            },
            ..Record::default()
        };
    }

    /// The bed below the sleeper in cells about as wide as this [m], before the load and after it.
    fn void_map(&self, script: &Script, edge: f64) -> VoidMap {
        let [low, high] = self.apparatus.footprint();
        let top = self.apparatus.bed_height();
        let (low_m, high_m) = ([low[0], low[1], 0.0], [high[0], high[1], top]);
        let cells = |axis: usize| ((high_m[axis] - low_m[axis]) / edge).round().max(1.0) as u32;
        VoidMap {
            low_m,
            high_m,
            cells: [0, 1, 2].map(cells),
            material: Some(AGGREGATE.to_owned()),
            at_ends_of: vec![
                script.stages_before(Phase::Load).saturating_sub(1),
                script.scene.stages.len().saturating_sub(1),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        JobSpec, Submission,
        spec::granular_scene::{GranularScene, Stage},
    };

    /// The scene of a test of cemented grains on a mat, whose moduli are 10¹⁰ and 2·10⁹ Pa.
    fn scene(accuracy: &str) -> GranularScene {
        let body = format!(
            r#"{{"kind": "ballast_box", "spec": {{"version": 1,
            "materials": {{
                "aggregate": {{"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e10,
                    "parallel_bond": {{"youngs_modulus_pa": 2e9, "tensile_strength_pa": 1e9,
                        "shear_strength_pa": 1e9}}}},
                "mat": {{"contact_stiffness_n_per_m": 2.54e6}}}},
            "grains": {{"shape": {{"breakable": {{"members": [
                {{"offset_m": [0, 0, 0.018], "radius_m": 0.02}},
                {{"offset_m": [0, 0, -0.018], "radius_m": 0.02}}]}}}}}},
            "accuracy": {accuracy}}}}}"#
        );
        match Submission::from_slice(body.as_bytes()) {
            Ok(Submission {
                spec: JobSpec::BallastBox(spec),
                ..
            }) => spec.script().scene,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn softened_times_stiffened_is_what_is_given_for_every_modulus() {
        let accuracies = [
            (r#""draft""#, 1e8, 1.0),
            (r#""standard""#, 1e9, 1.0),
            (r#""reference""#, 1e10, 1.0),
            (
                r#"{"stiffness": 0.5, "preparation_modulus_pa": 1e8}"#,
                1e8,
                0.5,
            ),
        ];
        for (accuracy, prepared, stiffness) in accuracies {
            let scene = scene(accuracy);
            let factors = scene.stages.iter().filter_map(|stage| match stage {
                Stage::Stiffen(stiffen) => Some(stiffen.factor),
                _ => None,
            });
            let factor: f64 = factors.product();
            let aggregate = &scene.materials["aggregate"];
            let cement = aggregate.parallel_bond.expect("it is cemented");
            let mat = (scene.planes.iter()).find_map(|plane| plane.contact_stiffness_n_per_m);
            let is = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-12;
            assert!(is(aggregate.youngs_modulus_pa, prepared), "{accuracy}");
            for (softened, given) in [
                (aggregate.youngs_modulus_pa, 1e10),
                (cement.youngs_modulus_pa, 2e9),
                (scene.materials["steel"].youngs_modulus_pa, 1e11),
                (mat.expect("a mat"), 2.54e6),
            ] {
                let tested = softened * factor;
                assert!(is(tested, stiffness * given), "{accuracy}: {tested}");
            }
        }
    }
}
