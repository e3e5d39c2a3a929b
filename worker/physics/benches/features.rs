//! What each feature of a granular scene costs: time per particle step, bytes per particle and
//! contact.
//!
//! `cargo bench --bench features` settles a bed of 2000 spheres and some of other bodies, then runs each
//! feature on it for `STEPS` steps; `ONLY=clumps` takes the rows with that word alone. Prints one JSON
//! line for each feature; `tests/figures granular_features` makes a table of them.
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]
mod beds;

use std::cell::LazyCell;

use beds::{PIECES, bed, run, setting, settled};
use serde_json::{Value, json};

/// Steps before the clock starts: the bed finds its contacts again.
const WARM: u64 = 1500;
/// Steps in which clumps come to rest.
const CLUMPS_SETTLE: u64 = 20_000;
/// Clumps along each edge of their raster.
const CLUMPS: usize = 6;

/// Steps in which spheres of a millimetre come to rest.
const SMALL_SETTLE: u64 = 80_000;
/// Steps in which a cylinder is filled.
const CYLINDER_SETTLE: u64 = 60_000;

/// Whether rows of this name are wanted.
fn is_wanted(name: &str) -> bool {
    std::env::var("ONLY").map_or(true, |word| name.contains(&word))
}

/// A scene's stages so that the last pieces are timed; prints its row.
fn measure(name: &str, mut spec: Value, warm: u64) {
    if !is_wanted(name) {
        return;
    }
    let piece = setting("STEPS", 4500.0) as u64 / PIECES;
    let steps = warm.div_ceil(piece) * piece + PIECES * piece;
    spec["stages"] = json!([{"run": {"steps": steps}}]);
    if spec["record"].is_null() {
        spec["record"] = json!({"bodies": []});
    }
    // rows of the curve are the clock, whatever else is recorded
    let every = spec["record"]["every_steps"].as_u64().unwrap_or(piece);
    spec["record"]["every_steps"] = json!(every);
    let (clock, report) = run(&spec, 1);
    let work = |name: &str| report.work[name] as f64;
    let particles = work("particle_steps") / work("steps");
    let rates = clock.rates(1, particles as usize);
    let candidates = work("candidate_steps") / work("steps");
    println!(
        "{}",
        json!({
            "feature": name,
            "ns_per_particle_step": 1e9 / rates[rates.len() / 2],
            "bytes_per_particle": work("particle_bytes") / particles,
            "bytes_per_candidate": work("contact_bytes") / candidates,
            "candidates_per_particle": candidates / particles,
        })
    );
}

/// Clumps of eight spheres at the corners of a cube that fall on each other.
fn clumps() -> Value {
    let (radius, spacing) = (0.0085, 0.042);
    let width = spacing * CLUMPS as f64 + 0.01;
    let mut spec = bed(&[], width, width, 0.5);
    let members: Vec<Value> = (0..8)
        .map(|corner| {
            let offset = [0, 1, 2].map(|axis| {
                if corner >> axis & 1 == 1 {
                    radius
                } else {
                    -radius
                }
            });
            json!({"offset_m": offset, "radius_m": radius})
        })
        .collect();
    let bodies: Vec<Value> = (0..CLUMPS * CLUMPS * CLUMPS)
        .map(|number| {
            let place = [
                number % CLUMPS,
                number / CLUMPS % CLUMPS,
                number / CLUMPS / CLUMPS,
            ];
            let position = place.map(|place| 0.025 + spacing * place as f64);
            json!({"clump": {"members": members}, "material": "stone", "position_m": position,
                   "angular_velocity_rad_per_s": [(number % 7) as f64, (number % 5) as f64, 1]})
        })
        .collect();
    spec["bodies"] = json!(bodies);
    spec
}

/// Spheres of a millimetre, dropped into a box; those twenty times as `large` come to lie among them.
fn sizes(large: usize, height: f64) -> Value {
    let width = 0.05;
    let mut spec = bed(&[], width, width, 0.5);
    let region = json!({"box": {"lower_m": [0, 0, 0], "upper_m": [width, width, height]}});
    let spheres = |count: usize, radius: f64| json!({"material": "stone", "region": region, "count": count, "sizes": {"radius_m": radius}});
    spec["generate"] = json!([spheres(12_000, 1e-3)]);
    if large > 0 {
        spec["generate"] = json!([spheres(large, 0.02), spheres(12_000, 1e-3)]);
    }
    spec["time_step_s"] = json!(3e-6);
    spec
}

/// Spheres of this mean radius [m], dropped into an upright cylinder of 24 flat sides.
fn cylinder(count: usize, radius: f64) -> Value {
    const SIDES: usize = 24;
    let (across, height) = (0.15, 0.5);
    let mut spec = bed(&[], 1.0, 1.0, 0.5);
    spec["planes"] = json!([spec["planes"][0]]);
    let corner = |side: usize, z: f64| {
        let angle = std::f64::consts::TAU * side as f64 / SIDES as f64;
        json!([across * angle.cos(), across * angle.sin(), z])
    };
    let triangles: Vec<Value> = (0..SIDES)
        .flat_map(|side| {
            let [low, next] = [side, side + 1].map(|side| corner(side, 0.0));
            let [high, opposite] = [side, side + 1].map(|side| corner(side, height));
            [json!([low, next, opposite]), json!([low, opposite, high])]
        })
        .collect();
    spec["facets"] = json!([{"name": "cylinder", "material": "stone", "triangles_m": triangles}]);
    let inside = 0.98 * across * (std::f64::consts::PI / SIDES as f64).cos();
    spec["generate"] = json!([{
        "material": "stone", "count": count,
        "region": {"cylinder": {"base_m": [0, 0, 0], "radius_m": inside, "height_m": height}},
        "sizes": {"uniform": {"smallest_radius_m": 0.6 * radius, "largest_radius_m": 1.4 * radius}},
    }]);
    spec["time_step_s"] = json!(1e-5);
    spec
}

fn main() {
    let bed_at_rest = LazyCell::new(settled);
    let with = |change: &dyn Fn(&mut Value)| {
        let (spheres, width) = &*bed_at_rest;
        let mut spec = bed(spheres, *width, *width, 0.5);
        change(&mut spec);
        spec
    };
    let smooth = |spec: &mut Value| spec["materials"]["stone"]["friction_angle_rad"] = json!(0);
    let restitution = |spec: &mut Value| spec["materials"]["stone"]["restitution"] = json!(0.5);
    let shear_restitution =
        |spec: &mut Value| spec["materials"]["stone"]["shear_restitution"] = json!(0.5);
    let law = |spec: &mut Value, law: &str| spec["laws"]["contact"] = json!(law);
    let row = |name: &str, change: &dyn Fn(&mut Value)| {
        if is_wanted(name) {
            measure(name, with(change), WARM);
        }
    };
    row("frictionless", &smooth);
    row("frictionless, restitution", &|spec| {
        smooth(spec);
        restitution(spec);
    });
    row("frictionless, Hertz", &|spec| {
        smooth(spec);
        law(spec, "hertz_mindlin");
    });
    row("friction", &|_| ());
    row("friction, logarithmic", &|spec| law(spec, "logarithmic"));
    row("friction, restitution", &restitution);
    row("friction, shear restitution", &shear_restitution);
    row("Hertz-Mindlin", &|spec| law(spec, "hertz_mindlin"));
    row("Hertz-Mindlin, restitution", &|spec| {
        law(spec, "hertz_mindlin");
        restitution(spec);
    });
    row("bonds", &|spec| {
        for cohesion in ["normal_cohesion_pa", "shear_cohesion_pa"] {
            spec["materials"]["stone"][cohesion] = json!(1e6);
        }
    });
    row("friction, a row of the curve every 100 steps", &|spec| {
        spec["record"] = json!({"bodies": [], "every_steps": 100});
    });
    row("the same, with a region", &|spec| {
        spec["record"] = json!({"bodies": [], "every_steps": 100, "regions": [{"name": "all"}]});
    });
    measure("clumps of eight", clumps(), CLUMPS_SETTLE);
    measure("equal sizes", sizes(0, 0.08), SMALL_SETTLE);
    measure("sizes 1:20", sizes(1, 0.11), SMALL_SETTLE);
    for (count, radius) in [(500, 0.016), (5000, 0.0075)] {
        let name = format!("{count} in a cylinder of facets");
        measure(&name, cylinder(count, radius), CYLINDER_SETTLE);
    }
}
