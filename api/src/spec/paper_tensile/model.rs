//! How a fibre is modelled.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fibre::{self, Division};

/// The model of a fibre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Model {
    /// Left out: a single fibre is a tube, and fibres of sheets are beams.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<Level>,
    /// Wanted length of a segment; a whole number of them makes up the fibre. Left out: the shortest
    /// without negative springs, which bends most like the wall. So of a single fibre and of tubes in sheets. Of beams and
    /// bars in a sheet that is given: the longest
    /// segment, none if left out. In one that is made: the length of the straight parts of a fibre,
    /// that of the accuracy if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.01, max = 1e5), extend("x-unit" = "µm"))]
    pub segment_um: Option<f64>,
    /// Points of a ring: even, for springs across join opposite ones.
    #[schemars(range(min = 4, max = 16), extend("multipleOf" = 2, "x-unit" = "1"))]
    pub points_on_ring: u32,
    pub ring: Ring,
    pub on_inadmissible: OnInadmissible,
    /// Timoshenko's shear coefficient of beams. Left out: that of a thin round tube,
    /// 2 (1 + ν)/(4 + 3 ν).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.01, max = 10.0), extend("x-unit" = "1"))]
    pub shear_coefficient: Option<f64>,
    /// Of a truss: strain by which its bars are taut before they are pulled, as fibres are that dried held. What
    /// a truss leaves loose is held by that alone; the larger it is the stiffer is the sheet and the fewer
    /// iterations find its equilibrium. Left out: 1e-9, which changes nothing of what is not loose.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 0.01), extend("x-unit" = "1"))]
    pub taut_strain: Option<f64>,
}

/// How much of a fibre the model knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Rings of points with springs between. In sheets bonds hold on to the points around the place where fibres touch;
    /// for small sheets, for its factor has ten to twenty times the entries of one of beams.
    Tube,
    /// Beams with extension, bending, shear and torsion, bonded also against turning. Of sheets.
    Beam,
    /// Bars that are only stretched and hinged at their ends. Of sheets, for comparison: one of fibres
    /// shorter than the distance of the jaws is a mechanism.
    Truss,
}

/// Where in the wall the ring of points lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Ring {
    /// On the radius of gyration of torsion: area and torsion agree.
    #[default]
    Gyration,
    /// On the face of the lumen, as the patent has it.
    Patent,
}

/// What is done where a segment of the wanted length needs springs of negative stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OnInadmissible {
    /// Segments are made as short as the window of admissible lengths allows.
    #[default]
    Refine,
    /// The job is refused, with the window.
    Reject,
    /// The length is kept; springs around and along get independent of one another, and G is lowered
    /// as far as it must be.
    Robust,
}

impl Level {
    /// Name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tube => "tube",
            Self::Beam => "beam",
            Self::Truss => "truss",
        }
    }
}

impl Default for Model {
    fn default() -> Self {
        Self {
            level: None,
            segment_um: None,
            points_on_ring: 6,
            ring: Ring::default(),
            on_inadmissible: OnInadmissible::default(),
            shear_coefficient: None,
            taut_strain: None,
        }
    }
}

impl Model {
    /// The same as the engine takes it.
    pub fn division(&self) -> Division {
        Division {
            points_on_ring: self.points_on_ring as usize,
            ring: match self.ring {
                Ring::Gyration => fibre::Ring::Gyration,
                Ring::Patent => fibre::Ring::Patent,
            },
            segment_um: self.segment_um,
            on_inadmissible: match self.on_inadmissible {
                OnInadmissible::Refine => fibre::OnInadmissible::Refine,
                OnInadmissible::Reject => fibre::OnInadmissible::Reject,
                OnInadmissible::Robust => fibre::OnInadmissible::Robust,
            },
        }
    }
}
