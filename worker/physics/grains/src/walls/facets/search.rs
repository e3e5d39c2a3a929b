//! Triangles near a sphere, by grids in the frame of each mesh.
//!
//! Triangles are sorted by the balls around them into levels by size, as spheres are, so that a wall
//! of two triangles and a fine scan can be one mesh. The grids are made once: a mesh does not change
//! in its own frame. They are made anew only when spheres come that reach farther.
use loadframe_api::surface::{bounds, closest_point, dot, length, minus};

use super::{Facets, Mesh, Pose};
use crate::{
    geometry::{
        neighbours::grid::{FINEST, Level},
        sphere::Sphere,
    },
    numbers::rows::Row,
};

/// Reach that the grids are made for, over the one needed now: skins widen and narrow.
const SPARE: f64 = 1.5;

/// Grids of all meshes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Search {
    /// Radius and skin of the spheres that may ask [m].
    reach: f64,
    /// Levels of each mesh.
    levels: Vec<Vec<Level>>,
}

impl Search {
    /// Makes the grids ready for spheres of a radius and a skin that are together `reach` [m].
    pub(crate) fn prepare(&mut self, facets: &Facets, reach: f64) {
        if reach <= self.reach || facets.facets.is_empty() {
            return;
        }
        self.reach = SPARE * reach;
        // around each facet: middle and radius, in the frame of its mesh
        let ball = |facet: &super::Facet| {
            let [lower, upper] = bounds(&facet.corners);
            let middle = std::array::from_fn(|axis| 0.5 * (lower[axis] + upper[axis]));
            let far = facet
                .corners
                .iter()
                .map(|corner| length(&minus(corner, &middle)));
            let [x, y, z] = middle;
            Row([x, y, z, far.fold(0.0, f64::max)])
        };
        let balls: Vec<Row> = facets.facets.iter().map(ball).collect();
        let levels = facets.meshes.iter();
        let levels = levels.map(|mesh| self.levels_of(mesh, &balls));
        self.levels = levels.collect();
    }

    fn levels_of(&self, mesh: &Mesh, balls: &[Row]) -> Vec<Level> {
        let radius = |facet: usize| balls[facet].0[3];
        let largest = mesh.facets.clone().map(radius).fold(0.0, f64::max);
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); FINEST + 1];
        for facet in mesh.facets.clone() {
            let halvings = (largest / radius(facet)).log2();
            members[(halvings as usize).min(FINEST)].push(facet as u32);
        }
        let levels = members.iter().enumerate();
        let filled = levels.filter(|(_, members)| !members.is_empty());
        filled
            .map(|(level, members)| {
                let widest = largest / (1_u64 << level) as f64;
                Level::new(balls, members, widest + self.reach)
            })
            .collect()
    }

    /// Gives `found` all facets closer to `sphere` than `skin` [m], in order.
    pub(crate) fn near(
        &self,
        facets: &Facets,
        poses: &[Pose],
        sphere: &Row,
        skin: f64,
        found: &mut Vec<u32>,
    ) {
        found.clear();
        let [x, y, z, radius] = sphere.0;
        let reach = radius + skin;
        for ((mesh, pose), levels) in facets.meshes.iter().zip(poses).zip(&self.levels) {
            let centre = pose.to_local(&[x, y, z]);
            let [lower, upper] = mesh.bounds;
            let is_away = |axis: usize| {
                centre[axis] + reach < lower[axis] || centre[axis] - reach > upper[axis]
            };
            if (0..3).any(is_away) {
                continue;
            }
            let local = Row([centre[0], centre[1], centre[2], radius]);
            for level in levels {
                level.around(&local, |others, balls| {
                    for (&other, ball) in others.iter().zip(balls) {
                        let facet = &facets.facets[other as usize];
                        // a grain within a vessel is near the balls of all its long triangles, but
                        // to the planes of few
                        let height = dot(&facet.normal, &minus(&centre, &facet.corners[0]));
                        if height.abs() > reach {
                            continue;
                        }
                        let [x, y, z, ball] = ball.0;
                        let way = minus(&centre, &[x, y, z]);
                        if length(&way) > reach + ball {
                            continue;
                        }
                        let closest = closest_point(&facet.corners, &centre).position;
                        if length(&minus(&closest, &centre)) <= reach {
                            found.push(other);
                        }
                    }
                });
            }
        }
        found.sort_unstable();
    }

    /// Whether a sphere reaches no facet.
    pub(crate) fn is_clear(&self, facets: &Facets, poses: &[Pose], sphere: &Sphere) -> bool {
        let mut near = Vec::new();
        let sphere = Row::new(sphere.centre, sphere.radius);
        self.near(facets, poses, &sphere, 0.0, &mut near);
        near.is_empty()
    }
}
