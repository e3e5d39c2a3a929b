//! A short run that tells how fast a machine is.
use loadframe_api::{
    JobSpec,
    spec::nonwoven_tensile::{
        Accuracy, Bond, Fabric, Jaws, Knobs, Lattice, NonwovenTensile, Output, Test,
    },
};

/// A job of some 3·10⁷ bond evaluations, about 0.1 s on a core of 2023: a lattice too large for a
/// core's own cache, as real ones are, strained without breaking. The `bond_evaluations` in its
/// report's work over the time it took is the speed estimates are made with.
pub fn calibration_spec() -> JobSpec {
    JobSpec::NonwovenTensile(Box::new(NonwovenTensile {
        version: 1,
        seed: 1,
        fabric: Fabric::Lattice(Lattice {
            points_per_row: 49,
            rows: 51,
            layers: 3,
            spacing_mm: [20.0, 20.0, 10.0],
            irregularity: [0.5; 3],
            jaws: Jaws::HalfBond,
            thickness_mm: None,
            grammage_g_per_m2: None,
        }),
        bond: Bond {
            modulus_n: Some(0.399),
            friction_modulus_n: 1.473,
            compression_stiffness_n: 0.157,
            mean_strength_n: Some(3.397),
            strength_sigma: 0.365,
            strength_draw: Default::default(),
        },
        test: Test {
            strain_step: 0.01,
            max_strain: 0.03,
            ..Test::default()
        },
        accuracy: Accuracy::Knobs(Knobs::default()),
        output: Output {
            snapshot_every_steps: 0,
            ..Output::default()
        },
    }))
}
