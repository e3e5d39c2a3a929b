//! Rest of a tube under held points: for small displacements, for large ones, and where it buckles.
//!
//! Displacements are three a point, in µm, forces in mN. Tension is positive.
use loadframe_numerics::equilibrium::{Newton, Settled, halved, settle};

use super::equations::{Equations, Stiffness, direction};
use super::{Tube, TubeError};

/// Unbalanced force over the largest force of a spring, at which a tube rests.
pub const RESIDUAL: f64 = 1e-10;
/// Round-off of forces is some 10⁻¹⁵ of stiffness times displacement: forces below this part of it,
/// times [`RESIDUAL`], are none. It matters where a tube is turned far and hardly strained.
const UNRESOLVED: f64 = 1e-5;
/// Newton steps to a rest, and halvings of one. From a rest nearby 4 to 8 steps are taken.
const MOST_STEPS: u32 = 60;
const MOST_HALVINGS: u32 = 30;
/// Rounds of inverse iteration. Each takes off the ratio of the first two loads, a quarter for Euler's.
const MOST_ROUNDS: u32 = 200;
/// Relative change of the buckling load at which it is taken as found.
const BUCKLING_CHANGE: f64 = 1e-12;

/// What is done to the points: `Some` displacement where a point is held or moved, axis by axis.
#[derive(Debug, Clone)]
pub struct Supports {
    moved_um: Vec<Option<f64>>,
}

/// A tube at rest.
#[derive(Debug, Clone)]
pub struct Rest {
    /// Three a point [µm].
    pub displacements_um: Vec<f64>,
    /// Forces with which the supports hold the points, three a point [mN]; 0 at free ones.
    pub reactions_mn: Vec<f64>,
    /// Of all springs [mN].
    pub tensions_mn: Vec<f64>,
    /// Largest unbalanced force over the largest force of a spring.
    pub residual: f64,
    /// Factors it took.
    pub factorings: u32,
}

/// The first buckling mode.
#[derive(Debug, Clone)]
pub struct Buckling {
    /// How many times the given prestress is critical.
    pub factor: f64,
    /// Three a point, the largest 1.
    pub mode: Vec<f64>,
    pub rounds: u32,
}

impl Supports {
    /// Nothing is held.
    pub fn none(tube: &Tube) -> Self {
        Self {
            moved_um: vec![None; 3 * tube.places_um().len()],
        }
    }

    /// Moves a point along an axis by so much [µm].
    pub fn move_point(&mut self, point: usize, axis: usize, by_um: f64) {
        self.moved_um[3 * point + axis] = Some(by_um);
    }

    /// Moves the points of a ring: what `by` says of a point's place, for the axes it says it of.
    pub fn move_ring(
        &mut self,
        tube: &Tube,
        ring: usize,
        by: impl Fn([f64; 3]) -> [Option<f64>; 3],
    ) {
        for point in tube.ring(ring) {
            for (axis, moved) in by(tube.places_um()[point]).into_iter().enumerate() {
                if let Some(by_um) = moved {
                    self.move_point(point, axis, by_um);
                }
            }
        }
    }

    fn held(&self) -> Vec<bool> {
        self.moved_um.iter().map(Option::is_some).collect()
    }
}

/// Rest for small displacements: one solution of the linear equations and one that corrects it.
///
/// # Errors
/// [`TubeError::Unstable`] when the supports leave a motion free.
pub fn small(tube: &Tube, supports: &Supports) -> Result<Rest, TubeError> {
    let mut equations = Equations::new(tube, &supports.held())?;
    equations.factor(unstressed(tube))?;
    let mut displacements: Vec<f64> = supports
        .moved_um
        .iter()
        .map(|moved| moved.unwrap_or(0.0))
        .collect();
    let mut step = vec![0.0; displacements.len()];
    for _ in 0..2 {
        let unbalanced = small_forces(tube, &displacements).0;
        equations.solve(&unbalanced, &mut step);
        for (displacement, part) in displacements.iter_mut().zip(&step) {
            *displacement += part;
        }
    }
    let (forces, tensions) = small_forces(tube, &displacements);
    Ok(at_rest(tube, supports, displacements, &forces, tensions))
}

/// Rest for displacements of any size: Newton's method on the energy of the springs, from the
/// displacements of a rest before.
///
/// The full tangent is taken where it is positive definite; elsewhere springs in compression give
/// only their stiffness along themselves. Steps are halved until the energy falls.
///
/// # Errors
/// [`TubeError::NotConverged`] with the largest displacement asked for.
pub fn large(tube: &Tube, supports: &Supports, start: &[f64]) -> Result<Rest, TubeError> {
    let displacements: Vec<f64> = start
        .iter()
        .zip(&supports.moved_um)
        .map(|(&start, moved)| moved.unwrap_or(start))
        .collect();
    let mut way = Way {
        tube,
        supports,
        equations: Equations::new(tube, &supports.held())?,
        step: vec![0.0; displacements.len()],
        at: Forced::new(tube, supports, displacements),
    };
    match settle(&mut way, MOST_STEPS)? {
        Settled::AtRest(_) => Ok(way.at.rest),
        Settled::Stuck(_) | Settled::Slow => {
            let asked = supports.moved_um.iter().flatten();
            Err(TubeError::NotConverged {
                displacement_um: asked.fold(0.0, |most, moved| most.max(moved.abs())),
                residual: way.at.rest.residual,
                limit: RESIDUAL,
                rounds: MOST_STEPS,
            })
        }
    }
}

/// The way of a tube to its rest.
struct Way<'a> {
    tube: &'a Tube,
    supports: &'a Supports,
    equations: Equations,
    at: Forced,
    step: Vec<f64>,
}

/// A tube after displacements, at rest or not.
struct Forced {
    rest: Rest,
    /// Of the springs on all points, three a point [mN].
    forces: Vec<f64>,
    energy_nj: f64,
}

impl Forced {
    fn new(tube: &Tube, supports: &Supports, displacements: Vec<f64>) -> Self {
        let (forces, tensions, energy_nj) = large_forces(tube, &displacements);
        Self {
            rest: at_rest(tube, supports, displacements, &forces, tensions),
            forces,
            energy_nj,
        }
    }
}

impl Newton for Way<'_> {
    type Failure = TubeError;

    fn is_at_rest(&mut self, steps: u32) -> Result<bool, TubeError> {
        self.at.rest.factorings = steps;
        Ok(self.at.rest.residual <= RESIDUAL)
    }

    fn advance(&mut self) -> Result<bool, TubeError> {
        let tube = self.tube;
        let Forced {
            rest,
            forces,
            energy_nj: energy,
        } = &self.at;
        let energy = *energy;
        let places = moved(tube, &rest.displacements_um);
        let stiffness =
            |is_tension_only| stressed(tube, &places, &rest.tensions_mn, is_tension_only);
        if self.equations.factor(stiffness(false)).is_err() {
            self.equations.factor(stiffness(true))?;
        }
        self.equations.solve(forces, &mut self.step);
        halved(1.0, MOST_HALVINGS, |part, halvings| {
            let from = self.at.rest.displacements_um.iter().zip(&self.step);
            let displacements = from.map(|(at, step)| at + part * step).collect();
            let there = Forced::new(tube, self.supports, displacements);
            // near rest the energy changes by less than its round-off
            let is_taken = there.energy_nj <= energy * (1.0 + 1e-12) || halvings == MOST_HALVINGS;
            if is_taken {
                self.at = there;
            }
            Ok(is_taken)
        })
    }
}

/// The smallest factor λ > 0 at which (K + λ K_f) φ = 0, K_f the stiffness that the tensions f of a
/// rest add: inverse iteration with the factor of K.
///
/// # Errors
/// [`TubeError::NoBuckling`] when the iteration finds no positive factor.
pub fn buckling(
    tube: &Tube,
    supports: &Supports,
    prestress: &Rest,
    start: &[f64],
) -> Result<Buckling, TubeError> {
    let mut equations = Equations::new(tube, &supports.held())?;
    equations.factor(unstressed(tube))?;
    let zero = |vector: &mut [f64]| {
        for (part, moved) in vector.iter_mut().zip(&supports.moved_um) {
            if moved.is_some() {
                *part = 0.0;
            }
        }
    };
    let mut mode = start.to_vec();
    zero(&mut mode);
    let mut next = vec![0.0; mode.len()];
    let (mut factor, mut change) = (0.0_f64, f64::INFINITY);
    for rounds in 1..=MOST_ROUNDS {
        let push = prestress_forces(tube, &prestress.tensions_mn, &mode);
        equations.solve(&push, &mut next);
        // φᵀKφ with K φ = push on the free displacements, over -φᵀK_f φ
        let elastic = dot(&next, &push);
        let geometric = dot(
            &next,
            &prestress_forces(tube, &prestress.tensions_mn, &next),
        );
        let new = elastic / geometric;
        change = ((new - factor) / new).abs();
        factor = new;
        let largest = next.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
        for (mode, part) in mode.iter_mut().zip(&next) {
            *mode = part / largest;
        }
        if change <= BUCKLING_CHANGE && factor > 0.0 {
            return Ok(Buckling {
                factor,
                mode,
                rounds,
            });
        }
    }
    Err(TubeError::NoBuckling {
        rounds: MOST_ROUNDS,
        change,
    })
}

/// Places of points after displacements.
pub fn moved(tube: &Tube, displacements: &[f64]) -> Vec<[f64; 3]> {
    let parts = displacements.as_chunks::<3>().0;
    tube.places_um()
        .iter()
        .zip(parts)
        .map(|(place, moved)| [0, 1, 2].map(|axis| place[axis] + moved[axis]))
        .collect()
}

fn at_rest(
    tube: &Tube,
    supports: &Supports,
    displacements_um: Vec<f64>,
    forces: &[f64],
    tensions_mn: Vec<f64>,
) -> Rest {
    let most = |values: &[f64]| {
        values
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let stiffest = tube
        .springs()
        .iter()
        .map(|spring| spring.stiffness_mn_per_um);
    let stiffest = stiffest.fold(0.0, f64::max);
    let scale = most(&tensions_mn).max(UNRESOLVED * stiffest * most(&displacements_um));
    let mut unbalanced = 0.0_f64;
    let mut reactions_mn = vec![0.0; forces.len()];
    for ((force, moved), reaction) in forces.iter().zip(&supports.moved_um).zip(&mut reactions_mn) {
        if moved.is_some() {
            *reaction = -force;
        } else {
            unbalanced = unbalanced.max(force.abs());
        }
    }
    Rest {
        displacements_um,
        reactions_mn,
        tensions_mn,
        residual: if scale > 0.0 { unbalanced / scale } else { 0.0 },
        factorings: 1,
    }
}

fn unstressed(tube: &Tube) -> impl Iterator<Item = Stiffness> + '_ {
    tube.springs().iter().map(|spring| Stiffness {
        direction: direction(spring, tube.places_um()).0,
        along: spring.stiffness_mn_per_um,
        across: 0.0,
    })
}

fn stressed<'a>(
    tube: &'a Tube,
    places: &'a [[f64; 3]],
    tensions: &'a [f64],
    is_tension_only: bool,
) -> impl Iterator<Item = Stiffness> + 'a {
    tube.springs()
        .iter()
        .zip(tensions)
        .map(move |(spring, tension)| {
            let (direction, length) = direction(spring, places);
            let across = tension / length;
            Stiffness {
                direction,
                along: spring.stiffness_mn_per_um,
                across: if is_tension_only {
                    across.max(0.0)
                } else {
                    across
                },
            }
        })
}

/// Forces of the springs on all points, and tensions, for small displacements.
fn small_forces(tube: &Tube, displacements: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut forces = vec![0.0; displacements.len()];
    let tensions = tube.springs().iter().map(|spring| {
        let (direction, _) = direction(spring, tube.places_um());
        let [low, high] = spring.points.map(|point| 3 * point as usize);
        let elongation: f64 = (0..3)
            .map(|axis| direction[axis] * (displacements[high + axis] - displacements[low + axis]))
            .sum();
        let tension = spring.stiffness_mn_per_um * elongation;
        for axis in 0..3 {
            forces[low + axis] += tension * direction[axis];
            forces[high + axis] -= tension * direction[axis];
        }
        tension
    });
    let tensions = tensions.collect();
    (forces, tensions)
}

/// Forces of the springs on all points, tensions, and energy [nJ], after displacements.
///
/// With a the vector along a spring at rest and d the change of it, the elongation is
/// (2 a·d + d·d)/(L + L₀): a difference of the lengths themselves would lose small strains.
fn large_forces(tube: &Tube, displacements: &[f64]) -> (Vec<f64>, Vec<f64>, f64) {
    let mut forces = vec![0.0; displacements.len()];
    let mut tensions = Vec::with_capacity(tube.springs().len());
    let mut energy = 0.0;
    for spring in tube.springs() {
        let (rest, rest_length) = direction(spring, tube.places_um());
        let [low, high] = spring.points.map(|point| 3 * point as usize);
        let change = [0, 1, 2].map(|axis| displacements[high + axis] - displacements[low + axis]);
        let apart = [0, 1, 2].map(|axis| rest_length * rest[axis] + change[axis]);
        let length = apart.iter().map(|part| part * part).sum::<f64>().sqrt();
        let gained: f64 = (0..3)
            .map(|axis| (2.0 * rest_length * rest[axis] + change[axis]) * change[axis])
            .sum();
        let elongation = gained / (length + rest_length);
        let tension = spring.stiffness_mn_per_um * elongation;
        energy += 0.5 * tension * elongation;
        for axis in 0..3 {
            let force = tension * apart[axis] / length;
            forces[low + axis] += force;
            forces[high + axis] -= force;
        }
        tensions.push(tension);
    }
    (forces, tensions, energy)
}

/// -K_f u: what the tensions of a rest push the points on by, after displacements u.
fn prestress_forces(tube: &Tube, tensions: &[f64], displacements: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; displacements.len()];
    for (spring, tension) in tube.springs().iter().zip(tensions) {
        let (direction, length) = direction(spring, tube.places_um());
        let [low, high] = spring.points.map(|point| 3 * point as usize);
        let apart = [0, 1, 2].map(|axis| displacements[high + axis] - displacements[low + axis]);
        let along: f64 = (0..3).map(|axis| apart[axis] * direction[axis]).sum();
        for axis in 0..3 {
            let force = tension / length * (apart[axis] - along * direction[axis]);
            forces[low + axis] += force;
            forces[high + axis] -= force;
        }
    }
    forces
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
