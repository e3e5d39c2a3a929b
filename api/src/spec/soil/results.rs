//! Results that its jobs may have.
use crate::results::Named;

/// Those of the scene that a test of soil is come beside these.
pub(super) const TRIAXIAL: &[Named] = &[
    ("peak_deviator_stress", "Pa"),
    ("peak_friction_angle", "deg"),
    ("critical_friction_angle", "deg"),
    ("dilatancy_angle", "deg"),
    ("axial_strain_at_peak", "1"),
    ("secant_modulus", "Pa"),
    ("confining_pressure", "Pa"),
    ("mean_stress_at_peak", "Pa"),
    ("initial_void_ratio", "1"),
    ("final_void_ratio", "1"),
    ("largest_axial_strain", "1"),
    ("final_volumetric_strain", "1"),
    ("initial_height", "mm"),
    ("initial_width", "mm"),
];

pub(super) const DIRECT_SHEAR: &[Named] = &[
    ("peak_shear_stress", "Pa"),
    ("peak_friction_angle", "deg"),
    ("critical_friction_angle", "deg"),
    ("dilatancy_angle", "deg"),
    ("shear_displacement_at_peak", "mm"),
    ("normal_stress", "Pa"),
    ("final_vertical_displacement", "mm"),
    ("largest_shear_displacement", "mm"),
    ("initial_height", "mm"),
    ("initial_void_ratio", "1"),
];
