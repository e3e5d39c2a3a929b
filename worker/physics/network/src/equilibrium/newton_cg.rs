//! Newton's method on the energy, each step solved by conjugate gradients.
//!
//! The energy is C¹ with kinks in its slope, and not convex where bonds are compressed. A step
//! follows the true Hessian as long as it curves upwards along all search directions; otherwise it
//! is solved again without the transverse stiffness of compressed bonds, which leaves a positive
//! matrix, and goes some way along the direction that was found to curve downwards
//! ([NocedalWright2006] chapter 7 truncates there instead; on networks after the force maximum this
//! gives steps too short to be of use). Steps are capped, and kept only when the
//! energy falls. Steps are found in single precision, and in double where single leads no further;
//! energy and forces, which decide, are always double. Before each step the few nodes that are far
//! worse than the others are balanced by themselves ([`super::neighbourhoods`]).
use std::sync::Arc;

use loadframe_harness::Interrupt;
use loadframe_numerics::{
    Team,
    equilibrium::{Newton, settle},
    wide,
};

use super::{
    Search,
    block_jacobi::BlockJacobi,
    conjugate_gradients::{Equations, Scratch, Solved, Stop, Waves, newton_step, precondition},
    forcing::{DOUBLE, NEAR, SINGLE, away, relative_residual, stop},
    line_search::{self, Point},
    multigrid::Cells,
    neighbourhoods::Neighbourhoods,
    work::Meter,
};
use crate::{
    assembly::Assembly,
    configuration::{Configuration, Residual, Verdict},
    field::{BLOCK, Field, Real, largest, longest_square},
    stiffness::Stiffness,
    strips::{AtPlaces, Strip},
};

/// Arithmetic of the Newton step. The energy and its slope are always double: a step in single
/// precision points nearly the same way at half the memory traffic.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Precision {
    Single,
    Double,
}

/// A Newton iteration: where it starts, how far it goes.
struct Iteration<'a, 'b> {
    search: &'b Search,
    assembly: &'a Assembly,
    team: &'b Team,
    here: &'b Configuration,
    waves: &'b mut Waves<'a>,
    /// Part of itself that the residual can fall to.
    tightest: f64,
    /// Preconditioned norm of the resultants, squared, as the last iteration found it.
    norm: f64,
}

/// Memory that iterations use one after the other.
#[derive(Debug)]
pub(super) struct Memory<T> {
    /// The resultants of the free nodes over the largest component among them: numbers of order
    /// one stay within the range of single precision.
    force: Field<T>,
    step: Field<T>,
    direction: Field<f64>,
    nodes: BlockJacobi<T>,
    scratch: Scratch<T>,
    /// The stiffness of a step without buckling.
    upwards: Stiffness<T>,
    neighbourhoods: Neighbourhoods,
    /// Steps in search of long waves share what is known of them.
    cells: Arc<Cells>,
}

impl<T: Real> Memory<T> {
    pub(super) fn new(assembly: &Assembly) -> Self {
        let zeros = Field::zeros(assembly.places(), assembly.dimensions());
        Self {
            force: zeros.clone(),
            step: zeros,
            direction: Field::zeros(assembly.places(), assembly.dimensions()),
            nodes: BlockJacobi::zeros(assembly),
            scratch: Scratch::new(assembly),
            upwards: Stiffness::default(),
            neighbourhoods: Neighbourhoods::default(),
            cells: Arc::default(),
        }
    }

    /// The equations of a step, and where to solve them.
    fn equations<'a>(
        &'a mut self,
        assembly: &'a Assembly,
        stiffness: &'a Stiffness<T>,
        team: &'a Team,
    ) -> (Equations<'a, T>, &'a mut Field<T>, &'a mut Scratch<T>) {
        let equations = Equations {
            assembly,
            stiffness,
            nodes: &self.nodes,
            force: &self.force,
            team,
        };
        (equations, &mut self.step, &mut self.scratch)
    }
}

/// Moves `here` to equilibrium; `there` and `single` are memory.
pub(super) fn descend(
    search: &Search,
    assembly: &Assembly,
    here: &mut Configuration,
    there: &mut Configuration,
    single: &mut Memory<f32>,
    team: &Team,
    meter: &mut Meter<'_>,
) -> Result<Residual, Interrupt> {
    let cells = Arc::clone(&single.cells);
    let mut way = Way {
        search,
        assembly,
        team,
        // not looked at yet
        residual: Residual {
            largest: f64::INFINITY,
            node: 0,
            mean: f64::INFINITY,
            verdict: Verdict::Unbalanced,
        },
        here,
        there,
        single,
        waves: Waves::new(assembly, &cells),
        // nothing is known of how residuals fall: the first step is a loose one
        previous_norm: 0.0,
        worth_parts: f64::INFINITY,
        precision: Precision::Single,
        meter,
    };
    settle(&mut way, search.iteration_limit)?;
    Ok(way.residual)
}

/// The way to an equilibrium.
struct Way<'a, 'b, 'm> {
    search: &'b Search,
    assembly: &'a Assembly,
    team: &'b Team,
    here: &'b mut Configuration,
    there: &'b mut Configuration,
    single: &'b mut Memory<f32>,
    waves: Waves<'a>,
    residual: Residual,
    previous_norm: f64,
    /// Residual below which parts are worth balancing, again if they just were.
    worth_parts: f64,
    precision: Precision,
    meter: &'b mut Meter<'m>,
}

impl Newton for Way<'_, '_, '_> {
    type Failure = Interrupt;

    fn is_at_rest(&mut self, steps: u32) -> Result<bool, Interrupt> {
        let Self {
            search, assembly, ..
        } = *self;
        loop {
            self.residual = self.here.residual(assembly, search.force_limit);
            let is_balanced = self.residual.verdict != Verdict::Unbalanced;
            if is_balanced || steps == search.iteration_limit {
                if !self.here.is_patched {
                    return Ok(is_balanced);
                }
                self.here.update(assembly, self.team);
                continue;
            }
            if self.residual.largest < self.worth_parts {
                let neighbourhoods = &mut self.single.neighbourhoods;
                let (here, residual) = (&mut *self.here, &self.residual);
                let again = neighbourhoods.relax(search, assembly, here, residual, self.meter)?;
                if let Some(again) = again {
                    self.worth_parts = again;
                    continue;
                }
            }
            self.worth_parts = f64::INFINITY;
            return Ok(false);
        }
    }

    fn advance(&mut self) -> Result<bool, Interrupt> {
        self.meter.work.newton_iterations += 1;
        let (assembly, team, there) = (self.assembly, self.team, &mut *self.there);
        let mut iteration = Iteration {
            search: self.search,
            assembly,
            team,
            here: self.here,
            waves: &mut self.waves,
            tightest: match self.precision {
                Precision::Single => SINGLE,
                Precision::Double => DOUBLE,
            },
            norm: if self.residual.largest < NEAR * self.search.force_limit {
                f64::INFINITY
            } else {
                self.previous_norm
            },
        };
        let is_accepted = match self.precision {
            Precision::Single => {
                let stiffness = &self.here.stiffness;
                iteration.go(stiffness, self.single, there, self.meter)?
            }
            Precision::Double => {
                let exact: Configuration<f64> =
                    Configuration::new(assembly, self.here.displacements.clone(), team);
                let memory = &mut Memory::new(assembly);
                iteration.go(&exact.stiffness, memory, there, self.meter)?
            }
        };
        self.previous_norm = iteration.norm;
        if is_accepted {
            std::mem::swap(self.here, self.there);
        } else if self.precision == Precision::Single {
            self.precision = Precision::Double;
        } else if self.here.is_patched {
            self.here.update(assembly, team);
        } else {
            // neither Hessian leads down: this is as far as the arithmetic goes
            return Ok(false);
        }
        Ok(true)
    }
}

impl Iteration<'_, '_> {
    /// Sets `there` to where a step leads; returns false when none leads down.
    fn go<T: Real>(
        &mut self,
        stiffness: &Stiffness<T>,
        memory: &mut Memory<T>,
        there: &mut Configuration,
        meter: &mut Meter<'_>,
    ) -> Result<bool, Interrupt> {
        let (assembly, here) = (self.assembly, self.here);
        memory.nodes.follow(assembly, stiffness, self.team);
        self.waves.follow(&memory.nodes);
        let unit = scale_to_one(assembly, &here.resultants, &mut memory.force, self.team);
        let norm = self.begin(stiffness, memory);
        let previous_norm = std::mem::replace(&mut self.norm, norm * unit * unit);
        let relative = relative_residual(self.norm, previous_norm, self.tightest);
        let (compliance, nodes) = (memory.nodes.compliance(), assembly.free().len());
        let stop = stop(self.search, relative, unit, norm, compliance, nodes);
        let solved = self.solve(stiffness, memory, norm, stop, meter)?;
        if solved == Solved::Step && self.follow(memory, unit, there, meter)? {
            return Ok(true);
        }
        // the direction found to curve downwards leads away from the saddle, however flat that is
        let downwards = match solved {
            Solved::Step => None,
            Solved::CurvesDown(length) => Some((length, memory.scratch.search.clone())),
        };
        let mut upwards = std::mem::take(&mut memory.upwards);
        stiffness.without_buckling(&mut upwards);
        let norm = self.begin(&upwards, memory);
        self.solve(&upwards, memory, norm, stop, meter)?;
        memory.upwards = upwards;
        if let Some((length, direction)) = downwards {
            let reach = direction.longest_square().wide().sqrt() * unit;
            if let Some(length) = away(self.search, length, reach) {
                memory.step.add(T::new(length), &direction);
            }
        }
        self.follow(memory, unit, there, meter)
    }

    /// Searches along the preconditioned resultants first; returns their squared norm.
    fn begin<T: Real>(&mut self, stiffness: &Stiffness<T>, memory: &mut Memory<T>) -> f64 {
        let (equations, _, scratch) = memory.equations(self.assembly, stiffness, self.team);
        precondition(&equations, self.waves, equations.force, &mut scratch.search)
    }

    fn solve<T: Real>(
        &mut self,
        stiffness: &Stiffness<T>,
        memory: &mut Memory<T>,
        norm: f64,
        stop: Stop,
        meter: &mut Meter<'_>,
    ) -> Result<Solved, Interrupt> {
        let (equations, step, scratch) = memory.equations(self.assembly, stiffness, self.team);
        newton_step(&equations, self.waves, norm, step, scratch, stop, meter)
    }

    /// Goes along a step, in units of `unit`, as far as the energy falls.
    fn follow<T: Real>(
        &self,
        memory: &mut Memory<T>,
        unit: f64,
        there: &mut Configuration,
        meter: &mut Meter<'_>,
    ) -> Result<bool, Interrupt> {
        let step = &memory.step;
        let along = AtPlaces(memory.direction.components_mut());
        let strips = &self.assembly.strips;
        let go = |strip: Strip, AtPlaces(along): &mut AtPlaces<'_, f64, 3>| {
            let step = step.panel(strip.places.clone());
            wide(
                #[inline(always)]
                || {
                    for (direction, step) in along.iter_mut().zip(step) {
                        for (direction, step) in direction.iter_mut().zip(step) {
                            *direction = step.wide() * unit;
                        }
                    }
                    longest_square(along.each_ref().map(
                        #[inline(always)]
                        |along| &**along,
                    ))
                },
            )
        };
        let longest_square = strips.fold(self.team, along, go, f64::max);
        let (assembly, team, start) = (self.assembly, self.team, self.here);
        let direction = &memory.direction;
        let point = |at: &Configuration| Point {
            energy: at.energy,
            slope: slope(assembly, at, direction, team),
        };
        let longest = self.search.step_cap / longest_square.sqrt();
        line_search::descend(point(start), longest, |length| {
            meter.spend(assembly.bonds())?;
            go_along(assembly, start, direction, length, there, team);
            Ok(point(there))
        })
    }
}

/// dE by the multiple of `direction` gone [N mm].
fn slope(assembly: &Assembly, at: &Configuration, direction: &Field<f64>, team: &Team) -> f64 {
    let free = assembly.free();
    -assembly.strips.sum(team, (), |strip, ()| {
        let places = strip.within(&free);
        wide(
            #[inline(always)]
            || at.resultants.dot(direction, places.clone()),
        )
    })
}

/// Sets `there` to what is `length` times `direction` away from `here`.
fn go_along(
    assembly: &Assembly,
    here: &Configuration,
    direction: &Field<f64>,
    length: f64,
    there: &mut Configuration,
    team: &Team,
) {
    let displacements = AtPlaces(there.displacements.components_mut());
    let strips = &assembly.strips;
    strips.each(team, displacements, |strip, AtPlaces(there)| {
        let [start, direction] =
            [&here.displacements, direction].map(|field| field.panel(strip.places.clone()));
        for (there, (start, direction)) in there.iter_mut().zip(start.iter().zip(direction)) {
            for (there, (start, direction)) in there.iter_mut().zip(start.iter().zip(direction)) {
                *there = start + direction * length;
            }
        }
    });
    there.update(assembly, team);
}

/// Sets `scaled` to the resultants of the free nodes over the largest component among them;
/// returns that [N].
fn scale_to_one<T: Real>(
    assembly: &Assembly,
    resultants: &Field<f64>,
    scaled: &mut Field<T>,
    team: &Team,
) -> f64 {
    let (strips, free) = (&assembly.strips, assembly.free());
    let most = |strip: Strip, (): &mut ()| {
        let forces = resultants.panel(strip.within(&free));
        wide(
            #[inline(always)]
            || {
                let mut magnitudes = [0.0; BLOCK];
                let mut most = 0.0_f64;
                for part in forces.iter().flat_map(|component| component.chunks(BLOCK)) {
                    let magnitudes = &mut magnitudes[..part.len()];
                    for (magnitude, force) in magnitudes.iter_mut().zip(part) {
                        *magnitude = force.abs();
                    }
                    most = most.max(largest(magnitudes));
                }
                most
            },
        )
    };
    let unit = strips.fold(team, (), most, f64::max);
    let outputs = AtPlaces(scaled.components_mut());
    strips.each(team, outputs, |strip, AtPlaces(scaled)| {
        let places = strip.within(&free);
        let forces = resultants.panel(places.clone());
        let own = places.start - strip.places.start..places.end - strip.places.start;
        wide(
            #[inline(always)]
            || {
                for (scaled, forces) in scaled.iter_mut().zip(forces) {
                    let scaled = scaled.get_mut(own.clone()).unwrap_or_default();
                    for (scaled, force) in scaled.iter_mut().zip(forces) {
                        *scaled = T::new(force / unit);
                    }
                }
            },
        );
    });
    unit
}
