//! Rollers in large displacements: the way of those that press is followed from where they touch.
//!
//! At every place of the rollers the rest is found by Newton's method on one energy, that of the
//! section and of (10) of [`circles`](crate::solve::circles), and the forces of (10) until (9) holds. A force
//! is reached by secants along the way. Whether what is found is stable, [`Rolling::is_stable`] tells; where the force falls as
//! the rollers go on, as when a specimen slips through between its supports, only a way can be asked for.
use serde::{Deserialize, Serialize};

use super::reach::{points, refuse_overlap};
use super::roller::{ContactEquilibrium, Roller, RollerContact, obeyed};
use crate::error::{CompositeError, finite, positive};
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::section::Grid;
use crate::solve::circles::{Circle, Circles};
use crate::solve::equilibrium::{Search, StaticOptions, Stuck};
use crate::supports::{Face, Supports};

/// Rounds of (10); each makes the overlap several times smaller.
const ROUNDS: u32 = 60;
/// By how much (9) may be missed, over the way of the rollers.
const SETTLED: f64 = 1e-9;
/// How far rollers go at once, over the smallest radius: the normal must not turn much at once.
const STRIDE: f64 = 0.25;
/// How often that may be halved.
const CUTS: u32 = 16;
/// Secants until a force is reached, and how near.
const SECANTS: u32 = 60;
const REACHED: f64 = 1e-8;

/// A section between rollers, some at rest and some that press together, bent as far as asked for.
#[allow(missing_debug_implementations, reason = "holds the equations")]
pub struct Rolling<'a> {
    search: Search<'a>,
    lattice: &'a Lattice,
    supports: &'a Supports,
    options: &'a StaticOptions,
    rollers: Vec<Roller>,
    /// How many of them rest.
    resting: usize,
    rounds: u64,
    at: RollingState,
}

/// Where the rollers and the section are: what a checkpoint keeps.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RollingState {
    /// Way of the rollers that press [mm], and their force along it [N].
    advance_mm: f64,
    force_n: f64,
    /// The same a step before.
    before: [f64; 2],
    u: Vec<f64>,
    /// Of every segment of every roller's face [N].
    pressing: Vec<Vec<f64>>,
}

impl<'a> Rolling<'a> {
    /// Before anything is pressed. `still` is a load of zeros.
    ///
    /// # Errors
    /// When a roller has no radius, lies beside its face, over another or on a support; when supports
    /// and rollers leave the section loose; or there is no memory for the equations.
    pub fn new(
        lattice: &'a Lattice,
        supports: &'a Supports,
        still: &'a [f64],
        resting: &[Roller],
        pressing: &[Roller],
        options: &'a StaticOptions,
    ) -> Result<Self, CompositeError> {
        let grid = lattice.grid();
        let rollers: Vec<Roller> = resting.iter().chain(pressing).copied().collect();
        for roller in &rollers {
            roller.checked(grid)?;
        }
        refuse_overlap(&rollers)?;
        // what is in reach must not be held, and holds the section as a whole
        let mut held = supports.clone();
        for point in points(grid, supports, &rollers)? {
            held.hold(grid, point.displacement / 2, point.displacement % 2, 0.0)?;
        }
        held.refuse_rigid_motion(grid)?;
        let mut matrix = lattice.matrix();
        let rest = vec![0.0; lattice.displacements()];
        lattice.tangent(Geometry::Linear, Tangent::Exact, &rest, &mut matrix);
        let circles: Vec<Circle> = rollers.iter().map(|roller| circle(roller, grid)).collect();
        let stiffest = circles
            .iter()
            .flat_map(|circle| &circle.face)
            .map(|&(particle, _)| matrix.diagonal(2 * particle + 1))
            .fold(f64::MIN_POSITIVE, f64::max);
        let mut search = Search::new(lattice, supports, still, options)?;
        search.circles = Circles::new(circles, stiffest);
        Ok(Self {
            search,
            lattice,
            supports,
            options,
            rollers,
            resting: resting.len(),
            rounds: 0,
            at: RollingState::default(),
        })
    }

    /// What a checkpoint keeps.
    #[must_use]
    pub fn state(&self) -> RollingState {
        let all = self.search.circles.all.iter();
        RollingState {
            u: self.search.u.clone(),
            pressing: all.map(|circle| circle.pressing.clone()).collect(),
            ..self.at
        }
    }

    /// Goes on from a state found before.
    ///
    /// # Errors
    /// [`CompositeError::OtherSize`] when it is of another section.
    pub fn resume(&mut self, state: RollingState) -> Result<(), CompositeError> {
        let all = &mut self.search.circles.all;
        let is_same = state.u.len() == self.search.u.len()
            && state.pressing.len() == all.len()
            && (state.pressing.iter().zip(all.iter()))
                .all(|(pressing, circle)| pressing.len() == circle.segments());
        if !is_same {
            return Err(CompositeError::OtherSize);
        }
        for (circle, pressing) in all.iter_mut().zip(&state.pressing) {
            circle.pressing.clone_from(pressing);
        }
        self.search.u.clone_from(&state.u);
        self.at = RollingState {
            u: Vec::new(),
            pressing: Vec::new(),
            ..state
        };
        self.place(self.at.advance_mm);
        Ok(())
    }

    /// Moves the rollers that press to a way from where they touch [mm].
    ///
    /// # Errors
    /// When cells would be turned inside out, or no equilibrium is found.
    pub fn advance_to(&mut self, advance_mm: f64) -> Result<(), CompositeError> {
        finite("a roller's advance [mm]", advance_mm)?;
        let radii = self.rollers.iter().map(|roller| roller.radius_mm);
        let full = STRIDE * radii.fold(f64::INFINITY, f64::min);
        let mut stride = full;
        while (advance_mm - self.at.advance_mm).abs() > 0.0 {
            let left = advance_mm - self.at.advance_mm;
            let goal = if left.abs() <= 1.001 * stride {
                advance_mm
            } else {
                self.at.advance_mm + stride.copysign(left)
            };
            let (u, circles) = (self.search.u.clone(), self.search.circles.clone());
            match self.settle(goal)? {
                Ok(force_n) => {
                    self.at.before = [self.at.advance_mm, self.at.force_n];
                    (self.at.advance_mm, self.at.force_n) = (goal, force_n);
                    stride = (2.0 * stride).min(full);
                    // beyond, there is no rest but that of what has fallen
                    if self.search.circles.holds_an_end(&self.search.u) {
                        return Err(CompositeError::OutOfRange {
                            quantity: "the way of the rollers [mm] at which an end of the section \
                                       reaches a support",
                            given: goal,
                            allowed: "more than the way asked for: choose a longer section, or a \
                                      shorter way",
                        });
                    }
                }
                Err(stuck) => {
                    self.search.u = u;
                    self.search.circles = circles;
                    stride *= 0.5;
                    if stride < full / f64::from(1_u32 << CUTS) {
                        return Err(self.told(stuck, goal / advance_mm));
                    }
                }
            }
        }
        Ok(())
    }

    /// Moves the rollers that press until their forces along their way sum up to a force [N].
    ///
    /// # Errors
    /// As [`Rolling::advance_to`], and when the section gives way before.
    pub fn press_to(&mut self, force_n: f64) -> Result<(), CompositeError> {
        positive("the force on the rollers [N]", force_n)?;
        if self.resting == self.rollers.len() {
            return Err(CompositeError::OutOfRange {
                quantity: "the number of rollers that press",
                given: 0.0,
                allowed: "at least 1",
            });
        }
        let radii = self.rollers.iter().map(|roller| roller.radius_mm);
        let full = STRIDE * radii.fold(f64::INFINITY, f64::min);
        for _ in 0..SECANTS {
            let miss = force_n - self.at.force_n;
            if miss.abs() <= REACHED * force_n {
                return Ok(());
            }
            let [way, force] = self.at.before;
            let (run, rise) = (self.at.advance_mm - way, self.at.force_n - force);
            let step = if run.abs() < f64::MIN_POSITIVE {
                // a touch, to feel how stiff it is
                0.02 * full
            } else {
                let slope = rise / run;
                if slope <= 0.0 {
                    return Err(CompositeError::SlipsThrough {
                        force_n,
                        largest_n: self.at.force_n.max(force),
                        advance_mm: self.at.advance_mm,
                    });
                }
                (miss / slope).clamp(-full, full)
            };
            self.advance_to(self.at.advance_mm + step)?;
        }
        Err(CompositeError::NotConverged {
            load_fraction: self.at.force_n / force_n,
            iterations: u64::from(SECANTS),
            residual: (self.at.force_n / force_n - 1.0).abs(),
        })
    }

    /// Whether it takes energy to push the section from its rest whichever way, the rollers in their places.
    ///
    /// # Errors
    /// When there is no memory for the equations.
    pub fn is_stable(&mut self) -> Result<bool, CompositeError> {
        self.search.is_stable()
    }

    /// What the rollers do where they are.
    ///
    /// # Errors
    /// When (9) is missed by more than round-off.
    pub fn equilibrium(&mut self) -> Result<ContactEquilibrium, CompositeError> {
        let mut found = self.search.finish(1.0);
        found.reactions_n = (found.reactions_n.iter())
            .enumerate()
            .map(|(place, reaction)| {
                if self.supports.is_held(place) {
                    *reaction
                } else {
                    0.0
                }
            })
            .collect();
        let (mut sums, mut sizes) = ([0.0; 2], [0.0; 2]);
        for (place, reaction) in found.reactions_n.iter().enumerate() {
            sums[place % 2] += reaction;
            sizes[place % 2] += reaction.abs();
        }
        let mut contacts = Vec::with_capacity(self.rollers.len());
        let (u, circles) = (&self.search.u, &self.search.circles);
        for (place, circle) in circles.all.iter().enumerate() {
            let pressed = (&self.rollers[place], circle, circles.stiffness);
            let (contact, force) = contact(pressed, u, &mut found.reactions_n)?;
            for axis in 0..2 {
                sums[axis] += force[axis];
                sizes[axis] += force[axis].abs();
            }
            let advance_mm = if place < self.resting {
                0.0
            } else {
                self.at.advance_mm
            };
            contacts.push(RollerContact {
                advance_mm,
                ..contact
            });
        }
        let size = sizes[0].max(sizes[1]);
        found.reaction_error = if size > 0.0 {
            sums[0].abs().max(sums[1].abs()) / size
        } else {
            0.0
        };
        Ok(ContactEquilibrium {
            equilibrium: found,
            rollers: contacts,
            rounds: self.rounds,
        })
    }

    /// Moves the circles of the rollers that press.
    fn place(&mut self, advance_mm: f64) {
        for circle in &mut self.search.circles.all[self.resting..] {
            circle.advance_mm = advance_mm;
        }
    }

    /// Finds the rest at a place of the rollers; the force on those that press, along their way.
    fn settle(&mut self, advance_mm: f64) -> Result<Result<f64, Stuck>, CompositeError> {
        self.place(advance_mm);
        let mut missed = f64::INFINITY;
        for _ in 0..ROUNDS {
            self.rounds += 1;
            if let Err(stuck) = self.search.load_step(1.0, 1.0, &|| false)? {
                return Ok(Err(stuck));
            }
            // forces that are augmented once more would be out of balance with those of the section
            missed = self.search.circles.missed_mm(&self.search.u) / advance_mm.abs();
            if missed <= SETTLED {
                return Ok(Ok(self.pressed()));
            }
            self.search.circles.augment(&self.search.u);
        }
        Ok(Err(Stuck::Slow {
            iterations: self.rounds,
            residual: missed,
        }))
    }

    /// Sum of the forces of rollers that press, along their way [N].
    fn pressed(&self) -> f64 {
        let (u, circles) = (&self.search.u, &self.search.circles);
        let of = |place: usize| -> f64 {
            let (roller, circle) = (&self.rollers[place], &circles.all[place]);
            (0..circle.segments())
                .map(|segment| {
                    let nearest = circle.nearest(segment, u);
                    let force = circle.force(segment, &nearest, circles.stiffness);
                    force * roller.inward() * nearest.normal[roller.normal()]
                })
                .sum()
        };
        (self.resting..self.rollers.len()).map(of).sum()
    }

    fn told(&self, stuck: Stuck, load_fraction: f64) -> CompositeError {
        let grid = self.lattice.grid();
        match stuck {
            Stuck::Inverted(cell) => {
                let [x_mm, y_mm] = grid.middle_mm(cell);
                CompositeError::Inverted {
                    column: cell % grid.columns(),
                    row: cell / grid.columns(),
                    x_mm,
                    y_mm,
                    step: self.rounds,
                    load_fraction,
                }
            }
            Stuck::Slow {
                iterations,
                residual,
            } => CompositeError::NotConverged {
                load_fraction,
                iterations,
                residual: residual.max(self.options.tolerance),
            },
        }
    }
}

fn circle(roller: &Roller, grid: &Grid) -> Circle {
    let lines = roller.face.lines_mm(grid).iter().enumerate();
    let face: Vec<(usize, f64)> = lines
        .map(|(line, at_mm)| (roller.face.particle(grid, line), at_mm - roller.at_mm))
        .collect();
    let (mut inward, mut along) = ([0.0; 2], [0.0; 2]);
    inward[roller.normal()] = roller.inward();
    along[roller.face.along()] = 1.0;
    Circle {
        radius_mm: roller.radius_mm,
        advance_mm: 0.0,
        inward,
        along,
        pressing: vec![0.0; face.len() - 1],
        face,
        left: match roller.face {
            Face::Bottom | Face::Right => 1.0,
            Face::Top | Face::Left => -1.0,
        },
    }
}

/// What a roller does to its face, with κ [N/mm], and its force on it [N], which is added to those on
/// particles.
fn contact(
    (roller, circle, stiffness): (&Roller, &Circle, f64),
    u: &[f64],
    forces: &mut [f64],
) -> Result<(RollerContact, [f64; 2]), CompositeError> {
    let mut force = [0.0; 2];
    let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
    let (mut pierced, mut between) = (0.0_f64, None::<[f64; 2]>);
    let mut touching: Vec<usize> = Vec::new();
    for segment in 0..circle.segments() {
        let nearest = circle.nearest(segment, u);
        pierced = pierced.max(-nearest.gap);
        let pressing = circle.force(segment, &nearest, stiffness);
        if pressing <= 0.0 {
            continue;
        }
        let [from, to] = [segment, segment + 1].map(|place| circle.face[place].1);
        let distance = from + nearest.share * (to - from);
        let at = roller.at_mm + distance;
        let shares = [1.0 - nearest.share, nearest.share];
        for (particle, share) in circle.ends(segment).into_iter().zip(shares) {
            if share > 0.0 && touching.last() != Some(&particle) {
                touching.push(particle);
            }
            for axis in 0..2 {
                forces[2 * particle + axis] += share * pressing * nearest.normal[axis];
            }
        }
        for (sum, part) in force.iter_mut().zip(nearest.normal) {
            *sum += pressing * part;
        }
        let [low, high] = between.unwrap_or([at; 2]);
        between = Some([low.min(at), high.max(at)]);
        sum += pressing;
        first += pressing * distance;
        second += pressing * distance * distance;
    }
    let size = u.iter().fold(circle.radius_mm, |size, u| size.max(u.abs()));
    obeyed(pierced / size)?;
    let mean = if sum > 0.0 { first / sum } else { 0.0 };
    let spread = if sum > 0.0 {
        second / sum - mean * mean
    } else {
        0.0
    };
    let contact = RollerContact {
        advance_mm: 0.0,
        force_n: roller.inward() * force[roller.normal()],
        particles: touching.len(),
        between_mm: between,
        centre_mm: roller.at_mm + mean,
        half_width_mm: 2.0 * spread.max(0.0).sqrt(),
    };
    Ok((contact, force))
}
