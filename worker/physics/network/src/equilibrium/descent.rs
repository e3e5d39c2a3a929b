//! Gradient descent as the thesis tried it: node after node, each against the gradient of the magnitude
//! of its own resultant.
//!
//! The objective of a node is F_b = |R| with R = Σ T n over its bonds, n towards the neighbour (its
//! eq. 7). A move is −α ∇F_b (its eq. 5), with α fixed or, from the second move on, that of Barzilai and
//! Borwein, α = |sᵀ y|/|y|² of the last change s of position and y of gradient (its eq. 6). The gradient
//! is one of three:
//!
//! - exact: ∇|R| = −K R/|R| with the node's stiffness K = Σ a n nᵀ + b (1 − n nᵀ) (7);
//! - as printed (its eq. 10-12): the sum of the gradients of the bonds' tensions, −Σ a n. It is that of
//!   Σ T, not of |Σ T n|: it does not vanish in equilibrium, nor turn there;
//! - smoothed (its section 2.3.3): that of a natural cubic spline through 5 x 5 x 5 values of |R|. A
//!   product of splines goes along the axes through the values on them, so at the middle, with f at
//!   distances ±h, ±2h, ∂F = (6 (f₁ − f₋₁) − (f₂ − f₋₂))/(8 h).
//!
//! **Limits.** Near its minimum |R| is a cone, whose gradient has the same length everywhere: a fixed
//! step ends in jumps from side to side that leave |R| ≈ α k². The step of its own choice therefore is
//! α = F_lim/k² with k = Σ a: short enough to end, and as many steps as the limit goes into the
//! resultant. Where a node is balanced along one axis only, K R turns little of R into motion: what is
//! long in the network stays, as in every relaxation.
//!
//! Source: [Zilka2022] sections 2.3.2 and 2.3.3, [BarzilaiBorwein1988]; fixed step and spacing are not
//! told there and are ours.
use loadframe_harness::Interrupt;

use super::{Descent, Gradient, Search, node_step::NodeStep, sequential::sweep, work::Meter};
use crate::{
    Vector,
    assembly::{Assembly, BondState},
    incidence::Incidence,
};

/// Displacements of every place, near equilibrium; see [`Search::run`].
pub(super) fn solve(
    search: &Search,
    descent: Descent,
    assembly: &Assembly,
    displacements: Vec<Vector>,
    meter: &mut Meter<'_>,
) -> Result<Vec<Vector>, Interrupt> {
    let incidence = assembly.incidence();
    let mut last: Option<Last> = None;
    sweep(
        search,
        assembly,
        displacements,
        meter,
        |displacements, node, attempt| {
            if attempt == 0 {
                last = None;
            }
            let around = Around {
                assembly,
                incidence,
                displacements,
                node,
            };
            around.step(search, descent, &mut last)
        },
    )
}

/// Where a node was before its last move, and the gradient there.
#[derive(Clone, Copy, Debug)]
struct Last {
    place: Vector,
    gradient: Vector,
}

/// A node among its neighbours.
struct Around<'a> {
    assembly: &'a Assembly,
    incidence: &'a Incidence,
    displacements: &'a [Vector],
    node: usize,
}

/// What a node's bonds come to.
#[derive(Clone, Copy, Debug)]
struct Pull {
    /// R [N].
    resultant: Vector,
    /// Σ a n [N/mm].
    rise: Vector,
    /// Σ a [N/mm].
    axial: f64,
    /// Rounding error of R [N].
    rounding: f64,
}

impl Around<'_> {
    fn step(&self, search: &Search, descent: Descent, last: &mut Option<Last>) -> NodeStep {
        let place = self.displacements[self.node];
        let pull = self.pull(place);
        let bonds = self.incidence.of(self.node).len();
        let magnitude = pull.resultant.norm();
        // a resultant that is not a number ends the search; whoever started it will find it
        if magnitude.is_nan() || magnitude <= search.force_limit.max(pull.rounding) {
            return NodeStep {
                is_balanced: true,
                step: Vector::zeros(),
                bonds,
            };
        }
        let (gradient, passes) = match descent.gradient {
            Gradient::Exact => (-self.turned(place, pull.resultant / magnitude), 2),
            Gradient::Printed => (-pull.rise, 1),
            Gradient::Smoothed { spacing } => (self.smoothed(place, spacing), 13),
        };
        let gradient = self.assembly.free_part(self.node, gradient);
        let fixed = descent
            .step
            .unwrap_or(search.force_limit / pull.axial.powi(2));
        let length = match last.as_ref().filter(|_| descent.is_adaptive) {
            Some(last) => barzilai_borwein(place - last.place, gradient - last.gradient),
            None => fixed,
        };
        *last = Some(Last { place, gradient });
        NodeStep {
            is_balanced: false,
            step: capped(-gradient, length, search.step_cap),
            bonds: passes * bonds,
        }
    }

    /// With the node displaced to `place`.
    fn pull(&self, place: Vector) -> Pull {
        let mut pull = Pull {
            resultant: Vector::zeros(),
            rise: Vector::zeros(),
            axial: 0.0,
            rounding: 0.0,
        };
        for bond in self.incidence.of(self.node) {
            let (state, towards, moved) = self.bond(*bond, place);
            pull.resultant += towards * state.tension;
            pull.rise += towards * state.axial;
            pull.axial += state.axial;
            pull.rounding += state.round_off(moved);
        }
        pull.resultant = self.assembly.free_part(self.node, pull.resultant);
        pull
    }

    /// K times a vector.
    fn turned(&self, place: Vector, vector: Vector) -> Vector {
        let bonds = self.incidence.of(self.node).iter();
        bonds
            .map(|bond| {
                let (state, towards, _) = self.bond(*bond, place);
                let along = towards * towards.dot(&vector);
                along * state.axial + (vector - along) * state.transverse
            })
            .sum()
    }

    /// The gradient of |R| after smoothing over values `spacing` apart.
    fn smoothed(&self, place: Vector, spacing: f64) -> Vector {
        let dimensions = self.assembly.dimensions();
        Vector::from_fn(|axis, _| {
            if axis >= dimensions {
                return 0.0;
            }
            let at = |steps: f64| {
                let mut beside = place;
                beside[axis] += steps * spacing;
                self.pull(beside).resultant.norm()
            };
            spline_slope([at(-2.0), at(-1.0), at(1.0), at(2.0)], spacing)
        })
    }

    /// A bond with the node at `place`: its state, its direction from the node on, and how far both ends
    /// moved together [mm].
    fn bond(&self, bond: u32, place: Vector) -> (BondState, Vector, f64) {
        let ends = self.assembly.ends[bond as usize].map(|end| end as usize);
        let [first, second] = ends.map(|end| {
            if end == self.node {
                place
            } else {
                self.displacements[end]
            }
        });
        let state = self.assembly.respond(bond as usize, &first, &second);
        let towards = if ends[0] == self.node {
            state.direction
        } else {
            -state.direction
        };
        (state, towards, first.amax() + second.amax())
    }
}

/// α of Barzilai and Borwein [mm²/N]; infinite where the gradient did not change.
fn barzilai_borwein(move_made: Vector, change: Vector) -> f64 {
    move_made.dot(&change).abs() / change.norm_squared()
}

/// `length` times the direction, no farther than `cap`.
fn capped(direction: Vector, length: f64, cap: f64) -> Vector {
    let reach = direction.norm();
    if length.is_nan() || length * reach > cap {
        // without a change of the gradient nothing says how far: as far as is allowed
        return direction * (cap / reach);
    }
    direction * length
}

/// Slope in the middle of the natural cubic spline through values at −2h, −h, h and 2h, and through any
/// in the middle, which does not count.
///
/// With slopes m at five knots, m₋₁ + 4 m₀ + m₁ = 3 (f₁ − f₋₁)/h and so on, 2 m₂ + m₁ = 3 (f₂ − f₁)/h at
/// the ends.
fn spline_slope([far_before, before, after, far_after]: [f64; 4], spacing: f64) -> f64 {
    (6.0 * (after - before) - (far_after - far_before)) / (8.0 * spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_the_spline_is_that_of_its_equations() {
        let h = 0.5;
        let [f0, f1, f2, f3, f4] = [1.0, -2.0, 0.3, 4.0, 2.5];
        // 2 m0 + m1, m0 + 4 m1 + m2, ..., m3 + 2 m4
        let matrix = nalgebra::Matrix5::new(
            2.0, 1.0, 0.0, 0.0, 0.0, 1.0, 4.0, 1.0, 0.0, 0.0, 0.0, 1.0, 4.0, 1.0, 0.0, 0.0, 0.0,
            1.0, 4.0, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0,
        );
        let right = nalgebra::Vector5::new(f1 - f0, f2 - f0, f3 - f1, f4 - f2, f4 - f3) * (3.0 / h);
        let slopes = matrix.lu().solve(&right).expect("a regular matrix");
        let slope = spline_slope([f0, f1, f3, f4], h);
        assert!((slope - slopes[2]).abs() < 1e-13, "{slope} {slopes}");
    }

    #[test]
    fn a_step_of_barzilai_and_borwein_ends_a_parabola_at_once() {
        // f = 2 x²: from 1 by 0.1, gradients 4 and 3.6, so α = 1/4 and the next move is 0.9
        let (before, after) = (Vector::x(), Vector::x() * 0.9);
        let length = barzilai_borwein(after - before, 4.0 * after - 4.0 * before);
        assert!((length - 0.25).abs() < 1e-15);
        let step = capped(-4.0 * after, length, 1.0);
        assert!((after + step).norm() < 1e-15);
        // a gradient that did not change says nothing: as far as is allowed
        let step = capped(Vector::y(), barzilai_borwein(before, Vector::zeros()), 0.3);
        assert!((step - Vector::y() * 0.3).norm() < 1e-15);
    }
}
