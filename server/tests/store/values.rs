//! Lists by values of specs and results: the same before these are kept and afterwards, however far they walk.
//!
//! One file, long as it is: all of it is held against one plain way to make a list.
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering as Memory};

use loadframe_api::{JobKind, JobOutcome, JobStatus, JobView, Page, Submission};
use loadframe_server::access::Sight;
use loadframe_server::store::pointer::Pointer;
use loadframe_server::store::{Clock, JobFilter, Looks, Store, StoreOptions, Wanted};
use serde_json::{Value, json};
use uuid::Uuid;

use crate::lab::{LONG, Lab, group, options, worker};

const NUMBER: &str = "/spec/test/strain_step";
const WORD: &str = "/spec/test/breaking";
const RESULT: &str = "/summary/max_force";
const SEED: &str = "/spec/seed";

/// What a job is submitted with, and what it is found by.
#[derive(Clone, Debug)]
struct Job {
    id: Uuid,
    seed: u64,
    /// Of those of the one kind that has both.
    number: Option<f64>,
    word: Option<&'static str>,
    has_result: bool,
}

async fn lab(looks: Looks) -> Lab {
    let folder = tempfile::tempdir().unwrap();
    let options = StoreOptions {
        looks,
        ..options(&folder, LONG)
    };
    let store = Store::open(options).await.unwrap();
    Lab { store, folder }
}

/// Another job, the `n`-th; every fourth is of a kind that has fields of other names.
async fn submit(store: &Store, n: usize) -> Job {
    let is_scene = n % 4 == 3;
    let kind = if is_scene {
        JobKind::GranularScene
    } else {
        JobKind::NonwovenTensile
    };
    let examples = kind.examples();
    let example = examples.last().unwrap();
    let mut body: Value = serde_json::from_str(example.body).unwrap();
    body["name"] = json!(if is_scene { "A scene" } else { "A quick look" });
    // with ties
    let seed = (n * 7 % 5) as u64;
    body["spec"]["seed"] = json!(seed);
    let (mut number, mut word) = (None, None);
    if !is_scene {
        number = Some(0.01 * (1 + n * 5 % 6) as f64);
        word = Some(["none", "all_over_strength", "weakest_first"][n % 3]);
        body["spec"]["test"]["strain_step"] = json!(number);
        body["spec"]["test"]["breaking"] = json!(word);
    }
    let submission = Submission::from_slice(body.to_string().as_bytes()).unwrap();
    let id = store.enqueue(&submission, None).await.unwrap().job.id;
    Job {
        id,
        seed,
        number,
        word,
        has_result: false,
    }
}

/// Forty jobs, of which a quarter have been done.
async fn filled(lab: &Lab) -> Vec<Job> {
    let mut jobs = Vec::new();
    for n in 0..40 {
        jobs.push(submit(&lab.store, n).await);
    }
    for _ in 0..10 {
        let lease = lab.claim(&worker("bench")).await.unwrap().unwrap();
        lab.finish(&lease).await;
        let done = jobs.iter_mut().find(|job| job.id == lease.job_id).unwrap();
        done.has_result = true;
    }
    jobs
}

fn wanted(conditions: &[&str], sort: Option<&str>) -> Wanted {
    Wanted {
        conditions: conditions
            .iter()
            .map(|text| text.parse().unwrap())
            .collect(),
        order: sort.map(|text| text.parse().unwrap()),
        shown: Vec::new(),
    }
}

fn filters() -> Vec<(&'static str, JobFilter)> {
    vec![
        ("all", JobFilter::default()),
        (
            "finished",
            JobFilter {
                status: Some(JobStatus::Finished),
                ..JobFilter::default()
            },
        ),
        (
            "one kind",
            JobFilter {
                kind: Some(JobKind::NonwovenTensile),
                ..JobFilter::default()
            },
        ),
        (
            "none",
            JobFilter {
                outcome: Some(JobOutcome::Failed),
                ..JobFilter::default()
            },
        ),
        ("a text of one kind", of_text("QUICK")),
        ("a text of none", of_text("no such text")),
        (
            "a text of one kind, finished",
            JobFilter {
                status: Some(JobStatus::Finished),
                ..of_text("quick")
            },
        ),
    ]
}

fn of_text(text: &str) -> JobFilter {
    JobFilter {
        q: Some(text.to_owned()),
        ..JobFilter::default()
    }
}

fn passes(filter: &JobFilter, job: &Job) -> bool {
    filter.status.is_none_or(|_| job.has_result)
        && filter.kind.is_none_or(|_| job.number.is_some())
        && filter.outcome.is_none()
        && filter
            .q
            .as_ref()
            .is_none_or(|text| text.eq_ignore_ascii_case("quick") && job.number.is_some())
}

/// A number or a word of a job; results of these jobs are all the same.
fn value(job: &Job, pointer: &str) -> (Option<f64>, Option<&'static str>) {
    match pointer {
        NUMBER => (job.number, None),
        WORD => (None, job.word),
        RESULT => (job.has_result.then_some(12.5), None),
        _ => (Some(job.seed as f64), None),
    }
}

/// The whole list, a page after the other.
async fn whole(store: &Store, filter: &JobFilter, wanted: &Wanted, limit: u32) -> (Vec<Uuid>, u32) {
    let (mut ids, mut cursor, mut stops) = (Vec::new(), None, 0);
    loop {
        let page: Page<JobView> = store
            .jobs_wanted(filter, wanted, cursor.as_deref(), limit)
            .await
            .unwrap();
        assert!(page.items.len() <= limit as usize);
        ids.extend(page.items.iter().map(|job| job.id));
        stops += u32::from(page.stopped_after.is_some());
        cursor = page.next;
        if cursor.is_none() {
            return (ids, stops);
        }
    }
}

async fn keep(store: &Store) {
    for pointer in [NUMBER, WORD, RESULT, SEED] {
        let pointer: Pointer = pointer.parse().unwrap();
        assert!(store.keep_values(&pointer).await.unwrap(), "{pointer:?}");
    }
    while store.fill_values().await.unwrap() {}
}

/// Checks every list against what the jobs were submitted with; tells how often a walk stopped.
async fn check(store: &Store, jobs: &[Job]) -> u32 {
    type Holds = fn(&Job) -> bool;
    let conditions: [(&[&str], Holds); 9] = [
        (&[], |_| true),
        (&["/spec/test/strain_step>=0.03"], |job| {
            job.number >= Some(0.03)
        }),
        (&["/spec/test/strain_step=0.03"], |job| {
            job.number == Some(0.03)
        }),
        (&["/spec/test/breaking=none"], |job| {
            job.word == Some("none")
        }),
        (&["/spec/test/breaking!=none"], |job| {
            job.word.is_some_and(|word| word != "none")
        }),
        (&["/spec/seed<3", "/spec/seed>0"], |job| {
            job.seed < 3 && job.seed > 0
        }),
        (&["/spec/seed!=2", "/summary/max_force>12"], |job| {
            job.seed != 2 && job.has_result
        }),
        (
            &["/spec/seed=2", "/spec/test/breaking=weakest_first"],
            |job| job.seed == 2 && job.word == Some("weakest_first"),
        ),
        // of another type
        (&["/spec/seed=true"], |_| false),
    ];
    let mut stops = 0;
    for (name, filter) in filters() {
        for (texts, holds) in conditions {
            let passing = || {
                let passing = jobs.iter().enumerate();
                passing.filter(|(_, job)| passes(&filter, job) && holds(job))
            };
            let mut newest: Vec<Uuid> = passing().map(|(_, job)| job.id).collect();
            newest.reverse();
            let (listed, stopped) = whole(store, &filter, &wanted(texts, None), 3).await;
            assert_eq!(listed, newest, "{name} {texts:?}");
            stops += stopped;
            for pointer in [NUMBER, WORD, RESULT, SEED] {
                for is_falling in [false, true] {
                    let mut sorted: Vec<(usize, &Job)> = passing().collect();
                    sorted.sort_by(|(m, a), (n, b)| {
                        let (mine, theirs) = (value(a, pointer), value(b, pointer));
                        let has =
                            |of: (Option<f64>, Option<&str>)| of.0.is_some() || of.1.is_some();
                        if !has(mine) || !has(theirs) {
                            return has(theirs).cmp(&has(mine)).then(n.cmp(m));
                        }
                        let rising = mine
                            .partial_cmp(&theirs)
                            .unwrap_or(Ordering::Equal)
                            .then(m.cmp(n));
                        if is_falling { rising.reverse() } else { rising }
                    });
                    let expected: Vec<Uuid> = sorted.iter().map(|(_, job)| job.id).collect();
                    let sort = format!("{}{pointer}", if is_falling { "-" } else { "" });
                    let list = wanted(texts, Some(&sort));
                    let (listed, stopped) = whole(store, &filter, &list, 7).await;
                    assert_eq!(listed, expected, "{name} {texts:?} {sort}");
                    stops += stopped;
                }
            }
        }
    }
    stops
}

#[tokio::test]
async fn lists_by_kept_values_are_those_of_all_specs_however_they_are_found() {
    let lab = lab(Looks::default()).await;
    let jobs = filled(&lab).await;
    assert_eq!(check(&lab.store, &jobs).await, 0);
    keep(&lab.store).await;
    assert_eq!(check(&lab.store, &jobs).await, 0);
    // by walks, that stop and go on; with texts that are looked up at once, and in the jobs
    let Lab { store, folder } = lab;
    drop(store);
    for rare in [1, 1000] {
        let bounds = Looks {
            read: 5,
            few: 2,
            rare,
            walked: 5,
        };
        let options = StoreOptions {
            looks: bounds,
            ..options(&folder, LONG)
        };
        let store = Store::open(options).await.unwrap();
        assert!(check(&store, &jobs).await > 100);
    }
}

#[tokio::test]
async fn what_a_person_sees_is_listed_by_values_and_nothing_else() {
    for few in [1, 1000] {
        let lab = lab(Looks {
            read: 4,
            few,
            rare: 2,
            walked: 6,
        })
        .await;
        let [(ada, adas), (_, berts)] = group(&lab, ["Ada", "Bert"]).await;
        let mut hers = Vec::new();
        for n in 0..12 {
            hers.push(submit(&adas, 4 * n).await);
            submit(&berts, 4 * n).await;
        }
        let lease = lab.claim(&worker("bench")).await.unwrap().unwrap();
        lab.finish(&lease).await;
        keep(&lab.store).await;
        let filter = JobFilter {
            sight: Some(Sight {
                owner: Some(ada),
                ..Sight::default()
            }),
            ..JobFilter::default()
        };
        let own: BTreeSet<Uuid> = hers.iter().map(|job| job.id).collect();
        for sort in ["/spec/seed", "-/spec/test/breaking", "/summary/max_force"] {
            let list = wanted(&["/spec/seed>=0"], Some(sort));
            let (listed, _) = whole(&lab.store, &filter, &list, 5).await;
            assert_eq!(listed.len(), own.len(), "{sort}");
            assert_eq!(listed.into_iter().collect::<BTreeSet<_>>(), own, "{sort}");
        }
    }
}

#[tokio::test]
async fn kept_values_follow_their_jobs() {
    let lab = lab(Looks::default()).await;
    let mut jobs = filled(&lab).await;
    keep(&lab.store).await;
    jobs.push(submit(&lab.store, 40).await);
    check(&lab.store, &jobs).await;
    let lease = lab.claim(&worker("bench")).await.unwrap().unwrap();
    lab.finish(&lease).await;
    let done = jobs.iter_mut().find(|job| job.id == lease.job_id).unwrap();
    done.has_result = true;
    check(&lab.store, &jobs).await;
    let gone = jobs.remove(5);
    lab.discard(gone.id).await.unwrap();
    check(&lab.store, &jobs).await;
    lab.bring_back(gone.id).await.unwrap();
    jobs.insert(5, gone);
    check(&lab.store, &jobs).await;
}

#[tokio::test]
async fn a_list_by_a_new_value_says_that_it_is_being_gathered_and_is_whole_afterwards() {
    let lab = lab(Looks {
        read: 6,
        few: 3,
        rare: 3,
        walked: 1000,
    })
    .await;
    let jobs = filled(&lab).await;
    let by_seed = wanted(&[], Some(SEED));
    let all = JobFilter::default();
    let first = lab.jobs_wanted(&all, &by_seed, None, 50).await.unwrap();
    assert_eq!((first.items.len(), first.stopped_after), (6, Some(6)));
    assert!(first.newest_only && first.gathering);
    let newest: BTreeSet<Uuid> = jobs[34..].iter().map(|job| job.id).collect();
    assert_eq!(
        first
            .items
            .iter()
            .map(|job| job.id)
            .collect::<BTreeSet<_>>(),
        newest
    );
    while lab.fill_values().await.unwrap() {}
    let whole = lab.jobs_wanted(&all, &by_seed, None, 50).await.unwrap();
    assert_eq!((whole.items.len(), whole.stopped_after), (40, None));
    assert!(!whole.newest_only && !whole.gathering);
    // what no job has is not gathered
    let misspelt = wanted(&[], Some("/spec/sede"));
    let page = lab.jobs_wanted(&all, &misspelt, None, 50).await.unwrap();
    assert_eq!(
        (page.stopped_after, page.newest_only, page.gathering),
        (Some(6), true, false)
    );
    assert!(!lab.fill_values().await.unwrap());
}

/// Pointers to every number, word and truth of a spec.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                pointers(value, &format!("{at}/{name}"), found);
            }
        }
        Value::Array(entries) => {
            for (place, value) in entries.iter().enumerate() {
                pointers(value, &format!("{at}/{place}"), found);
            }
        }
        Value::Null => {}
        _ => found.push(at.to_owned()),
    }
}

#[tokio::test]
async fn a_field_that_nobody_asks_for_gives_way_to_another_after_a_day() {
    let folder = tempfile::tempdir().unwrap();
    let now = Arc::new(AtomicI64::new(1_700_000_000_000));
    let options = StoreOptions {
        clock: Clock::Told(Arc::clone(&now)),
        ..options(&folder, LONG)
    };
    let store = Store::open(options).await.unwrap();
    let example = JobKind::ALL.iter().flat_map(|kind| kind.examples());
    let mut fields = Vec::new();
    for example in example {
        let mut of_this = Vec::new();
        let body: Value = serde_json::from_str(example.body).unwrap();
        pointers(&body["spec"], "/spec", &mut of_this);
        if of_this.len() > 40 {
            let submission = Submission::from_slice(example.body.as_bytes()).unwrap();
            store.enqueue(&submission, None).await.unwrap();
            fields = of_this;
            break;
        }
    }
    let fields: Vec<Pointer> = fields.iter().map(|text| text.parse().unwrap()).collect();
    let mut kept = 0;
    for field in &fields {
        now.fetch_add(1, Memory::SeqCst);
        if !store.keep_values(field).await.unwrap() {
            break;
        }
        kept += 1;
    }
    assert_eq!(kept, 32);
    while store.fill_values().await.unwrap() {}
    // a day later the first is asked for and the second is not
    now.fetch_add(25 * 3600 * 1000, Memory::SeqCst);
    let by_first = wanted(&[], Some(fields[0].text()));
    store
        .jobs_wanted(&JobFilter::default(), &by_first, None, 5)
        .await
        .unwrap();
    assert!(store.keep_values(&fields[32]).await.unwrap());
    while store.fill_values().await.unwrap() {}
    for (field, is_kept) in [(0, true), (1, false), (2, true), (32, true)] {
        let list = wanted(&[], Some(fields[field].text()));
        let page = store
            .jobs_wanted(&JobFilter::default(), &list, None, 5)
            .await
            .unwrap();
        assert_eq!(page.items.len(), 1, "{field}");
        assert_eq!(
            store.keeps_values(&fields[field]).await.unwrap(),
            is_kept,
            "{field}"
        );
    }
}
