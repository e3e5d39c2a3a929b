//! What the pull of large sheets takes, one row for each length:
//! `cargo run --release -p loadframe-paper --example scale -- length=1.9,3.5,8.4,14.6 to=10`.
//!
//! Keys and what they are if left out: `length` 2, or several, and `width` half of the length [mm], `grammage`
//! 60 [g/m²], `segment` 100 [µm], `level` beam or truss, `taut` 1e-9 (the strain of bars), `bonds` inside or nodes, `solver` cost, direct or
//! iterative, `precision` 0.05, `threads` 1, `seed` 1, `to` rest (the first equilibrium), peak (a tenth below
//! it, told every twentieth solution), end (a force of 0.3 of it) or a number of solutions. Times are those of the
//! processor [s]. `tests/figures` reads what this prints.
#![allow(clippy::print_stdout, reason = "this prints tables")]
use std::error::Error;
use std::fmt;
use std::sync::Arc;

use loadframe_numerics::Team;
use loadframe_paper::frame::{
    Attachment, BeamSection, FrameBond, FrameFibre, FrameModel, Level, Means, Network, Pull,
    PullState, PullTest, Pulling, Refactoring, Solver, Step,
};
use loadframe_paper::sheet::{Sheet, contacts};
use softwood::{Softwood, WALL_UM, WIDTH_UM};

mod softwood;

/// Strength of bonds, both ways [mN/µm²], their stiffness [mN/µm³], and the strength of fibres [GPa].
const BOND_STRENGTH: f64 = 0.004;
const BOND_STIFFNESS: f64 = 0.25;
const FIBRE_STRENGTH: f64 = 0.6;

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
        line_density_ug_per_um: 1.5e-4,
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

/// What is asked.
struct Asked {
    level: Level,
    taut: f64,
    attachment: Attachment,
    solver: Solver,
    team: Arc<Team>,
    grammage: f64,
    segment_um: f64,
    precision: f64,
    seed: u64,
    to: String,
}

impl fmt::Display for Asked {
    /// All keys of a row with their values.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = match self.level {
            Level::Truss => "truss",
            Level::Beam | Level::Tube => "beam",
        };
        let bonds = match self.attachment {
            Attachment::Inside => "inside",
            Attachment::Node => "nodes",
        };
        let solver = match self.solver {
            Solver::ByCost => "cost",
            Solver::Direct(_) => "direct",
            Solver::Iterative => "iterative",
        };
        write!(
            f,
            "grammage={} segment={} level={level} taut={:e} bonds={bonds} solver={solver} precision={} threads={} seed={} to={}",
            self.grammage,
            self.segment_um,
            self.taut,
            self.precision,
            self.team.threads(),
            self.seed,
            self.to
        )
    }
}

const HEAD: &str = "fibres   bonds  unknowns    lay  contacts   rest  iterations  ms/fibre    stored  kB/fibre  residual  stiffness_mN  solutions  iterations  ms/fibre";

/// Lays a sheet and pulls it; prints its row.
fn row(asked: &Asked, size_um: [f64; 2]) -> Result<(), Box<dyn Error>> {
    let [length, width] = size_um.map(|size| 1e-3 * size);
    println!("length={length} width={width} {asked}\n{HEAD}");
    let softwood = Softwood {
        grammage_g_per_m2: asked.grammage,
        coarseness_mg_per_m: 0.15,
        shape_factor: 0.95,
        flexibility: 0.2,
    };
    let plan = softwood.plan(size_um);
    let [start, _] = taken();
    let sheet = plan.lay(asked.seed, &asked.team)?;
    let [laid, _] = taken();
    let again = contacts(&sheet.fibres, plan.gap(), &asked.team);
    let [searched, _] = taken();
    assert_eq!(again, sheet.contacts);
    let model = FrameModel {
        level: asked.level,
        segment_um: None,
        attachment: asked.attachment,
        length_um: size_um[0],
    };
    let mut network = network(&sheet, asked.segment_um, model)?;
    if asked.level == Level::Truss {
        network = network.with_taut_bars(asked.taut)?;
    }
    let fibres = network.fibres() as f64;
    let test = PullTest {
        max_strain: 0.2,
        stop_force_fraction: if asked.to == "peak" { 0.9 } else { 0.3 },
        break_precision: asked.precision,
    };
    let means = Means {
        motion: None,
        solver: asked.solver,
        team: Arc::clone(&asked.team),
    };
    let [built, _] = taken();
    let mut pull = Pull::resume(&network, test, PullState::default(), &means)?;
    let [rested, memory_mb] = taken();
    let first = pull.cost();
    let measures = pull.state().measures;
    print!(
        "{:6}  {:6}  {:8}  {:5.1}  {:8.1}  {:5.1}  {:10}  {:8.2}  {:8}  {:8.1}  {:8.1e}  {:12.1}",
        network.fibres(),
        network.bonds(),
        first.unknowns,
        laid - start,
        searched - laid,
        rested - built,
        first.iterations,
        1e3 * (rested - built) / fibres,
        first.stored,
        1e3 * memory_mb / fibres,
        measures.largest_residual,
        measures.initial_stiffness_mn
    );
    let most = match asked.to.as_str() {
        "rest" => 0,
        to => to.parse().unwrap_or(usize::MAX),
    };
    let mut steps = 0;
    for step in 0..most {
        steps = step;
        match pull.advance()? {
            Step::Ended(end) => {
                println!("\n{end:?}");
                break;
            }
            Step::Broke(events) if asked.to == "peak" && step % 20 == 0 => println!(
                "\n{step} strain {:.6} force {:.4} mN, {} together, {} s, {:?}",
                events[0].strain,
                pull.jaw_force_mn()[1],
                events.len(),
                taken()[0],
                pull.cost()
            ),
            Step::Broke(_) | Step::Moved(_) | Step::Strained => {}
        }
    }
    let cost = pull.cost();
    let solutions = cost.solutions - first.solutions;
    if solutions == 0 {
        println!();
        return Ok(());
    }
    println!(
        "  {solutions:9}  {:10.1}  {:8.2}",
        (cost.iterations - first.iterations) as f64 / solutions as f64,
        1e3 * (taken()[0] - rested) / (solutions as f64 * fibres),
    );
    let measures = pull.state().measures;
    println!(
        "peak {:.6} mN at {:.9}, {:.3} nJ; {} bonds and {} segments broken in {} steps, {:.1} s, energy error {:.1e}, index error {:?}, taut share {:.1e}",
        measures.peak_force_mn,
        measures.strain_at_peak,
        measures.work_to_peak_nj,
        measures.broken_bonds,
        measures.broken_segments,
        steps,
        taken()[0] - rested,
        measures.energy_error(),
        measures.largest_index_error,
        measures.largest_taut_share
    );
    Ok(())
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
    let asked = Asked {
        level: match text("level", "beam").as_str() {
            "truss" => Level::Truss,
            _ => Level::Beam,
        },
        taut: number("taut", "1e-9")?,
        attachment: match text("bonds", "inside").as_str() {
            "inside" => Attachment::Inside,
            _ => Attachment::Node,
        },
        solver: match text("solver", "cost").as_str() {
            "direct" => Solver::Direct(Refactoring::ByCost),
            "iterative" => Solver::Iterative,
            _ => Solver::ByCost,
        },
        team: Arc::new(Team::new(number("threads", "1")? as usize)?),
        grammage: number("grammage", "60")?,
        segment_um: number("segment", "100")?,
        precision: number("precision", "0.05")?,
        seed: number("seed", "1")? as u64,
        to: text("to", "rest"),
    };
    for length in text("length", "2").split(',') {
        let length: f64 = length.parse()?;
        let width = text("width", "").parse().unwrap_or(0.5 * length);
        row(&asked, [1e3 * length, 1e3 * width])?;
    }
    Ok(())
}
