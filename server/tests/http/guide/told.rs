//! The guide tells of every kind of test, every warning and every measure of quality.
use std::collections::BTreeSet;
use std::path::PathBuf;

use loadframe_api::JobKind;

use super::{attributes, root};
use crate::support::Lab;

#[tokio::test]
async fn every_kind_has_its_page_and_its_fields() {
    let lab = Lab::open().await;
    let index = lab.get("/guide").await.text();
    for kind in JobKind::ALL {
        let mut answer = lab.get(&format!("/guide/{kind}")).await;
        let mut anchor = "";
        let home = answer.header("location").to_owned();
        if answer.status == 308 {
            let (page, section) = home.split_once('#').expect("a section of a page");
            assert_eq!(section, kind.name());
            anchor = section;
            answer = lab.get(page).await;
        }
        assert_eq!(
            answer.status, 200,
            "{kind} has no page: write server/guide/{kind}.md"
        );
        let page = answer.text();
        assert!(
            page.contains(&format!("id=\"{anchor}\"")) || anchor.is_empty(),
            "{kind}"
        );
        let fields = format!("/guide/{kind}/fields");
        assert!(
            page.contains(&fields),
            "the page of {kind} has no link to {fields}"
        );
        assert!(index.contains(&fields), "the index has no link to {fields}");
        let fields = lab.get(&fields).await.text();
        assert!(
            fields.contains(&format!("/v1/kinds/{kind}/schema")),
            "{kind}"
        );
        for example in kind.examples() {
            assert!(
                page.contains(example.name),
                "the page of {kind} does not name {}",
                example.name
            );
        }
    }
    let fields = lab.get("/guide/nonwoven_tensile/fields").await.text();
    assert!(fields.contains("id=\"test.strain_step\""));
    lab.get("/guide/nonsense/fields")
        .await
        .problem(404, "not-found");
}

#[test]
fn the_proxy_that_is_shown_is_the_one_that_is_tested() {
    let read = |path: &str| std::fs::read_to_string(root().join(path)).expect("a text");
    let page = read("server/guide/beyond-one-machine.md");
    let configuration = read("server/deploy/nginx.conf");
    assert!(page.contains(&format!("```nginx\n{configuration}```")));
}

/// Every Rust source of the engines and the vocabulary, without its tests.
fn sources() -> Vec<(PathBuf, String)> {
    let mut folders = vec![
        root().join("api"),
        root().join("worker"),
        root().join("server/src"),
    ];
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path
                .file_name()
                .and_then(|name| name.to_str())
                .unwrap_or("");
            if path.is_dir() && !["tests", "benches", "target"].contains(&name) {
                folders.push(path);
            } else if name.ends_with(".rs") && name != "tests.rs" {
                let text = std::fs::read_to_string(&path).expect("a source");
                let own = text
                    .split("#[cfg(test)]\nmod tests {")
                    .next()
                    .unwrap_or("")
                    .to_owned();
                sources.push((path, own));
            }
        }
    }
    sources
}

/// The word that `text` begins with, in quotes; white space before it is passed over.
fn quoted(text: &str) -> Option<&str> {
    let word = text.trim_start().strip_prefix('"')?.split('"').next()?;
    let is_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    (!word.is_empty() && word.chars().all(is_name)).then_some(word)
}

/// Codes of warnings: `warn("code"` and `Warning { code: "code"`.
fn warning_codes(sources: &[(PathBuf, String)]) -> BTreeSet<String> {
    // these take their codes from elsewhere: a quality check's name, another warning, a parameter
    const TAKEN_OVER: [&str; 3] = ["name.clone()", "warning.code.clone()", "code.to_owned()"];
    let mut codes = BTreeSet::new();
    for (path, text) in sources {
        for rest in text.split("warn(").skip(1) {
            codes.extend(quoted(rest).map(str::to_owned));
        }
        for (before, rest) in pieces(text, "Warning {") {
            let rest = rest.trim_start();
            if before.ends_with("struct ") || before.ends_with("impl ") || before.ends_with("for ")
            {
                continue;
            }
            let Some(code) = rest.strip_prefix("code:").map(str::trim_start) else {
                assert!(!rest.starts_with("code"), "{}: {rest:.60}", path.display());
                continue;
            };
            match quoted(code) {
                Some(code) => drop(codes.insert(code.to_owned())),
                None => assert!(
                    TAKEN_OVER.iter().any(|known| code.starts_with(known)),
                    "{}: this test cannot tell where the code comes from: {code:.60}",
                    path.display()
                ),
            }
        }
    }
    codes
}

/// Names of quality checks: `.check("name"` of a report, and what stands in quotes before
/// `QualityCheck::at_most`.
fn quality_names(sources: &[(PathBuf, String)]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (path, text) in sources {
        for rest in text.split(".check(").skip(1) {
            names.extend(quoted(rest).map(str::to_owned));
        }
        for (before, _) in pieces(text, "QualityCheck::at_most(") {
            let before = before.trim_end();
            // joint reports and their builder keep the names they are given
            if before.ends_with("check =") {
                continue;
            }
            let before = before.trim_end_matches(',').trim_end_matches(".to_owned()");
            let name = before
                .strip_suffix('"')
                .and_then(|before| before.rsplit('"').next());
            let name = name.unwrap_or_else(|| panic!("{}: a check without a name", path.display()));
            names.insert(name.to_owned());
        }
    }
    names
}

/// What stands before and after each place of `mark`.
fn pieces<'a>(text: &'a str, mark: &'a str) -> impl Iterator<Item = (&'a str, &'a str)> {
    let places = text.match_indices(mark);
    places.map(move |(place, _)| (&text[..place], &text[place + mark.len()..]))
}

#[tokio::test]
async fn every_warning_and_every_measure_is_told() {
    let sources = sources();
    let codes = warning_codes(&sources);
    let names = quality_names(&sources);
    // those that the scan must find, or it is blind
    for known in [
        "not_settled",
        "unconverged_steps",
        "misfit_above_tolerance",
        "repeats_alike",
        "not_calibrated",
    ] {
        assert!(codes.contains(known), "{known} in {codes:?}");
    }
    for known in [
        "largest_residual_ratio",
        "inertial_number",
        "condition_index",
    ] {
        assert!(names.contains(known), "{known} in {names:?}");
    }
    let lab = Lab::open().await;
    let page = lab.get("/guide/quality").await.text();
    let told: BTreeSet<String> = attributes(&page, "id").into_iter().collect();
    let untold: Vec<&String> = codes
        .union(&names)
        .filter(|name| !told.contains(*name))
        .collect();
    assert!(
        untold.is_empty(),
        "server/guide/quality.md does not tell of {untold:?}"
    );
}
