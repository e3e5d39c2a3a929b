//! What an accuracy study varies: in a test of a fibre how its tube is made, in one of a sheet what its
//! fibres are and how straight.
use super::{BondsAt, Direction, Level, PaperTensile, Ring, Specimen};
use crate::spec_trait::Studied;
use crate::study::Knob;

/// Points of tubes up to which a study tries them unasked.
const MOST_POINTS: f64 = 1e5;

/// Results that are compared: all that do not describe the division itself.
const COMPARED: [&str; 15] = [
    "axial_modulus",
    "poisson_ratio",
    "shear_modulus",
    "bending_stiffness",
    "buckling_load",
    "max_force",
    "tensile_strength",
    "tensile_index",
    "zero_span_strength",
    "zero_span_index",
    "stretch",
    "energy_absorption",
    "tensile_stiffness",
    "tensile_stiffness_index",
    "youngs_modulus",
];

impl Studied for PaperTensile {
    fn knobs(&self) -> Vec<Knob> {
        // a beam has the bending stiffness of the wall, which a tube has not: the beam is what others are held against
        let is_small = self.as_tubes_points() <= MOST_POINTS;
        let level = Knob::new(
            "level",
            "what fibres are made of: truss, tube or beam; tubes where they have 100 000 points at most",
            self.level().name(),
            if is_small {
                &["truss", "tube"][..]
            } else {
                &["truss"]
            },
            "beam",
        );
        match &self.specimen {
            Specimen::Explicit(_) => vec![level],
            Specimen::Sheet(_) => {
                let segment = Knob::new(
                    "segment_widths",
                    "length of the straight parts of fibres over the width of the narrowest",
                    self.sheet_segment_um() / self.narrowest_um(),
                    &["8", "4", "2", "1"],
                    "0.5",
                );
                let knobs = self.accuracy.knobs();
                let bonds_at = Knob::new(
                    "bonds_at",
                    "where bonds hold fibres: at nodes of their own or inside straight parts",
                    knobs.bonds_at.name(),
                    &["inside"],
                    "nodes",
                );
                let break_precision = Knob::new(
                    "break_precision",
                    "share of the largest failure index within which parts break together; 0: one by one",
                    knobs.break_precision,
                    &["0.2", "0.1", "0.05", "0.02"],
                    "0",
                );
                vec![segment, level, bonds_at, break_precision]
            }
            Specimen::SingleFibre(_) => vec![
                Knob::new(
                    "points_on_ring",
                    "points of a ring, an even number from 4 to 16",
                    self.model.points_on_ring,
                    &["4", "6", "8", "12"],
                    "16",
                ),
                Knob::new(
                    "ring",
                    "where in the wall the points lie: gyration or patent",
                    match self.model.ring {
                        Ring::Gyration => "gyration",
                        Ring::Patent => "patent",
                    },
                    &["patent"],
                    "gyration",
                ),
            ],
        }
    }

    fn turn(&mut self, knob: &str, value: &str) -> Option<()> {
        match knob {
            "segment_widths" => {
                let segment_widths = value.parse().ok()?;
                self.model.segment_um = None;
                self.accuracy
                    .change(|knobs| knobs.segment_widths = segment_widths);
            }
            "bonds_at" => {
                let bonds_at = match value {
                    "nodes" => BondsAt::Nodes,
                    "inside" => BondsAt::Inside,
                    _ => return None,
                };
                self.accuracy.change(|knobs| knobs.bonds_at = bonds_at);
            }
            "break_precision" => {
                let precision = value.parse().ok()?;
                self.accuracy
                    .change(|knobs| knobs.break_precision = precision);
            }
            "level" => {
                self.model.level = match value {
                    "tube" => Some(Level::Tube),
                    "beam" => Some(Level::Beam),
                    "truss" => Some(Level::Truss),
                    _ => return None,
                };
            }
            "points_on_ring" => self.model.points_on_ring = value.parse().ok()?,
            "ring" => {
                self.model.ring = match value {
                    "gyration" => Ring::Gyration,
                    "patent" => Ring::Patent,
                    _ => return None,
                };
            }
            _ => return None,
        }
        Some(())
    }

    fn single(&mut self, seed: u64) {
        self.realise(seed);
        if self.test.direction == Some(Direction::Both) {
            self.test.direction = Some(Direction::Md);
        }
    }

    fn realise(&mut self, seed: u64) {
        self.seed = seed;
        self.output.snapshot_every_steps = 0;
        if self.test.repeats.is_some() {
            self.test.repeats = Some(1);
        }
    }

    fn compares(result: &str) -> bool {
        COMPARED.contains(&result)
    }
}
