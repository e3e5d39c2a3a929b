//! What a test heard of its scene, row by row.
use loadframe_api::spec::ballast::{Phase, Script};

use super::place::{Place, place};

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
    /// Stress of the bed [Pa]: xx, yy, zz, xy, xz, yz, compression positive.
    pub(super) stress: [f64; 6],
    /// Of the bed on the base, downward, and on all sides, downward and along their normals [N].
    pub(super) on_walls: [f64; 3],
    /// Turn of a sleeper that tilts since it hung level, as a vector along the axis [rad].
    pub(super) turn: Option<[f64; 3]>,
    /// Where in the cycles it is, if it is in any.
    pub(super) place: Option<Place>,
    /// Height of the loading wall where the present cycle began, and the lowest in it so far [m].
    pub(super) cycle_start: f64,
    pub(super) lowest: f64,
    /// Number of the row.
    pub(super) number: usize,
    /// Solid volume of the bed [m³].
    pub(super) bed_solid: f64,
    pub(super) broken_bonds: Option<f64>,
}

/// All rows so far.
#[derive(Debug)]
pub(super) struct Heard<'a> {
    pub(super) script: &'a Script,
    pub(super) rows: Vec<Row>,
    /// Solid volumes of slices [m³], row after row: many small vectors among the engine's large ones
    /// would keep memory from being used again.
    pub(super) solids: Vec<f64>,
    /// Height of the loading wall where it was set down [m].
    pub(super) set_down: f64,
    /// Where the cycles begin: time [s] and height [m].
    start: Option<(f64, f64)>,
    /// The present stage of the load, and when it began [s].
    stage: Option<(usize, f64)>,
    /// Number of the present cycle, where it began and the lowest height in it so far [m].
    cycle: Option<(usize, f64, f64)>,
}

impl Row {
    /// Angle between a sleeper's top and the level [rad], if it tilts: with the turn θ about n,
    /// sin²(tilt/2) = sin²(θ/2) (1 − n_z²).
    pub(super) fn tilt(&self) -> Option<f64> {
        let [x, y, z] = self.turn?;
        let across = x.hypot(y);
        let angle = across.hypot(z);
        let share = if angle > 0.0 { across / angle } else { 0.0 };
        Some(2.0 * ((0.5 * angle).sin() * share).asin())
    }

    /// Height of the loading wall's lower face [m] at a place from its middle, x and y [m].
    pub(super) fn face_at(&self, [x, y]: [f64; 2]) -> f64 {
        let [about_x, about_y, _] = self.turn.unwrap_or_default();
        self.height + about_x * y - about_y * x
    }

    /// Way of the loading wall downward from a height [m].
    pub(super) fn displacement(&self, start: f64) -> f64 {
        start - self.height
    }
}

impl<'a> Heard<'a> {
    pub(super) fn new(script: &'a Script) -> Self {
        Self {
            script,
            rows: Vec::new(),
            solids: Vec::new(),
            set_down: f64::NAN,
            start: None,
            stage: None,
            cycle: None,
        }
    }

    /// Forgets all, to hear it again.
    pub(super) fn clear(&mut self) {
        *self = Self::new(self.script);
    }

    /// Adds a row. Returns where the cycles began, time [s] and height [m], if it is one of them.
    pub(super) fn add(&mut self, mut row: Row) -> Option<(f64, f64)> {
        if self.phase(row.stage) == Some(Phase::Place) {
            self.set_down = row.height;
        }
        let load = self.script.loads.get(&row.stage);
        let start = load.map(|load| {
            let before = self.rows.last().unwrap_or(&row);
            let (time, height) = (before.time, before.height);
            let start = *self.start.get_or_insert((time, height));
            let began = match self.stage {
                Some((stage, began)) if stage == row.stage => began,
                _ => time,
            };
            self.stage = Some((row.stage, began));
            let place = place(load, row.time - began);
            let (_, began, lowest) = match self.cycle {
                Some(cycle) if cycle.0 == place.cycle => cycle,
                _ => (place.cycle, height, height),
            };
            row.place = Some(place);
            (row.cycle_start, row.lowest) = (began, lowest.min(row.height));
            self.cycle = Some((place.cycle, began, row.lowest));
            start
        });
        self.rows.push(row);
        start
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
        let rows = rows.filter(|row| row.place.is_some());
        (rows, self.start.unwrap_or_default())
    }

    /// The last row before the cycles.
    pub(super) fn last_before_loading(&self) -> Option<&Row> {
        let mut rows = self.rows.iter().rev();
        let time = self.start.map_or(f64::INFINITY, |(time, _)| time);
        rows.find(|row| row.place.is_none() && row.time <= time)
    }

    /// Volume of each slice below the loading wall at a row [m³].
    fn room(&self, row: &Row) -> impl Iterator<Item = f64> {
        let (area, height) = (self.script.loaded_area, row.height);
        let slices = self.script.slices.iter();
        slices.map(move |slice| slice.room(area, height))
    }

    /// Porosity of the slices that the bed fills at a row.
    pub(super) fn bed_porosity(&self, row: &Row) -> f64 {
        let volume: f64 = self.room(row).sum();
        let solid: f64 = self.solids(row).iter().sum();
        1.0 - solid / volume
    }

    /// Porosity of each slice at a row, unknown where the loading wall has taken all of it.
    pub(super) fn porosities(&self, row: &Row) -> Vec<f64> {
        let slices = self.room(row).zip(self.solids(row));
        let porosity = |(volume, solid): (f64, &f64)| match volume > 0.0 {
            true => 1.0 - solid / volume,
            false => f64::NAN,
        };
        slices.map(porosity).collect()
    }

    /// The row of the cycles with the largest force.
    pub(super) fn peak_row(&self) -> Option<&Row> {
        let (rows, _) = self.loading();
        rows.reduce(|best, row| if row.force > best.force { row } else { best })
    }

    /// V_s of the bed where the cycles begin [m³].
    pub(super) fn bed_volume(&self) -> f64 {
        let row = self.last_before_loading();
        row.map_or(f64::NAN, |row| row.bed_solid)
    }
}
