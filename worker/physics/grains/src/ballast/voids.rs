//! Where under a sleeper a bed is loose, before the cycles and after them.
use std::io;

use loadframe_api::spec::granular_scene::VoidMap;
use loadframe_harness::{
    Recorder,
    vtk::{Array, Points},
};

use super::{
    heard::{Heard, Row},
    tables::table,
};

const COLUMNS: [&str; 6] = [
    "x_m",
    "y_m",
    "z_m",
    "porosity_before_loading",
    "porosity_at_end",
    "porosity_gained",
];

/// Part of a cell that must be left below the sleeper for its porosity to be told: overlaps with the
/// sleeper would be most of a thin rest.
const LEAST_REST: f64 = 0.5;

/// Porosity of every cell, of which so much is solid [m³], below the sleeper as it is at a row.
fn porosities(heard: &Heard<'_>, map: &VoidMap, solids: &[f64], row: &Row) -> Vec<f64> {
    let [x_edge, y_edge, height] = map.edges();
    let under = heard.script.middle;
    let porosity = |(cell, solid): (usize, &f64)| {
        let [x, y, z] = map.middle(cell);
        let bottom = z - 0.5 * height;
        let face = row.face_at([x - under[0], y - under[1]]);
        let rest = (face - bottom).clamp(0.0, height);
        if rest < LEAST_REST * height {
            f64::NAN
        } else {
            1.0 - solid / (x_edge * y_edge * rest)
        }
    };
    solids.iter().enumerate().map(porosity).collect()
}

/// Gives table and map to the recorder, if they are asked for; `solids` are those of the scene's map.
pub(super) fn write(
    heard: &Heard<'_>,
    solids: &[(usize, Vec<f64>)],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let map = heard.script.scene.record.voids.as_ref();
    let (Some(map), Some((_, first)), Some((_, last))) = (map, solids.first(), solids.last())
    else {
        return Ok(());
    };
    let (Some(before), Some(end)) = (heard.last_before_loading(), heard.rows.last()) else {
        return Ok(());
    };
    let before = porosities(heard, map, first, before);
    let end = porosities(heard, map, last, end);
    let pairs = || before.iter().zip(&end);
    let gained: Vec<f64> = pairs().map(|(before, end)| end - before).collect();
    let middles: Vec<[f64; 3]> = (0..map.count()).map(|cell| map.middle(cell)).collect();
    let rows: Vec<Vec<f64>> = (middles.iter().zip(pairs()).zip(&gained))
        .map(|(([x, y, z], (before, end)), gained)| vec![*x, *y, *z, *before, *end, *gained])
        .collect();
    table(recorder, "void_map.csv", &COLUMNS, &rows)?;
    let points = Points {
        points: &middles,
        data: &[
            Array::scalars(COLUMNS[3], &before),
            Array::scalars(COLUMNS[4], &end),
            Array::scalars(COLUMNS[5], &gained),
        ],
    };
    recorder.file("void_map.vtp", &mut |out| points.write(out))
}
