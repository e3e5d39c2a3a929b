//! What an accuracy study varies in a test of a fibre.
use super::{PaperTensile, Ring};
use crate::study::Knob;

/// Results that are compared: all that do not describe the division itself.
const COMPARED: [&str; 6] = [
    "axial_modulus",
    "poisson_ratio",
    "shear_modulus",
    "bending_stiffness",
    "buckling_load",
    "max_force",
];

pub(super) fn knobs(spec: &PaperTensile) -> Vec<Knob> {
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    vec![
        Knob {
            name: "points_on_ring",
            description: "points of a ring, an even number from 4 to 16",
            present: spec.model.points_on_ring.to_string(),
            grid: words(&["4", "6", "8", "12"]),
            reference: vec![("points_on_ring", "16".to_owned())],
            keeps_specimen: true,
        },
        Knob {
            name: "ring",
            description: "where in the wall the points lie: gyration or patent",
            present: match spec.model.ring {
                Ring::Gyration => "gyration",
                Ring::Patent => "patent",
            }
            .to_owned(),
            grid: words(&["patent"]),
            reference: vec![("ring", "gyration".to_owned())],
            keeps_specimen: true,
        },
    ]
}

/// Sets a knob; `None` when the value is not one it takes. Ranges are left to the schema.
pub(super) fn turn(spec: &mut PaperTensile, knob: &str, value: &str) -> Option<()> {
    match knob {
        "points_on_ring" => spec.model.points_on_ring = value.parse().ok()?,
        "ring" => {
            spec.model.ring = match value {
                "gyration" => Ring::Gyration,
                "patent" => Ring::Patent,
                _ => return None,
            };
        }
        _ => return None,
    }
    Some(())
}

pub(super) fn compares(result: &str) -> bool {
    COMPARED.contains(&result)
}
