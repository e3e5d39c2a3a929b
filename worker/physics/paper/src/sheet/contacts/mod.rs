//! Where fibres touch.
//!
//! Fibres have elliptical sections that lie flat, as wide as the fibre and as high as it is thick.
//! Two of them touch where the distance of their centre lines, with heights stretched by
//! (W₁ + W₂)/(t₁ + t₂ + 2 g), is at most (W₁ + W₂)/2: exact for round tubes and, at a crossing, the
//! condition |z₂ − z₁| ≤ (t₁ + t₂)/2 + g with the allowed gap g.
//!
//! `candidates` pairs fibres that lie near one another, a `tree` of boxes (`bounds`) per fibre leads
//! to pairs of segments, `segments` measures those, `region` joins neighbouring pairs to one contact
//! and `overlap` gives its area.
mod bounds;
mod candidates;
mod overlap;
mod region;
mod segments;
#[cfg(test)]
mod tests;
mod tree;

use loadframe_numerics::Team;

use super::{Contact, SheetFibre, polyline};
use bounds::{Bound, Oriented};
use candidates::Candidates;
use region::{Line, Regions};
use segments::{Metric, Touch};
use tree::{Tree, Walk};

/// Fibres in a piece of work for one thread.
const CHUNK: usize = 64;

/// Contacts between fibres whose vertical gap is at most `gap_um` [µm], by the first fibre, then the
/// second, then the place on the first; one for every region in which two fibres touch. Does not
/// depend on the number of threads.
pub fn contacts(fibres: &[SheetFibre], gap_um: f64, team: &Team) -> Vec<Contact> {
    search::<Oriented>(fibres, gap_um, team)
}

fn search<B: Bound>(fibres: &[SheetFibre], gap_um: f64, team: &Team) -> Vec<Contact> {
    let chunks: Vec<&[SheetFibre]> = fibres.chunks(CHUNK).collect();
    let indexed: Vec<Indexed<'_, B>> = team
        .map(chunks, |chunk| {
            let indexed = chunk.iter().map(|fibre| Indexed::new(fibre, gap_um));
            indexed.collect::<Vec<_>>()
        })
        .into_iter()
        .flatten()
        .collect();
    let candidates = Candidates::new(fibres, gap_um);
    let firsts: Vec<usize> = (0..fibres.len()).step_by(CHUNK).collect();
    let found = team.map(firsts, |start| {
        let mut work = Work::default();
        for first in start..fibres.len().min(start + CHUNK) {
            candidates.of(first, &mut work.others);
            for index in 0..work.others.len() {
                let second = work.others[index] as usize;
                let pair = [&indexed[first], &indexed[second]];
                work.pair([first as u32, second as u32], pair, gap_um);
            }
        }
        work.contacts
    });
    let count = found.iter().map(Vec::len).sum();
    let mut contacts = Vec::with_capacity(count);
    contacts.extend(found.into_iter().flatten());
    contacts
}

/// A fibre and what the search knows about it.
struct Indexed<'a, B> {
    fibre: &'a SheetFibre,
    /// Arc length [µm] of every point.
    arcs_um: Box<[f64]>,
    tree: Tree<B>,
}

impl<'a, B: Bound> Indexed<'a, B> {
    fn new(fibre: &'a SheetFibre, gap_um: f64) -> Self {
        Self {
            fibre,
            arcs_um: polyline::arc_lengths(&fibre.centre_line_um).into_boxed_slice(),
            tree: Tree::new(fibre, gap_um),
        }
    }

    fn line(&self) -> Line<'a, '_> {
        Line {
            fibre: self.fibre,
            arcs_um: &self.arcs_um,
        }
    }
}

/// What one thread needs for pairs of fibres.
#[derive(Default)]
struct Work {
    others: Vec<u32>,
    walk: Walk,
    touches: Vec<Touch>,
    regions: Regions,
    contacts: Vec<Contact>,
}

impl Work {
    fn pair<B: Bound>(&mut self, numbers: [u32; 2], pair: [&Indexed<'_, B>; 2], gap_um: f64) {
        let metric = Metric::new(pair.map(|one| one.fibre.section), gap_um);
        let lines = pair.map(|one| &one.fibre.centre_line_um[..]);
        let touches = &mut self.touches;
        touches.clear();
        self.walk
            .leaves(pair.map(|one| &one.tree), |[ones, others]| {
                for one in ones {
                    for other in others.clone() {
                        touches.extend(metric.touch(lines, [one, other]));
                    }
                }
            });
        if touches.is_empty() {
            return;
        }
        let lines = pair.map(|one| one.line());
        let start = self.contacts.len();
        self.regions.join(touches, lines, |touches| {
            let contact = region::contact(numbers, lines, touches);
            self.contacts.extend(contact);
        });
        self.contacts[start..].sort_by(|one, other| one.at_um[0].total_cmp(&other.at_um[0]));
    }
}
