//! Sheets against closed forms, statistics and brute force.
use super::*;

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
