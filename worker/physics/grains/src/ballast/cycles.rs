//! What happens in each cycle of loading.
use loadframe_api::spec::ballast::Script;
use loadframe_harness::curve;

use super::heard::Heard;

/// Parts of a cycle's peak force between which the unloading branch is fitted by a straight line: its
/// beginning is still rounded by what creeps, its end by what opens.
const FITTED: [f64; 2] = [0.5, 0.9];
/// A hair of a cycle that round-off may take.
const HAIR: f64 = 1e-9;

/// A cycle. Displacements are downward from where the cycles began.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Cycle {
    /// At its start, at its deepest, at its end [m].
    pub(super) start: f64,
    pub(super) peak: f64,
    pub(super) end: f64,
    /// Largest force [N].
    pub(super) peak_force: f64,
    /// Slope of the unloading branch [N/m], if enough of it is known.
    pub(super) unloading_stiffness: Option<f64>,
    /// Peak force over the way to the deepest point [N/m].
    pub(super) loading_stiffness: Option<f64>,
    /// Work of the force that does not come back [J].
    pub(super) dissipated: f64,
}

/// Number of the cycle, from 0, that a time [s] after the start belongs to, and the part of it that
/// has passed. The end of a cycle belongs to it.
pub(super) fn place_in_cycles(script: &Script, time: f64) -> (usize, f64) {
    let passed = time / script.period;
    // the last step may go a little beyond the end
    let last = f64::from(script.cycles) - 1.0;
    let number = (passed - HAIR).floor().clamp(0.0, last);
    (number as usize, passed - number)
}

/// All cycles of a test.
pub(super) fn of(heard: &Heard<'_>) -> Vec<Cycle> {
    let (rows, start) = heard.loading();
    let mut cycles: Vec<Vec<(f64, f64, f64)>> = Vec::new();
    let before = heard.last_before_loading();
    let mut last = before.map_or((0.0, 0.0), |row| (0.0, row.force));
    for row in rows {
        let (number, part) = place_in_cycles(heard.script, row.time - start.0);
        while cycles.len() <= number {
            // a cycle begins where the one before it ended
            cycles.push(vec![(0.0, last.0, last.1)]);
        }
        last = (start.1 - row.height, row.force);
        cycles[number].push((part, last.0, last.1));
    }
    cycles.iter().map(|points| cycle(points)).collect()
}

/// A cycle of points: part of the cycle, displacement [m], force [N].
fn cycle(points: &[(f64, f64, f64)]) -> Cycle {
    let by_displacement: Vec<(f64, f64)> = points.iter().map(|point| (point.0, point.1)).collect();
    let by_force: Vec<(f64, f64)> = points.iter().map(|point| (point.0, point.2)).collect();
    let deepest = curve::peak(&by_displacement).unwrap_or_default();
    let strongest = curve::peak(&by_force).unwrap_or_default();
    let path: Vec<(f64, f64)> = points.iter().map(|point| (point.1, point.2)).collect();
    let peak_force = path[strongest].1;
    let unloading: Vec<(f64, f64)> = path[strongest..]
        .iter()
        .copied()
        .filter(|(_, force)| (FITTED[0]..=FITTED[1]).contains(&(force / peak_force)))
        .collect();
    let (start, peak) = (path[0].0, path[deepest].0);
    Cycle {
        start,
        peak,
        end: path[path.len() - 1].0,
        peak_force,
        // a bed that creeps on while it is unloaded has no such branch
        unloading_stiffness: curve::slope(&unloading).filter(|slope| *slope > 0.0),
        loading_stiffness: (peak > start).then(|| (peak_force - path[0].1) / (peak - start)),
        dissipated: curve::area(&path),
    }
}
