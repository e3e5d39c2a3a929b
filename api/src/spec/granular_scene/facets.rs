//! Walls of triangles.
use std::borrow::Cow;

use base64::{Engine as _, prelude::BASE64_STANDARD};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::surface::{StlError, Triangle, read_stl};

/// A wall of triangles, from a list or from an STL file, exactly one of the two. It is two-sided:
/// bodies on either side are pushed away, to the side that their centre is on. It need not be closed,
/// and moves only when a stage drives it.
///
/// Where triangles meet, a body touches them once: a contact on an edge or corner counts only where
/// no triangle that it lies on has a point nearer to the body's centre, and equal points count once.
/// A flat wall of many triangles is therefore felt like a plane. (Under Yade's convention every
/// triangle pushes by itself, as there.)
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FacetMesh {
    /// Name for stages, tables and `record`.
    #[schemars(length(min = 1, max = 60), regex(pattern = "^[A-Za-z][A-Za-z0-9_]*$"))]
    pub name: String,
    /// Name of a material.
    pub material: String,
    /// Corners of every triangle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 1_000_000), inner(inner(inner(range(min = -1e9, max = 1e9)))), extend("x-unit" = "m"))]
    pub triangles_m: Option<Vec<Triangle>>,
    /// Text of an ASCII STL file, or a binary one in base64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub stl: Option<String>,
    /// Metres in a unit of length of the triangles: 0.001 for an STL file in millimetres.
    #[serde(default = "one")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "1"))]
    pub scale: f64,
    /// Where the origin of the triangles comes to lie.
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub position_m: [f64; 3],
}

/// Why there are no triangles in a wall.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FacetError {
    #[error("facets are either a list of triangles or an STL file")]
    NotOneSource,
    #[error("it is neither ASCII STL, which begins with \"solid\", nor base64: {0}")]
    Base64(String),
    #[error(transparent)]
    Stl(#[from] StlError),
}

impl FacetMesh {
    /// The triangles in their place [m].
    ///
    /// # Errors
    /// See [`FacetError`].
    pub fn triangles(&self) -> Result<Vec<Triangle>, FacetError> {
        let given = match (&self.triangles_m, &self.stl) {
            (Some(triangles), None) => Cow::Borrowed(triangles),
            (None, Some(stl)) => Cow::Owned(read_stl(&stl_bytes(stl)?)?),
            _ => return Err(FacetError::NotOneSource),
        };
        let place = |axis: usize, value: f64| self.position_m[axis] + self.scale * value;
        let placed = given.iter().map(|triangle| {
            triangle.map(|corner| std::array::from_fn(|axis| place(axis, corner[axis])))
        });
        Ok(placed.collect())
    }
}

fn stl_bytes(stl: &str) -> Result<Cow<'_, [u8]>, FacetError> {
    let start = stl.trim_start_matches('\u{feff}').trim_start();
    let word = start.get(..5);
    if word.is_some_and(|word| word.eq_ignore_ascii_case("solid")) {
        return Ok(Cow::Borrowed(stl.as_bytes()));
    }
    // line breaks every 76 signs are usual
    let packed: String = stl.split_ascii_whitespace().collect();
    let bytes = BASE64_STANDARD.decode(packed);
    bytes
        .map(Cow::Owned)
        .map_err(|error| FacetError::Base64(error.to_string()))
}

fn one() -> f64 {
    1.0
}
