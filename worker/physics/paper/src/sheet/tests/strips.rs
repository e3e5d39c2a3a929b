//! Sheets cut out, turned and coarsened.
#![allow(clippy::float_cmp, reason = "points are carried over unchanged")]
use super::*;

fn sheet() -> Sheet {
    lay(
        &deposited([1500.0, 1000.0], 30.0, vec![softwood(fixed(700.0))]),
        6,
    )
}

/// Place [µm] of a contact on one of its fibres.
fn place(sheet: &Sheet, contact: &Contact, side: usize) -> [f64; 3] {
    let line = &sheet.fibres[contact.fibres[side] as usize].centre_line_um;
    let arcs = polyline::arc_lengths(line);
    let at = contact.at_um[side];
    let end = arcs
        .partition_point(|arc| *arc < at)
        .clamp(1, arcs.len() - 1);
    let share = (at - arcs[end - 1]) / (arcs[end] - arcs[end - 1]);
    polyline::between(line[end - 1], line[end], share)
}

#[test]
fn contacts_lie_where_their_fibres_meet() {
    let sheet = sheet();
    assert!(sheet.contacts.len() > 500);
    for contact in &sheet.contacts {
        let [one, other] = [0, 1].map(|side| place(&sheet, contact, side));
        assert!((one[0] - other[0]).hypot(one[1] - other[1]) <= 28.0);
        // thickness and the gap of a quarter of a width at a slope of 0.3
        assert!((one[2] - other[2]).abs() <= 5.84 + 2.1 + 1e-6);
        assert!(contact.area_um2 > 0.0);
    }
}

#[test]
fn a_strip_holds_the_same_fibres_and_contacts_at_the_same_places() {
    let sheet = sheet();
    let strip = sheet
        .strip([300.0, 200.0], [800.0, 500.0])
        .expect("it is inside");
    let places = |sheet: &Sheet, shift: [f64; 2]| {
        let places = sheet.contacts.iter().map(|contact| {
            let [x, y, z] = place(sheet, contact, 0);
            [x + shift[0], y + shift[1], z]
        });
        // an inner part, so that pieces left out at the edges do not count
        places
            .filter(|[x, y, _]| (340.0..1060.0).contains(x) && (240.0..660.0).contains(y))
            .collect::<Vec<_>>()
    };
    let (whole, cut) = (places(&sheet, [0.0; 2]), places(&strip, [300.0, 200.0]));
    assert!(cut.len() > 100 && cut.len() <= whole.len());
    // contacts with pieces shorter than their width are lost, and these are few
    assert!(
        cut.len() as f64 > 0.98 * whole.len() as f64,
        "{} {}",
        cut.len(),
        whole.len()
    );
    for place in &cut {
        let nearest = whole.iter().map(|known| polyline::distance(*known, *place));
        // joining a short end moves a centre line by less than a tenth of a micrometre
        assert!(nearest.fold(f64::INFINITY, f64::min) < 0.1);
    }
    for fibre in &strip.fibres {
        let ends = [
            fibre.centre_line_um[0],
            fibre.centre_line_um[fibre.centre_line_um.len() - 1],
        ];
        assert!(
            ends.iter()
                .all(|[x, y, _]| { (0.0..=800.0).contains(x) && (0.0..=500.0).contains(y) })
        );
    }
    let on_jaw = strip
        .fibres
        .iter()
        .filter(|fibre| fibre.centre_line_um[0][0] <= 0.0)
        .count();
    assert!(on_jaw > 5, "{on_jaw}");
}

#[test]
fn the_whole_sheet_is_a_strip_of_itself() {
    let sheet = sheet();
    let strip = sheet.strip([0.0; 2], sheet.size_um).expect("it is inside");
    assert_eq!(strip.fibres.len(), sheet.fibres.len());
    assert_eq!(strip.contacts.len(), sheet.contacts.len());
}

#[test]
fn a_quarter_turn_changes_directions_and_nothing_else() {
    let sheet = sheet();
    let turned = sheet.turned();
    assert_eq!(turned.size_um, [1000.0, 1500.0]);
    let [before, after] = [&sheet, &turned].map(|sheet| Statistics::of(sheet, 10).expect("fibres"));
    assert!((before.anisotropy + after.anisotropy).abs() < ROUNDING);
    assert!((before.fibre_length_um / after.fibre_length_um - 1.0).abs() < ROUNDING);
    assert!((before.mean_thickness_um / after.mean_thickness_um - 1.0).abs() < 0.02);
    for contact in &turned.contacts {
        let [one, other] = [0, 1].map(|side| place(&turned, contact, side));
        assert!((one[0] - other[0]).hypot(one[1] - other[1]) <= 28.0);
    }
}

#[test]
fn coarser_lines_keep_their_contacts_nearby() {
    let sheet = sheet();
    let coarse = sheet.coarsened(50.0).expect("it is a length");
    assert_eq!(coarse.contacts.len(), sheet.contacts.len());
    let points = |sheet: &Sheet| -> usize {
        sheet
            .fibres
            .iter()
            .map(|fibre| fibre.centre_line_um.len())
            .sum()
    };
    assert!(points(&coarse) * 5 < points(&sheet));
    for (before, after) in sheet.contacts.iter().zip(&coarse.contacts) {
        for side in 0..2 {
            let moved =
                polyline::distance(place(&sheet, before, side), place(&coarse, after, side));
            // half a segment up and down at a slope of 0.3
            assert!(moved < 0.5 * 50.0 * 0.3 + 2.0, "{moved}");
        }
    }
    for (before, after) in sheet.fibres.iter().zip(&coarse.fibres) {
        assert!(after.length_um() <= before.length_um() * (1.0 + ROUNDING));
        assert!(after.length_um() > 0.95 * before.length_um());
        assert_eq!(before.centre_line_um[0], after.centre_line_um[0]);
    }
    assert!(sheet.coarsened(0.0).is_err());
}

#[test]
fn strips_beyond_the_sheet_are_refused_with_what_is_left() {
    let error = sheet()
        .strip([1000.0, 0.0], [600.0, 100.0])
        .expect_err("too long");
    assert_eq!(
        error.to_string(),
        "size of the strip along x is 600 um; allowed is above 0, up to the 500 um that are left of the sheet"
    );
    for (corner, size) in [
        ([-1.0, 0.0], [10.0, 10.0]),
        ([0.0, 1000.0], [10.0, 10.0]),
        ([0.0, 0.0], [0.0, 10.0]),
        ([0.0, f64::NAN], [10.0, 10.0]),
    ] {
        assert!(sheet().strip(corner, size).is_err());
    }
}
