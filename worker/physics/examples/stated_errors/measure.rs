//! From runs of drawn jobs to a table of errors.
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use loadframe_api::Report;
use serde_json::{Value, json};

use crate::kept::report;
use crate::run::value;
use crate::sort::Sort;

/// Part of the jobs that stay below twice an error, at least.
const QUANTILE: f64 = 0.95;

/// What `work` finds for each seed, on as many threads as are given, in the order of the seeds.
pub(crate) fn for_each<T: Send>(
    seeds: Range<u64>,
    threads: u64,
    work: impl Fn(u64) -> T + Sync,
) -> Vec<T> {
    let next = AtomicU64::new(seeds.start);
    let found = Mutex::new(BTreeMap::new());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds.end {
                        return;
                    }
                    let one = work(seed);
                    if let Ok(mut found) = found.lock() {
                        found.insert(seed, one);
                        eprintln!("{} of {}", found.len(), seeds.end - seeds.start);
                    }
                }
            });
        }
    });
    let found = found.into_inner().unwrap_or_default();
    found.into_values().collect()
}

/// Relative errors of the results of one job.
type Errors = BTreeMap<&'static str, f64>;

/// What one job told: its errors at every level of each knob but the finest, and at each preset.
struct Told {
    levels: Vec<Vec<Errors>>,
    presets: Vec<(Vec<f64>, Errors)>,
    traits: Vec<(&'static str, f64)>,
}

/// Over the result itself, or the job's scale.
fn errors(sort: &dyn Sort, seed: u64, coarse: &Report, finest: &Report) -> Errors {
    let scale = sort.scale(seed);
    let relative = |name: &&'static str| {
        let (coarse, finest) = value(coarse, name).zip(value(finest, name))?;
        let size = scale.unwrap_or(coarse).abs();
        Some((*name, (coarse - finest).abs() / size))
    };
    sort.results().iter().filter_map(relative).collect()
}

/// `None` where a run of the job has no result.
fn told(sort: &dyn Sort, seed: u64) -> Option<Told> {
    let run = |setting: &[f64]| report(&sort.job(seed, setting));
    let mut levels = Vec::new();
    for (index, knob) in sort.knobs().iter().enumerate() {
        let with = |value: f64| {
            let mut setting = sort.base();
            setting[index] = value;
            run(&setting)
        };
        let (finest, coarser) = knob.levels.split_last()?;
        let finest = with(*finest)?;
        let coarser = coarser
            .iter()
            .map(|value| Some(errors(sort, seed, &with(*value)?, &finest)));
        levels.push(coarser.collect::<Option<Vec<_>>>()?);
    }
    let finest = run(&sort.finest())?;
    let presets = sort.presets(seed).into_iter().map(|setting| {
        let errors = errors(sort, seed, &run(&setting)?, &finest);
        Some((setting, errors))
    });
    Some(Told {
        levels,
        presets: presets.collect::<Option<_>>()?,
        traits: sort.traits(seed, &finest),
    })
}

/// The table of a sort of jobs.
pub(crate) fn table(sort: &dyn Sort, kind: &str, seeds: Range<u64>, threads: u64) -> Value {
    let specs = seeds.end - seeds.start;
    let told = for_each(seeds.clone(), threads, |seed| (seed, told(sort, seed)));
    for (seed, told) in &told {
        if told.is_none() {
            eprintln!("the job of seed {seed} has no result");
        }
    }
    let mut range = BTreeMap::<&str, [f64; 2]>::new();
    let told: Vec<Told> = told.into_iter().filter_map(|(_, told)| told).collect();
    for (name, value) in told.iter().flat_map(|told| &told.traits) {
        let bounds = range.entry(name).or_insert([*value, *value]);
        *bounds = [bounds[0].min(*value), bounds[1].max(*value)];
    }
    let mut sources = rows(sort, &told);
    for name in sort.results() {
        let factor = factor(sort, name, &sources, &told);
        eprintln!("{name}: errors of single knobs times {factor:.2} hold at the presets");
        let levels = sources.iter_mut().flat_map(|(_, levels)| levels);
        for error in levels.filter_map(|(_, errors)| errors.get_mut(name)) {
            *error = three_digits(*error * factor.max(1.0));
        }
    }
    let sources = sources.into_iter().map(|(source, levels)| {
        let levels: Vec<Value> = levels
            .into_iter()
            .map(|(at, errors)| json!({"at": at, "errors": errors}))
            .collect();
        (source.to_owned(), Value::from(levels))
    });
    json!({
        "measured_by": format!("stated_errors measure {kind} {specs}"),
        "range": range,
        "sources": sources.collect::<serde_json::Map<_, _>>(),
    })
}

/// By source: its levels, the coarsest first, with the errors of all jobs there.
type Rows = Vec<(&'static str, Vec<(f64, Errors)>)>;

/// A coarser level has at least the error of the next finer, which chance may have made the larger. A
/// source says nothing of results that it does not touch.
fn rows(sort: &dyn Sort, told: &[Told]) -> Rows {
    let rows = sort
        .knobs()
        .into_iter()
        .enumerate()
        .map(|(knob, description)| {
            let mut finer = Errors::new();
            let mut levels = Vec::new();
            let coarser = &description.levels[..description.levels.len() - 1];
            for (level, at) in coarser.iter().enumerate().rev() {
                for name in sort.results() {
                    let all = told.iter().map(|told| &told.levels[knob][level]);
                    let all: Vec<f64> =
                        all.filter_map(|errors| errors.get(name).copied()).collect();
                    let least = finer.entry(name).or_default();
                    *least = least.max(error(&all));
                }
                levels.push((*at, finer.clone()));
            }
            for name in sort.results() {
                if levels.iter().all(|(_, errors)| errors[name] == 0.0) {
                    levels.iter_mut().for_each(|(_, errors)| {
                        errors.remove(name);
                    });
                }
            }
            levels.reverse();
            (description.source, levels)
        });
    rows.collect()
}

/// By what the errors of the knobs, taken as independent, must be multiplied to hold for the presets.
fn factor(sort: &dyn Sort, name: &str, sources: &Rows, told: &[Told]) -> f64 {
    let knobs = sort.knobs();
    let apart = |(setting, errors): &(Vec<f64>, Errors)| {
        let parts = knobs.iter().zip(sources).zip(setting);
        let squares = parts.filter_map(|((knob, (_, levels)), value)| {
            let falls = knob.levels.first() > knob.levels.last();
            let is_coarse = |at: f64| if falls { at >= *value } else { at <= *value };
            let level = levels.iter().rev().find(|(at, _)| is_coarse(*at))?;
            Some(level.1.get(name)?.powi(2))
        });
        Some(0.5 * errors.get(name)? / squares.sum::<f64>().sqrt())
    };
    let all = told.iter().flat_map(|told| &told.presets);
    most(&all.filter_map(apart).collect::<Vec<f64>>())
}

/// The root mean square, or half of what most stay below where that is more.
fn error(all: &[f64]) -> f64 {
    let squares: f64 = all.iter().map(|error| error * error).sum();
    (squares / all.len() as f64).sqrt().max(0.5 * most(all))
}

/// What most stay below.
fn most(all: &[f64]) -> f64 {
    let mut sorted = all.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (QUANTILE * all.len() as f64).ceil() as usize;
    let last = place.clamp(1, all.len().max(1)) - 1;
    sorted.get(last).copied().unwrap_or(f64::NAN)
}

fn three_digits(error: f64) -> f64 {
    format!("{error:.2e}").parse().unwrap_or(error)
}
