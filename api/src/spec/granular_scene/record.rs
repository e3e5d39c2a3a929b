//! What is written.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Region, VoidMap};

/// What is written, and how often. A row that names a step holds the state after that step; its
/// contacts are those whose forces moved the bodies in that step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Record {
    /// Steps between rows of `curve.csv`, `bodies.csv` and `contacts.csv`. The state before the
    /// first step and after the last one is always written.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub every_steps: u64,
    /// The stage, from 0, with which rows and snapshots begin. What happens before is written at the
    /// ends of stages only.
    #[serde(skip_serializing_if = "is_zero")]
    pub from_stage: usize,
    /// Bodies whose motion goes to `bodies.csv`; left out, all of them when fewer than 1000.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(max = 10_000_000))]
    pub bodies: Option<Vec<u32>>,
    /// A row of `curve.csv` at the end of every stage too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub stage_ends: bool,
    /// Planes whose force and displacement go to `curve.csv`.
    #[schemars(length(max = 1000))]
    pub planes: Vec<String>,
    /// Walls, planes and facets alike, whose force and displacement go to `curve.csv` as vectors,
    /// beside those that a `drive` stage drives, which are written in any case.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub walls: Vec<String>,
    /// Walls, planes and facets alike, whose normal forces go to `curve.csv` added up as numbers: what
    /// presses a cylinder apart, which as vectors cancels.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub normal_forces: Vec<String>,
    /// Clumps of `bodies` whose turn since the start goes to `curve.csv`: as a vector along the axis, as
    /// long as the angle.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub turns: Vec<u32>,
    /// Boxes in which the scene is measured for `curve.csv`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100))]
    pub regions: Vec<Region>,
    /// A map of porosity at the ends of stages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voids: Option<VoidMap>,
    /// Whether contacts go to `contacts.csv`.
    pub contacts: bool,
    /// Steps between snapshots for ParaView; 0 writes none.
    #[schemars(range(max = 1_000_000_000_000_u64))]
    pub snapshot_every_steps: u64,
}

/// Fewer bodies than this are written without being asked for.
pub(super) const FEW_BODIES: usize = 1000;

impl Default for Record {
    fn default() -> Self {
        Self {
            every_steps: 100,
            from_stage: 0,
            bodies: None,
            stage_ends: false,
            planes: Vec::new(),
            walls: Vec::new(),
            normal_forces: Vec::new(),
            turns: Vec::new(),
            regions: Vec::new(),
            voids: None,
            contacts: false,
            snapshot_every_steps: 0,
        }
    }
}

impl super::GranularScene {
    /// Bodies whose motion is written, of a scene of `count`.
    pub fn recorded_bodies(&self, count: usize) -> Vec<u32> {
        match &self.record.bodies {
            Some(bodies) => bodies.clone(),
            None if count < FEW_BODIES => (0..count as u32).collect(),
            None => Vec::new(),
        }
    }

    /// Whether the outcome describes every body of `count`.
    pub fn describes_bodies(count: usize) -> bool {
        count < FEW_BODIES
    }
}

fn is_zero(stage: &usize) -> bool {
    *stage == 0
}
