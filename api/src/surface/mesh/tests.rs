#![allow(clippy::float_cmp, reason = "these numbers are exact")]
use std::f64::consts::PI;

use super::*;
use crate::surface::{Triangle, ball, block, enclosed_volume};

fn volume(mesh: &TriangleMesh) -> f64 {
    let triangles: Vec<Triangle> = mesh.corners().map(|it| it.map(Into::into)).collect();
    enclosed_volume(&triangles)
}

#[test]
fn a_box_is_welded_closed_and_measured() {
    let mesh = TriangleMesh::weld(&block([1.0, 2.0, 3.0]));
    assert_eq!(
        (mesh.vertices.len(), mesh.triangles.len(), mesh.degenerate),
        (8, 12, 0)
    );
    assert!(mesh.seams.is_closed());
    assert_eq!(
        mesh.bounds(),
        [Vector3::zeros(), Vector3::new(1.0, 2.0, 3.0)]
    );
    assert!((volume(&mesh) - 6.0).abs() < 1e-14);
}

#[test]
fn corners_a_rounding_apart_are_one_vertex() {
    let mut triangles = block([1.0, 2.0, 3.0]);
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
    let mut triangles = block([1.0; 3]);
    triangles.remove(5);
    let open = TriangleMesh::weld(&triangles).seams;
    assert_eq!((open.boundary_edges, open.misoriented_edges), (3, 0));
    let mut triangles = block([1.0; 3]);
    triangles[5].swap(0, 1);
    let flipped = TriangleMesh::weld(&triangles).seams;
    assert_eq!((flipped.boundary_edges, flipped.misoriented_edges), (0, 3));
    // one inside out as a whole is closed
    let mut triangles = block([1.0; 3]);
    triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
    let mesh = TriangleMesh::weld(&triangles);
    assert!(mesh.seams.is_closed() && (volume(&mesh) - 1.0).abs() < 1e-14);
    assert!(mesh.encloses(&Vector3::repeat(0.5)));
}

/// A needle without area between two triangles keeps the surface closed, but is not contacted.
#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let mut triangles = block([1.0; 3]);
    let [a, b, c] = triangles.remove(0);
    let middle = (a + b) * 0.5;
    triangles.extend([[a, middle, c], [middle, b, c], [a, b, middle], [a, a, b]]);
    let mesh = TriangleMesh::weld(&triangles);
    assert_eq!((mesh.triangles.len(), mesh.degenerate), (13, 2));
    assert!(mesh.seams.is_closed(), "{:?}", mesh.seams);
    assert!((volume(&mesh) - 1.0).abs() < 1e-14);
}

#[test]
fn inside_is_inside_however_close_to_the_surface() {
    let sides = [1.0, 2.0, 3.0];
    let mesh = TriangleMesh::weld(&block(sides));
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
    let ratio = volume(&mesh) / (32.0 / 3.0 * PI);
    assert!(ratio < 1.0 && ratio > 0.998, "{ratio}");
}
