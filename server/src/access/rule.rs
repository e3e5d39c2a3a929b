//! The one rule.
use loadframe_api::people::{Role, Scope};

use super::{Caller, ComparisonFacts, DeletedFacts, Identity, JobFacts, ProjectFacts};

/// Why an archived project takes no job, whoever finds it archived.
pub(crate) const ARCHIVED: &str = "the project is archived and takes no jobs; bring it back first";

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Ask who one is.
    Introduce,
    /// Read: of the lab what is no object's (kinds, lists, streams), of a job everything but its files.
    Read,
    /// Read the files, snapshots and log of a job.
    ReadFiles,
    /// See which machines compute.
    ReadWorkers,
    /// Read the counts of the whole server.
    ReadMetrics,
    /// Submit a job; of a project, put jobs into it.
    Submit,
    /// Change, cancel, delete, move, share.
    Change,
    /// Give a project to another person or group.
    HandOver,
    /// Look after one's own account: password, sessions, tokens, links.
    ManageOwn,
    /// See the people and groups of the lab.
    ReadPeople,
    /// Look after people, groups, tokens of workers, the audit log.
    Administer,
    /// Claim jobs and write under leases.
    Work,
}

/// What it is done to.
#[derive(Clone, Copy, Debug)]
pub enum Object<'a> {
    /// What belongs to nobody.
    Lab,
    Job(&'a JobFacts),
    Project(&'a ProjectFacts),
    Comparison(&'a ComparisonFacts),
    Deleted(DeletedFacts),
}

/// Whether it may be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Yes,
    /// It must not be, for this reason.
    No(&'static str),
    /// The object must not be seen: it is answered as one that does not exist.
    Hidden,
}

/// Whether `caller` may do `action` to `object`.
pub fn may(caller: &Caller, action: Action, object: Object) -> Verdict {
    if let Some(refusal) = refusal_of_the_caller(caller, action) {
        return Verdict::No(refusal);
    }
    let (is_seen, is_held) = match object {
        Object::Lab => return Verdict::Yes,
        Object::Job(job) => (job.is_seen_by(caller), job.is_held_by(caller)),
        Object::Project(project) => (project.is_seen_by(caller), project.is_held_by(caller)),
        Object::Comparison(of) => (of.is_seen_by(caller), of.is_held_by(caller)),
        Object::Deleted(of) => (of.is_owned_by(caller), of.is_owned_by(caller)),
    };
    let is_held = is_held
        || matches!(caller.identity, Identity::Sole)
        || caller.has_role(Role::Administrator);
    match action {
        _ if !is_seen => Verdict::Hidden,
        Action::Change | Action::Submit | Action::HandOver if !is_held => {
            Verdict::No("it is shared with you to read; its owner can change it")
        }
        Action::HandOver if !is_owner(caller, object) => {
            Verdict::No("a group's project is handed over by an administrator")
        }
        Action::Submit if is_archived(object) => Verdict::No(ARCHIVED),
        _ => Verdict::Yes,
    }
}

/// Why the caller must not do this to anything.
fn refusal_of_the_caller(caller: &Caller, action: Action) -> Option<&'static str> {
    let is_link = matches!(caller.identity, Identity::Link(_));
    let is_guest = caller.has_role(Role::Guest);
    let works = matches!(caller.scope, Scope::Worker | Scope::Everything);
    match action {
        Action::Introduce => None,
        Action::Work if works && !caller.is_session() && !is_link => None,
        Action::Work => Some("only a token of scope `worker` works; administrators make them"),
        _ if !caller.reads() => {
            Some("this token can only work: claim jobs and write under its leases")
        }
        Action::Read => None,
        Action::ReadFiles => match &caller.identity {
            Identity::Link(link) if !link.shows_files => {
                Some("this link shows results without files")
            }
            _ => None,
        },
        _ if is_link => Some("a share link shows what it was made for, and nothing else"),
        Action::Submit | Action::Change | Action::HandOver if !caller.changes() => {
            Some("this token can only read; one of scope `submit` is needed")
        }
        Action::Submit | Action::Change | Action::HandOver if is_guest => {
            Some("guests read what is shared with them; an administrator can make you a member")
        }
        Action::ReadWorkers if is_guest => Some("guests read what is shared with them"),
        Action::Submit | Action::Change | Action::HandOver | Action::ReadWorkers => None,
        Action::ReadMetrics => {
            let reads =
                matches!(caller.identity, Identity::Sole) || caller.has_role(Role::Administrator);
            (!reads).then_some("the counts of the whole server are for administrators")
        }
        Action::ReadPeople if is_guest => Some("guests read what is shared with them"),
        Action::ReadPeople | Action::ManageOwn | Action::Administer
            if caller.person().is_none() =>
        {
            Some("this server is one person's: `loadframe people create-admin` makes it a group's")
        }
        Action::ReadPeople => None,
        Action::ManageOwn if caller.is_session() => None,
        Action::ManageOwn | Action::Administer if !caller.is_session() => {
            Some("this is done signed in, not by token")
        }
        Action::Administer if caller.has_role(Role::Administrator) => None,
        Action::Administer | Action::ManageOwn => Some("administrators do this"),
    }
}

/// Whether the project is the caller's own, or the caller an administrator.
fn is_owner(caller: &Caller, object: Object) -> bool {
    let own = caller.person().map(|person| person.id);
    let is_own = matches!(object, Object::Project(project) if project.person.is_some() && project.person == own);
    is_own || caller.has_role(Role::Administrator)
}

fn is_archived(object: Object) -> bool {
    match object {
        Object::Project(project) => project.is_archived,
        _ => false,
    }
}

#[cfg(test)]
#[path = "rule_tests.rs"]
mod tests;
