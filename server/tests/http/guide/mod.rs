//! The guide: every page, link and anchor; that it tells of whatever the program can say ([`told`]) and
//! shows commands that there are ([`commands`]); that things are found in it ([`search`]).
mod commands;
mod search;
mod told;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

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

/// The markdown texts of the guide, and the README.
fn texts() -> Vec<PathBuf> {
    let guide = root().join("server/guide");
    let files = std::fs::read_dir(guide).expect("the folder of the guide");
    let files = files.map(|file| file.expect("a file").path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    files.chain([root().join("README.md")]).collect()
}

/// Links of the texts: the text's path, and the target as written.
fn markdown_links() -> Vec<(PathBuf, String)> {
    let mut links = Vec::new();
    for path in texts() {
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
    let source = include_str!("../../../src/http/guide/source.rs");
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
