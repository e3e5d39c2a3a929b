//! What sheets measure and what they cost: `cargo run --release -p loadframe-paper --example sheet`.
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "this prints tables of times"
)]
use std::time::Instant;

use loadframe_numerics::Team;
use loadframe_paper::sheet::{Sheet, SheetError, SheetPlan, Statistics, contacts};
use softwood::Softwood;

mod softwood;

fn plan(size_um: [f64; 2], grammage: f64, coarseness: f64, flexibility: f64) -> SheetPlan {
    let softwood = Softwood {
        grammage_g_per_m2: grammage,
        coarseness_mg_per_m: coarseness,
        shape_factor: 0.92,
        flexibility,
    };
    softwood.plan(size_um)
}

const HEAD: &str =
    "fibres  contacts  per_fibre  free_um   rba  layers  covered  mean_um  peaks_um  kg/m3";

fn row(sheet: &Sheet) -> String {
    let Some(measured) = Statistics::of(sheet, 20) else {
        return "empty".to_owned();
    };
    format!(
        "{:6}  {:8}  {:9.1}  {:7.1}  {:4.2}  {:6.2}  {:7.3}  {:7.1}  {:8.1}  {:5.0}",
        sheet.fibres.len(),
        sheet.contacts.len(),
        measured.contacts_per_fibre,
        measured.free_length_um.unwrap_or(f64::NAN),
        measured.relative_bonded_area,
        measured.coverage,
        measured.covered_share,
        measured.mean_thickness_um,
        measured.peak_thickness_um,
        measured.apparent_density_kg_per_m3,
    )
}

fn main() -> Result<(), SheetError> {
    let alone = Team::alone();
    let side = std::env::args().nth(1).and_then(|side| side.parse().ok());
    let side: f64 = side.unwrap_or(5000.0);
    println!("flexibility (square, 60 g/m2)\n          {HEAD}");
    for flexibility in [0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0] {
        let plan = plan([side; 2], 60.0, 0.245, flexibility);
        println!("{flexibility:8.2}  {}", row(&plan.lay(1, &alone)?));
    }
    println!("\nsegment [um] (square, 60 g/m2, flexibility 0.2)\n          {HEAD}");
    for segment_um in [14.0, 10.0, 7.0, 5.0, 3.5, 2.5] {
        let mut plan = plan([side; 2], 60.0, 0.245, 0.2);
        plan.segment_um = Some(segment_um);
        println!("{segment_um:8.1}  {}", row(&plan.lay(1, &alone)?));
    }
    println!("\ngap [um] (square, 60 g/m2, flexibility 0.2)\n          {HEAD}");
    let mut sheet = plan([side; 2], 60.0, 0.245, 0.2).lay(1, &alone)?;
    for gap in [0.0, 0.1, 0.3, 0.5, 1.0, 2.0, 2.8, 4.0, 6.0, 10.0] {
        sheet.contacts = contacts(&sheet.fibres, gap, &alone);
        println!("{gap:8.1}  {}", row(&sheet));
    }
    println!("\ngrammage [g/m2] (square, flexibility 0.2)\n          {HEAD}");
    for grammage in [2.5, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0] {
        let plan = plan([side; 2], grammage, 0.245, 0.2);
        println!("{grammage:8.1}  {}", row(&plan.lay(1, &alone)?));
    }
    println!(
        "\ncost, 60 g/m2, 0.15 mg/m, 5 mm wide; seconds\n   mm  threads     lay  contacts  us/fibre  expected  {HEAD}"
    );
    for length_mm in [1.0, 3.0, 10.0, 30.0] {
        for threads in [1, 2] {
            let Ok(team) = Team::new(threads) else {
                continue;
            };
            let plan = plan([length_mm * 1e3, 5000.0], 60.0, 0.15, 0.2);
            let start = Instant::now();
            let sheet = plan.lay(1, &team)?;
            let all = start.elapsed().as_secs_f64();
            let start = Instant::now();
            let again = contacts(&sheet.fibres, plan.gap(), &team);
            let search = start.elapsed().as_secs_f64();
            assert_eq!(again, sheet.contacts);
            println!(
                "{length_mm:5.0}  {threads:7}  {:6.2}  {search:8.2}  {:8.1}  {:8.0}  {}",
                all - search,
                all * 1e6 / sheet.fibres.len() as f64,
                plan.expected().fibres,
                row(&sheet)
            );
        }
    }
    Ok(())
}
