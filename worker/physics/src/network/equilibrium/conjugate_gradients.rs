//! Preconditioned conjugate gradients for the Newton step H d = F.
use crate::wide::wide;

use super::{block_jacobi::BlockJacobi, work::Meter};
use crate::{
    Interrupt,
    network::{
        assembly::Assembly,
        field::{Field, Real},
        stiffness::Stiffness,
    },
};

/// Memory that steps use one after the other.
#[derive(Debug)]
pub(super) struct Scratch<T> {
    residual: Field<T>,
    search: Field<T>,
    product: Field<T>,
}

impl<T: Real> Scratch<T> {
    pub(super) fn new(assembly: &Assembly) -> Self {
        let zeros = Field::zeros(assembly.nodes(), assembly.dimensions());
        Self {
            residual: zeros.clone(),
            search: zeros.clone(),
            product: zeros,
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
    pub(super) preconditioner: &'a BlockJacobi<T>,
    /// F, zero at held nodes.
    pub(super) force: &'a Field<T>,
}

/// Sets `step` to the Newton step, zero at held nodes. Returns false when the Hessian was found to
/// curve downwards; `step` then is what was found before.
///
/// # Errors
/// The interrupt that ended it early.
pub(super) fn newton_step<T: Real>(
    equations: &Equations<'_, T>,
    step: &mut Field<T>,
    scratch: &mut Scratch<T>,
    stop: Stop,
    meter: &mut Meter<'_>,
) -> Result<bool, Interrupt> {
    let Equations {
        assembly,
        stiffness,
        preconditioner,
        force,
    } = equations;
    let Scratch {
        residual,
        search,
        product,
    } = scratch;
    residual.copy_from(force);
    step.clear();
    let mut norm = preconditioner.apply(residual, search);
    let enough = (stop.relative * norm).max(stop.absolute);
    for _ in 0..stop.iterations {
        if norm <= enough {
            break;
        }
        meter.spend(assembly.bonds())?;
        meter.work.conjugate_gradient_iterations += 1;
        stiffness.multiply(assembly, search, product);
        let curvature = wide(
            #[inline(always)]
            || search.dot(product, assembly.free()),
        );
        if curvature.is_nan() || curvature <= 0.0 {
            return Ok(false);
        }
        let length = norm / curvature;
        wide(
            #[inline(always)]
            || {
                add(step, T::new(length), search);
                add(residual, T::new(-length), product);
            },
        );
        // the product is used up: its place serves for the preconditioned residual
        let next_norm = preconditioner.apply(residual, product);
        let turn = T::new(next_norm / norm);
        norm = next_norm;
        wide(
            #[inline(always)]
            || turn_to(search, turn, product),
        );
    }
    Ok(true)
}

/// `values` += `factor` `others`.
#[inline(always)]
fn add<T: Real>(values: &mut Field<T>, factor: T, others: &Field<T>) {
    let pairs = values.components_mut().into_iter().zip(others.components());
    for (values, others) in pairs {
        for (value, other) in values.iter_mut().zip(others) {
            *value += factor * *other;
        }
    }
}

/// `values` = `others` + `factor` `values`.
#[inline(always)]
fn turn_to<T: Real>(values: &mut Field<T>, factor: T, others: &Field<T>) {
    let pairs = values.components_mut().into_iter().zip(others.components());
    for (values, others) in pairs {
        for (value, other) in values.iter_mut().zip(others) {
            *value = *other + factor * *value;
        }
    }
}
