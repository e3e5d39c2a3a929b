//! A cylinder as triangles, a sleeper as spheres.
use std::f64::consts::TAU;

use super::super::granular_scene::Member;
use crate::surface::{Point, Triangle, rectangle};

/// Distance of the corners from the axis of a regular prism with as large a cross-section as a
/// cylinder of this radius.
pub(super) fn corner_radius(radius: f64, facets: u32) -> f64 {
    let angle = TAU / f64::from(facets);
    radius * (angle / angle.sin()).sqrt()
}

/// Distance of the faces of that prism from its axis.
pub(super) fn face_radius(radius: f64, facets: u32) -> f64 {
    corner_radius(radius, facets) * (0.5 * TAU / f64::from(facets)).cos()
}

/// A prism about z with as large a cross-section as a cylinder of this radius, without lids.
pub(super) fn cylinder(radius: f64, height: f64, facets: u32) -> Vec<Triangle> {
    let corner = |index: u32, z: f64| -> Point {
        let angle = TAU * f64::from(index % facets) / f64::from(facets);
        let radius = corner_radius(radius, facets);
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let sides = (0..facets).flat_map(|index| {
        let [left, right] = [index, index + 1];
        rectangle([
            corner(left, 0.0),
            corner(left, height),
            corner(right, height),
            corner(right, 0.0),
        ])
    });
    sides.collect()
}

/// Spheres of a radius in a row along each side of a shell.
fn rows(sides: [f64; 3], radius: f64) -> [usize; 3] {
    // a hair more than fits: sides that are whole numbers of diameters are rounded
    sides.map(|side| ((0.5 * side / radius + 1e-9).floor() as usize).max(1))
}

/// Number of spheres in a [`shell`] of these sides.
pub(super) fn shell_members(sides: [f64; 3], radius: f64) -> usize {
    let rows = rows(sides, radius);
    let product = |rows: [usize; 3]| rows.into_iter().fold(1, usize::saturating_mul);
    product(rows) - product(rows.map(|row| row.saturating_sub(2)))
}

/// Equal spheres that do not overlap along the faces of an upright box, touching them from inside;
/// offsets are from its lower corner.
pub(super) fn shell(lower: Point, upper: Point, radius: f64) -> Vec<Member> {
    let sides: [f64; 3] = std::array::from_fn(|axis| upper[axis] - lower[axis]);
    let counts = rows(sides, radius);
    let place = |index: [usize; 3]| {
        std::array::from_fn(|axis| {
            let gaps = (counts[axis] - 1).max(1) as f64;
            radius + (sides[axis] - 2.0 * radius) * index[axis] as f64 / gaps
        })
    };
    let all = (0..counts.iter().product()).map(|number: usize| {
        let [x, y, _] = counts;
        [number % x, number / x % y, number / (x * y)]
    });
    let outer =
        all.filter(|index| (0..3).any(|axis| index[axis] == 0 || index[axis] + 1 == counts[axis]));
    let member = |index| Member {
        offset_m: place(index),
        radius_m: radius,
    };
    outer.map(member).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{cross, length, minus};

    #[test]
    fn a_shell_of_spheres_touches_all_faces_and_not_itself() {
        let members = shell([0.0; 3], [0.25, 0.3, 0.15], 0.005);
        assert_eq!(members.len(), 25 * 30 * 15 - 23 * 28 * 13);
        for sides in [[0.25, 0.3, 0.15], [0.01, 0.3, 0.15], [0.001, 0.001, 1.0]] {
            let told = shell_members(sides, 0.005);
            assert_eq!(told, shell([0.0; 3], sides, 0.005).len(), "{sides:?}");
        }
        for axis in 0..3 {
            let ends = members.iter().map(|member| member.offset_m[axis]);
            let largest = ends.fold(0.0, f64::max);
            assert!((largest - ([0.25, 0.3, 0.15][axis] - 0.005)).abs() < 1e-12);
        }
        let apart = length(&minus(&members[0].offset_m, &members[1].offset_m));
        assert!(apart > 0.01 - 1e-12, "{apart}");
    }

    #[test]
    fn a_prism_holds_what_its_cylinder_holds() {
        let area = |[a, b, c]: &Triangle| 0.5 * length(&cross(&minus(b, a), &minus(c, a)));
        let faces = cylinder(0.15, 0.2, 24);
        let side: f64 = faces.iter().map(area).sum();
        // perimeter times apothem is twice the cross-section
        let section = 0.5 * side / 0.2 * face_radius(0.15, 24);
        let circle = 0.5 * TAU * 0.15 * 0.15;
        assert!((section / circle - 1.0).abs() < 1e-12, "{section} {circle}");
    }
}
