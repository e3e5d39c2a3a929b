//! The whole against closed forms.
mod beams;
mod buckling;
mod contact;
mod hertz;
mod motion;
mod patch;
mod plies;
mod sections;
mod settling;

pub(crate) use plies::{CARBON, stacked};
pub(crate) use sections::{isotropic, orthotropic, plain};
