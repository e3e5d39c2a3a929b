//! `parameters.md`: the study as a page.
use std::fmt::Write;

use loadframe_api::words;

use super::analysis::Study;
use super::labels::Labels;
use crate::text::digits;

/// The page.
pub(super) fn page(study: &Study) -> String {
    let seeds = &study.seeds;
    let mut text = format!("# {}\n\n", study.title);
    if !study.source.is_empty() {
        let _ = writeln!(text, "Source: {}\n", study.source);
    }
    if !study.statement.is_empty() {
        let _ = writeln!(text, "> {}\n", study.statement);
    }
    let heads = study.findings.keys().map(|name| study.head(name));
    let heads: Vec<String> = heads.collect();
    let labels = Labels::of(&study.cases);
    let first = words(labels.name());
    let all: Vec<&str> = [first.as_str()]
        .into_iter()
        .chain(heads.iter().map(String::as_str))
        .chain(["n", "processor time of a test [s]", "tests with warnings"])
        .collect();
    row(&mut text, all.iter().map(|head| (*head).to_owned()));
    row(&mut text, all.iter().map(|_| "---".to_owned()));
    for case in &study.cases {
        let results = study.findings.keys().map(|name| {
            let result = &case.results[name];
            let interval = result
                .interval_in_words()
                .map(|interval| format!(" {interval}"));
            result.in_words(seeds.len()) + &interval.unwrap_or_default()
        });
        let warnings = match case.warnings_in_words() {
            none if none.is_empty() => "none".to_owned(),
            some => some,
        };
        let end = [seeds.len().to_string(), digits(case.cpu_s), warnings];
        row(
            &mut text,
            [labels.short(&case.label).to_owned()]
                .into_iter()
                .chain(results)
                .chain(end),
        );
    }
    let range = match seeds.as_slice() {
        [first, .., last] => format!("seeds {first} to {last}, the same in all cases"),
        [seed] => format!("seed {seed}"),
        [] => String::new(),
    };
    let _ = writeln!(
        text,
        "\nMean ± standard deviation over n specimens ({range}), in brackets the 95 % interval of \
         the mean (Student's t).\n\n## What the numbers say\n"
    );
    for sentence in study.sentences() {
        let _ = writeln!(text, "- {sentence}");
    }
    let _ = writeln!(
        text,
        "\nJobs of kind `{}`, computed by loadframe {} ({}).",
        study.kind, study.engine_version, study.engine_commit
    );
    text
}

/// A row of a table; a bar in a cell would end it.
fn row(text: &mut String, cells: impl Iterator<Item = String>) {
    let cells: Vec<String> = cells.map(|cell| cell.replace('|', "\\|")).collect();
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}
