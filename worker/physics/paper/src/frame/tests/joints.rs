//! Bonded fibres whose forces are known in closed form.
use super::*;

const ELONGATION: PullTest = PullTest {
    max_strain: 0.01,
    stop_force_fraction: 0.0,
    break_precision: 0.0,
};

fn axial() -> f64 {
    tube().youngs_modulus_gpa * tube().area_um2
}

/// Two fibres along one line, one from each jaw, that overlap and are bonded at `at` [µm].
fn lap(at: &[f64], length: f64) -> (Vec<FrameFibre>, Vec<FrameBond>) {
    let [first, last] = [at[0] - 10.0, at[at.len() - 1] + 10.0];
    let fibres = vec![
        fibre(&[[0.0; 3], [last, 0.0, 0.0]]),
        fibre(&[[first, 0.0, 0.0], [length, 0.0, 0.0]]),
    ];
    let bonds = at.iter().map(|&x| bond([0, 1], [x, x - first])).collect();
    (fibres, bonds)
}

#[test]
fn a_bond_between_two_fibres_is_a_spring_in_series() {
    let (fibres, bonds) = lap(&[60.0], 100.0);
    let spring = bonds[0].stiffness_mn_per_um3 * bonds[0].area_um2;
    let compliance = 60.0 / axial() + 1.0 / spring + 40.0 / axial();
    for level in [Level::Beam, Level::Truss] {
        let network = Network::new(&fibres, &bonds, model(level, 100.0)).unwrap();
        let mut pull = Pull::new(&network, ELONGATION).unwrap();
        let (events, end) = pull.run().unwrap();
        assert!(events.is_empty() && end == PullEnd::MaxStrain);
        let [left, right] = pull.jaw_force_mn();
        close(right, 1.0 / compliance, ROUND_OFF);
        close(left, right, ROUND_OFF);
        close(
            pull.state().measures.initial_stiffness_mn,
            100.0 / compliance,
            ROUND_OFF,
        );
        close(pull.bond_force_mn(0)[1], right, ROUND_OFF);
        close(
            pull.segment_stress_gpa(0),
            right / tube().area_um2,
            ROUND_OFF,
        );
    }
}

#[test]
fn equal_bonds_share_shear_as_a_discrete_shear_lag() {
    // slips obey δᵢ₊₁ - 2 δᵢ + δᵢ₋₁ = (2 K h/(E A)) δᵢ: δᵢ ~ cosh(μ (i - middle)), the form of
    // [Volkersen1938] for bonds one by one
    let (count, spacing) = (9, 25.0);
    let at: Vec<f64> = (0..count).map(|i| 50.0 + spacing * f64::from(i)).collect();
    let (fibres, bonds) = lap(&at, 300.0);
    let spring = bonds[0].stiffness_mn_per_um3 * bonds[0].area_um2;
    let mu = (1.0 + spring * spacing / axial()).acosh();
    let share = |i: i32| (mu * (f64::from(i) - 0.5 * f64::from(count - 1))).cosh();
    let sum: f64 = (0..count).map(share).sum();
    for level in [Level::Beam, Level::Truss] {
        let network = Network::new(&fibres, &bonds, model(level, 300.0)).unwrap();
        let mut pull = Pull::new(&network, ELONGATION).unwrap();
        pull.run().unwrap();
        let force = pull.jaw_force_mn()[1];
        for i in 0..count {
            close(
                pull.bond_force_mn(i as usize)[1],
                force * share(i) / sum,
                ROUND_OFF,
            );
        }
    }
}

#[test]
fn a_crossing_peels_by_bending_twisting_and_the_bond() {
    // the first along x from the jaw, the second across its end, pulled out of the plane at its tip
    let (a, arm) = (50.0, 40.0);
    let section = tube();
    let flexural = section.youngs_modulus_gpa * section.inertia_um4;
    let torsional = section.shear_modulus_gpa * section.polar_um4;
    let shear = section.shear_coefficient * section.shear_modulus_gpa * section.area_um2;
    let joint = bond([0, 1], [a, arm]);
    let spring = joint.stiffness_mn_per_um3 * joint.area_um2;
    let turning = spring * joint.area_um2 / 12.0;
    let bent = |length: f64| length.powi(3) / (3.0 * flexural) + length / shear;
    let compliance =
        bent(a) + 1.0 / spring + arm * arm * (a / torsional + 1.0 / turning) + bent(arm);
    for height in [0.0, 30.0] {
        let fibres = [
            fibre(&[[0.0; 3], [a, 0.0, 0.0]]),
            fibre(&[[a, -arm, height], [a, arm, height]]),
        ];
        let network = Network::new(&fibres, &[joint], model(Level::Beam, 1000.0)).unwrap();
        let tip = network.nearest_node(1, 2.0 * arm);
        let load = NodeLoad {
            node: tip,
            force_mn: [0.0, 0.0, 0.5],
            moment_mn_um: [0.0; 3],
        };
        let rest = network.rest(0.0, &[load]).unwrap();
        close(rest.displacement_um[tip][2], 0.5 * compliance, ROUND_OFF);
    }
}

#[test]
fn fibres_across_carry_nothing_in_a_patch() {
    let mut fibres = Vec::new();
    let mut bonds = Vec::new();
    for row in 0..4 {
        let y = 20.0 * f64::from(row);
        fibres.push(fibre(&[[0.0, y, 0.0], [200.0, y, 0.0]]));
    }
    for column in 0..5 {
        let x = 30.0 + 35.0 * f64::from(column);
        fibres.push(fibre(&[[x, -10.0, 30.0], [x, 75.0, 30.0]]));
        for row in 0..4 {
            let at = [x, 10.0 + 20.0 * f64::from(row)];
            bonds.push(bond([row as u32, 4 + column as u32], at));
        }
    }
    // at the beam level a column's bond turns with it: its own moments stay in it
    for level in [Level::Beam, Level::Truss] {
        let network = Network::new(&fibres, &bonds, model(level, 200.0)).unwrap();
        let mut pull = Pull::new(&network, ELONGATION).unwrap();
        pull.run().unwrap();
        close(
            pull.jaw_force_mn()[1],
            4.0 * axial() * ELONGATION.max_strain,
            ROUND_OFF,
        );
    }
}

#[test]
fn bars_at_an_angle_pull_as_their_cosines() {
    // two bars from either jaw to one point, bonded in a ring there. With N the force of a bar, its
    // elongation is c (1 - w)/2 - s v for a unit pull; bonds open by w along x, N c = K w, and by 2 v
    // across, N s = 2 K v: 2 N c = c²/(l/(E A) + 1/(2 K))
    let apexes = [
        [0.0, 40.0, 0.0],
        [0.0, -40.0, 0.0],
        [100.0, 40.0, 0.0],
        [100.0, -40.0, 0.0],
    ];
    let middle = [50.0, 0.0, 0.0];
    let fibres: Vec<FrameFibre> = apexes.iter().map(|&apex| fibre(&[apex, middle])).collect();
    let length = f64::hypot(50.0, 40.0);
    let bonds = [[0, 1], [2, 3], [0, 2], [1, 3]].map(|fibres| bond(fibres, [length; 2]));
    let network = Network::new(&fibres, &bonds, model(Level::Truss, 100.0)).unwrap();
    let mut pull = Pull::new(&network, ELONGATION).unwrap();
    pull.run().unwrap();
    let spring = bonds[0].stiffness_mn_per_um3 * bonds[0].area_um2;
    let cosine = 50.0 / length;
    let stiffness = cosine * cosine / (length / axial() + 0.5 / spring);
    // a strain of 1e-9 keeps the bars taut: 1e-9 E A/l is 2.6e-8 of the stiffness
    close(pull.jaw_force_mn()[1], stiffness, 3e-8);
    assert!(pull.state().measures.largest_taut_share < 3e-8);
}

#[test]
fn a_kinked_bar_is_a_mechanism_and_says_so() {
    let kinked = fibre(&[[0.0; 3], [50.0, 30.0, 0.0], [100.0, 0.0, 0.0]]);
    let network = Network::new(&[kinked], &[], model(Level::Truss, 100.0)).unwrap();
    let mut pull = Pull::new(&network, ELONGATION).unwrap();
    pull.run().unwrap();
    assert!(pull.state().measures.largest_taut_share > 0.99);
    assert!(pull.jaw_force_mn()[1] < 1e-6 * axial() * ELONGATION.max_strain);
}
