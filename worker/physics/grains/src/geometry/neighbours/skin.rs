//! How wide the skin is, and when it is used up.
//!
//! A list holds as long as no two bodies have come closer than the skin s, so as long as nothing
//! has moved by s/2. The sum of the largest speeds times Δt is an upper bound of the way, and
//! costs nothing; only when it is used up is the true way measured.
use serde::{Deserialize, Serialize};

use crate::numbers::rows::Row;

/// Steps that a list should last: a search costs some twenty steps.
const LASTING: f64 = 400.0;
/// Bounds of the skin over the mean radius: round-off of a bed at rest, and a fast flow.
const NARROWEST: f64 = 0.004;
const WIDEST: f64 = 0.5;
/// Skin of the first list over the mean radius.
const FIRST: f64 = 0.1;
/// A list is renewed early when its skin is this many times too wide.
const TOO_WIDE: f64 = 2.0;
/// The true way is measured again only when at least this part of s/2 is left; a list that is
/// nearly used up is renewed.
const WORTH_KEEPING: f64 = 0.1;

/// The skin of the present list.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Skin {
    /// s [m].
    pub(crate) width: f64,
    mean_radius: f64,
    /// Way that is surely left [m].
    left: f64,
    /// Steps done with this list.
    steps: u64,
    /// Centres when the list was made [m].
    reference: Vec<[f64; 3]>,
    /// Way of the fastest plane since then [m].
    plane_way: f64,
}

impl Skin {
    pub(crate) fn new(centres: &[Row]) -> Self {
        let radii = centres.iter().map(|centre| centre.0[3]).sum::<f64>();
        let mean_radius = radii / centres.len().max(1) as f64;
        Self {
            width: FIRST * mean_radius,
            mean_radius,
            ..Self::default()
        }
    }

    /// A new list is made at these centres.
    pub(crate) fn renew(&mut self, centres: &[Row]) {
        if self.steps > 0 {
            let wanted = self.wanted(self.way(centres));
            // not by leaps: the last list may have been a moment's accident
            let wanted = wanted.clamp(0.25 * self.width, 4.0 * self.width);
            self.width = wanted.clamp(NARROWEST * self.mean_radius, WIDEST * self.mean_radius);
        }
    }

    /// The list made at these centres is in use now.
    pub(crate) fn start(&mut self, centres: &[Row]) {
        self.reference.clear();
        let places = centres
            .iter()
            .map(|centre| [centre.0[0], centre.0[1], centre.0[2]]);
        self.reference.extend(places);
        self.left = 0.5 * self.width;
        self.steps = 0;
        self.plane_way = 0.0;
    }

    /// Whether the list holds after a step in which no body moved farther than `way` and no plane
    /// farther than `plane_way` [m]; the next step is taken to be no larger.
    pub(crate) fn holds_after(&mut self, way: f64, plane_way: f64, centres: &[Row]) -> bool {
        self.steps += 1;
        self.plane_way += plane_way;
        self.left -= way.max(plane_way);
        let is_time_to_look = self.steps >= 64 && self.steps.is_power_of_two();
        if self.left > way && !is_time_to_look {
            return true;
        }
        let way_so_far = self.way(centres);
        self.left = 0.5 * self.width - way_so_far;
        let is_used_up = self.left <= way.max(WORTH_KEEPING * 0.5 * self.width);
        let narrowest = NARROWEST * self.mean_radius;
        let is_too_wide =
            is_time_to_look && TOO_WIDE * self.wanted(way_so_far).max(narrowest) < self.width;
        !(is_used_up || is_too_wide)
    }

    /// Skin that lasts when `way` was done with the present list.
    fn wanted(&self, way: f64) -> f64 {
        2.0 * way / self.steps as f64 * LASTING
    }

    /// Farthest that anything has moved since the list was made [m].
    fn way(&self, centres: &[Row]) -> f64 {
        let squares = centres
            .iter()
            .zip(&self.reference)
            .map(|(centre, reference)| {
                let moved: [f64; 3] = std::array::from_fn(|axis| centre.0[axis] - reference[axis]);
                moved.iter().map(|way| way * way).sum::<f64>()
            });
        squares.fold(0.0, f64::max).sqrt().max(self.plane_way)
    }
}
