//! Where on the way from one load to another the first of many quantities passes 1.
//!
//! A quantity is a failure index: below 1 nothing happens, beyond 1 a bond breaks. What lies between
//! two loads is not known; the straight line between them says where to look next.

/// A quantity at the ends of an interval of load: at most 1 before, above 1 after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub before: f64,
    pub after: f64,
}

/// Part of the allowed excess that is aimed at where one quantity passes 1 alone: close to the crossing,
/// and yet beyond it although the line is not straight.
const CLOSE: f64 = 0.1;
/// The same where others follow within the allowed excess: to part them would be finer than asked for.
const WIDE: f64 = 0.8;
/// Every so many looks the middle of the interval is tried, so that it shrinks however the quantities
/// behave.
const BISECT_EVERY: u32 = 3;

impl Crossing {
    /// The part of the way at which the quantity has this value on the straight line.
    fn at(self, value: f64) -> f64 {
        (value - self.before) / (self.after - self.before)
    }
}

/// The part of the way, within (0, 1), at which to look next for a load whose largest quantity is
/// above 1 by at most `precision`; `look` counts from 0. Without crossings it is the middle.
pub fn next_look(crossings: &[Crossing], precision: f64, look: u32) -> f64 {
    const MIDDLE: f64 = 0.5;
    let first = crossings.iter().enumerate().min_by(|(_, a), (_, b)| {
        let (a, b) = (a.at(1.0), b.at(1.0));
        a.total_cmp(&b)
    });
    let Some((number, first)) = first else {
        return MIDDLE;
    };
    if look % BISECT_EVERY == BISECT_EVERY - 1 {
        return MIDDLE;
    }
    let within = first.at(1.0 + precision);
    let others = crossings.iter().enumerate();
    let is_alone = others
        .filter(|(other, _)| *other != number)
        .all(|(_, crossing)| crossing.at(1.0) > within);
    let excess = if is_alone { CLOSE } else { WIDE };
    let part = first.at(1.0 + excess * precision);
    if part > 0.0 && part < 1.0 {
        part
    } else {
        MIDDLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRECISION: f64 = 0.01;

    #[test]
    fn a_single_crossing_is_looked_for_just_beyond_it() {
        let part = next_look(
            &[Crossing {
                before: 0.5,
                after: 1.5,
            }],
            PRECISION,
            0,
        );
        assert!((part - 0.501).abs() < 1e-12);
    }

    #[test]
    fn crossings_closer_than_asked_for_are_taken_together() {
        let pair = [
            Crossing {
                before: 0.5,
                after: 1.5,
            },
            Crossing {
                before: 0.495,
                after: 1.495,
            },
        ];
        assert!((next_look(&pair, PRECISION, 0) - 0.508).abs() < 1e-12);
    }

    #[test]
    fn the_first_on_the_way_counts_not_the_largest_at_its_end() {
        let pair = [
            Crossing {
                before: 0.0,
                after: 3.0,
            },
            Crossing {
                before: 0.99,
                after: 1.09,
            },
        ];
        // 0.99 + 0.1 part = 1.001
        assert!((next_look(&pair, PRECISION, 0) - 0.11).abs() < 1e-12);
    }

    #[test]
    fn the_middle_is_tried_where_the_line_says_nothing() {
        for crossings in [
            vec![],
            vec![Crossing {
                before: 0.0,
                after: f64::INFINITY,
            }],
            vec![Crossing {
                before: 1.0,
                after: 1.0,
            }],
        ] {
            assert!((next_look(&crossings, PRECISION, 0) - 0.5).abs() < 1e-12);
        }
        let crossing = Crossing {
            before: 0.5,
            after: 1.5,
        };
        assert!((next_look(&[crossing], PRECISION, 2) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn any_growing_quantity_is_found_in_few_looks() {
        // the seventh power of the load passes 1 at 1
        for end in [1.1, 2.0, 10.0] {
            let (mut from, mut to, mut look) = (0.0, end, 0);
            let quantity = |load: f64| load.powi(7);
            while quantity(to) > 1.0 + PRECISION {
                let crossing = Crossing {
                    before: quantity(from),
                    after: quantity(to),
                };
                let load = from + next_look(&[crossing], PRECISION, look) * (to - from);
                if quantity(load) > 1.0 {
                    to = load;
                } else {
                    from = load;
                }
                look += 1;
                assert!(look < 40, "{end}: {from} to {to}");
            }
        }
    }
}
