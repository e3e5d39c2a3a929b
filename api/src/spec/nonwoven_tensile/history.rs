//! Loading and unloading: where the jaw goes, turn after turn.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MOST_STEPS, NonwovenTensile, Test};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations};

/// More cycles than this are refused.
const MOST_CYCLES: u64 = 100_000;

/// Some cycles alike: to a target, and back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Where the specimen is pulled to.
    pub to: Target,
    /// Where it is unloaded to; left out, the next block goes on from `to`. A force that is not yet
    /// reached at no strain ends there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back_to: Option<Target>,
    /// How often in a row; more than once only with `back_to`.
    #[serde(default = "once")]
    #[schemars(range(min = 1, max = 100_000))]
    pub repetitions: u32,
}

/// Where a leg of the way ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// At this nominal strain, at most `max_strain`.
    Strain(#[schemars(range(min = 0.0, max = 100.0), extend("x-unit" = "1"))] f64),
    /// At this force on the moving jaw; found to 1e-5 of the largest force so far. The strain stays
    /// between 0 and `max_strain`.
    ForceN(#[schemars(range(min = 0.0, max = 1e12), extend("x-unit" = "N"))] f64),
}

/// One way of the jaw in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    pub target: Target,
    /// Whether the jaw comes back.
    pub unloads: bool,
    /// The cycle it belongs to, counted from 1 over all blocks.
    pub cycle: u32,
    /// Number of its block, counted from 0.
    pub block: usize,
}

fn once() -> u32 {
    1
}

impl Test {
    /// The legs of the way in their order: without a history a single one to `max_strain`.
    pub fn legs(&self) -> Vec<Leg> {
        if self.history.is_empty() {
            return vec![Leg {
                target: Target::Strain(self.max_strain),
                unloads: false,
                cycle: 1,
                block: 0,
            }];
        }
        let mut legs = Vec::new();
        let mut cycle = 0;
        for (number, block) in self.history.iter().enumerate() {
            for _ in 0..block.repetitions {
                cycle += 1;
                let leg = |target, unloads| Leg {
                    target,
                    unloads,
                    cycle,
                    block: number,
                };
                legs.push(leg(block.to, false));
                legs.extend(block.back_to.map(|target| leg(target, true)));
            }
        }
        legs
    }

    /// The largest strain that is reached, as far as the spec says: a force may be reached anywhere.
    pub fn farthest_strain(&self) -> f64 {
        let ends = self.history.iter().map(|block| match block.to {
            Target::Strain(strain) => strain,
            Target::ForceN(_) => self.max_strain,
        });
        ends.reduce(f64::max).unwrap_or(self.max_strain)
    }
}

impl Target {
    fn pointer(self) -> &'static str {
        match self {
            Self::Strain(_) => "strain",
            Self::ForceN(_) => "force_n",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Strain(_) => "1",
            Self::ForceN(_) => "N",
        }
    }

    fn value(self) -> f64 {
        match self {
            Self::Strain(value) | Self::ForceN(value) => value,
        }
    }

    /// Whether it is known to lie above another; a strain and a force cannot be compared.
    fn is_known_above(self, other: Self) -> Option<bool> {
        (self.pointer() == other.pointer()).then(|| self.value() > other.value())
    }

    /// A violation at this target of a block, whose field is `side`.
    fn refuse(self, block: usize, side: &str, detail: &str, allowed: String) -> Violation {
        let pointer = format!("/test/history/{block}/{side}/{}", self.pointer());
        Violation::new(pointer, "out_of_range", detail)
            .value(self.value())
            .allowed(allowed)
            .unit(self.unit())
    }
}

pub(super) fn check(spec: &NonwovenTensile, violations: &mut Violations) {
    let test = &spec.test;
    if test.history.is_empty() {
        return;
    }
    if !spec.output.force_distribution_strains.is_empty() {
        let strains = &spec.output.force_distribution_strains;
        violations.push(
            Violation::new(
                "/output/force_distribution_strains",
                "not_allowed",
                "a test with a history meets a strain more than once: snapshots have the distribution \
                 of forces at every turn of the way",
            )
            .value(strains.clone())
            .allowed("[] beside a history"),
        );
    }
    let cycles: u64 = test.history.iter().map(|b| u64::from(b.repetitions)).sum();
    if cycles > MOST_CYCLES {
        violations.push(
            Violation::new(
                "/test/history",
                "too_large",
                "the blocks have too many cycles",
            )
            .value(cycles)
            .allowed(format!("at most {MOST_CYCLES} cycles")),
        );
    }
    let steps = u128::from(test.steps()) * test.legs().len() as u128;
    if cycles <= MOST_CYCLES && steps > u128::from(MOST_STEPS) {
        let detail = "so many legs of at most max_strain/strain_step give too many steps";
        violations.push(
            Violation::new("/test/history", "too_many_steps", detail)
                .value(steps as f64)
                .allowed(format!("at most {MOST_STEPS} steps")),
        );
    }
    let before = violations.count();
    let mut end = Target::Strain(0.0);
    for (number, block) in test.history.iter().enumerate() {
        check_block(number, block, end, test.max_strain, violations);
        if violations.count() - before >= LISTED_OF_A_SORT {
            return;
        }
        end = block.back_to.unwrap_or(block.to);
    }
}

/// `start` is where the block before it ends.
fn check_block(
    number: usize,
    block: &Block,
    start: Target,
    max_strain: f64,
    violations: &mut Violations,
) {
    for (side, target) in [("to", Some(block.to)), ("back_to", block.back_to)] {
        if let Some(target @ Target::Strain(strain)) = target
            && strain > max_strain
        {
            let detail = "the test ends before this strain";
            let allowed = format!("≤ max_strain = {max_strain}");
            violations.push(target.refuse(number, side, detail, allowed));
        }
    }
    if block.to.is_known_above(start) == Some(false) {
        let detail = "a block begins with a pull beyond where the way before it ended";
        let allowed = format!("> {}", start.value());
        violations.push(block.to.refuse(number, "to", detail, allowed));
    }
    match block.back_to {
        Some(back) if block.to.is_known_above(back) == Some(false) => {
            let detail = "unloading ends below where it begins";
            let allowed = format!("< {}", block.to.value());
            violations.push(back.refuse(number, "back_to", detail, allowed));
        }
        None if block.repetitions > 1 => violations.push(
            Violation::new(
                format!("/test/history/{number}/back_to"),
                "missing_field",
                "what is repeated must come back",
            )
            .allowed("a strain or a force below that of `to`, or repetitions = 1"),
        ),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "copied numbers are exact")]
    use super::*;

    fn block(to: Target, back_to: Option<Target>, repetitions: u32) -> Block {
        Block {
            to,
            back_to,
            repetitions,
        }
    }

    #[test]
    fn legs_follow_the_blocks_and_cycles_are_counted_through() {
        let (up, down) = (Target::Strain(0.2), Target::ForceN(0.0));
        let test = Test {
            history: vec![
                block(up, Some(down), 2),
                block(Target::ForceN(9.0), None, 1),
            ],
            ..Test::default()
        };
        let legs = test.legs();
        let found: Vec<_> = legs.iter().map(|leg| (leg.cycle, leg.unloads)).collect();
        let expected = [(1, false), (1, true), (2, false), (2, true), (3, false)];
        assert_eq!(found, expected);
        assert_eq!(legs[4].target, Target::ForceN(9.0));
        assert_eq!(test.farthest_strain(), 3.0);
    }

    #[test]
    fn without_a_history_there_is_one_leg_to_the_largest_strain() {
        let legs = Test::default().legs();
        assert_eq!(legs.len(), 1);
        assert_eq!(legs[0].target, Target::Strain(3.0));
        assert!(!legs[0].unloads);
    }
}
