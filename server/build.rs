//! Gives the service the commit it was built from: `LOADFRAME_COMMIT`, else what git or its files say, else a
//! hash of the sources. Checkpoints are told apart by it, so that no two builds may be called the same.
use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What decides what is computed, from this folder.
const SOURCES: [&str; 4] = ["../Cargo.lock", "../api", "../worker", "src"];
/// Digits of a commit that are shown.
const DIGITS: usize = 12;

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
        .or_else(commit_of_files)
        .unwrap_or_else(hash_of_sources);
    println!("cargo::rustc-env=LOADFRAME_COMMIT={commit}");
}

fn commit_of_git() -> Option<String> {
    let answer = Command::new("git")
        .args(["rev-parse", &format!("--short={DIGITS}"), "HEAD"])
        .output()
        .ok()?;
    let commit = String::from_utf8(answer.stdout).ok()?.trim().to_owned();
    (answer.status.success() && !commit.is_empty()).then_some(commit)
}

/// Where git is missing, or the objects of its repository are, as in the context of an image.
fn commit_of_files() -> Option<String> {
    let repository = Path::new("../.git");
    let read = |name: &str| fs::read_to_string(repository.join(name)).ok();
    let head = read("HEAD")?;
    let commit = match head.trim().strip_prefix("ref: ") {
        None => head.trim().to_owned(),
        Some(name) => read(name).or_else(|| {
            let packed = read("packed-refs")?;
            let line = packed.lines().find(|line| line.ends_with(name))?;
            line.split_whitespace().next().map(str::to_owned)
        })?,
    };
    commit.get(..DIGITS).map(str::to_owned)
}

fn hash_of_sources() -> String {
    let mut files = Vec::new();
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
        gather(Path::new(source), &mut files);
    }
    files.sort();
    let mut hash = DefaultHasher::new();
    for file in files {
        hash.write(file.to_string_lossy().as_bytes());
        hash.write(&fs::read(&file).unwrap_or_default());
    }
    format!("sources-{:012x}", hash.finish() >> 16)
}

/// Files of Rust below a path, and the path itself where it is a file.
fn gather(path: &Path, files: &mut Vec<PathBuf>) {
    match fs::read_dir(path) {
        Ok(entries) => {
            for entry in entries.flatten() {
                gather(&entry.path(), files);
            }
        }
        Err(_)
            if path
                .extension()
                .is_some_and(|name| name == "rs" || name == "lock") =>
        {
            files.push(path.to_owned());
        }
        Err(_) => {}
    }
}
