//! The files a calibration leaves behind.
use std::io::{self, Write};

use loadframe_harness::{Recorder, csv, plan::Curve, statistics::Sample};
use serde_json::json;

use super::{
    report::{fitted, name},
    trials::{Best, Trials},
};

/// Gives the best curve and all tables to the recorder.
pub(super) fn write(trials: &mut Trials<'_>, best: &Best) -> io::Result<()> {
    let history = history(trials);
    let fit = fit(trials, best.trial);
    let fit_curve = fit_curve(trials, best.trial);
    let job = fitted_job(trials, best.trial)?;
    let recorder = trials.recorder();
    curve(&best.curve, recorder)?;
    let mut file = |name: &str, bytes: &[u8]| recorder.file(name, &mut |out| out.write_all(bytes));
    file("trials.csv", &history?)?;
    file("fit.csv", &fit?)?;
    if let Some(fit_curve) = fit_curve {
        file("fit_curve.csv", &fit_curve?)?;
    }
    file("fitted.json", &job)
}

/// The curve of the best trial's first specimen, as the job's own.
fn curve(curve: &Curve, recorder: &mut dyn Recorder) -> io::Result<()> {
    if curve.columns.is_empty() {
        return Ok(());
    }
    let columns: Vec<&str> = curve.columns.iter().map(String::as_str).collect();
    recorder.columns(&columns)?;
    for point in curve.rows() {
        recorder.point(point)?;
    }
    recorder.file("curve.csv", &mut |out| {
        csv::header(out, &columns)?;
        curve.rows().try_for_each(|point| csv::row(out, point))
    })
}

/// Every trial in the order in which it was asked for, the derivatives around the best one last:
/// parameters, means of the measured results, misfit.
fn history(trials: &Trials<'_>) -> io::Result<Vec<u8>> {
    let spec = trials.setting.spec;
    let parameters = spec.free.iter().map(|free| name(&free.parameter));
    let results = spec
        .measured
        .results
        .iter()
        .map(|result| result.result.clone());
    let names: Vec<String> = std::iter::once("trial".to_owned())
        .chain(parameters)
        .chain(results)
        .chain(["misfit".to_owned()])
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut out = Vec::new();
    csv::header(&mut out, &names)?;
    for (index, trial) in trials.all().iter().enumerate() {
        let mut row = vec![(index + 1) as f64];
        let parameters = trials.setting.parameters(&trial.point);
        row.extend(parameters.iter().map(|(_, value)| value));
        row.extend(
            fitted(trials, index)
                .iter()
                .take(spec.measured.results.len()),
        );
        row.push(trials.misfit(index));
        csv::row(&mut out, &row)?;
    }
    Ok(out)
}

/// Measured and fitted results side by side.
fn fit(trials: &Trials<'_>, best: usize) -> io::Result<Vec<u8>> {
    let mut out = Vec::new();
    let columns = [
        "result",
        "measured",
        "fitted",
        "fitted_deviation",
        "residual",
    ];
    csv::header(&mut out, &columns)?;
    let residuals = trials.residuals(best);
    let means = fitted(trials, best);
    let results = trials.setting.spec.measured.results.iter().enumerate();
    for (index, result) in results {
        let values = trials.all()[best].values.iter();
        let values: Vec<f64> = values.map(|values| values[index]).collect();
        let deviation = Sample::of(&values).and_then(|sample| sample.deviation);
        write!(out, "{},", result.result)?;
        let deviation = deviation.unwrap_or(f64::NAN);
        csv::row(
            &mut out,
            &[result.value, means[index], deviation, residuals[index]],
        )?;
    }
    Ok(out)
}

/// The measured curve beside the mean of the simulated ones.
fn fit_curve(trials: &Trials<'_>, best: usize) -> Option<io::Result<Vec<u8>>> {
    let measured = &trials.setting.spec.measured;
    let curve = measured.curve.as_ref()?;
    let means = fitted(trials, best);
    let means = &means[measured.results.len()..];
    Some((|| {
        let mut out = Vec::new();
        csv::header(&mut out, &["abscissa", "measured", "fitted"])?;
        for ([x, y], mean) in curve.rows.iter().zip(means) {
            csv::row(&mut out, &[*x, *y, *mean])?;
        }
        Ok(out)
    })())
}

/// The inner job with the fitted parameters, ready to be posted.
fn fitted_job(trials: &Trials<'_>, best: usize) -> io::Result<Vec<u8>> {
    let setting = trials.setting;
    let parameters = setting.parameters(&trials.all()[best].point);
    let found: Vec<String> = parameters
        .iter()
        .map(|(parameter, value)| format!("{parameter} = {value}"))
        .collect();
    let job = json!({
        "kind": setting.spec.job.kind,
        "name": "Fitted parameters",
        "notes": format!("Fitted: {}.", found.join(", ")),
        "spec": setting.template.with(&parameters),
    });
    let mut bytes = serde_json::to_vec_pretty(&job)?;
    bytes.push(b'\n');
    Ok(bytes)
}
