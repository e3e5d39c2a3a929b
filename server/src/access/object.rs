//! What is asked for, as far as the rules look.
use loadframe_api::people::{Role, Visibility};
use uuid::Uuid;

use super::{Caller, Identity};

/// Whose a project is, and who sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProjectFacts {
    pub id: Uuid,
    pub person: Option<Uuid>,
    pub group: Option<Uuid>,
    pub visibility: Visibility,
    pub is_archived: bool,
    /// Groups of its person.
    pub circle: Vec<Uuid>,
}

/// Whose a job is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobFacts {
    pub id: Uuid,
    pub owner: Option<Uuid>,
    pub project: Option<ProjectFacts>,
}

/// Whose a comparison is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComparisonFacts {
    pub id: Uuid,
    pub owner: Option<Uuid>,
    pub project: Option<ProjectFacts>,
}

/// Whose something deleted is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeletedFacts {
    pub id: Uuid,
    pub owner: Option<Uuid>,
}

impl DeletedFacts {
    /// Whether the caller sees it, and may bring it back: its owner, nobody whom it was shared with.
    pub(super) fn is_owned_by(self, caller: &Caller) -> bool {
        match &caller.identity {
            Identity::Sole => true,
            Identity::Person(person) => {
                person.role == Role::Administrator || self.owner == Some(person.id)
            }
            Identity::Worker | Identity::Link(_) => false,
        }
    }
}

impl ProjectFacts {
    /// Whether the caller sees the project and its jobs.
    pub(super) fn is_seen_by(&self, caller: &Caller) -> bool {
        match &caller.identity {
            Identity::Sole => true,
            Identity::Worker => false,
            Identity::Link(link) => link.project == Some(self.id),
            Identity::Person(person) => {
                let is_among = |groups: &[Uuid]| groups.iter().any(|of| person.groups.contains(of));
                person.role == Role::Administrator
                    || self.is_held_by(caller)
                    // a group shows its guests what it has
                    || self.group.is_some_and(|group| person.groups.contains(&group))
                    || match self.visibility {
                        Visibility::Private => false,
                        Visibility::Group => is_among(&self.circle),
                        // a guest sees only what its groups share
                        Visibility::Everyone => {
                            person.role == Role::Member || is_among(&self.circle)
                        }
                    }
            }
        }
    }

    /// Whether it is the caller's own, or that of a group in which the caller works.
    pub(super) fn is_held_by(&self, caller: &Caller) -> bool {
        caller.person().is_some_and(|person| {
            let is_group = self
                .group
                .is_some_and(|group| person.groups.contains(&group));
            self.person == Some(person.id) || (is_group && person.role != Role::Guest)
        })
    }
}

impl JobFacts {
    pub(super) fn is_seen_by(&self, caller: &Caller) -> bool {
        if let Identity::Link(link) = &caller.identity
            && (link.job == Some(self.id) || link.compared.contains(&self.id))
        {
            return true;
        }
        self.is_owned_by(caller)
            || match &self.project {
                Some(project) => project.is_seen_by(caller),
                None => {
                    matches!(caller.identity, Identity::Sole)
                        || caller.has_role(Role::Administrator)
                }
            }
    }

    pub(super) fn is_held_by(&self, caller: &Caller) -> bool {
        let project = self.project.as_ref();
        self.is_owned_by(caller) || project.is_some_and(|project| project.is_held_by(caller))
    }

    fn is_owned_by(&self, caller: &Caller) -> bool {
        caller
            .person()
            .is_some_and(|person| self.owner == Some(person.id))
    }
}

impl ComparisonFacts {
    pub(super) fn is_seen_by(&self, caller: &Caller) -> bool {
        let project = self.project.as_ref();
        match &caller.identity {
            Identity::Sole => true,
            Identity::Worker => false,
            Identity::Link(link) => link.comparison == Some(self.id),
            Identity::Person(person) => {
                person.role == Role::Administrator
                    || self.owner == Some(person.id)
                    || project.is_some_and(|project| project.is_seen_by(caller))
            }
        }
    }

    pub(super) fn is_held_by(&self, caller: &Caller) -> bool {
        let is_owner = |person: &super::Person| self.owner == Some(person.id);
        let project = self.project.as_ref();
        caller.person().is_some_and(is_owner)
            || project.is_some_and(|project| project.is_held_by(caller))
    }
}
