//! What happened, in words.
use crate::history::History;
use crate::server::{Answer, Leased, Request};

/// What was asked and answered, in words that are the same whenever the seed is.
pub(crate) fn told(history: &History, request: &Request, answer: &Answer) -> String {
    let asked = match request {
        Request::Claim(_) => "claims".to_owned(),
        Request::Leased(lease, message) => {
            let job = history.name(lease.job_id);
            let word = match message {
                Leased::Heartbeat => "lives",
                Leased::Report(_) => "reports",
                Leased::Upload(name, _) => name,
                Leased::Save(..) => "saves",
                Leased::Fetch => "fetches",
                Leased::Complete(_) => "completes",
                Leased::Fail(_) => "fails",
                Leased::Fault(_) => "is at fault",
                Leased::Release(_) => "releases",
                Leased::ExceedEstimate => "takes too long",
            };
            format!("{word}, {job}, attempt {}", lease.attempt)
        }
        Request::Submit { name, .. } => format!("submits {name}"),
        Request::Ask { job, action } => format!("{action:?} {}", history.name(*job)),
    };
    let answered = match answer {
        Answer::Claimed(Some(lease)) => {
            let job = history.name(lease.job_id);
            format!("{job}, attempt {}", lease.attempt)
        }
        Answer::Claimed(None) => "nothing".to_owned(),
        Answer::Command(command) => format!("{command:?}"),
        Answer::Done => "done".to_owned(),
        Answer::Checkpoint(found) => format!("found: {}", found.is_some()),
        Answer::LeaseLost => "lease lost".to_owned(),
        Answer::Job(job) => format!("{:?} {:?}", job.status, job.outcome),
        Answer::Conflict => "conflict".to_owned(),
    };
    format!("{asked}: {answered}")
}
