//! `loadframe autoscale slurm` beside a Slurm that is two scripts; on a real one: `tests/slurm`.
use loadframe_tests::{SLOW, SMALL, Server, loadframe, with_seed};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Commands that stand in for Slurm's: what is submitted is listed as waiting from then on.
struct Slurm {
    folder: PathBuf,
}

impl Slurm {
    fn new(folder: &Path, sbatch: &str) -> Self {
        let folder = folder.join("slurm");
        std::fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(
                &path,
                format!("#!/bin/sh\ncd {}\n{text}\n", folder.display()),
            )
            .unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        };
        write("squeue", "cat queue 2>/dev/null || true");
        write("sbatch", sbatch);
        Self { folder }
    }

    /// One that takes everything.
    fn willing(folder: &Path) -> Self {
        // `--array=0-2` are three tasks
        Self::new(
            folder,
            "echo \"$@\" >>lines; cat >script
             last=$(echo \"$@\" | sed 's/.*--array=0-\\([0-9]*\\).*/\\1/')
             for task in $(seq 0 $last); do echo \"7_$task|PENDING|0:00|954M|Priority\" >>queue; done
             echo 7",
        )
    }

    fn autoscale(&self, server: &Server, options: &[&str]) -> Output {
        let path = std::env::var("PATH").unwrap();
        let mut command = loadframe();
        command
            .args(["autoscale", "slurm", "--server", &server.url])
            .args(options)
            .env("PATH", format!("{}:{path}", self.folder.display()));
        command.output().unwrap()
    }

    /// Options of sbatch, a line for each time it was called.
    fn submitted(&self) -> Vec<String> {
        let text = std::fs::read_to_string(self.folder.join("lines")).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn one_allocation_is_asked_for_each_job_that_waits_and_none_twice() {
    let server = Server::start();
    let slurm = Slurm::willing(server.folder());
    let none = slurm.autoscale(&server, &["--once"]);
    assert!(none.status.success(), "{}", text(&none.stderr));
    assert!(slurm.submitted().is_empty());
    for seed in 0..3 {
        // minutes each by the estimate, or one allocation would do for all
        let mut body = with_seed(SLOW, seed);
        body["spec"]["test"]["repeats"] = 4.into();
        server.client.submit(&body);
    }
    let shown = slurm.autoscale(&server, &["--dry-run", "--partition", "long"]);
    let line = text(&shown.stdout);
    assert!(
        line.starts_with("sbatch --parsable --job-name=loadframe --array=0-2"),
        "{line}"
    );
    assert!(
        line.contains("--partition=long") && line.contains(" worker "),
        "{line}"
    );
    assert!(slurm.submitted().is_empty(), "a dry run submits nothing");

    let options = ["--once", "--partition", "long", "--account", "lab"];
    for _ in 0..2 {
        let once = slurm.autoscale(&server, &options);
        assert!(once.status.success(), "{}", text(&once.stderr));
    }
    let lines = slurm.submitted();
    assert_eq!(
        lines.len(),
        1,
        "what is coming is not asked for again: {lines:?}"
    );
    assert!(
        lines[0].contains("--array=0-2") && lines[0].contains("--account=lab"),
        "{lines:?}"
    );
    let script = std::fs::read_to_string(slurm.folder.join("script")).unwrap();
    assert!(script.starts_with("#!/bin/sh\nexec "), "{script}");

    let seen = text(&server.client.get("/v1/allocations").body);
    assert_eq!(seen.matches("PENDING").count(), 3, "{seen}");
}

#[test]
fn three_refusals_in_a_row_end_it_and_everybody_hears_why() {
    let server = Server::start();
    let slurm = Slurm::new(
        server.folder(),
        "echo x >>lines; echo 'sbatch: no such account' >&2; exit 1",
    );
    server.client.submit(&with_seed(SMALL, 1));
    let refused = slurm.autoscale(&server, &["--every", "0.05"]);
    assert_eq!(refused.status.code(), Some(1));
    let said = text(&refused.stderr);
    assert!(
        said.contains("3 times in a row") && said.contains("no such account"),
        "{said}"
    );
    assert_eq!(slurm.submitted().len(), 3);
    let seen = text(&server.client.get("/v1/allocations").body);
    assert!(seen.contains("no such account"), "{seen}");
}
