//! Parts of the guide that go over all kinds: written from the one list of kinds, so that no page forgets
//! one.
use loadframe_api::study::Knob;
use loadframe_api::{Envelope, JobKind, JobSpec};

use crate::ServeConfig;

/// A list, written out.
type List = fn() -> String;

/// The text with lists in the places of their marks.
pub(super) fn with_lists(markdown: &str) -> String {
    let marks: [(&str, List); 2] = [
        ("{{fields of every kind}}", fields),
        ("{{knobs of every kind}}", knobs),
    ];
    let mut text = markdown.to_owned();
    for (mark, list) in marks {
        if text.contains(mark) {
            text = text.replace(mark, &list());
        }
    }
    text
}

/// Links to the pages of fields, side by side.
fn fields() -> String {
    let links = JobKind::ALL.iter().map(|kind| {
        let lab = ServeConfig::DEFAULT_LISTEN;
        format!("[{kind}](http://{lab}/guide/{kind}/fields)")
    });
    links.collect::<Vec<_>>().join(", ")
}

/// A table of what a study of accuracy can vary in the examples of each kind; kinds that are alike share
/// their rows.
fn knobs() -> String {
    let mut groups: Vec<(Vec<String>, Vec<Knob>)> = Vec::new();
    for kind in JobKind::ALL {
        let (name, own) = (format!("`{kind}`"), knobs_of(*kind));
        let is_alike = |known: &[Knob]| {
            let texts = |knobs: &[Knob]| -> Vec<[&str; 2]> {
                let texts = knobs.iter().map(|knob| [knob.name, knob.description]);
                texts.collect()
            };
            texts(known) == texts(&own)
        };
        match groups.iter_mut().find(|(_, known)| is_alike(known)) {
            Some((names, _)) => names.push(name),
            None => groups.push((vec![name], own)),
        }
    }
    let mut table = String::from("| kind | knob | what it is |\n|---|---|---|\n");
    for (names, own) in groups {
        let mut names = names.join(", ");
        for knob in own {
            table += &format!("| {names} | `{}` | {} |\n", knob.name, knob.description);
            // once for all of its rows
            names.clear();
        }
    }
    table
}

/// The knobs of a kind, in the order in which its examples have them.
fn knobs_of(kind: JobKind) -> Vec<Knob> {
    let mut all: Vec<Knob> = Vec::new();
    for example in kind.examples() {
        let envelope = serde_json::from_str::<Envelope>(example.body).ok();
        let spec = envelope.and_then(|envelope| JobSpec::from_json(kind, envelope.spec.get()).ok());
        for knob in spec.iter().flat_map(JobSpec::knobs) {
            if all.iter().all(|known| known.name != knob.name) {
                all.push(knob);
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_its_fields_and_its_knobs() {
        let text = with_lists("Here: {{fields of every kind}}.\n\n{{knobs of every kind}}\n");
        assert!(!text.contains("{{"), "{text}");
        for kind in JobKind::ALL {
            assert!(text.contains(&format!("/guide/{kind}/fields)")), "{kind}");
            assert!(text.contains(&format!("`{kind}`")), "{kind}");
            let knobs = knobs_of(*kind);
            assert!(!knobs.is_empty(), "{kind}");
            for knob in knobs {
                let row = format!("| `{}` | {} |", knob.name, knob.description);
                assert!(text.contains(&row), "{kind}: {row}");
                // it would end the cell
                assert!(!knob.description.contains('|'), "{kind}: {row}");
            }
        }
    }
}
