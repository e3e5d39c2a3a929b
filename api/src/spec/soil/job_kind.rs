//! A test of soil as a kind of job.
use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};

use super::super::{granular_scene::results as scene, repeats::check_seeds};
use super::{Shearing, Soil};
use crate::results::Named;
use crate::spec_trait::Spec;
use crate::{Calibration, Estimate, Extent, Violation, Violations};

/// The largest grain over the narrowest side of a specimen, at most: wider ones measure the walls.
const LARGEST_GRAIN: f64 = 0.25;

impl<T> Spec for Soil<T>
where
    T: Shearing + Serialize + DeserializeOwned + JsonSchema,
{
    const RESULTS: &'static [&'static [Named]] = &[T::RESULTS, scene::RESULTS];
    const IS_RESUMABLE: bool = true;

    fn check(&self, violations: &mut Violations) {
        self.test.check(violations);
        violations.extend(check_seeds(self.seed, self.repeats, "repeats"));
        if self.grains.sizes.is_none() && self.grains.shape.template().is_none() {
            let detail = "spheres need sizes";
            let violation = Violation::new("/grains/sizes", "missing", detail);
            violations.push(violation.allowed("radii, a distribution or a sieve curve"));
        }
        if !violations.is_empty() {
            return;
        }
        self.check_sizes(violations);
        if !violations.is_empty() {
            return;
        }
        let mut of_scene = Violations::default();
        self.script().scene.check(&mut of_scene);
        violations.extend(of_scene.into_vec().into_iter().map(|mut violation| {
            violation.pointer = pointer_in_test(&violation.pointer);
            violation
        }));
    }

    fn normalise(&mut self) {
        self.accuracy.write_out();
    }

    fn estimate(&self, calibration: &Calibration) -> Estimate {
        let one = self.script().scene.estimate(calibration);
        one.of_repeats(self.repeats)
    }

    fn extent(&self) -> Extent {
        self.script().scene.extent()
    }

    fn curve_columns(&self) -> Vec<String> {
        let names = T::COLUMNS.iter();
        names.map(|name| (*name).to_owned()).collect()
    }

    fn seed(&self) -> u64 {
        self.seed
    }
}

impl<T: Shearing> Soil<T> {
    fn check_sizes(&self, violations: &mut Violations) {
        let sides = self.test.sides().into_iter();
        let narrowest = sides.fold(f64::INFINITY, f64::min);
        let grains = &self.grains;
        let largest = grains.shape.largest_diameter(grains.sizes.as_ref());
        let allowed = LARGEST_GRAIN * narrowest;
        if largest > allowed {
            let field = if grains.sizes.is_some() {
                "/grains/sizes"
            } else {
                "/grains/shape"
            };
            let detail = "the largest grain is too large for the specimen's smallest side";
            violations.push(
                Violation::new(field, "does_not_fit", detail)
                    .value(largest)
                    .allowed(format!("≤ {allowed:.3e}, a quarter of the side"))
                    .unit("m"),
            );
        }
    }
}

/// Where in a test the cause is of what a scene complains about.
fn pointer_in_test(pointer: &str) -> String {
    let known = [
        ("/generate/0/grain", "/grains/shape"),
        ("/generate/0/sizes", "/grains/sizes"),
        ("/generate/0", "/grains"),
        ("/materials/soil", "/soil"),
        ("/materials/smooth", "/soil"),
    ];
    for (scene, test) in known {
        if let Some(rest) = pointer.strip_prefix(scene) {
            return format!("{test}{rest}");
        }
    }
    if pointer.starts_with("/laws/") {
        return pointer.to_owned();
    }
    "/test".to_owned()
}
