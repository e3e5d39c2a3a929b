//! What the JSON Schema cannot say of a test.
use super::{
    super::granular_scene::{Clump, Grain, MOST_MEMBERS, check_grain},
    Apparatus, Ballast, Tamper,
    shapes::shell_members,
};
use crate::spec::repeats::check_seeds;
use crate::{Violation, Violations, spec_trait::Spec as _};

/// The largest grain over the narrowest width that it is poured into, at most: wider ones jam.
const LARGEST_GRAIN: f64 = 0.65;

/// Ways to say the pace of a load.
const PACES: [&str; 3] = ["period_s", "frequency_hz", "velocity_m_per_s"];
/// Cycles of machines: each is two of the stages of a scene.
const MACHINE_CYCLES: u64 = 450;

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

/// Finds what a sleeper cannot do that tilts, or a rail where it does not; `pointers` are those of the two
/// fields and of the radius of spheres, `sides` those of its top along x and y [m].
pub(super) fn check_tilting(
    [tilts, rail, radius]: [&str; 3],
    (does_tilt, is_of_spheres): (bool, bool),
    rail_m: Option<[f64; 2]>,
    sides: [f64; 2],
) -> Option<Violation> {
    if does_tilt && !is_of_spheres {
        let detail = "a sleeper of flat faces is a wall, which moves along axes and does not turn; one of \
                      spheres is a body, which does";
        let violation = Violation::new(tilts, "not_together", detail).value(true);
        return Some(violation.allowed(format!(
            "false, or {radius} given: a shell of spheres, the flatter the smaller they are"
        )));
    }
    let place = rail_m?;
    if !does_tilt {
        let detail = "a sleeper that does not tilt does not feel where its rail stands";
        let violation = Violation::new(rail, "not_together", detail).value(place.to_vec());
        return Some(violation.allowed("none, or a sleeper that tilts").unit("m"));
    }
    let halves = sides.map(|side| 0.5 * side);
    (0..2)
        .any(|axis| place[axis].abs() > halves[axis])
        .then(|| {
            let violation = Violation::new(rail, "too_large", "the rail stands beside its sleeper");
            let [x, y] = halves;
            let violation = violation.value(place.to_vec());
            violation
                .allowed(format!("within ±{x} along x and ±{y} along y"))
                .unit("m")
        })
}

pub(super) fn check<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    spec.apparatus.check(violations);
    violations.extend(check_seeds(spec.seed, spec.repeats, "repeats"));
    check_load(spec, violations);
    violations.extend(check_mat(spec));
    if let (Some(edge), true) = (spec.output.void_cell_m, A::IS_OEDOMETER) {
        let detail = "an oedometer has no sleeper below which voids could be";
        violations.push(
            Violation::new("/output/void_cell_m", "not_together", detail)
                .value(edge)
                .allowed("none; /output/slices tells its porosity over height")
                .unit("m"),
        );
    }
    check_shape(spec, violations);
    violations.extend(check_spheres_first(spec));
    if !violations.is_empty() {
        return;
    }
    check_machine(spec, violations);
    violations.extend(check_tamping(spec));
    if !violations.is_empty() {
        // its scene would have no such wall
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
    let first = [test.period_s, test.frequency_hz, test.velocity_m_per_s];
    let then = (test.then.iter())
        .map(|block| [block.period_s, block.frequency_hz, block.velocity_m_per_s]);
    let pointers = (0..test.then.len()).map(|index| format!("/test/then/{index}"));
    let pointers = || ["/test".to_owned()].into_iter().chain(pointers.clone());
    for (pointer, paces) in pointers().zip([first].into_iter().chain(then)) {
        let given = paces
            .iter()
            .zip(PACES)
            .filter_map(|(pace, field)| Some((field, (*pace)?)));
        if let Some((field, value)) = given.skip(1).last() {
            let detail = "the pace of a load is said in one way";
            violations.push(
                Violation::new(format!("{pointer}/{field}"), "not_both", detail)
                    .value(value)
                    .allowed(format!("at most one of: {}", PACES.join(", "))),
            );
        }
    }
    let mut stages = 0;
    for (pointer, block) in pointers().zip(test.history()) {
        let [smallest, peak] = block.forces();
        if peak <= smallest {
            let detail = "the load does not swing";
            violations.push(
                Violation::new(format!("{pointer}/peak_force_n"), "out_of_order", detail)
                    .value(peak)
                    .allowed(format!("> {smallest}"))
                    .unit("N"),
            );
        }
        if block.velocity_m_per_s.is_some() {
            stages += 2 * u64::from(block.cycles.unwrap_or(1));
        }
        if stages > 2 * MACHINE_CYCLES {
            let detail = "a machine goes down and up in stages of their own";
            violations.push(
                Violation::new(format!("{pointer}/cycles"), "too_many", detail)
                    .value(block.cycles)
                    .allowed(format!(
                        "at most {MACHINE_CYCLES} cycles with a velocity in all"
                    )),
            );
            break;
        }
    }
}

/// The layer below the bed is given in one way, where there is one.
fn check_mat<A: Apparatus>(spec: &Ballast<A>) -> Option<Violation> {
    let mat = spec.materials.mat?;
    let (code, detail, allowed) = if spec.materials.rubber.is_some() {
        let detail = "the layer below is given by its modulus or by its stiffness";
        ("not_both", detail, "exactly one of: rubber, mat")
    } else if A::IS_OEDOMETER {
        let detail = "an oedometer stands on steel";
        ("not_together", detail, "none; a box or a rail bed has one")
    } else {
        return None;
    };
    let violation = Violation::new("/materials/mat/contact_stiffness_n_per_m", code, detail);
    let violation = violation.value(mat.contact_stiffness_n_per_m);
    Some(violation.allowed(allowed).unit("N/m"))
}

/// A sleeper of spheres is a body, which does not follow a sine.
fn check_tamping<A: Apparatus>(spec: &Ballast<A>) -> Option<Violation> {
    let tamping = spec.preparation.tamping?;
    (tamping.by == Tamper::Plate && spec.script().body.is_some()).then(|| {
        let detail = "a sleeper of flat faces beats the bed, not one of spheres";
        Violation::new("/preparation/tamping/by", "not_together", detail)
            .value("plate")
            .allowed("\"base\", or a sleeper without a radius of spheres")
    })
}

/// A sleeper of spheres is a body, and stages end by forces on walls.
fn check_machine<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    let mut blocks = spec.test.history().into_iter();
    let machine = blocks.position(|block| block.velocity_m_per_s.is_some());
    if let Some(block) = machine
        && spec.script().body.is_some()
    {
        let pointer = match block.checked_sub(1) {
            None => "/test/velocity_m_per_s".to_owned(),
            Some(index) => format!("/test/then/{index}/velocity_m_per_s"),
        };
        let detail = "a machine moves a sleeper of flat faces, not one of spheres";
        violations.push(
            Violation::new(pointer, "not_together", detail)
                .allowed("a sleeper without a radius of spheres, or a period"),
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

/// What takes the places of spheres is rigid, and is turned.
fn check_spheres_first<A: Apparatus>(spec: &Ballast<A>) -> Option<Violation> {
    spec.preparation.poured_as_spheres?;
    let pointer = "/preparation/poured_as_spheres";
    let (detail, allowed) = match &spec.grains.shape {
        Grain::Sphere => (
            "these grains are spheres",
            "none, or a clump as /grains/shape",
        ),
        Grain::Breakable(_) => (
            "grains that break are poured as they are: their bonds are made with them",
            "none, or a rigid clump as /grains/shape",
        ),
        Grain::Clump(_) if !spec.grains.turned => (
            "clumps that take the places of spheres are turned at random",
            "none, or /grains/turned left out",
        ),
        Grain::Clump(_) => return None,
    };
    Some(Violation::new(pointer, "not_together", detail).allowed(allowed))
}

fn check_sizes<A: Apparatus>(spec: &Ballast<A>, violations: &mut Violations) {
    let [low, high] = spec.apparatus.footprint();
    let widths = [high[0] - low[0], high[1] - low[1]];
    let narrowest = widths
        .into_iter()
        .fold(spec.apparatus.bed_height(), f64::min);
    let largest = (spec.spheres_first()).map_or_else(
        || spec.grains.largest_diameter(),
        |first| first.largest_diameter(),
    );
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
    if pointer.ends_with("/replace/material") {
        return "/materials/aggregate".to_owned();
    }
    if pointer.ends_with("/replace/equal") {
        return "/preparation/poured_as_spheres/equal".to_owned();
    }
    if pointer.starts_with("/record/voids") {
        return "/output/void_cell_m".to_owned();
    }
    if pointer.starts_with("/laws/raised_cohesion") {
        return "/laws/raised_cohesion".to_owned();
    }
    if pointer.starts_with("/planes/") && pointer.ends_with("/contact_stiffness_n_per_m") {
        return "/materials/mat/contact_stiffness_n_per_m".to_owned();
    }
    if pointer.starts_with("/materials/") || pointer.starts_with("/laws/") {
        return pointer.to_owned();
    }
    "/apparatus".to_owned()
}
