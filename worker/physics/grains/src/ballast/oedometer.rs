//! An oedometer's terms: stress, strain, void ratio, modulus.
//!
//! With the plate's area A, its height h, h₀ where the cycles begin, and the grains' volume V_s:
//! σ = F/A, ε = (h₀ − h)/h₀, e = A h/V_s − 1, and over a step of stress E_oed = Δσ/Δε
//! ([Terzaghi1943]; steps as in ISO 17892-5, each twice the one before).
use loadframe_harness::curve;

use super::heard::{Heard, Row};

/// Steps of stress up to the peak, each twice the one before.
const STEPS: i32 = 6;

/// What an oedometer test says.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Oedometer {
    /// h₀ [m].
    pub(super) height: f64,
    /// e where the cycles begin.
    pub(super) void_ratio: f64,
    /// Of every row of the cycles: σ [Pa], ε, e.
    pub(super) path: Vec<[f64; 3]>,
    pub(super) steps: Vec<Step>,
}

/// A step of stress in the first cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) is_loading: bool,
    /// From and to [Pa].
    pub(super) stresses: [f64; 2],
    /// Void ratios there.
    pub(super) void_ratios: [f64; 2],
    /// E_oed [Pa].
    pub(super) modulus: f64,
}

/// Void ratio of a bed this high [m].
pub(super) fn void_ratio(heard: &Heard<'_>, height: f64) -> f64 {
    heard.script.loaded_area * height / heard.bed_volume() - 1.0
}

/// `None` for tests of another sort.
pub(super) fn of(heard: &Heard<'_>) -> Option<Oedometer> {
    if !heard.script.is_oedometer {
        return None;
    }
    let (rows, (_, height)) = heard.loading();
    let area = heard.script.loaded_area;
    let state = |row: &Row| {
        let strain = row.displacement(height) / height;
        [row.force / area, strain, void_ratio(heard, row.height)]
    };
    let path: Vec<[f64; 3]> = rows.clone().map(state).collect();
    let is_first = |row: &&Row| row.place.is_some_and(|place| place.cycle == 0);
    let first = rows.take_while(is_first).count();
    Some(Oedometer {
        height,
        void_ratio: void_ratio(heard, height),
        steps: steps(&path[..first]),
        path,
    })
}

/// Steps of one cycle's path, up and down.
fn steps(path: &[[f64; 3]]) -> Vec<Step> {
    let stresses: Vec<(f64, f64)> = path.iter().map(|state| (0.0, state[0])).collect();
    let Some(top) = curve::peak(&stresses) else {
        return Vec::new();
    };
    let peak = path[top][0];
    let marks: Vec<f64> = (0..=STEPS)
        .map(|step| peak * 0.5_f64.powi(STEPS - step))
        .collect();
    // ascending in stress, whatever a grain's click takes back
    let rising = |states: &mut dyn Iterator<Item = &[f64; 3]>| {
        let mut kept: Vec<[f64; 3]> = Vec::new();
        for state in states {
            if kept.last().is_none_or(|last| state[0] > last[0]) {
                kept.push(*state);
            }
        }
        kept
    };
    let up = rising(&mut path[..=top].iter());
    let down = rising(&mut path[top..].iter().rev());
    let branch = |states: &[[f64; 3]], is_loading: bool| {
        let at = |stress: f64, column: usize| {
            let points: Vec<(f64, f64)> = states.iter().map(|s| (s[0], s[column])).collect();
            curve::interpolate(&points, stress)
        };
        let step = |pair: &[f64]| {
            let strain = at(pair[1], 1)? - at(pair[0], 1)?;
            let from_to = |pair: [f64; 2]| if is_loading { pair } else { [pair[1], pair[0]] };
            Some(Step {
                is_loading,
                stresses: from_to([pair[0], pair[1]]),
                void_ratios: from_to([at(pair[0], 2)?, at(pair[1], 2)?]),
                modulus: (pair[1] - pair[0]) / strain,
            })
        };
        marks.windows(2).filter_map(step).collect::<Vec<_>>()
    };
    let mut steps = branch(&up, true);
    steps.extend(branch(&down, false).into_iter().rev());
    steps
}
