//! People and sharing: who one is, accounts, tokens, groups, projects, links, the audit log.
//!
//! On a server of one person these routes answer that it is one; `loadframe people create-admin` makes
//! it a group's.
mod accounts;
mod audit;
mod groups;
mod invitations;
mod limits;
mod mails;
mod projects;
mod retention;
mod sessions;
mod shares;
mod sign_in;
mod tokens;
mod webhooks;

use axum::Json;
use axum::extract::State;
use loadframe_api::people::{CallerKind, CallerView, Named};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::AppState;
use super::permit::{Introduce, Permit};
use super::problem::Result;
use crate::access::{Credential, Identity};

pub(super) fn router() -> OpenApiRouter<AppState> {
    OpenApiRouter::default()
        .routes(routes!(me))
        .merge(accounts::router())
        .merge(limits::router())
        .merge(sessions::router())
        .merge(sign_in::router())
        .merge(invitations::router())
        .merge(tokens::router())
        .merge(groups::router())
        .merge(projects::router())
        .merge(retention::router())
        .merge(webhooks::router())
        .merge(mails::router())
        .merge(shares::router())
        .merge(audit::router())
}

/// Who am I?
///
/// Whom the server takes the caller for, by its session, token or link.
#[utoipa::path(get, operation_id = "read_me", path = "/v1/me", tag = "People",
    responses((status = 200, description = "The caller", body = ref("#/components/schemas/CallerView"))))]
async fn me(State(state): State<AppState>, permit: Permit<Introduce>) -> Result<Json<CallerView>> {
    let caller = &permit.call.caller;
    let mut view = CallerView {
        kind: CallerKind::Sole,
        accounts: state.store.has_people(),
        mail: state.ways.mailer.is_some(),
        scope: match caller.credential {
            Credential::Session(_) | Credential::Proxy(_) => None,
            _ => Some(caller.scope),
        },
        person: None,
        groups: Vec::new(),
        job: None,
        project: None,
        comparison: None,
        files: None,
    };
    match &caller.identity {
        Identity::Sole => {}
        Identity::Worker => view.kind = CallerKind::Worker,
        Identity::Person(person) => {
            view.kind = CallerKind::Person;
            let people = state.store.people().await?;
            view.person = people.into_iter().find(|of| of.id == person.id);
            let groups = state.store.groups().await?.into_iter();
            let own = groups.filter(|group| person.groups.contains(&group.id));
            view.groups = own
                .map(|of| Named {
                    id: of.id,
                    name: of.name,
                })
                .collect();
        }
        Identity::Link(link) => {
            view.kind = CallerKind::Share;
            view.job = link.job;
            view.comparison = link.comparison;
            view.files = Some(link.shows_files);
            let projects = state.store.projects().await?.into_iter();
            let mut shown = projects.filter(|project| Some(project.id) == link.project);
            view.project = shown.next().map(|of| Named {
                id: of.id,
                name: of.name,
            });
        }
    }
    Ok(Json(view))
}
