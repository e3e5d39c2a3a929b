//! What an accuracy study varies: in a test of a fibre how its tube is made, in one of a sheet what its
//! fibres are and how straight.
use super::{Accuracy, BondsAt, Knobs, Level, PaperTensile, Ring, Specimen};
use crate::study::Knob;

/// Results that are compared: all that do not describe the division itself.
const COMPARED: [&str; 13] = [
    "axial_modulus",
    "poisson_ratio",
    "shear_modulus",
    "bending_stiffness",
    "buckling_load",
    "max_force",
    "tensile_strength",
    "tensile_index",
    "stretch",
    "energy_absorption",
    "tensile_stiffness",
    "tensile_stiffness_index",
    "youngs_modulus",
];

pub(super) fn knobs(spec: &PaperTensile) -> Vec<Knob> {
    let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    let level = Knob {
        name: "level",
        description: "what fibres are made of: beam or truss",
        present: spec.level().name().to_owned(),
        grid: words(&["truss"]),
        reference: vec![("level", "beam".to_owned())],
        keeps_specimen: true,
    };
    match &spec.specimen {
        Specimen::SingleFibre(_) => {}
        Specimen::Explicit(_) => return vec![level],
        Specimen::Sheet(_) => {
            let segment = Knob {
                name: "segment_widths",
                description: "length of the straight parts of fibres over the width of the narrowest",
                present: (spec.sheet_segment_um() / spec.narrowest_um()).to_string(),
                grid: words(&["8", "4", "2", "1"]),
                reference: vec![("segment_widths", "0.5".to_owned())],
                keeps_specimen: true,
            };
            let knobs = spec.accuracy.knobs();
            let bonds_at = Knob {
                name: "bonds_at",
                description: "where bonds hold fibres: at nodes of their own or inside straight parts",
                present: knobs.bonds_at.name().to_owned(),
                grid: words(&["inside"]),
                reference: vec![("bonds_at", "nodes".to_owned())],
                keeps_specimen: true,
            };
            let break_precision = Knob {
                name: "break_precision",
                description: "share of the largest failure index within which parts break together; 0: one by one",
                present: knobs.break_precision.to_string(),
                grid: words(&["0.2", "0.1", "0.05", "0.02"]),
                reference: vec![("break_precision", "0".to_owned())],
                keeps_specimen: true,
            };
            return vec![segment, level, bonds_at, break_precision];
        }
    }
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
        "segment_widths" => {
            spec.model.segment_um = None;
            let knobs = Knobs {
                segment_widths: value.parse().ok()?,
                ..spec.accuracy.knobs()
            };
            spec.accuracy = Accuracy::Knobs(knobs);
        }
        "bonds_at" => {
            let bonds_at = match value {
                "nodes" => BondsAt::Nodes,
                "inside" => BondsAt::Inside,
                _ => return None,
            };
            let knobs = Knobs {
                bonds_at,
                ..spec.accuracy.knobs()
            };
            spec.accuracy = Accuracy::Knobs(knobs);
        }
        "break_precision" => {
            let knobs = Knobs {
                break_precision: value.parse().ok()?,
                ..spec.accuracy.knobs()
            };
            spec.accuracy = Accuracy::Knobs(knobs);
        }
        "level" => {
            spec.model.level = match value {
                "beam" => Some(Level::Beam),
                "truss" => Some(Level::Truss),
                _ => return None,
            };
        }
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
