use std::convert::Infallible;

use super::*;
use crate::Team;

/// A chain of springs of stiffness 1 between walls, whose points move in two directions, each direction
/// `stiff` times as stiffly; preconditioned by what each point is held with.
struct Chain {
    stiff: [f64; 2],
}

impl Preconditioned<2> for Chain {
    fn apply(&mut self, motion: &[[f64; 2]], forces: &mut [[f64; 2]]) -> f64 {
        let mut product = 0.0;
        for point in 0..motion.len() {
            for (axis, stiff) in self.stiff.into_iter().enumerate() {
                let before = point
                    .checked_sub(1)
                    .map_or(0.0, |before| motion[before][axis]);
                let after = motion.get(point + 1).map_or(0.0, |after| after[axis]);
                forces[point][axis] = stiff * (2.0 * motion[point][axis] - before - after);
                product += forces[point][axis] * motion[point][axis];
            }
        }
        product
    }

    fn precondition(&mut self, residual: &[[f64; 2]], corrected: &mut [[f64; 2]]) -> f64 {
        let mut product = 0.0;
        for (residual, corrected) in residual.iter().zip(corrected) {
            for axis in 0..2 {
                corrected[axis] = residual[axis] / (2.0 * self.stiff[axis].abs());
                product += residual[axis] * corrected[axis];
            }
        }
        product
    }
}

const POINTS: usize = 40;

/// What a force of 1 on every point, in both directions, moves it by: i (n + 1 - i)/2 over the stiffness.
fn exact(stiff: [f64; 2]) -> Vec<[f64; 2]> {
    (1..=POINTS)
        .map(|point| stiff.map(|stiff| (point * (POINTS + 1 - point)) as f64 / (2.0 * stiff)))
        .collect()
}

fn solved(team: &Team, stiff: [f64; 2], enough: Enough, most: usize) -> (Vec<[f64; 2]>, Found) {
    let mut vectors = Gradients::new(POINTS);
    vectors.residual.fill([1.0; 2]);
    let mut motion = vec![[0.0; 2]; POINTS];
    let found = vectors.solve(&mut Chain { stiff }, team, &mut motion, enough, most);
    (motion, found)
}

/// √(eᵀKe) of what a motion is off.
fn energy_error(stiff: [f64; 2], motion: &[[f64; 2]]) -> f64 {
    let exact = exact(stiff);
    let pairs = motion.iter().zip(&exact);
    let off: Vec<[f64; 2]> = pairs
        .map(|(found, exact)| [found[0] - exact[0], found[1] - exact[1]])
        .collect();
    Chain { stiff }
        .apply(&off, &mut vec![[0.0; 2]; POINTS])
        .sqrt()
}

#[test]
fn a_chain_under_its_weight_sags_as_a_parabola_by_every_measure_of_enough() {
    let stiff = [1.0, 1000.0];
    let team = Team::alone();
    // a chain of 40 points has 20 symmetric waves, in each direction
    for enough in [
        Enough::Residual(1e-12),
        Enough::Product {
            share: 1e-24,
            least: 0.0,
        },
        Enough::EnergyError(1e-9),
    ] {
        let (motion, found) = solved(&team, stiff, enough, 100);
        assert_eq!(found.ended, Ended::Near, "{enough:?}");
        assert!(found.iterations <= 60, "{enough:?} {}", found.iterations);
        let off = energy_error(stiff, &motion);
        assert!(off < 1e-8, "{enough:?} {off:e}");
    }
}

#[test]
fn the_error_told_was_that_of_some_iterations_ago() {
    let stiff = [1.0, 2.0];
    let (motion, found) = solved(&Team::alone(), stiff, Enough::EnergyError(1.0), 100);
    assert!(
        found.ended == Ended::Near && found.error <= 1.0,
        "{found:?}"
    );
    // what six iterations took away is known; what is left now is less
    assert!(energy_error(stiff, &motion) <= found.error, "{found:?}");
    let spent = solved(&Team::alone(), stiff, Enough::EnergyError(1e-9), 5).1;
    assert!(spent.iterations == 5 && spent.error.is_infinite());
    assert!(matches!(spent.ended, Ended::Spent(left) if left > 0.0));
}

#[test]
fn nothing_to_do_is_done_at_once() {
    let mut vectors = Gradients::new(POINTS);
    let mut motion = vec![[3.0; 2]; POINTS];
    let mut chain = Chain { stiff: [1.0; 2] };
    for enough in [Enough::Residual(1e-9), Enough::EnergyError(0.0)] {
        let found = vectors.solve(&mut chain, &Team::alone(), &mut motion, enough, 9);
        assert_eq!((found.iterations, found.ended), (0, Ended::Near));
        assert_eq!(found.error.to_bits(), 0.0_f64.to_bits());
    }
    assert!(
        motion
            .iter()
            .flatten()
            .all(|part| part.to_bits() == 3.0_f64.to_bits())
    );
}

#[test]
fn what_is_not_positive_is_said() {
    let (_, found) = solved(&Team::alone(), [1.0, -1.0], Enough::Residual(1e-9), 100);
    assert!(matches!(found.ended, Ended::CurvesDown(_)), "{found:?}");
    assert!(found.error.is_infinite());
}

#[test]
fn iterations_go_on_where_they_were_left() {
    let enough = Enough::Product {
        share: 1e-24,
        least: 0.0,
    };
    let mut iterated = Plain::new();
    let whole = Plain::new().run(usize::MAX);
    let mut product = iterated.start;
    let mut parts = 0;
    while let Ok((_, Ended::Spent(left))) = iterate(&mut iterated, product, 3) {
        product = left;
        parts += 1;
    }
    assert!(parts > 3 && whole.len() == POINTS);
    let (motion, _) = solved(&Team::alone(), [1.0; 2], enough, 100);
    for ((whole, part), motion) in whole.iter().zip(&iterated.motion).zip(motion) {
        assert_eq!(whole.to_bits(), part.to_bits());
        assert!((whole - motion[0]).abs() < 1e-9);
    }
}

/// The chain in one direction, without a preconditioner, by vectors of its own.
struct Plain {
    start: f64,
    motion: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    forces: Vec<f64>,
}

impl Plain {
    fn new() -> Self {
        Self {
            start: POINTS as f64,
            motion: vec![0.0; POINTS],
            residual: vec![1.0; POINTS],
            direction: vec![1.0; POINTS],
            forces: vec![0.0; POINTS],
        }
    }

    fn run(mut self, most: usize) -> Vec<f64> {
        let start = self.start;
        let Ok((_, ended)) = iterate(&mut self, start, most);
        assert_eq!(ended, Ended::Near);
        self.motion
    }
}

impl Iterated for Plain {
    type Interrupt = Infallible;

    fn apply(&mut self) -> Result<f64, Infallible> {
        let d = &self.direction;
        for point in 0..POINTS {
            let before = point.checked_sub(1).map_or(0.0, |before| d[before]);
            self.forces[point] = 2.0 * d[point] - before - d.get(point + 1).unwrap_or(&0.0);
        }
        Ok(d.iter().zip(&self.forces).map(|(d, f)| d * f).sum())
    }

    fn advance(&mut self, length: f64) -> Option<f64> {
        for point in 0..POINTS {
            self.motion[point] += length * self.direction[point];
            self.residual[point] -= length * self.forces[point];
        }
        let left = self.residual.iter().map(|part| part * part).sum();
        (left > 1e-24).then_some(left)
    }

    fn turn(&mut self, keep: f64) {
        for (direction, residual) in self.direction.iter_mut().zip(&self.residual) {
            *direction = residual + keep * *direction;
        }
    }
}

/// The way down a slope that ends at 0, by steps of this part of what is left; at 1 there is no way on.
struct Slide {
    at: f64,
    part: f64,
}

impl Newton for Slide {
    type Failure = &'static str;

    fn is_at_rest(&mut self, _: u32) -> Result<bool, Self::Failure> {
        if self.at.is_nan() {
            return Err("nowhere");
        }
        Ok(self.at < 1e-3)
    }

    fn advance(&mut self) -> Result<bool, Self::Failure> {
        self.at -= self.part * self.at;
        Ok(self.part > 0.0)
    }
}

#[test]
fn steps_end_at_rest_where_they_lead_nowhere_or_are_spent() {
    let slide = |at, part, most| settle(&mut Slide { at, part }, most);
    // 2⁻¹⁰ is the first power below a thousandth
    assert_eq!(slide(1.0, 0.5, 10), Ok(Settled::AtRest(10)));
    assert_eq!(slide(1.0, 0.5, 9), Ok(Settled::Slow));
    assert_eq!(slide(1.0, 0.0, 9), Ok(Settled::Stuck(0)));
    assert_eq!(slide(0.0, 0.5, 0), Ok(Settled::AtRest(0)));
    assert_eq!(slide(f64::NAN, 0.5, 9), Err("nowhere"));
}

#[test]
fn lengths_are_halved_until_one_is_taken() {
    let mut tried = Vec::new();
    let taken = halved(1.0, 4, |length, halvings| {
        tried.push((length, halvings));
        Ok::<_, Infallible>(length <= 0.25)
    });
    assert_eq!(taken, Ok(true));
    assert_eq!(tried, [(1.0, 0), (0.5, 1), (0.25, 2)]);
    assert_eq!(
        halved(1.0, 4, |length, _| Ok::<_, ()>(length < 0.05)),
        Ok(false)
    );
    assert_eq!(halved(1.0, 4, |_, _| Err("stop")), Err("stop"));
}

#[test]
fn rest_is_a_share_of_the_largest_force_or_round_off() {
    let left = |largest, scale, round_off| Unbalanced {
        largest,
        scale,
        round_off,
    };
    assert!(left(1e-6, 10.0, 0.0).is_within(1e-7) && !left(1e-6, 1.0, 0.0).is_within(1e-7));
    assert!(left(1e-6, 0.1, 1e-6).is_within(1e-7));
    // nothing acts: only nothing balances it
    assert!(left(0.0, 0.0, 0.0).is_within(0.0) && !left(1e-9, 0.0, 0.0).is_within(1.0));
    assert!(!left(f64::NAN, 1.0, 1.0).is_within(1.0));
}
