//! How far a test is: the part of it that is done, and the words for it.
use loadframe_api::spec::nonwoven_tensile::{Breaking, NonwovenTensile};

use super::{path::Path, specimen::Specimen, state::State};

/// What is kept of the bar for rupture itself: about half of the wall time of a polyester test goes
/// by at the strains where it tears. The bar tells of time, so that the time left can be told.
const RESERVE: f64 = 0.45;
/// Part of the bonds whose breaking leaves 1/e of what was left. Polyester lattices of 28 000 and
/// 183 000 bonds tear when 2 % are broken, and have 7 to 8 % broken at the end; nearly half of
/// the wall time goes by between.
const DAMAGE: f64 = 0.05;
/// Not more while it runs: a full bar means done.
const NEARLY_DONE: f64 = 0.999;
/// Decimals at most in a strain in percent.
const MOST_DECIMALS: usize = 8;

/// What the progress of a test is measured by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Yardstick {
    /// Strain at which the test ends in any case [-].
    max_strain: f64,
    /// Strain at which rupture is expected [-]; infinite when nothing can break.
    rupture_strain: f64,
    bonds: usize,
    decimals: usize,
}

impl Yardstick {
    pub(super) fn new(spec: &NonwovenTensile, specimen: &Specimen) -> Self {
        Self {
            max_strain: spec.test.max_strain,
            rupture_strain: match spec.test.breaking {
                Breaking::None => f64::INFINITY,
                _ => specimen.expected_rupture_strain(),
            },
            bonds: specimen.network.bonds.len(),
            decimals: percent_decimals(spec.test.strain_step),
        }
    }

    /// Part of the test that is done, and what is being done.
    pub(super) fn measure(&self, path: &Path, state: &State) -> (f64, String) {
        let place = state.place;
        let done = path.strain(place, state.step.saturating_sub(1).max(place.after_step));
        let broken = state.events.len();
        let strain = self.percent(path.strain(place, state.step));
        if !path.turns() {
            let phase = format!("straining, {strain} strain, {broken} bonds broken");
            return (self.fraction(done, broken), phase);
        }
        let leg = path.leg(place);
        let doing = if leg.unloads {
            "unloading"
        } else {
            "straining"
        };
        let cycle = leg.cycle;
        let phase = format!("{doing}, cycle {cycle}, {strain} strain, {broken} bonds broken");
        (path.part_done(place, done).min(NEARLY_DONE), phase)
    }

    /// A strain in percent, to as many decimals as the strain step has, at least one.
    pub(super) fn percent(&self, strain: f64) -> String {
        format!("{:.*} %", self.decimals, 100.0 * strain)
    }

    /// Part of the test that is done when `strain` is, with `broken` bonds.
    ///
    /// The test ends at its largest strain, or before it at rupture, so the further of both ways
    /// counts. Up to the expected rupture at ε_r the bar fills to 1 − R in proportion to strain;
    /// beyond it the rest shrinks as R exp(−(1 − R)(ε/ε_r − 1)/R), with the same slope at ε_r, so
    /// that a late rupture is always expected R/(1 − R) of ε_r ahead. Rupture itself takes long at
    /// one strain: broken bonds, d of all, shrink the rest by exp(−d/D).
    ///
    /// Grows with strain and with broken bonds, and stays below 1.
    fn fraction(&self, strain: f64, broken: usize) -> f64 {
        let way = strain / self.rupture_strain;
        let left_to_rupture = if way < 1.0 {
            1.0 - (1.0 - RESERVE) * way
        } else {
            RESERVE * (-(1.0 - RESERVE) * (way - 1.0) / RESERVE).exp()
        };
        let left = left_to_rupture.min(1.0 - strain / self.max_strain);
        let damage = broken as f64 / self.bonds.max(1) as f64;
        (1.0 - left * (-damage / DAMAGE).exp()).min(NEARLY_DONE)
    }
}

/// Decimals that multiples of `step` have in percent, at least one.
fn percent_decimals(step: f64) -> usize {
    let is_whole = |decimals: &usize| {
        let scaled = step * 10_f64.powi(2 + *decimals as i32);
        // rounding of a decimal step and of the product, with a wide margin
        scaled.round() >= 1.0 && (scaled - scaled.round()).abs() < 1e-9 * scaled
    };
    (1..MOST_DECIMALS).find(is_whole).unwrap_or(MOST_DECIMALS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example: the expected rupture is that of a bond one deviation weaker than most.
    const PET: Yardstick = Yardstick {
        max_strain: 3.0,
        rupture_strain: 1.137,
        bonds: 27_755,
        decimals: 1,
    };
    /// A handful of roundings of numbers of order one.
    const ROUND_OFF: f64 = 1e-14;

    #[test]
    fn the_bar_is_past_its_middle_where_polyester_tears_and_nearly_full_after() {
        // so many bonds are broken at these strains; it tears at 1.13, with 2125 broken at the end
        assert!((PET.fraction(0.5, 0) - 0.55 * 0.5 / 1.137).abs() < ROUND_OFF);
        assert!((0.5..0.7).contains(&PET.fraction(1.10, 449)));
        assert!((0.6..0.75).contains(&PET.fraction(1.13, 605)));
        assert!(PET.fraction(1.13, 2125) > 0.89);
    }

    #[test]
    fn it_grows_and_stays_below_one_however_late_rupture_is() {
        let mut before = 0.0;
        for step in 1..300 {
            for broken in [10 * step - 5, 10 * step] {
                let now = PET.fraction(step as f64 * 0.01, broken);
                assert!(before <= now && now < 1.0, "{now} at {step} after {before}");
                before = now;
            }
        }
        assert!(PET.fraction(3.0, 27_755) < 1.0);
        // at the expected strain both parts meet in value and slope
        let [below, at, above] = [0.999, 1.0, 1.001].map(|way| PET.fraction(way * 1.137, 0));
        assert!(((above - at) / (at - below) - 1.0).abs() < 0.01);
    }

    #[test]
    fn without_rupture_it_is_the_part_of_the_largest_strain() {
        let unbreakable = Yardstick {
            rupture_strain: f64::INFINITY,
            ..PET
        };
        assert!((unbreakable.fraction(1.5, 0) - 0.5).abs() < ROUND_OFF);
        let short = Yardstick {
            max_strain: 0.1,
            ..PET
        };
        assert!((short.fraction(0.05, 0) - 0.5).abs() < ROUND_OFF);
    }

    #[test]
    fn strains_have_the_decimals_of_the_step() {
        for (step, strain, text) in [
            (0.01, 1.13, "113.0 %"),
            (0.02, 0.3, "30.0 %"),
            (0.0025, 0.0725, "7.25 %"),
            (0.00005, 0.000_35, "0.035 %"),
            (1.0 / 3e4, 1.0 / 3.0, "33.33333333 %"),
        ] {
            let decimals = percent_decimals(step);
            assert_eq!(Yardstick { decimals, ..PET }.percent(strain), text);
        }
    }
}
