//! A worker that is stopped past its lease and woken again: another has done its job, it is told so
//! and publishes nothing.
use loadframe_api::{JobOutcome, JobStatus};
use loadframe_tests::{
    Chance, Cut, JobFiles, Relay, SMALL, Server, Worker, is_sound, losses, run_alone, until,
    with_seed,
};
use nix::sys::signal::Signal;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Times that the scene is played, each with another moment to stop at.
const ROUNDS: u64 = 5;

#[test]
fn a_worker_woken_after_its_lease_publishes_nothing() {
    let server = Server::start();
    let mut chance = Chance::new("stopped workers");
    let body = with_seed(SMALL, 1);
    let alone = run_alone(&body, 1, &server.folder().join("alone"));
    for round in 0..ROUNDS {
        let refused: Arc<Mutex<Vec<String>>> = Arc::default();
        let seen_refused = Arc::clone(&refused);
        let relay = Relay::start(&server.url, move |seen| {
            if seen.status == Some(409) {
                seen_refused.lock().unwrap().push(seen.request.to_owned());
            }
            Cut::Pass
        });
        let sleeper = Worker::start_through(&server, &relay.url, &format!("sleeper-{round}"));
        let id = loop {
            let id = server.client.submit(&body);
            until("the worker has the job", || {
                let job = server.client.job(id);
                (job.status != JobStatus::Queued).then_some(())
            });
            std::thread::sleep(chance.duration(Duration::from_millis(200)));
            sleeper.process.signal(Signal::SIGSTOP);
            if sleeper.job(&server.client).is_some() {
                break id;
            }
            // too late, it was done; wake up for another one
            sleeper.process.signal(Signal::SIGCONT);
        };
        let mut other = Worker::start(&server, &format!("other-{round}"));
        until("the other worker has done the job", || {
            (server.client.job(id).status == JobStatus::Finished).then_some(())
        });
        let (job, files) = (
            server.client.job(id),
            JobFiles::on_server(&server.client, id),
        );
        is_sound(&job);
        assert_eq!(
            (job.outcome, losses(&job)),
            (Some(JobOutcome::Succeeded), 1),
            "{job:#?}"
        );
        assert_eq!(files, alone);

        sleeper.process.signal(Signal::SIGCONT);
        until("the woken worker is refused", || {
            (!refused.lock().unwrap().is_empty()).then_some(())
        });
        // it gives up that job and is good for others
        other.process.kill();
        let next = server.client.submit(&with_seed(SMALL, 2));
        until("the woken worker has done another job", || {
            (server.client.job(next).status == JobStatus::Finished).then_some(())
        });
        assert_eq!(server.client.job(next).attempts[0].worker, sleeper.name);
        assert_eq!(
            server.client.job(id),
            job,
            "a stale worker changed a finished job"
        );
        assert_eq!(JobFiles::on_server(&server.client, id), files);
    }
}
