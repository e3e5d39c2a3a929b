//! Sheets of fibres that lie on one another.
use super::*;

fn softwood_sheet(side_um: f64, grammage: f64, flexibility: f64) -> SheetPlan {
    SheetPlan {
        placement: Placement::Deposition { flexibility },
        ..deposited([side_um; 2], grammage, vec![softwood(fixed(1000.0))])
    }
}

fn measured(plan: &SheetPlan, seed: u64) -> Statistics {
    Statistics::of(&lay(plan, seed), 10).expect("there are fibres")
}

/// Heights of both centre lines where two segments cross when seen from above.
fn crossing(one: &[[f64; 3]], other: &[[f64; 3]]) -> Option<[f64; 2]> {
    let [a, b, c, d] = [one[0], one[1], other[0], other[1]];
    let [u, v, w] = [[b, a], [d, c], [c, a]].map(|[to, from]| [to[0] - from[0], to[1] - from[1]]);
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let under = cross(u, v);
    let (s, t) = (cross(w, v) / under, cross(w, u) / under);
    let is_crossing = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    is_crossing.then(|| [a[2] + s * (b[2] - a[2]), c[2] + t * (d[2] - c[2])])
}

/// Upper surface of the lower fibre under the lower surface of the upper one, at every crossing of two
/// centre lines [µm].
fn gaps(plan: &SheetPlan, seed: u64) -> Vec<f64> {
    let mut gaps = Vec::new();
    // the later one lies on the earlier
    let fibres = plan
        .lay_fibres(seed, &Uninterrupted)
        .expect("the plan is good");
    for (index, lower) in fibres.iter().enumerate() {
        for upper in &fibres[index + 1..] {
            let thickness = 0.5 * (lower.section.thickness_um + upper.section.thickness_um);
            for one in lower.centre_line_um.windows(2) {
                for other in upper.centre_line_um.windows(2) {
                    let heights = crossing(one, other);
                    gaps.extend(heights.map(|[below, above]| above - below - thickness));
                }
            }
        }
    }
    gaps
}

#[test]
fn no_fibre_goes_through_another() {
    for flexibility in [0.0, 0.1, 0.3, 1.0] {
        let gaps = gaps(&softwood_sheet(350.0, 60.0, flexibility), 2);
        assert!(gaps.len() > 200, "{}", gaps.len());
        // within a pixel of 7 µm a fibre climbs by its slope, and the pixel knows one height
        let deepest = gaps.iter().copied().fold(0.0, f64::min);
        assert!(
            deepest >= -flexibility * 7.0 - 1e-9,
            "{flexibility}: {deepest}"
        );
    }
}

#[test]
fn contacts_are_the_crossings_with_a_small_gap() {
    let plan = softwood_sheet(500.0, 60.0, 0.3);
    let sheet = lay(&plan, 2);
    let gaps = gaps(&plan, 2);
    let within = |gap: f64| gaps.iter().filter(|its| **its <= gap).count() as f64;
    let contacts = sheet.contacts.len() as f64;
    // where one of them slopes, fibres are nearer beside the crossing, by up to F times a width
    let [fewest, most] = [within(plan.gap()), within(plan.gap() + 0.3 * 28.0)];
    assert!(
        contacts > 0.95 * fewest && contacts < most,
        "{fewest} {contacts} {most}"
    );
    assert!(
        most < 0.7 * gaps.len() as f64,
        "many crossings are far apart"
    );
}

#[test]
fn no_slope_is_steeper_than_the_flexibility() {
    let sheet = lay(&softwood_sheet(800.0, 40.0, 0.2), 1);
    let mut steepest = 0.0_f64;
    for fibre in &sheet.fibres {
        for ends in fibre.centre_line_um.windows(2) {
            let run = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
            steepest = steepest.max((ends[1][2] - ends[0][2]).abs() / run);
        }
    }
    // short ends are joined across bends, where the way is shorter
    assert!(steepest <= 0.2 + 1e-4, "{steepest}");
    assert!(
        steepest > 0.2 - 1e-9,
        "somewhere the bound is used: {steepest}"
    );
}

#[test]
fn thickness_rises_linearly_with_grammage_beyond_a_few_layers() {
    let thickness = |grammage: f64| {
        let each = (0..2)
            .map(|seed| measured(&softwood_sheet(700.0, grammage, 0.3), seed).mean_thickness_um);
        each.sum::<f64>() / 2.0
    };
    // 4.6, 9.1, 13.7 and 18.3 layers
    let heights = [40.0, 80.0, 120.0, 160.0].map(thickness);
    let steps: Vec<f64> = heights.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // the first step still has the smooth side on the wire in it
    assert!((steps[2] / steps[1] - 1.0).abs() < 0.1, "{steps:?}");
    assert!((steps[1] / steps[0] - 1.0).abs() < 0.2, "{steps:?}");
    // fibres never fill the sheet: a layer of 4.57 takes more than its own 5.8 µm
    assert!(steps.iter().all(|step| *step > 4.5 * 5.834), "{steps:?}");
}

#[test]
fn more_flexible_fibres_make_denser_sheets_with_more_contacts() {
    let rows: Vec<Statistics> = [0.05, 0.2, 0.5, 2.0]
        .map(|flexibility| measured(&softwood_sheet(1000.0, 60.0, flexibility), 1))
        .into();
    for pair in rows.windows(2) {
        assert!(pair[1].apparent_density_kg_per_m3 > 1.1 * pair[0].apparent_density_kg_per_m3);
        assert!(pair[1].contacts_per_fibre > 1.2 * pair[0].contacts_per_fibre);
        assert!(pair[1].relative_bonded_area > 1.2 * pair[0].relative_bonded_area);
    }
    // never denser than the wall: 2.45e-4/(π · 2 · 26) µg/µm³
    let wall = 2.45e-4 / wall_area_um2(28.0, 2.0) * 1e9;
    assert!(rows[3].apparent_density_kg_per_m3 < wall);
}

#[test]
fn the_default_flexibility_gives_the_density_of_paper() {
    // 670 to 740 kg/m³ were measured of copy paper and liner
    let densities: Vec<f64> = (0..4)
        .map(|seed| {
            let plan = softwood_sheet(1000.0, 60.0, Placement::FLEXIBILITY);
            measured(&plan, seed).apparent_density_kg_per_m3
        })
        .collect();
    let mean = densities.iter().sum::<f64>() / 4.0;
    assert!((630.0..760.0).contains(&mean), "{densities:?}");
}

/// Where fibres lie at random the number over a point is Poisson's: none with exp(−coverage).
#[test]
fn coverage_leaves_the_holes_of_poisson() {
    for grammage in [2.5, 10.0] {
        let rows: Vec<f64> = (0..8)
            .map(|seed| {
                let row = measured(&softwood_sheet(1000.0, grammage, 0.3), seed);
                let coverage = grammage * 1e-6 / 2.45e-4 * 28.0;
                assert!(
                    (row.coverage / coverage - 1.0).abs() < 0.04,
                    "{}",
                    row.coverage
                );
                (1.0 - row.covered_share).ln() / row.coverage
            })
            .collect();
        let sample = Sample::of(&rows).expect("there are rows");
        // pixels of a quarter of the width make fibres up to an eighth wider
        assert!(
            (-1.125..-0.98).contains(&sample.mean),
            "{grammage}: {}",
            sample.mean
        );
    }
}
