//! Breaking against closed forms, balances and itself.
mod bars;
mod beams;
mod closing;
mod delamination;
mod extremes;
mod laminates;
mod rollers;
mod shares;
mod speed;

use super::*;
use crate::section::{Division, Layout, Section};
use crate::strength::{Criterion, InterfaceStrength, Limit, Strength};
use crate::supports::{Face, FaceSupport, Supports};

/// A limit with a fracture energy.
fn tough(limit: f64, energy: f64) -> Option<Limit> {
    Some(Limit {
        limit,
        fracture_energy_n_per_mm: Some(energy),
    })
}

/// A limit without one.
fn brittle(limit: f64) -> Option<Limit> {
    Some(Limit {
        limit,
        fracture_energy_n_per_mm: None,
    })
}

fn in_tension(tension: Option<Limit>) -> MaterialStrength {
    MaterialStrength {
        bulk: Strength {
            tension,
            ..Strength::default()
        },
        interface: None,
    }
}

const UNBREAKABLE: MaterialStrength = MaterialStrength {
    bulk: Strength {
        tension: None,
        compression: None,
        across_tension: None,
        across_compression: None,
        shear: None,
    },
    interface: None,
};

/// What a test breaks.
struct Case {
    layout: Layout,
    supports: Supports,
    load_n: Vec<f64>,
    strengths: Vec<MaterialStrength>,
    options: BreakingOptions,
    between_plies: BetweenPlies,
}

impl Case {
    /// Pulled along x by the right face, free to contract.
    fn pulled(
        section: &Section,
        cells: [usize; 2],
        reach_mm: f64,
        strengths: &[MaterialStrength],
    ) -> Self {
        let layout = section.layout(Division::Uniform { cells }).unwrap();
        let grid = layout.grid();
        let faces = [
            (Face::Left, FaceSupport::Rolling),
            (Face::Right, FaceSupport::PerAxis([Some(reach_mm), None])),
        ];
        let mut supports = Supports::of_faces(grid, &faces).unwrap();
        supports.hold(grid, 0, 1, 0.0).unwrap();
        let load_n = vec![0.0; 2 * grid.particles()];
        Self {
            layout,
            supports,
            load_n,
            strengths: strengths.to_vec(),
            options: BreakingOptions::default(),
            between_plies: BetweenPlies::default(),
        }
    }

    fn breaking(&self) -> Breaking {
        self.carrying(MOST_COLUMNS)
    }

    fn carrying(&self, most_columns: usize) -> Breaking {
        Breaking::carrying(self.specimen(), self.options, most_columns).unwrap()
    }

    fn refused(&self) -> String {
        Breaking::new(self.specimen(), self.options)
            .unwrap_err()
            .to_string()
    }

    fn specimen(&self) -> Specimen<'_> {
        Specimen {
            layout: &self.layout,
            supports: &self.supports,
            load_n: &self.load_n,
            strengths: &self.strengths,
            between_plies: &self.between_plies,
            rollers: None,
        }
    }
}

/// All events and why there are no more.
fn broken(breaking: &mut Breaking) -> (Vec<Event>, EndReason) {
    let mut events = Vec::new();
    loop {
        match breaking.advance().unwrap() {
            Advance::Broke(event) => events.push(event),
            Advance::Ended(reason) => return (events, reason),
        }
    }
}

/// Largest difference between the work along the path and elastic energy with dissipation, over the
/// largest energy.
fn imbalance(events: &[Event]) -> f64 {
    let (mut work, mut at, mut worst, mut largest) = (0.0, (0.0, 0.0), 0.0_f64, 0.0_f64);
    for event in events {
        let next = (event.displacement_mm, event.force_n);
        work += 0.5 * (at.1 + next.1) * (next.0 - at.0);
        at = next;
        let kept = event.elastic_n_mm + event.dissipated_n_mm + event.closing_n_mm;
        worst = worst.max((work - kept).abs());
        largest = largest.max(kept);
    }
    worst / largest
}

/// Bound of [`imbalance`]: sums of thousands of parts, each solved to 1e-11.
const BALANCE: f64 = 1e-9;

fn peak(events: &[Event]) -> f64 {
    events.iter().map(|event| event.force_n).fold(0.0, f64::max)
}
