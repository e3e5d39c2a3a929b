//! How a route asks whether it may: an extractor for each action.
//!
//! A handler that takes a [`Permit`] runs only when the caller may do that at all, one that takes a
//! [`JobPermit`] only when the caller may do it to the job in its path. What either holds is a handle on
//! the store under the caller's name, so that what is changed through it is written down.
use std::marker::PhantomData;
use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{FromRequestParts, RawPathParams};
use axum::http::request::Parts;
use uuid::Uuid;

use super::problem::{ApiError, BAD_REQUEST, FORBIDDEN, Result};
use super::state::AppState;
use crate::access::{
    Action, Caller, Identity, JobFacts, Object, Person, ProjectFacts, Sight, Verdict, may,
};
use crate::store::people::{Actor, Versions};
use crate::store::{Store, StoreError};

/// Where a request came from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trace {
    pub(super) request: Uuid,
    pub(super) address: Option<IpAddr>,
}

impl Trace {
    /// Who to write down for what the request changes.
    pub(super) fn actor(&self, caller: Option<&Caller>) -> Actor {
        Actor {
            who: caller.map_or("nobody", Caller::name).to_owned(),
            person: caller.and_then(Caller::person).map(|person| person.id),
            credential: caller.and_then(|caller| caller.credential.id()),
            request: Some(self.request),
            address: self.address.map_or_else(String::new, |of| of.to_string()),
        }
    }
}

/// A request whose sender is known.
#[derive(Clone, Debug)]
pub(super) struct Call {
    pub(super) caller: Caller,
    pub(super) trace: Trace,
    /// How often things had changed when it came, where that is known.
    pub(super) versions: Option<Versions>,
}

impl Call {
    /// Refuses what the rules do.
    pub(super) fn ask(&self, action: Action, object: Object) -> Result<()> {
        match may(&self.caller, action, object) {
            Verdict::Yes => Ok(()),
            Verdict::No(reason) => Err(ApiError::new(FORBIDDEN, reason)),
            Verdict::Hidden => Err(match object {
                Object::Job(job) => missing("job", job.id),
                Object::Project(project) => missing("project", project.id),
                Object::Comparison(comparison) => missing("comparison", comparison.id),
                Object::Deleted(deleted) => missing("deleted job or project", deleted.id),
                Object::Lab => ApiError::not_found("thing of this kind"),
            }),
        }
    }

    /// How often things had changed at some moment since the request came.
    pub(super) async fn versions(&self, store: &Store) -> Result<Versions> {
        match self.versions {
            Some(versions) => Ok(versions),
            None => Ok(store.versions().await?),
        }
    }

    /// The store under the caller's name; the one person of a server without accounts has none.
    pub(super) fn store(&self, store: &Store) -> Store {
        match self.caller.identity {
            Identity::Sole => store.clone(),
            // a lease is its own proof, and the attempt's record says which worker had it
            Identity::Worker => store.clone(),
            _ => store.acting(self.trace.actor(Some(&self.caller))),
        }
    }

    /// The person who asks.
    pub(super) fn person(&self) -> Result<&Person> {
        let detail = "this is done by a person who is signed in";
        self.caller
            .person()
            .ok_or_else(|| ApiError::new(FORBIDDEN, detail))
    }

    /// What the caller sees.
    pub(super) async fn sight(&self, store: &Store) -> Result<Sight> {
        if self.caller.identity == Identity::Sole {
            return Ok(Sight::everything());
        }
        Ok(Sight::of(&self.caller, &store.project_facts().await?))
    }

    /// Whether the caller may do this to the job; a job that is not there is answered as a hidden one.
    pub(super) async fn ask_of_job(&self, store: &Store, action: Action, id: Uuid) -> Result<()> {
        if self.caller.identity == Identity::Sole {
            return self.ask(action, Object::Lab);
        }
        self.ask(action, Object::Lab)?;
        let facts: JobFacts = store.job_facts(id).await?;
        self.ask(action, Object::Job(&facts))
    }

    /// Whether the caller may do this to the comparison; one that is not there is answered as a hidden one.
    pub(super) async fn ask_of_comparison(
        &self,
        store: &Store,
        action: Action,
        id: Uuid,
    ) -> Result<()> {
        self.ask(action, Object::Lab)?;
        let projects = store.project_facts().await?;
        let facts = store.comparison_facts(id, &projects).await?;
        self.ask(action, Object::Comparison(&facts))
    }

    /// The project, where the caller may do this to it.
    pub(super) async fn ask_of_project(
        &self,
        store: &Store,
        action: Action,
        id: Uuid,
    ) -> Result<ProjectFacts> {
        self.ask(action, Object::Lab)?;
        let projects = store.project_facts().await?;
        let found = projects.iter().find(|project| project.id == id);
        let found = found.cloned().ok_or_else(|| missing("project", id))?;
        self.ask(action, Object::Project(&found))?;
        Ok(found)
    }
}

fn missing(what: &str, id: Uuid) -> ApiError {
    StoreError::NotFound(format!("{what} {id}")).into()
}

/// What a route does.
pub(super) trait Asked: Send + Sync {
    const ACTION: Action;
}

macro_rules! asked {
    ($($name:ident),+ $(,)?) => {
        $(
            #[derive(Debug)]
            pub(super) struct $name;
            impl Asked for $name {
                const ACTION: Action = Action::$name;
            }
        )+
    };
}

asked!(
    Introduce,
    Read,
    ReadFiles,
    ReadWorkers,
    ReadMetrics,
    Submit,
    Change,
    ManageOwn,
    ReadPeople,
    Administer,
    Work,
);

/// That the caller may do this.
#[derive(Debug)]
pub(super) struct Permit<A> {
    pub(super) call: Arc<Call>,
    pub(super) store: Store,
    _asked: PhantomData<A>,
}

/// That the caller may do this to the job `id` of the path.
#[derive(Debug)]
pub(super) struct JobPermit<A> {
    pub(super) id: Uuid,
    pub(super) call: Arc<Call>,
    pub(super) store: Store,
    _asked: PhantomData<A>,
}

fn call_of(parts: &Parts) -> Result<Arc<Call>> {
    // the guard puts it there, and lets nobody else come to a guarded route
    let call = parts.extensions.get::<Arc<Call>>().cloned();
    call.ok_or_else(|| ApiError::new(FORBIDDEN, "nobody is known to ask this"))
}

impl<A: Asked> FromRequestParts<AppState> for Permit<A> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self> {
        let call = call_of(parts)?;
        call.ask(A::ACTION, Object::Lab)?;
        Ok(Self {
            store: call.store(&state.store),
            call,
            _asked: PhantomData,
        })
    }
}

impl<A: Asked> FromRequestParts<AppState> for JobPermit<A> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self> {
        let call = call_of(parts)?;
        call.ask(A::ACTION, Object::Lab)?;
        let id = id_in_path(parts, state).await?;
        call.ask_of_job(&state.store, A::ACTION, id).await?;
        Ok(Self {
            id,
            store: call.store(&state.store),
            call,
            _asked: PhantomData,
        })
    }
}

async fn id_in_path(parts: &mut Parts, state: &AppState) -> Result<Uuid> {
    let bad = |detail: String| ApiError::new(BAD_REQUEST, detail);
    let params = RawPathParams::from_request_parts(parts, state).await;
    let params = params.map_err(|error| bad(error.to_string()))?;
    let id = params.iter().find(|(name, _)| *name == "id");
    let id = id.map_or("", |(_, text)| text);
    Uuid::try_parse(id).map_err(|error| bad(format!("the id {id:?} is not a UUID: {error}")))
}
