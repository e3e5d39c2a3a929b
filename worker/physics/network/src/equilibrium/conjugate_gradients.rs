//! Preconditioned conjugate gradients for the Newton step H d = F.
//!
//! The iterations are those of [`loadframe_numerics::equilibrium`]; what is here is what they work on: vectors
//! in single precision over strips, one array an axis, with the preconditioner of nodes applied in the pass
//! that goes along the direction.
use std::ops::Range;

use loadframe_harness::Interrupt;
use loadframe_numerics::{
    Team,
    equilibrium::{Ended, Iterated, iterate},
    wide,
};

use super::{
    block_jacobi::BlockJacobi,
    multigrid::{Cells, Multigrid},
    work::Meter,
};
use crate::{
    assembly::Assembly,
    field::{Field, Real},
    stiffness::Stiffness,
    strips::{AtPlaces, Spill},
};

/// Memory that steps use one after the other.
#[derive(Debug)]
pub(super) struct Scratch<T> {
    residual: Field<T>,
    /// The last direction.
    pub(super) search: Field<T>,
    product: Field<T>,
    spill: Spill<T, 3>,
}

impl<T: Real> Scratch<T> {
    pub(super) fn new(assembly: &Assembly) -> Self {
        let zeros = Field::zeros(assembly.places(), assembly.dimensions());
        Self {
            residual: zeros.clone(),
            search: zeros.clone(),
            product: zeros,
            spill: Spill::new(&assembly.strips, assembly.dimensions()),
        }
    }
}

/// When the iterations end, in terms of the squared preconditioned norm of the residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    /// Relative to the start.
    pub(super) relative: f64,
    pub(super) absolute: f64,
    pub(super) iterations: usize,
}

/// The equations H d = F of a Newton step.
#[derive(Debug)]
pub(super) struct Equations<'a, T> {
    pub(super) assembly: &'a Assembly,
    pub(super) stiffness: &'a Stiffness<T>,
    pub(super) nodes: &'a BlockJacobi<T>,
    /// F, zero at held nodes.
    pub(super) force: &'a Field<T>,
    pub(super) team: &'a Team,
}

/// The part of the preconditioner that sees long waves.
#[derive(Debug)]
pub(super) struct Waves<'a> {
    assembly: &'a Assembly,
    cells: &'a Cells,
    grids: Option<Multigrid<'a>>,
    /// Iterations of one step before the grids are built with the present stiffness.
    patience: usize,
}

/// Iterations after which a grid at rest serves so badly that grids of the present stiffness pay, though
/// they cost as much as dozens of iterations. From 40 to 200 all serve alike.
const PATIENCE: usize = 100;

impl<'a> Waves<'a> {
    pub(super) fn new(assembly: &'a Assembly, cells: &'a Cells) -> Self {
        let grids = Multigrid::at_rest(assembly, cells);
        let patience = match (cells.are_enough(assembly), &grids) {
            (false, _) => usize::MAX,
            (_, None) => 0,
            (_, Some(_)) => PATIENCE,
        };
        Self {
            assembly,
            cells,
            grids,
            patience,
        }
    }

    /// Takes note of how stiff the nodes are now.
    pub(super) fn follow<T: Real>(&mut self, nodes: &BlockJacobi<T>) {
        if let Some(grids) = &mut self.grids {
            grids.follow(nodes);
        }
    }

    /// Patience is at its end: whether the preconditioner changed.
    fn renew<T: Real>(&mut self, stiffness: &Stiffness<T>) -> bool {
        self.grids = Multigrid::new(self.assembly, self.cells, stiffness);
        self.patience = usize::MAX;
        self.grids.is_some()
    }
}

/// How the search for a Newton step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solved {
    /// As exactly as asked.
    Step,
    /// The Hessian curves downwards along the last direction, [`Scratch::search`]: were it upwards
    /// as strongly, the minimum along it would be this multiple away.
    CurvesDown(f64),
}

/// Sets `step` to the Newton step, zero at held nodes, or to what was found of it before the
/// Hessian was found to curve downwards. At the start [`Scratch::search`] is the preconditioned
/// force, and `norm` the product of both.
///
/// # Errors
/// The interrupt that ended it early.
pub(super) fn newton_step<T: Real>(
    equations: &Equations<'_, T>,
    waves: &mut Waves<'_>,
    mut norm: f64,
    step: &mut Field<T>,
    scratch: &mut Scratch<T>,
    stop: Stop,
    meter: &mut Meter<'_>,
) -> Result<Solved, Interrupt> {
    scratch.residual.copy_from(equations.force);
    step.clear();
    if waves.patience == 0 && waves.renew(equations.stiffness) {
        norm = precondition(equations, waves, &scratch.residual, &mut scratch.search);
    }
    let mut enough = (stop.relative * norm).max(stop.absolute);
    let mut left = stop.iterations;
    while norm > enough || norm.is_nan() {
        let most = left.min(waves.patience);
        let mut under_way = UnderWay {
            equations,
            grids: &mut waves.grids,
            step: &mut *step,
            scratch: &mut *scratch,
            enough,
            meter: &mut *meter,
        };
        match iterate(&mut under_way, norm, most)?.1 {
            Ended::CurvesDown(length) => return Ok(Solved::CurvesDown(length)),
            Ended::Near => break,
            Ended::Spent(_) if most == left => break,
            Ended::Spent(last) => {
                left -= most;
                norm = last;
                if waves.renew(equations.stiffness) {
                    // another preconditioner is another norm, and another start
                    let whole =
                        precondition(equations, waves, equations.force, &mut scratch.product);
                    enough = (stop.relative * whole).max(stop.absolute);
                    norm = precondition(equations, waves, &scratch.residual, &mut scratch.search);
                }
            }
        }
    }
    Ok(Solved::Step)
}

/// Iterations towards a step.
struct UnderWay<'e, 'a, 'w, 'm, T> {
    equations: &'e Equations<'a, T>,
    grids: &'e mut Option<Multigrid<'w>>,
    step: &'e mut Field<T>,
    scratch: &'e mut Scratch<T>,
    /// Squared preconditioned norm of the residual at which they end.
    enough: f64,
    meter: &'e mut Meter<'m>,
}

impl<T: Real> Iterated for UnderWay<'_, '_, '_, '_, T> {
    type Interrupt = Interrupt;

    fn apply(&mut self) -> Result<f64, Interrupt> {
        let Equations {
            assembly,
            stiffness,
            team,
            ..
        } = self.equations;
        self.meter.spend(assembly.bonds())?;
        self.meter.work.conjugate_gradient_iterations += 1;
        let Scratch {
            search,
            product,
            spill,
            ..
        } = &mut *self.scratch;
        Ok(stiffness.multiply(assembly, search, product, spill, team))
    }

    fn advance(&mut self, length: f64) -> Option<f64> {
        let Scratch {
            residual,
            search,
            product,
            ..
        } = &mut *self.scratch;
        let (nodes, team) = (self.equations.nodes, self.equations.team);
        let length = T::new(length);
        let mut norm = advance(self.equations, length, search, product, self.step, residual);
        if let Some(grids) = &mut self.grids {
            norm += grids.correct(nodes, residual, product, team);
        }
        (norm > self.enough || norm.is_nan()).then_some(norm)
    }

    fn turn(&mut self, keep: f64) {
        // the product became the preconditioned residual
        let Scratch {
            search, product, ..
        } = &mut *self.scratch;
        turn_to(self.equations, search, T::new(keep), product);
    }
}

/// Places worked on at once: their numbers stay in the core's nearest cache.
const PANEL: usize = 256;

/// Places of a strip, so many at a time, and which they are within the strip.
fn panels(places: Range<usize>) -> impl Iterator<Item = (usize, Range<usize>)> {
    let count = places.len();
    let starts = (0..count).step_by(PANEL);
    starts.map(move |start| (places.start + start, start..(start + PANEL).min(count)))
}

/// Sets `moved` to the preconditioned `residual`; returns their product.
pub(super) fn precondition<T: Real>(
    equations: &Equations<'_, T>,
    waves: &mut Waves<'_>,
    residual: &Field<T>,
    moved: &mut Field<T>,
) -> f64 {
    let Equations {
        assembly,
        nodes,
        team,
        ..
    } = equations;
    let outputs = AtPlaces(moved.components_mut());
    let mut norm = assembly
        .strips
        .sum(team, outputs, |strip, AtPlaces(moved)| {
            let mut norm = 0.0;
            wide(
                #[inline(always)]
                || {
                    for (start, panel) in panels(strip.places.clone()) {
                        let residual = residual.panel(start..start + panel.len());
                        let moved = panel_of(moved, panel);
                        norm += nodes.apply(start, residual, moved);
                    }
                },
            );
            norm
        });
    if let Some(grids) = &mut waves.grids {
        norm += grids.correct(nodes, residual, moved, team);
    }
    norm
}

/// Goes `length` along `search`: updates `step` and `residual` and sets `product`, which was the
/// Hessian's product with `search`, to the preconditioned residual. Returns its squared norm.
fn advance<T: Real>(
    equations: &Equations<'_, T>,
    length: T,
    search: &Field<T>,
    product: &mut Field<T>,
    step: &mut Field<T>,
    residual: &mut Field<T>,
) -> f64 {
    let (assembly, nodes) = (equations.assembly, equations.nodes);
    let outputs = [product, step, residual].map(|field| AtPlaces(field.components_mut()));
    let [product, step, residual] = outputs;
    let outputs = (product, (step, residual));
    assembly.strips.sum(
        equations.team,
        outputs,
        |strip, (AtPlaces(product), (AtPlaces(step), AtPlaces(residual)))| {
            let mut norm = 0.0;
            wide(
                #[inline(always)]
                || {
                    for (start, panel) in panels(strip.places.clone()) {
                        let search = search.panel(start..start + panel.len());
                        let product = panel_of(product, panel.clone());
                        let step = panel_of(step, panel.clone());
                        let residual = panel_of(residual, panel);
                        for axis in 0..3 {
                            add(step[axis], length, search[axis]);
                            add(residual[axis], -length, product[axis]);
                        }
                        let residual = residual.map(
                            #[inline(always)]
                            |component| &*component,
                        );
                        norm += nodes.apply(start, residual, product);
                    }
                },
            );
            norm
        },
    )
}

/// The components over the places of `range`; empty ones stay so.
#[inline(always)]
fn panel_of<'a, T>(components: &'a mut [&mut [T]; 3], range: Range<usize>) -> [&'a mut [T]; 3] {
    components.each_mut().map(
        #[inline(always)]
        |component| component.get_mut(range.clone()).unwrap_or_default(),
    )
}

/// `values` += `factor` `others`.
#[inline(always)]
fn add<T: Real>(values: &mut [T], factor: T, others: &[T]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = factor.mul_add(*other, *value);
    }
}

/// `values` = `others` + `factor` `values`.
fn turn_to<T: Real>(
    equations: &Equations<'_, T>,
    values: &mut Field<T>,
    factor: T,
    others: &Field<T>,
) {
    let outputs = AtPlaces(values.components_mut());
    let strips = &equations.assembly.strips;
    strips.each(equations.team, outputs, |strip, AtPlaces(values)| {
        let others = others.panel(strip.places);
        wide(
            #[inline(always)]
            || {
                for (values, others) in values.iter_mut().zip(others) {
                    for (value, other) in values.iter_mut().zip(others) {
                        *value = factor.mul_add(*value, *other);
                    }
                }
            },
        );
    });
}
