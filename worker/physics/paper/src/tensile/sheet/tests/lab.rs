//! Pulps as they are measured, tests of the fibres alone, theories beside results, errors of results.
use serde_json::{Value, json};

use super::{codes, go, pulp, value};

/// Fibres of 600 MPa on 0.6 mm x 0.4 mm that lie flat and are hardly bonded.
fn flat() -> Value {
    let mut pulps = pulp();
    pulps[0]["strength_mpa"] = json!(600);
    pulps[0]["shape_factor"] = json!(1);
    json!({
        "version": 1, "seed": 5, "pulp": pulps,
        "specimen": {"sheet": {"length_mm": 0.6, "width_mm": 0.4, "grammage_g_per_m2": 20,
                               "placement": {"random": {"thickness_um": 100}}}},
        "bond": {"normal_strength_mpa": 4, "shear_strength_mpa": 4, "stiffness_n_per_m_per_um2": 250},
        "accuracy": "draft",
    })
}

fn zero_span() -> Value {
    let mut body = flat();
    body["test"] = json!({"type": "zero_span"});
    body.as_object_mut().unwrap().remove("bond");
    body
}

/// Strength over density of the wall [N m/g]: 600 MPa × π 2 (28 − 2) µm² over 0.245 g/km.
const FIBRE_INDEX: f64 = 600.0 * std::f64::consts::PI * 52.0 / 0.245 * 1e-3;

#[test]
fn between_closed_jaws_fibres_break_and_their_index_is_that_of_the_fibres() {
    let mut body = zero_span();
    let width = json!(4);
    body["specimen"]["sheet"]["width_mm"] = width;
    let (report, record) = go(&body, 1);
    assert_eq!(codes(&report), Vec::<&str>::new());
    assert!(report.quality.values().all(|check| check.ok));
    assert_eq!(value(&report, "bonds"), 0.0);
    assert!(value(&report, "broken_fibres") > 10.0);
    assert!(
        record
            .table("events.csv")
            .iter()
            .all(|event| event[6] == 3.0)
    );
    // fibres along the pull break at σ/E = 0.02, few hold on much longer, and those at a small angle break
    // up to 0.25 % earlier, for jaws that hold them bend them, too
    let strain = value(&report, "zero_span_strain");
    assert!((0.9975 * 0.02..0.025).contains(&strain), "{strain}");
    let [run, fibres] =
        ["zero_span_index", "zero_span_index_of_fibres"].map(|name| value(&report, name));
    // 3/8 of that of a fibre for uniform directions; fifty fibres of 1 mm have them to a tenth or so
    assert!(
        (fibres / (0.375 * FIBRE_INDEX) - 1.0).abs() < 0.2,
        "{fibres}"
    );
    // one section of the sheet against all of them: a hundred fibres cross it
    assert!((run / fibres - 1.0).abs() < 0.2, "{run} {fibres}");
    let forbidden = ["tensile_index", "tensile_stiffness", "page_tensile_index"];
    assert!(
        forbidden
            .iter()
            .all(|name| !report.summary.contains_key(*name))
    );
}

#[test]
fn fibres_along_the_pull_alone_have_their_own_strength_between_closed_jaws() {
    let mut body = zero_span();
    // nearly all within 0.1 rad
    body["specimen"]["sheet"]["orientation"] = json!({"von_mises": {"concentration": 200}});
    let (report, _) = go(&body, 1);
    for name in ["zero_span_index", "zero_span_index_of_fibres"] {
        // the section that is crossed has more or fewer fibres than the mean one
        let found = value(&report, name) / FIBRE_INDEX;
        assert!((0.75..1.25).contains(&found), "{name} {found}");
    }
    let index = value(&report, "zero_span_index_of_fibres") / FIBRE_INDEX;
    assert!((0.97..1.0).contains(&index), "{index}");
}

#[test]
fn a_histogram_of_angles_turns_a_sheet() {
    // of eighteen bins of 10° those next to the machine direction, or those across it
    let sheet = |bins: [usize; 2]| {
        let mut densities = [0.0; 18];
        bins.iter().for_each(|bin| densities[*bin] = 1.0);
        let mut body = flat();
        body["specimen"]["sheet"]["orientation"] = json!({"histogram": {"densities": densities}});
        body["test"] = json!({"max_strain": 1e-6});
        value(&go(&body, 1).0, "anisotropy")
    };
    // the mean of cos 2θ over 0° to 10° is sin 20°/(20° in rad)
    let expected = 20_f64.to_radians().sin() / 20_f64.to_radians();
    let [along, across] = [sheet([0, 17]), sheet([8, 9])];
    assert!((along / expected - 1.0).abs() < 0.02, "{along} {expected}");
    assert!((across / expected + 1.0).abs() < 0.02, "{across}");
}

#[test]
fn measured_fibres_are_those_of_the_sheet() {
    let mut body = flat();
    let pulp = body["pulp"][0].as_object_mut().unwrap();
    pulp.remove("length_mm");
    pulp.remove("length_variation");
    pulp.insert(
        "measured".to_owned(),
        json!({"lengths_mm": [0.1, 0.1, 0.1], "widths_um": [20, 28, 36], "shape_factors": [1, 1, 0.9]}),
    );
    body["test"] = json!({"max_strain": 1e-6});
    let (report, record) = go(&body, 1);
    // whole fibres have 0.1 mm, those at edges less
    let lengths = record.table("fibre_lengths.csv");
    let longest = lengths.iter().rfind(|row| row[2] > 0.0).unwrap();
    assert!(
        (longest[1] - 0.1).abs() < 1e-9 && longest[2] > 0.5,
        "{longest:?}"
    );
    let width = value(&report, "mean_fibre_width");
    assert!((width - 28.0).abs() < 1.0, "{width}");
    assert!((value(&report, "grammage") / 20.0 - 1.0).abs() < 1e-9);
    // bonds between fibres of unlike walls: t = π 2 (W - 2)/W, and E/10 across
    body["bond"] = json!({});
    let (report, _) = go(&body, 1);
    let told = |one: f64, other: f64| {
        let half = |width: f64| 0.5 * std::f64::consts::PI * 2.0 * (width - 2.0) / width / 3.0;
        1000.0 / (half(one) + half(other))
    };
    let range = format!("{:.4} to {:.4}", told(36.0, 36.0), told(20.0, 20.0));
    assert!(
        report.warnings[0].detail.contains(&range),
        "{}",
        report.warnings[0].detail
    );
}

#[test]
fn pages_equation_takes_its_terms_from_the_job() {
    let (report, _) = go(&flat(), 1);
    let of = |name: &str| value(&report, name);
    // b P L RBA over 12 c: MPa µm² over g/km
    let bonded = 2.0 * of("mean_fibre_width") * 1e3 * of("length_weighted_fibre_length");
    let bonds = 4.0 * bonded * of("relative_bonded_area") / (12.0 * 0.245) * 1e-3;
    let fibres = 8.0 / 9.0 * of("zero_span_index_of_fibres");
    let expected = 1.0 / (1.0 / fibres + 1.0 / bonds);
    assert!((of("page_tensile_index") / expected - 1.0).abs() < 1e-9);
    assert!((of("page_bond_share") - expected / bonds).abs() < 1e-9);
    let over = of("tensile_index") / expected;
    assert!((of("tensile_index_over_page") / over - 1.0).abs() < 1e-9);
    // shear lag is below Cox, and near to it where bonds hardly give
    let [lag, cox] = ["shear_lag_stiffness_index", "cox_stiffness_index"].map(of);
    assert!(lag > 0.0 && lag < cox, "{lag} {cox}");
    let mut stiff = flat();
    stiff["bond"]["stiffness_n_per_m_per_um2"] = json!(1e8);
    stiff["test"] = json!({"max_strain": 1e-6});
    let (report, _) = go(&stiff, 1);
    let [lag, cox] =
        ["shear_lag_stiffness_index", "cox_stiffness_index"].map(|name| value(&report, name));
    assert!(lag > 0.95 * cox && lag < cox, "{lag} {cox}");
}

#[test]
fn results_say_how_wrong_they_may_be_and_from_what() {
    let mut body = flat();
    body["specimen"]["sheet"]
        .as_object_mut()
        .unwrap()
        .remove("placement");
    body["specimen"]["sheet"]["length_mm"] = json!(0.3);
    body["test"] = json!({"max_strain": 1e-3});
    let sources = |report: &loadframe_api::Report, name: &str| -> Vec<String> {
        let error = report.summary[name].error.as_ref();
        error.map_or_else(Vec::new, |error| {
            error.parts.iter().map(|part| part.source.clone()).collect()
        })
    };
    let (report, _) = go(&body, 1);
    assert_eq!(sources(&report, "tensile_stiffness"), ["straight_parts"]);
    assert!(sources(&report, "tensile_index").is_empty());
    body["test"]["repeats"] = json!(3);
    let (report, _) = go(&body, 2);
    for name in [
        "tensile_stiffness",
        "tensile_stiffness_index",
        "youngs_modulus",
    ] {
        assert_eq!(sources(&report, name), ["straight_parts", "specimens"]);
    }
    assert_eq!(sources(&report, "tensile_index"), ["specimens"]);
    let index = &report.summary["tensile_index"];
    let told = index.error.as_ref().unwrap().value;
    assert!((told / (index.deviation.unwrap() / 3_f64.sqrt()) - 1.0).abs() < 1e-12);
}

#[test]
fn bonds_inside_straight_parts_are_too_stiff_by_about_what_is_told() {
    let mut body = flat();
    let sheet = body["specimen"]["sheet"].as_object_mut().unwrap();
    sheet.remove("placement");
    sheet["grammage_g_per_m2"] = json!(40);
    body["model"] = json!({"segment_um": 80});
    body["test"] = json!({"max_strain": 1e-6});
    let stiffness = |report: &loadframe_api::Report| value(report, "tensile_stiffness");
    let (at_nodes, _) = go(&body, 1);
    body["accuracy"] = json!({"bonds_at": "inside", "break_precision": 0.05});
    let (inside, _) = go(&body, 1);
    let error = inside.summary["tensile_stiffness"].error.as_ref().unwrap();
    let told = error
        .parts
        .iter()
        .find(|part| part.source == "bonds_inside");
    let told = told.unwrap().value;
    let off = stiffness(&inside) - stiffness(&at_nodes);
    // the table is of another sheet
    assert!(told > 0.5 * off && told < 2.0 * off, "{told} for {off}");
}

#[test]
fn a_sheet_without_contact_or_with_one_fibre_has_a_sentence_and_no_force() {
    // a piece of fibre as long as it is wide and little more, far from both jaws or not
    let mut one = flat();
    one["pulp"][0]["length_mm"] = json!(0.1);
    one["pulp"][0]["length_variation"] = json!(0);
    one["specimen"]["sheet"]["grammage_g_per_m2"] = json!(0.06);
    // fibres at heights so far apart that they do not touch
    let mut apart = flat();
    apart["specimen"]["sheet"]["length_mm"] = json!(3);
    apart["specimen"]["sheet"]["grammage_g_per_m2"] = json!(2);
    apart["specimen"]["sheet"]["placement"]["random"]["thickness_um"] = json!(1e6);
    for (name, body) in [("one fibre", one), ("no contact", apart)] {
        let (report, _) = go(&body, 1);
        assert_eq!(value(&report, "bonds"), 0.0, "{name}");
        assert_eq!(report.stop_reason, "no_load_path", "{name}");
        assert_eq!(codes(&report), ["no_load_path"], "{name}");
        assert!(report.warnings[0].detail.contains("below percolation"));
        assert_eq!(value(&report, "tensile_index"), 0.0, "{name}");
        // nothing bonded: nothing by Page either
        assert_eq!(value(&report, "page_tensile_index"), 0.0, "{name}");
    }
}

#[test]
fn one_fibre_from_jaw_to_jaw_has_its_own_strength() {
    let mut body = flat();
    let fibre = json!({"pulp": "softwood", "centre_line_um": [[0, 0, 0], [600, 0, 0]]});
    body["specimen"] =
        json!({"explicit": {"length_mm": 0.6, "width_mm": 0.4, "fibres": [fibre], "bonds": []}});
    let (report, _) = go(&body, 1);
    assert!((value(&report, "tensile_index") / FIBRE_INDEX - 1.0).abs() < 1e-9);
    assert!((value(&report, "stretch") / 0.02 - 1.0).abs() < 1e-9);
}

#[test]
fn coarseness_that_contradicts_the_wall_is_told_with_both_numbers() {
    let mut body = flat();
    body["pulp"][0]["coarseness_mg_per_m"] = json!(0.1);
    body["test"] = json!({"max_strain": 1e-6});
    let (report, _) = go(&body, 1);
    let detail = &report.warnings[0].detail;
    assert_eq!(report.warnings[0].code, "contradicting_coarseness");
    // 0.1 mg/m over π 2 (28 − 2) µm²
    let density = format!("{:.0}", 0.1e-6 / (std::f64::consts::PI * 52.0e-12));
    assert!(
        detail.contains("0.1 mg/m") && detail.contains(&density),
        "{detail}"
    );
}

/// The cheapest of the trends: `tests/figures paper_trends` has them all, with their chances.
#[test]
fn strength_goes_with_that_of_bonds_while_fibres_hold_and_stiffness_falls_with_curl() {
    let mut body = flat();
    body["pulp"][0]["strength_mpa"] = Value::Null;
    // shorter than the sheet, or fibres from jaw to jaw would hold for ever
    body["pulp"][0]["length_mm"] = json!(0.3);
    body["specimen"]["sheet"]["placement"]["random"]["thickness_um"] = json!(30);
    body["test"] = json!({"max_strain": 0.5});
    let (once, _) = go(&body, 1);
    for name in ["normal_strength_mpa", "shear_strength_mpa"] {
        body["bond"][name] = json!(8);
    }
    let (twice, _) = go(&body, 1);
    for name in ["tensile_index", "stretch"] {
        let ratio = value(&twice, name) / value(&once, name);
        assert!((ratio - 2.0).abs() < 1e-9, "{name}: {ratio}");
    }
    assert_eq!(value(&twice, "broken_bonds"), value(&once, "broken_bonds"));
    body["pulp"][0]["shape_factor"] = json!(0.8);
    let (curled, _) = go(&body, 1);
    let [straight, curled] =
        [&once, &curled].map(|report| value(report, "tensile_stiffness_index"));
    assert!(curled < 0.9 * straight, "{curled} {straight}");
}
