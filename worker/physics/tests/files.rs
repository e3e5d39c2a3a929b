//! The files a test leaves behind.
#![allow(clippy::float_cmp, reason = "some results are exact")]
mod scene;

use loadframe_api::spec::nonwoven_tensile::Breaking;
use scene::{array, floats, polyester, run};

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("the file is text")
}

#[test]
fn a_run_leaves_its_tables_and_snapshots() {
    let mut spec = polyester(3, 5, 1);
    spec.test.strain_step = 0.1;
    spec.test.max_strain = 0.5;
    spec.output.snapshot_every_steps = 2;
    let (report, record) = run(&spec);
    let names: Vec<&str> = record.files.keys().map(String::as_str).collect();
    let expected = [
        "avalanches.csv",
        "breaking_by_force.csv",
        "breaking_by_strain.csv",
        "curve.csv",
        "curve_machine.csv",
        "events.csv",
        "force_drops.csv",
        "force_histogram.csv",
        "poisson_ratio.csv",
        "snapshots.pvd",
        "snapshots/peak.vtp",
        "snapshots/step_00000.vtp",
        "snapshots/step_00002.vtp",
        "snapshots/step_00004.vtp",
        "snapshots/step_00005.vtp",
    ];
    assert_eq!(names, expected);
    let curve = text(&record.files["curve.csv"]);
    assert!(curve.starts_with(
        "nominal_strain,force_n,force_bottom_jaw_n,broken_bonds,residual_ratio,rounds,\
         stored_energy_n_mm,width_strain,poisson_ratio\n"
    ));
    assert_eq!(record.table("curve.csv"), record.points);
    assert_eq!(
        text(&record.files["events.csv"]).lines().next(),
        Some("step,round,nominal_strain,bond,force_n,energy_released_n_mm")
    );
    let series = text(&record.files["snapshots.pvd"]);
    assert!(series.contains(r#"timestep="0.5" part="0" file="snapshots/step_00005.vtp""#));
    // every loaded bond is in a bin of its snapshot
    let bonds = report.summary["bonds"].value.expect("bonds are counted");
    let bins = record.table("force_histogram.csv");
    let counted: f64 = bins
        .iter()
        .filter(|bin| bin[0] == 0.2)
        .map(|bin| bin[3])
        .sum();
    assert_eq!(counted, bonds);
    assert!(record.fractions.is_sorted() && record.fractions.last() == Some(&1.0));
}

#[test]
fn a_snapshot_is_vtk_poly_data_with_lines() {
    let mut spec = polyester(3, 5, 1);
    spec.test.strain_step = 0.1;
    spec.output.snapshot_every_steps = 1;
    let (_, record) = run(&spec);
    let mut files = record.files.iter();
    let (_, file) = files
        .rfind(|(name, _)| name.starts_with("snapshots/"))
        .expect("a snapshot of every step");
    let nodes = 3 * 3 + 2 * 4 + 2 * 6;
    let bonds = 3 * 2 + 2 * 3 + 4 * 6 + 2 * 6;
    let head = String::from_utf8_lossy(&file[..400]);
    let expected = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  \
         <PolyData>\n    \
         <Piece NumberOfPoints=\"{nodes}\" NumberOfVerts=\"0\" NumberOfLines=\"{bonds}\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <PointData>\n"
    );
    assert!(head.starts_with(&expected), "{head}");
    assert_eq!(floats(file, "Points").len(), 3 * nodes);
    assert_eq!(array(file, "connectivity").len(), 2 * 4 * bonds);
    assert_eq!(
        array(file, "jaw").iter().filter(|jaw| **jaw == 2).count(),
        6
    );
    let broken = array(file, "broken");
    let forces = floats(file, "force_n");
    assert!(broken.contains(&1) && broken.len() == bonds);
    let idle = broken
        .iter()
        .zip(&forces)
        .filter(|(broken, _)| **broken == 1);
    assert!(idle.into_iter().all(|(_, force)| *force == 0.0));
}

#[test]
fn without_snapshots_and_breaking_there_is_nothing_of_them() {
    let mut spec = polyester(3, 5, 1);
    spec.test.max_strain = 0.05;
    spec.test.breaking = Breaking::None;
    let (_, record) = run(&spec);
    let names: Vec<&str> = record.files.keys().map(String::as_str).collect();
    let expected = [
        "curve.csv",
        "curve_machine.csv",
        "events.csv",
        "poisson_ratio.csv",
    ];
    assert_eq!(names, expected);
}
