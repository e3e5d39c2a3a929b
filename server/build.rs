//! Gives the service the commit it was built from: `LOADFRAME_COMMIT`, else what git says.
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=LOADFRAME_COMMIT");
    println!("cargo::rerun-if-changed=build.rs");
    // the log of HEAD grows with every commit and checkout; a missing path would rebuild always
    if Path::new("../.git/logs/HEAD").exists() {
        println!("cargo::rerun-if-changed=../.git/logs/HEAD");
    }
    // a new text of the guide is built in; debug builds read the folder itself
    if std::env::var("PROFILE").is_ok_and(|profile| profile == "release") {
        println!("cargo::rerun-if-changed=guide");
    }
    let commit = std::env::var("LOADFRAME_COMMIT")
        .ok()
        .filter(|commit| !commit.is_empty())
        .or_else(commit_of_git)
        .unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=LOADFRAME_COMMIT={commit}");
}

fn commit_of_git() -> Option<String> {
    let answer = Command::new("git")
        .args(["rev-parse", "--short=12", "HEAD"])
        .output()
        .ok()?;
    let commit = String::from_utf8(answer.stdout).ok()?.trim().to_owned();
    (answer.status.success() && !commit.is_empty()).then_some(commit)
}
