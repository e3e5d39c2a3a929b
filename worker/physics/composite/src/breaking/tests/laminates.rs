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
    assert_eq!(
        (event.part, event.mode),
        (BrokenPart::Matrix, Mode::Tension)
    );
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
    assert!(imbalance(&events) < BALANCE);
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
pub(super) fn with_fibre(angle_deg: f64) -> Section {
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

/// Measured, energy over G times area: 1.107, 1.043, 0.985 with cells of 0.75, 0.5 and 0.25 of the
/// process zone; the error of the finest grid's saw is 0.098.
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
        assert!(
            (events[0].force_n / (5.0 * 6.0) - 1.0).abs() < 1e-9,
            "{}",
            events[0].force_n
        );
        let totals = breaking.totals();
        assert!(imbalance(&events) < BALANCE);
        // one of the two faces, over the whole height
        assert!((totals.crack_area_mm2 - 6.0).abs() < 1e-9);
        assert_eq!(totals.broken_cells as usize, cells[1]);
        let taken = totals.dissipated.interfaces_n_mm / (0.05 * 6.0);
        let coarse = if cells[1] < 12 {
            totals.coarseness
        } else {
            0.0
        };
        assert!(
            (taken - 1.0).abs() < totals.saw_error + coarse,
            "{cells:?} {taken}"
        );
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
        )
        .stiffness;
        assert!(
            (composed - stiffness).amax() < 1e-12 * stiffness.amax(),
            "{cell}"
        );
        let mean = parts
            .iter()
            .zip(&bearings)
            .fold(Vector3::zeros(), |sum, (part, bearing)| {
                // from the axes of its planes to those of the section: σ = Tᵀ σ'
                let axis = breaking.parts.laws[part.law as usize]
                    .axis
                    .unwrap_or([1.0, 0.0]);
                let turn = composition::strain_turn(axis);
                sum + turn.transpose() * (bearing.stress * strain) * part.share
            });
        let expected = stiffness * strain;
        assert!(
            (mean - expected).amax() < 1e-10 * expected.amax(),
            "{mean} {expected}"
        );
        counts[parts.len()] += 1;
    }
    assert!(
        counts[1] > 0 && counts[2] > 0 && counts[3] > 0,
        "{counts:?}"
    );
}

#[test]
fn a_face_that_slid_under_pressure_still_bears_it_and_opens_when_pulled() {
    use super::criterion::{cracked, first_crack};
    let face = InterfaceStrength {
        normal: tough(5.0, 0.05).unwrap(),
        shear: tough(8.0, 0.1).unwrap(),
    };
    let strength = MaterialStrength {
        bulk: Strength::default(),
        interface: Some(face),
    };
    let case = Case::pulled(&with_fibre(0.0), [12, 6], 1.0, &[UNBREAKABLE, strength]);
    let breaking = case.breaking();
    let place = breaking
        .parts
        .all
        .iter()
        .position(part::Part::is_face)
        .unwrap();
    let part = breaking.parts.all[place];
    let law = breaking.parts.laws[part.law as usize];
    let sides = [1.0, 1.0];
    let mut damage = breaking.damage[place];
    let crack = |damage: &Damage, stress: [f64; 3]| {
        first_crack(&part, &law, damage, 10, [stress, [0.0; 3]])
    };
    // (⟨σ⟩/5)² + (τ/8)² = 1: pressure does not count
    let hit = crack(&damage, [0.0, 3.0, 4.0]).unwrap();
    assert!((hit.factor - 1.0 / (0.36_f64 + 0.25).sqrt()).abs() < 1e-12);
    let pressed = [0.0, -100.0, 4.0];
    let hit = crack(&damage, pressed).unwrap();
    assert!((hit.factor - 2.0).abs() < 1e-12 && hit.is_pressed);
    for level in 1..=10 {
        let hit = crack(&damage, pressed).unwrap();
        damage = cracked(&part, &law, &damage, 10, sides, 1.0, &hit).unwrap();
        let opened = if level < 10 { 0 } else { 10 };
        assert_eq!(
            (damage.planes[1].level, damage.planes[1].opened),
            (level, opened)
        );
        let [normal, shear] = damage.planes[1].softness(10, true);
        assert!(normal == 0.0 && shear > 0.0);
    }
    assert!(crack(&damage, pressed).is_none());
    // nothing but pressure holds it any more: pulled, it parts
    assert!(damage.planes[1].is_closed && damage.planes[1].has_faces());
    assert!(crack(&damage, [0.0, 1.0, 0.0]).is_none());
    damage.planes[1].is_closed = false;
    let [normal, _] = damage.planes[1].softness(10, true);
    assert!(normal > 1e5, "{normal}");
}

#[test]
fn principal_stresses_crack_across_their_own_direction() {
    use super::criterion::first_crack;
    let strength = MaterialStrength {
        bulk: Strength {
            tension: brittle(10.0),
            compression: brittle(15.0),
            ..Strength::default()
        },
        interface: None,
    };
    let section = plain([1.0, 1.0], isotropic(100.0, 0.2), 0.0);
    let breaking = Case::pulled(&section, [1, 1], 1.0, &[strength]).breaking();
    let (part, law) = (breaking.parts.all[0], breaking.parts.laws[0]);
    for step in 0..24 {
        let (s, c) = (f64::from(step) * 15.0_f64.to_radians()).sin_cos();
        for (principal, factor, is_pressed) in [
            ([4.0, 1.0], 10.0 / 4.0, false),
            ([4.0, -5.0], 10.0 / 4.0, false),
            ([1.0, -5.0], 15.0 / 5.0, true),
        ] {
            let [p, q]: [f64; 2] = principal;
            let stress = [
                p * c * c + q * s * s,
                p * s * s + q * c * c,
                (p - q) * s * c,
            ];
            let hit =
                first_crack(&part, &law, &breaking.damage[0], 10, [stress, [0.0; 3]]).unwrap();
            assert!((hit.factor - factor).abs() < 1e-12, "{hit:?}");
            assert_eq!(hit.is_pressed, is_pressed);
            // across the first principal direction, or the second
            let expected = if is_pressed { [-s, c] } else { [c, s] };
            let cosine = hit.axis[0] * expected[0] + hit.axis[1] * expected[1];
            assert!((cosine.abs() - 1.0).abs() < 1e-12, "{hit:?} {step}");
        }
    }
}

#[test]
fn no_damage_makes_a_cell_indefinite_or_stiffer() {
    let mut section = with_fibre(30.0);
    section.materials[0].material = CARBON;
    let face = InterfaceStrength {
        normal: tough(50.0, 9.0).unwrap(),
        shear: tough(80.0, 9.0).unwrap(),
    };
    let tough_ply = MaterialStrength {
        bulk: Strength {
            tension: tough(100.0, 9.0),
            compression: tough(100.0, 9.0),
            across_tension: tough(30.0, 9.0),
            across_compression: tough(40.0, 9.0),
            shear: tough(30.0, 9.0),
        },
        interface: Some(face),
    };
    let case = Case::pulled(&section, [12, 6], 1.0, &[tough_ply; 2]);
    let mut breaking = case.breaking();
    let mut seen = 0;
    for cell in 0..72 {
        let of = breaking.parts.of(cell);
        if of.len() < 3 {
            continue;
        }
        seen += 1;
        let mut before = breaking.intact[cell];
        // one tooth after the other of every plane of every part, down to nothing
        for step in 0..60 {
            let place = of.start + step % of.len();
            let plane = (step / of.len()) % 2;
            if breaking.parts.all[place].is_face() && plane == 0 {
                continue;
            }
            let state = &mut breaking.damage[place].planes[plane];
            state.roots = [0.1; 2];
            state.level = (state.level + 1).min(10);
            state.opened = state.level;
            let after = breaking.composed(cell).stiffness;
            let scale = breaking.intact[cell].amax();
            let least = after.symmetric_eigenvalues().min();
            assert!(least > 1e-10 * scale, "{cell} {step} {least}");
            let lost = (before - after).symmetric_eigenvalues().min();
            assert!(lost > -1e-12 * scale, "{cell} {step} {lost}");
            before = after;
        }
        assert!(breaking.damage()[cell] > 0.999);
    }
    assert!(seen > 5, "{seen}");
}
