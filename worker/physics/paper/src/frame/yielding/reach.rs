//! How far a pull is from what happens next, when loads grow by a constant rate.
use super::super::element::PARTS;
use super::super::input::{BeamSection, Level};
use super::super::network::Network;
use super::law::{Law, Plastic};

/// Way until a segment yields, with the force and its rate; infinite when it never does. One that is
/// on its limit and goes back yields on the other side.
pub(super) fn until_yield(law: &Law, plastic: Plastic, force: f64, rate: f64) -> f64 {
    let limit = law.limit(plastic.hardened_um);
    let way = if rate > 0.0 {
        (limit - force) / rate
    } else if rate < 0.0 {
        (limit + force) / -rate
    } else {
        f64::INFINITY
    };
    way.max(0.0)
}

/// Way until an element is at a failure index, with its loads, which are below it, and their rates.
pub(super) fn until_break(
    network: &Network,
    element: usize,
    loads: &[f64; PARTS],
    rates: &[f64; PARTS],
    failure_index: f64,
) -> f64 {
    let segments = network.segments();
    if element >= segments {
        let strengths = network.strengths(element - segments);
        until_bond_breaks(loads, rates, strengths.map(|one| failure_index * one))
    } else {
        let section = network.section_of(element);
        let Some(strength) = section.strength_gpa else {
            return f64::INFINITY;
        };
        let level = network.model().level;
        until_fibre_breaks(section, level, failure_index * strength, loads, rates)
    }
}

/// (fₙ/Fₙ)² + (fₛ/Fₛ)² = 1 is convex along the way, with and without the part of an opening force: the
/// larger root is where it is passed, and the sign of fₙ there says which of both holds.
fn until_bond_breaks(loads: &[f64; PARTS], rates: &[f64; PARTS], [normal, shear]: [f64; 2]) -> f64 {
    let over = |value: f64, strength: f64| {
        if value == 0.0 { 0.0 } else { value / strength }
    };
    let square = |parts: &[usize], strength: f64| {
        let mut sum = [0.0; 3];
        for &part in parts {
            let [at, rate] = [loads[part], rates[part]].map(|value| over(value, strength));
            sum[0] += rate * rate;
            sum[1] += 2.0 * at * rate;
            sum[2] += at * at;
        }
        sum
    };
    let sheared = square(&[1, 2], shear);
    let opened = square(&[0], normal);
    let alone = roots([sheared[0], sheared[1], sheared[2] - 1.0])[1];
    if loads[0] + rates[0] * alone <= 0.0 || alone == f64::INFINITY && rates[0] <= 0.0 {
        return alone.max(0.0);
    }
    let both: [f64; 3] = std::array::from_fn(|power| sheared[power] + opened[power]);
    roots([both[0], both[1], both[2] - 1.0])[1].max(0.0)
}

/// N/A + |M| w/(2 I) = strength at either end: |M|² is the square of what is left for it.
fn until_fibre_breaks(
    section: &BeamSection,
    level: Level,
    strength: f64,
    loads: &[f64; PARTS],
    rates: &[f64; PARTS],
) -> f64 {
    let left = strength - loads[0] / section.area_um2;
    let less = rates[0] / section.area_um2;
    if level == Level::Truss {
        return if less > 0.0 {
            (left / less).max(0.0)
        } else {
            f64::INFINITY
        };
    }
    let lever = 0.5 * section.width_um / section.inertia_um4;
    let mut first = f64::INFINITY;
    for sign in [-1.0, 1.0] {
        let mut of = [-less * less, 2.0 * left * less, -left * left];
        for (bent, changing) in [(4, 1), (5, 2)] {
            let at = lever * (loads[bent] + sign * loads[changing]);
            let rate = lever * (rates[bent] + sign * rates[changing]);
            of[0] += rate * rate;
            of[1] += 2.0 * at * rate;
            of[2] += at * at;
        }
        // where something is left still; within the limit there is one such way ahead at most
        for way in roots(of) {
            if way >= 0.0 && left - less * way >= 0.0 {
                first = first.min(way);
            }
        }
    }
    first
}

/// Roots of a x² + b x + c, the smaller first; infinite where there are none. One of a line is twice
/// itself.
fn roots([a, b, c]: [f64; 3]) -> [f64; 2] {
    const NONE: [f64; 2] = [f64::INFINITY; 2];
    if a == 0.0 {
        return if b == 0.0 { NONE } else { [-c / b; 2] };
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant.is_nan() || discriminant < 0.0 {
        return NONE;
    }
    // without differences of nearly equal numbers
    let half = -0.5 * (b + discriminant.sqrt().copysign(b));
    let [one, other] = [half / a, if half == 0.0 { 0.0 } else { c / half }];
    [one.min(other), one.max(other)]
}
