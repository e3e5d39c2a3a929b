//! The texts of the guide: markdown files in `server/guide`, and the validation pages in
//! `tests/validation`, built into the executable.
use rust_embed::Embed;

use super::listed::with_lists;
use crate::ServeConfig;

/// The folder of the guide.
#[derive(Embed)]
#[folder = "guide"]
struct Folder;

/// Path of the folder in the repository.
const FOLDER: &str = "server/guide";

/// The text that opens the guide, and whose links give the order of the pages.
pub(super) const INDEX: &str = "README.md";

/// Pages that lie elsewhere in the repository: name, path, text.
const ELSEWHERE: [(&str, &str, &str); 2] = [
    (
        "validation-nonwoven",
        "tests/validation/nonwoven.md",
        include_str!("../../../../tests/validation/nonwoven.md"),
    ),
    (
        "validation-ballast",
        "tests/validation/ballast.md",
        include_str!("../../../../tests/validation/ballast.md"),
    ),
];

/// A text of the guide.
#[derive(Debug)]
pub(super) struct Source {
    /// Its address is `/guide/{name}`; that of the index is empty.
    pub(super) name: String,
    /// Where it lies in the repository.
    pub(super) path: String,
    pub(super) markdown: String,
}

/// Every text, the index first and the others in the order in which it links them.
pub(super) fn all() -> Vec<Source> {
    let own = Folder::iter().filter_map(|file| {
        let name = file
            .strip_suffix(".md")
            .filter(|name| !name.contains('/'))?;
        let bytes = Folder::get(&file)?.data;
        Some(Source {
            name: if file == INDEX {
                String::new()
            } else {
                name.to_owned()
            },
            path: format!("{FOLDER}/{file}"),
            markdown: with_lists(&with_tables(&String::from_utf8_lossy(&bytes))),
        })
    });
    let elsewhere = ELSEWHERE.map(|(name, path, markdown)| Source {
        name: name.to_owned(),
        path: path.to_owned(),
        markdown: markdown.to_owned(),
    });
    let mut all: Vec<Source> = own.chain(elsewhere).collect();
    let index = all.iter().find(|source| source.name.is_empty());
    let order = index.map_or_else(Vec::new, |index| links(&index.markdown));
    let place = |source: &Source| match source.name.as_str() {
        "" => 0,
        _ => {
            let linked = order.iter().position(|path| *path == source.path);
            linked.map_or(usize::MAX, |place| place + 1)
        }
    };
    all.sort_by_cached_key(|source| (place(source), source.name.clone()));
    all
}

/// A picture of the guide.
pub(super) fn picture(name: &str) -> Option<rust_embed::EmbeddedFile> {
    let path = format!("pictures/{name}");
    // only what is listed, whatever a name may lead to
    Folder::iter().find(|file| *file == path)?;
    Folder::get(&path)
}

/// Paths in the repository that the index links, in its order.
fn links(index: &str) -> Vec<String> {
    let targets = index.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split([')', '#']).next());
    targets.map(|target| from_folder(FOLDER, target)).collect()
}

/// The text with measured tables, `tables/NAME.md`, in the place of the lines `{{table NAME}}`.
fn with_tables(markdown: &str) -> String {
    let lines = markdown.lines().map(|line| match table_name(line) {
        None => line.to_owned(),
        Some(name) => match Folder::get(&format!("tables/{name}.md")) {
            Some(file) => String::from_utf8_lossy(&file.data).into_owned(),
            None => format!("{MISSING} `{name}`."),
        },
    });
    lines.fold(String::with_capacity(markdown.len()), |text, line| {
        text + line.trim_end_matches('\n') + "\n"
    })
}

/// Said where a table should be; a test looks for it.
pub(super) const MISSING: &str = "There is no table";

fn table_name(line: &str) -> Option<&str> {
    line.trim().strip_prefix("{{table ")?.strip_suffix("}}")
}

/// Where a link in the text at `path` leads; `None` for what this server does not serve.
pub(super) fn lead(path: &str, link: &str, served: &[(String, String)]) -> Option<String> {
    // a lab on its default address is this one
    let own = format!("http://{}/", ServeConfig::DEFAULT_LISTEN);
    if let Some(rest) = link.strip_prefix(&own) {
        return Some(format!("/{rest}"));
    }
    if link.starts_with("http://") || link.starts_with("https://") || link.starts_with('#') {
        return Some(link.to_owned());
    }
    let (target, anchor) = link.split_once('#').unwrap_or((link, ""));
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let target = from_folder(folder, target);
    let page = served.iter().find(|(path, _)| *path == target);
    let address = match page {
        Some((_, name)) if name.is_empty() => "/guide".to_owned(),
        Some((_, name)) => format!("/guide/{name}"),
        None => {
            let picture = target.strip_prefix(FOLDER)?.strip_prefix("/pictures/")?;
            format!("/guide/pictures/{picture}")
        }
    };
    Some(match anchor {
        "" => address,
        anchor => format!("{address}#{anchor}"),
    })
}

/// The path that a relative one means in `folder`.
fn from_folder(folder: &str, relative: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in relative.split('/') {
        match part {
            ".." => {
                parts.pop();
            }
            "." | "" => {}
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_where_they_lead_in_the_repository() {
        let served = [
            ("server/guide/start.md".to_owned(), "start".to_owned()),
            ("server/guide/README.md".to_owned(), String::new()),
            (
                "tests/validation/b.md".to_owned(),
                "validation-b".to_owned(),
            ),
        ];
        let lead = |link: &str| lead("server/guide/a.md", link, &served);
        let to = |address: &str| Some(address.to_owned());
        assert_eq!(lead("start.md#rest"), to("/guide/start#rest"));
        assert_eq!(lead("README.md"), to("/guide"));
        assert_eq!(
            lead("../../tests/validation/b.md"),
            to("/guide/validation-b")
        );
        assert_eq!(lead("pictures/lab.png"), to("/guide/pictures/lab.png"));
        assert_eq!(lead("#here"), to("#here"));
        assert_eq!(lead("http://127.0.0.1:8400/docs#x"), to("/docs#x"));
        assert_eq!(lead("https://example.org/"), to("https://example.org/"));
        assert_eq!(lead("../../tests/run"), None);
        assert_eq!(lead("javascript:alert(1)"), None);
    }

    #[test]
    fn every_table_is_there_and_shown() {
        let texts = all();
        for source in &texts {
            let missing = source
                .markdown
                .lines()
                .find(|line| line.starts_with(MISSING));
            assert_eq!(missing, None, "{}", source.path);
            let is_left = source.markdown.contains(" of every kind}}");
            assert!(!is_left, "{}", source.path);
        }
        let raw = Folder::iter().filter(|file| !file.starts_with("tables/"));
        let raw = raw.filter_map(|file| {
            Some(String::from_utf8_lossy(&Folder::get(&file)?.data).into_owned())
        });
        let raw: Vec<String> = raw.collect();
        for file in Folder::iter().filter(|file| file.starts_with("tables/")) {
            let name = file.trim_start_matches("tables/").trim_end_matches(".md");
            let line = format!("{{{{table {name}}}}}");
            assert!(
                raw.iter().any(|text| text.contains(&line)),
                "no page shows {file}"
            );
        }
        assert!(with_tables("a\n{{table none}}\nb\n").contains("There is no table `none`."));
    }

    #[test]
    fn every_page_is_in_the_index() {
        let texts = all();
        let order = links(&texts[0].markdown);
        for source in &texts[1..] {
            assert!(order.contains(&source.path), "{}", source.path);
        }
    }
}
