//! A machine that is wrong and not dead: its scratch folder is full, or gone. No job is lost to it.
use loadframe_api::{AttemptEnd, JobOutcome, JobStatus, ReasonCode};
use loadframe_tests::{Server, TINY, Worker, is_sound, until, with_seed};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Jobs that wait when the machine begins to work on them.
const JOBS: u64 = 40;

/// A worker with its scratch folder on a disk that takes no more files, though it has room: one without room
/// says so in its claim and is given nothing. `None`, having said why, where nothing may be mounted.
fn with_full_scratch(server: &Server) -> Option<Worker> {
    let folder = server.folder().join("scratch");
    std::fs::create_dir(&folder).unwrap();
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64m,nr_inodes=64", "tmpfs"])
        .arg(&folder)
        .status();
    if !mounted.is_ok_and(|status| status.success()) {
        eprintln!("not tested: no file system can be mounted here");
        return None;
    }
    let scratch = folder.to_str().unwrap();
    let worker = Worker::start_with(server, &server.url, "sick", &["--scratch", scratch]);
    until("the worker has its folder", || {
        std::fs::read_dir(&folder).unwrap().next().map(|_| ())
    });
    let filled =
        (0..100).find(|number| std::fs::write(folder.join(format!("{number}")), []).is_err());
    filled.expect("a disk that is full");
    Some(worker)
}

fn unmount(server: &Server) {
    let folder = server.folder().join("scratch");
    let _ = Command::new("umount").arg("-l").arg(folder).status();
}

/// The worker's row in the list of workers.
fn listed(server: &Server, name: &str) -> Value {
    let answer = server.client.send("GET", "/v1/workers", &[], b"").unwrap();
    let page: Value = serde_json::from_slice(&answer.body).unwrap();
    let workers = page["items"].as_array().unwrap();
    let found = workers.iter().find(|worker| worker["name"] == name);
    found.cloned().unwrap_or_default()
}

#[test]
fn a_full_scratch_folder_fails_no_job() {
    let server = Server::start();
    let ids: Vec<_> = (0..JOBS)
        .map(|seed| server.client.submit(&with_seed(TINY, seed)))
        .collect();
    let Some(_sick) = with_full_scratch(&server) else {
        return;
    };
    let aside = until("the machine is set aside", || {
        Some(listed(&server, "sick")).filter(|worker| !worker["set_aside"].is_null())
    });
    assert_eq!(aside["set_aside"]["code"], "disk", "{aside}");
    let reason = aside["set_aside"]["reason"].as_str().unwrap();
    assert!(reason.contains("No space left on device"), "{reason}");

    let _healthy = Worker::start(&server, "healthy");
    for id in ids {
        let job = until("the job has finished", || {
            let job = server.client.job(id);
            (job.status == JobStatus::Finished).then_some(job)
        });
        is_sound(&job);
        assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
    }
    unmount(&server);
}

#[test]
fn a_scratch_folder_that_was_removed_is_made_anew() {
    let server = Server::start();
    let folder = server.folder().join("tidied");
    let scratch = folder.to_str().unwrap();
    let _worker = Worker::start_with(&server, &server.url, "worker", &["--scratch", scratch]);
    until("the worker has its folder", || {
        // it has started when its folder is locked
        let mut entries = Path::new(&folder).read_dir().ok()?.flatten();
        entries.find(|entry| entry.path().join("lock").exists())
    });
    std::fs::remove_dir_all(&folder).unwrap();
    let id = server.client.submit(&with_seed(TINY, 1));
    let job = until("the job has finished", || {
        let job = server.client.job(id);
        (job.status == JobStatus::Finished).then_some(job)
    });
    assert_eq!(job.outcome, Some(JobOutcome::Succeeded), "{job:#?}");
    assert_eq!(job.attempts.len(), 1, "{job:#?}");
}

#[test]
fn a_scratch_folder_that_cannot_be_made_again_sends_the_job_on() {
    let server = Server::start();
    let folder = server.folder().join("blocked");
    let scratch = folder.to_str().unwrap();
    let _worker = Worker::start_with(&server, &server.url, "worker", &["--scratch", scratch]);
    until("the worker has its folder", || {
        // it has started when its folder is locked
        let mut entries = Path::new(&folder).read_dir().ok()?.flatten();
        entries.find(|entry| entry.path().join("lock").exists())
    });
    std::fs::remove_dir_all(&folder).unwrap();
    // a file in the place of the folder: nothing can be made in it
    std::fs::write(&folder, b"").unwrap();
    let id = server.client.submit(&with_seed(TINY, 1));
    let job = until("the job is handed on", || {
        let job = server.client.job(id);
        (job.reason_code == ReasonCode::WorkerFault).then_some(job)
    });
    assert_eq!(job.attempts[0].end_reason, Some(AttemptEnd::Faulted));
    let _healthy = Worker::start(&server, "healthy");
    until("the job has succeeded elsewhere", || {
        (server.client.job(id).outcome == Some(JobOutcome::Succeeded)).then_some(())
    });
}
