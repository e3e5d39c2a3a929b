//! What is read off all contacts between the two phases of a step, when somebody looks.
//!
//! Each patch reads its own; its contacts are added up as they are read, and kept one by one only
//! where somebody asks for them. Sums are folded in the order of patches.
use super::{
    engine::Engine,
    observe::Contact,
    scene::Model,
    time_step::{Critical, PatchRows},
};

/// What contacts add up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    pub(super) contacts: u64,
    /// Intact bonds.
    pub(super) bonds: u64,
    /// Ends of contacts at bodies that move.
    pub(super) movable_ends: u64,
    /// In normal and shear springs [J].
    pub(super) elastic: f64,
    /// Of the sizes of forces [N].
    pub(super) force: f64,
    /// Largest compression over the smaller radius; of a bond, the change of its overlap.
    pub(super) overlap_ratio: f64,
}

/// All contacts, looked at.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    pub(super) sums: Sums,
    /// `None` when no contact moves anything.
    pub(super) critical: Option<Critical>,
    /// In the order of patches, if they were asked for.
    pub(super) contacts: Vec<Contact>,
}

impl Sums {
    fn add(&mut self, contact: &Contact, model: &Model) {
        let ends = contact.bodies.iter();
        let ends = ends.filter(|body| model.is_movable.get(**body as usize) == Some(&true));
        self.contacts += 1;
        self.bonds += u64::from(contact.is_bonded);
        self.movable_ends += ends.count() as u64;
        self.elastic += contact.energy;
        self.force += (contact.normal_force + contact.shear_force).norm();
        let overlap_ratio = contact.compression.abs() / contact.radius;
        self.overlap_ratio = self.overlap_ratio.max(overlap_ratio);
    }

    fn join(&mut self, part: &Self) {
        self.contacts += part.contacts;
        self.bonds += part.bonds;
        self.movable_ends += part.movable_ends;
        self.elastic += part.elastic;
        self.force += part.force;
        self.overlap_ratio = self.overlap_ratio.max(part.overlap_ratio);
    }
}

impl Engine {
    /// Looks at all contacts that touch; to be called between the phases.
    pub(super) fn survey(&self, keeps_contacts: bool) -> Survey {
        let work = self.state.patches.iter().zip(&self.contact_lists);
        let seen = self.team.map(work.collect(), |(patch, lists)| {
            let mut sums = Sums::default();
            let mut rows = PatchRows::new(patch);
            let mut contacts = Vec::new();
            lists.see(&mut |touching| {
                let Some(contact) = self.contact(&touching) else {
                    return;
                };
                sums.add(&contact, &self.model);
                rows.add(&contact, patch, &self.model);
                if keeps_contacts {
                    contacts.push(contact);
                }
            });
            (sums, rows, contacts)
        });
        let mut sums = Sums::default();
        let mut rows = Vec::with_capacity(seen.len());
        let mut contacts = Vec::new();
        for (part, of_patch, some) in seen {
            sums.join(&part);
            rows.push(of_patch);
            contacts.extend(some);
        }
        Survey {
            sums,
            critical: self.critical_step(rows),
            contacts,
        }
    }
}
