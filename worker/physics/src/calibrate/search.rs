//! The search for the smallest misfit.
//!
//! First a trust-region Gauss-Newton method within bounds ([BranchColemanLi1999], as `basin` has
//! it): few trials where results follow the parameters smoothly, its derivatives taken over steps
//! long enough to look past single avalanches. Where that ends above the tolerance, BOBYQA
//! ([Powell2009]) goes on from the best trial without derivatives: it models the misfit itself
//! over a region that shrinks to a fraction of those steps.
use std::cell::RefCell;

use basin::{
    Bobyqa, BoxBounds, ConstraintDescription, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, DenseMatrix, Executor, Jacobian, Residual, TerminationCode,
    TrustRegionReflective,
};
use loadframe_harness::SimulationError;

use super::trials::{Halt, Trials};

/// Radius of the first step: a factor of e^0.5 in a parameter on a logarithmic scale, half the range
/// on a linear one.
const FIRST_RADIUS: f64 = 0.5;
/// Steps refused one after another, each a quarter of the last, before derivatives are given up.
const REFUSALS: usize = 4;
/// BOBYQA's first and last radius in steps of the derivatives: from where avalanches no longer hide
/// the slope to where they are all there is.
const RADII: [f64; 2] = [2.0, 0.2];
/// What an unknown misfit counts, in the largest known ones.
const UNKNOWN: f64 = 10.0;

/// How a search came to its end by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopReason {
    ToleranceReached,
    NoDescent,
    MaxTrials,
}

impl StopReason {
    /// The word for programs.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::ToleranceReached => "tolerance_reached",
            Self::NoDescent => "no_further_descent",
            Self::MaxTrials => "max_trials",
        }
    }
}

/// Seeks the best trial, from `start`.
///
/// # Errors
/// An interrupt or what made a result impossible.
pub(super) fn search(trials: &mut Trials<'_>, start: Vec<f64>) -> Result<StopReason, Halt> {
    match descend(trials, start) {
        Ok(()) => Ok(StopReason::NoDescent),
        Err(Halt::Reached) => Ok(StopReason::ToleranceReached),
        Err(Halt::UsedUp) => Ok(StopReason::MaxTrials),
        Err(halt) => Err(halt),
    }
}

fn descend(trials: &mut Trials<'_>, start: Vec<f64>) -> Result<(), Halt> {
    let spec = trials.setting.spec;
    let step = spec.difference_step;
    // a step of the derivatives' length would gain less than a tenth of a misfit at the tolerance
    let quantities = trials.setting.targets.quantities() as f64;
    let gradient = 0.1 * 0.5 * quantities * spec.tolerance.powi(2) / step;
    let solver = TrustRegionReflective::new()
        .with_initial_radius(FIRST_RADIUS)
        .with_max_inner_attempts(REFUSALS)
        .with_absolute_scaled_gradient_tolerance(gradient);
    let result = Executor::from_start(Problem::new(trials), solver, start).run();
    let code = result.map_err(halt)?.report.code();
    if code == TerminationCode::SolverConverged {
        return Ok(());
    }
    let Some(best) = trials.best().map(|best| best.trial) else {
        return Ok(());
    };
    let best = trials.all()[best].point.clone();
    let solver = Bobyqa::new()
        .with_initial_radius(RADII[0] * step)
        .with_final_radius(RADII[1] * step);
    let result = Executor::from_start(Problem::new(trials), solver, best).run();
    result.map(|_| ()).map_err(halt)
}

fn halt(error: ConstraintSolveError<Halt>) -> Halt {
    match error {
        ConstraintSolveError::Evaluation(halt) => halt,
        error => Halt::Failed(SimulationError::Calibration(format!("{error:?}"))),
    }
}

/// The residuals of trials, as the solvers ask for them.
struct Problem<'a, 'b> {
    trials: RefCell<&'a mut Trials<'b>>,
    low: Vec<f64>,
    high: Vec<f64>,
    steps: Vec<f64>,
}

impl<'a, 'b> Problem<'a, 'b> {
    fn new(trials: &'a mut Trials<'b>) -> Self {
        let coordinates = trials.setting.coordinates;
        let step = trials.setting.spec.difference_step;
        let end = |index: usize| coordinates.iter().map(move |c| c.range()[index]).collect();
        Self {
            low: end(0),
            high: end(1),
            steps: coordinates.iter().map(|c| c.difference(step)).collect(),
            trials: RefCell::new(trials),
        }
    }

    /// `point` with one coordinate moved by a step, forward where the range allows it, or the other way.
    fn moved(&self, point: &[f64], index: usize, forward: bool) -> Vec<f64> {
        let mut moved = point.to_vec();
        let fits = point[index] + self.steps[index] <= self.high[index];
        let sign = if fits == forward { 1.0 } else { -1.0 };
        let end = point[index] + sign * self.steps[index];
        moved[index] = end.clamp(self.low[index], self.high[index]);
        moved
    }
}

impl Constraints for Problem<'_, '_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.low), Some(&self.high)))
    }
}

impl Residual for Problem<'_, '_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Halt;

    fn residual(&self, point: &Vec<f64>) -> Result<Vec<f64>, Halt> {
        let mut trials = self.trials.borrow_mut();
        let found = trials.at(std::slice::from_ref(point))?;
        Ok(trials.residuals(found[0]))
    }
}

impl Jacobian for Problem<'_, '_> {
    type Jacobian = DenseMatrix;

    /// Differences over one step, all parameters side by side. A parameter whose step leads to
    /// where a result is unknown is stepped the other way; where that fails too, its column is 0
    /// and it stays as it is for now.
    fn jacobian(&self, point: &Vec<f64>) -> Result<DenseMatrix, Halt> {
        let mut trials = self.trials.borrow_mut();
        let count = point.len();
        let mut moved: Vec<Vec<f64>> = (0..count).map(|i| self.moved(point, i, true)).collect();
        let mut points = vec![point.clone()];
        points.extend(moved.iter().cloned());
        let found = trials.at(&points)?;
        let centre = trials.residuals(found[0]);
        let mut sides: Vec<Vec<f64>> = found[1..].iter().map(|t| trials.residuals(*t)).collect();
        for index in 0..count {
            if sides[index].iter().any(|residual| residual.is_nan()) {
                moved[index] = self.moved(point, index, false);
                let found = trials.at(std::slice::from_ref(&moved[index]))?;
                sides[index] = trials.residuals(found[0]);
            }
        }
        let entry = |row: usize, column: usize| {
            let step = moved[column][column] - point[column];
            let slope = (sides[column][row] - centre[row]) / step;
            if slope.is_finite() { slope } else { 0.0 }
        };
        let rows = 0..centre.len();
        let entries = rows.flat_map(|row| (0..count).map(move |column| (row, column)));
        let entries: Vec<f64> = entries.map(|(row, column)| entry(row, column)).collect();
        Ok(DenseMatrix::from_row_slice(centre.len(), count, &entries))
    }

    /// Both at once, so that the first trial and its derivatives are tested side by side.
    fn residual_and_jacobian(&self, point: &Vec<f64>) -> Result<(Vec<f64>, DenseMatrix), Halt> {
        let jacobian = self.jacobian(point)?;
        Ok((self.residual(point)?, jacobian))
    }
}

impl CostFunction for Problem<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Halt;

    /// ½ Σ r². Where it is unknown, more than any that is known, so that the model leads away.
    fn cost(&self, point: &Vec<f64>) -> Result<f64, Halt> {
        let squares = |residuals: Vec<f64>| 0.5 * residuals.iter().map(|r| r * r).sum::<f64>();
        let mut trials = self.trials.borrow_mut();
        let found = trials.at(std::slice::from_ref(point))?[0];
        let cost = squares(trials.residuals(found));
        if cost.is_finite() {
            return Ok(cost);
        }
        // trials after this one may be known from a checkpoint, and must not count
        let known = (0..found).map(|trial| squares(trials.residuals(trial)));
        let largest = known.filter(|cost| cost.is_finite()).fold(0.0, f64::max);
        Ok(UNKNOWN * largest)
    }
}
