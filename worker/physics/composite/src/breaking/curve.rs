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

/// A machine that records a path of events, one after the other.
///
/// Between events the section is elastic, so that to and from each event a straight line through the
/// origin leads. Under a displacement that only grows, the force falls at once to the line on which an
/// event with a larger displacement lies, along it to that event, and so on. At the end it falls to the
/// line after the last event. A growing force jumps in the same way to the line on which a larger
/// force is reached; where there is none, the section fails, and the curve ends.
#[derive(Debug, Clone)]
pub struct Machine {
    control: Control,
    at: (f64, f64),
}

impl Machine {
    /// Before any load.
    #[must_use]
    pub fn new(control: Control) -> Self {
        Self {
            control,
            at: (0.0, 0.0),
        }
    }

    /// Displacement [mm] and force [N] where it lands after the event before, and at this one; `None`
    /// when it does not see the event.
    pub fn add(&mut self, event: &Event) -> Option<[Option<(f64, f64)>; 2]> {
        let point = (event.displacement_mm, event.force_n);
        let (way, force) = self.at;
        let landing = match self.control {
            Control::Events => None,
            Control::Displacement if point.0 > way => {
                (way > 0.0).then(|| (way, way * point.1 / point.0))
            }
            Control::Force if point.1 > force => {
                (force > 0.0).then(|| (force * point.0 / point.1, force))
            }
            Control::Displacement | Control::Force => return None,
        };
        self.at = point;
        Some([landing, Some(point)])
    }

    /// Where it lands after the last event, where it does.
    #[must_use]
    pub fn end(&self, last: &Event) -> Option<(f64, f64)> {
        let d = last.displacement_mm;
        let falls = self.control == Control::Displacement && d > 0.0;
        falls.then(|| {
            // E = ½ d (F - F'), the energy that the last event released
            let left = last.force_n - 2.0 * last.energy_released_n_mm / d;
            (self.at.0, left.max(0.0) / d * self.at.0)
        })
    }
}

/// Displacement [mm] and force [N] that a machine records, from the unloaded section on.
#[must_use]
pub fn machine_curve(events: &[Event], control: Control) -> Vec<(f64, f64)> {
    let mut machine = Machine::new(control);
    let mut curve = vec![(0.0, 0.0)];
    for event in events {
        curve.extend(machine.add(event).into_iter().flatten().flatten());
    }
    curve.extend(events.last().and_then(|last| machine.end(last)));
    curve
}
