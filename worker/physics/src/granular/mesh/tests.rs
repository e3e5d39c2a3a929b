#![allow(clippy::float_cmp, reason = "these numbers are exact")]
use std::f64::consts::PI;

use super::*;
use crate::granular::lattice::Arrangement;

/// The box [0, sides], as loose triangles.
fn cuboid(sides: [f64; 3]) -> Vec<[Vector3<f64>; 3]> {
    let corner = |number: usize| {
        Vector3::from_fn(|axis, _| {
            if number >> axis & 1 == 1 {
                sides[axis]
            } else {
                0.0
            }
        })
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    faces
        .into_iter()
        .flat_map(halves)
        .map(|corners| corners.map(corner))
        .collect()
}

/// A sphere of triangles: an octahedron, each face divided `times` times.
fn ball(radius: f64, times: u32) -> Vec<[Vector3<f64>; 3]> {
    let mut triangles = Vec::new();
    for octant in 0..8_u32 {
        let sign = |axis: u32| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
        let [x, y, z] = [0, 1, 2].map(|axis| Vector3::ith(axis as usize, sign(axis)));
        let is_even = octant.count_ones() % 2 == 0;
        triangles.push(if is_even { [x, y, z] } else { [y, x, z] });
    }
    for _ in 0..times {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]: [Vector3<f64>; 3]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum.normalize());
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    triangles
        .iter()
        .map(|corners| corners.map(|corner| corner * radius))
        .collect()
}

#[test]
fn a_box_is_welded_closed_and_measured() {
    let mesh = TriangleMesh::weld(&cuboid([1.0, 2.0, 3.0]));
    assert_eq!(
        (mesh.vertices.len(), mesh.triangles.len(), mesh.degenerate),
        (8, 12, 0)
    );
    assert!(mesh.seams.is_closed());
    assert_eq!(
        mesh.bounds(),
        [Vector3::zeros(), Vector3::new(1.0, 2.0, 3.0)]
    );
    assert!((mesh.signed_volume() - 6.0).abs() < 1e-14);
}

#[test]
fn corners_a_rounding_apart_are_one_vertex() {
    let mut triangles = cuboid([1.0, 2.0, 3.0]);
    for (number, corners) in triangles.iter_mut().enumerate() {
        corners[0] += Vector3::new(1e-7, -1e-7, 1e-7) * (number as f64 % 3.0 - 1.0);
    }
    let mesh = TriangleMesh::weld(&triangles);
    assert_eq!(mesh.vertices.len(), 8);
    assert!(mesh.seams.is_closed());
}

/// Vertices that lie close, but not close enough, are found again each.
#[test]
fn neighbouring_vertices_stay_apart() {
    let far = Vector3::new(1.0, 0.0, 0.0);
    // two corners of a cell of the grid, 1.6 weld distances apart
    let near = [Vector3::repeat(1e-8), Vector3::repeat(0.95e-6)];
    let [first, second] = near;
    let triangles = [[first, far, second], [second, far, first]];
    let mesh = TriangleMesh::weld(&triangles.repeat(3));
    assert_eq!(mesh.vertices.len(), 3);
    assert!(mesh.seams.is_closed());
}

#[test]
fn a_hole_and_a_flipped_triangle_are_counted() {
    let mut triangles = cuboid([1.0; 3]);
    triangles.remove(5);
    let open = TriangleMesh::weld(&triangles).seams;
    assert_eq!((open.boundary_edges, open.misoriented_edges), (3, 0));
    let mut triangles = cuboid([1.0; 3]);
    triangles[5].swap(0, 1);
    let flipped = TriangleMesh::weld(&triangles).seams;
    assert_eq!((flipped.boundary_edges, flipped.misoriented_edges), (0, 3));
    // one inside out as a whole is closed, with a negative volume
    let mut triangles = cuboid([1.0; 3]);
    triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
    let mesh = TriangleMesh::weld(&triangles);
    assert!(mesh.seams.is_closed() && (mesh.signed_volume() + 1.0).abs() < 1e-14);
    assert!(mesh.encloses(&Vector3::repeat(0.5)));
}

/// A needle without area between two triangles keeps the surface closed, but is not contacted.
#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let mut triangles = cuboid([1.0; 3]);
    let [a, b, c] = triangles.remove(0);
    let middle = (a + b) * 0.5;
    triangles.extend([[a, middle, c], [middle, b, c], [a, b, middle], [a, a, b]]);
    let mesh = TriangleMesh::weld(&triangles);
    assert_eq!((mesh.triangles.len(), mesh.degenerate), (13, 2));
    assert!(mesh.seams.is_closed(), "{:?}", mesh.seams);
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-14);
}

#[test]
fn inside_is_inside_however_close_to_the_surface() {
    let sides = [1.0, 2.0, 3.0];
    let mesh = TriangleMesh::weld(&cuboid(sides));
    let margin = 1e-9;
    // rays from these points run through edges and corners
    let inside = [
        [0.5, 1.0, 1.5],
        [margin, 1.0, 1.5],
        [0.5, 0.5, margin],
        [margin; 3],
    ];
    let outside = [
        [-margin, 1.0, 1.5],
        [0.5, 1.0, 3.0 + margin],
        [-margin; 3],
        [9.0, 1.0, 1.5],
    ];
    assert!(
        inside
            .iter()
            .all(|point| mesh.encloses(&Vector3::from(*point)))
    );
    assert!(
        !outside
            .iter()
            .any(|point| mesh.encloses(&Vector3::from(*point)))
    );
}

#[test]
fn a_fine_ball_has_nearly_the_volume_of_a_sphere() {
    let mesh = TriangleMesh::weld(&ball(2.0, 5));
    assert!(mesh.seams.is_closed());
    assert_eq!(mesh.vertices.len(), 4 * 4_usize.pow(5) + 2);
    let ratio = mesh.signed_volume() / (32.0 / 3.0 * PI);
    assert!(ratio < 1.0 && ratio > 0.998, "{ratio}");
}

#[test]
fn a_box_is_filled_to_its_walls() {
    let mesh = TriangleMesh::weld(&cuboid([5.0, 3.0, 3.0]));
    let spheres = fill(&mesh, 0.5, Arrangement::SimpleCubic, 1.0).expect("it fits");
    assert_eq!(spheres.len(), 5 * 3 * 3);
    // between 2 and 3 of them fit along a box of 2.9
    let mesh = TriangleMesh::weld(&cuboid([5.0, 2.9, 2.9]));
    let spheres = fill(&mesh, 0.5, Arrangement::SimpleCubic, 1.0).expect("it fits");
    assert_eq!(spheres.len(), 5);
}

#[test]
fn a_ball_is_filled_by_135_spheres_of_the_thesis_radius() {
    let mesh = TriangleMesh::weld(&ball(24.0, 5));
    let spheres = fill(&mesh, 3.6, Arrangement::Hexagonal, 7.2).expect("it fits");
    let reach = |sphere: &crate::granular::sphere::Sphere| sphere.centre.norm() + sphere.radius;
    assert!(spheres.iter().all(|sphere| reach(sphere) <= 24.0));
    assert_eq!(spheres.len(), 135);
}

#[test]
fn what_cannot_be_filled_says_why() {
    let mut triangles = cuboid([1.0; 3]);
    let mesh = TriangleMesh::weld(&triangles);
    let message = |mesh| {
        fill(mesh, 0.6, Arrangement::SimpleCubic, 1.0)
            .expect_err("no")
            .to_string()
    };
    assert_eq!(
        message(&mesh),
        "no sphere of radius 0.6 fits into the surface, whose bounding box is 1 x 1 x 1"
    );
    triangles.pop();
    assert_eq!(
        message(&TriangleMesh::weld(&triangles)),
        "the surface is not closed: 3 boundary edges and 0 edges between triangles of opposite orientation"
    );
}
