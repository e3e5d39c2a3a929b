//! Beds of spheres for benchmarks, and a clock that runs along.
#![allow(clippy::disallowed_methods, reason = "it measures")]

use std::{fs, io, time::Instant};

use loadframe_api::{JobSpec, Report, Submission};
use loadframe_physics::{Ending, Recorder, RunContext, Uninterrupted, simulate};
use serde_json::{Value, json};

/// Time step of the beds [s].
const STEP_S: f64 = 2e-5;
/// Pieces that the timed steps are cut into; the median is what is told.
pub(crate) const PIECES: u64 = 9;

/// Notes the time at every point of the curve and keeps the tables.
pub(crate) struct Clock<'a> {
    start: Instant,
    /// Step, processor time and wall time without what is done between pieces.
    pub(crate) times: Vec<[f64; 3]>,
    bodies: String,
    between: Box<dyn FnMut() + 'a>,
}

impl Recorder for Clock<'_> {
    fn columns(&mut self, _names: &[&str]) -> io::Result<()> {
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        let wall = self.start.elapsed().as_secs_f64();
        self.times.push([values[0], self.processor_time(), wall]);
        let pause = Instant::now();
        (self.between)();
        self.start += pause.elapsed();
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

impl<'a> Clock<'a> {
    fn new(between: impl FnMut() + 'a) -> Self {
        Self {
            start: Instant::now(),
            times: Vec::new(),
            bodies: String::new(),
            between: Box::new(between),
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

pub(crate) fn setting(name: &str, default: f64) -> f64 {
    let text = std::env::var(name).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// A bed of spheres `[x, y, z, r]` between five planes.
pub(crate) fn bed(spheres: &[[f64; 4]], width: f64, depth: f64, friction: f64) -> Value {
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

pub(crate) fn run(spec: &Value, threads: usize) -> (Clock<'static>, Report) {
    run_pausing(spec, threads, || ())
}

/// A run that does something else between pieces.
pub(crate) fn run_pausing<'a>(
    spec: &Value,
    threads: usize,
    between: impl FnMut() + 'a,
) -> (Clock<'a>, Report) {
    let context = RunContext {
        threads,
        interrupt: &Uninterrupted,
        checkpoint: None,
    };
    let mut clock = Clock::new(between);
    match simulate(&job(spec), context, &mut clock) {
        Ok(Ending::Finished(report)) => (clock, report),
        Ok(ending) => panic!("{ending:?}"),
        Err(error) => panic!("{error}"),
    }
}

/// Drops a raster of 2000 spheres and lets them come to rest.
pub(crate) fn settled() -> (Vec<[f64; 4]>, f64) {
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

impl Clock<'_> {
    /// Particle steps per second of every piece, by processor or by wall time.
    pub(crate) fn pieces(&self, column: usize, particles: usize) -> Vec<f64> {
        let pieces = self.times.windows(2);
        let rate = |pair: &[[f64; 3]]| {
            (pair[1][0] - pair[0][0]) * particles as f64 / (pair[1][column] - pair[0][column])
        };
        pieces.map(rate).collect()
    }

    /// Those of the last pieces, sorted.
    pub(crate) fn rates(&self, column: usize, particles: usize) -> Vec<f64> {
        let mut pieces = self.pieces(column, particles);
        let mut rates = pieces.split_off(pieces.len() - PIECES as usize);
        rates.sort_by(f64::total_cmp);
        rates
    }
}
