//! What users write: one module a kind. Structs with units in their field names, their defaults,
//! their limits (as JSON Schema, the one source), the cross-checks and the cost.
pub mod ballast;
pub mod calibrate;
pub mod composite_bending;
pub mod composite_cell;
pub mod granular_scene;
pub mod nonwoven_tensile;
pub mod paper_tensile;
mod repeats;
pub mod soil;
