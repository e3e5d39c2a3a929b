//! Beds of other programs: text as Yade exports it, data files of LAMMPS.
//!
//! A file is in SI units (as in Yade, and in LAMMPS with `units si`) unless `scale` says otherwise.
//! What it says wrongly is an error with its line.
mod lammps;
mod text;
mod yade;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Body, Clump, Member, Sphere};
pub use text::ImportError;

/// Bodies of a file of another program. Spheres of one clump become one body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Import {
    pub format: ImportFormat,
    /// The whole file.
    #[schemars(length(min = 1, max = 2_000_000_000))]
    pub text: String,
    /// Name of a material, for all of it. A density that the file gives must be the material's.
    pub material: String,
    /// Metres in the file's unit of length; velocities are scaled too.
    #[serde(default = "one")]
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "1"))]
    pub scale: f64,
    /// Added to every position, after scaling.
    #[serde(default)]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub shift_m: [f64; 3],
    /// Whether clumps of the file break: their spheres are bonded instead of rigid.
    #[serde(default)]
    pub breakable_clumps: bool,
}

/// Format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ImportFormat {
    /// Lines `x y z r` or `x y z r clump`, as `yade.export.text` and `textClumps` write them.
    Yade,
    /// A data file with `Atoms # sphere` and perhaps `Velocities`.
    Lammps,
}

fn one() -> f64 {
    1.0
}

/// Densities of file and material differ by rounding at most.
const SAME_DENSITY: f64 = 1e-6;

impl Import {
    /// The bodies of the file, in the order in which it first names them, made of a material of
    /// `density` [kg/m³].
    ///
    /// # Errors
    /// [`ImportError`] when the text is not what its format says.
    pub fn bodies(&self, density: f64) -> Result<Vec<Body>, ImportError> {
        let spheres = match self.format {
            ImportFormat::Yade => yade::read(&self.text),
            ImportFormat::Lammps => lammps::read(&self.text),
        }?;
        let mut bodies: Vec<Body> = Vec::with_capacity(spheres.len());
        let mut clumps: BTreeMap<u32, usize> = BTreeMap::new();
        for sphere in spheres {
            if let Some(found) = sphere.density
                && (found / density - 1.0).abs() > SAME_DENSITY
            {
                return Err(ImportError::Density { found, density });
            }
            let place = |axis: usize| self.shift_m[axis] + self.scale * sphere.centre[axis];
            let centre: [f64; 3] = std::array::from_fn(place);
            let radius_m = self.scale * sphere.radius;
            let Some(clump) = sphere.clump else {
                bodies.push(Body {
                    sphere: Some(Sphere { radius_m }),
                    velocity_m_per_s: sphere.velocity.map(|v| self.scale * v),
                    angular_velocity_rad_per_s: sphere.angular_velocity,
                    ..Body::at(centre, &self.material)
                });
                continue;
            };
            let body = *clumps.entry(clump).or_insert_with(|| {
                bodies.push(Body::at(centre, &self.material));
                bodies.len() - 1
            });
            let body = &mut bodies[body];
            let origin = body.position_m;
            let shape = if self.breakable_clumps {
                &mut body.breakable
            } else {
                &mut body.clump
            };
            let members = &mut shape.get_or_insert_with(Clump::default).members;
            members.push(Member {
                offset_m: std::array::from_fn(|axis| centre[axis] - origin[axis]),
                radius_m,
            });
        }
        Ok(bodies)
    }
}
