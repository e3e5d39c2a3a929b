//! The whole against closed forms.
mod beams;
mod patch;
mod sections;
