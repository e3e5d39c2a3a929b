//! What the JSON Schema cannot say of a test.
use super::{
    super::granular_scene::{Clump, MOST_MEMBERS, check_grain},
    Apparatus, Ballast,
    shapes::shell_members,
};
use crate::{Violation, Violations, spec_trait::Spec as _};

/// The largest grain over the narrowest width that it is poured into, at most: wider ones jam.
const LARGEST_GRAIN: f64 = 0.65;

/// Finds a sleeper with these sides [m] that would be of too many spheres; the pointer is that of their
/// radius [m].
pub(super) fn check_shell(
    pointer: &str,
    sides: [f64; 3],
    radius: Option<f64>,
) -> Option<Violation> {
    let radius = radius?;
    let members = shell_members(sides, radius) as u64;
    (members > MOST_MEMBERS).then(|| {
        let detail = format!("the sleeper would be of {members} spheres");
        let faces = 2.0
            * (0..3)
                .map(|axis| sides[axis] * sides[(axis + 1) % 3])
                .sum::<f64>();
        let enough = 0.5 * (faces / MOST_MEMBERS as f64).sqrt();
        Violation::new(pointer, "too_large", detail)
            .value(radius)
            .allowed(format!(
                "at most {MOST_MEMBERS} spheres: from about {enough:.2e} on"
            ))
            .unit("m")
    })
}

pub(super) fn check<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    spec.apparatus.check(violations);
    check_load(spec, violations);
    check_shape(spec, violations);
    if !violations.is_empty() {
        return;
    }
    check_sizes(spec, violations);
    let mut of_scene = Violations::default();
    spec.script().scene.check(&mut of_scene);
    violations.extend(of_scene.into_vec().into_iter().map(|mut violation| {
        violation.pointer = pointer_in_test(&violation.pointer);
        violation
    }));
}

fn check_load<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    let test = &spec.test;
    if test.period_s.is_some() && test.frequency_hz.is_some() {
        let detail = "a period and a frequency say the same";
        violations.push(
            Violation::new("/test/frequency_hz", "not_both", detail)
                .value(test.frequency_hz)
                .allowed("at most one of: period_s, frequency_hz"),
        );
    }
    if test.peak_force_n <= test.smallest_force_n {
        let detail = "the load does not swing";
        violations.push(
            Violation::new("/test/peak_force_n", "out_of_order", detail)
                .value(test.peak_force_n)
                .allowed(format!("> {}", test.smallest_force_n))
                .unit("N"),
        );
    }
}

fn check_shape<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    let shape = &spec.grains.shape;
    let is_one = |clump: &Clump| clump.filled.is_none() && clump.members.len() == 1;
    if shape.template().is_some_and(is_one) {
        let detail = "a clump of one is a sphere";
        violations.push(
            Violation::new("/grains/shape", "clump_of_one", detail)
                .value(1)
                .allowed("at least 2 members, or \"sphere\""),
        );
    }
    violations.extend(check_grain("/grains/shape", shape));
}

fn check_sizes<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    let [low, high] = spec.apparatus.footprint();
    let widths = [high[0] - low[0], high[1] - low[1]];
    let narrowest = widths
        .into_iter()
        .fold(spec.apparatus.bed_height(), f64::min);
    let largest = spec.grains.largest_diameter();
    let allowed = LARGEST_GRAIN * narrowest;
    if largest > allowed {
        let detail = format!(
            "the largest grain, {largest:.4} m, does not fit: the bed is {narrowest:.4} m wide or \
             high where it is loaded"
        );
        let field = if spec.grains.sizes.is_some() {
            "/grains/sizes"
        } else {
            "/grains/shape"
        };
        violations.push(
            Violation::new(field, "does_not_fit", detail)
                .value(largest)
                .allowed(format!("≤ {allowed:.4}"))
                .unit("m"),
        );
    }
}

/// Where in a test the cause is of what a scene complains about.
fn pointer_in_test(pointer: &str) -> String {
    let known = [
        ("/generate/0/grain/", "/grains/shape/"),
        ("/generate/0/grain", "/grains/shape"),
        ("/generate/0/sizes", "/grains/sizes"),
        ("/generate/0/material", "/materials/aggregate"),
        ("/generate/0", "/grains"),
    ];
    for (scene, test) in known {
        if let Some(rest) = pointer.strip_prefix(scene) {
            return format!("{test}{rest}");
        }
    }
    if pointer.starts_with("/materials/") || pointer.starts_with("/laws/") {
        return pointer.to_owned();
    }
    "/apparatus".to_owned()
}
