//! A look at all elements: what they do to the nodes, and what breaks first.
use super::balance::{Forces, Motion};
use super::element::{PARTS, stress_gpa};
use super::input::Level;
use super::network::Network;
use super::springs::SpringSum;

/// An element over its limit at unit elongation, by the factor that brings it there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Critical {
    pub(crate) element: usize,
    /// Elongation at which it breaks [µm per unit of the jaw's].
    pub(crate) factor: f64,
}

/// One pass over what is active: forces, energy, and what breaks first.
pub(crate) fn survey(
    network: &Network,
    is_active: &[bool],
    motion: &Motion,
    gyration: f64,
    forces: &mut Forces,
) -> Option<Critical> {
    survey_of(
        network,
        network.elements(),
        is_active,
        motion,
        gyration,
        forces,
    )
}

/// The same with elements other than the network's own, which may be softer.
pub(crate) fn survey_of<E: SpringSum>(
    network: &Network,
    elements: &[E],
    is_active: &[bool],
    motion: &Motion,
    gyration: f64,
    forces: &mut Forces,
) -> Option<Critical> {
    forces.clear();
    let is_truss = network.model().level == Level::Truss;
    let segments = network.segments();
    let mut worst: Option<Critical> = None;
    for (index, element) in elements.iter().enumerate() {
        if !is_active[index] {
            continue;
        }
        let loads = element.push(motion, gyration, forces);
        if is_truss && index < segments {
            forces.taut_energy += 0.5
                * (1..3)
                    .map(|part| loads[part] * loads[part] / element.stiffness()[part])
                    .sum::<f64>();
        }
        let factor = breaks_at(network, index, &loads);
        // the first of equals stays
        if factor < worst.map_or(f64::INFINITY, |worst| worst.factor) {
            worst = Some(Critical {
                element: index,
                factor,
            });
        }
    }
    worst
}

/// Factor of its loads at which an element breaks; infinite when it never does.
pub(crate) fn breaks_at(network: &Network, element: usize, loads: &[f64; PARTS]) -> f64 {
    let segments = network.segments();
    if element >= network.parts() {
        // rings of tubes
        return f64::INFINITY;
    }
    if element >= segments {
        return 1.0 / bond_index(loads, network.strengths(element - segments));
    }
    let section = network.section_of(element);
    match section.strength_gpa {
        Some(strength) => strength / stress_gpa(section, network.model().level, loads).max(0.0),
        None => f64::INFINITY,
    }
}

/// √((fₙ/Fₙ)² + (fₛ/Fₛ)²) of a bond with the loads q: 1 where it breaks. Only opening counts for fₙ.
pub(crate) fn bond_index(loads: &[f64; PARTS], [normal, shear]: [f64; 2]) -> f64 {
    let share = |force: f64, strength: f64| if force > 0.0 { force / strength } else { 0.0 };
    share(loads[0], normal).hypot(share(loads[1].hypot(loads[2]), shear))
}
