//! What is read off model and state; nothing here changes them.
//!
//! [`contact`] is a contact as observers see it. A [`survey`] looks at all of them between the phases of
//! a step, with the critical [`time_step`]; [`measure`] makes a continuum of a box, [`fragments`] are
//! what bonds hold together, [`plates`] are at rest or not, [`inspect`] finds bodies that a run must tell of. Below:
//! [`step`](crate::step).
pub(crate) mod contact;
pub(crate) mod fragments;
pub(crate) mod inspect;
pub(crate) mod measure;
mod plates;
pub(crate) mod survey;
pub(crate) mod time_step;
