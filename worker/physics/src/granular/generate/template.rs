//! Members of a clump of the spec, found by filling its shape.
use loadframe_api::{
    spec::granular_scene::{Clump, Filled, Lattice, Member, Shape},
    surface::{StlError, read_stl},
};

use super::{GrainError, GrainShape, members};
use crate::granular::{
    Vector,
    lattice::Arrangement,
    mesh::{FillError, TriangleMesh, fill},
    sphere::Sphere,
};

/// Why a shape cannot be filled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum TemplateError {
    #[error(transparent)]
    Grain(#[from] GrainError),
    #[error(transparent)]
    Surface(#[from] FillError),
    #[error(transparent)]
    Stl(#[from] StlError),
}

/// The clump with its members one by one.
///
/// # Errors
/// See [`TemplateError`].
pub(crate) fn resolved(clump: &Clump) -> Result<Clump, TemplateError> {
    let Some(filled) = &clump.filled else {
        return Ok(clump.clone());
    };
    let member = |sphere: Sphere| Member {
        offset_m: sphere.centre.into(),
        radius_m: sphere.radius,
    };
    Ok(Clump {
        members: spheres(filled)?.into_iter().map(member).collect(),
        filled: None,
    })
}

fn spheres(filled: &Filled) -> Result<Vec<Sphere>, TemplateError> {
    let arrangement = match filled.lattice {
        Lattice::Hexagonal => Arrangement::Hexagonal,
        Lattice::SimpleCubic => Arrangement::SimpleCubic,
    };
    let (radius, spacing) = (filled.member_radius_m, filled.spacing());
    let shape = match &filled.shape {
        Shape::Ellipsoid { semi_axes_m } => GrainShape::Ellipsoid {
            semi_axes: *semi_axes_m,
        },
        Shape::Cylinder { radius_m, height_m } => GrainShape::Cylinder {
            radius: *radius_m,
            half_height: 0.5 * height_m,
        },
        Shape::Box { sides_m } => GrainShape::Cuboid { sides: *sides_m },
        Shape::Surface { stl, scale } => {
            let triangles = read_stl(stl.as_bytes())?;
            let scaled = |corner: [f64; 3]| Vector::from(corner) * *scale;
            let triangles: Vec<[Vector; 3]> = triangles
                .into_iter()
                .map(|corners| corners.map(scaled))
                .collect();
            let mesh = TriangleMesh::weld(&triangles);
            let [lower, upper] = mesh.bounds();
            let middle = 0.5 * (lower + upper);
            let mut spheres = fill(&mesh, radius, arrangement, spacing)?;
            for sphere in &mut spheres {
                sphere.centre -= middle;
            }
            return Ok(spheres);
        }
    };
    Ok(members(&shape, radius, arrangement, spacing)?)
}
