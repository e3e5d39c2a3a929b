//! The commands that the guide shows.
use std::collections::BTreeMap;
use std::path::PathBuf;

use super::{root, texts};

/// The commands that guide and README show, each in a line: blocks for a shell, and code in a line.
fn commands() -> Vec<(PathBuf, String)> {
    let mut commands = Vec::new();
    for path in texts() {
        let text = std::fs::read_to_string(&path).expect("a text");
        let mut in_block = false;
        for line in text.lines() {
            if line.starts_with("```") {
                in_block = !in_block;
                continue;
            }
            let codes: Vec<&str> = match in_block {
                true => vec![line],
                false => line.split('`').skip(1).step_by(2).collect(),
            };
            for code in codes {
                let code = code.split(" #").next().unwrap_or("");
                // other variables and a way through cargo may stand before it
                let call = code.split_once("loadframe ").filter(|(before, _)| {
                    before.is_empty() || before.ends_with(' ') && before.contains('=')
                });
                if let Some((_, call)) = call {
                    commands.push((path.clone(), call.to_owned()));
                }
            }
        }
    }
    commands
}

#[test]
fn every_command_shown_is_one_that_can_be_given() {
    let mut helps = BTreeMap::new();
    let mut help_of = |words: &[&str]| -> Option<String> {
        let key = words.join(" ");
        let known = helps.entry(key).or_insert_with(|| {
            let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_loadframe"));
            let output = command
                .args(words)
                .arg("--help")
                .output()
                .expect("the executable");
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            output.status.success().then_some(text)
        });
        known.clone()
    };
    let commands = commands();
    assert!(commands.len() > 30, "{}", commands.len());
    for (path, call) in commands {
        let place = format!("{}: loadframe {call}", path.display());
        let words: Vec<&str> = call.split_whitespace().collect();
        // options of the executable itself, as in `loadframe --help`
        let Some(first) = words.first().filter(|word| !word.starts_with('-')) else {
            continue;
        };
        let has_parts = ["autoscale", "people", "study", "token"].contains(first);
        let parts: Vec<&str> = match (has_parts, words.get(1)) {
            (true, Some(second)) => vec![first, second],
            _ => vec![first],
        };
        let help = help_of(&parts).unwrap_or_else(|| panic!("{place}: there is no such command"));
        for option in words.iter().filter(|word| word.starts_with("--")) {
            let option = option.split('=').next().unwrap_or(option);
            assert!(
                help.contains(&format!("{option} ")) || help.contains(&format!("{option}\n")),
                "{place}: {option}"
            );
        }
        if *first == "example"
            && let Some(name) = words.get(1)
        {
            assert!(loadframe_api::Example::named(name).is_ok(), "{place}");
        }
        if parts == ["study", "parameters"]
            && let Some(file) = words.get(2)
        {
            assert!(root().join(file).exists(), "{place}");
        }
    }
}
