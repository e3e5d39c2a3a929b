//! Random numbers that do not depend on the order in which they are drawn.
//!
//! Every purpose has its own key and every object (node, bond) its own stream under that key. A
//! bond's strength is then a function of seed and bond number alone: it stays the same whoever
//! draws first, and however many numbers other objects needed.
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// What random numbers are drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Displacements that make a lattice irregular, one stream per node.
    Irregularity,
    /// Bond strengths, one stream per bond.
    Strength,
    /// Sizes of grains, one stream per generator.
    GrainSizes,
    /// Orientations of grains, one stream per generator.
    GrainRotations,
    /// Places of grains, one stream per generator.
    GrainPlaces,
    /// Places of grains that are put in during a test, one stream per batch.
    BatchPlaces,
    /// Strengths of what a cell of a section holds, one stream per cell.
    CellStrength,
    /// Sizes of fibres, one stream per fibre.
    FibreSizes,
    /// Places of fibres: in a unit cell, one stream per cell; and directions in a sheet, one per fibre.
    FibrePlaces,
}

/// The streams of one purpose.
#[derive(Clone, Debug)]
pub struct Streams(ChaCha8Rng);

impl Streams {
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let name = match purpose {
            Purpose::Irregularity => "irregularity",
            Purpose::Strength => "strength",
            Purpose::GrainSizes => "grain sizes",
            Purpose::GrainRotations => "grain rotations",
            Purpose::GrainPlaces => "grain places",
            Purpose::BatchPlaces => "batch places",
            Purpose::CellStrength => "cell strength",
            Purpose::FibreSizes => "fibre sizes",
            Purpose::FibrePlaces => "fibre places",
        };
        // hashing keeps streams unrelated for seeds that differ in one bit, and the name makes a
        // new purpose harmless to the numbers of the old ones
        let key = blake3::Hasher::new_derive_key("loadframe random stream 1")
            .update(&seed.to_le_bytes())
            .update(name.as_bytes())
            .finalize();
        Self(ChaCha8Rng::from_seed(*key.as_bytes()))
    }

    /// The generator of object number `index`.
    pub fn of(&self, index: usize) -> ChaCha8Rng {
        let mut generator = self.0.clone();
        generator.set_stream(index as u64);
        generator
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng as _;

    #[test]
    fn an_object_draws_the_same_whoever_drew_before() {
        let streams = Streams::new(7, Purpose::Strength);
        let late = streams.of(5).next_u64();
        streams.of(4).next_u64();
        assert_eq!(streams.of(5).next_u64(), late);
    }

    #[test]
    fn seeds_purposes_and_objects_draw_differently() {
        let first = |seed, purpose, index| Streams::new(seed, purpose).of(index).next_u64();
        let reference = first(7, Purpose::Strength, 0);
        assert_ne!(first(8, Purpose::Strength, 0), reference);
        assert_ne!(first(7, Purpose::Irregularity, 0), reference);
        assert_ne!(first(7, Purpose::Strength, 1), reference);
    }
}
