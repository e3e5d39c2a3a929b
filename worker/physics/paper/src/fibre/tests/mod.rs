//! Closed forms against the reference's table and the balance of a point; tubes against what was put
//! in, and against beams.
mod beams;
mod closed_form;
mod tubes;

use super::{Elasticity, Ring, Section, Segment};

/// G/E of the reference's table, from an isotropic wall to a soft one.
const SHEAR_RATIOS: [f64; 4] = [0.385, 0.2, 0.08, 0.03];

/// W 30 µm, WT 3 µm: the fibre of the reference.
fn section() -> Section {
    Section::new(30.0, 3.0).unwrap()
}

fn elasticity(shear_ratio: f64) -> Elasticity {
    Elasticity::new(30.0, 0.3, 30.0 * shear_ratio).unwrap()
}

fn segment(points: usize, ring: Ring, length_um: f64) -> Segment {
    let diameter = section().ring_diameter_um(ring).unwrap();
    Segment::new(points, diameter, length_um).unwrap()
}

fn near(given: f64, expected: f64, relative: f64) {
    assert!(
        (given - expected).abs() <= relative * expected.abs(),
        "{given} is not {expected} within {relative}"
    );
}
