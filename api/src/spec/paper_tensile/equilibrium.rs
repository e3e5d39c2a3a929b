//! By which road a sheet comes to equilibrium: what the engine goes by, and what is told of it before and on the way.

use super::Level;

/// Unknowns up to which a factor is made where bonds have nodes. It holds some 100 numbers for each, and as
/// many are read for every break: fewer than some 20 iterations read, which start at every break from
/// a motion that is nearly right.
pub const DIRECT: usize = 1_000_000;

/// Unknowns of a truss up to which iterations have a factor of all of it, unless they have
/// [rigid groups](has_rigid_groups): bars are hinged everywhere, and groups know nothing of how they fold.
pub const FACTORED_TRUSS: usize = 100_000;

/// Strain from which on bars of a truss are taut enough for rigid groups.
pub const LEAST_TAUT: f64 = 1e-5;

/// `break_precision` from which on a truss has rigid groups: rests that must be more exact take
/// thousands of iterations with them.
pub const LEAST_PRECISION: f64 = 5e-3;

/// Whether iterations on a truss go by rigid groups however small it is.
pub fn has_rigid_groups(taut_strain: f64, break_precision: f64) -> bool {
    taut_strain >= LEAST_TAUT && break_precision >= LEAST_PRECISION
}

/// Share of the bonds that break until the force of a sheet has fallen to 0.3; of a truss fewer, 0.19 and 0.15 of the
/// bonds of two small ones.
const BROKEN_SHARE: f64 = 0.5;
const BROKEN_SHARE_OF_TRUSS: f64 = 0.17;
/// Solutions at a precision of 0.1: with a power of what breaks, and another of the precision. Pulls of beams of
/// 466, 1157 and 2434 fibres to a tenth below their largest force had 87, 164 and 189, the first 190 at 0.05. Damage of
/// large sheets is everywhere before any part of them parts. Two trusses of 1157 fibres had 71 and 76, one of 13 798 had
/// 154, and one of 384 181 at 0.2 had 89 to its peak.
const TOGETHER: f64 = 18.0;
const TOGETHER_OF_TRUSS: f64 = 13.0;
const OF_BREAKS: f64 = 0.25;
const OF_PRECISION: f64 = 0.1;
const POWER_OF_PRECISION: f64 = 1.1;

/// Share of the bonds that break until a sheet has parted.
#[must_use]
pub fn broken_share(level: Level) -> f64 {
    match level {
        Level::Truss => BROKEN_SHARE_OF_TRUSS,
        Level::Beam | Level::Tube => BROKEN_SHARE,
    }
}

/// Solutions in which iterations find so many breaks: one by one where there is no precision.
#[must_use]
pub fn solutions(level: Level, break_precision: f64, breaks: f64) -> f64 {
    let together = match level {
        Level::Truss => TOGETHER_OF_TRUSS,
        Level::Beam | Level::Tube => TOGETHER,
    };
    let coarser = (break_precision / OF_PRECISION).powf(-POWER_OF_PRECISION);
    (together * coarser * breaks.powf(OF_BREAKS)).min(breaks)
}
