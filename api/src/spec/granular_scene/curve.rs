//! The columns of a scene's curve.
use std::collections::BTreeSet;

use super::GranularScene;
use crate::{Violation, Violations};

/// That no two columns of the curve have one name: of walls that are recorded twice, or of a wall or
/// region that is called as another's column.
pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    let mut names = BTreeSet::new();
    let doubled = spec
        .curve_columns()
        .into_iter()
        .find(|name| !names.insert(name.clone()));
    violations.extend(doubled.map(|name| {
        let detail = "two columns of curve.csv would have this name";
        let violation = Violation::new("/record", "name_taken", detail).value(name);
        violation.allowed("every plane, wall and region once, under names of their own")
    }));
}

/// Columns of the place in the run.
const PLACE: [&str; 3] = ["step", "time_s", "stage"];
/// Readings of the whole.
const READINGS: [&str; 6] = [
    "kinetic_energy_j",
    "elastic_energy_j",
    "contacts",
    "coordination_number",
    "unbalanced_force_ratio",
    "step_over_critical",
];

/// How many columns every scene's curve has.
pub(super) const EVERY_SCENE: usize = PLACE.len() + READINGS.len();

/// Quantities of a region and their units, as columns of the curve.
const REGION: [&str; 10] = [
    "porosity",
    "coordination_number",
    "inertial_number",
    "mean_stress_pa",
    "stress_xx_pa",
    "stress_yy_pa",
    "stress_zz_pa",
    "stress_xy_pa",
    "stress_xz_pa",
    "stress_yz_pa",
];

impl GranularScene {
    /// Columns of the curve: place in the run, recorded planes, walls and driven bodies, normal
    /// forces, turns, readings, regions.
    pub fn curve_columns(&self) -> Vec<String> {
        let place = PLACE.map(str::to_owned);
        let planes = self.record.planes.iter().flat_map(|plane| {
            [
                format!("{plane}_displacement_m"),
                format!("{plane}_force_n"),
            ]
        });
        let walls = self.recorded_walls().into_iter().map(str::to_owned);
        let bodies = self.driven_bodies().into_iter();
        let driven = walls.chain(bodies.map(|body| format!("body_{body}")));
        let driven = driven.flat_map(|name| {
            let along = |what: &str, unit: &str| {
                ["x", "y", "z"].map(|axis| format!("{name}_{what}_{axis}_{unit}"))
            };
            [along("displacement", "m"), along("force", "n")].concat()
        });
        let pressed = self.record.normal_forces.iter();
        let pressed = pressed.map(|name| format!("{name}_normal_force_n"));
        let turns = self.record.turns.iter();
        let turns = turns
            .flat_map(|body| ["x", "y", "z"].map(|axis| format!("body_{body}_turn_{axis}_rad")));
        let regions = self.record.regions.iter().flat_map(|region| {
            let name = &region.name;
            REGION.map(|column| format!("{name}_{column}"))
        });
        let bonds = self.is_cohesive().then(|| "broken_bonds".to_owned());
        place
            .into_iter()
            .chain(planes)
            .chain(driven)
            .chain(pressed)
            .chain(turns)
            .chain(READINGS.map(str::to_owned))
            .chain(regions)
            .chain(bonds)
            .collect()
    }
}
