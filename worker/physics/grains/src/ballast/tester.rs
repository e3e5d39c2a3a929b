//! From the rows of a scene to those of a test.
use std::io::{self, Write};

use loadframe_api::{
    Report,
    spec::ballast::{BED, Script},
};
use loadframe_harness::{Decorator, Recorder};

use super::{
    cycles,
    heard::{Heard, Row},
    moments::Moments,
    oedometer, report, tables, voids,
};
use crate::output::journal::Journal;

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
    stress: [usize; 6],
    /// Vertical forces on the base and on each side, normal forces on each side.
    base: usize,
    sides: [Vec<usize>; 2],
    /// Of the slices, and of the bed.
    porosities: Vec<usize>,
    /// About x, y, z, of a sleeper that tilts.
    turn: Option<[usize; 3]>,
    broken_bonds: Option<usize>,
}

/// Stands between the engine and the recorder of a job.
pub(super) struct Tester<'a> {
    recorder: &'a mut dyn Recorder,
    places: Places,
    /// Volume of the boxes of slices and bed [m³], of which the scene gives the porosity.
    boxes: Vec<f64>,
    pub(super) heard: Heard<'a>,
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
            recorder,
            places: Places::default(),
            boxes: boxes.collect(),
            heard: Heard::new(script),
        }
    }

    fn read(&mut self, values: &[f64]) -> Row {
        let places = &self.places;
        let porosities = places.porosities.iter().map(|place| values[*place]);
        let solids = porosities
            .zip(&self.boxes)
            .map(|(porosity, volume)| (1.0 - porosity) * volume);
        self.heard.solids.extend(solids);
        let bed_solid = self.heard.solids.pop().unwrap_or(f64::NAN);
        let height = self.heard.script.wall_height + values[places.displacement];
        // the bed fills a part of the box in which it is measured: p ~ 1/V, I ~ 1/√p
        let fill = self
            .heard
            .script
            .bed
            .room(self.heard.script.loaded_area, height)
            / self.boxes.last().copied().unwrap_or(f64::NAN);
        Row {
            time: values[places.time],
            // people count from 1
            stage: (values[places.stage] as usize).saturating_sub(1),
            height,
            force: values[places.force] - self.heard.script.weight,
            coordination: values[places.coordination],
            unbalanced: values[places.unbalanced],
            step_ratio: values[places.step_ratio],
            inertial_number: values[places.inertial_number] * fill.sqrt(),
            mean_stress: values[places.mean_stress] / fill,
            stress: places.stress.map(|place| values[place] / fill),
            on_walls: self.on_walls(values),
            turn: places.turn.map(|places| places.map(|place| values[place])),
            place: None,
            cycle_start: f64::NAN,
            lowest: f64::NAN,
            number: self.heard.rows.len(),
            bed_solid,
            broken_bonds: places.broken_bonds.map(|place| values[place]),
        }
    }

    /// See [`Row::on_walls`].
    fn on_walls(&self, values: &[f64]) -> [f64; 3] {
        let sum = |places: &[usize]| places.iter().map(|place| values[*place]).sum::<f64>();
        let [vertical, normal] = &self.places.sides;
        [-values[self.places.base], -sum(vertical), sum(normal)]
    }

    /// Makes files and the report of the test, given the scene's report and what its run kept.
    ///
    /// # Errors
    /// Of the recorder.
    pub(super) fn conclude(&mut self, scene: Report, journal: &Journal) -> io::Result<Report> {
        let heard = &self.heard;
        let cycles = cycles::of(heard);
        let oedometer = oedometer::of(heard);
        let moments = Moments::of(heard, &journal.fragments);
        tables::write(heard, &cycles, oedometer.as_ref(), &moments, self.recorder)?;
        voids::write(heard, &journal.voids, self.recorder)?;
        Ok(report::report(
            heard,
            scene,
            &cycles,
            oedometer.as_ref(),
            &moments,
        ))
    }
}

impl Tester<'_> {
    /// Keeps what is known of a test that failed: how its bed was prepared.
    pub(super) fn keep(&mut self) {
        if let Err(error) = tables::write_preparation(&self.heard, self.recorder) {
            // why the test failed is what is told
            self.recorder
                .log(&format!("the preparation could not be written: {error}"));
        }
    }
}

impl Decorator for Tester<'_> {
    fn inner(&self) -> &dyn Recorder {
        &*self.recorder
    }

    fn inner_mut(&mut self) -> &mut dyn Recorder {
        self.recorder
    }

    fn columns(&mut self, names: &[&str]) -> io::Result<()> {
        let place = |name: &str| names.iter().position(|known| *known == name);
        let known = |name: &str| place(name).unwrap_or_default();
        let (wall, walls) = (&self.heard.script.wall, self.heard.script.walls);
        let slices = self
            .heard
            .script
            .slices
            .iter()
            .chain([&self.heard.script.bed]);
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
            stress: ["xx", "yy", "zz", "xy", "xz", "yz"]
                .map(|part| known(&format!("{BED}_stress_{part}_pa"))),
            base: known(&format!("{}_force_z_n", walls.base)),
            sides: ["force_z_n", "normal_force_n"].map(|what| {
                let sides = walls.sides.iter();
                sides.map(|name| known(&format!("{name}_{what}"))).collect()
            }),
            porosities: slices
                .map(|slice| known(&format!("{}_porosity", slice.name)))
                .collect(),
            turn: self
                .heard
                .script
                .rail
                .map(|_| ["x", "y", "z"].map(|axis| known(&format!("{wall}_turn_{axis}_rad")))),
            broken_bonds: place("broken_bonds"),
        };
        self.heard.clear();
        self.recorder.columns(&self.heard.script.columns())
    }

    fn point(&mut self, values: &[f64]) -> io::Result<()> {
        let row = self.read(values);
        let mut told = None;
        if let Some(start) = self.heard.add(row) {
            let last = self.heard.rows.last();
            told = last.map(|row| tables::curve_row(&self.heard, row, start));
        }
        told.map_or(Ok(()), |row| self.recorder.point(&row))
    }

    fn file(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        // the test has a curve of its own, and a map that knows of the sleeper
        if name == "curve.csv" || name == "voids.csv" {
            return Ok(());
        }
        self.recorder.file(name, write)
    }
}
