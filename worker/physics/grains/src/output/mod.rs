//! What a run keeps and leaves behind.
//!
//! The [`journal`] is filled on the way: rows of [`tables`], [`fragments`] and [`breaks`], maps of [`voids`], the worst
//! that was seen. A [`snapshot`] is written at once. At the end the tables become files ([`table`](self::table)) and
//! the [`report`] says whether to believe them, [`warnings`](self::warnings) what would help, and [`errors`] how wrong energies may be, [`bed_errors`] how wrong what is read off a bed. Below: [`observe`](crate::observe).
pub(crate) mod bed_errors;
pub(crate) mod breaks;
pub(crate) mod errors;
pub(crate) mod fragments;
pub(crate) mod journal;
pub(crate) mod report;
pub(crate) mod snapshot;
mod table;
pub(crate) mod tables;
pub(crate) mod voids;
pub(crate) mod warnings;
