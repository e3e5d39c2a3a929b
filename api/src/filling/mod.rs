//! Shapes filled with equal spheres: what a grain of many members is made of.
//!
//! Both sides need this: whoever checks a scene and says what it takes, and whoever runs it.
mod error;
mod lattice;
mod solid;
mod surface;
#[cfg(test)]
mod tests;

pub use error::FillError;
pub use lattice::{Arrangement, Lattice};

use nalgebra::Vector3;

use crate::{
    spec::granular_scene::{Clump, Filled, Member, Shape},
    surface::{StlError, TriangleMesh, read_stl},
};
use solid::Rows;

impl Clump {
    /// The clump with its members one by one.
    ///
    /// # Errors
    /// See [`FillError`].
    pub fn resolved(&self) -> Result<Self, FillError> {
        let Some(filled) = &self.filled else {
            return Ok(self.clone());
        };
        Ok(Self {
            members: filled.members()?,
            filled: None,
        })
    }
}

impl Filled {
    /// The members, about the middle of the shape.
    ///
    /// # Errors
    /// See [`FillError`].
    pub fn members(&self) -> Result<Vec<Member>, FillError> {
        let rows = Rows {
            radius: self.member_radius_m,
            arrangement: self.lattice,
            spacing: self.spacing(),
        };
        let centres = match &self.shape {
            Shape::Ellipsoid { semi_axes_m } => solid::ellipsoid(*semi_axes_m, rows),
            Shape::Cylinder { radius_m, height_m } => {
                solid::cylinder(*radius_m, 0.5 * height_m, rows)
            }
            Shape::Box { sides_m } => solid::cuboid(*sides_m, rows),
            Shape::Surface { stl, scale } => {
                let mesh = scaled(stl, *scale)?;
                let [lower, upper] = mesh.bounds();
                let middle = 0.5 * (lower + upper);
                let mut centres = surface::centres(&mesh, rows)?;
                for centre in &mut centres {
                    *centre -= middle;
                }
                centres
            }
        };
        if centres.is_empty() {
            return Err(FillError::NothingFits(rows.radius));
        }
        let member = |centre: Vector3<f64>| Member {
            offset_m: centre.into(),
            radius_m: rows.radius,
        };
        Ok(centres.into_iter().map(member).collect())
    }

    /// Finds a surface that encloses nothing.
    ///
    /// # Errors
    /// [`FillError::Stl`] and [`FillError::NotClosed`].
    pub(crate) fn check_surface(&self) -> Result<(), FillError> {
        match &self.shape {
            Shape::Surface { stl, scale } => surface::check(&scaled(stl, *scale)?),
            _ => Ok(()),
        }
    }
}

/// The surface in an STL file, in metres.
fn scaled(stl: &str, scale: f64) -> Result<TriangleMesh, StlError> {
    let triangles: Vec<[Vector3<f64>; 3]> = read_stl(stl.as_bytes())?
        .into_iter()
        .map(|corners| corners.map(|corner| Vector3::from(corner) * scale))
        .collect();
    Ok(TriangleMesh::weld(&triangles))
}
