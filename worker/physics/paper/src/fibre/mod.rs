//! One fibre.
