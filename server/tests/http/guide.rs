//! The guide: every page, link and anchor, and that it tells of whatever the program can say.
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

use loadframe_api::JobKind;

use crate::support::Lab;

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What stands in `attribute="..."` anywhere in a page, as text.
fn attributes(html: &str, attribute: &str) -> Vec<String> {
    let begin = format!(" {attribute}=\"");
    let values = html.split(&begin).skip(1);
    let values = values.filter_map(|rest| rest.split('"').next());
    values.map(|value| value.replace("&amp;", "&")).collect()
}

/// Every page that links lead to from `/guide`, by its address.
async fn every_page(lab: &Lab) -> BTreeMap<String, String> {
    let mut pages = BTreeMap::new();
    let mut to_read = VecDeque::from(["/guide".to_owned()]);
    while let Some(address) = to_read.pop_front() {
        if pages.contains_key(&address) {
            continue;
        }
        let answer = lab.get(&address).await;
        assert_eq!(answer.status, 200, "{address}");
        assert_eq!(
            answer.header("content-type"),
            "text/html; charset=utf-8",
            "{address}"
        );
        let html = answer.text();
        let links = attributes(&html, "href").into_iter();
        let links = links.filter_map(|link| link.split('#').next().map(str::to_owned));
        to_read.extend(links.filter(|link| link.starts_with("/guide") || link == "/docs"));
        pages.insert(address, html);
    }
    pages
}

#[tokio::test]
async fn every_link_and_anchor_leads_somewhere() {
    let lab = Lab::open().await;
    let pages = every_page(&lab).await;
    let anchors: BTreeMap<&str, BTreeSet<String>> = pages
        .iter()
        .map(|(address, html)| {
            (
                address.as_str(),
                attributes(html, "id").into_iter().collect(),
            )
        })
        .collect();
    let mut dead = Vec::new();
    for (address, html) in &pages {
        for link in attributes(html, "href") {
            let (target, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if target.is_empty() { address } else { target };
            let is_page = target.starts_with("/guide") || target == "/docs";
            if is_page && !anchor.is_empty() && !anchors[target].contains(anchor) {
                dead.push(format!("{address}: {link}"));
            }
            let is_route = target.starts_with("/v1") || target == "/openapi.json";
            if is_route && lab.get(target).await.status != 200 {
                dead.push(format!("{address}: {link}"));
            }
        }
        for picture in attributes(html, "src") {
            if lab.get(&picture).await.status != 200 {
                dead.push(format!("{address}: {picture}"));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

#[tokio::test]
async fn every_page_is_one_document() {
    let lab = Lab::open().await;
    for (address, html) in every_page(&lab).await {
        assert_eq!(html.matches("<h1").count(), 1, "{address}");
        assert_eq!(html.matches("<main").count(), 1, "{address}");
        assert!(html.contains("class=\"skip\" href=\"#main\""), "{address}");
        assert!(!html.contains("<script"), "{address}");
        assert!(
            !html.contains("<th>"),
            "{address}: a table's head without scope"
        );
        let ids = attributes(&html, "id");
        let different: BTreeSet<&String> = ids.iter().collect();
        assert_eq!(ids.len(), different.len(), "{address}: an anchor twice");
        let links = attributes(&html, "href");
        assert!(links.iter().any(|link| link == "/docs"), "{address}");
        assert!(links.iter().any(|link| link == "/guide"), "{address}");
    }
}

/// Links of markdown texts: the text's path, and the target as written.
fn markdown_links() -> Vec<(PathBuf, String)> {
    let guide = root().join("server/guide");
    let files = std::fs::read_dir(guide).expect("the folder of the guide");
    let files = files.map(|file| file.expect("a file").path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let mut links = Vec::new();
    for path in files.chain([root().join("README.md")]) {
        let text = std::fs::read_to_string(&path).expect("a text");
        let targets = text.split("](").skip(1);
        let targets = targets.filter_map(|rest| rest.split(')').next());
        links.extend(targets.map(|target| (path.clone(), target.to_owned())));
    }
    links
}

#[tokio::test]
async fn links_of_the_texts_lead_somewhere_in_the_repository_too() {
    let lab = Lab::open().await;
    let pages = every_page(&lab).await;
    let mut dead = Vec::new();
    for (path, link) in markdown_links() {
        if link.starts_with("http") {
            continue;
        }
        let (target, anchor) = link.split_once('#').unwrap_or((&link, ""));
        let folder = path.parent().expect("a folder");
        let file = if target.is_empty() {
            path.clone()
        } else {
            folder.join(target)
        };
        if !file.exists() {
            dead.push(format!("{}: {link}", path.display()));
            continue;
        }
        // the anchors of a text are those of its page
        let stem = file
            .file_stem()
            .and_then(|stem| stem.to_str())
            .unwrap_or("");
        let page = match file.to_string_lossy().contains("tests/validation") {
            true => format!("/guide/validation-{stem}"),
            false => format!("/guide/{stem}"),
        };
        let has_anchor = |html: &String| html.contains(&format!("id=\"{anchor}\""));
        if !anchor.is_empty() && !pages.get(&page).is_some_and(has_anchor) {
            dead.push(format!("{}: {link}", path.display()));
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

#[test]
fn the_readme_is_one_screenful() {
    let text = std::fs::read_to_string(root().join("README.md")).expect("the README");
    assert!(text.lines().count() < 150);
    for command in [
        "cargo run --release -- lab --demo",
        "tests/run",
        "server/guide/pictures/lab.png",
    ] {
        assert!(text.contains(command), "{command}");
    }
}

#[test]
fn every_validation_page_is_in_the_guide() {
    let source = include_str!("../../src/http/guide/source.rs");
    let folder = std::fs::read_dir(root().join("tests/validation")).expect("the folder");
    for file in folder {
        let name = file.expect("a file").file_name();
        let name = name.to_string_lossy();
        if name.ends_with(".md") {
            assert!(
                source.contains(&format!("\"tests/validation/{name}\"")),
                "{name}"
            );
        }
    }
}

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
            "the page of {kind} links its fields"
        );
        assert!(
            index.contains(&fields),
            "the index links the fields of {kind}"
        );
        let fields = lab.get(&fields).await.text();
        assert!(
            fields.contains(&format!("/v1/kinds/{kind}/schema")),
            "{kind}"
        );
        for example in kind.examples() {
            assert!(
                page.contains(example.name),
                "the page of {kind} names {}",
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

/// Names of quality checks: what stands in quotes before `QualityCheck::at_most`.
fn quality_names(sources: &[(PathBuf, String)]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (path, text) in sources {
        for (before, _) in pieces(text, "QualityCheck::at_most(") {
            let before = before.trim_end();
            // joint reports keep the names they are given
            if before.ends_with("*check =") {
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

#[tokio::test]
async fn search_finds_sections() {
    let lab = Lab::open().await;
    for (query, address) in [
        ("jaw_force_imbalance", "/guide/quality#jaw_force_imbalance"),
        ("quarantined", "/guide/operate#workers"),
        (
            "strain_step",
            "/guide/nonwoven_tensile/fields#test.strain_step",
        ),
        ("backup", "/guide/operate#data"),
        (
            "LAMMPS",
            "/guide/peers-and-speed#beside-lammps-and-yade-in-speed",
        ),
        ("token%20revoke", "/guide/operate#tokens"),
        ("which+command", "/guide/how-it-is-built#which-command-when"),
    ] {
        let page = lab.get(&format!("/guide/search?q={query}")).await.text();
        let link = format!("<a href=\"{address}\">");
        assert!(page.contains(&link), "{query}: {page}");
    }
    let first = lab.get("/guide/search?q=inertial_number").await.text();
    let found = first.split("class=\"found\"").nth(1).expect("results");
    assert!(found.contains("<mark>inertial_number</mark>"));
}

#[tokio::test]
async fn search_takes_whatever_is_asked() {
    let lab = Lab::open().await;
    let long = "very+long+".repeat(5_000);
    for query in [
        "",
        "?",
        "?q",
        "?q=",
        "?q=%20",
        "?other=1",
        "?q=a&q=b",
        "?q=%00%01",
        "?q=%ff%fe",
        "?q=%",
        "?q=%F0%9F%A6%80",
        "?q=..%2f..%2fetc",
        "?q=%3Cscript%3Ealert(1)%3C/script%3E",
        "?q=%22%3E%3Cimg+src=x+onerror=y%3E",
        &format!("?q={long}"),
    ] {
        let answer = lab.get(&format!("/guide/search{query}")).await;
        assert_eq!(answer.status, 200, "{query:.60}");
        let html = answer.text();
        assert!(
            !html.contains("<script") && !html.contains("<img"),
            "{query:.60}"
        );
        assert!(html.len() < 200_000, "{query:.60}");
        assert_eq!(html.matches("<h1").count(), 1);
    }
}

#[tokio::test]
async fn what_is_known_is_not_sent_again() {
    let lab = Lab::open().await;
    for path in [
        "/guide",
        "/guide/quality",
        "/guide/granular_scene/fields",
        "/docs",
        "/guide/pictures/lab.png",
    ] {
        let answer = lab.get(path).await;
        assert_eq!(answer.status, 200, "{path}");
        let tag = answer.header("etag");
        assert!(!tag.is_empty(), "{path}");
        let again = lab.get_with(path, &[("if-none-match", tag)]).await;
        assert_eq!((again.status, again.body.len()), (304, 0), "{path}");
        let other = lab.get_with(path, &[("if-none-match", "\"other\"")]).await;
        assert_eq!(other.status, 200, "{path}");
    }
    let [one, other] = [lab.get("/guide").await, lab.get("/guide/quality").await];
    assert_ne!(
        one.header("etag"),
        other.header("etag"),
        "each page has its own tag"
    );
}

#[tokio::test]
async fn odd_addresses_are_answered() {
    let lab = Lab::open().await;
    for path in [
        "/guide/none",
        "/guide/..%2f",
        "/guide/%2e%2e",
        "/guide/README",
        "/guide/tables",
        "/guide/%00",
        "/guide/%ff",
        "/guide/none.md",
        "/guide/tables/calibrate_pet.md",
        "/guide/pictures/none.png",
        "/guide/pictures/..%2fstart.md",
        "/guide/start/fields",
        "/guide/start/",
        "/guide/search/fields",
    ] {
        let answer = lab.get(path).await;
        assert!(
            [400, 404].contains(&answer.status),
            "{path}: {}",
            answer.status
        );
        assert_eq!(
            answer.header("content-type"),
            "application/problem+json",
            "{path}"
        );
    }
    for (path, address) in [("/guide/", "/guide"), ("/guide/start.md", "/guide/start")] {
        let answer = lab.get(path).await;
        assert_eq!(
            (answer.status, answer.header("location")),
            (308, address),
            "{path}"
        );
    }
    lab.post("/guide/start", "{}")
        .await
        .problem(405, "method-not-allowed");
}
