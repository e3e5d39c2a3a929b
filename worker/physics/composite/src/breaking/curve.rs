//! What a testing machine records of a path of events.
use super::event::Event;

/// How a machine drives a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// As the cracks go: the path itself, with its snap-backs.
    Events,
    /// The displacement only grows: the force jumps down.
    Displacement,
    /// The force only grows: the displacement jumps up.
    Force,
}

/// Displacement [mm] and force [N] that a machine records, from the unloaded section on.
///
/// Between events the section is elastic, so that to and from each event a straight line through the
/// origin leads. Under a displacement that only grows, the force falls at once to the line on which an
/// event with a larger displacement lies, along it to that event, and so on. At the end it falls to the
/// line after the last event. A growing force jumps in the same way to the line on which a larger
/// force is reached; where there is none, the section fails, and the curve ends.
#[must_use]
pub fn machine_curve(events: &[Event], control: Control) -> Vec<(f64, f64)> {
    let mut curve = vec![(0.0, 0.0)];
    let mut at = (0.0_f64, 0.0_f64);
    for event in events {
        let point = (event.displacement_mm, event.force_n);
        match control {
            Control::Events => {}
            Control::Displacement if point.0 > at.0 => {
                if at.0 > 0.0 {
                    curve.push((at.0, at.0 * point.1 / point.0));
                }
            }
            Control::Force if point.1 > at.1 => {
                if at.1 > 0.0 {
                    curve.push((at.1 * point.0 / point.1, at.1));
                }
            }
            Control::Displacement | Control::Force => continue,
        }
        curve.push(point);
        at = point;
    }
    if let (Control::Displacement, Some(last)) = (control, events.last())
        && last.displacement_mm > 0.0
    {
        // E = ½ d (F - F'), the energy that the last event released
        let d = last.displacement_mm;
        let left = last.force_n - 2.0 * last.energy_released_n_mm / d;
        curve.push((at.0, left.max(0.0) / d * at.0));
    }
    curve
}
