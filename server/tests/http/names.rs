//! Names of result files: which are taken, and that every reader of archives unpacks an archive into its own
//! folder.
#![allow(clippy::print_stderr, reason = "a reader that is not there is told of")]
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use loadframe_api::sha256_hex;
use loadframe_server::store::StoreError;
use tempfile::TempDir;

use crate::support::{Lab, key};

/// Names that some file system, archive or reader takes for something else.
fn bad_names() -> Vec<String> {
    let mut names: Vec<String> = [
        "",
        ".",
        "..",
        "../curve.csv",
        "snapshots/../../curve.csv",
        "/etc/passwd",
        "C:\\curve.csv",
        "C:curve.csv",
        "..\\curve.csv",
        "snapshots//a.vtp",
        "snapshots/",
        "./curve.csv",
        ".hidden",
        "curve.csv\0.vtp",
        "curve\n.csv",
        "curve .csv",
        "curve.csv.",
        "snapshots./a.vtp",
        "curve.csv:stream",
        "a\u{202e}vsc.exe",
        "a\u{200f}.csv",
        "e\u{301}.csv",
        "é.csv",
        "~",
        "*",
        "$(id)",
        "<b>.csv",
    ]
    .map(str::to_owned)
    .to_vec();
    names.push("é".repeat(2_000));
    names.push("a".repeat(4_096));
    names.push("a/".repeat(100) + "b");
    // devices of Windows, whatever the case and whatever follows
    for device in ["CON", "prn", "Aux", "NUL", "com1", "LPT9"] {
        names.push(device.to_owned());
        names.push(format!("{device}.csv"));
        names.push(format!("snapshots/{device}.tar.gz"));
        names.push(format!("{device}/a.csv"));
    }
    names
}

#[tokio::test]
async fn a_name_that_means_something_elsewhere_is_refused_with_a_sentence() {
    let lab = Lab::open().await;
    lab.submit().await;
    let lease = lab.claim().await;
    let put = async |name: &str| {
        let sha256 = sha256_hex(b"x");
        lab.store
            .upload(key(&lease), name, &sha256, &b"x"[..])
            .await
    };
    for name in bad_names() {
        match put(&name).await {
            Err(StoreError::Invalid(sentence)) => {
                assert!(sentence.contains("a file name is"), "{name:?}: {sentence}");
            }
            other => panic!("{name:?}: {other:?}"),
        }
        // and whoever asks for it gets what everybody gets for a file that is not there
        let path: String = name.bytes().map(|byte| format!("%{byte:02x}")).collect();
        let path = format!("/v1/jobs/{}/files/{path}", lease.job_id);
        let answer = lab.get(&path).await;
        assert!(
            matches!(answer.status, 400 | 404 | 414),
            "{name:?}: {answer:?}"
        );
    }
    for name in [
        "console.csv",
        "com.csv",
        "com10",
        "snapshots/a.con",
        "A-b_c.1",
    ] {
        put(name)
            .await
            .unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[tokio::test]
async fn names_that_differ_by_case_alone_are_no_result() {
    let lab = Lab::open().await;
    lab.submit().await;
    let lease = lab.claim().await;
    let mut request = loadframe_api::worker::CompleteRequest {
        outcome: crate::outcome::outcome(&lease, &[]),
        files: Vec::new(),
    };
    let text = serde_json::to_vec(&request.outcome).expect("JSON");
    for (name, bytes) in [
        ("outcome.json", &text[..]),
        ("curve.csv", b"1"),
        ("Curve.csv", b"2"),
    ] {
        let sha256 = sha256_hex(bytes);
        let uploaded = lab.store.upload(key(&lease), name, &sha256, bytes).await;
        request.files.push(uploaded.expect("the lease is held"));
    }
    match lab.store.complete(key(&lease), &request).await {
        Err(StoreError::Invalid(sentence)) => assert_eq!(
            sentence,
            "the files curve.csv and Curve.csv would be one where case does not count"
        ),
        other => panic!("{other:?}"),
    }
    request.files.pop();
    let completed = lab.store.complete(key(&lease), &request).await;
    completed.expect("the lease is held");
}

/// Files below a folder, by their names in it.
fn unpacked(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).expect("a folder") {
            let path = entry.expect("an entry").path();
            let kind = std::fs::symlink_metadata(&path)
                .expect("an entry")
                .file_type();
            assert!(!kind.is_symlink(), "{path:?}");
            if kind.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).expect("within").to_str();
            let bytes = std::fs::read(&path).expect("a file");
            found.insert(name.expect("text").to_owned(), bytes);
        }
    }
    found
}

/// How a reader is told to unpack an archive into the folder it is in.
type Reader = fn(&Path) -> Command;
const READERS: [(&str, Reader); 4] = [
    ("python3", |archive| {
        let mut command = Command::new("python3");
        let program = "import sys, zipfile\nwith zipfile.ZipFile(sys.argv[1]) as of:\n    assert of.testzip() is None\n    of.extractall()";
        command.args(["-c", program]).arg(archive);
        command
    }),
    ("unzip", |archive| {
        let mut command = Command::new("unzip");
        command.arg("-q").arg(archive);
        command
    }),
    ("7z", |archive| {
        let mut command = Command::new("7z");
        command.args(["x", "-bd"]).arg(archive);
        command
    }),
    ("7zz", |archive| {
        let mut command = Command::new("7zz");
        command.args(["x", "-bd"]).arg(archive);
        command
    }),
];

#[tokio::test]
async fn every_reader_of_archives_unpacks_the_same_files_into_one_folder() {
    let long = format!("{}.csv", "n".repeat(196));
    let deep = "d/".repeat(99) + "e";
    let files: [(&str, &[u8]); 5] = [
        ("curve.csv", b"strain,force_n\n0,1\n"),
        ("snapshots/step_00010.vtp", b"<?xml"),
        ("empty.csv", b""),
        (&long, b"long"),
        (&deep, b"deep"),
    ];
    let lab = Lab::open().await;
    let mut job: serde_json::Value = serde_json::from_str(crate::support::example()).expect("JSON");
    // what its folder is named for
    job["name"] = "../../CON: \u{202e}gnp.exe".into();
    let submitted = lab.post("/v1/jobs", &job.to_string()).await;
    assert_eq!(submitted.status, 201, "{submitted:?}");
    let id = crate::people::group::id_of(&submitted.json());
    lab.finish(id, &files).await;
    let answer = lab.get(&format!("/v1/jobs/{id}/archive.zip")).await;
    assert_eq!(answer.status, 200);
    let mut readers = 0;
    for (name, reader) in READERS {
        let outer = TempDir::new().expect("a folder");
        let inner: PathBuf = outer.path().join("a/b/c");
        std::fs::create_dir_all(&inner).expect("folders");
        let archive = outer.path().join("archive.zip");
        std::fs::write(&archive, &answer.body).expect("written");
        let done = match reader(&archive).current_dir(&inner).output() {
            Ok(done) => done,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                eprintln!("{name} is not on this machine and was not asked");
                continue;
            }
            Err(error) => panic!("{name}: {error}"),
        };
        assert!(done.status.success(), "{name}: {done:?}");
        std::fs::remove_file(&archive).expect("it is there");
        let found = unpacked(outer.path());
        let folder = found.keys().next().expect("a file").clone();
        let folder = folder.strip_prefix("a/b/c/").expect("in its folder");
        let (folder, _) = folder.split_once('/').expect("a folder of the job");
        assert!(
            !folder.starts_with('.') && !folder.contains("CON"),
            "{folder}"
        );
        for (file, bytes) in files {
            let place = format!("a/b/c/{folder}/{file}");
            let there = found.get(&place).map(Vec::as_slice);
            assert_eq!(there, Some(bytes), "{name}: {file}");
        }
        // and `outcome.json`, and nothing anywhere else
        assert_eq!(found.len(), files.len() + 1, "{name}: {:?}", found.keys());
        readers += 1;
    }
    assert!(readers > 0, "no reader of archives is on this machine");
}
