//! The whole against closed forms.
mod beams;
mod motion;
mod patch;
mod plies;
mod sections;
