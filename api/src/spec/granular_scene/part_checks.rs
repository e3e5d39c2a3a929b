//! Checks of what many parts of a scene have: a material, a clump.
use super::{Clump, Filled, GranularScene, Shape, grains::MOST_MEMBERS};
use crate::{Violation, filling::FillError};

/// Places times triangles that are looked at to fill a surface, at most: some minutes.
const MOST_LOOKS: f64 = 5e9;

/// A clump is given member by member or by what it fills, which can be filled.
pub(super) fn check_clump(pointer: &str, clump: &Clump) -> Option<Violation> {
    if clump.members.is_empty() == clump.filled.is_none() {
        let detail = "members are given one by one or fill a shape";
        let violation = Violation::new(pointer, "not_one_shape", detail);
        return Some(violation.allowed("exactly one of: members (at least one), filled"));
    }
    let filled = clump.filled.as_ref()?;
    check_filled(&format!("{pointer}/filled"), filled)
}

fn check_filled(pointer: &str, filled: &Filled) -> Option<Violation> {
    let radius = |code: &str, detail: String| {
        Violation::new(format!("{pointer}/member_radius_m"), code, detail)
            .value(filled.member_radius_m)
            .unit("m")
    };
    if let Err(error) = filled.check_surface() {
        let code = match error {
            FillError::NotClosed(_) => "not_closed",
            _ => "not_a_surface",
        };
        let stl = format!("{pointer}/shape/surface/stl");
        let violation = Violation::new(stl, code, error.to_string());
        return Some(violation.allowed("a closed surface of triangles, as an STL file's text"));
    }
    if filled.looks() > MOST_LOOKS {
        let detail = "filling the surface takes too long";
        let violation = radius("too_large", detail.to_owned());
        return Some(
            violation.allowed("larger members, further apart, or a surface of fewer triangles"),
        );
    }
    let too_many = |members: u64| {
        let violation = radius("too_large", format!("the shape takes {members} spheres"));
        violation.allowed(format!("at most {MOST_MEMBERS} spheres in a shape"))
    };
    let about = filled.members_by_size();
    if about > MOST_MEMBERS {
        return Some(too_many(about));
    }
    if matches!(filled.shape, Shape::Surface { .. }) {
        // what a surface takes is known when it is filled
        return None;
    }
    match filled.members() {
        Err(error) => {
            let violation = radius("does_not_fit", error.to_string());
            Some(violation.allowed("a radius with which a sphere fits"))
        }
        Ok(members) => {
            let members = members.len() as u64;
            (members > MOST_MEMBERS).then(|| too_many(members))
        }
    }
}

/// What can break is held together by something.
pub(super) fn check_cohesive(
    spec: &GranularScene,
    pointer: &str,
    material: &str,
) -> Option<Violation> {
    let is_loose = |name: &str| {
        let material = spec.materials.get(name);
        material.is_some_and(|material| !material.is_cohesive())
    };
    is_loose(material).then(|| {
        let detail = "nothing bonds the spheres of a breakable body of this material";
        Violation::new(format!("{pointer}/material"), "not_cohesive", detail)
            .value(material)
            .allowed("a material with normal_cohesion_pa or shear_cohesion_pa above 0")
    })
}

pub(super) fn check_material(spec: &GranularScene, pointer: &str, name: &str) -> Option<Violation> {
    let names: Vec<&str> = spec.materials.keys().map(String::as_str).collect();
    (!spec.materials.contains_key(name)).then(|| {
        Violation::new(
            format!("{pointer}/material"),
            "no_such_material",
            "no material has this name",
        )
        .value(name)
        .allowed(format!("one of: {}", names.join(", ")))
    })
}
