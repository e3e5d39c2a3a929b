//! What an e-mail says: one event in a sentence, many as a digest.
use std::fmt::Write;

use crate::store::people::{Due, DueEvent};

/// Jobs that are named one by one.
const NAMED: usize = 20;
/// Longest name in a line [characters].
const LONGEST_NAME: usize = 80;
/// Longest reason in a line [characters].
const LONGEST_REASON: usize = 300;

/// Subject and text.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Written {
    pub(super) subject: String,
    pub(super) text: String,
}

/// The first e-mail to an address, with the link by which whoever reads it takes it over.
pub(super) fn verification(due: &Due, address: &str) -> Written {
    let text = format!(
        "Somebody asked this server to send e-mail about its jobs to this address:\n{address}\n\n\
         If it was you, follow this link while you are signed in there:\n{address}mail#{}\n\n\
         If not, do nothing: no other e-mail will come.\n",
        due.secret
    );
    Written {
        subject: "loadframe: confirm this address".to_owned(),
        text,
    }
}

/// What happened.
pub(super) fn digest(due: &Due, address: &str) -> Written {
    let mut lines: Vec<(String, String)> = Vec::new();
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for event in &due.events {
        let (word, sentence) = sentence(event);
        match counts.iter_mut().find(|(known, _)| *known == word) {
            Some((_, count)) => *count += 1,
            None => counts.push((word, 1)),
        }
        lines.push((sentence + &why(event), link(event, address)));
    }
    let subject = match &due.events[..] {
        [event] => format!("loadframe: {}", sentence(event).1),
        _ => {
            let counts = counts.iter().map(|(word, count)| format!("{count} {word}"));
            format!("loadframe: {}", counts.collect::<Vec<_>>().join(", "))
        }
    };
    let mut text = String::new();
    for (sentence, link) in lines.iter().take(NAMED) {
        // writing to a text does not fail
        let _ = writeln!(text, "{sentence}\n  {link}\n");
    }
    if lines.len() > NAMED {
        let _ = writeln!(text, "… and {} more.\n", lines.len() - NAMED);
    }
    let _ = writeln!(
        text,
        "-- \nYou asked for this on the page Account of {address}\nIt ends there, too."
    );
    Written { subject, text }
}

/// The word by which events are counted, and the event in a sentence.
fn sentence(event: &DueEvent) -> (&'static str, String) {
    let word = |name: &str| plain(event.about[name].as_str().unwrap_or(""), LONGEST_NAME);
    let job = match word("name") {
        name if name.is_empty() => "a job".to_owned(),
        name => name,
    };
    match event.event.as_str() {
        "failed" => ("failed", format!("{job} has failed")),
        "quarantined" => ("set aside", format!("{job} was set aside")),
        "shared" => ("shared", "a share link was made".to_owned()),
        "quota" => {
            let number = |name: &str| event.about[name].as_f64();
            let sentence = match (number("used_core_h"), number("limit_core_h")) {
                (Some(used), Some(limit)) => {
                    format!("your queued jobs take {used:.2} of {limit:.2} core h")
                }
                _ => {
                    let [used, limit] =
                        ["used_gb", "limit_gb"].map(|name| number(name).unwrap_or(0.0));
                    format!("your files take {used:.2} GB of {limit:.2} GB")
                }
            };
            ("at a limit", sentence)
        }
        _ if word("outcome") == "cancelled" => ("cancelled", format!("{job} was cancelled")),
        _ => ("succeeded", format!("{job} has succeeded")),
    }
}

/// Why it did not succeed, where that is known.
fn why(event: &DueEvent) -> String {
    let reason = event.about["reason"].as_str().unwrap_or("");
    match event.event.as_str() {
        "failed" | "quarantined" if !reason.is_empty() => {
            format!(": {}", plain(reason, LONGEST_REASON))
        }
        _ => String::new(),
    }
}

/// Where to look at it.
fn link(event: &DueEvent, address: &str) -> String {
    let id = |name: &str| event.about[name].as_str().map(str::to_owned);
    match (id("job"), id("comparison"), id("project")) {
        (Some(job), ..) => format!("{address}jobs/{job}"),
        (_, Some(comparison), _) => format!("{address}compare/{comparison}"),
        (.., Some(project)) => format!("{address}?project={project}"),
        _ => format!("{address}account"),
    }
}

/// A text that begins no line and no header of its own.
fn plain(text: &str, longest: usize) -> String {
    let seen = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    seen.take(longest).collect()
}

#[cfg(test)]
mod tests {
    use loadframe_api::Timestamp;
    use serde_json::json;

    use super::*;

    fn due(events: Vec<DueEvent>) -> Due {
        Due::of_mail("anna@example.org", "secret", events)
    }

    fn ended(number: i64, name: &str, outcome: &str) -> DueEvent {
        DueEvent {
            number,
            event: if outcome == "failed" {
                "failed"
            } else {
                "ended"
            }
            .to_owned(),
            at: Timestamp(0),
            about: json!({ "job": "7", "name": name, "outcome": outcome, "reason": "no\nequilibrium" }),
        }
    }

    #[test]
    fn one_event_is_a_sentence_and_many_are_counted() {
        let one = digest(&due(vec![ended(1, "Strip 3", "failed")]), "https://lab/");
        assert_eq!(one.subject, "loadframe: Strip 3 has failed");
        assert!(
            one.text
                .contains("Strip 3 has failed: no equilibrium\n  https://lab/jobs/7\n"),
            "{}",
            one.text
        );
        let many = (0..30).map(|n| ended(n, "s", if n < 2 { "failed" } else { "succeeded" }));
        let many = digest(&due(many.collect()), "https://lab/");
        assert_eq!(many.subject, "loadframe: 2 failed, 28 succeeded");
        assert_eq!(many.text.matches("https://lab/jobs/").count(), NAMED);
        assert!(many.text.contains("… and 10 more."), "{}", many.text);
    }

    #[test]
    fn a_limit_is_that_of_files_or_of_queued_jobs() {
        let quota = |about| DueEvent {
            number: 1,
            event: "quota".to_owned(),
            at: Timestamp(0),
            about,
        };
        for (about, words) in [
            (
                json!({ "person": "Anna", "used_gb": 9.5, "limit_gb": 10.0 }),
                "your files take 9.50 GB of 10.00 GB",
            ),
            (
                json!({ "person": "Anna", "used_core_h": 95.0, "limit_core_h": 100.0 }),
                "your queued jobs take 95.00 of 100.00 core h",
            ),
        ] {
            let mail = digest(&due(vec![quota(about)]), "https://lab/");
            assert!(mail.text.contains(words), "{}", mail.text);
        }
    }

    #[test]
    fn a_name_begins_no_header() {
        let written = digest(
            &due(vec![ended(1, "a\r\nBcc: b@c.org", "failed")]),
            "https://lab/",
        );
        assert!(
            !written.subject.contains(['\r', '\n']),
            "{}",
            written.subject
        );
        assert!(!written.text.contains("\nBcc"), "{}", written.text);
    }
}
