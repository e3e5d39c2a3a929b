//! Conjugate gradients over the motions of nodes: their vectors, and when they are near enough.
use std::convert::Infallible;

use super::conjugate::{Ended, Iterated, iterate};
use crate::Team;

/// Equations over N motions of each node, and what preconditions them.
pub trait Preconditioned<const N: usize> {
    /// Sets `forces` to those of a motion, 0 where nothing is free; gives the product of both.
    fn apply(&mut self, motion: &[[f64; N]], forces: &mut [[f64; N]]) -> f64;

    /// Sets `corrected` to about the motion that relieves a residual, by a symmetric positive matrix; gives
    /// the product of both.
    fn precondition(&mut self, residual: &[[f64; N]], corrected: &mut [[f64; N]]) -> f64;
}

/// When a motion is near enough, r being its residual and M the preconditioner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Enough {
    /// √(r · r) is not above this share of what it was at the start.
    Residual(f64),
    /// r · M r is at most `share` of what it was at the start, or at most `least`.
    Product { share: f64, least: f64 },
    /// √(eᵀKe) of the error e is at most this, as [`LOOK_BACK`] iterations tell.
    EnergyError(f64),
}

/// Iterations that an estimate of the error looks back: with steps αⱼ and products ρⱼ = rⱼ·M⁻¹rⱼ the
/// squared error in energy before step k is Σ αⱼ ρⱼ over all steps from k on, and most of it is in the
/// first few [HestenesStiefel1952], [StrakosTichy2002]. The error is told of the motion that many
/// iterations ago, so that what is left now is smaller.
const LOOK_BACK: usize = 6;

/// Nodes of a pass over vectors alone.
const NODES_OF_PIECE: usize = 2048;

/// The vectors of iterations, which solutions use one after the other.
#[derive(Clone, Debug)]
pub struct Gradients<const N: usize> {
    /// What the motion leaves of the forces: set by who asks for a solution, and kept after it.
    pub residual: Vec<[f64; N]>,
    corrected: Vec<[f64; N]>,
    direction: Vec<[f64; N]>,
    forces: Vec<[f64; N]>,
    /// Where the motion was once and twice as long ago as an error in energy looks back; empty where none is asked for.
    marks: [Vec<[f64; N]>; 2],
}

/// What iterations came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    pub iterations: usize,
    pub ended: Ended,
    /// r · M r at the start, and when it was looked at last.
    pub products: [f64; 2],
    /// Estimate of √(eᵀKe) of the error e that is left; infinite where iterations do not tell it.
    pub error: f64,
}

impl<const N: usize> Gradients<N> {
    /// For so many nodes.
    pub fn new(nodes: usize) -> Self {
        let none = || vec![[0.0; N]; nodes];
        Self {
            residual: none(),
            corrected: none(),
            direction: none(),
            forces: none(),
            marks: Default::default(),
        }
    }

    /// The motion from some iterations before the last solution ended, or its start: what moved since is about the
    /// error that there was then. Empty unless an error in energy was asked for.
    pub fn earlier(&self) -> &[[f64; N]] {
        &self.marks[0]
    }

    /// Moves the nodes until they are near enough, with at most so many iterations. The [`Self::residual`] is
    /// that of the motion, before and after.
    pub fn solve(
        &mut self,
        equations: &mut impl Preconditioned<N>,
        team: &Team,
        motion: &mut [[f64; N]],
        enough: Enough,
        most: usize,
    ) -> Found {
        let mut under_way = UnderWay {
            equations,
            team,
            vectors: self,
            motion,
            enough,
            product: 0.0,
            drops: [f64::INFINITY; LOOK_BACK],
            since_mark: 0,
        };
        if let Enough::EnergyError(_) = under_way.enough {
            for mark in &mut under_way.vectors.marks {
                mark.clear();
                mark.extend_from_slice(under_way.motion);
            }
        }
        let begun = under_way.begin();
        let first = under_way.product;
        let (iterations, ended) = match begun {
            None => (0, Ended::Near),
            Some(product) => {
                let Ok(found) = iterate(&mut under_way, product, most);
                found
            }
        };
        let UnderWay { product, drops, .. } = under_way;
        Found {
            iterations,
            ended,
            products: [first, product],
            error: match ended {
                // nothing is left
                Ended::Near if product == 0.0 => 0.0,
                Ended::Near => error(&drops),
                Ended::CurvesDown(_) | Ended::Spent(_) => f64::INFINITY,
            },
        }
    }
}

/// Iterations towards a motion.
struct UnderWay<'a, P, const N: usize> {
    equations: &'a mut P,
    team: &'a Team,
    vectors: &'a mut Gradients<N>,
    motion: &'a mut [[f64; N]],
    /// Once begun, a residual and a least product themselves.
    enough: Enough,
    product: f64,
    /// Falls of the squared error in energy, the last one last.
    drops: [f64; LOOK_BACK],
    /// Iterations since the motion was marked.
    since_mark: usize,
}

impl<P: Preconditioned<N>, const N: usize> UnderWay<'_, P, N> {
    /// The first direction; none when nothing is left to do.
    fn begin(&mut self) -> Option<f64> {
        if let Enough::Residual(share) = &mut self.enough {
            *share *= norm(&self.vectors.residual);
        }
        if self.has_small_residual() {
            return None;
        }
        let Gradients {
            residual,
            direction,
            ..
        } = &mut *self.vectors;
        self.product = self.equations.precondition(residual, direction);
        if let Enough::Product { share, least } = &mut self.enough {
            *least = least.max(*share * self.product);
        }
        (!self.has_small_product()).then_some(self.product)
    }

    fn has_small_residual(&self) -> bool {
        match self.enough {
            // what is no number is left to who looks at the motion
            Enough::Residual(most) => {
                let left = norm(&self.vectors.residual);
                left <= most || left.is_nan()
            }
            Enough::Product { .. } | Enough::EnergyError(_) => false,
        }
    }

    fn has_small_product(&self) -> bool {
        match self.enough {
            Enough::Product { least, .. } => self.product <= least,
            Enough::Residual(_) | Enough::EnergyError(_) => self.product == 0.0,
        }
    }
}

impl<P: Preconditioned<N>, const N: usize> Iterated for UnderWay<'_, P, N> {
    type Interrupt = Infallible;

    fn apply(&mut self) -> Result<f64, Infallible> {
        let Gradients {
            direction, forces, ..
        } = &mut *self.vectors;
        Ok(self.equations.apply(direction, forces))
    }

    fn advance(&mut self, length: f64) -> Option<f64> {
        let Gradients {
            residual,
            direction,
            forces,
            ..
        } = &mut *self.vectors;
        both(self.team, self.motion, direction, |motion, direction| {
            *motion += length * direction;
        });
        both(self.team, residual, forces, |residual, force| {
            *residual -= length * force;
        });
        self.drops.rotate_left(1);
        self.drops[LOOK_BACK - 1] = length * self.product;
        if let Enough::EnergyError(most) = self.enough {
            if error(&self.drops) <= most {
                return None;
            }
            self.since_mark += 1;
            if self.since_mark == LOOK_BACK {
                self.since_mark = 0;
                let [earlier, later] = &mut self.vectors.marks;
                std::mem::swap(earlier, later);
                later.copy_from_slice(self.motion);
            }
        }
        if self.has_small_residual() {
            return None;
        }
        let Gradients {
            residual,
            corrected,
            ..
        } = &mut *self.vectors;
        self.product = self.equations.precondition(residual, corrected);
        (!self.has_small_product()).then_some(self.product)
    }

    fn turn(&mut self, keep: f64) {
        let Gradients {
            corrected,
            direction,
            ..
        } = &mut *self.vectors;
        both(self.team, direction, corrected, |direction, corrected| {
            *direction = corrected + keep * *direction;
        });
    }
}

fn error(drops: &[f64]) -> f64 {
    drops.iter().sum::<f64>().sqrt()
}

fn norm<const N: usize>(vector: &[[f64; N]]) -> f64 {
    let values = vector.as_flattened();
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// Works on the motions of two vectors, in pieces where several threads share them.
fn both<const N: usize>(
    team: &Team,
    first: &mut [[f64; N]],
    second: &[[f64; N]],
    work: impl Fn(&mut f64, f64) + Sync,
) {
    let each = |first: &mut [[f64; N]], second: &[[f64; N]]| {
        let pairs = first.as_flattened_mut().iter_mut();
        for (first, second) in pairs.zip(second.as_flattened()) {
            work(first, *second);
        }
    };
    if team.is_alone() {
        return each(first, second);
    }
    let pieces = first
        .chunks_mut(NODES_OF_PIECE)
        .zip(second.chunks(NODES_OF_PIECE));
    team.map(pieces.collect(), |(first, second)| each(first, second));
}
