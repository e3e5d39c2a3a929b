//! Files of a cell: convergence, stiffness, what theory says, a picture, and the material it is.
use std::io;

use loadframe_api::Report;
use loadframe_api::spec::composite_cell::CompositeCell;
use loadframe_harness::vtk::{Array, Polygons, Series};
use loadframe_harness::{Recorder, SimulationError, csv};

use super::conduct::Tested;
use super::results::{self, CONSTANTS};
use crate::homogenise::{Load, bounds};

/// Voigt's order of stresses and strains.
const ORDER: [&str; 6] = ["11", "22", "33", "23", "13", "12"];
/// The stress under which the picture is drawn [MPa].
const PULLED: [f64; 6] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
/// A picture of more cells than this is drawn of every second of them along both sides, or fewer.
const MOST_DRAWN: usize = 70_000;
const PICTURE: &str = "snapshots/cell.vtp";

/// Writes all files of one cell.
pub(super) fn write(
    spec: &CompositeCell,
    tested: &Tested,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let names = results::columns();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    for file in ["curve.csv", "cell_convergence.csv"] {
        recorder.file(file, &mut |out| {
            csv::header(out, &names)?;
            let grids = tested.grids.iter();
            grids
                .into_iter()
                .try_for_each(|values| csv::row(out, &results::point(spec, values)))
        })?;
    }
    recorder.file("stiffness.csv", &mut |out| {
        let names = ORDER.map(|name| format!("c_{name}_mpa"));
        csv::header(out, &names.each_ref().map(String::as_str))?;
        let rows = tested.effective.stiffness.iter();
        rows.into_iter().try_for_each(|row| csv::row(out, row))
    })?;
    write_fibres(tested, recorder)?;
    write_companions(tested, recorder)?;
    if spec.output.picture {
        write_picture(tested, recorder)?;
    }
    Ok(())
}

/// Where the fibres are.
fn write_fibres(tested: &Tested, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
    recorder.file("fibres.csv", &mut |out| {
        csv::header(out, &["centre_2_mm", "centre_3_mm", "diameter_mm"])?;
        tested.cell.fibres.iter().try_for_each(|fibre| {
            let [along_2, along_3] = fibre.centre_mm;
            csv::row(out, &[along_2, along_3, fibre.diameter_mm])
        })
    })?;
    Ok(())
}

/// The constants beside those of bounds and formulas.
fn write_companions(tested: &Tested, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
    let cell = &tested.cell;
    let found = bounds::companions(&cell.fibre, &cell.matrix, tested.effective.fraction)?;
    // in the order of the constants; a formula knows some of them
    let estimate = |all: &bounds::Estimate| {
        let none = f64::NAN;
        let g23 = all.g23_mpa.unwrap_or(none);
        let (e2, g12) = (all.e2_mpa, all.g12_mpa);
        [all.e1_mpa, e2, e2, all.nu12, all.nu12, none, g12, g12, g23]
    };
    let mut columns = vec![
        ("reuss", found.reuss.values()),
        ("cell", tested.effective.constants.values()),
        ("voigt", found.voigt.values()),
        ("halpin_tsai", estimate(&found.halpin_tsai)),
        ("chamis", estimate(&found.chamis)),
    ];
    let sides = [found.hashin_shtrikman_lower, found.hashin_shtrikman_upper];
    if let [Some(lower), Some(upper)] = sides {
        columns.insert(1, ("hashin_shtrikman_lower", lower.values()));
        columns.insert(3, ("hashin_shtrikman_upper", upper.values()));
    }
    recorder.file("companions.csv", &mut |out| {
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        writeln!(out, "constant,unit,{}", names.join(","))?;
        for (place, kind) in CONSTANTS.iter().enumerate() {
            write!(out, "{},{},", kind.name, kind.unit)?;
            let values: Vec<f64> = columns.iter().map(|(_, values)| values[place]).collect();
            csv::row(out, &values)?;
        }
        Ok(())
    })?;
    Ok(())
}

/// The picture of a cell that was tested, and its series.
fn write_picture(tested: &Tested, recorder: &mut dyn Recorder) -> Result<(), SimulationError> {
    let effective = &tested.effective;
    let fields = effective.fields(&Load::Stress(PULLED))?;
    let drawn = Drawn {
        grid: effective.grid(),
        pixel_mm: effective.pixel_mm(),
        shares: &effective.fibre_shares(),
        stresses: Some(&fields),
    };
    draw(&drawn, recorder)?;
    let series = Series {
        entries: vec![(1.0, PICTURE.to_owned())],
    };
    recorder.file("snapshots.pvd", &mut |out| series.write(out))?;
    Ok(())
}

/// What is drawn of a cell.
pub(super) struct Drawn<'a> {
    /// Number of cells of the grid along 2 and 3, and their sides [mm].
    pub(super) grid: [usize; 2],
    pub(super) pixel_mm: [f64; 2],
    /// Share of fibre in each.
    pub(super) shares: &'a [f64],
    /// Stresses under a pull across the fibres [MPa], once it was tested.
    pub(super) stresses: Option<&'a [[f64; 6]]>,
}

/// The grid's cells with what is known of each.
pub(super) fn draw(shown: &Drawn<'_>, recorder: &mut dyn Recorder) -> io::Result<()> {
    let [columns, rows] = shown.grid;
    let mut every = 1;
    while columns * rows / (every * every) > MOST_DRAWN {
        every *= 2;
    }
    let (drawn, lines) = (columns.div_ceil(every), rows.div_ceil(every));
    // a drawn cell is the mean of those it covers
    let mut share = vec![0.0; drawn * lines];
    let mut stress = vec![[0.0; 6]; drawn * lines];
    let mut covered = vec![0.0; drawn * lines];
    let place = |cell: usize| (cell / columns / every) * drawn + (cell % columns) / every;
    for (cell, held) in shown.shares.iter().enumerate() {
        covered[place(cell)] += 1.0;
        share[place(cell)] += held;
    }
    for (cell, field) in shown.stresses.iter().flat_map(|all| all.iter().enumerate()) {
        for (sum, part) in stress[place(cell)].iter_mut().zip(field) {
            *sum += part;
        }
    }
    let mut points = Vec::with_capacity(4 * drawn * lines);
    let pixel = shown.pixel_mm;
    let line =
        |axis: usize, place: usize, count: usize| pixel[axis] * (place * every).min(count) as f64;
    for j in 0..lines {
        let y = [line(1, j, rows), line(1, j + 1, rows)];
        for i in 0..drawn {
            let x = [line(0, i, columns), line(0, i + 1, columns)];
            points.extend([
                [x[0], y[0], 0.0],
                [x[1], y[0], 0.0],
                [x[1], y[1], 0.0],
                [x[0], y[1], 0.0],
            ]);
        }
    }
    for (place, count) in covered.iter().enumerate() {
        share[place] /= count;
        for part in &mut stress[place] {
            *part /= count;
        }
    }
    let columns_of = |part: usize| stress.iter().map(|all| all[part]).collect::<Vec<f64>>();
    let parts: Vec<Vec<f64>> = (0..ORDER.len()).map(columns_of).collect();
    let names = ORDER.map(|name| format!("stress_{name}_mpa"));
    let mises: Vec<f64> = stress.iter().map(equivalent).collect();
    let mut data = vec![Array::scalars("fibre_share", &share)];
    if shown.stresses.is_some() {
        data.extend(
            names
                .iter()
                .zip(&parts)
                .map(|(name, part)| Array::scalars(name, part)),
        );
        data.push(Array::scalars("stress_mises_mpa", &mises));
    }
    let polygons = Polygons {
        points: &points,
        corners: &vec![4; drawn * lines],
        point_data: &[],
        cell_data: &data,
    };
    recorder.file(PICTURE, &mut |out| polygons.write(out))
}

/// The equivalent stress of [vonMises1913].
fn equivalent(&[s11, s22, s33, s23, s13, s12]: &[f64; 6]) -> f64 {
    let differences = (s11 - s22).powi(2) + (s22 - s33).powi(2) + (s33 - s11).powi(2);
    (0.5 * differences + 3.0 * (s23 * s23 + s13 * s13 + s12 * s12)).sqrt()
}

/// `material.json`: what a spec of `composite_bending` takes as a material.
pub(super) fn write_material(
    report: &Report,
    recorder: &mut dyn Recorder,
) -> Result<(), SimulationError> {
    let value = |name: &str| report.summary.get(name).and_then(|quantity| quantity.value);
    let field = |field: &str| {
        CONSTANTS
            .iter()
            .find(|kind| field.strip_suffix("_mpa").unwrap_or(field) == kind.name)
            .and_then(|kind| value(kind.name))
    };
    const FIELDS: [&str; 9] = [
        "modulus_1_mpa",
        "modulus_2_mpa",
        "modulus_3_mpa",
        "poisson_ratio_12",
        "poisson_ratio_13",
        "poisson_ratio_23",
        "shear_modulus_12_mpa",
        "shear_modulus_13_mpa",
        "shear_modulus_23_mpa",
    ];
    recorder.file("material.json", &mut |out| {
        writeln!(out, "{{\"orthotropic\": {{")?;
        let known = FIELDS.iter().filter_map(|name| Some((*name, field(name)?)));
        let known: Vec<(&str, f64)> = known.collect();
        for (place, (name, value)) in known.iter().enumerate() {
            let comma = if place + 1 < known.len() { "," } else { "" };
            writeln!(out, "  \"{name}\": {value:?}{comma}")?;
        }
        writeln!(out, "}}}}")
    })?;
    Ok(())
}
