//! Results that its jobs may have.
use crate::results::Named;

pub(super) const RESULTS: &[Named] = &[
    ("modulus_1", "MPa"),
    ("modulus_2", "MPa"),
    ("modulus_3", "MPa"),
    ("poisson_ratio_12", "1"),
    ("poisson_ratio_13", "1"),
    ("poisson_ratio_23", "1"),
    ("shear_modulus_12", "MPa"),
    ("shear_modulus_13", "MPa"),
    ("shear_modulus_23", "MPa"),
    ("strength_along_tension", "MPa"),
    ("strength_along_compression", "MPa"),
    ("strength_across_tension", "MPa"),
    ("strength_across_compression", "MPa"),
    ("strength_shear", "MPa"),
    ("fibre_fraction", "1"),
    ("fibres", "1"),
    ("cells", "1"),
];
