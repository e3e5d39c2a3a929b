//! What a caller sees of a list or a stream.
use loadframe_api::people::Role;
use uuid::Uuid;

use super::{Caller, Identity, ProjectFacts};

/// Which jobs a caller sees, in a form that lists can be narrowed by.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sight {
    /// Every job; nothing else counts then.
    pub everything: bool,
    /// All jobs of this person.
    pub owner: Option<Uuid>,
    /// These jobs.
    pub jobs: Vec<Uuid>,
    /// This comparison.
    pub comparison: Option<Uuid>,
    /// All jobs in these projects.
    pub projects: Vec<Uuid>,
    /// But no job in these.
    pub not_in: Vec<Uuid>,
    /// And no job of this person.
    pub not_of: Option<Uuid>,
}

/// Which part of what one sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    /// One's own jobs.
    Mine,
    /// Jobs in projects of one's groups.
    Groups,
    /// What others share.
    Shared,
}

impl Sight {
    /// Of somebody who sees every job.
    pub fn everything() -> Self {
        Self {
            everything: true,
            ..Self::default()
        }
    }

    /// What `caller` sees where these are all projects.
    pub fn of(caller: &Caller, projects: &[ProjectFacts]) -> Self {
        let everything =
            matches!(caller.identity, Identity::Sole) || caller.has_role(Role::Administrator);
        let seen = projects.iter().filter(|project| project.is_seen_by(caller));
        Self {
            everything,
            owner: caller.person().map(|person| person.id),
            jobs: match &caller.identity {
                Identity::Link(link) => link.compared.iter().copied().chain(link.job).collect(),
                _ => Vec::new(),
            },
            comparison: match &caller.identity {
                Identity::Link(link) => link.comparison,
                _ => None,
            },
            projects: match everything {
                true => Vec::new(),
                false => seen.map(|project| project.id).collect(),
            },
            ..Self::default()
        }
    }

    /// Without the jobs of archived projects.
    pub fn without_archived(mut self, projects: &[ProjectFacts]) -> Self {
        let archived = projects.iter().filter(|project| project.is_archived);
        self.not_in = archived.map(|project| project.id).collect();
        self
    }

    /// That part of it.
    pub fn only(mut self, whose: Whose, caller: &Caller, projects: &[ProjectFacts]) -> Self {
        let own = caller.person().map(|person| person.id);
        let seen = projects.iter().filter(|project| project.is_seen_by(caller));
        let mine = caller.person().map_or(&[][..], |person| &person.groups);
        let is_groups =
            |project: &ProjectFacts| project.group.is_some_and(|group| mine.contains(&group));
        self.everything = false;
        match whose {
            Whose::Mine => self.projects.clear(),
            Whose::Groups => {
                self.owner = None;
                self.projects = seen.filter(|of| is_groups(of)).map(|of| of.id).collect();
            }
            Whose::Shared => {
                (self.owner, self.not_of) = (None, own);
                let others = seen.filter(|of| !is_groups(of) && of.person != own);
                self.projects = others.map(|of| of.id).collect();
            }
        }
        self
    }

    /// Whether it holds this job.
    pub fn shows(&self, job: Uuid, owner: Option<Uuid>, project: Option<Uuid>) -> bool {
        let is_among =
            |projects: &[Uuid]| project.is_some_and(|project| projects.contains(&project));
        let is_of = |person: Option<Uuid>| person.is_some() && person == owner;
        (self.everything
            || is_of(self.owner)
            || self.jobs.contains(&job)
            || is_among(&self.projects))
            && !is_among(&self.not_in)
            && !is_of(self.not_of)
    }
}
