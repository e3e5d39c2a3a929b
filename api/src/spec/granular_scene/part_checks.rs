//! Checks of what many parts of a scene have: a material, a clump.
use super::{Clump, Filled, GranularScene, Shape, grains::MOST_MEMBERS};
use crate::{Violation, filling::FillError};

/// Places times triangles that are looked at to fill a surface, at most: some minutes.
const MOST_LOOKS: f64 = 5e9;

/// Shapes that are filled to be checked have so many members together, at most: a second's work.
const MOST_FILLED: u64 = 2_000_000;

/// Every shape may be filled by itself, and all of them together take too long.
pub(super) fn check_filled_together(spec: &GranularScene) -> Option<Violation> {
    let given = spec.bodies.iter().enumerate().filter_map(|(index, body)| {
        let filled = body.members()?.filled.as_ref()?;
        Some((index, filled))
    });
    let given = given.map(|(index, filled)| (format!("/bodies/{index}"), filled));
    let made = spec.generators().filter_map(|(pointer, generator)| {
        let filled = generator.grain.template()?.filled.as_ref()?;
        Some((pointer, filled))
    });
    let replacing = spec.replacements().filter_map(|(index, replace)| {
        let filled = replace.clump.filled.as_ref()?;
        Some((format!("/stages/{index}/replace/clump"), filled))
    });
    let mut members = 0_u64;
    for (pointer, filled) in given.chain(made).chain(replacing) {
        let own = filled.members_by_size();
        if own <= MOST_MEMBERS {
            members += own;
        }
        if members > MOST_FILLED {
            let detail = "the shapes up to this one are filled with too many spheres together";
            let violation = Violation::new(pointer, "too_large", detail).value(members);
            return Some(violation.allowed(format!(
                "at most {MOST_FILLED} spheres in all shapes; grains that are alike come from one \
                 template of generate"
            )));
        }
    }
    None
}

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
            .allowed("a material with normal_cohesion_pa or shear_cohesion_pa above 0, or a parallel_bond")
    })
}

pub(super) fn check_material(spec: &GranularScene, pointer: &str, name: &str) -> Option<Violation> {
    (!spec.materials.contains_key(name)).then(|| {
        let names: Vec<&str> = spec.materials.keys().map(String::as_str).collect();
        Violation::new(
            format!("{pointer}/material"),
            "no_such_material",
            "no material has this name",
        )
        .value(name)
        .allowed(format!("one of: {}", names.join(", ")))
    })
}
