//! Results that its jobs may have.
use crate::results::Named;

/// Those of the scene that a ballast test is come beside these.
pub(super) const RESULTS: &[Named] = &[
    ("unloading_stiffness", "N/m"),
    ("peak_displacement", "mm"),
    ("peak_displacement_from_set_down", "mm"),
    ("residual_displacement", "mm"),
    ("settlement_after_block_*", "mm"),
    ("unloading_stiffness_of_block_*", "N/m"),
    ("cycles", "1"),
    ("last_cycle_displacement", "mm"),
    ("settlement", "mm"),
    ("last_unloading_stiffness", "N/m"),
    ("tilt_before_loading", "rad"),
    ("tilt_at_peak", "rad"),
    ("tilt_at_end", "rad"),
    ("peak_force", "N"),
    ("initial_height", "mm"),
    ("initial_void_ratio", "1"),
    ("initial_porosity", "1"),
    ("oedometric_modulus", "Pa"),
    ("porosity", "1"),
    ("mass_in_single_spheres_*", "1"),
    ("mass_in_whole_grains_*", "1"),
    ("mass_from_135_spheres_*", "1"),
];
