//! People: they submit, look, change their minds, and send again what was not answered.
use loadframe_server::store::UserAction;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use uuid::Uuid;

use crate::server::{Answer, Request};

/// Jobs that each submits.
const JOBS: usize = 5;

pub(crate) struct Person {
    name: String,
    submitted: usize,
    /// Those that were accepted, as far as the person knows.
    pub(crate) accepted: Vec<(String, Uuid)>,
    /// The one to be resumed next, once the world is whole.
    turn: usize,
}

impl Person {
    pub(crate) fn new(number: usize) -> Self {
        Self {
            name: format!("person {number}"),
            submitted: 0,
            accepted: Vec::new(),
            turn: 0,
        }
    }

    pub(crate) fn has_submitted_all(&self) -> bool {
        self.accepted.len() == JOBS
    }

    /// What it sends next, if anything.
    pub(crate) fn next(&mut self, rng: &mut ChaCha8Rng, is_whole: bool) -> Option<Request> {
        if self.submitted < JOBS && (is_whole || self.submitted == 0 || rng.random_bool(0.5)) {
            let number = self.submitted;
            self.submitted += 1;
            return Some(Request::Submit {
                name: format!("{}, job {number}", self.name),
                seed: rng.random_range(0..1000),
            });
        }
        if self.accepted.is_empty() {
            return None;
        }
        let (at, action) = if is_whole {
            // nothing stays paused
            self.turn += 1;
            (self.turn % self.accepted.len(), UserAction::Resume)
        } else {
            let action = match rng.random_range(0..10) {
                0 => UserAction::Cancel,
                1..4 => UserAction::Pause,
                4..7 => UserAction::Resume,
                _ => UserAction::Retry,
            };
            (rng.random_range(0..self.accepted.len()), action)
        };
        Some(Request::Ask {
            job: self.accepted[at].1,
            action,
        })
    }

    pub(crate) fn hear(&mut self, request: &Request, answer: Answer) {
        match (request, answer) {
            (Request::Submit { name, .. }, Answer::Job(job)) => {
                self.accepted.push((name.clone(), job.id));
            }
            (Request::Ask { .. }, Answer::Job(_) | Answer::Conflict) => {}
            _ => panic!("an answer to something else"),
        }
    }
}
