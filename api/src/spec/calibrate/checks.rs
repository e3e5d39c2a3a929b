//! What the JSON Schema cannot say: a job that is valid wherever its parameters may go, and
//! measurements it can be held against.
use super::{Calibrate, CurveReading, FreeParameter, Measured, MeasuredResult, Scale, Template};
use crate::spec::repeats::check_seeds;
use crate::{JobKind, JobSpec, Violation, Violations, result_names, result_units};

/// Points of a measured curve, as many as `rows` may have.
const MOST_POINTS: usize = 100_000;
/// Bytes that are read to check one job, at most.
const MOST_READ: usize = 16 << 20;
/// Parameters named where one is unknown.
const LISTED: usize = 30;

pub(super) fn check(spec: &Calibrate, violations: &mut Violations) {
    check_counts(spec, violations);
    if spec.job.kind == JobKind::Calibrate {
        let violation = Violation::new(
            "/job/kind",
            "not_allowed",
            "a calibration cannot be calibrated",
        );
        violations.push(violation.value("calibrate").allowed("every other kind"));
        check_measured(&spec.measured, None, violations);
        return;
    }
    if let Some(violation) = check_length(spec) {
        violations.push(violation);
        return;
    }
    check_measured(&spec.measured, spec.job.read().ok().as_ref(), violations);
    match Template::new(&spec.job) {
        Ok(template) => check_free(spec, &template, violations),
        Err(inner) => violations.extend(inner.into_iter().map(|mut violation| {
            violation.pointer.insert_str(0, "/job");
            violation
        })),
    }
}

/// The job is read anew at the start and with each parameter at each end of its range, which takes no
/// longer than a body of the largest size does.
fn check_length(spec: &Calibrate) -> Option<Violation> {
    let readings = 2 + 2 * spec.free.len();
    let (length, most) = (spec.job.spec.as_str().len(), MOST_READ / readings);
    (length > most).then(|| {
        let detail = format!("the job is too long to be read {readings} times over");
        Violation::new("/job/spec", "too_large", detail)
            .value(length)
            .allowed(format!("at most {most} bytes with so many free parameters"))
    })
}

fn check_counts(spec: &Calibrate, violations: &mut Violations) {
    let fewest = spec.fewest_trials();
    if spec.max_trials < fewest {
        let detail = "the search for this many parameters needs more trials";
        let violation = Violation::new("/max_trials", "out_of_range", detail);
        violations.push(
            violation
                .value(spec.max_trials)
                .allowed(format!("≥ {fewest}")),
        );
    }
    violations.extend(check_seeds(spec.seed, spec.realisations, "realisations"));
}

fn check_free(spec: &Calibrate, template: &Template, violations: &mut Violations) {
    let before = violations.count();
    for (index, free) in spec.free.iter().enumerate() {
        let place = format!("/free/{index}");
        let mut earlier = spec.free[..index].iter();
        if earlier.any(|other| other.parameter == free.parameter) {
            let pointer = format!("{place}/parameter");
            let detail = "this parameter is given more than once";
            let violation = Violation::new(pointer, "not_unique", detail);
            violations.push(violation.value(free.parameter.as_str()));
        }
        match template.number(&free.parameter) {
            Some(own) => check_range(&place, free, own, template, violations),
            None => violations.push(no_parameter(&place, free, template)),
        }
    }
    if violations.count() == before {
        check_corners(spec, template, violations);
    }
}

fn no_parameter(place: &str, free: &FreeParameter, template: &Template) -> Violation {
    let known = template.numbers(LISTED);
    Violation::new(
        format!("{place}/parameter"),
        "not_allowed",
        "this names no number in the job's spec; whole numbers cannot be free",
    )
    .value(free.parameter.as_str())
    .allowed(format!("a pointer to a number: {}", known.join(", ")))
}

fn check_range(
    place: &str,
    free: &FreeParameter,
    own: f64,
    template: &Template,
    violations: &mut Violations,
) {
    let unit = template.unit(&free.parameter);
    let mut refuse = |field: &str, detail: &str, value: f64, allowed: String| {
        let violation = Violation::new(format!("{place}/{field}"), "out_of_range", detail);
        let violation = violation.value(value).allowed(allowed);
        violations.push(match unit {
            Some(unit) => violation.unit(unit),
            None => violation,
        });
    };
    let (min, max) = (free.min, free.max);
    if min >= max {
        refuse("max", "no room is left above min", max, format!("> {min}"));
    } else if free.scale == Scale::Log && min <= 0.0 {
        let detail = "a logarithmic scale has no 0; choose \"linear\" or a larger min";
        refuse("min", detail, min, "> 0".to_owned());
    } else if !(min..=max).contains(&free.start.unwrap_or(own)) {
        let detail = match free.start {
            Some(_) => "the search cannot start outside its range",
            None => "left out, it is the job's own value, which lies outside the range",
        };
        let start = free.start.unwrap_or(own);
        refuse("start", detail, start, format!("{min} … {max}"));
    }
}

/// The job must be valid at the start and with each parameter at each end of its range.
fn check_corners(spec: &Calibrate, template: &Template, violations: &mut Violations) {
    let start = |free: &FreeParameter| free.start.or_else(|| template.number(&free.parameter));
    let base: Vec<(&str, f64)> = spec
        .free
        .iter()
        .map(|free| (free.parameter.as_str(), start(free).unwrap_or(free.min)))
        .collect();
    if let Err(found) = template.job(&base) {
        violations.extend(found.iter().map(|inner| at_value(spec, &base, inner, None)));
        return;
    }
    for (index, free) in spec.free.iter().enumerate() {
        for (field, value) in [("min", free.min), ("max", free.max)] {
            let mut numbers = base.clone();
            numbers[index].1 = value;
            if let Err(found) = template.job(&numbers) {
                let place = Some((index, field));
                let found = found.iter();
                violations.extend(found.map(|inner| at_value(spec, &numbers, inner, place)));
            }
        }
    }
}

/// A violation of the inner job, said of the value that led to it.
fn at_value(
    spec: &Calibrate,
    numbers: &[(&str, f64)],
    inner: &Violation,
    place: Option<(usize, &str)>,
) -> Violation {
    let own = |(parameter, _): &(&str, f64)| inner.pointer == format!("/spec{parameter}");
    let index = place.map(|(index, _)| index);
    let index = index.or_else(|| numbers.iter().position(own)).unwrap_or(0);
    let field = place.map_or("start", |(_, field)| field);
    let parameter = &spec.free[index].parameter;
    let detail = if inner.pointer == format!("/spec{parameter}") {
        inner.detail.clone()
    } else {
        format!(
            "with {parameter} = {} the job cannot be accepted: {}: {}",
            numbers[index].1, inner.pointer, inner.detail
        )
    };
    Violation {
        allowed: inner.allowed.clone(),
        unit: inner.unit.clone(),
        ..Violation::new(format!("/free/{index}/{field}"), &inner.code, detail)
    }
    .value(numbers[index].1)
}

fn check_measured(measured: &Measured, job: Option<&JobSpec>, violations: &mut Violations) {
    if measured.results.is_empty() && measured.curve.is_none() {
        let detail = "nothing was measured";
        let violation = Violation::new("/measured", "missing_field", detail);
        violations.push(violation.allowed("results, a curve, or both"));
    }
    for (index, result) in measured.results.iter().enumerate() {
        let place = format!("/measured/results/{index}");
        let mut earlier = measured.results[..index].iter();
        if earlier.any(|other| other.result == result.result) {
            let detail = "this result is given more than once";
            let violation = Violation::new(format!("{place}/result"), "not_unique", detail);
            violations.push(violation.value(result.result.as_str()));
        }
        if result.value == 0.0 && result.deviation.is_none() {
            let detail = "differences cannot be told as parts of 0; give a deviation";
            violations.push(no_scale(format!("{place}/deviation"), detail));
        }
        if let Some(job) = job {
            check_result(index, result, job, violations);
        }
    }
    let Some(curve) = &measured.curve else {
        return;
    };
    if curve.csv.is_some() != curve.rows.is_empty() {
        let detail = "a curve is given as rows or as text";
        let violation = Violation::new("/measured/curve", "not_allowed", detail);
        violations.push(violation.allowed("rows or csv, one of them"));
        return;
    }
    if let (None, Some(_)) = (&curve.csv, &curve.reading) {
        let detail = "rows are not read from text";
        let violation = Violation::new("/measured/curve/reading", "not_together", detail);
        violations.push(violation.allowed("reading beside csv"));
    }
    if let Some(reading) = &curve.reading {
        check_reading(reading, violations);
    }
    let points = job.map(|job| match &curve.csv {
        Some(text) => curve.read(text, job).map(|reading| reading.points),
        None => curve.wanted(job).map(|_| curve.rows.clone()),
    });
    match points {
        Some(Err(mut violation)) => {
            violation.pointer.insert_str(0, "/measured/curve");
            violations.push(violation);
        }
        Some(Ok(points)) if points.len() > MOST_POINTS => {
            let detail = "the text has too many points";
            let violation = Violation::new("/measured/curve/csv", "wrong_length", detail);
            violations.push(
                violation
                    .value(points.len())
                    .allowed(format!("at most {MOST_POINTS}")),
            );
        }
        Some(Ok(points)) if curve.deviation.is_none() && points.iter().all(|[_, y]| *y == 0.0) => {
            let detail = "all ordinates are 0; give a deviation";
            violations.push(no_scale("/measured/curve/deviation".to_owned(), detail));
        }
        // without a valid job nothing is known of its columns
        None | Some(Ok(_)) => {}
    }
}

/// A result must be one that the job may have, in its unit.
fn check_result(index: usize, result: &MeasuredResult, job: &JobSpec, violations: &mut Violations) {
    let units = result_units(job.kind(), &result.result);
    let place = format!("/measured/results/{index}");
    if units.is_empty() {
        let detail = format!("a {} has no result of this name", job.kind());
        let violation = Violation::new(format!("{place}/result"), "not_allowed", detail);
        let allowed = format!("one of: {}", result_names(job.kind()).join(", "));
        violations.push(violation.value(result.result.as_str()).allowed(allowed));
    } else if let Some(unit) = result.unit.as_deref().filter(|unit| !units.contains(unit)) {
        let detail = format!("{} is given in another unit", result.result);
        let violation = Violation::new(format!("{place}/unit"), "not_allowed", detail);
        violations.push(violation.value(unit).allowed(units.join(" or ")));
    }
}

fn check_reading(reading: &CurveReading, violations: &mut Violations) {
    if let Some([low, high]) = reading.slack_between
        && low >= high
    {
        let detail = "no part of the curve lies between these ordinates";
        let violation = Violation::new(
            "/measured/curve/reading/slack_between",
            "out_of_range",
            detail,
        );
        violations.push(
            violation
                .value(vec![low, high])
                .allowed("the smaller first"),
        );
    }
    if reading.slack_between.is_some() && reading.preload.is_some() {
        let detail = "both say where the abscissa begins to count";
        let violation = Violation::new("/measured/curve/reading/preload", "not_together", detail);
        violations.push(violation.allowed("preload or slack_between, one of them"));
    }
}

fn no_scale(pointer: String, detail: &str) -> Violation {
    Violation::new(pointer, "missing_field", detail).allowed("> 0")
}
