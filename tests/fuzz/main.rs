//! The parsers of foreign bytes over the corpus, the offending specs of `data/bad`, the examples, and
//! what becomes of each when it is cut, changed, doubled or spliced.
mod parsers;

use std::fs;
use std::path::Path;

use loadframe_api::JobKind;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Mutants of a file. `LOADFRAME_FUZZ` sets another number.
const MUTANTS: usize = 40;
/// Bytes that mean something to one parser or another.
const MARKS: &[u8] = b"\0\xff{}[]\",:;.-+eE019\n\t ";
/// Larger files would take all of the time.
const LARGEST: usize = 20_000;

fn files(folder: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(&folder).expect("the corpus is in the repository");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    let read = paths.iter().map(|path| fs::read(path).expect("a file"));
    read.filter(|bytes| bytes.len() <= LARGEST).collect()
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

fn hold(parser: fn(&[u8]), files: &[Vec<u8>]) {
    let mutants = std::env::var("LOADFRAME_FUZZ").ok();
    let mutants = mutants.map_or(MUTANTS, |text| text.parse().expect("a number"));
    let mut chance = ChaCha8Rng::seed_from_u64(36);
    for file in files {
        parser(file);
        for _ in 0..mutants {
            let other = &files[chance.random_range(0..files.len())];
            parser(&mutant(file, other, &mut chance));
        }
    }
}

#[test]
fn no_submission_is_the_end_of_its_reader() {
    let mut all = files("fuzz/corpus/submission");
    all.extend(files("data/bad"));
    let examples = JobKind::ALL
        .iter()
        .filter_map(|kind| kind.examples().first());
    all.extend(examples.map(|example| example.body.as_bytes().to_vec()));
    hold(parsers::submission, &all);
}

#[test]
fn no_message_is_the_end_of_its_reader() {
    hold(parsers::message, &files("fuzz/corpus/message"));
}

#[test]
fn no_table_is_the_end_of_its_reader() {
    hold(parsers::table, &files("fuzz/corpus/table"));
}

#[test]
fn no_bed_is_the_end_of_its_reader() {
    hold(parsers::bed, &files("fuzz/corpus/bed"));
}

#[test]
fn no_surface_is_the_end_of_its_reader() {
    hold(parsers::surface, &files("fuzz/corpus/surface"));
}

#[test]
fn no_checkpoint_is_the_end_of_its_reader() {
    hold(parsers::checkpoint, &files("fuzz/corpus/checkpoint"));
}
