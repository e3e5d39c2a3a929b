//! Plans that are refused, and what is said about them.
use super::*;

fn good() -> SheetPlan {
    deposited([1000.0; 2], 20.0, vec![softwood(fixed(500.0))])
}

#[track_caller]
fn refused(change: impl FnOnce(&mut SheetPlan), words: &str) {
    let mut plan = good();
    change(&mut plan);
    let error = plan.lay(1, &Team::alone()).expect_err(words).to_string();
    assert!(error.starts_with(words), "{error}");
}

#[test]
fn values_out_of_range_are_named_with_their_range() {
    let pulp = |plan: &mut SheetPlan, change: fn(&mut Pulp)| change(&mut plan.pulps[0]);
    refused(
        |plan| pulp(plan, |pulp| pulp.wall_um = 15.0),
        "pulp 0: wall thickness is 15 um; allowed is above 0, up to half the width, 14 um",
    );
    for shape in [0.0, 1.01, f64::NAN] {
        let words = format!("pulp 0: shape factor is {shape} ; allowed is [0.1, 1]");
        refused(|plan| plan.pulps[0].shape_factor = shape, &words);
    }
    refused(
        |plan| pulp(plan, |pulp| pulp.length = fixed(40.0)),
        "pulp 0: length is 40 um; allowed is from twice the width, 56 um, to 100000 um",
    );
    refused(
        |plan| pulp(plan, |pulp| pulp.coarseness_ug_per_um = 0.0),
        "pulp 0: coarseness is 0 ug/um; allowed is above 0",
    );
    refused(
        |plan| plan.size_um[1] = 50.0,
        "width of the sheet is 50 um; allowed is from twice the widest fibre, 56 um, to 1e7 um",
    );
    refused(
        |plan| plan.grammage_ug_per_um2 = f64::INFINITY,
        "grammage is inf",
    );
    refused(
        |plan| plan.placement = Placement::Random3d { thickness_um: 5.0 },
        "thickness of the sheet is 5 um; allowed is from the thickest fibre, 5.83",
    );
    refused(
        |plan| plan.placement = Placement::Deposition { flexibility: -0.1 },
        "flexibility is -0.1 ; allowed is [0, 10]",
    );
    refused(
        |plan| plan.segment_um = Some(20.0),
        "segment of a deposited sheet is 20 um",
    );
    refused(|plan| plan.gap_um = Some(-1.0), "gap of a contact is -1 um");
    refused(
        |plan| plan.orientation = Orientation::VonMises { kappa: -1.0 },
        "orientation: kappa is -1",
    );
    refused(
        |plan| {
            plan.orientation = Orientation::Histogram {
                weights: vec![0.0; 3],
            }
        },
        "orientation: sum of the weights is 0",
    );
}

#[test]
fn empty_lists_are_refused() {
    refused(
        |plan| plan.pulps.clear(),
        "a sheet is made of at least one pulp",
    );
    let nothing = LengthDistribution::Measured(Vec::new());
    refused(
        |plan| plan.pulps[0].length = nothing,
        "pulp 0: measured fibres",
    );
    let weights = Vec::new();
    refused(
        |plan| plan.orientation = Orientation::Histogram { weights },
        "orientation: weights of the histogram",
    );
}

#[test]
fn mass_fractions_must_sum_to_one() {
    refused(
        |plan| plan.pulps[0].mass_fraction = 0.75,
        "the mass fractions of the pulps sum to 0.75",
    );
}

#[test]
fn too_much_and_too_little_are_told_in_numbers() {
    refused(
        |plan| {
            plan.size_um = [1e6; 2];
            plan.grammage_ug_per_um2 = 1e-3;
        },
        "the sheet would have about 81",
    );
    refused(
        |plan| plan.grammage_ug_per_um2 = 2.45e-9,
        "pulp 0 has 10 um of fibre in the whole sheet, which is less than a fibre is wide (28 um)",
    );
}
