//! Materials that no body can have, names that are none's, strengths that do not fit.
use std::collections::BTreeMap;

use crate::section::error::CompositeError;
use crate::section::material::PlaneState;
use crate::spec::composite_bending::{CompositeBending, Material};
use crate::{Violation, Violations};

/// Finds what is wrong with the materials of a section.
pub(super) fn check_materials(spec: &CompositeBending, violations: &mut Violations) {
    let needs_density = spec.test.history.is_some();
    for (name, material) in &spec.materials {
        // a ply shows its material from the side at which it is turned
        let angles = spec.plies.iter().filter(|ply| ply.material == *name);
        let angles = angles.map(|ply| ply.angle_deg).chain([0.0]);
        check_material(
            name,
            material,
            spec.section.state.into(),
            angles,
            violations,
        );
        if needs_density && material.density_kg_per_m3.is_none() {
            let detail = "motion in time needs the density of every material";
            let pointer = format!("{}/density_kg_per_m3", pointer_to(name));
            violations.push(
                Violation::new(pointer, "missing", detail)
                    .allowed("a density above 0")
                    .unit("kg/m3"),
            );
        }
    }
}

/// Finds what is wrong with a material, seen from the sides at which it is turned.
pub(crate) fn check_material(
    name: &str,
    material: &Material,
    state: PlaneState,
    mut angles: impl Iterator<Item = f64>,
    violations: &mut Violations,
) {
    let pointer = pointer_to(name);
    let Some(elastic) = material.elastic() else {
        violations.push(
            Violation::new(
                &pointer,
                "not_one_material",
                "a material is isotropic or orthotropic",
            )
            .allowed("exactly one of: isotropic, orthotropic"),
        );
        return;
    };
    let refused = angles.find_map(|angle| elastic.stiffness_out_of_plane(state, angle).err());
    if let Some(error) = refused {
        violations.push(unstable(&pointer, material, &error));
    }
    let Some(strength) = material.strength.filter(|_| material.isotropic.is_some()) else {
        return;
    };
    for (field, given) in [
        ("across_tension", strength.across_tension),
        ("across_compression", strength.across_compression),
        ("shear", strength.shear),
    ] {
        if given.is_some() {
            violations.push(
                Violation::new(
                    format!("{pointer}/strength/{field}"),
                    "not_allowed",
                    "an isotropic material has no fibres, along or across which it could break; its \
                     principal stresses count",
                )
                .allowed("tension and compression of an isotropic material"),
            );
        }
    }
}

/// The interface of a material of which no fibre is.
pub(crate) fn refused_interface(name: &str, material: &Material) -> Option<Violation> {
    material.interface?;
    let refused = Violation::new(
        format!("{}/interface", pointer_to(name)),
        "not_allowed",
        "no fibre is of this material, so that it has no interface",
    );
    Some(refused.allowed("the interface of a fibre's material"))
}

pub(in super::super) fn pointer_to(material: &str) -> String {
    format!("/materials/{}", escaped(material))
}

/// Elastic constants that no stable material has.
fn unstable(pointer: &str, material: &Material, error: &CompositeError) -> Violation {
    let form = if material.isotropic.is_some() {
        "isotropic"
    } else {
        "orthotropic"
    };
    let violation = Violation::new(
        format!("{pointer}/{form}"),
        "unstable_material",
        error.to_string(),
    );
    match error {
        CompositeError::UnstableMaterial { given, bound, .. } => violation
            .value(*given)
            .allowed(format!("above -{bound:.6} and below {bound:.6}")),
        CompositeError::OutOfRange { given, allowed, .. } => {
            violation.value(*given).allowed(*allowed)
        }
        _ => violation,
    }
}

/// A name that is not one of the materials'.
pub(crate) fn unknown_material(
    materials: &BTreeMap<String, Material>,
    pointer: impl Into<String>,
    name: &str,
) -> Option<Violation> {
    (!materials.contains_key(name)).then(|| {
        let known: Vec<&str> = materials.keys().map(String::as_str).collect();
        let allowed = if known.is_empty() {
            "the spec has no materials".to_owned()
        } else {
            format!("one of: {}", known.join(", "))
        };
        Violation::new(pointer, "unknown_material", "there is no such material")
            .value(name)
            .allowed(allowed)
    })
}

/// A name as a part of a JSON pointer.
pub(in super::super) fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}
