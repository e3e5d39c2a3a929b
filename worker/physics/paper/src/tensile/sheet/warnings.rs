//! What is said beside the results of a sheet.
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_harness::ReportBuilder;

use super::course::Course;
use super::specimen::Specimen;
use crate::frame::{MotionReport, PullEnd};
use crate::tensile::contradictions::warn_of_contradictions;

/// Share of the energy in what only keeps a truss in place, from which on its force means nothing.
const LARGEST_TAUT_SHARE: f64 = 0.01;
/// A turn [rad] that small displacements follow to half a per cent: 1 - cos 0.1.
const LARGEST_TURN: f64 = 0.1;

/// A number of two digits, written out: 40, 0.0012.
fn two_digits(value: f64) -> String {
    let rounded = format!("{value:.1e}");
    rounded
        .parse::<f64>()
        .map_or(rounded, |value| value.to_string())
}

/// What to know before the results are believed, of which there are all but these.
pub(super) fn warn(
    report: &mut ReportBuilder,
    spec: &PaperTensile,
    specimen: &Specimen,
    course: &Course<'_>,
    end: PullEnd,
) {
    let measures = course.pull.state().measures;
    let stiffness_index = report.value("tensile_stiffness_index");
    warn_of_contradictions(report, spec);
    if let Some([least, most]) = specimen.assumed_stiffness {
        let range = if least < most {
            format!("{least:.4} to {most:.4}")
        } else {
            format!("{least:.4}")
        };
        report.warn(
            "assumed_bond_stiffness",
            format!(
                "no bond stiffness is given; {range} N/m/µm2 is taken, that of the two half fibres between \
                 the centre lines, as thick as flattened walls, of a tenth of Young's modulus"
            ),
        );
    }
    if end == PullEnd::NoPath {
        report.warn(
            "no_load_path",
            format!(
                "the sheet is below percolation: {} fibres and {} bonds do not tie the jaws together, and \
                 the force is 0",
                specimen.network.fibres(),
                specimen.network.bonds()
            ),
        );
    }
    if measures.largest_taut_share > LARGEST_TAUT_SHARE {
        report.warn(
            "truss_mechanism",
            format!(
                "up to {:.1} % of the energy is in what only keeps bars in place: the truss is a mechanism, \
                 and its force means nothing. Fibres shorter than the distance of the jaws need bending \
                 stiffness to carry: take beams",
                100.0 * measures.largest_taut_share
            ),
        );
    }
    if let Some(motion) = course.pull.motion_report()
        && motion.kinetic_share > MotionReport::LARGEST_KINETIC_SHARE
        && let Some(dynamics) = spec.test.dynamics
    {
        // that of waves from breaks goes with the speed, that of the pull itself with its square
        let slower = MotionReport::LARGEST_KINETIC_SHARE / motion.kinetic_share;
        report.warn(
            "too_fast",
            format!(
                "on the way to the largest force up to {:.3} of the elastic energy was in motion as well, where 0.01 \
                 counts as rest: results depend on the speed. test.dynamics.strain_rate_per_s of {} or less \
                 should be at rest",
                motion.kinetic_share,
                two_digits(slower * dynamics.strain_rate_per_s)
            ),
        );
    }
    let broken = measures.broken();
    if end == PullEnd::MaxStrain && broken == 0 {
        report.warn(
            "nothing_broke",
            format!(
                "nothing broke up to the largest strain of {}; the force there is not a strength",
                spec.test.max_strain
            ),
        );
    } else if end == PullEnd::MaxStrain && measures.strain_at_peak >= spec.test.max_strain {
        report.warn(
            "maximum_at_end",
            "the force was still at its maximum when the largest strain was reached; strength and \
             stretch are lower bounds"
                .to_owned(),
        );
    }
    if measures.turn_to_peak_rad > LARGEST_TURN {
        report.warn(
            "large_turns",
            format!(
                "up to the largest force nodes turn by up to {:.2} rad; the model is for small \
                 displacements, and curled fibres that straighten are softer in it than they are",
                measures.turn_to_peak_rad
            ),
        );
    }
    let cox = specimen.laid.as_ref().and_then(|laid| laid.theory.cox);
    if let (Some(index), Some(cox)) = (stiffness_index, cox)
        && index > cox.held
    {
        report.warn(
            "above_cox",
            format!(
                "a tensile stiffness index of {index:.4} kN m/g is above {:.4}, what straight fibres of the \
                 same directions would have between jaws that hold the width, and no sheet has more",
                cox.held
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_told_in_two_digits_without_powers_of_ten() {
        assert_eq!(two_digits(40.4), "40");
        assert_eq!(two_digits(1234.0), "1200");
        assert_eq!(two_digits(0.001_24), "0.0012");
    }
}
