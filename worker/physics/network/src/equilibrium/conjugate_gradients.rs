//! Preconditioned conjugate gradients for the Newton step H d = F.
use std::ops::Range;

use loadframe_harness::Interrupt;
use loadframe_numerics::{Team, wide};

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

    /// After so many iterations of a step: whether the preconditioner changed.
    fn look<T: Real>(&mut self, iterations: usize, stiffness: &Stiffness<T>) -> bool {
        if iterations < self.patience {
            return false;
        }
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
    let Equations {
        assembly,
        stiffness,
        force,
        team,
        ..
    } = equations;
    let Scratch {
        residual,
        search,
        product,
        spill,
    } = scratch;
    residual.copy_from(force);
    step.clear();
    if waves.look(0, stiffness) {
        norm = precondition(equations, waves, residual, search);
    }
    let mut enough = (stop.relative * norm).max(stop.absolute);
    for iteration in 0..stop.iterations {
        if norm <= enough {
            break;
        }
        if waves.look(iteration, stiffness) {
            // another preconditioner is another norm, and another start
            let whole = precondition(equations, waves, force, product);
            enough = (stop.relative * whole).max(stop.absolute);
            norm = precondition(equations, waves, residual, search);
        }
        meter.spend(assembly.bonds())?;
        meter.work.conjugate_gradient_iterations += 1;
        let curvature = stiffness.multiply(assembly, search, product, spill, team);
        if curvature.is_nan() || curvature <= 0.0 {
            return Ok(Solved::CurvesDown(norm / curvature.abs()));
        }
        let length = T::new(norm / curvature);
        let mut next_norm = advance(equations, length, search, product, step, residual);
        if let Some(grids) = &mut waves.grids {
            next_norm += grids.correct(equations.nodes, residual, product, team);
        }
        let turn = T::new(next_norm / norm);
        norm = next_norm;
        // the product became the preconditioned residual
        turn_to(equations, search, turn, product);
    }
    Ok(Solved::Step)
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
