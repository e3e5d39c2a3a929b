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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::breaking::{BrokenPart, Mode};

    fn event(displacement_mm: f64, force_n: f64, energy_released_n_mm: f64) -> Event {
        Event {
            number: 1,
            factor: 1.0,
            displacement_mm,
            force_n,
            cell: 0,
            part: BrokenPart::Matrix,
            mode: Mode::Tension,
            shear_share: 0.0,
            normal: [1.0, 0.0],
            tooth: 1,
            elastic_n_mm: 0.5 * displacement_mm * force_n,
            energy_released_n_mm,
            dissipated_n_mm: 0.0,
            closing_n_mm: 0.0,
            crack_area_mm2: 0.0,
        }
    }

    #[test]
    fn machines_jump_to_the_line_of_the_next_event_that_they_reach() {
        // up to 10 N, back to 0.5 mm, up again with 3 N/mm to 2 mm, and with 2.2 N/mm to 5 mm; what is
        // left then are 11 - 2 · 20/5 = 3 N
        let path = [
            event(1.0, 10.0, 1.0),
            event(0.5, 4.0, 0.2),
            event(2.0, 6.0, 0.5),
            event(5.0, 11.0, 20.0),
        ];
        assert_eq!(
            machine_curve(&path, Control::Events),
            [(0.0, 0.0), (1.0, 10.0), (0.5, 4.0), (2.0, 6.0), (5.0, 11.0)]
        );
        let close = |found: Vec<(f64, f64)>, expected: &[(f64, f64)]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (a, b) in found.iter().zip(expected) {
                assert!(
                    (a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12,
                    "{a:?} {b:?}"
                );
            }
        };
        close(
            machine_curve(&path, Control::Displacement),
            &[
                (0.0, 0.0),
                (1.0, 10.0),
                (1.0, 3.0),
                (2.0, 6.0),
                (2.0, 4.4),
                (5.0, 11.0),
                (5.0, 3.0),
            ],
        );
        // 10 N are reached again at 10/2.2 mm
        close(
            machine_curve(&path, Control::Force),
            &[(0.0, 0.0), (1.0, 10.0), (10.0 / 2.2, 10.0), (5.0, 11.0)],
        );
        assert_eq!(machine_curve(&[], Control::Displacement), [(0.0, 0.0)]);
    }
}
