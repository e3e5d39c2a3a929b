//! What becomes of files when they are cut, changed, doubled or spliced.
use std::fs;
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Mutants of a file. `LOADFRAME_FUZZ` sets another number.
const MUTANTS: usize = 40;
/// Bytes that mean something to one parser or another.
const MARKS: &[u8] = b"\0\xff{}[]\",:;.-+eE019\n\t ";
/// Larger files would take all of the time.
const LARGEST: usize = 20_000;

/// The files of a folder, in the order of their names.
pub(crate) fn files(folder: &Path) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder).expect("the corpus is in the repository");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    let read = paths.iter().map(|path| fs::read(path).expect("a file"));
    read.filter(|bytes| bytes.len() <= LARGEST).collect()
}

/// Each of the files, and its mutants.
pub(crate) fn of(files: &[Vec<u8>]) -> impl Iterator<Item = Vec<u8>> {
    let mutants = std::env::var("LOADFRAME_FUZZ").ok();
    let mutants = mutants.map_or(MUTANTS, |text| text.parse().expect("a number"));
    let mut chance = ChaCha8Rng::seed_from_u64(36);
    (0..files.len() * (1 + mutants)).map(move |number| {
        let file = &files[number / (1 + mutants)];
        if number.is_multiple_of(1 + mutants) {
            return file.clone();
        }
        let other = &files[chance.random_range(0..files.len())];
        mutant(file, other, &mut chance)
    })
}

/// Another file from one, or from one and the end of another.
fn mutant(of: &[u8], other: &[u8], chance: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = of.to_vec();
    for _ in 0..chance.random_range(1..4) {
        if bytes.is_empty() {
            return other.to_vec();
        }
        let at = chance.random_range(0..bytes.len());
        match chance.random_range(0..6) {
            0 => bytes.truncate(at),
            1 => bytes[at] ^= 1 << chance.random_range(0..8),
            2 => bytes[at] = MARKS[chance.random_range(0..MARKS.len())],
            3 => {
                let piece = bytes[at..bytes.len().min(at + 40)].to_vec();
                bytes.splice(at..at, piece);
            }
            4 => drop(bytes.drain(at..(at + 10).min(bytes.len()))),
            _ => {
                bytes.truncate(at);
                bytes.extend(&other[other.len().min(at)..]);
            }
        }
    }
    bytes
}
