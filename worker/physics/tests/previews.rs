//! What a specimen looks like before its job is submitted is what the job's first snapshot shows, byte by byte; of
//! the kinds whose runs begin with one.
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use loadframe_api::{JobKind, JobSpec, Submission};
use loadframe_physics::{
    Decorator, Interrupt, InterruptSource, Recorder, RunContext, Uninterrupted, Unrecorded,
    preview, simulate,
};

/// Pictures by name; has the run cancelled once those of these names are there.
#[derive(Default)]
struct Album<'a> {
    pictures: BTreeMap<String, Vec<u8>>,
    until: Option<(Vec<String>, &'a AtomicBool)>,
    rest: Unrecorded,
}

impl Decorator for Album<'_> {
    fn inner(&self) -> &dyn Recorder {
        &self.rest
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        &mut self.rest
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        if !name.ends_with(".vtp") || self.pictures.contains_key(name) {
            return Ok(());
        }
        let mut content = Vec::new();
        write(&mut content)?;
        self.pictures.insert(name.to_owned(), content);
        if let Some((names, enough)) = &self.until
            && names.iter().all(|name| self.pictures.contains_key(name))
        {
            enough.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

struct Enough<'a>(&'a AtomicBool);

impl InterruptSource for Enough<'_> {
    fn interrupt(&self) -> Option<Interrupt> {
        self.0.load(Ordering::Relaxed).then_some(Interrupt::Cancel)
    }
}

/// The sentence of a preview, its pictures, and those of the same names that the run has made.
type Beside = (String, BTreeMap<String, Vec<u8>>, BTreeMap<String, Vec<u8>>);

fn beside(spec: &JobSpec) -> Beside {
    let context = |interrupt| RunContext {
        threads: 1,
        interrupt,
        checkpoint: None,
    };
    let mut before = Album::default();
    let shows = preview(spec, context(&Uninterrupted), &mut before).expect("it can be drawn");
    let enough = AtomicBool::new(false);
    let names = before.pictures.keys().cloned().collect();
    let mut run = Album {
        until: Some((names, &enough)),
        ..Album::default()
    };
    let _ = simulate(spec, context(&Enough(&enough)), &mut run).expect("it runs");
    (shows, before.pictures, run.pictures)
}

#[test]
fn pictures_before_a_job_are_its_first_snapshots() {
    for kind in [JobKind::NonwovenTensile, JobKind::GranularScene] {
        let with_pictures = |body: &str| body.contains("snapshot_every_steps");
        let mut examples = kind.examples().iter();
        let example = examples.find(|example| with_pictures(example.body));
        let body = example.expect("an example with pictures").body;
        let job = Submission::from_slice(body.as_bytes()).expect("an example");
        let (shows, before, run) = beside(&job.spec);
        assert!(
            !before.is_empty() && shows.ends_with('.'),
            "{kind}: {shows}"
        );
        for (name, picture) in &before {
            assert!(run.get(name) == Some(picture), "{kind}: {name} differs");
        }
    }
}
