//! `loadframe submit`
use std::time::{Duration, Instant};

use backon::{ConstantBuilder, Retryable};
use clap::Args;
use loadframe_api::{JobView, Problem};
use loadframe_client::{ServerClient, ServerError};
use reqwest::{Method, header};
use uuid::Uuid;

use super::connection::Connection;
use super::failure::{Code, Failure};
use super::follow::{conclude, follow};
use super::source::{Source, SpecArgument};
use super::terminal::{print_json, print_line};

/// A server that restarts is waited for: so many tries, so far apart.
const TRIES: usize = 10;
const PAUSE: Duration = Duration::from_millis(500);
/// Who sits before it is told after so long, whatever pauses the server asks for.
const LONGEST: Duration = Duration::from_secs(30);

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    spec: SpecArgument,
    /// Follow the job to its end and print its results
    #[arg(long)]
    watch: bool,
    /// Your name for this submission: the same key with the same spec is the same job
    #[arg(long, value_name = "KEY")]
    idempotency_key: Option<String>,
    /// Print the job as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let source = arguments.spec.read()?;
    let server = arguments.connection.client()?;
    let job = submit(&server, &source.text, arguments.idempotency_key.as_deref()).await;
    let job = job.map_err(|error| refusal(error, &source))?;
    if arguments.watch {
        let job = follow(&server, job.id).await?;
        return conclude(&server, &job, arguments.json).await;
    }
    if arguments.json {
        return print_json(&job);
    }
    print_line(&format!("{}  {}", job.id, job.name));
    print_line(&format!("{}{}", server.address(), job.links.page));
    Ok(())
}

/// Submits the job in `text`; it is there once even if an answer is lost and the job sent again.
pub(crate) async fn submit(
    server: &ServerClient,
    text: &[u8],
    key: Option<&str>,
) -> Result<JobView, ServerError> {
    let key = key.map_or_else(|| Uuid::new_v4().to_string(), str::to_owned);
    let send = || {
        let request = server.request(Method::POST, "/v1/jobs");
        let request = request
            .header(header::CONTENT_TYPE, "application/json")
            .header("idempotency-key", &key)
            .body(text.to_vec());
        server.json(request)
    };
    let pauses = ConstantBuilder::default()
        .with_delay(PAUSE)
        .with_max_times(TRIES);
    // nothing listens: more likely the wrong address than a restart, and people should not wait
    let is_passing = |error: &ServerError| {
        matches!(
            error,
            ServerError::Unavailable { .. } | ServerError::Gateway { .. }
        )
    };
    let begin = Instant::now();
    let within = |pause: &Duration| begin.elapsed() + *pause <= LONGEST;
    send.retry(pauses)
        .when(is_passing)
        .adjust(|error: &ServerError, pause| pause.map(|own| error.pause(own)).filter(within))
        .await
}

/// The server's refusal, with the lines of what it refuses.
fn refusal(error: ServerError, source: &Source) -> Failure {
    match error {
        ServerError::Refused(Problem { violations, .. }) if !violations.is_empty() => {
            Failure::new(Code::Usage, source.findings(&violations))
        }
        error => error.into(),
    }
}
