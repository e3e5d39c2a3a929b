//! The commands of the shell against a server: submit, watch, fetch, cancel, and their exit codes.
use loadframe_api::{JobOutcome, JobStatus};
use loadframe_tests::{
    JobFiles, LONG, SLOW, SMALL, Server, TINY, Worker, loadframe, run_alone, until, with_seed,
};
use serde_json::Value;
use std::process::Output;

fn shell(server: &Server, arguments: &[&str]) -> Output {
    let mut command = loadframe();
    command.args(arguments).env("LOADFRAME_SERVER", &server.url);
    command.output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn text(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

#[test]
fn submit_watch_and_fetch_bring_home_what_run_gives() {
    let server = Server::start();
    let _worker = Worker::start(&server, "worker");
    let body = with_seed(SMALL, 1);
    let alone = run_alone(&body, 1, &server.folder().join("alone"));
    let spec = server.folder().join("alone.json");
    let submitted = shell(&server, &["submit", spec.to_str().unwrap(), "--json"]);
    assert_eq!(code(&submitted), 0, "{}", text(&submitted));
    let job: Value = serde_json::from_slice(&submitted.stdout).unwrap();
    let id = job["id"].as_str().unwrap();
    let watched = shell(&server, &["watch", id]);
    assert_eq!(code(&watched), 0, "{}", text(&watched));
    let folder = server.folder().join("fetched");
    let out = folder.to_str().unwrap();
    let fetched = shell(&server, &["fetch", id, "--out", out]);
    assert_eq!(code(&fetched), 0, "{}", text(&fetched));
    assert_eq!(JobFiles::in_folder(&folder), alone);
    // a damaged file is fetched again, the others are not
    std::fs::write(folder.join("curve.csv"), "damaged").unwrap();
    assert_eq!(code(&shell(&server, &["fetch", id, "--out", out])), 0);
    assert_eq!(JobFiles::in_folder(&folder), alone);
    // nothing is fetched among the files of another result
    let other = server.folder().join("alone");
    let refused = shell(&server, &["fetch", id, "--out", other.to_str().unwrap()]);
    assert_eq!(code(&refused), 2, "{}", text(&refused));
    assert_eq!(JobFiles::in_folder(&other), alone);
    let listed = shell(&server, &["list"]);
    assert!(text(&listed).contains(&id[..8]), "{}", text(&listed));
}

#[test]
fn exit_codes_tell_scripts_how_it_ended() {
    let server = Server::start();
    let folder = server.folder();
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let mut bad = with_seed(SMALL, 1);
    bad["spec"]["bond"]["modulus_n"] = serde_json::json!(-1);
    let bad = file("bad.json", &serde_json::to_string_pretty(&bad).unwrap());
    for command in ["validate", "submit"] {
        let refused = shell(&server, &[command, &bad]);
        assert_eq!(code(&refused), 2, "{}", text(&refused));
        assert!(text(&refused).contains("modulus_n"), "{}", text(&refused));
    }
    assert!(server.client.jobs("").is_empty());
    let slow = file("slow.json", &with_seed(SLOW, 1).to_string());
    assert_eq!(code(&shell(&server, &["validate", &slow])), 0);
    let submitted = shell(&server, &["submit", &slow, "--json"]);
    let job: Value = serde_json::from_slice(&submitted.stdout).unwrap();
    let id = job["id"].as_str().unwrap();
    assert_eq!(code(&shell(&server, &["cancel", id])), 0);
    assert_eq!(code(&shell(&server, &["watch", id])), 4);
    let unknown = "00000000-0000-4000-8000-000000000000";
    assert_eq!(code(&shell(&server, &["watch", unknown])), 1);
    let nobody = ["list", "--server", "http://127.0.0.1:1"];
    assert_eq!(code(&shell(&server, &nobody)), 3);
}

#[test]
fn examples_are_printed_by_their_own_name_and_a_misspelt_one_is_guessed() {
    let example = |name: &str| {
        let mut command = loadframe();
        command.args(["example", name]).output().unwrap()
    };
    for (asked, job) in [
        ("granular_scene", "A sphere falls on another"),
        ("granular_scene_hopper", "hopper"),
    ] {
        let printed = example(asked);
        assert_eq!(code(&printed), 0, "{}", text(&printed));
        let body: Value = serde_json::from_slice(&printed.stdout).unwrap();
        assert_eq!(body["kind"], "granular_scene");
        assert!(text(&printed).contains(job), "{}", text(&printed));
    }
    let refused = example("granular_scene_hoper");
    assert_eq!(code(&refused), 2, "{}", text(&refused));
    for said in ["did you mean \"granular_scene_hopper\"", "\n  calibrate, "] {
        assert!(text(&refused).contains(said), "{}", text(&refused));
    }
}

#[test]
fn what_memory_cannot_hold_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("large.json");
    // ten million steps of a thousand specimens are kept until the end: about 450 GB
    let mut body = with_seed(SMALL, 1);
    body["spec"]["test"] = serde_json::json!({
        "strain_step": 3e-7, "max_strain": 3.0, "repeats": 1000});
    std::fs::write(&spec, body.to_string()).unwrap();
    let out = folder.path().join("results");
    let mut command = loadframe();
    command.arg("run").arg(&spec).arg("--out").arg(&out);
    let refused = command.output().unwrap();
    assert_eq!(code(&refused), 2, "{}", text(&refused));
    // how much is free is the machine's, gigabytes or less
    for said in ["GB of memory", "B free", "--even-if-large"] {
        assert!(text(&refused).contains(said), "{}", text(&refused));
    }
    assert!(!out.exists());
}

#[test]
fn a_run_interrupted_by_sigint_goes_on_where_it_was() {
    let server = Server::start();
    let body = with_seed(LONG, 1);
    let alone = run_alone(&body, 1, &server.folder().join("alone"));
    let folder = server.folder().join("interrupted");
    let run = || {
        let mut command = loadframe();
        command.arg("run").arg(server.folder().join("alone.json"));
        command.arg("--out").arg(&folder).args(["--threads", "1"]);
        command
    };
    let mut process = loadframe_tests::Process::start(run(), server.folder().join("run.log"));
    until("the run has begun", || folder.is_dir().then_some(()));
    std::thread::sleep(std::time::Duration::from_millis(200));
    process.signal(nix::sys::signal::Signal::SIGINT);
    let status = until("the run has ended", || process.ended());
    assert_eq!(
        status.code(),
        Some(5),
        "interrupted, or done too early to be"
    );
    let output = run().output().unwrap();
    assert!(output.status.success(), "{}", text(&output));
    assert_eq!(JobFiles::in_folder(&folder), alone);
}

#[test]
fn a_study_tells_what_exactness_costs_and_refuses_knobs_there_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("spec.json");
    std::fs::write(&spec, with_seed(TINY, 1).to_string()).unwrap();
    let study = |more: &[&str]| {
        let mut command = loadframe();
        command.args(["study", "accuracy"]).arg(&spec).args(more);
        let out = folder.path().join("study");
        command.arg("--out").arg(out).output().unwrap()
    };
    let refused = study(&["--knob", "magic=1"]);
    assert_eq!(code(&refused), 2, "{}", text(&refused));
    let known = "force_accuracy, solver, strain_step, break_precision, breaking, size";
    assert!(text(&refused).contains(known), "{}", text(&refused));
    assert!(!folder.path().join("study").exists());
    let told = study(&["--knob", "force_accuracy=5,50", "--seeds", "2"]);
    assert_eq!(code(&told), 0, "{}", text(&told));
    assert!(text(&told).contains("reference"), "{}", text(&told));
    for name in ["accuracy.csv", "accuracy.json", "accuracy.svg"] {
        assert!(folder.path().join("study").join(name).is_file(), "{name}");
    }
    let again = study(&["--knob", "force_accuracy=5,50", "--seeds", "2", "--json"]);
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["knobs"][0]["rows"].as_array().unwrap().len(), 4);
}

#[test]
fn a_study_of_parameters_shows_what_they_do_and_refuses_cases_that_cannot_be_run() {
    let folder = tempfile::tempdir().unwrap();
    let studies = concat!(env!("CARGO_MANIFEST_DIR"), "/../api/studies");
    let out = folder.path().join("study");
    let study = |file: &std::path::Path, more: &[&str]| {
        let mut command = loadframe();
        command.args(["study", "parameters"]).arg(file).args(more);
        command.arg("--out").arg(&out).output().unwrap()
    };
    let bad = folder.path().join("bad.json");
    let cases = r#"{"title": "Steps", "example": "nonwoven_tensile_quick",
        "vary": {"/test/strain_step": [0.02, 7]}}"#;
    std::fs::write(&bad, cases).unwrap();
    let refused = study(&bad, &[]);
    assert_eq!(code(&refused), 2, "{}", text(&refused));
    for said in ["line 2", "case \"strain_step = 7\"", "given 7", "allowed: "] {
        let told = text(&refused);
        assert!(told.contains(said), "{said} in {told}");
    }
    assert!(!out.exists());

    let strengths = std::path::Path::new(studies).join("nonwoven_strength_scatter.json");
    let told = study(&strengths, &["--seeds", "3"]);
    assert_eq!(code(&told), 0, "{}", text(&told));
    let finding = "Max force falls from case to case: 0.05 (";
    assert!(text(&told).contains(finding), "{}", text(&told));
    for name in ["csv", "json", "md", "svg"] {
        assert!(out.join(format!("parameters.{name}")).is_file(), "{name}");
    }

    // in the same folder: tests of other studies are left alone
    let friction = std::path::Path::new(studies).join("granular_friction.json");
    let told = study(&friction, &["--json", "--threads", "2"]);
    assert_eq!(code(&told), 0, "{}", text(&told));
    let told: Value = serde_json::from_slice(&told.stdout).unwrap();
    let finding = &told["findings"]["coordination_number"];
    assert_eq!(finding["trend"], "falls", "{finding}");
    assert!(finding["ends"]["p"].as_f64().unwrap() < 1e-3, "{finding}");
}

#[test]
fn a_lab_brings_its_own_workers() {
    let server = Server::start();
    let mut command = loadframe();
    let data = server.folder().join("lab");
    command
        .args(["lab", "--listen", "127.0.0.1:0", "--data"])
        .arg(data);
    let lab = loadframe_tests::Process::start(command, server.folder().join("lab.log"));
    let url = until("the lab tells its address", || {
        let log = std::fs::read_to_string(server.folder().join("lab.log")).unwrap_or_default();
        let start = log.find("http://127.0.0.1:")?;
        log[start..].split_whitespace().next().map(str::to_owned)
    });
    let client = loadframe_tests::Client::new(&url);
    let answers = || {
        client
            .send("GET", "/readyz", &[], b"")
            .ok()
            .filter(|answer| answer.status == 200)
    };
    until("the lab is ready", answers);
    let id = client.submit(&with_seed(SMALL, 1));
    let job = until("a worker of the lab has done the job", || {
        let job = client.job(id);
        (job.status == JobStatus::Finished).then_some(job)
    });
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded));
    let mut lab = lab;
    lab.signal(nix::sys::signal::Signal::SIGTERM);
    let status = until("the lab has ended", || lab.ended());
    assert!(status.success(), "{status}");
}
