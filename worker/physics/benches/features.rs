//! What each feature of a granular scene costs: time per particle step, bytes per particle and
//! contact.
//!
//! `cargo bench --bench features` settles a bed of 2000 spheres and one of clumps, then runs each
//! feature on it for `STEPS` steps. Prints the rows of a Markdown table.
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]
mod beds;

use beds::{PIECES, bed, run, setting, settled};
use serde_json::{Value, json};

/// Steps before the clock starts: the bed finds its contacts again.
const WARM: u64 = 1500;
/// Steps in which clumps come to rest.
const CLUMPS_SETTLE: u64 = 20_000;
/// Clumps along each edge of their raster.
const CLUMPS: usize = 6;

/// A scene's stages so that the last pieces are timed; prints its row.
fn measure(name: &str, mut spec: Value, warm: u64, particles: usize) {
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
    let rates = clock.rates(1, particles);
    let work = |name: &str| report.work[name] as f64;
    let candidates = work("candidate_steps") / work("steps");
    println!(
        "| {name} | {:.1} | {:.0} | {:.0} | {:.1} |",
        1e9 / rates[rates.len() / 2],
        work("particle_bytes") / particles as f64,
        work("contact_bytes") / candidates,
        candidates / particles as f64,
    );
}

/// Clumps of eight spheres at the corners of a cube that fall on each other.
fn clumps() -> (Value, usize) {
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
    let count = 8 * bodies.len();
    spec["bodies"] = json!(bodies);
    (spec, count)
}

fn main() {
    println!(
        "| feature | ns per particle step | bytes per particle | bytes per candidate | candidates per particle |"
    );
    println!("|---|---|---|---|---|");
    let (spheres, width) = settled();
    let with = |change: &dyn Fn(&mut Value)| {
        let mut spec = bed(&spheres, width, width, 0.5);
        change(&mut spec);
        spec
    };
    let smooth = |spec: &mut Value| spec["materials"]["stone"]["friction_angle_rad"] = json!(0);
    let restitution = |spec: &mut Value| spec["materials"]["stone"]["restitution"] = json!(0.5);
    let law = |spec: &mut Value, law: &str| spec["laws"]["contact"] = json!(law);
    let row =
        |name: &str, change: &dyn Fn(&mut Value)| measure(name, with(change), WARM, spheres.len());
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
    let (spec, count) = clumps();
    measure("friction, clumps of eight", spec, CLUMPS_SETTLE, count);
}
