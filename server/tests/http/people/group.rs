//! A group's server for a test: people signed in, jobs of theirs.
//!
//! Ada administers. Anna and Bert are members of the group Paper, Gina a guest of it; Carl is a member
//! of no group.
use axum::http::HeaderMap;
use futures_util::future::BoxFuture;
use loadframe_api::people::{
    Acceptance, Named, NewInvitation, NewProject, NewShare, NewToken, ProjectView, Role, Scope,
    Visibility,
};
use loadframe_server::store::people::Actor;
use serde_json::{Value, json};
use uuid::Uuid;

use crate::support::{Answer, JSON, Lab, example, request};

pub(crate) const PASSWORD: &str = "a password for tests";

/// Somebody, and how they are known.
#[derive(Clone, Debug)]
pub(crate) struct Somebody {
    pub(crate) id: Uuid,
    pub(crate) name: String,
    /// Header and its value.
    pub(crate) known_by: (&'static str, String),
}

impl Somebody {
    /// The same, known by the secret of a token or a link.
    fn with(&self, secret: &str) -> Self {
        Self {
            known_by: ("authorization", format!("Bearer {secret}")),
            ..self.clone()
        }
    }
}

pub(crate) struct Group {
    pub(crate) lab: Lab,
    pub(crate) paper: Uuid,
    pub(crate) ada: Somebody,
    pub(crate) anna: Somebody,
    pub(crate) bert: Somebody,
    pub(crate) carl: Somebody,
    pub(crate) gina: Somebody,
}

impl Group {
    pub(crate) async fn open() -> Self {
        Self::of(Lab::open().await).await
    }

    /// Makes the server a group's.
    pub(crate) fn of(lab: Lab) -> BoxFuture<'static, Self> {
        Box::pin(async move {
            let first = lab.store.create_first_administrator("Ada", PASSWORD).await;
            let ada = signed_in(&lab, first.expect("an administrator").id, "Ada").await;
            let paper = lab.store.create_group("Paper").await.expect("a group").id;
            let anna = invited(&lab, "Anna", Role::Member, &[paper]).await;
            let bert = invited(&lab, "Bert", Role::Member, &[paper]).await;
            let carl = invited(&lab, "Carl", Role::Member, &[]).await;
            let gina = invited(&lab, "Gina", Role::Guest, &[paper]).await;
            Self {
                lab,
                paper,
                ada,
                anna,
                bert,
                carl,
                gina,
            }
        })
    }

    /// A request as the page of this server sends it.
    pub(crate) fn send<'a>(
        &'a self,
        by: &'a Somebody,
        method: &'a str,
        path: &'a str,
        body: &'a str,
    ) -> BoxFuture<'a, Answer> {
        Box::pin(async move {
            let (name, value) = &by.known_by;
            let headers = [(*name, &**value), ("origin", "http://localhost"), JSON];
            self.lab.send(request(method, path, &headers, body)).await
        })
    }

    pub(crate) async fn get(&self, by: &Somebody, path: &str) -> Answer {
        self.send(by, "GET", path, "").await
    }

    /// Submits a job to a project; its id.
    pub(crate) async fn submit(&self, by: &Somebody, project: Uuid) -> Uuid {
        let path = format!("/v1/jobs?project={project}");
        let answer = self.send(by, "POST", &path, example()).await;
        assert_eq!(answer.status, 201, "{answer:?}");
        id_of(&answer.json())
    }

    pub(crate) fn project<'a>(
        &'a self,
        by: &'a Somebody,
        visibility: Visibility,
        group: Option<Uuid>,
    ) -> BoxFuture<'a, ProjectView> {
        Box::pin(async move {
            let new = NewProject {
                name: "a project".to_owned(),
                visibility,
                group,
            };
            let made = self.lab.store.create_project(by.id, new).await;
            made.expect("a project")
        })
    }

    /// A token of somebody.
    pub(crate) fn token<'a>(
        &'a self,
        of: &'a Somebody,
        scope: Scope,
    ) -> BoxFuture<'a, (Somebody, Uuid)> {
        Box::pin(async move {
            let new = NewToken {
                name: "a token".to_owned(),
                scope,
                days: None,
            };
            let made = self.lab.store.create_token(Some(of.id), new).await;
            let made = made.expect("a token");
            (of.with(&made.secret), made.id)
        })
    }

    /// Whoever has a link of somebody.
    pub(crate) fn link<'a>(
        &'a self,
        of: &'a Somebody,
        shown: NewShare,
    ) -> BoxFuture<'a, (Somebody, Uuid)> {
        Box::pin(async move {
            let made = self.lab.store.create_share(of.id, shown).await;
            let made = made.expect("a link");
            let (_, secret) = made.path.split_once('#').expect("a secret");
            (of.with(secret), made.id)
        })
    }
}

/// A link to one job.
pub(crate) fn to_job(job: Uuid, files: bool) -> NewShare {
    NewShare {
        job: Some(job),
        project: None,
        comparison: None,
        files,
        days: 1,
    }
}

pub(crate) fn id_of(value: &Value) -> Uuid {
    value["id"]
        .as_str()
        .expect("an id")
        .parse()
        .expect("a UUID")
}

pub(crate) fn ids(page: &Value) -> Vec<Uuid> {
    page["items"]
        .as_array()
        .expect("items")
        .iter()
        .map(id_of)
        .collect()
}

pub(crate) fn named(somebody: &Somebody) -> Named {
    Named {
        id: somebody.id,
        name: somebody.name.clone(),
    }
}

async fn signed_in(lab: &Lab, id: Uuid, name: &str) -> Somebody {
    let session = lab.store.open_session(id, false, "a test").await;
    let secret = session.expect("a session").secret;
    Somebody {
        id,
        name: name.to_owned(),
        known_by: ("cookie", format!("loadframe={secret}")),
    }
}

async fn invited(lab: &Lab, name: &str, role: Role, groups: &[Uuid]) -> Somebody {
    let new = NewInvitation {
        role,
        groups: groups.to_vec(),
        days: 1,
        email: None,
    };
    let made = lab.store.invite(new).await.expect("an invitation");
    let (_, secret) = made.path.split_once('#').expect("a secret");
    let store = lab.store.acting(Actor::shell());
    let opened = store.accept_invitation(Acceptance {
        secret: secret.to_owned(),
        name: name.to_owned(),
        password: PASSWORD.to_owned(),
    });
    signed_in(lab, opened.await.expect("an account").id, name).await
}

/// Signs in as the page does.
pub(crate) async fn sign_in(lab: &Lab, origin: &str, name: &str, password: &str) -> Answer {
    let body = json!({ "name": name, "password": password }).to_string();
    let host = origin.split_once("://").map_or("", |(_, host)| host);
    let headers = [("origin", origin), ("host", host), JSON];
    lab.send(request("POST", "/v1/sessions", &headers, &body))
        .await
}

/// The cookie of an answer, as a browser sends it back.
pub(crate) fn cookie_of(headers: &HeaderMap) -> String {
    let cookie = headers.get("set-cookie").expect("a cookie");
    let cookie = cookie.to_str().expect("text");
    cookie.split(';').next().unwrap_or("").to_owned()
}
