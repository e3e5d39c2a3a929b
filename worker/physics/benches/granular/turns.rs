//! What two threads gain, whatever else the machine does.
//!
//! A processor that others share is slower in one second than in the next, by more than what is
//! to be told. So the same bed runs three times at once, a piece of [`PIECE`] steps each by turns: on
//! one thread, on two, and as two jobs of one thread side by side, which wait for nothing and tell what
//! two cores give at that moment.
use std::{
    sync::{Condvar, Mutex, PoisonError},
    thread,
};

use serde_json::json;
use statrs::statistics::{Data, OrderStatistics};

use super::{
    WARM,
    beds::{bed, run_pausing},
};

/// Steps of a piece: a tenth of a second or so for 20 000 spheres.
const PIECE: u64 = 250;
/// Who runs at the same time, turn by turn: jobs, with the threads of each.
const TURNS: [&[usize]; 3] = [&[1], &[2], &[1, 1]];

/// Which turn it is, counted from the start, and how many jobs have ended theirs.
#[derive(Default)]
struct Rota {
    now: Mutex<(usize, usize)>,
    changed: Condvar,
}

impl Rota {
    fn begin(&self, turn: usize) {
        let now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        let now = self.changed.wait_while(now, |now| now.0 != turn);
        drop(now.unwrap_or_else(PoisonError::into_inner));
    }

    fn end(&self, turn: usize) {
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        now.1 += 1;
        if now.1 == TURNS[turn % TURNS.len()].len() {
            *now = (turn + 1, 0);
            self.changed.notify_all();
        }
    }
}

/// Prints quartiles of the rates by wall time and of their ratios to the piece of one thread beside.
pub(crate) fn compare(spheres: &[[f64; 4]], [width, depth]: [f64; 2], rounds: usize) {
    let warm = WARM.div_ceil(PIECE) as usize;
    let mut spec = bed(spheres, width, depth, 0.5);
    spec["stages"] = json!([{"run": {"steps": PIECE * (warm + rounds) as u64}}]);
    spec["record"] = json!({"every_steps": PIECE, "bodies": []});
    let rota = Rota::default();
    // particle steps per second, piece by piece
    let job = |own: usize, threads: usize| {
        let mut next = own;
        let (clock, _) = run_pausing(&spec, threads, || {
            if next > own {
                rota.end(next - TURNS.len());
            }
            rota.begin(next);
            next += TURNS.len();
        });
        rota.end(own + (warm + rounds) * TURNS.len());
        clock.pieces(2, spheres.len()).split_off(warm)
    };
    let mut rates = vec![vec![0.0; rounds]; TURNS.len()];
    let job = &job;
    thread::scope(|scope| {
        let jobs = (0..).zip(TURNS);
        let jobs = jobs.flat_map(|(own, jobs)| jobs.iter().map(move |threads| (own, *threads)));
        let running = jobs.map(|(own, threads)| (own, scope.spawn(move || job(own, threads))));
        // all begin before the first is waited for
        for (own, job) in running.collect::<Vec<_>>() {
            let of_job = job.join().expect("the job runs");
            for (sum, rate) in rates[own].iter_mut().zip(of_job) {
                *sum += rate;
            }
        }
    });
    let gain = |turn: usize| {
        let pieces = rates[turn].iter().zip(&rates[0]);
        quartiles(pieces.map(|(rate, alone)| rate / alone).collect())
    };
    let [one_thread, two_threads, two_jobs] = [0, 1, 2].map(|turn| quartiles(rates[turn].clone()));
    println!(
        "{}",
        json!({
            "particles": spheres.len(), "pieces": rounds,
            "particle_steps_per_s": {"one_thread": one_thread, "two_threads": two_threads, "two_jobs": two_jobs},
            "times_one_thread": {"two_threads": gain(1), "two_jobs": gain(2)},
        })
    );
}

fn quartiles(numbers: Vec<f64>) -> [f64; 3] {
    let mut numbers = Data::new(numbers);
    [0.25, 0.5, 0.75].map(|part| numbers.quantile(part))
}
