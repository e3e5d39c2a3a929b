//! Whether files can be read and what is to be made can be made.
use super::{
    Arrangement, Cut, Generate, Grain, GranularScene, Sizes, Stage, Volume,
    part_checks::{check_clump, check_cohesive, check_material},
};
use crate::{Violation, Violations};

/// Solid fractions that no arrangement of spheres in the given way exceeds: a random close packing,
/// and the lattices. Random placing ends earlier, where depends on the sizes.
const FULL: [f64; 3] = [0.64, std::f64::consts::FRAC_PI_6, 0.740_5];

/// Places of a lattice, at most: half a gigabyte, twice what the largest scene needs.
const MOST_PLACES: f64 = 2e7;

pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    for (index, import) in spec.import.iter().enumerate() {
        let pointer = format!("/import/{index}");
        let missing = check_material(spec, &pointer, &import.material);
        if missing.is_none()
            && let Err(error) = import.bodies(spec.density_of(&import.material))
        {
            violations.push(
                Violation::new(format!("{pointer}/text"), "unreadable", error.to_string())
                    .allowed("a file of the format given"),
            );
        }
        if import.breakable_clumps {
            violations.extend(check_cohesive(spec, &pointer, &import.material));
        }
        violations.extend(missing);
    }
    for (pointer, generator) in spec.generators() {
        check_generator(spec, &pointer, generator, violations);
    }
    for (pointer, generator) in spec.generators() {
        violations.extend(check_places(&pointer, generator));
    }
    for (index, generator) in spec.generate.iter().enumerate() {
        violations.extend(check_planes(spec, &format!("/generate/{index}"), generator));
        violations.extend(check_room(spec, &format!("/generate/{index}"), generator));
    }
    for (index, stage) in spec.stages.iter().enumerate() {
        if let Stage::Cut(Cut {
            above_m: None,
            below_m: None,
            ..
        }) = stage
        {
            violations.push(
                Violation::new(
                    format!("/stages/{index}/cut"),
                    "no_height",
                    "a cut needs a height",
                )
                .allowed("at least one of: above_m, below_m"),
            );
        }
    }
}

fn check_generator(
    spec: &GranularScene,
    pointer: &str,
    generator: &Generate,
    violations: &mut Violations,
) {
    violations.extend(check_material(spec, pointer, &generator.material));
    let amounts = [
        generator.count.is_some(),
        generator.mass_kg.is_some(),
        generator.porosity.is_some(),
    ];
    if amounts.iter().filter(|amount| **amount).count() != 1 {
        violations.push(
            Violation::new(
                pointer,
                "not_one_amount",
                "one number says how many are made",
            )
            .allowed("exactly one of: count, mass_kg, porosity"),
        );
    }
    match &generator.grain {
        Grain::Sphere if generator.sizes.is_none() => violations.push(
            Violation::new(
                format!("{pointer}/sizes"),
                "missing_field",
                "spheres need their sizes",
            )
            .allowed("one of: radius_m, uniform, log_normal, sieve_curve"),
        ),
        Grain::Breakable(_) => {
            violations.extend(check_cohesive(spec, pointer, &generator.material));
        }
        Grain::Sphere | Grain::Clump(_) => {}
    }
    violations.extend(check_grain(&format!("{pointer}/grain"), &generator.grain));
    if let Some(sizes) = &generator.sizes {
        check_sizes(&format!("{pointer}/sizes"), sizes, violations);
    }
    if let Volume::Box { lower_m, upper_m } = &generator.region
        && (0..3).any(|axis| lower_m[axis] >= upper_m[axis])
    {
        violations.push(
            Violation::new(
                format!("{pointer}/region/box/upper_m"),
                "empty_region",
                "the box is empty",
            )
            .value(upper_m.to_vec())
            .allowed(format!("above {lower_m:?} along every axis"))
            .unit("m"),
        );
    }
}

fn check_sizes(pointer: &str, sizes: &Sizes, violations: &mut Violations) {
    let mut ordered = |pointer: String, smallest: f64, largest: f64| {
        if largest < smallest {
            violations.push(
                Violation::new(pointer, "out_of_order", "the largest is below the smallest")
                    .value(largest)
                    .allowed(format!("≥ {smallest}"))
                    .unit("m"),
            );
        }
    };
    match sizes {
        Sizes::Uniform {
            smallest_radius_m,
            largest_radius_m,
        } => ordered(
            format!("{pointer}/uniform/largest_radius_m"),
            *smallest_radius_m,
            *largest_radius_m,
        ),
        Sizes::SieveCurve(fractions) => {
            for (index, fraction) in fractions.iter().enumerate() {
                ordered(
                    format!("{pointer}/sieve_curve/{index}/largest_diameter_m"),
                    fraction.smallest_diameter_m,
                    fraction.largest_diameter_m,
                );
            }
        }
        Sizes::RadiusM(_) | Sizes::LogNormal { .. } => {}
    }
}

/// Nothing may be made behind a plane.
fn check_planes(spec: &GranularScene, pointer: &str, generator: &Generate) -> Option<Violation> {
    let [lower, upper] = generator.region.bounds();
    let plane = spec.planes.iter().find(|plane| {
        let axis = plane.axis.index();
        if plane.facing > 0 {
            lower[axis] < plane.position_m
        } else {
            upper[axis] > plane.position_m
        }
    })?;
    let detail = format!("the region reaches behind plane {:?}", plane.name);
    Some(
        Violation::new(format!("{pointer}/region"), "behind_plane", detail).allowed(format!(
            "a region {} {} m along {}",
            if plane.facing > 0 { "above" } else { "below" },
            plane.position_m,
            ["x", "y", "z"][plane.axis.index()]
        )),
    )
}

/// Grains on a lattice in a region that has far more places than they take.
fn check_places(pointer: &str, generator: &Generate) -> Option<Violation> {
    let places = generator.places();
    (places > MOST_PLACES).then(|| {
        let detail = "the lattice has too many places in this region, which are all listed";
        Violation::new(format!("{pointer}/region"), "too_large", detail)
            .value(places)
            .allowed(format!(
                "at most {MOST_PLACES:e} places: a region for the grains that are made"
            ))
    })
}

/// Gradings that surely do not fit are refused before anything is tried.
fn check_room(spec: &GranularScene, pointer: &str, generator: &Generate) -> Option<Violation> {
    let density = spec.density_of(&generator.material);
    let fraction = generator.expected_solid_fraction(density);
    let full = match generator.arrangement {
        Arrangement::Random => FULL[0],
        Arrangement::Grid => FULL[1],
        Arrangement::Hexagonal => FULL[2],
    };
    (fraction > full && generator.sizes.is_some()).then(|| {
        let detail = format!(
            "about {} grains would take {fraction:.3} of the region's {:.3e} m³: use a larger \
             region, fewer grains, or a stage that inserts them in batches",
            generator.expected_grains(density).round(),
            generator.region.volume(),
        );
        Violation::new(format!("{pointer}/region"), "does_not_fit", detail)
            .value(fraction)
            .allowed(format!("a solid fraction ≤ {full:.3}"))
            .unit("1")
    })
}

/// A grain that is a clump can be one.
pub(crate) fn check_grain(pointer: &str, grain: &Grain) -> Option<Violation> {
    match grain {
        Grain::Sphere => None,
        Grain::Clump(template) => check_clump(&format!("{pointer}/clump"), template),
        Grain::Breakable(template) => check_clump(&format!("{pointer}/breakable"), template),
    }
}
