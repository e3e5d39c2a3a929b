//! The tests of a job: repeats of a specimen, each in one or two directions.
//!
//! A job of one test goes straight to [`super::run_one`]; otherwise [`test_specimens`] carries them out
//! and joins their results.
use loadframe_api::{Report, spec::nonwoven_tensile::NonwovenTensile};
use loadframe_harness::{
    Ending, Recorder, RunContext, SimulationError,
    checkpoint::Fingerprint,
    plan::{Compared, Place, Specimens, test_specimens},
};

/// Leading columns of the curve that are kept of every test: nominal strain and force, and with a
/// history cycle and direction.
const KEPT_COLUMNS: [usize; 2] = [2, 4];
/// Results compared between directions, in units that do not depend on the specimen's size.
const COMPARED: [Compared; 4] = [
    ("strength", "Strength"),
    ("strain_at_max_force", "Strain at max force"),
    ("modulus_at_10_percent", "Modulus at 10 %"),
    ("poisson_ratio", "Poisson ratio"),
];

/// Runs everything `spec` asks for.
///
/// # Errors
/// What made a result impossible, see [`SimulationError`].
pub fn run(
    spec: &NonwovenTensile,
    context: RunContext<'_>,
    recorder: &mut dyn Recorder,
) -> Result<Ending, SimulationError> {
    if spec.test.repeats <= 1 && spec.test.directions.len() <= 1 {
        return super::run_one(spec, context, recorder);
    }
    test_specimens(&Repeats(spec), Fingerprint::of(spec)?, context, recorder)
}

/// The specimens of a spec.
struct Repeats<'a>(&'a NonwovenTensile);

impl Repeats<'_> {
    /// The spec of a test, on its own.
    fn spec_of(&self, place: Place) -> NonwovenTensile {
        let mut own = self.0.clone();
        own.test.repeats = 1;
        let direction = self.0.test.directions.get(place.direction);
        own.test.directions = direction.copied().into_iter().collect();
        own.seed += place.specimen as u64;
        if place.specimen > 0 {
            // nobody would see them
            own.output.snapshot_every_steps = 0;
            own.output.force_distribution_strains.clear();
            own.output.force_landscape = None;
        }
        own
    }
}

impl Specimens for Repeats<'_> {
    fn count(&self) -> usize {
        self.0.test.repeats as usize
    }

    fn first_seed(&self) -> u64 {
        self.0.seed
    }

    fn directions(&self) -> Vec<&'static str> {
        let directions = self.0.test.directions.iter();
        directions.map(|direction| direction.name()).collect()
    }

    fn compared(&self) -> &'static [Compared] {
        &COMPARED
    }

    fn kept_columns(&self) -> usize {
        KEPT_COLUMNS[usize::from(!self.0.test.history.is_empty())]
    }

    fn overview(&self) -> String {
        let repeats = self.0.test.repeats;
        let last = self.0.seed + u64::from(repeats.saturating_sub(1));
        let specimens = match repeats {
            1 => "one specimen".to_owned(),
            _ => format!("{repeats} repeats, seeds {} to {last}", self.0.seed),
        };
        match self.directions().as_slice() {
            [first, second] => format!("{specimens}, along {first} and along {second}"),
            _ => specimens,
        }
    }

    fn line(&self, place: Place, report: &Report) -> Option<String> {
        let along = match self.directions().as_slice() {
            directions @ [_, _] => format!(" along {}", directions[place.direction]),
            _ => String::new(),
        };
        let value = |name: &str| report.summary.get(name).and_then(|quantity| quantity.value);
        Some(format!(
            "seed {}{along}: {}, maximum force {} N, {} bonds broken",
            self.0.seed + place.specimen as u64,
            report.stop_reason.replace('_', " "),
            value("max_force").unwrap_or(f64::NAN),
            value("broken_bonds").unwrap_or(f64::NAN),
        ))
    }

    fn test(
        &self,
        place: Place,
        context: RunContext<'_>,
        recorder: &mut dyn Recorder,
    ) -> Result<Ending, SimulationError> {
        super::run_one(&self.spec_of(place), context, recorder)
    }
}
