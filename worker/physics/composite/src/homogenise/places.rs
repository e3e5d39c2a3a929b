//! Random places of fibres: hard discs in thermal equilibrium on a periodic square.
//!
//! Discs thrown at random are pushed apart until none overlaps, and then shaken by Metropolis moves
//! until they have forgotten how they came there. What is left is one well-known ensemble at every
//! fraction, with the contact value and pressure of hard discs; sequential addition jams near 0.547
//! and, like pushing alone, leaves neighbours that depend on the algorithm.
//!
//! Source of the moves: [Metropolis1953], who made them for these discs.
use std::f64::consts::PI;

use loadframe_harness::InterruptSource;
use loadframe_harness::rng::{Purpose, Streams};
use rand::{Rng, RngExt as _};

use super::{RoundFibre, periodic, within};
use crate::error::{CompositeError, positive};

/// What random fibres are like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Randomness {
    /// Share of the cell that is fibre, above 0 and at most 0.7: the fluid of hard discs freezes
    /// there.
    pub fraction: f64,
    /// Number of fibres in the cell, at most 1000.
    pub count: usize,
    /// Of all fibres [mm].
    pub diameter_mm: f64,
    /// Least distance between the faces of neighbours [mm], 0 or more.
    pub gap_mm: f64,
    pub seed: u64,
}

/// Fibres in a cell, as a share of it, beyond which discs are no fluid.
const MOST_FRACTION: f64 = 0.7;

/// The same for the discs that fibres are with half of the gap around them: pushing apart finds no
/// way near the close random packing of 0.84.
const MOST_WITH_GAP: f64 = 0.8;

/// Shaking and pushing take a time that grows with the square.
const MOST_FIBRES: usize = 1_000;

/// Rounds of pushing; a few hundred do at [`MOST_WITH_GAP`].
const MOST_ROUNDS: u64 = 20_000;

/// Discs are pushed so much farther than they must be that the last overlaps vanish in finite time.
const BEYOND: f64 = 1e-3;

/// Moves of each disc. At 0.7 a disc then wanders several times the free distance to its neighbours.
const SWEEPS: usize = 500;

/// Share of a plane covered by the densest packing of discs, π/(2√3).
const DENSEST: f64 = 0.906_899_682_117_108_9;

/// Places for fibres in a square cell, and the cell's sides [mm]. The fraction is exact: the sides
/// follow from it.
///
/// # Errors
/// When a value is outside its range, or so few fibres do not fit the square at that fraction;
/// [`CompositeError::GivenUp`] at a cancel.
pub fn fibre_places(
    random: &Randomness,
    interrupt: &dyn InterruptSource,
) -> Result<(Vec<RoundFibre>, [f64; 2]), CompositeError> {
    let diameter = positive("a fibre's diameter [mm]", random.diameter_mm)?;
    let fraction = within(
        random.fraction,
        MOST_FRACTION,
        "above 0 and at most 0.7 for random places",
    )?;
    if !(1..=MOST_FIBRES).contains(&random.count) {
        return Err(CompositeError::OutOfRange {
            quantity: "the number of fibres",
            given: random.count as f64,
            allowed: "from 1 to 1000",
        });
    }
    if !(random.gap_mm >= 0.0 && random.gap_mm.is_finite()) {
        return Err(CompositeError::OutOfRange {
            quantity: "the gap between fibres [mm]",
            given: random.gap_mm,
            allowed: "a finite number, 0 or more",
        });
    }
    let apart = diameter + random.gap_mm;
    let filled = fraction * (apart / diameter).powi(2);
    if filled > MOST_WITH_GAP {
        return Err(CompositeError::OutOfRange {
            quantity: "the fraction of fibres with half of the gap around each",
            given: filled,
            allowed: "at most 0.8: lower the fraction or the gap",
        });
    }
    let side = diameter * (random.count as f64 * PI / (4.0 * fraction)).sqrt();
    let mut generator = Streams::new(random.seed, Purpose::FibrePlaces).of(0);
    let mut discs = Discs {
        apart,
        size: [side; 2],
        places: (0..random.count)
            .map(|_| [0, 1].map(|_| side * generator.random::<f64>()))
            .collect(),
    };
    if !discs.push_apart(interrupt)? {
        return Err(CompositeError::NoRoom {
            count: random.count,
            fraction: filled,
            rounds: MOST_ROUNDS,
        });
    }
    let reach = apart * ((DENSEST / filled).sqrt() - 1.0).min(0.5);
    discs.shake(reach, &mut generator, interrupt)?;
    let fibres = discs
        .places
        .into_iter()
        .map(|centre_mm| RoundFibre {
            centre_mm,
            diameter_mm: diameter,
        })
        .collect();
    Ok((fibres, [side; 2]))
}

fn wanted_still(interrupt: &dyn InterruptSource) -> Result<(), CompositeError> {
    match interrupt.is_cancelled() {
        true => Err(CompositeError::GivenUp),
        false => Ok(()),
    }
}

/// Discs of one size on a periodic square.
struct Discs {
    /// Least distance of two centres.
    apart: f64,
    size: [f64; 2],
    places: Vec<[f64; 2]>,
}

impl Discs {
    /// Moves every pair that overlaps apart by half of the overlap each, round by round; whether
    /// none overlaps in the end.
    fn push_apart(&mut self, interrupt: &dyn InterruptSource) -> Result<bool, CompositeError> {
        if self.apart > self.size[0] {
            return Ok(false);
        }
        let wanted = self.apart * (1.0 + BEYOND);
        for _ in 0..MOST_ROUNDS {
            wanted_still(interrupt)?;
            let mut overlaps = false;
            for first in 0..self.places.len() {
                for second in first + 1..self.places.len() {
                    let [d2, d3] = [0, 1].map(|axis| {
                        let d = self.places[second][axis] - self.places[first][axis];
                        d - self.size[axis] * (d / self.size[axis]).round()
                    });
                    let distance = (d2 * d2 + d3 * d3).sqrt();
                    if distance >= self.apart {
                        continue;
                    }
                    overlaps = true;
                    let way = if distance > 0.0 {
                        [d2 / distance, d3 / distance]
                    } else {
                        [1.0, 0.0]
                    };
                    let half = 0.5 * (wanted - distance);
                    let (from, to) = (self.places[first], self.places[second]);
                    let moved = |place: [f64; 2], by: f64| {
                        [0, 1].map(|axis| self.wrapped(place[axis] + by * way[axis], axis))
                    };
                    let places = (moved(from, -half), moved(to, half));
                    (self.places[first], self.places[second]) = places;
                }
            }
            if !overlaps {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Metropolis moves of hard discs: each disc in turn, up to `reach` along both axes, taken where
    /// it overlaps none.
    fn shake(
        &mut self,
        reach: f64,
        generator: &mut impl Rng,
        interrupt: &dyn InterruptSource,
    ) -> Result<(), CompositeError> {
        for _ in 0..SWEEPS {
            wanted_still(interrupt)?;
            for disc in 0..self.places.len() {
                let here = self.places[disc];
                let there = [0, 1].map(|axis| {
                    let step = reach * (2.0 * generator.random::<f64>() - 1.0);
                    self.wrapped(here[axis] + step, axis)
                });
                let is_free = self.places.iter().enumerate().all(|(other, place)| {
                    other == disc || periodic(there, *place, self.size) >= self.apart
                });
                if is_free {
                    self.places[disc] = there;
                }
            }
        }
        Ok(())
    }

    fn wrapped(&self, place: f64, axis: usize) -> f64 {
        let inside = place.rem_euclid(self.size[axis]);
        // round-off can make it the side itself
        if inside < self.size[axis] {
            inside
        } else {
            0.0
        }
    }
}
