//! The rule by cases: who, what, whose.
use loadframe_api::people::Visibility;
use uuid::Uuid;

use super::*;
use crate::access::{Credential, Link, Person, Sight, Whose};

const ANNA: Uuid = Uuid::from_u128(1);
const BERT: Uuid = Uuid::from_u128(2);
const PAPER: Uuid = Uuid::from_u128(10);
const GRAINS: Uuid = Uuid::from_u128(11);
const JOB: Uuid = Uuid::from_u128(20);
const PROJECT: Uuid = Uuid::from_u128(30);

fn person(id: Uuid, role: Role, groups: &[Uuid]) -> Caller {
    Caller {
        identity: Identity::Person(Person {
            id,
            name: String::new(),
            role,
            groups: groups.to_vec(),
        }),
        scope: Scope::Everything,
        credential: Credential::Session(Uuid::from_u128(99)),
        expires_at: None,
    }
}

fn by_token(caller: Caller, scope: Scope) -> Caller {
    Caller {
        scope,
        credential: Credential::Token(Uuid::from_u128(98)),
        ..caller
    }
}

fn link(job: Option<Uuid>, project: Option<Uuid>, shows_files: bool) -> Caller {
    Caller {
        identity: Identity::Link(Link {
            job,
            project,
            comparison: None,
            compared: Vec::new(),
            shows_files,
        }),
        scope: Scope::Read,
        credential: Credential::Link(Uuid::from_u128(97)),
        expires_at: None,
    }
}

/// Anna's project; she is in the group of paper.
fn annas(visibility: Visibility) -> ProjectFacts {
    ProjectFacts {
        id: PROJECT,
        person: Some(ANNA),
        group: None,
        visibility,
        is_archived: false,
        circle: vec![PAPER],
    }
}

fn of_group(visibility: Visibility) -> ProjectFacts {
    ProjectFacts {
        person: None,
        group: Some(PAPER),
        circle: Vec::new(),
        ..annas(visibility)
    }
}

fn job(project: ProjectFacts) -> JobFacts {
    JobFacts {
        id: JOB,
        owner: Some(ANNA),
        project: Some(project),
    }
}

fn of_job(caller: &Caller, action: Action, job: &JobFacts) -> Verdict {
    may(caller, action, Object::Job(job))
}

#[test]
fn a_private_job_is_its_owners_and_the_administrators() {
    let private = job(annas(Visibility::Private));
    for (caller, expected) in [
        (person(ANNA, Role::Member, &[PAPER]), Verdict::Yes),
        (person(BERT, Role::Administrator, &[]), Verdict::Yes),
        (person(BERT, Role::Member, &[PAPER]), Verdict::Hidden),
        (person(BERT, Role::Guest, &[PAPER]), Verdict::Hidden),
        (Caller::sole(Scope::Everything), Verdict::Yes),
    ] {
        for action in [Action::Read, Action::ReadFiles] {
            assert_eq!(of_job(&caller, action, &private), expected, "{caller:?}");
        }
    }
}

#[test]
fn what_a_person_shares_is_read_by_its_groups_or_by_every_member() {
    let shared = job(annas(Visibility::Group));
    let public = job(annas(Visibility::Everyone));
    for (role, groups, reads_shared, reads_public) in [
        (Role::Member, &[PAPER][..], true, true),
        (Role::Member, &[GRAINS], false, true),
        (Role::Guest, &[PAPER], true, true),
        (Role::Guest, &[GRAINS], false, false),
    ] {
        let bert = person(BERT, role, groups);
        let reads = |job| of_job(&bert, Action::Read, job) == Verdict::Yes;
        assert_eq!(
            (reads(&shared), reads(&public)),
            (reads_shared, reads_public)
        );
        for job in [&shared, &public] {
            assert_ne!(of_job(&bert, Action::Change, job), Verdict::Yes, "{bert:?}");
        }
    }
    let bert = person(BERT, Role::Member, &[PAPER]);
    assert!(matches!(
        of_job(&bert, Action::Change, &shared),
        Verdict::No(_)
    ));
}

#[test]
fn in_a_groups_project_members_work_together_and_guests_look_on() {
    let job = job(of_group(Visibility::Group));
    let ask = |role, groups: &[Uuid], action| of_job(&person(BERT, role, groups), action, &job);
    assert_eq!(ask(Role::Member, &[PAPER], Action::Change), Verdict::Yes);
    assert_eq!(ask(Role::Guest, &[PAPER], Action::Read), Verdict::Yes);
    assert!(matches!(
        ask(Role::Guest, &[PAPER], Action::Change),
        Verdict::No(_)
    ));
    assert_eq!(
        ask(Role::Member, &[GRAINS], Action::Change),
        Verdict::Hidden
    );
}

#[test]
fn a_token_reaches_as_far_as_its_scope() {
    let own = job(annas(Visibility::Private));
    let anna = || person(ANNA, Role::Administrator, &[]);
    let allowed = |scope: Scope| {
        let token = by_token(anna(), scope);
        [
            of_job(&token, Action::Read, &own),
            of_job(&token, Action::Change, &own),
            may(&token, Action::Submit, Object::Lab),
            may(&token, Action::Work, Object::Lab),
            may(&token, Action::Administer, Object::Lab),
            may(&token, Action::ManageOwn, Object::Lab),
        ]
        .map(|verdict| verdict == Verdict::Yes)
    };
    assert_eq!(
        allowed(Scope::Read),
        [true, false, false, false, false, false]
    );
    assert_eq!(
        allowed(Scope::Submit),
        [true, true, true, false, false, false]
    );
    assert_eq!(
        allowed(Scope::Worker),
        [false, false, false, true, false, false]
    );
    assert_eq!(
        allowed(Scope::Everything),
        [true, true, true, true, false, false]
    );
}

#[test]
fn a_worker_only_works_and_a_browser_never_does() {
    let own = job(annas(Visibility::Everyone));
    for action in [Action::Read, Action::ReadFiles, Action::Change] {
        assert!(matches!(
            of_job(&Caller::worker(), action, &own),
            Verdict::No(_)
        ));
    }
    let asks = |caller: &Caller, action| may(caller, action, Object::Lab);
    assert_eq!(asks(&Caller::worker(), Action::Work), Verdict::Yes);
    assert!(matches!(
        asks(&Caller::worker(), Action::Submit),
        Verdict::No(_)
    ));
    let anna = person(ANNA, Role::Administrator, &[]);
    assert!(matches!(asks(&anna, Action::Work), Verdict::No(_)));
}

#[test]
fn a_link_shows_its_object_and_nothing_else() {
    let job = job(annas(Visibility::Private));
    let other = JobFacts {
        id: Uuid::from_u128(21),
        ..job.clone()
    };
    let one = link(Some(JOB), None, false);
    assert_eq!(of_job(&one, Action::Read, &job), Verdict::Yes);
    assert!(matches!(
        of_job(&one, Action::ReadFiles, &job),
        Verdict::No(_)
    ));
    assert_eq!(of_job(&one, Action::Read, &other), Verdict::Hidden);
    let all = link(None, Some(PROJECT), true);
    assert_eq!(of_job(&all, Action::ReadFiles, &other), Verdict::Yes);
    for action in [
        Action::Submit,
        Action::Change,
        Action::Work,
        Action::Administer,
        Action::ManageOwn,
        Action::ReadWorkers,
        Action::ReadPeople,
        Action::ReadMetrics,
    ] {
        let verdict = may(&all, action, Object::Lab);
        assert!(matches!(verdict, Verdict::No(_)), "{action:?}");
    }
}

#[test]
fn a_groups_project_leaves_the_group_by_an_administrator() {
    let own = annas(Visibility::Group);
    let groups = of_group(Visibility::Group);
    let asks = |caller: &Caller, project| may(caller, Action::HandOver, Object::Project(project));
    let anna = person(ANNA, Role::Member, &[PAPER]);
    assert_eq!(asks(&anna, &own), Verdict::Yes);
    assert!(matches!(asks(&anna, &groups), Verdict::No(_)));
    let ada = person(BERT, Role::Administrator, &[]);
    assert_eq!(asks(&ada, &groups), Verdict::Yes);
    let bert = person(BERT, Role::Member, &[PAPER]);
    assert!(matches!(asks(&bert, &own), Verdict::No(_)));
}

#[test]
fn an_archived_project_takes_no_jobs() {
    let archived = ProjectFacts {
        is_archived: true,
        ..annas(Visibility::Private)
    };
    let anna = person(ANNA, Role::Member, &[]);
    let ask = |action, project: &ProjectFacts| may(&anna, action, Object::Project(project));
    assert!(matches!(ask(Action::Submit, &archived), Verdict::No(_)));
    assert_eq!(ask(Action::Change, &archived), Verdict::Yes);
    let open = annas(Visibility::Private);
    assert_eq!(ask(Action::Submit, &open), Verdict::Yes);
}

#[test]
fn a_sight_shows_exactly_what_may_be_read() {
    let callers = [
        person(ANNA, Role::Member, &[PAPER]),
        person(BERT, Role::Member, &[PAPER]),
        person(BERT, Role::Member, &[GRAINS]),
        person(BERT, Role::Guest, &[PAPER]),
        person(BERT, Role::Guest, &[]),
        person(BERT, Role::Administrator, &[]),
        Caller::sole(Scope::Everything),
        link(Some(JOB), None, false),
        link(None, Some(PROJECT), false),
        link(Some(Uuid::from_u128(5)), None, true),
    ];
    let all = [Visibility::Private, Visibility::Group, Visibility::Everyone];
    let projects = all.map(annas).into_iter().chain(all.map(of_group));
    for project in projects {
        let facts = job(project.clone());
        for caller in &callers {
            let sight = Sight::of(caller, std::slice::from_ref(&project));
            let shown = sight.shows(JOB, facts.owner, Some(PROJECT));
            let read = of_job(caller, Action::Read, &facts) == Verdict::Yes;
            assert_eq!(shown, read, "{caller:?} {project:?}");
        }
    }
}

#[test]
fn parts_of_a_sight_are_told_apart() {
    let group = ProjectFacts {
        id: Uuid::from_u128(31),
        ..of_group(Visibility::Group)
    };
    let projects = [annas(Visibility::Everyone), group];
    let shows = |whose, owner, project: usize| {
        let bert = person(BERT, Role::Member, &[PAPER]);
        let sight = Sight::of(&bert, &projects).only(whose, &bert, &projects);
        sight.shows(JOB, Some(owner), Some(projects[project].id))
    };
    assert!(shows(Whose::Mine, BERT, 1) && !shows(Whose::Mine, ANNA, 1));
    assert!(shows(Whose::Groups, ANNA, 1) && !shows(Whose::Groups, ANNA, 0));
    assert!(shows(Whose::Shared, ANNA, 0) && !shows(Whose::Shared, ANNA, 1));
    let anna = person(ANNA, Role::Member, &[]);
    let mut archived = projects.clone();
    archived[0].is_archived = true;
    let sight = Sight::of(&anna, &archived).without_archived(&archived);
    assert!(!sight.shows(JOB, Some(ANNA), Some(PROJECT)));
}
