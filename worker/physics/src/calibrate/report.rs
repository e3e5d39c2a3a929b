//! Results of a calibration, and whether to believe them.
use loadframe_api::{Quantity, Report};
use loadframe_harness::{
    ReportBuilder, SimulationError,
    plan::{joint_warnings, mean, values, worst_quality},
};

use super::{
    confidence::{Confidence, LARGEST_CONDITION},
    misfit::means,
    search::StopReason,
    trials::{Best, Trials},
};

/// Part of its range within which a parameter is at the end of it.
const AT_BOUND: f64 = 0.005;

/// The report of a finished calibration.
pub(super) fn report(
    trials: &Trials<'_>,
    best: &Best,
    confidence: &Confidence,
    stop_reason: StopReason,
) -> Result<Report, SimulationError> {
    let reports = best.reports()?;
    let spec = trials.setting.spec;
    let mut report = ReportBuilder::new(stop_reason.name());
    parameters(&mut report, trials, best, confidence);
    fits(&mut report, trials, best, &reports);
    let tests = trials.all().len() * spec.realisations as usize;
    report.count("trials", trials.all().len(), "Sets of parameters tried.");
    report.count("tests", tests, "Specimens tested in all trials.");
    let at_bounds = at_bounds(trials, best);
    checks(&mut report, trials, best, confidence, &at_bounds);
    warn(
        &mut report,
        trials,
        best,
        confidence,
        &at_bounds,
        stop_reason,
    );
    let mut report = report.finish();
    let of_specimens = "The worst of all specimens of the best trial.";
    report.quality.extend(worst_quality(&reports, of_specimens));
    let mut warnings = joint_warnings(spec.seed, "specimens of the best trial", &reports);
    // its results have errors of their own
    warnings.retain(|warning| warning.code != "errors_at_edge");
    report.warnings.extend(warnings);
    report.work = trials.work().clone();
    Ok(report)
}

/// Name of a parameter among results: `/bond/modulus_n` as `bond_modulus_n`.
pub(super) fn name(parameter: &str) -> String {
    let path = parameter.trim_start_matches('/').replace('/', "_");
    path.replace("~1", "/").replace("~0", "~")
}

fn parameters(
    report: &mut ReportBuilder,
    trials: &Trials<'_>,
    best: &Best,
    confidence: &Confidence,
) {
    let setting = trials.setting;
    let found = setting.parameters(&trials.all()[best.trial].point);
    for (index, (free, (parameter, value))) in setting.spec.free.iter().zip(found).enumerate() {
        let own = setting.template.number(parameter);
        let start = free.start.or(own).unwrap_or(f64::NAN);
        let coordinate = setting.coordinates[index];
        let x = trials.all()[best.trial].point[index];
        let half = confidence.half_widths[index];
        let interval = half.map(|half| [x - half, x + half].map(|end| coordinate.value(end)));
        let words = format!("Fitted value of {parameter}; the search started from {start}.");
        let unit = setting.template.unit(parameter).unwrap_or("1");
        let quantity = Quantity {
            interval,
            ..Quantity::new(value, unit, &words)
        };
        report.insert(&name(parameter), quantity);
    }
}

/// What the best trial gives for each measured result, and its residual.
fn fits(report: &mut ReportBuilder, trials: &Trials<'_>, best: &Best, reports: &[Report]) {
    let setting = trials.setting;
    let measured = &setting.spec.measured;
    let residuals = trials.residuals(best.trial);
    let words = "Root mean square of the residuals, a curve counted as one.";
    report.result("misfit", best.misfit, "1", words);
    for (result, residual) in measured.results.iter().zip(&residuals) {
        let own = reports
            .first()
            .and_then(|report| report.summary.get(&result.result));
        let Some(own) = own else {
            continue;
        };
        let mut fitted = mean(own, &values(reports, &result.result));
        fitted.description = match own.unit.as_str() {
            "1" => format!("Measured {}. {}", result.value, own.description),
            unit => format!("Measured {} {unit}. {}", result.value, own.description),
        };
        report.insert(&result.result, fitted);
        let over = match result.deviation {
            Some(_) => "its deviation",
            None => "the measured value",
        };
        let words = format!("Simulated minus measured {}, over {over}.", result.result);
        let name = format!("residual_of_{}", result.result);
        report.result(&name, *residual, "1", &words);
    }
    if let Some(curve) = &measured.curve {
        let words = match &curve.read_as[..] {
            [] => "Points of the measured curve.".to_owned(),
            said => format!(
                "Points of the measured curve, read so: {}.",
                said.join("; ")
            ),
        };
        report.count("measured_points", curve.rows.len(), &words);
        let points = &residuals[measured.results.len()..];
        let square: f64 = points.iter().map(|residual| residual * residual).sum();
        let words = "Root mean square of simulated minus measured ordinates, over the largest \
                     measured one or the deviation.";
        report.result("residual_of_curve", square.sqrt(), "1", words);
    }
}

/// Parameters of the best trial that stand at an end of their range.
fn at_bounds(trials: &Trials<'_>, best: &Best) -> Vec<usize> {
    let point = &trials.all()[best.trial].point;
    let is_at_bound = |index: &usize| {
        let [low, high] = trials.setting.coordinates[*index].range();
        let room = (point[*index] - low).min(high - point[*index]);
        room <= AT_BOUND * (high - low)
    };
    (0..point.len()).filter(is_at_bound).collect()
}

fn checks(
    report: &mut ReportBuilder,
    trials: &Trials<'_>,
    best: &Best,
    confidence: &Confidence,
    at_bounds: &[usize],
) {
    let spec = trials.setting.spec;
    // an exact 0 has no condition; numbers in JSON end somewhere
    let condition = confidence.condition.min(f64::MAX);
    report.check(
        "misfit",
        best.misfit,
        spec.tolerance,
        "1",
        "Root mean square of the residuals; the bound is the tolerance asked for.",
    );
    report.check(
        "condition_index",
        condition,
        LARGEST_CONDITION,
        "1",
        "How nearly two parameters, or a combination of several, do the same to all results.",
    );
    report.check(
        "parameters_without_effect",
        confidence.idle.len() as f64,
        0.0,
        "1",
        "Free parameters that no measured result depends on.",
    );
    report.check(
        "parameters_at_bounds",
        at_bounds.len() as f64,
        0.0,
        "1",
        "Free parameters that stand at an end of their range.",
    );
}

fn warn(
    report: &mut ReportBuilder,
    trials: &Trials<'_>,
    best: &Best,
    confidence: &Confidence,
    at_bounds: &[usize],
    stop_reason: StopReason,
) {
    let setting = trials.setting;
    let spec = setting.spec;
    let named = |indices: &[usize]| {
        let names = indices
            .iter()
            .map(|index| spec.free[*index].parameter.as_str());
        names.collect::<Vec<_>>().join(", ")
    };
    if best.misfit > spec.tolerance {
        let [misfit, tolerance] = [best.misfit, spec.tolerance].map(|m| setting.targets.words(m));
        let worst = worst_result(trials, best)
            .map_or(String::new(), |name| format!("; {name} is farthest off"));
        report.warn(
            "misfit_above_tolerance",
            match stop_reason {
                StopReason::MaxTrials => format!(
                    "the search ended after {} trials with a misfit of {misfit}, above the tolerance of \
                 {tolerance}{worst}: give it more with max_trials, or start from the fitted values",
                    spec.max_trials
                ),
                _ => format!(
                    "no trial nearby has a misfit below {misfit}, above the tolerance of {tolerance}\
                 {worst}: the job cannot give all that was measured, unless other parameters are \
                 free or the start is another; chance is reduced by more realisations"
                ),
            },
        );
    }
    if stop_reason == StopReason::MaxTrials {
        let detail = format!(
            "all {} trials were used before the search ended",
            spec.max_trials
        );
        report.warn("trials_used_up", detail);
    }
    let values = setting.parameters(&trials.all()[best.trial].point);
    for index in at_bounds {
        let free = &spec.free[*index];
        report.warn(
            "parameter_at_bound",
            format!(
                "{} = {} stands at an end of its range, {} … {}: what was measured asks for more than \
             it allows",
                free.parameter, values[*index].1, free.min, free.max
            ),
        );
    }
    if !confidence.idle.is_empty() {
        report.warn(
            "parameter_without_effect",
            format!(
                "no measured result depends on {}: its value means nothing",
                named(&confidence.idle)
            ),
        );
    }
    if !confidence.entangled.is_empty() {
        report.warn(
            "parameters_not_told_apart",
            format!(
                "{} do the same to all that was measured: only a combination of them is known. Fix all \
             but one of them, or measure something else too",
                named(&confidence.entangled)
            ),
        );
    }
    if spec.realisations == 1 {
        let detail = "one realisation says nothing of scatter: intervals know of given deviations \
                      only";
        report.warn("one_realisation", detail.to_owned());
    }
}

/// The measured result that is farthest off, the curve aside.
fn worst_result<'a>(trials: &Trials<'a>, best: &Best) -> Option<&'a str> {
    let results = trials.setting.spec.measured.results.iter();
    let residuals = trials.residuals(best.trial);
    let worst = results
        .zip(residuals)
        .max_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()));
    worst.map(|(result, _)| result.result.as_str())
}

/// The simulated numbers of a trial: means over its specimens.
pub(super) fn fitted(trials: &Trials<'_>, trial: usize) -> Vec<f64> {
    means(&trials.all()[trial].values)
}
