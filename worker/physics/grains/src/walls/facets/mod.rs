//! Walls of triangles: where they are, how they move, which spheres they may touch.
//!
//! A [`Mesh`] stays as it is for a run, in a frame of its own; a [`Pose`] says where that frame is
//! and how it moves. Whoever asks about a sphere takes it into the mesh's frame, so that a wall that
//! moves costs no more than one that stands. [`search`] finds the triangles near a sphere, [`once`]
//! the ones that a sphere touches of those near it. What a touch does is told in
//! [`crate::contact::facets`].
pub(crate) mod once;
mod pose;
pub(crate) mod search;

use loadframe_api::{
    spec::granular_scene::{Convention, GranularScene},
    surface::{Point, Triangle, bounds, length, minus, unit_normal},
};

pub(crate) use pose::Pose;

/// A triangle in the frame of its mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(crate) corners: Triangle,
    /// Unit normal.
    pub(crate) normal: Point,
    /// Number of its mesh.
    pub(crate) mesh: u32,
}

/// A wall of triangles.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    pub(crate) name: String,
    /// Number of its material.
    pub(crate) surface: usize,
    /// Its facets among those of all meshes.
    pub(crate) facets: std::ops::Range<usize>,
    /// Middle [m] and radius [m] of a sphere around it, in its frame.
    pub(crate) ball: (Point, f64),
    /// Box around it, in its frame [m].
    pub(crate) bounds: [Point; 2],
}

/// All walls of triangles of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Facets {
    pub(crate) meshes: Vec<Mesh>,
    /// Facets of all meshes, one mesh after the other.
    pub(crate) facets: Vec<Facet>,
    pub(crate) rule: FacetRule,
    /// Radius that a facet brings to the stiffness of a contact, over that of the sphere.
    pub(crate) radius_ratio: f64,
}

/// Whose rule a contact with a facet follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FacetRule {
    /// As a plane, and where triangles meet once.
    Once,
    /// Every triangle by itself, by Yade's `Ig2_Facet_Sphere_ScGeom`.
    Each,
}

impl Facets {
    /// Those of `spec`; materials by the place of their names in order.
    pub(crate) fn new(spec: &GranularScene) -> Self {
        let names: Vec<&String> = spec.materials.keys().collect();
        let mut all = Self {
            meshes: Vec::with_capacity(spec.facets.len()),
            facets: Vec::new(),
            rule: match spec.laws.convention {
                Convention::Loadframe => FacetRule::Once,
                Convention::Yade => FacetRule::Each,
            },
            radius_ratio: spec.laws.facet_radius_ratio(),
        };
        for (mesh, wall) in (0..).zip(&spec.facets) {
            // a checked spec has triangles, all of them with an area
            let triangles = wall.triangles().unwrap_or_default();
            let first = all.facets.len();
            all.facets.extend(triangles.iter().filter_map(|corners| {
                Some(Facet {
                    corners: *corners,
                    normal: unit_normal(corners)?,
                    mesh,
                })
            }));
            let [lower, upper] = bounds(triangles.iter().flatten());
            let middle = std::array::from_fn(|axis| 0.5 * (lower[axis] + upper[axis]));
            all.meshes.push(Mesh {
                name: wall.name.clone(),
                surface: names.binary_search(&&wall.material).unwrap_or_default(),
                facets: first..all.facets.len(),
                ball: (middle, 0.5 * length(&minus(&upper, &lower))),
                bounds: [lower, upper],
            });
        }
        all
    }

    /// Number of the material of a facet.
    pub(crate) fn surface_of(&self, facet: u32) -> usize {
        self.meshes[self.facets[facet as usize].mesh as usize].surface
    }
}
