//! What happens in each cycle of loading.
use loadframe_harness::curve;

use super::heard::Heard;

/// Parts of a cycle's peak force between which the unloading branch is fitted by a straight line: its
/// beginning is still rounded by what creeps, its end by what opens.
const FITTED: [f64; 2] = [0.5, 0.9];

/// A cycle. Displacements are downward from where the cycles began.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Cycle {
    /// Number of its block, from 0.
    pub(super) block: usize,
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

/// All cycles of a test.
pub(super) fn of(heard: &Heard<'_>) -> Vec<Cycle> {
    let (_, (_, origin)) = heard.loading();
    let mut cycles: Vec<(usize, Vec<(f64, f64)>)> = Vec::new();
    let mut last = (0.0, 0.0);
    for row in &heard.rows {
        let here = (row.displacement(origin), row.force);
        if let Some(place) = row.place {
            while cycles.len() <= place.cycle {
                // a cycle begins where what was before it ended
                cycles.push((place.block, vec![last]));
            }
            cycles[place.cycle].1.push(here);
        }
        last = here;
    }
    cycles
        .iter()
        .map(|(block, path)| cycle(*block, path))
        .collect()
}

/// A cycle of points: displacement [m], force [N].
fn cycle(block: usize, path: &[(f64, f64)]) -> Cycle {
    let turned: Vec<(f64, f64)> = path.iter().map(|(way, force)| (*force, *way)).collect();
    let deepest = curve::peak(&turned).unwrap_or_default();
    let strongest = curve::peak(path).unwrap_or_default();
    let peak_force = path[strongest].1;
    let unloading: Vec<(f64, f64)> = path[strongest..]
        .iter()
        .copied()
        .filter(|(_, force)| (FITTED[0]..=FITTED[1]).contains(&(force / peak_force)))
        .collect();
    let (start, peak) = (path[0].0, path[deepest].0);
    Cycle {
        block,
        start,
        peak,
        end: path[path.len() - 1].0,
        peak_force,
        // a bed that creeps on while it is unloaded has no such branch
        unloading_stiffness: curve::slope(&unloading).filter(|slope| *slope > 0.0),
        loading_stiffness: (peak > start).then(|| (peak_force - path[0].1) / (peak - start)),
        dissipated: curve::area(path),
    }
}
