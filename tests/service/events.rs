//! Server-sent events: everything arrives in order, and after a break nothing is missed.
use loadframe_api::{Event, JobStatus};
use loadframe_tests::{SMALL, Server, TINY, Worker, until, with_seed};
use std::io::{BufRead, BufReader};
use uuid::Uuid;

/// An event with its number.
type Numbered = (u64, Event);

/// A stream of events from `path`.
struct Stream(Box<dyn BufRead>);

impl Stream {
    fn open(server: &Server, path: &str, last: Option<u64>) -> Self {
        let last = last.map(|number| number.to_string());
        let mut headers = vec![("accept", "text/event-stream")];
        headers.extend(last.as_deref().map(|number| ("last-event-id", number)));
        let (answer, body) = server.client.open(path, &headers);
        assert_eq!(
            (answer.status, &*answer.content_type),
            (200, "text/event-stream"),
            "{answer}"
        );
        Self(Box::new(BufReader::new(body)))
    }

    /// The next event.
    fn next(&mut self) -> Numbered {
        let (mut number, mut name, mut data) = (None, None, String::new());
        loop {
            let mut line = String::new();
            assert!(self.0.read_line(&mut line).unwrap() > 0, "the stream ended");
            let line = line.trim_end();
            if let Some(text) = line.strip_prefix("id:") {
                number = Some(text.trim().parse().unwrap());
            } else if let Some(text) = line.strip_prefix("event:") {
                name = Some(text.trim().to_owned());
            } else if let Some(text) = line.strip_prefix("data:") {
                data.push_str(text.trim_start());
            } else if let (true, Some(name)) = (line.is_empty(), &name) {
                let data: serde_json::Value = serde_json::from_str(&data).unwrap();
                let event = serde_json::json!({"event": name, "data": data});
                return (number.unwrap(), serde_json::from_value(event).unwrap());
            }
        }
    }

    /// Events up to the one that ends the job `id`.
    fn until_finished(&mut self, id: Uuid) -> Vec<Numbered> {
        let mut events = Vec::new();
        loop {
            let (number, event) = self.next();
            let is_end = matches!(&event, Event::Job(job) if job.id == id && job.status == JobStatus::Finished);
            events.push((number, event));
            if is_end {
                return events;
            }
        }
    }
}

#[test]
fn a_stream_tells_the_life_of_a_job_in_order() {
    let server = Server::start();
    let id = server.client.submit(&with_seed(SMALL, 1));
    let mut stream = Stream::open(&server, &format!("/v1/jobs/{id}/events"), None);
    let _worker = Worker::start(&server, "worker");
    let events = stream.until_finished(id);
    assert!(
        events.windows(2).all(|pair| pair[0].0 < pair[1].0),
        "numbers grow"
    );
    let mut statuses: Vec<JobStatus> = Vec::new();
    let (mut progress, mut points) = (0.0, 0);
    for (_, event) in &events {
        assert_eq!(event.job_id(), id);
        match event {
            Event::Job(job) => {
                if statuses.last() != Some(&job.status) {
                    statuses.push(job.status);
                }
            }
            Event::Progress(now) => {
                assert!(now.progress >= progress, "progress fell to {now:?}");
                progress = now.progress;
            }
            Event::Points(ready) => {
                assert!(ready.total >= points, "points were lost: {ready:?}");
                points = ready.total;
            }
            Event::Deleted(_) => panic!("nobody deleted it"),
        }
    }
    // several changes that a reader comes late to are told as one
    let order = [JobStatus::Queued, JobStatus::Running, JobStatus::Finished];
    let places = statuses
        .iter()
        .map(|status| order.iter().position(|one| one == status).unwrap());
    assert!(places.is_sorted(), "{statuses:?}");
    assert_eq!(statuses.first(), Some(&JobStatus::Queued));
    let curve: loadframe_api::CurveView = server.client.get(&format!("/v1/jobs/{id}/curve")).json();
    assert!(curve.complete);
    assert_eq!(
        points,
        curve.points.len() as u64,
        "the last event tells of the last point"
    );
}

#[test]
fn after_a_break_the_stream_goes_on_where_it_was_even_over_a_restart() {
    let mut server = Server::start();
    let mut worker = Worker::start(&server, "worker");
    let id = server.client.submit(&with_seed(TINY, 1));
    let path = format!("/v1/jobs/{id}/events");
    let whole = Stream::open(&server, &path, Some(0)).until_finished(id);
    assert!(whole.len() >= 2, "{whole:?}");
    worker.process.kill();
    server.process.kill();
    server.restart();
    server.wait_until_ready();
    let numbers: Vec<u64> = whole.iter().map(|(number, _)| *number).collect();
    for (position, number) in numbers.iter().enumerate().take(numbers.len() - 1) {
        let rest = Stream::open(&server, &path, Some(*number)).until_finished(id);
        // of several changes of the job itself the last one tells all; everything else is repeated
        assert_eq!(rest.last(), whole.last(), "after event {number}");
        let repeated: Vec<u64> = rest.iter().map(|(number, _)| *number).collect();
        assert!(
            repeated.is_sorted() && repeated[0] > *number,
            "{repeated:?} after {number}"
        );
        let is_points = |event: &&Numbered| matches!(event.1, Event::Points(_));
        let points =
            |events: &[Numbered]| events.iter().filter(is_points).cloned().collect::<Vec<_>>();
        assert_eq!(points(&rest).last(), points(&whole[position + 1..]).last());
    }
}

#[test]
fn one_stream_follows_several_jobs_and_tells_of_their_end() {
    let server = Server::start();
    let ids = [1, 2].map(|seed| server.client.submit(&with_seed(TINY, seed)));
    let other = server.client.submit(&with_seed(TINY, 3));
    let path = format!("/v1/events?jobs={},{}", ids[0], ids[1]);
    let mut stream = Stream::open(&server, &path, None);
    let _worker = Worker::start(&server, "worker");
    until("the jobs are done", || {
        let done = |id: &Uuid| server.client.job(*id).status == JobStatus::Finished;
        (ids.iter().all(done) && done(&other)).then_some(())
    });
    for id in ids {
        let answer = server
            .client
            .send("DELETE", &format!("/v1/jobs/{id}"), &[], b"")
            .unwrap();
        assert_eq!(answer.status, 204, "{answer}");
    }
    let mut deleted = Vec::new();
    while deleted.len() < ids.len() {
        let (_, event) = stream.next();
        assert!(ids.contains(&event.job_id()), "{event:?} was not asked for");
        if let Event::Deleted(gone) = event {
            deleted.push(gone.job_id);
        }
    }
    assert_eq!(deleted, ids);
}
