//! Particle steps per second of processor time on settled beds.
//!
//! `BED=file.xyzr WIDTH=1.0 [DEPTH=1.0] cargo bench --bench granular` takes a bed of spheres as
//! lines `x y z r` between five planes, `STEPS`, `THREADS` as you like; without `BED` it settles
//! a small one of its own. Friction with memory, rotation and searches are included. Prints one
//! JSON line for each friction setting.
#![allow(clippy::print_stdout, reason = "the table is what it is run for")]
use std::{fs, io, time::Instant};

use loadframe_api::{JobSpec, Submission};
use loadframe_physics::{Ending, Recorder, RunContext, Uninterrupted, simulate};
use serde_json::{Value, json};

/// Steps before the clock starts: the bed finds its contacts again.
const WARM: u64 = 1500;
/// Pieces that the timed steps are cut into; the median is what is told.
const PIECES: u64 = 9;
const STEP_S: f64 = 2e-5;

/// Notes the time at every point of the curve and keeps the tables.
struct Clock {
    start: Instant,
    /// Step, processor time and wall time.
    times: Vec<[f64; 3]>,
    bodies: String,
}

impl Recorder for Clock {
    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        let wall = self.start.elapsed().as_secs_f64();
        self.times.push([values[0], self.processor_time(), wall]);
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn io::Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        if name == "bodies.csv" {
            self.bodies = String::from_utf8_lossy(&bytes).into_owned();
        }
        Ok(())
    }

    fn progress(&mut self, _fraction: f64, _phase: &str) {}

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        false
    }

    fn checkpoint(&mut self, _bytes: &[u8]) -> io::Result<()> {
        Ok(())
    }
}

impl Clock {
    fn new() -> Self {
        Self {
            start: Instant::now(),
            times: Vec::new(),
            bodies: String::new(),
        }
    }

    /// Of this thread [s]; wall time where the system does not tell.
    fn processor_time(&self) -> f64 {
        let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        let nanoseconds = text
            .split_whitespace()
            .next()
            .and_then(|text| text.parse::<f64>().ok());
        nanoseconds.map_or(self.start.elapsed().as_secs_f64(), |ns| ns * 1e-9)
    }
}

fn setting(name: &str, default: f64) -> f64 {
    let text = std::env::var(name).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// A bed of spheres `[x, y, z, r]` between five planes.
fn bed(spheres: &[[f64; 4]], width: f64, depth: f64, friction: f64) -> Value {
    let bodies: Vec<Value> = spheres
        .iter()
        .map(|[x, y, z, r]| json!({"sphere": {"radius_m": r}, "material": "stone", "position_m": [x, y, z]}))
        .collect();
    let plane = |name: &str, axis: &str, position: f64, facing: i32| json!({"name": name, "axis": axis, "position_m": position, "facing": facing, "material": "stone"});
    json!({
        "version": 1, "gravity_m_per_s2": [0, 0, -9.81],
        "materials": {"stone": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8, "stiffness_ratio": 0.3, "friction_angle_rad": friction}},
        "bodies": bodies,
        "planes": [plane("base", "z", 0.0, 1), plane("left", "x", 0.0, 1), plane("right", "x", width, -1),
                   plane("front", "y", 0.0, 1), plane("back", "y", depth, -1)],
        "laws": {"local_damping": 0.3},
        "time_step_s": STEP_S,
    })
}

fn job(spec: &Value) -> JobSpec {
    let body = json!({"kind": "granular_scene", "spec": spec}).to_string();
    match Submission::from_slice(body.as_bytes()) {
        Ok(submission) => submission.spec,
        Err(error) => panic!("{}", error.into_problem()),
    }
}

fn run(spec: &Value, threads: usize) -> (Clock, loadframe_api::Report) {
    let context = RunContext {
        threads,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    let mut clock = Clock::new();
    match simulate(&job(spec), context, &mut clock) {
        Ok(Ending::Finished(report)) => (clock, report),
        Ok(ending) => panic!("{ending:?}"),
        Err(error) => panic!("{error}"),
    }
}

/// Drops a raster of 2000 spheres and lets them come to rest.
fn settled() -> (Vec<[f64; 4]>, f64) {
    let (across, layers, spacing) = (10, 20, 0.046);
    let width = 0.45;
    let mut spheres = Vec::new();
    for number in 0..across * across * layers {
        let hash = (number * 2_654_435_761_usize) % 1000;
        let radius = 0.016_25 * (0.6 + 0.8 * hash as f64 / 1000.0);
        let place = [
            number % across,
            number / across % across,
            number / across / across,
        ];
        let shift = 0.002 * ((hash * 7) % 10) as f64 / 10.0;
        let [x, y, z] = place.map(|place| 0.0225 + spacing * 0.97 * place as f64);
        spheres.push([x + shift, y + 0.002 - shift, z + 0.002, radius]);
    }
    let mut spec = bed(&spheres, width, width, 0.5);
    let steps = setting("SETTLE", 30_000.0) as u64;
    spec["stages"] = json!([{"run": {"steps": steps}}]);
    let all: Vec<usize> = (0..spheres.len()).collect();
    spec["record"] = json!({"every_steps": steps, "bodies": all});
    let (clock, _) = run(&spec, 1);
    for row in clock.bodies.lines().skip(1) {
        let row: Vec<f64> = row
            .split(',')
            .filter_map(|cell| cell.parse().ok())
            .collect();
        if row[0] > 0.0 {
            spheres[row[2] as usize][..3].copy_from_slice(&row[3..6]);
        }
    }
    (spheres, width)
}

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
    let steps = setting("STEPS", 9000.0) as u64 / PIECES * PIECES;
    let threads = setting("THREADS", 1.0) as usize;
    for friction in [0.5, 0.0] {
        let mut spec = bed(&spheres, width, depth, friction);
        let piece = steps / PIECES;
        spec["stages"] = json!([{"run": {"steps": WARM.div_ceil(piece) * piece + steps}}]);
        spec["record"] = json!({"every_steps": piece, "bodies": []});
        let (clock, report) = run(&spec, threads);
        let times = &clock.times[clock.times.len() - PIECES as usize - 1..];
        // particle steps per second of each piece, sorted
        let rates = |column: usize| {
            let pieces = times.windows(2);
            let mut rates: Vec<f64> = pieces
                .map(|pair| {
                    (pair[1][0] - pair[0][0]) * spheres.len() as f64
                        / (pair[1][column] - pair[0][column])
                })
                .collect();
            rates.sort_by(f64::total_cmp);
            rates
        };
        let (by_processor, by_wall) = (rates(1), rates(2));
        let work = |name: &str| report.work[name] as f64;
        println!(
            "{}",
            json!({
                "engine": "loadframe", "particles": spheres.len(), "friction": friction, "threads": threads,
                "particle_steps_per_cpu_s": by_processor[by_processor.len() / 2].round(),
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
