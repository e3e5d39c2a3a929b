//! Which parts break with one solution.
//!
//! Of all that is at its strength, or short of it by a quarter of the precision, a part breaks unless one of its
//! fibres has another that is more overloaded by more than the precision: what a break sets free goes first
//! to the parts along the fibres that it joined, so that those wait for what it leaves them with. Parts without
//! a fibre in common do not wait for one another, and a large sheet takes hardly more solutions than a small one.
//!
//! What is over its strength by less than the precision waits until more is: a sheet is elongated until its most
//! loaded part is over by the precision, so that the few parts which a round of breaks leaves overloaded do not
//! take a solution of their own. What breaks early makes a sheet weaker and what waits makes it stronger; at
//! these shares the two make up for one another in part (`tests/figures paper_together paper_together_trusses`).
//!
//! So do a few that are over it by more, where the elongation grows by the precision at most until the next is: every
//! round of breaks leaves some, then a fourth as many, and so on to the last one, each round at the price of the first
//! (in a strip of 15 mm x 100 mm 14 000 bonds, then 1638, 422, 82, 24 and 5). Without that bound a sheet that has nearly
//! parted would be pulled on with what holds it overloaded.
use super::network::Network;

/// What breaks early is short of its strength by this share of the precision at most.
const EARLY: f64 = 0.25;

/// The failure index up to which parts that are over their strength wait for a larger elongation: 1 where parts
/// break one by one.
pub(crate) fn waits_to(precision: f64) -> f64 {
    1.0 + precision
}

/// How many parts may be over their strength by more than the precision, over all that have broken.
const FEW: f64 = 0.003;

/// Parts that wait for a slightly larger elongation however much they are over their strength.
pub(crate) fn few(precision: f64, broken: usize) -> usize {
    if precision > 0.0 {
        (FEW * broken as f64) as usize
    } else {
        0
    }
}

/// Parts that break together, the most loaded first. `indices` are the failure indices of parts: 1 where they break.
pub(crate) fn together(network: &Network, indices: &[(usize, f64)], precision: f64) -> Vec<usize> {
    let share = 1.0 - precision;
    let most = indices.iter().map(|(_, index)| *index).fold(0.0, f64::max);
    // what breaks first may be a hair below its strength by round-off
    let least = (1.0 - EARLY * precision) * most.min(1.0);
    let mut breaking: Vec<(usize, f64)> = indices.to_vec();
    breaking.retain(|(_, index)| *index >= least && *index > 0.0);
    let mut largest = vec![0.0_f64; network.fibres()];
    for &(part, index) in &breaking {
        for fibre in network.fibres_of(part) {
            largest[fibre] = largest[fibre].max(index);
        }
    }
    breaking.retain(|&(part, index)| {
        let fibres = network.fibres_of(part);
        fibres.iter().all(|&fibre| index >= share * largest[fibre])
    });
    breaking.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    breaking.into_iter().map(|(part, _)| part).collect()
}
