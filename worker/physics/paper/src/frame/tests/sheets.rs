//! Flat sheets of straight fibres: what must not matter does not.
use super::*;

/// A sheet to be: evenly scattered places and angles, and how strong its bonds are.
#[derive(Clone, Copy)]
pub(super) struct Scatter {
    pub(super) size_um: [f64; 2],
    pub(super) fibres: usize,
    pub(super) fibre_length_um: f64,
    /// Height of each fibre above the one before [µm]; 0: all centre lines in one plane.
    pub(super) layer_um: f64,
    /// Tensile strength of fibres [GPa].
    pub(super) strength_gpa: Option<f64>,
}

pub(super) const SMALL: Scatter = Scatter {
    size_um: [800.0, 400.0],
    fibres: 28,
    fibre_length_um: 500.0,
    layer_um: 3.0,
    strength_gpa: Some(0.25),
};

/// Small, for as tubes it has thirteen times the entries of a factor of beams.
pub(super) const TUBES: Scatter = Scatter {
    size_um: [400.0, 250.0],
    fibres: 11,
    fibre_length_um: 330.0,
    ..SMALL
};

/// Most fibres reach from jaw to jaw: as a truss it is no mechanism.
pub(super) const LONG: Scatter = Scatter {
    fibres: 14,
    fibre_length_um: 2000.0,
    ..SMALL
};

/// Numbers in [0, 1)³, evenly spread: multiples of the powers of 1/1.2207..., the root of x⁴ = x + 1.
fn spread(index: usize) -> [f64; 3] {
    [1, 2, 3].map(|power| (0.5 + index as f64 * 1.220_744_084_605_759_5_f64.powi(-power)).fract())
}

impl Scatter {
    /// Fibres cut at the jaws, a bond wherever two cross.
    pub(super) fn sheet(&self) -> (Vec<FrameFibre>, Vec<FrameBond>) {
        let [length, width] = self.size_um;
        let lines: Vec<[[f64; 3]; 2]> = (0..self.fibres)
            .map(|index| {
                let [x, y, angle] = spread(index);
                let (sin, cos) = (std::f64::consts::PI * angle).sin_cos();
                let half = 0.5 * self.fibre_length_um;
                let z = self.layer_um * index as f64;
                [-half, half].map(|at| {
                    let x = x * length;
                    // cut where it meets a jaw
                    let at = if cos.abs() > 1e-12 {
                        let jaws = [-x / cos, (length - x) / cos];
                        at.clamp(jaws[0].min(jaws[1]), jaws[0].max(jaws[1]))
                    } else {
                        at
                    };
                    [x + at * cos, y * width + at * sin, z]
                })
            })
            .collect();
        let mut bonds = Vec::new();
        for (first, a) in lines.iter().enumerate() {
            for (second, b) in lines.iter().enumerate().skip(first + 1) {
                if let Some(at_um) = crossing(a, b) {
                    let [_, _, strength] = spread(1000 + bonds.len());
                    bonds.push(FrameBond {
                        normal_strength_mn: Some(0.5 + strength),
                        shear_strength_mn: Some(0.5 + strength),
                        ..bond([first as u32, second as u32], at_um)
                    });
                }
            }
        }
        let fibres = lines.iter().map(|line| {
            let mut fibre = fibre(line);
            fibre.section.strength_gpa = self.strength_gpa;
            fibre
        });
        (fibres.collect(), bonds)
    }

    pub(super) fn network(&self, level: Level, segment_um: Option<f64>) -> Network {
        let (fibres, bonds) = self.sheet();
        if level == Level::Tube {
            return super::tubes::network(&fibres, &bonds, self.size_um[0]);
        }
        let model = FrameModel {
            segment_um,
            ..model(level, self.size_um[0])
        };
        Network::new(&fibres, &bonds, model).unwrap()
    }
}

/// Where two lines cross, seen from above, as distances from their starts.
fn crossing(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]) -> Option<[f64; 2]> {
    let along = |line: &[[f64; 3]; 2]| [line[1][0] - line[0][0], line[1][1] - line[0][1]];
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (p, q) = (along(a), along(b));
    let between = [b[0][0] - a[0][0], b[0][1] - a[0][1]];
    let (s, t) = (
        cross(between, q) / cross(p, q),
        cross(between, p) / cross(p, q),
    );
    let is_inside = |share: f64| (0.0..=1.0).contains(&share);
    (is_inside(s) && is_inside(t)).then(|| [s * f64::hypot(p[0], p[1]), t * f64::hypot(q[0], q[1])])
}

pub(super) const TO_THE_END: PullTest = PullTest {
    max_strain: 0.5,
    stop_force_fraction: 0.05,
    break_precision: 0.0,
};

#[test]
fn the_cut_into_segments_does_not_matter() {
    let test = PullTest {
        max_strain: 1e-6,
        ..TO_THE_END
    };
    for (level, scatter) in [(Level::Beam, SMALL), (Level::Truss, LONG)] {
        let force = |segment_um: Option<f64>| {
            let network = scatter.network(level, segment_um);
            let mut pull = Pull::new(&network, test).unwrap();
            pull.run().unwrap();
            pull.jaw_force_mn()[1]
        };
        let whole = force(None);
        assert!(whole > 0.0);
        close(force(Some(20.0)), whole, 1e-8);
        close(force(Some(7.0)), whole, 1e-8);
    }
}

#[test]
fn turning_the_sheet_about_the_pull_or_upside_down_does_not_matter() {
    let (fibres, bonds) = SMALL.sheet();
    let [length, _] = SMALL.size_um;
    let turns: [&dyn Fn([f64; 3]) -> [f64; 3]; 3] = [
        // half a turn about x: a sheet lies in its plane, where its fibres touch as ribbons do
        &|[x, y, z]| [x, -y, -z],
        // half a turn about z: the jaws change places
        &|[x, y, z]| [length - x, -y, z],
        &|[x, y, z]| [x, y, -z],
    ];
    let model = model(Level::Beam, length);
    let pull = |fibres: &[FrameFibre]| {
        let network = Network::new(fibres, &bonds, model).unwrap();
        Pull::new(&network, TO_THE_END).unwrap().run().unwrap().0
    };
    let straight = pull(&fibres);
    for turn in turns {
        let turned: Vec<FrameFibre> = fibres
            .iter()
            .map(|fibre| FrameFibre {
                centre_line_um: fibre
                    .centre_line_um
                    .iter()
                    .map(|&point| turn(point))
                    .collect(),
                ..fibre.clone()
            })
            .collect();
        same_events(&pull(&turned), &straight, 1e-8);
    }
}

fn same_events(found: &[Event], expected: &[Event], share: f64) {
    let first = expected[0].force_before_mn;
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.broken, expected.broken);
        close(found.strain, expected.strain, share);
        assert!((found.force_after_mn - expected.force_after_mn).abs() < share * first);
        // what is left of a truss is a mechanism: its forces are round-off
        let is_left = found.force_after_mn > 1e-6 * first;
        assert!(found.residual < 1e-9 || !is_left, "{}", found.residual);
    }
    assert_eq!(found.len(), expected.len());
}

#[test]
fn events_are_the_same_with_and_without_a_new_factor() {
    for (level, scatter) in [
        (Level::Beam, SMALL),
        (Level::Truss, LONG),
        (Level::Tube, TUBES),
    ] {
        let network = scatter.network(level, None);
        let pull = |refactoring| {
            let state = PullState::default();
            let means = Means::by(Solver::Direct(refactoring));
            let mut pull = Pull::resume(&network, TO_THE_END, state, &means).unwrap();
            let events = pull.run().unwrap().0;
            (events, pull.cost(), pull.state().measures)
        };
        let (always, anew, measures) = pull(Refactoring::Always);
        let (never, kept, _) = pull(Refactoring::Never);
        let (by_cost, _, _) = pull(Refactoring::ByCost);
        assert!(always.len() > 5, "{}", always.len());
        assert!(anew.factors > always.len() && kept.factors < 5);
        same_events(&never, &always, 1e-9);
        same_events(&by_cost, &always, 1e-9);
        // at the end the sheet is 1e4 times softer than it was, and round-off is still that of its
        // stiffest segments
        assert!(
            measures.energy_error() < 1e-8,
            "{}",
            measures.energy_error()
        );
        assert!(measures.largest_jaw_imbalance < 1e-9);
        assert!(always.iter().all(|event| event.energy_released_nj >= 0.0));
        let is_bond = |event: &&Event| matches!(event.broken, Broken::Bond(_));
        assert_eq!(always.iter().filter(is_bond).count(), measures.broken_bonds);
    }
}

#[test]
fn a_pull_goes_on_to_the_same_bits() {
    for (level, scatter) in [(Level::Beam, SMALL), (Level::Tube, TUBES)] {
        let network = scatter.network(level, None);
        let (whole, _) = Pull::new(&network, TO_THE_END).unwrap().run().unwrap();
        let (again, _) = Pull::new(&network, TO_THE_END).unwrap().run().unwrap();
        assert_eq!(whole, again);
        for stop in [1, 7, whole.len() / 2] {
            let mut first = Pull::new(&network, TO_THE_END).unwrap();
            let mut events = Vec::new();
            for _ in 0..stop {
                if let Step::Broke(broke) = first.advance().unwrap() {
                    events.extend(broke);
                }
            }
            let state = first.state().clone();
            let mut second = Pull::resume(&network, TO_THE_END, state, &Means::default()).unwrap();
            let bits = |pull: &Pull| pull.jaw_force_mn().map(f64::to_bits);
            assert_eq!(bits(&second), bits(&first));
            events.extend(second.run().unwrap().0);
            assert_eq!(events, whole);
        }
    }
}

#[test]
fn a_sheet_is_softer_than_coxs() {
    // all fibres straight from jaw to jaw would give E Σ A l cos⁴ / (length of the sheet) per strain
    let (fibres, _) = SMALL.sheet();
    let affine: f64 = fibres
        .iter()
        .map(|fibre| {
            let [a, b] = [fibre.centre_line_um[0], fibre.centre_line_um[1]];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            dx.powi(4) / f64::hypot(dx, dy).powi(3) * tube().area_um2 * tube().youngs_modulus_gpa
        })
        .sum();
    let stiffness = |level| {
        let network = SMALL.network(level, None);
        let pull = Pull::new(&network, TO_THE_END).unwrap();
        pull.state().measures.initial_stiffness_mn
    };
    let (beam, truss) = (stiffness(Level::Beam), stiffness(Level::Truss));
    let bound = affine / SMALL.size_um[0];
    assert!(truss < beam && beam < bound, "{truss} {beam} {bound}");
}

#[test]
fn at_small_strain_large_motions_are_small_ones() {
    let network = SMALL.network(Level::Beam, None);
    let strain = 1e-7;
    let elongation = strain * SMALL.size_um[0];
    let large = network.rest_at_large(elongation, &[], 1).unwrap();
    let small = network.rest(elongation, &[]).unwrap();
    // the difference is of the order of strain over slenderness
    close(large.jaw_force_mn[1], small.jaw_force_mn[1], 1e-3);
    close(large.energy_nj, small.energy_nj, 1e-3);
}

#[test]
fn a_sheet_begins_to_break_alike_at_large_motions() {
    let network = SMALL.network(Level::Beam, None);
    let test = LargePullTest {
        until: TO_THE_END,
        strain_step: 0.001,
    };
    let mut large = LargePull::new(&network, test).unwrap();
    let mut small = Pull::new(&network, TO_THE_END).unwrap();
    for _ in 0..2 {
        let Step::Broke(expected) = small.advance().unwrap() else {
            panic!("a sheet breaks");
        };
        let found = loop {
            if let LargeStep::Broke(event) = large.advance().unwrap() {
                break event;
            }
        };
        // strains are 0.001: what turns is of second order
        let [expected] = expected.as_slice() else {
            panic!("one by one");
        };
        assert_eq!(found.broken, expected.broken);
        close(found.strain, expected.strain, 5e-3);
        close(found.force_before_mn, expected.force_before_mn, 5e-3);
        assert!(found.residual < 1e-7, "{}", found.residual);
    }
}

/// Time and memory of a large sheet; `cargo test --release -p loadframe-paper --lib large_sheet -- --ignored
/// --nocapture`.
#[test]
#[ignore = "measures: minutes"]
#[expect(
    clippy::print_stderr,
    clippy::disallowed_methods,
    reason = "it measures"
)]
fn large_sheet_by_time() {
    let number = |name: &str, other: usize| {
        let given = std::env::var(name)
            .ok()
            .and_then(|value| value.parse().ok());
        given.unwrap_or(other)
    };
    let scatter = Scatter {
        size_um: [5000.0, 5000.0],
        fibres: number("FIBRES", 2000),
        fibre_length_um: 1000.0,
        layer_um: 0.3,
        strength_gpa: Some(0.6),
    };
    let level = if number("TRUSS", 0) == 1 {
        Level::Truss
    } else {
        Level::Beam
    };
    let clock = std::time::Instant::now();
    let network = scatter.network(level, None);
    eprintln!(
        "{} nodes, {} bonds, {:.2?}",
        network.nodes(),
        network.bonds(),
        clock.elapsed()
    );
    let clock = std::time::Instant::now();
    let mut pull = Pull::new(&network, TO_THE_END).unwrap();
    eprintln!("{:?} {:.2?}", pull.cost(), clock.elapsed());
    for _ in 0..number("EVENTS", 200) {
        let clock = std::time::Instant::now();
        match pull.advance().unwrap() {
            Step::Broke(events) | Step::Moved(events) => {
                for event in events {
                    eprintln!(
                        "{:.3e} {:.4} {:?} {:.1e} {:.2?} {:?}",
                        event.strain,
                        event.force_after_mn,
                        event.broken,
                        event.residual,
                        clock.elapsed(),
                        pull.cost()
                    );
                }
            }
            Step::Strained => {}
            Step::Ended(end) => {
                eprintln!("{end:?}");
                break;
            }
        }
    }
    eprintln!("{:?}", pull.state().measures);
    let memory = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    eprintln!(
        "{:?}",
        memory.lines().find(|line| line.starts_with("VmHWM"))
    );
}
