//! Filling a closed surface with spheres.
use nalgebra::Vector3;

use super::{error::FillError, lattice::Lattice, solid::Rows};
use crate::surface::{TriangleMesh, closest_point};

/// Finds a surface with holes, or with triangles that turn both ways.
///
/// # Errors
/// [`FillError::NotClosed`].
pub(super) fn check(mesh: &TriangleMesh) -> Result<(), FillError> {
    if mesh.seams.is_closed() {
        Ok(())
    } else {
        Err(FillError::NotClosed(mesh.seams))
    }
}

/// Centres of members that lie wholly inside a closed surface, one of the lattice's points in the
/// middle of its bounding box; radius and spacing in the unit of the surface.
///
/// A spacing below 2 radii makes members overlap and the grain smoother. Costs some 50 ns per
/// lattice point in the bounding box and triangle: 18 ms for 135 members in 2000 triangles.
///
/// # Errors
/// [`FillError::NotClosed`].
pub(super) fn centres(mesh: &TriangleMesh, rows: Rows) -> Result<Vec<Vector3<f64>>, FillError> {
    check(mesh)?;
    let [lower, upper] = mesh.bounds();
    let anchor = (lower + upper) * 0.5;
    let lattice = Lattice {
        arrangement: rows.arrangement,
        spacing: rows.spacing,
        anchor,
    };
    let clearance = rows.clearance();
    let fits = |centre: &Vector3<f64>| {
        let is_clear = mesh.corners().all(|corners| {
            let closest = closest_point(&corners.map(Into::into), &(*centre).into()).position;
            (Vector3::from(closest) - centre).norm_squared() >= clearance * clearance
        });
        is_clear && mesh.encloses(centre)
    };
    let inset = Vector3::repeat(clearance);
    let mut centres = lattice.points_between(&(lower + inset), &(upper - inset));
    centres.retain(fits);
    Ok(centres)
}
