//! The whole against closed forms.
mod beams;
mod contact;
mod motion;
mod patch;
mod plies;
mod sections;
