//! What fills the section: a matrix or plies, and fibres that do not share a place.
use super::materials::unknown_material;
use crate::section::error::CompositeError;
use crate::section::fibre::{Band, Fibre, refuse_overlap};
use crate::spec::composite_bending::CompositeBending;
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations};

/// Thicknesses of plies sum up to the height within this part of it.
const PLIES_FILL: f64 = 1e-9;

/// A matrix or plies, whose thicknesses fill the height.
pub(super) fn check_filling(spec: &CompositeBending, violations: &mut Violations) {
    match (&spec.matrix, spec.plies.is_empty()) {
        (Some(name), true) => {
            violations.extend(unknown_material(&spec.materials, "/matrix", name));
        }
        (None, true) => violations.push(
            Violation::new("/matrix", "missing", "nothing fills the section")
                .allowed("the name of a material, or plies"),
        ),
        (Some(name), false) => violations.push(
            Violation::new(
                "/matrix",
                "not_allowed",
                "the plies fill the section already",
            )
            .value(name.as_str())
            .allowed("a matrix or plies, not both"),
        ),
        (None, false) => {}
    }
    let unknown = spec.plies.iter().enumerate().filter_map(|(index, ply)| {
        unknown_material(
            &spec.materials,
            format!("/plies/{index}/material"),
            &ply.material,
        )
    });
    violations.extend(unknown.take(LISTED_OF_A_SORT));
    let filled: f64 = spec.plies.iter().map(|ply| ply.thickness_mm).sum();
    let height = spec.section.height_mm;
    if !spec.plies.is_empty() && (filled - height).abs() > PLIES_FILL * height {
        violations.push(
            Violation::new(
                "/plies",
                "plies_do_not_fill",
                "the thicknesses of the plies do not sum up to the section's height",
            )
            .value(filled)
            .allowed(format!("height_mm = {height}"))
            .unit("mm"),
        );
    }
}

pub(super) fn check_fibres(spec: &CompositeBending, violations: &mut Violations) {
    let before = violations.count();
    let sides = [spec.section.length_mm, spec.section.height_mm];
    let mut bands = Vec::with_capacity(spec.fibres.len());
    for (index, fibre) in spec.fibres.iter().enumerate() {
        if violations.count() - before >= LISTED_OF_A_SORT {
            break;
        }
        let pointer = format!("/fibres/{index}");
        violations.extend(unknown_material(
            &spec.materials,
            format!("{pointer}/material"),
            &fibre.material,
        ));
        let band = Fibre {
            material: 0,
            through_mm: fibre.through_mm,
            angle_deg: fibre.angle_deg,
            thickness_mm: fibre.thickness_mm,
            length_mm: fibre.length_mm,
        };
        match Band::new(index, &band, sides) {
            Ok(band) => bands.push(band),
            Err(_) => violations.push(
                Violation::new(
                    format!("{pointer}/through_mm"),
                    "outside_section",
                    "the fibre does not touch the section",
                )
                .value(fibre.through_mm.to_vec())
                .allowed(format!(
                    "a point with x from 0 to {}, y from 0 to {}",
                    sides[0], sides[1]
                ))
                .unit("mm"),
            ),
        }
    }
    if violations.count() > before {
        return;
    }
    if let Err(CompositeError::Overlap {
        first,
        second,
        area_mm2,
        x_mm,
        y_mm,
    }) = refuse_overlap(&bands)
    {
        violations.push(
            Violation::new(
                format!("/fibres/{second}"),
                "overlap",
                format!(
                    "fibres {first} and {second} share {area_mm2:.6} mm² around ({x_mm:.6}, \
                     {y_mm:.6}) mm: move one, or cut it with a length"
                ),
            )
            .value(area_mm2)
            .allowed("fibres that do not overlap"),
        );
    }
}
