//! What the pull of a large sheet takes:
//! `cargo run --release -p loadframe-paper --example scale -- length=10 width=5 level=beam to=peak`.
//!
//! Keys and what they are if left out: `length` 2 and `width` 1 [mm], `grammage` 60 [g/m²], `segment` 100
//! [µm], `level` beam or truss, `bonds` inside or nodes, `solver` cost, direct or iterative, `precision`
//! 0.05, `threads` 1, `seed` 1, `to` rest (the first equilibrium), peak (a tenth below it) or a number of
//! solutions. One line: the sheet, times of the processor [s] by part, solutions, iterations, results.
#![allow(clippy::print_stdout, reason = "this prints tables")]
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use loadframe_numerics::Team;
use loadframe_paper::frame::{
    Attachment, BeamSection, FrameBond, FrameFibre, FrameModel, Level, Means, Network, Pull,
    PullState, PullTest, Refactoring, Solver, Step,
};
use loadframe_paper::sheet::{
    LengthDistribution, Lumen, Orientation, Placement, Pulp, Sheet, SheetPlan, contacts,
};

const WIDTH_UM: f64 = 28.0;
const WALL_UM: f64 = 2.0;
/// Strength of bonds, both ways [mN/µm²], their stiffness [mN/µm³], and the strength of fibres [GPa].
const BOND_STRENGTH: f64 = 0.004;
const BOND_STIFFNESS: f64 = 0.25;
const FIBRE_STRENGTH: f64 = 0.6;

fn plan(size_um: [f64; 2], grammage: f64) -> SheetPlan {
    SheetPlan {
        size_um,
        grammage_ug_per_um2: grammage * 1e-6,
        pulps: vec![Pulp {
            mass_fraction: 1.0,
            length: LengthDistribution::LogNormal {
                mean_um: 2000.0,
                variation: 0.4,
            },
            width_um: WIDTH_UM,
            wall_um: WALL_UM,
            coarseness_ug_per_um: 1.5e-4,
            shape_factor: 0.95,
            lumen: Lumen::Collapsed,
        }],
        orientation: Orientation::Uniform,
        placement: Placement::Deposition { flexibility: 0.2 },
        segment_um: None,
        gap_um: None,
    }
}

fn section() -> BeamSection {
    let inner = WIDTH_UM - 2.0 * WALL_UM;
    let inertia = std::f64::consts::PI / 64.0 * (WIDTH_UM.powi(4) - inner.powi(4));
    BeamSection {
        area_um2: std::f64::consts::PI / 4.0 * (WIDTH_UM.powi(2) - inner.powi(2)),
        inertia_um4: inertia,
        polar_um4: 2.0 * inertia,
        youngs_modulus_gpa: 30.0,
        shear_modulus_gpa: 2.5,
        shear_coefficient: 2.6 / 4.9,
        strength_gpa: Some(FIBRE_STRENGTH),
        width_um: WIDTH_UM,
        yielding: None,
    }
}

fn network(sheet: &Sheet, segment_um: f64, model: FrameModel) -> Result<Network, Box<dyn Error>> {
    let coarse = sheet.coarsened(segment_um)?;
    let fibres: Vec<FrameFibre> = coarse
        .fibres
        .iter()
        .map(|fibre| FrameFibre {
            centre_line_um: fibre.centre_line_um.clone(),
            section: section(),
        })
        .collect();
    let bonds: Vec<FrameBond> = coarse
        .contacts
        .iter()
        .enumerate()
        .map(|(number, contact)| {
            // multiples of the golden section: from half to one and a half
            let scatter = 0.5 + (number as f64 * 0.618_033_988_749_894_9).fract();
            let strength = BOND_STRENGTH * contact.area_um2 * scatter;
            FrameBond {
                fibres: contact.fibres,
                at_um: contact.at_um,
                area_um2: contact.area_um2,
                stiffness_mn_per_um3: BOND_STIFFNESS,
                normal_strength_mn: Some(strength),
                shear_strength_mn: Some(strength),
            }
        })
        .collect();
    Ok(Network::new(&fibres, &bonds, model)?)
}

/// Time of the processor that this process took [s], and the most memory [MB].
fn taken() -> [f64; 2] {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(11).take(2);
    let ticks: f64 = ticks.filter_map(|value| value.parse::<f64>().ok()).sum();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let peak = peak.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    [ticks / 100.0, peak.unwrap_or(f64::NAN) / 1024.0]
}

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let text = |key: &str, usual: &str| -> String {
        let found = given
            .iter()
            .find_map(|pair| pair.strip_prefix(&format!("{key}=")));
        found.unwrap_or(usual).to_owned()
    };
    let number = |key: &str, usual: &str| text(key, usual).parse::<f64>();
    let size_um = [number("length", "2")? * 1e3, number("width", "1")? * 1e3];
    let team = Arc::new(Team::new(number("threads", "1")? as usize)?);
    let is_inside = text("bonds", "inside") == "inside";
    let model = FrameModel {
        level: if text("level", "beam") == "truss" {
            Level::Truss
        } else {
            Level::Beam
        },
        segment_um: None,
        attachment: if is_inside {
            Attachment::Inside
        } else {
            Attachment::Node
        },
        length_um: size_um[0],
    };
    let solver = match text("solver", "cost").as_str() {
        "direct" => Solver::Direct(Refactoring::ByCost),
        "iterative" => Solver::Iterative,
        _ => Solver::ByCost,
    };
    let to = text("to", "rest");
    let test = PullTest {
        max_strain: 0.2,
        stop_force_fraction: if to == "peak" { 0.9 } else { 0.3 },
        break_precision: number("precision", "0.05")?,
    };

    let plan = plan(size_um, number("grammage", "60")?);
    let sheet = plan.lay(number("seed", "1")? as u64, &team)?;
    let [laid, _] = taken();
    let again = contacts(&sheet.fibres, plan.gap(), &team);
    let search = taken()[0] - laid;
    assert_eq!(again, sheet.contacts);
    let network = network(&sheet, number("segment", "100")?, model)?;
    let built = taken()[0] - laid - search;
    println!(
        "{} fibres, {} bonds, {} nodes; lay {laid:.1} s, contacts {search:.1} s, network {built:.1} s",
        network.fibres(),
        network.bonds(),
        network.fibre_nodes()
    );
    let clock = Instant::now();
    let means = Means { solver, team };
    let mut pull = Pull::resume(&network, test, PullState::default(), &means)?;
    let first = taken()[0] - laid - search - built;
    let cost = pull.cost();
    println!(
        "rest: {first:.2} s ({:.2} s by the clock), {} unknowns, {} solutions, {} iterations, {} stored, {:.0} MB, residual {:.1e}, stiffness {:.6} mN",
        clock.elapsed().as_secs_f64(),
        cost.unknowns,
        cost.solutions,
        cost.iterations,
        cost.stored,
        taken()[1],
        pull.state().measures.largest_residual,
        pull.state().measures.initial_stiffness_mn
    );
    if to == "rest" {
        return Ok(());
    }
    let most = to.parse().unwrap_or(usize::MAX);
    for step in 0..most {
        match pull.advance()? {
            Step::Ended(end) => {
                println!("{end:?}");
                break;
            }
            Step::Broke(events) if step % 20 == 0 => println!(
                "{step} strain {:.6} force {:.4} mN, {} together, {} s, {:?}",
                events[0].strain,
                pull.jaw_force_mn()[1],
                events.len(),
                taken()[0],
                pull.cost()
            ),
            Step::Broke(_) | Step::Strained => {}
        }
    }
    let measures = pull.state().measures;
    println!(
        "{:.1} s ({:.1} s by the clock), {:.0} MB, {:?}\n{measures:?} energy error {:.1e}",
        taken()[0],
        clock.elapsed().as_secs_f64(),
        taken()[1],
        pull.cost(),
        measures.energy_error()
    );
    Ok(())
}
