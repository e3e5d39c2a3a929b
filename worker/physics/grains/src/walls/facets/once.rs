//! Which triangles a sphere touches, each feature of a surface once.
//!
//! The point of a triangle nearest to a sphere's centre lies on its face, an edge or a corner. Of a
//! surface it is a place of contact only where no other triangle that it lies on has a point nearer
//! still: on a flat wall the edge of a triangle beside the one below the sphere is none, and on a
//! ridge, where both triangles give the same point of their common edge, it is one. This is the
//! rule that a contact is a local minimum of the distance to the surface, asked of the triangles
//! themselves rather than of a table of neighbours: it holds as well for meshes that meet with
//! unequal triangles, and for one wall that goes on where another ends.
//!
//! What takes a triangle's place also takes over what its contact remembers, so that the shear force
//! goes on when a sphere slides or rolls from one triangle to the next.
//!
//! Source: the hierarchy of distances of M. Santasusana, J. Irazábal, E. Oñate and J. M. Carbonell,
//! *The Double Hierarchy Method*, Comput. Part. Mech. 3 (2016) 407. Faces that meet in a hollow edge
//! count both, as two planes do.
use loadframe_api::surface::{Point, closest_point, dot, length, minus};

use super::{Facets, Pose};
use crate::numbers::rows::Row;

/// Points nearer than this part of the sphere's radius are one: ten times what single precision
/// leaves of a coordinate in a file, and far below any feature one would feel.
const SAME: f64 = 1e-6;

/// A triangle that a sphere reaches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// Place among the candidates, those of a sphere one after the other.
    pub(crate) slot: u32,
    /// Number among all facets.
    pub(crate) facet: u32,
    /// Nearest point [m].
    pub(crate) point: Point,
    /// Unit vector from the sphere to there: into the wall.
    pub(crate) normal: Point,
    /// From the sphere's centre to there [m].
    pub(crate) distance: f64,
    /// The one that takes its place, if another does, by place in the list.
    pub(crate) heir: Option<u32>,
}

impl Facets {
    /// The nearest point of a facet, when the sphere reaches it.
    #[inline]
    pub(crate) fn reach(
        &self,
        poses: &[Pose],
        sphere: &Row,
        slot: u32,
        number: u32,
    ) -> Option<Near> {
        let facet = &self.facets[number as usize];
        let pose = &poses[facet.mesh as usize];
        let [x, y, z, radius] = sphere.0;
        let centre = pose.to_local(&[x, y, z]);
        let height = dot(&facet.normal, &minus(&centre, &facet.corners[0]));
        // most candidates end here
        if height.abs() > radius {
            return None;
        }
        let closest = closest_point(&facet.corners, &centre);
        let (normal, distance) = if closest.is_on_face() {
            // the normal of the triangle itself, as of a plane, also for a centre in the wall
            let into = if height < 0.0 { 1.0 } else { -1.0 };
            (facet.normal.map(|part| into * part), height.abs())
        } else {
            let way = minus(&closest.position, &centre);
            let distance = length(&way);
            (way.map(|part| part / distance), distance)
        };
        // on an edge itself there is no direction
        (distance <= radius && normal.iter().all(|part| part.is_finite())).then(|| Near {
            slot,
            facet: number,
            point: pose.to_global(&closest.position),
            normal: pose.direction(&normal),
            distance,
            heir: None,
        })
    }

    /// Unit vector from a sphere's centre to the nearest point of a facet, also of one that it does not reach.
    pub(crate) fn towards(&self, poses: &[Pose], sphere: &Row, number: u32) -> Point {
        let facet = &self.facets[number as usize];
        let pose = &poses[facet.mesh as usize];
        let [x, y, z, _] = sphere.0;
        let centre = pose.to_local(&[x, y, z]);
        let closest = closest_point(&facet.corners, &centre);
        let way = minus(&closest.position, &centre);
        let distance = length(&way);
        // a centre in the plane of the triangle has no direction to its face
        let normal = if closest.is_on_face() || distance <= 0.0 {
            facet.normal
        } else {
            way.map(|part| part / distance)
        };
        pose.direction(&normal)
    }

    /// Finds who takes whose place among the triangles that a sphere of radius `radius` [m] reaches:
    /// the first that is nearer to its centre and has the point in question.
    pub(crate) fn settle(&self, poses: &[Pose], near: &mut [Near], radius: f64) {
        let same = SAME * radius;
        for own in 0..near.len() {
            let mine = near[own];
            let heir = near.iter().position(|other| {
                // equal points are equally near up to round-off: one of them has to go
                let is_nearer = (other.distance, other.slot) < (mine.distance, mine.slot);
                is_nearer && self.has_point(poses, other.facet, &mine.point, same)
            });
            near[own].heir = heir.map(|place| place as u32);
        }
    }

    /// Which of the triangles that a sphere reaches, by place in the list, goes on where one ends that it no
    /// longer reaches: the first that has the point of it nearest to the sphere's centre.
    pub(crate) fn goes_on(
        &self,
        poses: &[Pose],
        sphere: &Row,
        left: u32,
        near: &[Near],
    ) -> Option<usize> {
        let facet = &self.facets[left as usize];
        let pose = &poses[facet.mesh as usize];
        let [x, y, z, radius] = sphere.0;
        let closest = closest_point(&facet.corners, &pose.to_local(&[x, y, z]));
        let point = pose.to_global(&closest.position);
        let same = SAME * radius;
        near.iter()
            .position(|other| self.has_point(poses, other.facet, &point, same))
    }

    /// Whether a facet has this point.
    fn has_point(&self, poses: &[Pose], number: u32, point: &Point, same: f64) -> bool {
        let facet = &self.facets[number as usize];
        let local = poses[facet.mesh as usize].to_local(point);
        let height = dot(&facet.normal, &minus(&local, &facet.corners[0]));
        height.abs() <= same
            && length(&minus(
                &closest_point(&facet.corners, &local).position,
                &local,
            )) <= same
    }
}

/// The one at the end of the line of heirs, each nearer than the one before.
pub(crate) fn last_heir(near: &[Near], place: usize) -> usize {
    let mut last = place;
    while let Some(heir) = near[last].heir {
        last = heir as usize;
    }
    last
}
