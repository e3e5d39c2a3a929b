//! REST from a test.
use loadframe_api::{JobView, Page};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::io::Read;
use std::time::Duration;
use ureq::http::{Request, Response};
use ureq::{Agent, Body};
use uuid::Uuid;

/// Speaks to one server.
#[derive(Clone, Debug)]
pub struct Client {
    agent: Agent,
    url: String,
}

/// What a server answered.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub content_type: String,
    pub etag: Option<String>,
    pub body: Vec<u8>,
}

impl Client {
    pub fn new(url: &str) -> Self {
        // beyond the longest claim (30 s), so that only a hang ends here
        const TIMEOUT: Duration = Duration::from_secs(60);
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_global(Some(TIMEOUT))
            // a connection that the server closes just when it is used again would look like a fault of it
            .max_idle_connections(0)
            .max_idle_connections_per_host(0)
            .build();
        Self {
            agent: config.new_agent(),
            url: url.to_owned(),
        }
    }

    /// Sends a request.
    ///
    /// # Errors
    /// When there was no answer: the server is away.
    pub fn send(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: &[u8],
    ) -> Result<Answer, ureq::Error> {
        let mut response = self.respond(method, path, headers, body)?;
        let body = response.body_mut().with_config().limit(u64::MAX);
        Ok(Answer {
            body: body.read_to_vec()?,
            ..Answer::head(&response)
        })
    }

    /// Opens a stream: the answer without its body, and the body to read from.
    pub fn open(&self, path: &str, headers: &[(&str, &str)]) -> (Answer, impl Read + use<>) {
        let response = self.respond("GET", path, headers, b"").unwrap();
        (Answer::head(&response), response.into_body().into_reader())
    }

    fn respond(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: &[u8],
    ) -> Result<Response<Body>, ureq::Error> {
        let mut request = Request::builder()
            .method(method)
            .uri(format!("{}{path}", self.url));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        self.agent.run(request.body(body)?)
    }

    /// POST of JSON.
    pub fn post(&self, path: &str, body: &impl serde::Serialize) -> Answer {
        let body = serde_json::to_vec(body).unwrap();
        self.send("POST", path, &[("content-type", "application/json")], &body)
            .unwrap()
    }

    pub fn get(&self, path: &str) -> Answer {
        self.send("GET", path, &[], b"").unwrap()
    }

    /// Submits a job that must be accepted.
    pub fn submit(&self, body: &Value) -> Uuid {
        let answer = self.post("/v1/jobs", body);
        assert_eq!(answer.status, 201, "{answer}");
        answer.json::<JobView>().id
    }

    pub fn job(&self, id: Uuid) -> JobView {
        self.get(&format!("/v1/jobs/{id}")).json()
    }

    /// Asks for `cancel`, `pause`, `resume` or `retry`.
    pub fn ask(&self, id: Uuid, action: &str) -> Answer {
        self.send("POST", &format!("/v1/jobs/{id}/{action}"), &[], b"")
            .unwrap()
    }

    /// All jobs that `filter` (a query such as `status=running`) lets through, page by page.
    pub fn jobs(&self, filter: &str) -> Vec<JobView> {
        let mut all = Vec::new();
        let mut cursor = String::new();
        loop {
            let page: Page<JobView> = self
                .get(&format!("/v1/jobs?limit=100&{filter}{cursor}"))
                .json();
            all.extend(page.items);
            match page.next {
                Some(next) => cursor = format!("&cursor={next}"),
                None => return all,
            }
        }
    }
}

impl Answer {
    fn head(response: &Response<Body>) -> Self {
        let header = |name: &str| {
            let value = response.headers().get(name)?;
            value.to_str().ok().map(str::to_owned)
        };
        Self {
            status: response.status().as_u16(),
            content_type: header("content-type").unwrap_or_default(),
            etag: header("etag"),
            body: Vec::new(),
        }
    }

    /// The body as `T`.
    ///
    /// # Panics
    /// When the server did not answer with success, or with something else.
    #[track_caller]
    pub fn json<T: DeserializeOwned>(&self) -> T {
        assert!(self.status < 300, "{self}");
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self}"))
    }
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const SHOWN: usize = 2000;
        let body = &self.body[..self.body.len().min(SHOWN)];
        write!(
            f,
            "{} {} {}",
            self.status,
            self.content_type,
            String::from_utf8_lossy(body)
        )
    }
}
