use loadframe_physics::{Ending, Recorder, RunContext, Uninterrupted, simulate};
use std::{
    io::{self, Write},
    time::Instant,
};
struct Deaf;
impl Recorder for Deaf {
    fn columns(&mut self, _: &[&str]) -> io::Result<()> {
        Ok(())
    }
    fn point(&mut self, _: &[f64]) -> io::Result<()> {
        Ok(())
    }
    fn file(
        &mut self,
        _: &str,
        _: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        Ok(())
    }
    fn progress(&mut self, _: f64, _: &str) {}
    fn log(&mut self, _: &str) {}
    fn checkpoint_due(&self) -> bool {
        false
    }
    fn checkpoint(&mut self, _: &[u8]) -> io::Result<()> {
        Ok(())
    }
}
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let threads = std::env::args().nth(2).map_or(1, |t| t.parse().unwrap());
    let body = std::fs::read(path).unwrap();
    let submission = loadframe_api::Submission::from_slice(&body).unwrap();
    let t = Instant::now();
    let ending = simulate(
        &submission.spec,
        RunContext {
            threads,
            interrupt: &Uninterrupted,
            checkpoint: None,
        },
        &mut Deaf,
    )
    .unwrap();
    let s = t.elapsed().as_secs_f64();
    let Ending::Finished(report) = ending else {
        panic!()
    };
    let v = |n: &str| {
        report
            .summary
            .get(n)
            .and_then(|q| q.value)
            .unwrap_or(f64::NAN)
    };
    println!(
        "{s:.3} s  F {:.4} at {:.4} E {:.4} nu {:.5} broken {} | {:?} unconv {:?} imb {:?}",
        v("max_force"),
        v("strain_at_max_force"),
        v("modulus_at_10_percent"),
        v("poisson_ratio"),
        v("broken_bonds"),
        report.work,
        report.quality.get("unconverged_steps").map(|q| q.value),
        report.quality.get("jaw_force_imbalance").map(|q| q.value)
    );
}
