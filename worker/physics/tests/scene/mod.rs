//! What the tests share: specs to start from, a recorder that keeps everything, interrupts on
//! demand.
#![allow(dead_code, reason = "every test file uses its own part of this")]

use std::{
    collections::BTreeMap,
    io::{self, Write},
    sync::atomic::{AtomicU64, Ordering},
};

use loadframe_api::{
    JobSpec, Report,
    spec::nonwoven_tensile::{
        Accuracy, Bond, Breaking, Fabric, Jaw, Jaws, Knobs, Lattice, Network, NetworkBond,
        NonwovenTensile, Output, Solver, Test,
    },
};
use loadframe_physics::{
    Ending, Interrupt, InterruptSource, Recorder, RunContext, SimulationError, Uninterrupted,
    simulate,
};

/// The needle-punched polyester of [Zilka2022] tables 5 and 6 on a lattice of any size.
pub(crate) fn polyester(points_per_row: u32, rows: u32, layers: u32) -> NonwovenTensile {
    NonwovenTensile {
        version: 1,
        seed: 1,
        fabric: Fabric::Lattice(Lattice {
            points_per_row,
            rows,
            layers,
            spacing_mm: [20.0, 20.0, 10.0],
            irregularity: [0.5; 3],
            jaws: Jaws::HalfBond,
            thickness_mm: None,
            grammage_g_per_m2: None,
        }),
        bond: Bond {
            modulus_n: Some(0.399),
            friction_modulus_n: 1.473,
            compression_stiffness_n: 0.157,
            mean_strength_n: Some(3.397),
            strength_sigma: 0.365,
            strength_draw: Default::default(),
        },
        test: Test::default(),
        accuracy: solver(Solver::NewtonCg, 100.0),
        output: Output {
            snapshot_every_steps: 0,
            ..Output::default()
        },
    }
}

pub(crate) fn solver(solver: Solver, force_accuracy: f64) -> Accuracy {
    Accuracy::Knobs(Knobs {
        solver,
        force_accuracy,
        ..Knobs::default()
    })
}

/// The lattice of a spec made by [`polyester`].
pub(crate) fn lattice(spec: &mut NonwovenTensile) -> &mut Lattice {
    match &mut spec.fabric {
        Fabric::Lattice(lattice) => lattice,
        Fabric::Network(_) => panic!("the spec has a network"),
    }
}

/// An explicit network without breaking, solved as exactly as doubles allow.
pub(crate) fn explicit(
    nodes: &[([f64; 3], Jaw)],
    bonds: Vec<NetworkBond>,
    bond: Bond,
) -> NonwovenTensile {
    NonwovenTensile {
        fabric: Fabric::Network(Network {
            nodes_mm: nodes.iter().map(|(position, _)| *position).collect(),
            jaws: nodes.iter().map(|(_, jaw)| *jaw).collect(),
            bonds,
            width_mm: Some(10.0),
            thickness_mm: None,
            grammage_g_per_m2: None,
        }),
        bond,
        test: Test {
            breaking: Breaking::None,
            ..Test::default()
        },
        accuracy: solver(Solver::NewtonCg, 1e15),
        ..polyester(1, 1, 1)
    }
}

/// A bond with nothing of its own.
pub(crate) fn bond(first: u32, second: u32) -> NetworkBond {
    NetworkBond {
        nodes: [first, second],
        rest_length_mm: None,
        modulus_n: None,
        friction_modulus_n: None,
        compression_stiffness_n: None,
        strength_n: None,
    }
}

/// Everything a run said.
#[derive(Debug, Default)]
pub(crate) struct Record {
    pub(crate) columns: Vec<String>,
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    pub(crate) fractions: Vec<f64>,
    pub(crate) checkpoint: Option<Vec<u8>>,
    /// Whether to ask for a checkpoint whenever one may be asked for.
    pub(crate) always_checkpoint: bool,
}

impl Recorder for Record {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        self.columns = names.iter().map(|name| (*name).to_owned()).collect();
        self.points.clear();
        Ok(())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        assert_eq!(values.len(), self.columns.len());
        self.points.push(values.to_vec());
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        self.files.insert(name.to_owned(), bytes);
        Ok(())
    }

    fn progress(&mut self, fraction: f64, _phase: &str) {
        self.fractions.push(fraction);
    }

    fn log(&mut self, _message: &str) {}

    fn checkpoint_due(&self) -> bool {
        self.always_checkpoint
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checkpoint = Some(bytes.to_vec());
        Ok(())
    }
}

impl Record {
    /// A column of the curve.
    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let column = self.columns.iter().position(|column| column == name);
        let column = column.unwrap_or_else(|| panic!("no column {name}"));
        self.points.iter().map(|point| point[column]).collect()
    }

    /// The rows of a table, without its header; what is not known is no number.
    pub(crate) fn table(&self, name: &str) -> Vec<Vec<f64>> {
        let text = std::str::from_utf8(&self.files[name]).expect("tables are text");
        let rows = text.lines().skip(1);
        rows.map(|row| {
            let cells = row.split(',');
            let number = |cell: &str| match cell {
                "" => f64::NAN,
                cell => cell.parse().expect("a number"),
            };
            cells.map(number).collect()
        })
        .collect()
    }
}

/// Interrupts from the n-th look on, counted from 1.
#[derive(Debug)]
pub(crate) struct AtLook {
    pub(crate) interrupt: Interrupt,
    looks_left: AtomicU64,
}

impl AtLook {
    pub(crate) fn new(interrupt: Interrupt, look: u64) -> Self {
        Self {
            interrupt,
            looks_left: AtomicU64::new(look),
        }
    }
}

impl InterruptSource for AtLook {
    fn interrupt(&self) -> Option<Interrupt> {
        let one_less = |left: u64| Some(left.saturating_sub(1));
        let before = self
            .looks_left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less);
        (before.unwrap_or_default() <= 1).then_some(self.interrupt)
    }
}

/// Runs a spec from `checkpoint` until `interrupt`.
pub(crate) fn run_with(
    spec: &NonwovenTensile,
    record: &mut Record,
    interrupt: &dyn InterruptSource,
    checkpoint: Option<&[u8]>,
    threads: usize,
) -> Ending {
    let job = JobSpec::NonwovenTensile(Box::new(spec.clone()));
    run_job(&job, record, interrupt, checkpoint, threads).expect("the spec can be simulated")
}

/// Runs a job of any kind from `checkpoint` until `interrupt`.
pub(crate) fn run_job(
    job: &JobSpec,
    record: &mut Record,
    interrupt: &dyn InterruptSource,
    checkpoint: Option<&[u8]>,
    threads: usize,
) -> Result<Ending, SimulationError> {
    let context = RunContext {
        threads,
        interrupt,
        checkpoint,
    };
    simulate(job, context, record)
}

/// Runs a spec to its end on one thread.
pub(crate) fn run(spec: &NonwovenTensile) -> (Report, Record) {
    let mut record = Record::default();
    match run_with(spec, &mut record, &Uninterrupted, None, 1) {
        Ending::Finished(report) => (report, record),
        ending => panic!("{ending:?}"),
    }
}

/// The report of a run that was not stopped.
pub(crate) fn finished(ending: Ending) -> Report {
    match ending {
        Ending::Finished(report) => report,
        ending => panic!("{ending:?}"),
    }
}

/// What a resumed run must have in common with one that was not stopped; work is a cost.
pub(crate) fn assert_same(expected: &(Report, Record), found: &(Report, Record)) {
    let without_work = |report: &Report| Report {
        work: Default::default(),
        ..report.clone()
    };
    assert_eq!(without_work(&expected.0), without_work(&found.0));
    assert_eq!(expected.1.columns, found.1.columns);
    assert_eq!(expected.1.points, found.1.points);
    let names = |record: &Record| record.files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&expected.1), names(&found.1));
    for (name, bytes) in &expected.1.files {
        assert!(*bytes == found.1.files[name], "{name} differs");
    }
}

/// Suspends a run every so many looks until it has finished.
pub(crate) fn suspended_again_and_again(
    spec: &NonwovenTensile,
    looks: u64,
    threads: usize,
) -> (Report, Record) {
    let (mut record, mut checkpoint, mut pieces) = (Record::default(), None, 0);
    let report = loop {
        pieces += 1;
        let interrupt = AtLook::new(Interrupt::Suspend, looks);
        let from: Option<&Vec<u8>> = checkpoint.as_ref();
        let from = from.map(Vec::as_slice);
        match run_with(spec, &mut record, &interrupt, from, threads) {
            Ending::Suspended => checkpoint = record.checkpoint.clone(),
            ending => break finished(ending),
        }
    };
    assert!(pieces > 1, "{looks} looks did not suspend");
    (report, record)
}

/// A value of the summary.
pub(crate) fn value(report: &Report, name: &str) -> f64 {
    let quantity = &report.summary[name];
    quantity
        .value
        .unwrap_or_else(|| panic!("{name} is unknown"))
}

/// The numbers of a Float64 array in a `.vtp` file.
pub(crate) fn floats(file: &[u8], name: &str) -> Vec<f64> {
    let bytes = array(file, name);
    let numbers = bytes.chunks_exact(8);
    numbers
        .map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")))
        .collect()
}

/// The bytes of an array in a `.vtp` file, decompressed.
pub(crate) fn array(file: &[u8], name: &str) -> Vec<u8> {
    let find = |text: &[u8], from: usize| {
        let windows = file[from..].windows(text.len());
        let place = windows.into_iter().position(|window| window == text);
        from + place.expect("the file has it") + text.len()
    };
    let header = find(format!("Name=\"{name}\"").as_bytes(), 0);
    let offset = find(b"offset=\"", header);
    let digits = file[offset..]
        .iter()
        .take_while(|byte| byte.is_ascii_digit());
    let offset = digits.fold(0, |value, digit| 10 * value + usize::from(digit - b'0'));
    let data = &file[find(b"<AppendedData encoding=\"raw\">\n_", 0) + offset..];
    let number = |index: usize| {
        let bytes = data[8 * index..8 * index + 8].try_into();
        u64::from_le_bytes(bytes.expect("eight bytes")) as usize
    };
    let blocks = number(0);
    let mut bytes = Vec::new();
    let mut from = 8 * (3 + blocks);
    for block in 0..blocks {
        let length = number(3 + block);
        let mut decoder = flate2::read::ZlibDecoder::new(&data[from..from + length]);
        io::Read::read_to_end(&mut decoder, &mut bytes).expect("a zlib stream");
        from += length;
    }
    bytes
}
