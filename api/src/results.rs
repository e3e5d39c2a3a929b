//! Names and units of the results that jobs of each kind may have, for those who refer to them before
//! a job has run. Which of them a job does have depends on its spec; that the engines give no others is
//! tested with every example.
use serde_json::{Value, json};

use crate::JobKind;

/// A result's name and unit; a name that ends in a moment of the test, or in another result, is written
/// with `*`.
type Named = (&'static str, &'static str);

const NONWOVEN: &[Named] = &[
    ("max_force", "N"),
    ("strain_at_max_force", "1"),
    ("strength", "N/m"),
    ("modulus_at_10_percent", "N/m"),
    ("secant_stiffness_at_10_percent", "N"),
    ("poisson_ratio", "1"),
    ("energy_absorption", "J/m2"),
    ("work_to_max_force", "J"),
    ("strength_pa", "Pa"),
    ("modulus_at_10_percent_pa", "Pa"),
    ("tensile_index", "N m/g"),
    ("tenacity", "N/tex"),
    ("modulus_at_10_percent_per_tex", "N/tex"),
    ("specimen_width", "mm"),
    ("gauge_length", "mm"),
    ("mean_bond_strength", "N"),
    ("max_force_per_layer", "N"),
    ("broken_bonds", "1"),
    ("nodes", "1"),
    ("bonds", "1"),
    ("cycles", "1"),
    ("residual_strain", "1"),
    ("energy_loaded", "J"),
    ("energy_recovered", "J"),
    ("energy_dissipated", "J"),
    ("energy_released_by_breaking", "J"),
    ("first_cycle_stiffness", "N"),
    ("last_cycle_stiffness", "N"),
    ("anisotropy_of_*", "1"),
];

const PAPER: &[Named] = &[
    ("max_force", "N"),
    ("max_force", "mN"),
    ("tensile_strength", "kN/m"),
    ("tensile_index", "N m/g"),
    ("breaking_length", "km"),
    ("stretch", "1"),
    ("energy_absorption", "J/m2"),
    ("energy_absorption_index", "J/g"),
    ("tensile_stiffness", "kN/m"),
    ("tensile_stiffness_index", "kN m/g"),
    ("youngs_modulus", "GPa"),
    ("broken_bonds", "1"),
    ("plastic_work", "J/m2"),
    ("yielded_share", "1"),
    ("residual_strain", "1"),
    ("broken_bonds_opened", "1"),
    ("broken_bonds_sheared", "1"),
    ("broken_fibres", "1"),
    ("fibres", "1"),
    ("bonds", "1"),
    ("void_bonds", "1"),
    ("grammage", "g/m2"),
    ("zero_span_strength", "kN/m"),
    ("zero_span_index", "N m/g"),
    ("zero_span_strain", "1"),
    ("zero_span_index_of_fibres", "N m/g"),
    ("cox_stiffness_index", "kN m/g"),
    ("shear_lag_stiffness_index", "kN m/g"),
    ("page_tensile_index", "N m/g"),
    ("page_bond_share", "1"),
    ("tensile_index_over_page", "1"),
    ("contacts_per_fibre", "1"),
    ("relative_bonded_area", "1"),
    ("coverage", "1"),
    ("thickness", "µm"),
    ("peak_thickness", "µm"),
    ("density", "kg/m3"),
    ("mean_fibre_length", "mm"),
    ("mean_fibre_width", "µm"),
    ("length_weighted_fibre_length", "mm"),
    ("anisotropy", "1"),
    ("free_segment_length", "µm"),
    ("axial_modulus", "GPa"),
    ("axial_modulus_given", "GPa"),
    ("poisson_ratio", "1"),
    ("poisson_ratio_given", "1"),
    ("shear_modulus", "GPa"),
    ("shear_modulus_given", "GPa"),
    ("bending_stiffness", "N m2"),
    ("bending_stiffness_of_wall", "N m2"),
    ("buckling_load", "mN"),
    ("buckling_load_of_column", "mN"),
    ("initial_stiffness", "mN"),
    ("segments", "1"),
    ("segment_length", "µm"),
    ("shortest_segment", "µm"),
    ("longest_segment", "µm"),
    ("ring_diameter", "µm"),
    ("wall_density", "kg/m3"),
    ("anisotropy_of_*", "1"),
];

const BENDING: &[Named] = &[
    ("effective_modulus", "MPa"),
    ("effective_poisson_ratio", "1"),
    ("effective_shear_modulus", "MPa"),
    ("max_force", "N"),
    ("mean_top_deflection", "mm"),
    ("mean_bottom_deflection", "mm"),
    ("mean_top_deflection_limit", "mm"),
    ("mean_bottom_deflection_limit", "mm"),
    ("effective_modulus_limit", "MPa"),
    ("effective_shear_modulus_limit", "MPa"),
    ("deflection_ratio", "1"),
    ("strain_energy", "J"),
    ("peak_deflection", "mm"),
    ("time_of_peak_deflection", "s"),
    ("natural_frequency", "Hz"),
    ("flexural_modulus", "MPa"),
    ("deflection", "mm"),
    ("roller_displacement", "mm"),
    ("flexural_stress", "MPa"),
    ("flexural_strain", "1"),
    ("flexural_stress_large_deflection", "MPa"),
    ("flexural_strain_large_deflection", "1"),
    ("interlaminar_shear_stress", "MPa"),
    ("largest_shear_stress", "MPa"),
    ("bending_modulus", "MPa"),
    ("flexural_modulus_without_shear", "MPa"),
    ("beam_deflection", "mm"),
    ("shear_deflection_share", "1"),
    ("span_to_depth", "1"),
    ("contact_width", "mm"),
    ("displacement_at_max_force", "mm"),
    ("first_crack_force", "N"),
    ("first_crack_displacement", "mm"),
    ("initial_stiffness", "N/mm"),
    ("dissipated_energy", "J"),
    ("dissipated_in_matrix", "J"),
    ("dissipated_in_fibres", "J"),
    ("dissipated_at_interfaces", "J"),
    ("dissipated_between_plies", "J"),
    ("crack_area", "mm2"),
    ("cracks", "1"),
    ("broken_cells", "1"),
    ("interlaminar_shear_strength", "MPa"),
    ("release_rate", "N/mm"),
    ("energy_per_crack_area", "N/mm"),
    ("beam_stiffness", "N/mm"),
    ("crack_length", "mm"),
    ("flexural_strength", "MPa"),
    ("tensile_strength", "MPa"),
    ("stiffness_over_exact", "1"),
    ("cells", "1"),
    ("particles", "1"),
    ("deformation_factor", "1"),
];

const CELL: &[Named] = &[
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

const SCENE: &[Named] = &[
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
    ("removed_bodies", "1"),
    ("removed_mass", "kg"),
];

/// Those of the scene that a test of soil is come beside these.
const TRIAXIAL: &[Named] = &[
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
const DIRECT_SHEAR: &[Named] = &[
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

/// Those of the scene that a ballast test is come beside these.
const BALLAST: &[Named] = &[
    ("unloading_stiffness", "N/m"),
    ("peak_displacement", "mm"),
    ("residual_displacement", "mm"),
    ("cycles", "1"),
    ("last_cycle_displacement", "mm"),
    ("settlement", "mm"),
    ("last_unloading_stiffness", "N/m"),
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
/// What names of a second direction end in.
const ALONG: [&str; 4] = ["_along_x", "_along_y", "_along_md", "_along_cd"];

fn lists(kind: JobKind) -> [&'static [Named]; 2] {
    match kind {
        JobKind::NonwovenTensile => [NONWOVEN, &[]],
        JobKind::PaperTensile => [PAPER, &[]],
        JobKind::CompositeBending => [BENDING, &[]],
        JobKind::CompositeCell => [CELL, &[]],
        JobKind::GranularScene => [SCENE, &[]],
        JobKind::Triaxial => [TRIAXIAL, SCENE],
        JobKind::DirectShear => [DIRECT_SHEAR, SCENE],
        JobKind::BallastOedometer | JobKind::BallastBox | JobKind::BallastRailbed => {
            [BALLAST, SCENE]
        }
        // its results have the names of its parameters
        JobKind::Calibrate => [&[], &[]],
    }
}

/// `x-results` of a kind's schema: name and unit of each result.
pub(crate) fn results_of(kind: JobKind) -> Value {
    let all = lists(kind).concat().into_iter();
    all.map(|(name, unit)| json!({ "name": name, "unit": unit }))
        .collect()
}

/// Names of the results that jobs of a kind may have.
pub fn result_names(kind: JobKind) -> Vec<&'static str> {
    let mut names: Vec<&str> = lists(kind).concat().iter().map(|(name, _)| *name).collect();
    names.dedup();
    names
}

/// The units in which jobs of a kind may give a result; none where they have no such result.
pub fn result_units(kind: JobKind, name: &str) -> Vec<&'static str> {
    let own = ALONG
        .iter()
        .find_map(|end| name.strip_suffix(end))
        .unwrap_or(name);
    let is_it = |known: &str| match known.strip_suffix('*') {
        Some(beginning) => name.starts_with(beginning),
        None => known == name || known == own,
    };
    let all = lists(kind).concat().into_iter();
    all.filter(|(known, _)| is_it(known))
        .map(|(_, unit)| unit)
        .collect()
}
