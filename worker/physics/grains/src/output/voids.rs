//! A map of what is solid and what is not: `voids.csv`.
use std::io;

use loadframe_api::spec::granular_scene::{GranularScene, VoidMap};
use loadframe_harness::Recorder;

use super::{journal::Journal, table::write_table};
use crate::{
    geometry::solid_share::{Cuboid, sphere_volume_within},
    numbers::Vector,
    step::engine::Engine,
};

const COLUMNS: [&str; 5] = ["stage", "x_m", "y_m", "z_m", "porosity"];

/// Adds the solid volume in every cell [m³] to the journal, if this is the end of a stage at which it is
/// asked for.
pub(crate) fn look(spec: &GranularScene, engine: &Engine, journal: &mut Journal) {
    let Some(map) = &spec.record.voids else {
        return;
    };
    if map.at_ends_of.contains(&journal.stage) {
        let mut names = spec.materials.keys();
        let only = map.material.as_ref();
        let only = only.and_then(|name| names.position(|known| known == name));
        let solid = engine.solid_in_cells(map, only);
        journal.voids.push((journal.stage, solid));
    }
}

/// Gives the map to the recorder, if there is one.
pub(crate) fn write(
    spec: &GranularScene,
    journal: &Journal,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let Some(map) = &spec.record.voids else {
        return Ok(());
    };
    let volume: f64 = map.edges().iter().product();
    let mut rows = Vec::with_capacity(COLUMNS.len() * map.count() * journal.voids.len());
    for (stage, solids) in &journal.voids {
        for (cell, solid) in solids.iter().enumerate() {
            rows.push((stage + 1) as f64);
            rows.extend(map.middle(cell));
            rows.push(1.0 - solid / volume);
        }
    }
    write_table(recorder, "voids.csv", &COLUMNS, &rows)
}

impl Engine {
    /// Solid volume in every cell of a map [m³], of all bodies or those of one surface; see
    /// [`measure`](crate::observe::measure) for what is solid.
    fn solid_in_cells(&self, map: &VoidMap, only: Option<usize>) -> Vec<f64> {
        let particles = &self.state.particles;
        let mut solid = vec![0.0; map.count()];
        self.solid_spheres(only, &mut |particle, part| {
            let row = &particles.centres[particle];
            fill(map, &row.vector(), row.0[3], part, &mut solid);
        });
        solid
    }
}

/// Adds a part of a sphere with this radius [m] to the cells that it reaches into.
fn fill(map: &VoidMap, centre: &Vector, radius: f64, part: f64, solid: &mut [f64]) {
    let edges = map.edges();
    let reached = [0, 1, 2].map(|axis: usize| {
        let cell = |place: f64| ((place - map.low_m[axis]) / edges[axis]).floor();
        let last = f64::from(map.cells[axis]) - 1.0;
        let [first, end] = [centre[axis] - radius, centre[axis] + radius].map(cell);
        // beyond the box there are none
        if end < 0.0 || first > last {
            0..0
        } else {
            first.max(0.0) as usize..end.min(last) as usize + 1
        }
    });
    let [x, y, _] = map.cells.map(|cells| cells as usize);
    let half = 0.5 * Vector::from(edges);
    for layer in reached[2].clone() {
        for row in reached[1].clone() {
            for column in reached[0].clone() {
                let cell = column + x * (row + y * layer);
                let middle = Vector::from(map.middle(cell));
                let cuboid = Cuboid {
                    low: middle - half,
                    high: middle + half,
                };
                solid[cell] += part * sphere_volume_within(&cuboid, centre, radius);
            }
        }
    }
}
