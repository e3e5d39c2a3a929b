//! Sheets against closed forms, statistics and brute force.
mod bad_input;
mod deposited;
mod extremes;
mod laid;
mod strips;

use loadframe_harness::{Sample, Uninterrupted};
use loadframe_numerics::Team;

use super::*;

/// Mass and mass fractions are sums of some thousand lengths.
pub(super) const ROUNDING: f64 = 1e-12;

pub(super) fn softwood(length: LengthDistribution) -> Pulp {
    Pulp {
        mass_fraction: 1.0,
        length,
        width_um: 28.0,
        wall_um: 2.0,
        coarseness_ug_per_um: 2.45e-4,
        shape_factor: 0.92,
        lumen: Lumen::Collapsed,
    }
}

pub(super) fn fixed(length_um: f64) -> LengthDistribution {
    LengthDistribution::Fixed { length_um }
}

pub(super) fn random(size_um: [f64; 2], grammage: f64, pulps: Vec<Pulp>) -> SheetPlan {
    SheetPlan {
        size_um,
        grammage_ug_per_um2: grammage * 1e-6,
        pulps,
        orientation: Orientation::Uniform,
        placement: Placement::Random3d { thickness_um: 90.0 },
        segment_um: None,
        gap_um: None,
    }
}

pub(super) fn deposited(size_um: [f64; 2], grammage: f64, pulps: Vec<Pulp>) -> SheetPlan {
    SheetPlan {
        placement: Placement::Deposition { flexibility: 0.3 },
        ..random(size_um, grammage, pulps)
    }
}

pub(super) fn lay(plan: &SheetPlan, seed: u64) -> Sheet {
    plan.lay(seed, &Team::alone())
        .expect("the plan is a good one")
}

/// Holds the mean of `values` against what it should be, within three standard errors.
#[track_caller]
pub(super) fn assert_mean(values: &[f64], expected: f64) {
    let sample = Sample::of(values).expect("there are values");
    let scatter = sample.deviation.expect("there are several");
    let error = scatter / (values.len() as f64).sqrt();
    let off = (sample.mean - expected) / error;
    assert!(
        off.abs() < 3.0,
        "{} for {expected}, {off} standard errors off",
        sample.mean
    );
}
