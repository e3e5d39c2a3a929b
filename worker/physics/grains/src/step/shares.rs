//! Handing out the bodies of a scene to the patches that move them.
use super::patch::{Bodies, Patch};
use crate::{motion::clump::Clump, scene::particles::Particles};

/// A patch's own bodies.
pub(crate) fn share<'a>(
    particles: &'a mut Particles,
    clumps: &'a mut [Clump],
    patch: &Patch,
) -> Bodies<'a> {
    let range = patch.particles.clone();
    // without friction there are no spins
    let turning = if particles.spins.is_empty() {
        0..0
    } else {
        range.clone()
    };
    Bodies {
        centres: &mut particles.centres[range.clone()],
        velocities: &mut particles.velocities[range],
        spins: &mut particles.spins[turning],
        clumps: &mut clumps[patch.clumps.clone()],
        owners: &particles.owners[patch.particles.clone()],
    }
}

/// Hands neighbouring patches their own bodies.
pub(crate) fn shares<'a>(
    particles: &'a mut Particles,
    clumps: &'a mut [Clump],
    patches: &'a mut [Patch],
) -> Vec<(&'a mut Patch, Bodies<'a>)> {
    let Some([first, first_clump]) = patches
        .first()
        .map(|patch| [patch.particles.start, patch.clumps.start])
    else {
        return Vec::new();
    };
    let mut centres = &mut particles.centres[first..];
    let mut velocities = &mut particles.velocities[first..];
    let is_rough = !particles.spins.is_empty();
    let mut spins = &mut particles.spins[if is_rough { first } else { 0 }..];
    let mut clumps = &mut clumps[first_clump..];
    let mut shares = Vec::with_capacity(patches.len());
    for patch in patches {
        let rows = patch.particles.len();
        let bodies = Bodies {
            centres: take(&mut centres, rows),
            velocities: take(&mut velocities, rows),
            spins: take(&mut spins, if is_rough { rows } else { 0 }),
            clumps: take(&mut clumps, patch.clumps.len()),
            owners: &particles.owners[patch.particles.clone()],
        };
        shares.push((patch, bodies));
    }
    shares
}

/// Splits off the first `count` items.
fn take<'a, T>(items: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(items).split_at_mut(count);
    *items = rest;
    first
}
