//! The distribution of bond forces at the strains a spec asks for.
use loadframe_api::spec::nonwoven_tensile::NonwovenTensile;

use super::{experiment::Experiment, path::nominal_strain, snapshot, state::State};

/// The step nearest to each of the spec's strains, in their order. Of two steps equally near it is
/// the earlier one.
pub(super) fn steps(spec: &NonwovenTensile) -> Vec<u64> {
    let last = spec.test.steps();
    let nearest = |strain: &f64| {
        let distance = |step: u64| (nominal_strain(spec, step) - strain).abs();
        // the division may round to either side of a whole number: distance decides
        let below = ((strain / spec.test.strain_step) as u64).min(last);
        let around = below.saturating_sub(1)..=(below + 1).min(last);
        around.fold(below, |best, step| {
            let is_nearer = distance(step) < distance(best);
            let is_earlier = distance(step) <= distance(best) && step < best;
            if is_nearer || is_earlier { step } else { best }
        })
    };
    let strains = spec.output.force_distribution_strains.iter();
    strains.map(nearest).collect()
}

/// Keeps the distribution at the step just recorded: after its bonds broke, in bins from the
/// smallest to the largest force.
pub(super) fn take(experiment: &mut Experiment<'_>) {
    let bins = snapshot::histogram(experiment);
    experiment.state.force_distribution.extend(bins);
}

/// Strains asked for that lie beyond the end of the test.
pub(super) fn unreached(spec: &NonwovenTensile, state: &State) -> Vec<f64> {
    let strains = spec.output.force_distribution_strains.iter();
    let with_steps = strains.zip(steps(spec));
    let beyond = with_steps.filter(|(_, step)| *step > state.step);
    beyond.map(|(strain, _)| *strain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps_of(strain_step: f64, max_strain: f64, strains: &[f64]) -> Vec<u64> {
        let loadframe_api::JobSpec::NonwovenTensile(mut spec) = crate::nonwoven::calibration_spec()
        else {
            panic!("the calibration pulls a nonwoven");
        };
        spec.test.strain_step = strain_step;
        spec.test.max_strain = max_strain;
        spec.output.force_distribution_strains = strains.to_vec();
        steps(&spec)
    }

    #[test]
    fn the_nearest_step_is_found_on_both_sides_and_ties_go_to_the_earlier() {
        let steps = steps_of(0.25, 1.0, &[0.0, 0.1, 0.125, 0.2, 0.25, 0.9, 1.0]);
        assert_eq!(steps, [0, 0, 0, 1, 1, 4, 4]);
    }

    #[test]
    fn rounding_of_the_quotient_decides_nothing() {
        // 0.3/0.1 is below 3 in floating point
        assert_eq!(steps_of(0.1, 1.0, &[0.3, 0.7]), [3, 7]);
    }

    #[test]
    fn a_shorter_last_step_counts_where_it_is() {
        // steps at 0, 0.4, 0.8, 1.0
        assert_eq!(steps_of(0.4, 1.0, &[0.85, 0.92, 1.0]), [2, 3, 3]);
    }
}
