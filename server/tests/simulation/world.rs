//! The world: what happens when, by a stream of random numbers.
use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

use crate::happening::{Call, Happening, Line, Party};
use crate::history::History;
use crate::network::Network;
use crate::people::Person;
use crate::server::{Answer, Request, Server};
use crate::words::told;
use crate::worker::Worker;

/// Until then anything happens [ms]; from then on nothing bad does.
const BAD_TIMES: i64 = 150_000;
/// By then everything has come to its end [ms]: machines that were at fault are set aside for minutes.
const END: i64 = BAD_TIMES + 3 * 3_600_000;
/// Where the clock of the server begins [ms since 1970].
const BEGIN: i64 = 1_795_000_000_000;
/// An answer that does not come for so long is not waited for any more [ms].
const PATIENCE: i64 = 5_000;
const SWEEP_EVERY: i64 = 1_000;
const HEARTBEAT_EVERY: i64 = 4_000;
const WORKERS: usize = 4;
const PEOPLE: usize = 2;

pub(crate) struct World {
    seed: u64,
    rng: ChaCha8Rng,
    now: i64,
    /// What is to come, by moment and order.
    future: BTreeMap<(i64, u64), Happening>,
    order: u64,
    calls: u64,
    network: Network,
    server: Server,
    dies_after_next: bool,
    frozen_until: i64,
    leapt: i64,
    workers: Vec<Worker>,
    worker_frozen_until: [i64; WORKERS],
    cut_until: [i64; WORKERS],
    people: Vec<Person>,
    /// Of workers, then people: number of the process, and what it waits for on both lines.
    processes: Vec<(u64, [Option<Call>; 2])>,
    is_whole: bool,
    history: History,
    trace: Vec<String>,
    folder: TempDir,
}

impl World {
    pub(crate) async fn new(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // in memory where there is such a folder: what a disk forgets is tried elsewhere
        let memory = std::path::Path::new("/dev/shm");
        let folder = if memory.is_dir() {
            tempfile::tempdir_in(memory).unwrap()
        } else {
            tempfile::tempdir().unwrap()
        };
        let mut world = Self {
            seed,
            now: 0,
            future: BTreeMap::new(),
            order: 0,
            calls: 0,
            network: Network::new(&mut rng),
            server: Server::new(folder.path()),
            dies_after_next: false,
            frozen_until: 0,
            leapt: 0,
            workers: (0..WORKERS).map(Worker::new).collect(),
            worker_frozen_until: [0; WORKERS],
            cut_until: [0; WORKERS],
            people: (0..PEOPLE).map(Person::new).collect(),
            processes: (0..WORKERS + PEOPLE).map(|_| (0, [None, None])).collect(),
            is_whole: false,
            history: History::default(),
            trace: Vec::new(),
            folder,
            rng,
        };
        world.server.set_clock(BEGIN);
        world.server.start().await;
        world.foretell();
        world
    }

    /// What happened, line by line; of the world nothing stays.
    pub(crate) async fn end(mut self) -> Vec<String> {
        self.server.kill();
        crate::schema::forget(self.folder.path()).await;
        std::mem::take(&mut self.trace)
    }

    /// Puts the world's troubles into the future; each kind comes under some seeds only.
    fn foretell(&mut self) {
        self.after(0, Happening::Sweep);
        self.after(0, Happening::Follow);
        self.after(BAD_TIMES, Happening::Mend);
        for number in 0..WORKERS {
            self.begin(Party::Worker(number));
        }
        for number in 0..PEOPLE {
            self.begin(Party::Person(number));
        }
        for kind in 0..7 {
            let most = [3, 3, 2, 2, 5, 4, 6][kind];
            let times = if self.rng.random_bool(0.6) {
                self.rng.random_range(1..=most)
            } else {
                0
            };
            for _ in 0..times {
                let at = self.rng.random_range(0..BAD_TIMES);
                let length = self.rng.random_range(500..90_000);
                let worker = self.rng.random_range(0..WORKERS);
                let hour = self.rng.random_range(-3_600_000..3_600_000);
                let happening = match kind {
                    0 => Happening::Kill { after_next: false },
                    1 => Happening::Kill { after_next: true },
                    2 => Happening::Freeze(length),
                    3 => Happening::Leap(hour),
                    4 => Happening::Cut(worker, length),
                    5 => Happening::FreezeWorker(worker, length),
                    _ => Happening::KillWorker(worker),
                };
                self.at(at, happening);
            }
        }
    }

    fn at(&mut self, moment: i64, happening: Happening) {
        self.order += 1;
        self.future.insert((moment, self.order), happening);
    }

    fn after(&mut self, wait: i64, happening: Happening) {
        self.at(self.now + wait, happening);
    }

    fn index(party: Party) -> usize {
        match party {
            Party::Worker(number) => number,
            Party::Person(number) => WORKERS + number,
        }
    }

    /// The line of the party's process of now.
    fn line(&self, party: Party, is_heartbeat: bool) -> Line {
        Line {
            party,
            process: self.processes[Self::index(party)].0,
            is_heartbeat,
        }
    }

    fn begin(&mut self, party: Party) {
        let wait = self.rng.random_range(0..3_000);
        self.after(wait, Happening::Acts(self.line(party, false)));
        if matches!(party, Party::Worker(_)) {
            self.after(wait, Happening::Acts(self.line(party, true)));
        }
    }

    fn call(&mut self, line: Line) -> &mut Option<Call> {
        &mut self.processes[Self::index(line.party)].1[usize::from(line.is_heartbeat)]
    }

    fn say(&mut self, text: impl FnOnce(&Self) -> String) {
        let line = format!("{:>8} {}", self.now, text(self));
        self.trace.push(line);
    }

    /// Lets everything happen, until all jobs have ended.
    pub(crate) async fn run(&mut self) {
        while let Some(((moment, _), happening)) = self.future.pop_first() {
            self.now = moment;
            assert!(moment < END, "jobs that do not end");
            self.server.set_clock(BEGIN + self.now + self.leapt);
            self.history.now = moment;
            if let Some((until, happening)) = self.held_up(happening) {
                match until {
                    Some(until) => self.at(until, happening),
                    None => {
                        if self.happen(happening).await {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Until when something frozen holds up what would happen; nothing where it does not happen at all.
    fn held_up(&self, happening: Happening) -> Option<(Option<i64>, Happening)> {
        let frozen = match &happening {
            Happening::Arrives(line, ..) if self.is_cut(*line) => return None,
            Happening::Answered(line, ..) if self.is_cut(*line) => return None,
            Happening::Arrives(..) | Happening::Sweep | Happening::Follow => self.frozen_until,
            Happening::Answered(line, ..) | Happening::Acts(line) | Happening::Waited(line, _) => {
                match line.party {
                    Party::Worker(number) => self.worker_frozen_until[number],
                    Party::Person(_) => 0,
                }
            }
            _ => 0,
        };
        Some(((frozen > self.now).then_some(frozen), happening))
    }

    fn is_cut(&self, line: Line) -> bool {
        matches!(line.party, Party::Worker(number) if self.cut_until[number] > self.now)
    }

    /// Whether all has come to its end.
    async fn happen(&mut self, happening: Happening) -> bool {
        match happening {
            Happening::Arrives(line, number, request) => self.arrive(line, number, request).await,
            Happening::Answered(line, number, answer) => self.answered(line, number, answer),
            Happening::Acts(line) => self.act(line),
            Happening::Waited(line, number) => self.send_again(line, number),
            Happening::Sweep => {
                self.server.sweep().await;
                if let Some(store) = self.server.store() {
                    self.history.look_at_changed(store).await;
                }
                self.after(SWEEP_EVERY, Happening::Sweep);
            }
            Happening::Follow => {
                if let Some(store) = self.server.store() {
                    self.history.follow(store).await;
                }
                if self.is_whole && self.is_settled().await {
                    let store = self.server.store().expect("a server that is up");
                    self.history.settled(store).await;
                    return true;
                }
                self.after(7_300, Happening::Follow);
            }
            Happening::Kill { after_next: true } => self.dies_after_next = true,
            Happening::Kill { after_next: false } => self.kill(),
            Happening::Start => {
                self.say(|_| "the server starts".to_owned());
                self.server.start().await;
            }
            Happening::Freeze(length) => {
                self.say(|_| format!("the server freezes for {length} ms"));
                self.frozen_until = self.now + length;
            }
            Happening::Leap(by) => {
                self.say(|_| format!("the clock leaps by {by} ms"));
                self.leapt += by;
            }
            Happening::Cut(worker, length) => {
                self.say(|_| format!("worker {worker} is cut off for {length} ms"));
                self.cut_until[worker] = self.now + length;
            }
            Happening::FreezeWorker(worker, length) => {
                self.say(|_| format!("worker {worker} freezes for {length} ms"));
                self.worker_frozen_until[worker] = self.now + length;
            }
            Happening::KillWorker(worker) => {
                self.say(|_| format!("worker {worker} is killed"));
                self.workers[worker].start_again();
                let process = &mut self.processes[worker];
                *process = (process.0 + 1, [None, None]);
                self.begin(Party::Worker(worker));
            }
            Happening::Mend => {
                self.say(|_| "bad times are over".to_owned());
                self.is_whole = true;
                self.network.mend();
                self.dies_after_next = false;
                self.frozen_until = 0;
                self.worker_frozen_until = [0; WORKERS];
                self.cut_until = [0; WORKERS];
            }
        }
        false
    }

    fn kill(&mut self) {
        if self.server.store().is_some() {
            self.say(|_| "the server is killed".to_owned());
            self.server.kill();
            let away = self.rng.random_range(200..60_000);
            self.after(away, Happening::Start);
        }
    }

    /// Whether every job has ended and nobody is at one.
    async fn is_settled(&mut self) -> bool {
        let Some(store) = self.server.store() else {
            return false;
        };
        for id in self.history.jobs().collect::<Vec<_>>() {
            if store.job(id).await.unwrap().outcome.is_none() {
                return false;
            }
        }
        let has_all = self.people.iter().all(Person::has_submitted_all);
        has_all && self.workers.iter().all(Worker::is_idle)
    }

    async fn arrive(&mut self, line: Line, number: u64, request: Request) {
        if self.server.store().is_none() {
            return;
        }
        let answer = self.server.serve(request.clone()).await;
        let store = self.server.store().expect("it is up");
        self.history.saw(store, &request, &answer).await;
        let told = told(&self.history, &request, &answer);
        self.say(|_| format!("{:?} {number}: {told}", line.party));
        if self.dies_after_next {
            self.dies_after_next = false;
            self.kill();
            return;
        }
        for way in self.network.ways(&mut self.rng) {
            self.after(way, Happening::Answered(line, number, answer.clone()));
        }
    }

    fn answered(&mut self, line: Line, number: u64, answer: Answer) {
        if line != self.line(line.party, line.is_heartbeat) {
            return;
        }
        let call = self.call(line);
        if call.as_ref().is_none_or(|call| call.number != number) {
            return;
        }
        let call = call.take().expect("the call");
        match line.party {
            Party::Worker(worker) => self.workers[worker].hear(&call.request, answer),
            Party::Person(person) => self.people[person].hear(&call.request, answer),
        }
    }

    /// Lets a process do what it does next, unless it waits for an answer.
    fn act(&mut self, line: Line) {
        if line != self.line(line.party, line.is_heartbeat) {
            return;
        }
        let (rng, is_whole) = (&mut self.rng, self.is_whole);
        let (request, wait) = match line.party {
            Party::Worker(number) if line.is_heartbeat => {
                (self.workers[number].heartbeat(), HEARTBEAT_EVERY)
            }
            Party::Worker(_) => (None, rng.random_range(500..6_000)),
            Party::Person(_) if is_whole => (None, 30_000),
            Party::Person(_) => (None, rng.random_range(1_000..15_000)),
        };
        self.after(wait, Happening::Acts(line));
        if self.call(line).is_some() {
            return;
        }
        let rng = &mut self.rng;
        let request = match line.party {
            _ if line.is_heartbeat => request,
            Party::Worker(number) => self.workers[number].next(rng, is_whole),
            Party::Person(number) => self.people[number].next(rng, is_whole),
        };
        let Some(request) = request else { return };
        self.calls += 1;
        let number = self.calls;
        *self.call(line) = Some(Call { number, request });
        self.send(line, number);
    }

    /// Sends what the line waits for.
    fn send(&mut self, line: Line, number: u64) {
        let request = self.call(line).as_ref().map(|call| call.request.clone());
        let request = request.expect("a call");
        if !self.is_cut(line) {
            for way in self.network.ways(&mut self.rng) {
                self.after(way, Happening::Arrives(line, number, request.clone()));
            }
        }
        self.after(PATIENCE, Happening::Waited(line, number));
    }

    fn send_again(&mut self, line: Line, number: u64) {
        let is_same = line == self.line(line.party, line.is_heartbeat);
        let waits = self
            .call(line)
            .as_ref()
            .is_some_and(|call| call.number == number);
        if is_same && waits {
            self.send(line, number);
        }
    }
}

impl Drop for World {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let last = self.trace.len().saturating_sub(100);
            eprintln!(
                "seed {}, after\n{}",
                self.seed,
                self.trace[last..].join("\n")
            );
            eprintln!("{:>8} in {}", self.now, self.folder.path().display());
        }
    }
}
