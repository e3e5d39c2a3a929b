//! Particle steps per second of processor time on settled beds.
//!
//! `BED=file.xyzr WIDTH=1.0 [DEPTH=1.0] cargo bench --bench granular` takes a bed of spheres as
//! lines `x y z r` between five planes, `STEPS`, `THREADS`, `FRICTION` as you like; without `BED` it settles
//! a small one of its own. Friction with memory, rotation and searches are included. Prints one
//! JSON line for each friction setting. With `TURNS=60` it tells instead what two threads gain, from
//! so many pieces by turns.
//!
//! With `--features unwatched` no step looks for the deepest contact and the shortest critical step, and
//! nobody sums the work of walls: what is faster then is what that costs. `tests/figures granular_watched`
//! runs both builds by turns and counts their instructions.
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]
#[path = "../beds/mod.rs"]
mod beds;
mod turns;

use std::fs;

use beds::{PIECES, bed, run, setting, settled};
use serde_json::json;

/// Steps before the clock starts, unless `WARM` says otherwise: the bed finds its contacts again.
const WARM: u64 = 1500;

fn main() {
    let (spheres, width) = match std::env::var("BED") {
        Ok(path) => {
            let text = fs::read_to_string(path).expect("the bed can be read");
            let spheres: Vec<[f64; 4]> = text
                .lines()
                .filter_map(|line| {
                    let numbers: Vec<f64> = line
                        .split_whitespace()
                        .filter_map(|word| word.parse().ok())
                        .collect();
                    numbers.try_into().ok()
                })
                .collect();
            (spheres, setting("WIDTH", 0.45))
        }
        Err(_) => settled(),
    };
    let depth = setting("DEPTH", width);
    let rounds = setting("TURNS", 0.0) as usize;
    if rounds > 0 {
        turns::compare(&spheres, [width, depth], rounds);
        return;
    }
    let steps = setting("STEPS", 9000.0) as u64 / PIECES * PIECES;
    let threads = setting("THREADS", 1.0) as usize;
    let frictions = match std::env::var("FRICTION") {
        Ok(_) => vec![setting("FRICTION", 0.5)],
        Err(_) => vec![0.5, 0.0],
    };
    for friction in frictions {
        let mut spec = bed(&spheres, width, depth, friction);
        let piece = steps / PIECES;
        let warm = setting("WARM", WARM as f64) as u64;
        spec["stages"] = json!([{"run": {"steps": warm.div_ceil(piece) * piece + steps}}]);
        spec["record"] = json!({"every_steps": piece, "bodies": []});
        let (clock, report) = run(&spec, threads);
        let rates = |column: usize| clock.rates(column, spheres.len());
        let by_wall = rates(2);
        // the processor time of others than the caller is not known
        let by_processor = (threads == 1).then(|| rates(1));
        let work = |name: &str| report.work[name] as f64;
        println!(
            "{}",
            json!({
                "engine": "loadframe", "is_watched": loadframe_physics::WATCHES, "particles": spheres.len(), "friction": friction, "threads": threads,
                "particle_steps_per_cpu_s": by_processor.map(|rates| rates[rates.len() / 2].round()),
                "particle_steps_per_s": by_wall[by_wall.len() / 2].round(),
                "fastest_per_s": by_wall[by_wall.len() - 1].round(),
                "contacts": report.summary["contacts"].value,
                "candidates_per_particle": work("candidate_steps") / work("particle_steps"),
                "searches": work("neighbour_searches"), "steps": work("steps"),
                "unbalanced": report.summary["unbalanced_force_ratio"].value,
            })
        );
    }
}
