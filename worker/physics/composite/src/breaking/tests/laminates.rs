//! Plies, fibres and their faces.
use super::*;
use crate::section::{Fibre, Ply};
use crate::tests::{CARBON, isotropic, orthotropic, plain, stacked};

const PLY: MaterialStrength = MaterialStrength {
    bulk: Strength {
        tension: Some(Limit {
            limit: 2_000.0,
            fracture_energy_n_per_mm: None,
        }),
        compression: Some(Limit {
            limit: 1_200.0,
            fracture_energy_n_per_mm: None,
        }),
        across_tension: Some(Limit {
            limit: 50.0,
            fracture_energy_n_per_mm: None,
        }),
        across_compression: Some(Limit {
            limit: 200.0,
            fracture_energy_n_per_mm: None,
        }),
        shear: Some(Limit {
            limit: 80.0,
            fracture_energy_n_per_mm: None,
        }),
    },
    interface: None,
};

fn first(case: &Case) -> Event {
    match case.breaking().advance().unwrap() {
        Advance::Broke(event) => event,
        Advance::Ended(reason) => panic!("{reason:?}"),
    }
}

#[test]
fn the_plies_across_crack_first_at_their_transverse_strain() {
    let (length, height) = (10.0, 2.0);
    let section = stacked(length, height, &[0.0, 90.0, 90.0, 0.0]);
    let case = Case::pulled(&section, [20, 4], 1.0, &[PLY]);
    let event = first(&case);
    // E₂ = 10 GPa: 50 MPa at 0.5 %; along, 2000 MPa of 140 GPa are 1.4 %
    assert!((event.displacement_mm / length - 50.0 / 10_000.0).abs() < 1e-9);
    assert!([1, 2].contains(&(event.cell / 20)), "{}", event.cell);
    assert_eq!((event.part, event.mode), (BrokenPart::Matrix, Mode::Tension));
    assert!((event.normal[0].abs() - 1.0).abs() < 1e-9);
    let force = 5e-3 * height * (140_000.0 + 10_000.0) / 2.0;
    assert!((event.force_n / force - 1.0).abs() < 1e-9);
    // two plies through one cell: the same
    let coarse = Case::pulled(&section, [20, 2], 1.0, &[PLY]);
    assert!((first(&coarse).displacement_mm - event.displacement_mm).abs() < 1e-9);
    // then, all across being cracked through, the fibres
    let mut case = Case::pulled(&section, [6, 4], 1.0, &[PLY]);
    case.options.stop.force_fraction = 0.5;
    let (events, _) = broken(&mut case.breaking());
    let along = events
        .iter()
        .position(|event| [0, 3].contains(&(event.cell / 6)))
        .unwrap();
    assert!(events[..along].iter().all(|e| e.mode == Mode::Tension));
    assert!(imbalance(&events) < 1e-9);
}

#[test]
fn limits_of_strain_are_strains() {
    let length = 10.0;
    let section = stacked(length, 2.0, &[0.0, 90.0, 0.0, 90.0]);
    let mut strength = PLY;
    strength.bulk.across_tension = brittle(0.006);
    strength.bulk.tension = brittle(0.02);
    let mut case = Case::pulled(&section, [10, 4], 1.0, &[strength]);
    case.options.criterion = Criterion::Strain;
    // the first crack does not wait for bending: the ends stay straight but for the section's own
    // curvature, which this stack has
    let event = first(&case);
    assert_eq!(event.part, BrokenPart::Matrix);
    let strain = event.displacement_mm / length;
    assert!((strain / 0.006 - 1.0).abs() < 0.05, "{strain}");
    // of one ply, exactly
    let section = stacked(length, 2.0, &[90.0]);
    let mut case = Case::pulled(&section, [10, 4], 1.0, &[strength]);
    case.options.criterion = Criterion::Strain;
    assert!((first(&case).displacement_mm / length / 0.006 - 1.0).abs() < 1e-9);
}

#[test]
fn a_ply_at_45_degrees_out_of_the_plane_bears_what_the_turned_stress_says() {
    let length = 10.0;
    let section = stacked(length, 2.0, &[45.0]);
    let case = Case::pulled(&section, [5, 2], 1.0, &[PLY]);
    // σ/2 across and σ/2 in shear: σ = 2 / √(1/50² + 1/80²) = 84.8 MPa
    let expected = 2.0 / (1.0 / 2_500.0 + 1.0 / 6_400.0_f64).sqrt();
    assert!((first(&case).force_n / 2.0 / expected - 1.0).abs() < 1e-9);
    let mut strain = Case::pulled(&section, [5, 2], 1.0, &[PLY]);
    strain.options.criterion = Criterion::Strain;
    assert!(strain.refused().contains("0 or 90"), "{}", strain.refused());
}

/// A fibre along x in a matrix; limits of the fibre, and of its faces.
fn with_fibre(angle_deg: f64) -> Section {
    let mut section = plain([12.0, 6.0], isotropic(1_000.0, 0.3), 0.0);
    let mut second = section.materials[0];
    second.material = orthotropic(50_000.0, 5_000.0, 0.25, Some(2_000.0));
    section.materials.push(second);
    section.fibres = vec![Fibre {
        material: 1,
        through_mm: [6.0, 3.0],
        angle_deg,
        thickness_mm: 1.0,
        length_mm: None,
    }];
    section
}

#[test]
fn a_fibre_breaks_in_tension_and_in_compression_at_its_own_limits() {
    let strength = MaterialStrength {
        bulk: Strength {
            tension: brittle(1_000.0),
            compression: brittle(400.0),
            ..Strength::default()
        },
        interface: None,
    };
    for (reach, mode, strain) in [
        (1.0, Mode::Tension, 1_000.0 / 50_000.0),
        (-1.0, Mode::Compression, 400.0 / 50_000.0),
    ] {
        // rows of 1 mm: the fibre fills one, or shares two with matrix
        for rows in [6, 4] {
            let cells = [12, rows];
            let case = Case::pulled(&with_fibre(0.0), cells, reach, &[UNBREAKABLE, strength]);
            let event = first(&case);
            assert_eq!((event.part, event.mode), (BrokenPart::Fibre(0), mode));
            // the ends are straight, so that fibre and matrix share the strain; Poisson's ratios
            // differ, and the stress between them changes it by little
            let found = event.displacement_mm / 12.0;
            assert!((found / strain - 1.0).abs() < 2e-3, "{found} {strain}");
        }
    }
}

#[test]
fn a_weak_face_opens_first_and_takes_its_energy() {
    let face = InterfaceStrength {
        normal: tough(5.0, 0.05).unwrap(),
        shear: tough(8.0, 0.1).unwrap(),
    };
    let fibre = MaterialStrength {
        bulk: Strength {
            tension: brittle(1_000.0),
            ..Strength::default()
        },
        interface: Some(face),
    };
    let matrix = in_tension(tough(20.0, 1.0));
    for (angle, cells) in [(90.0, [12, 6]), (90.0, [8, 4]), (90.0, [24, 12])] {
        let mut section = with_fibre(angle);
        section.materials[0].material = isotropic(1_000.0, 0.0);
        section.materials[1].material = orthotropic(50_000.0, 5_000.0, 0.0, Some(2_000.0));
        let mut case = Case::pulled(&section, cells, 1.0, &[matrix, fibre]);
        case.options.stop.force_fraction = 0.01;
        let mut breaking = case.breaking();
        let (events, _) = broken(&mut breaking);
        assert_eq!(events[0].part, BrokenPart::Interface(0));
        assert_eq!(events[0].mode, Mode::Tension);
        assert!((events[0].force_n / (5.0 * 6.0) - 1.0).abs() < 1e-9, "{}", events[0].force_n);
        let totals = breaking.totals();
        println!("{cells:?} {totals:?}");
        assert!(imbalance(&events) < 1e-9);
        let taken = totals.dissipated.interfaces_n_mm / (0.05 * totals.crack_area_mm2);
        println!("{taken}");
    }
}

#[test]
fn composed_cells_are_the_layouts_and_their_parts_bear_their_stress() {
    let mut section = with_fibre(30.0);
    section.materials[0].material = CARBON;
    section.plies = [0.0, 90.0, 45.0]
        .map(|angle_deg| Ply {
            material: 0,
            thickness_mm: 2.0,
            angle_deg,
            in_plane_angle_deg: 5.0,
        })
        .to_vec();
    let second = Fibre {
        material: 1,
        through_mm: [1.5, 4.5],
        angle_deg: 90.0,
        thickness_mm: 0.4,
        length_mm: Some(1.5),
    };
    section.fibres.push(second);
    let case = Case::pulled(&section, [11, 7], 1.0, &[UNBREAKABLE; 2]);
    let breaking = case.breaking();
    let strain = Vector3::new(1e-3, -4e-4, 7e-4);
    let mut counts = [0; 5];
    for (cell, stiffness) in case.layout.stiffness().iter().enumerate() {
        let of = breaking.parts.of(cell);
        let mut bearings = breaking.bearings[of.clone()].to_vec();
        let parts = &breaking.parts.all[of.clone()];
        let composed = compose(
            parts,
            &breaking.parts.laws,
            &breaking.damage[of],
            10,
            &mut bearings,
        );
        assert!((composed - stiffness).amax() < 1e-12 * stiffness.amax(), "{cell}");
        let mean = parts
            .iter()
            .zip(&bearings)
            .fold(Vector3::zeros(), |sum, (part, bearing)| {
                // from the axes of its planes to those of the section: σ = Tᵀ σ'
                let axis = breaking.parts.laws[part.law as usize].axis.unwrap_or([1.0, 0.0]);
                let turn = composition::strain_turn(axis);
                sum + turn.transpose() * (bearing.stress * strain) * part.share
            });
        let expected = stiffness * strain;
        assert!((mean - expected).amax() < 1e-10 * expected.amax(), "{mean} {expected}");
        counts[parts.len()] += 1;
    }
    assert!(counts[1] > 0 && counts[2] > 0 && counts[3] > 0, "{counts:?}");
}
