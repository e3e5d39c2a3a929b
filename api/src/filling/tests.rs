//! Surfaces that are filled, and what cannot be.
use super::*;
use crate::{
    Submission, SubmissionError,
    surface::{ball, block},
};

#[test]
fn a_box_is_filled_to_its_walls() {
    let mesh = TriangleMesh::weld(&block([5.0, 3.0, 3.0]));
    let spheres = surface::centres(&mesh, Rows::touching(0.5, Arrangement::SimpleCubic))
        .expect("it is closed");
    assert_eq!(spheres.len(), 5 * 3 * 3);
    // between 2 and 3 of them fit along a box of 2.9
    let mesh = TriangleMesh::weld(&block([5.0, 2.9, 2.9]));
    let spheres = surface::centres(&mesh, Rows::touching(0.5, Arrangement::SimpleCubic))
        .expect("it is closed");
    assert_eq!(spheres.len(), 5);
}

#[test]
fn a_ball_is_filled_by_135_spheres_of_the_thesis_radius() {
    let mesh = TriangleMesh::weld(&ball(24.0, 5));
    let spheres =
        surface::centres(&mesh, Rows::touching(3.6, Arrangement::Hexagonal)).expect("it is closed");
    assert!(spheres.iter().all(|centre| centre.norm() + 3.6 <= 24.0));
    assert_eq!(spheres.len(), 135);
}

#[test]
fn what_cannot_be_filled_says_why() {
    let facet = |[a, b, c]: [[f64; 3]; 3]| {
        let vertex = |[x, y, z]: [f64; 3]| format!("vertex {x} {y} {z}\n");
        let corners = [a, b, c].map(vertex).concat();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let mut triangles: Vec<_> = (block([1.0; 3]).into_iter())
        .map(|corners| facet(corners.map(Into::into)))
        .collect();
    let filled = |triangles: &[String]| Filled {
        shape: Shape::Surface {
            stl: format!("solid cube\n{}endsolid cube\n", triangles.concat()),
            scale: 0.1,
        },
        member_radius_m: 0.06,
        lattice: Arrangement::SimpleCubic,
        spacing_m: None,
    };
    let message = |filled: &Filled| filled.members().expect_err("it cannot").to_string();
    assert_eq!(
        message(&filled(&triangles)),
        "no sphere of radius 0.06 m fits into the shape"
    );
    assert_eq!(filled(&triangles).check_surface(), Ok(()));
    triangles.pop();
    let open = filled(&triangles);
    assert_eq!(
        message(&open),
        "the surface is not closed: 3 boundary edges and 0 edges between triangles of opposite orientation"
    );
    assert!(open.check_surface().is_err());
}

/// A disc that is as thin as its members has a layer of them, of any number.
#[test]
fn thin_shapes_of_too_many_members_are_not_tried() {
    let body = |axes: [f64; 3], radius: f64| {
        format!(
            r#"{{"kind": "granular_scene", "spec": {{"version": 1,
                "materials": {{"stone": {{"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8}}}},
                "bodies": [{{"material": "stone", "position_m": [0, 0, 0], "clump": {{"filled":
                    {{"shape": {{"ellipsoid": {{"semi_axes_m": {axes:?}}}}}, "member_radius_m": {radius}}}}}}}],
                "stages": [{{"run": {{"steps": 1}}}}]}}}}"#
        )
    };
    for axes in [[1e-9, 1e6, 1e6], [1e-9, 1e-9, 1e6]] {
        let text = body(axes, 1e-9);
        let refused = Submission::from_slice(text.as_bytes()).expect_err("too many");
        let SubmissionError::Invalid(violations) = refused else {
            panic!("{refused}");
        };
        let pointer = "/spec/bodies/0/clump/filled/member_radius_m";
        assert!(
            violations
                .iter()
                .any(|it| it.pointer == pointer && it.code == "too_large"),
            "{violations:#?}"
        );
    }
    let thin = body([0.001, 0.02, 0.02], 0.001);
    Submission::from_slice(thin.as_bytes()).expect("one layer");
}
