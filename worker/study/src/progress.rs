//! How far a study is.
use std::time::Instant;

use loadframe_run::{Progress, TimeToGo};

/// The tests to be done, each with its expected share of the work and how far it is.
#[derive(Debug)]
pub(super) struct StudyProgress {
    tests: usize,
    weights: Vec<f64>,
    fractions: Vec<f64>,
    finished: usize,
    begun: Instant,
    to_go: TimeToGo,
}

impl StudyProgress {
    /// Of so many tests in all those of these weights are to be done.
    pub(super) fn new(tests: usize, weights: Vec<f64>) -> Self {
        Self {
            tests,
            fractions: vec![0.0; weights.len()],
            finished: tests - weights.len(),
            weights,
            begun: Instant::now(),
            to_go: TimeToGo::default(),
        }
    }

    pub(super) fn advance(&mut self, task: usize, fraction: f64) {
        self.fractions[task] = fraction;
    }

    pub(super) fn finish(&mut self, task: usize) {
        self.advance(task, 1.0);
        self.finished += 1;
    }

    /// How far all tests together are.
    pub(super) fn now(&mut self) -> Progress {
        let all: f64 = self.weights.iter().sum();
        let done = self.weights.iter().zip(&self.fractions);
        let done: f64 = done.map(|(weight, fraction)| weight * fraction).sum();
        let fraction = if all > 0.0 { done / all } else { 1.0 };
        Progress {
            fraction,
            phase: format!("{} of {} tests finished", self.finished, self.tests),
            eta_s: self.to_go.update(self.begun.elapsed(), fraction),
        }
    }
}
