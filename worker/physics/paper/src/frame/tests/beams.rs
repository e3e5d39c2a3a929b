//! Beams under loads against strength of materials.
use super::*;

fn force(node: usize, force_mn: [f64; 3]) -> NodeLoad {
    NodeLoad {
        node,
        force_mn,
        moment_mn_um: [0.0; 3],
    }
}

#[test]
fn a_cantilever_bends_and_shears_as_timoshenkos() {
    let section = tube();
    let length = 100.0;
    for segment_um in [None, Some(7.0)] {
        let fibre = fibre(&[[0.0; 3], [length, 0.0, 0.0]]);
        let model = FrameModel {
            segment_um,
            ..model(Level::Beam, 1000.0)
        };
        let network = Network::new(&[fibre], &[], model).unwrap();
        let tip = network.nodes() - 1;
        let rest = network.rest(0.0, &[force(tip, [3.0, 2.0, -1.0])]).unwrap();
        let flexural = section.youngs_modulus_gpa * section.inertia_um4;
        let shear = section.shear_coefficient * section.shear_modulus_gpa * section.area_um2;
        let compliance = length.powi(3) / (3.0 * flexural) + length / shear;
        let [x, y, z] = rest.displacement_um[tip];
        close(
            x,
            3.0 * length / (section.youngs_modulus_gpa * section.area_um2),
            ROUND_OFF,
        );
        close(y, 2.0 * compliance, ROUND_OFF);
        close(z, -compliance, ROUND_OFF);
        close(
            rest.rotation[tip][2],
            2.0 * length.powi(2) / (2.0 * flexural),
            ROUND_OFF,
        );
        close(rest.energy_nj, 0.5 * (3.0 * x + 2.0 * y - z), ROUND_OFF);
    }
}

#[test]
fn an_l_in_space_bends_and_twists() {
    // one arm along x, one along y, a force across both at the end
    let section = tube();
    let (a, b) = (80.0, 50.0);
    let arms = fibre(&[[0.0; 3], [a, 0.0, 0.0], [a, b, 0.0]]);
    let network = Network::new(&[arms], &[], model(Level::Beam, 1000.0)).unwrap();
    let rest = network.rest(0.0, &[force(2, [0.0, 0.0, 2.0])]).unwrap();
    let flexural = section.youngs_modulus_gpa * section.inertia_um4;
    let torsional = section.shear_modulus_gpa * section.polar_um4;
    let shear = section.shear_coefficient * section.shear_modulus_gpa * section.area_um2;
    let bending = (f64::powi(a, 3) + f64::powi(b, 3)) / (3.0 * flexural) + (a + b) / shear;
    let twisting = a * b * b / torsional;
    close(
        rest.displacement_um[2][2],
        2.0 * (bending + twisting),
        ROUND_OFF,
    );
}

#[test]
fn loads_on_what_no_jaw_holds_are_refused() {
    let away = fibre(&[[10.0, 0.0, 0.0], [50.0, 0.0, 0.0]]);
    let network = Network::new(&[away], &[], model(Level::Beam, 1000.0)).unwrap();
    let error = network.rest(0.0, &[force(1, [1.0, 0.0, 0.0])]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "node of a load is 1, allowed is a node of a cluster that a jaw holds"
    );
}
