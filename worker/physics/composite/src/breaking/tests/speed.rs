//! How many events a second.
use super::*;
use crate::section::Fibre;
use crate::tests::{isotropic, plain};

/// Fibres in a matrix on 100 by 30 cells, with scatter: cracks, broken fibres and faces everywhere.
fn fibred(energy: Option<f64>) -> Case {
    let mut section = plain([20.0, 6.0], isotropic(3_000.0, 0.35), 0.0);
    let mut second = section.materials[0];
    second.material = isotropic(70_000.0, 0.2);
    section.materials.push(second);
    section.fibres = [1.1, 3.1, 5.1]
        .map(|y| Fibre {
            material: 1,
            through_mm: [10.0, y],
            angle_deg: 0.0,
            thickness_mm: 0.2,
            length_mm: None,
        })
        .to_vec();
    let limit = |limit| Limit {
        limit,
        fracture_energy_n_per_mm: energy,
    };
    let fibre = MaterialStrength {
        bulk: Strength {
            tension: brittle(2_000.0),
            ..Strength::default()
        },
        interface: Some(InterfaceStrength {
            normal: limit(30.0),
            shear: limit(30.0),
        }),
    };
    let matrix = in_tension(Some(limit(50.0)));
    let mut case = Case::pulled(&section, [100, 30], 1.0, &[matrix, fibre]);
    case.options.scatter = Some(Scatter {
        law: ScatterLaw::Weibull { modulus: 10.0 },
        reference_volume_mm3: None,
    });
    case.options.stop.events = 250;
    case
}

/// Processor time of this thread [s], whoever else works on the machine.
fn busy_s() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    let busy_ns: f64 = told.split(' ').next().unwrap().parse().unwrap();
    1e-9 * busy_ns
}

#[test]
#[ignore = "a measurement, not a check: run it in release with --ignored --nocapture"]
#[allow(clippy::print_stdout, reason = "its result is what it prints")]
fn events_a_second_by_columns_that_a_factor_carries() {
    for (name, energy) in [("brittle", None), ("ten teeth", Some(0.3))] {
        let case = fibred(energy);
        for columns in [0, 64, 128] {
            let mut breaking = case.carrying(columns);
            let start = busy_s();
            let (events, _) = broken(&mut breaking);
            let rate = events.len() as f64 / (busy_s() - start);
            println!(
                "{name}, {columns} columns: {rate:.0} events a second, {} factors, balance {:.1e}",
                breaking.factors(),
                imbalance(&events)
            );
        }
    }
}
