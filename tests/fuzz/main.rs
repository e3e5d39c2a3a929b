//! The parsers of foreign bytes over the corpus, the offending specs of `data/bad`, the examples, and
//! what becomes of each when it is cut, changed, doubled or spliced. Those of the server, which read a
//! request's target, headers and body, are held in `server/tests/http/foreign.rs` against `corpus/request`.
mod mutants;
mod parsers;

use std::path::Path;

use loadframe_api::JobKind;

fn files(folder: &str) -> Vec<Vec<u8>> {
    mutants::files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder))
}

fn hold(parser: fn(&[u8]), files: &[Vec<u8>]) {
    mutants::of(files).for_each(|bytes| parser(&bytes));
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
