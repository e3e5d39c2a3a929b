//! From the rows of a scene to those of a test.
use std::io::{self, Write};

use loadframe_api::{
    Report,
    spec::ballast::{BED, Phase, Script},
};
use loadframe_harness::Recorder;

use super::{cycles, oedometer, report, tables};

/// A row of the scene, in terms of the test.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// [s].
    pub(super) time: f64,
    pub(super) stage: usize,
    /// Height of the loading wall's lower face [m].
    pub(super) height: f64,
    /// Of the bed on the loading wall, without the wall's weight [N].
    pub(super) force: f64,
    pub(super) coordination: f64,
    pub(super) unbalanced: f64,
    pub(super) step_ratio: f64,
    /// I and mean stress [Pa] of the bed.
    pub(super) inertial_number: f64,
    pub(super) mean_stress: f64,
    /// Number of the row.
    number: usize,
    /// Solid volume of the bed [m³].
    pub(super) bed_solid: f64,
    pub(super) broken_bonds: Option<f64>,
}

/// Places of what is read in a row of the scene.
#[derive(Debug, Default)]
struct Places {
    time: usize,
    stage: usize,
    displacement: usize,
    force: usize,
    coordination: usize,
    unbalanced: usize,
    step_ratio: usize,
    inertial_number: usize,
    mean_stress: usize,
    /// Of the slices, and of the bed.
    porosities: Vec<usize>,
    broken_bonds: Option<usize>,
}

/// Stands between the engine and the recorder of a job.
pub(super) struct Tester<'a> {
    pub(super) script: &'a Script,
    recorder: &'a mut dyn Recorder,
    places: Places,
    /// Volume of the boxes of slices and bed [m³], of which the scene gives the porosity.
    boxes: Vec<f64>,
    /// Every row so far.
    pub(super) rows: Vec<Row>,
    /// Solid volumes of slices [m³], row after row: many small vectors among the engine's large ones
    /// would keep memory from being used again.
    solids: Vec<f64>,
    /// Where the cycles begin: time [s] and height [m].
    start: Option<(f64, f64)>,
    /// The scene's table of fragments.
    fragments: Vec<u8>,
}

impl<'a> Tester<'a> {
    pub(super) fn new(script: &'a Script, recorder: &'a mut dyn Recorder) -> Self {
        let boxes = script.scene.record.regions.iter().map(|region| {
            let (low, high) = (
                region.low_m.unwrap_or_default(),
                region.high_m.unwrap_or_default(),
            );
            (0..3).map(|axis| high[axis] - low[axis]).product()
        });
        Self {
            script,
            recorder,
            places: Places::default(),
            boxes: boxes.collect(),
            rows: Vec::new(),
            solids: Vec::new(),
            start: None,
            fragments: Vec::new(),
        }
    }

    fn read(&mut self, values: &[f64]) -> Row {
        let places = &self.places;
        let porosities = places.porosities.iter().map(|place| values[*place]);
        let solids = porosities
            .zip(&self.boxes)
            .map(|(porosity, volume)| (1.0 - porosity) * volume);
        self.solids.extend(solids);
        let bed_solid = self.solids.pop().unwrap_or(f64::NAN);
        let height = self.script.wall_height + values[places.displacement];
        // the bed fills a part of the box in which it is measured: p ~ 1/V, I ~ 1/√p
        let fill = self.script.bed.room(self.script.loaded_area, height)
            / self.boxes.last().copied().unwrap_or(f64::NAN);
        Row {
            time: values[places.time],
            stage: values[places.stage] as usize,
            height,
            force: values[places.force] - self.script.weight,
            coordination: values[places.coordination],
            unbalanced: values[places.unbalanced],
            step_ratio: values[places.step_ratio],
            inertial_number: values[places.inertial_number] * fill.sqrt(),
            mean_stress: values[places.mean_stress] / fill,
            number: self.rows.len(),
            bed_solid,
            broken_bonds: places.broken_bonds.map(|place| values[place]),
        }
    }

    /// Solid volume of each slice at a row [m³].
    pub(super) fn solids(&self, row: &Row) -> &[f64] {
        let count = self.script.slices.len();
        &self.solids[row.number * count..][..count]
    }

    fn phase(&self, stage: usize) -> Option<Phase> {
        self.script.phases.get(stage).copied()
    }

    /// Rows of the cycles, with what they are measured from: time [s] and height [m].
    pub(super) fn loading(&self) -> (impl Iterator<Item = &Row> + Clone, (f64, f64)) {
        let rows = self.rows.iter();
        let rows = rows.filter(|row| self.phase(row.stage) == Some(Phase::Load));
        (rows, self.start.unwrap_or_default())
    }

    /// The last row before the cycles.
    pub(super) fn last_before_loading(&self) -> Option<&Row> {
        let mut rows = self.rows.iter().rev();
        rows.find(|row| self.phase(row.stage) != Some(Phase::Load))
    }

    /// Makes files and the report of the test.
    ///
    /// # Errors
    /// Of the recorder.
    pub(super) fn conclude(&mut self, scene: Report) -> io::Result<Report> {
        let cycles = cycles::of(self);
        let oedometer = oedometer::of(self);
        tables::write(self, &cycles, oedometer.as_ref())?;
        Ok(report::report(self, scene, &cycles, oedometer.as_ref()))
    }

    /// Gives a file to the job's recorder.
    pub(super) fn write(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        self.recorder.file(name, write)
    }

    /// The scene's table of fragments, if grains break.
    pub(super) fn fragments(&self) -> &str {
        std::str::from_utf8(&self.fragments).unwrap_or_default()
    }
}

impl Recorder for Tester<'_> {
    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        let place = |name: &str| names.iter().position(|known| *known == name);
        let known = |name: &str| place(name).unwrap_or_default();
        let wall = &self.script.wall;
        let slices = self.script.slices.iter().chain([&self.script.bed]);
        self.places = Places {
            time: known("time_s"),
            stage: known("stage"),
            displacement: known(&format!("{wall}_displacement_z_m")),
            force: known(&format!("{wall}_force_z_n")),
            coordination: known("coordination_number"),
            unbalanced: known("unbalanced_force_ratio"),
            step_ratio: known("step_over_critical"),
            inertial_number: known(&format!("{BED}_inertial_number")),
            mean_stress: known(&format!("{BED}_mean_stress_pa")),
            porosities: slices
                .map(|slice| known(&format!("{}_porosity", slice.name)))
                .collect(),
            broken_bonds: place("broken_bonds"),
        };
        self.rows.clear();
        self.solids.clear();
        self.start = None;
        self.recorder.columns(&tables::curve_columns(self.script))
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        let row = self.read(values);
        if self.phase(row.stage) == Some(Phase::Load) {
            let before = self.rows.last().unwrap_or(&row);
            let start = *self.start.get_or_insert((before.time, before.height));
            self.recorder
                .point(&tables::curve_row(self.script, &row, start))?;
        }
        self.rows.push(row);
        Ok(())
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        match name {
            // the test has a curve of its own
            "curve.csv" => return Ok(()),
            "fragments.csv" => {
                self.fragments.clear();
                write(&mut self.fragments)?;
            }
            _ => {}
        }
        self.recorder.file(name, write)
    }

    fn progress(&mut self, fraction: f64, phase: &str) {
        self.recorder.progress(fraction, phase);
    }

    fn log(&mut self, message: &str) {
        self.recorder.log(message);
    }

    fn checkpoint_due(&self) -> bool {
        self.recorder.checkpoint_due()
    }

    fn checkpoint(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.recorder.checkpoint(bytes)
    }
}
