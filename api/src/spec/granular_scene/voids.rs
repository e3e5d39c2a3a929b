//! Where in a box a scene is dense and where it is not.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GranularScene, part_checks::check_material};
use crate::{Violation, Violations};

/// Cells of a map, at most.
const MOST_CELLS: u64 = 100_000;

/// A box cut into equal cells, in each of which porosity is measured at the ends of stages, for
/// `voids.csv`. Cells smaller than bodies tell where these are rather than how dense they lie.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VoidMap {
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub low_m: [f64; 3],
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "m"))]
    pub high_m: [f64; 3],
    /// Along x, y and z.
    #[schemars(inner(range(min = 1, max = 10_000)))]
    pub cells: [u32; 3],
    /// Only bodies of this material count as solid; left out, all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Stages, from 0, at whose ends it is measured.
    #[schemars(length(min = 1, max = 100))]
    pub at_ends_of: Vec<usize>,
}

impl VoidMap {
    /// Edges of a cell [m].
    pub fn edges(&self) -> [f64; 3] {
        std::array::from_fn(|axis| {
            (self.high_m[axis] - self.low_m[axis]) / f64::from(self.cells[axis])
        })
    }

    /// How many cells there are.
    pub fn count(&self) -> usize {
        self.cells.iter().map(|cells| *cells as usize).product()
    }

    /// Middle of a cell [m]; x runs fastest, z slowest.
    pub fn middle(&self, cell: usize) -> [f64; 3] {
        let [x, y, _] = self.cells.map(|cells| cells as usize);
        let place = [cell % x, cell / x % y, cell / (x * y)];
        let edges = self.edges();
        std::array::from_fn(|axis| self.low_m[axis] + edges[axis] * (place[axis] as f64 + 0.5))
    }
}

pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    let Some(map) = &spec.record.voids else {
        return;
    };
    let pointer = "/record/voids";
    if (0..3).any(|axis| map.low_m[axis] >= map.high_m[axis]) {
        let detail = "the box has no inside";
        violations.push(
            Violation::new(format!("{pointer}/high_m"), "empty", detail)
                .value(map.high_m.to_vec())
                .allowed("above low_m along every axis")
                .unit("m"),
        );
    }
    let cells = map.cells.iter().map(|cells| u64::from(*cells));
    let cells = cells.fold(1, u64::saturating_mul);
    if cells > MOST_CELLS {
        violations.push(
            Violation::new(format!("{pointer}/cells"), "too_large", "too many cells")
                .value(cells)
                .allowed(format!("at most {MOST_CELLS} in all")),
        );
    }
    if let Some(name) = &map.material {
        violations.extend(check_material(spec, pointer, name));
    }
    let stages = spec.stages.len();
    let mut missing = map.at_ends_of.iter().enumerate();
    let missing = missing.find(|(_, stage)| **stage >= stages);
    violations.extend(missing.map(|(index, stage)| {
        let pointer = format!("{pointer}/at_ends_of/{index}");
        let violation = Violation::new(pointer, "no_such_stage", "there is no such stage");
        violation
            .value(*stage)
            .allowed(format!("0 … {}", stages.saturating_sub(1)))
    }));
}
