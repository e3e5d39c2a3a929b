//! What a job left behind, in a form that two runs can be compared by.
use crate::Client;
use loadframe_api::{FileEntry, sha256_hex};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use uuid::Uuid;

/// The result files of a job: equal when two runs gave the same bytes. What a run may say
/// differently is left out: its log, and in `outcome.json` the cost, host, threads and time.
#[derive(Clone, PartialEq)]
pub struct JobFiles {
    /// SHA-256 by name.
    pub sums: BTreeMap<String, String>,
    pub outcome: Value,
}

const LOG: &str = "log.jsonl";
const OUTCOME: &str = "outcome.json";

impl JobFiles {
    /// Reads what `loadframe run --out` or `fetch --out` wrote.
    pub fn in_folder(folder: &Path) -> Self {
        let mut sums = BTreeMap::new();
        collect(folder, "", &mut sums);
        let outcome = std::fs::read(folder.join(OUTCOME)).unwrap();
        Self::new(sums, serde_json::from_slice(&outcome).unwrap())
    }

    /// Downloads every file of a job and holds it against the size and sum the server states.
    pub fn on_server(client: &Client, id: Uuid) -> Self {
        let job = format!("/v1/jobs/{id}");
        let listed: Vec<FileEntry> = {
            let answer: Value = client.get(&format!("{job}/files")).json();
            serde_json::from_value(answer["items"].clone()).unwrap()
        };
        let mut sums = BTreeMap::new();
        for file in listed {
            let answer = client.get(&format!("{job}/files/{}", file.name));
            assert_eq!(answer.status, 200, "{}: {answer}", file.name);
            assert_eq!(answer.body.len() as u64, file.bytes, "{}", file.name);
            assert_eq!(sha256_hex(&answer.body), file.sha256, "{}", file.name);
            sums.insert(file.name, file.sha256);
        }
        assert!(sums.contains_key(OUTCOME), "{sums:?}");
        Self::new(sums, client.get(&format!("{job}/outcome")).json())
    }

    fn new(mut sums: BTreeMap<String, String>, mut outcome: Value) -> Self {
        sums.remove(LOG);
        sums.remove(OUTCOME);
        let fields = outcome.as_object_mut().unwrap();
        fields.remove("cost");
        for own in ["host", "threads", "started_at"] {
            fields["provenance"].as_object_mut().unwrap().remove(own);
        }
        let files = fields["files"].as_array_mut().unwrap();
        files.retain(|file| file["name"] != LOG);
        Self { sums, outcome }
    }
}

fn collect(folder: &Path, prefix: &str, sums: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        if entry.file_type().unwrap().is_dir() {
            collect(&entry.path(), &format!("{name}/"), sums);
        } else {
            sums.insert(name, sha256_hex(&std::fs::read(entry.path()).unwrap()));
        }
    }
}

impl std::fmt::Debug for JobFiles {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (name, sum) in &self.sums {
            writeln!(f, "{} {name}", &sum[..8])?;
        }
        write!(f, "{}", self.outcome)
    }
}
