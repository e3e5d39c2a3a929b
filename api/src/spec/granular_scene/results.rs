//! Results that its jobs may have, and of the tests that are scenes.
use crate::results::Named;

pub(crate) const RESULTS: &[Named] = &[
    ("simulated_time", "s"),
    ("time_step", "s"),
    ("steps", "1"),
    ("bodies", "1"),
    ("particles", "1"),
    ("total_mass", "kg"),
    ("contacts", "1"),
    ("coordination_number", "1"),
    ("kinetic_energy", "J"),
    ("elastic_energy", "J"),
    ("unbalanced_force_ratio", "1"),
    ("escaped_bodies", "1"),
    ("bonds", "1"),
    ("broken_bonds", "1"),
    ("replaced_spheres", "1"),
    ("mass_before_replacing", "kg"),
    ("mass_after_replacing", "kg"),
    ("overlap_after_replacing", "1"),
    ("removed_bodies", "1"),
    ("removed_mass", "kg"),
];
