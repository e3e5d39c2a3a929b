//! Sheets at the limits of what may be asked for.
use super::*;

#[test]
fn one_fibre_touches_nothing() {
    // 500 µm of fibre in 4 mm²
    let grammage = 2.45e-4 * 500.0 / 4e6 * 1e6;
    for plan in
        [random, deposited].map(|plan| plan([2000.0; 2], grammage, vec![softwood(fixed(500.0))]))
    {
        let sheet = (0..50)
            .map(|seed| lay(&plan, seed))
            .find(|sheet| sheet.fibres.len() == 1)
            .expect("a fibre of 50 lies wholly inside");
        assert!(sheet.contacts.is_empty());
        let measured = Statistics::of(&sheet, 5).expect("there is a fibre");
        assert!(measured.free_length_um.is_none());
        assert!(measured.contacts_per_fibre < f64::MIN_POSITIVE);
        assert!((measured.fibre_length_um - 500.0).abs() < 1e-9);
    }
}

#[test]
fn light_and_heavy_sheets_are_laid() {
    for (side, grammage) in [(2000.0, 5.0), (300.0, 500.0)] {
        let sheet = lay(
            &deposited([side; 2], grammage, vec![softwood(fixed(1500.0))]),
            1,
        );
        let measured = Statistics::of(&sheet, 5).expect("there are fibres");
        assert!((measured.grammage_ug_per_um2 / (grammage * 1e-6) - 1.0).abs() < ROUNDING);
        assert!(!sheet.contacts.is_empty());
    }
}

#[test]
fn fibres_longer_than_the_sheet_and_strongly_curled_ones_are_cut_to_it() {
    for shape_factor in [1.0, 0.5, 0.1] {
        let pulp = Pulp {
            shape_factor,
            ..softwood(fixed(3000.0))
        };
        let sheet = lay(&deposited([400.0, 300.0], 30.0, vec![pulp]), 1);
        let longest = sheet
            .fibres
            .iter()
            .map(SheetFibre::length_um)
            .fold(0.0, f64::max);
        assert!(longest > 300.0 && longest < 2000.0, "{longest}");
        for contact in &sheet.contacts {
            assert!(contact.fibres[0] < contact.fibres[1]);
            for side in 0..2 {
                let length = sheet.fibres[contact.fibres[side] as usize].length_um();
                assert!((0.0..=length * (1.0 + ROUNDING)).contains(&contact.at_um[side]));
            }
        }
    }
}

#[test]
fn fibres_far_apart_in_a_thick_sheet_do_not_touch() {
    let plan = SheetPlan {
        placement: Placement::Random3d { thickness_um: 1e6 },
        ..random([1000.0; 2], 1.0, vec![softwood(fixed(500.0))])
    };
    let sheet = lay(&plan, 1);
    assert!(sheet.fibres.len() > 8 && sheet.contacts.is_empty());
}

#[test]
fn walls_as_thick_as_half_the_width_are_solid() {
    let pulp = Pulp {
        wall_um: 14.0,
        ..softwood(fixed(600.0))
    };
    // π/4 of the width
    assert!((pulp.section().thickness_um / 28.0 - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
    assert!(
        !lay(&deposited([600.0; 2], 40.0, vec![pulp]), 1)
            .contacts
            .is_empty()
    );
}

#[test]
fn nothing_is_measured_on_an_empty_sheet() {
    let sheet = Sheet {
        size_um: [100.0; 2],
        fibres: Vec::new(),
        contacts: Vec::new(),
    };
    assert_eq!(Statistics::of(&sheet, 5), None);
    assert!(contacts(&sheet.fibres, 1.0, &Team::alone()).is_empty());
}
