//! What the JSON Schema cannot say of walls and of what drives them.
use std::collections::BTreeSet;

use super::{Axis, Body, Drive, FacetMesh, GranularScene, Place, Servo};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations, surface::unit_normal};

/// Names of walls, and the triangles of facets.
pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    let planes = (0..spec.planes.len()).map(|index| format!("/planes/{index}/name"));
    let facets = (0..spec.facets.len()).map(|index| format!("/facets/{index}/name"));
    let mut names = BTreeSet::new();
    for (pointer, name) in planes.chain(facets).zip(spec.wall_names()) {
        if !names.insert(name) {
            violations.push(
                Violation::new(pointer, "name_taken", "another wall has this name")
                    .value(name)
                    .allowed("a name of its own"),
            );
        }
    }
    for (index, mesh) in spec.facets.iter().enumerate() {
        check_triangles(mesh, &format!("/facets/{index}"), violations);
    }
}

fn check_triangles(mesh: &FacetMesh, pointer: &str, violations: &mut Violations) {
    if mesh.triangles_m.is_some() == mesh.stl.is_some() {
        violations.push(
            Violation::new(
                pointer,
                "not_one_source",
                "facets are either a list of triangles or an STL file",
            )
            .allowed("exactly one of: triangles_m, stl"),
        );
        return;
    }
    let triangles = match mesh.triangles() {
        Ok(triangles) => triangles,
        Err(error) => {
            let violation =
                Violation::new(format!("{pointer}/stl"), "not_a_surface", error.to_string());
            violations.push(
                violation.allowed("the text of an ASCII STL file, or a binary one in base64"),
            );
            return;
        }
    };
    let flat = triangles.iter().enumerate();
    let flat: Vec<usize> = flat
        .filter_map(|(index, triangle)| unit_normal(triangle).is_none().then_some(index))
        .collect();
    for index in flat.iter().take(LISTED_OF_A_SORT) {
        let more = if flat.len() > LISTED_OF_A_SORT {
            format!(" ({} such triangles in all)", flat.len())
        } else {
            String::new()
        };
        let place = match mesh.stl {
            Some(_) => format!("{pointer}/stl"),
            None => format!("{pointer}/triangles_m/{index}"),
        };
        let detail = format!("triangle {index}, counted from 0, has no area{more}");
        violations.push(
            Violation::new(place, "no_area", detail)
                .value(*index)
                .allowed("three corners that are not on a line"),
        );
    }
}

/// Names and numbers that stages may use.
pub(super) struct Known<'a> {
    spec: &'a GranularScene,
    planes: BTreeSet<&'a str>,
    walls: BTreeSet<&'a str>,
    /// How many bodies there are, up to the first breakable one whose members are still to be found.
    bodies: usize,
}

impl<'a> Known<'a> {
    pub(super) fn of(spec: &'a GranularScene) -> Self {
        let has_number = |body: &&Body| body.breakable.is_none() || !body.is_filled();
        let numbered = spec.bodies.iter().take_while(has_number);
        Self {
            spec,
            planes: spec.planes.iter().map(|plane| &*plane.name).collect(),
            walls: spec.wall_names().collect(),
            bodies: numbered.map(Body::numbers).sum(),
        }
    }

    /// That there is a wall of this name.
    pub(super) fn check_wall(&self, pointer: String, name: &str) -> Option<Violation> {
        (!self.walls.contains(name)).then(|| {
            let names: Vec<&str> = self.spec.wall_names().collect();
            let allowed = if names.is_empty() {
                "the scene has no walls".to_owned()
            } else {
                format!("one of: {}", names.join(", "))
            };
            Violation::new(
                pointer,
                "no_such_wall",
                "no plane and no facets have this name",
            )
            .value(name)
            .allowed(allowed)
        })
    }

    /// That a body of this number is a clump, which has an orientation.
    pub(super) fn check_clump(&self, pointer: String, number: u32) -> Option<Violation> {
        let known = self.check_body(pointer.clone(), number);
        known.or_else(|| {
            let mut first = 0;
            let body = self.spec.bodies.iter().find(|body| {
                first += body.numbers();
                (number as usize) < first
            });
            body.is_none_or(|body| body.clump.is_none()).then(|| {
                let detail = "the turning of a sphere is not followed";
                let violation = Violation::new(pointer, "not_a_clump", detail).value(number);
                violation.allowed("the number of a clump of /bodies")
            })
        })
    }

    /// That there is a body of this number.
    fn check_body(&self, pointer: String, number: u32) -> Option<Violation> {
        (number as usize >= self.bodies).then(|| {
            let allowed = match self.bodies {
                0 => "the scene has no bodies".to_owned(),
                count => format!("0 … {}", count - 1),
            };
            Violation::new(pointer, "no_such_body", "there is no body of this number")
                .value(number)
                .allowed(allowed)
        })
    }
}

/// A stage that drives.
pub(super) fn check_drive(
    known: &Known<'_>,
    drive: &Drive,
    pointer: &str,
    violations: &mut Violations,
) {
    let mut names = BTreeSet::new();
    for (index, wall) in drive.walls.iter().enumerate() {
        let pointer = format!("{pointer}/walls/{index}");
        violations.extend(known.check_wall(format!("{pointer}/name"), &wall.name));
        if !names.insert(wall.name.as_str()) {
            violations
                .push(driven_twice(format!("{pointer}/name"), "wall").value(wall.name.as_str()));
        }
        let ways = [
            wall.velocity_m_per_s.is_some(),
            wall.sine.is_some(),
            wall.turn.is_some(),
            wall.force.is_some(),
            wall.servo.is_some(),
        ];
        if ways.iter().filter(|given| **given).count() != 1 {
            violations.push(
                Violation::new(&pointer, "not_one_drive", "a wall is driven in one way")
                    .allowed("exactly one of: velocity_m_per_s, sine, turn, force, servo"),
            );
        }
        if wall.turn.is_some() && known.planes.contains(&*wall.name) {
            violations.push(
                Violation::new(
                    format!("{pointer}/turn"),
                    "plane_cannot_turn",
                    "a plane stays across its axis",
                )
                .allowed("facets only"),
            );
        }
        if let Some(force) = &wall.force {
            let swings = [force.peak_force_n.is_some(), force.period_s.is_some()];
            violations.extend(check_swing(&format!("{pointer}/force"), swings));
        }
        if let Some(servo) = &wall.servo {
            let pointer = format!("{pointer}/servo");
            violations.extend(check_servo(known, servo, &wall.name, &pointer));
        }
    }
    if let Some(until) = &drive.until {
        let pointer = format!("{pointer}/until");
        violations.extend(known.check_wall(format!("{pointer}/wall"), &until.wall));
        if until.at_least_n.is_some() == until.at_most_n.is_some() {
            let detail = "a force ends a stage from one side";
            violations.push(
                Violation::new(pointer, "not_one_of", detail)
                    .allowed("exactly one of: at_least_n, at_most_n"),
            );
        }
    }
    let mut bodies = BTreeSet::new();
    for (index, body) in drive.bodies.iter().enumerate() {
        let pointer = format!("{pointer}/bodies/{index}");
        violations.extend(known.check_body(format!("{pointer}/body"), body.body));
        if !bodies.insert(body.body) {
            violations.push(driven_twice(format!("{pointer}/body"), "body").value(body.body));
        }
        if body.velocity.is_some() == body.force.is_some() {
            violations.push(
                Violation::new(&pointer, "not_one_drive", "a body is driven in one way")
                    .allowed("exactly one of: velocity, force"),
            );
        }
        if let Some(force) = &body.force {
            let swings = [force.peak_force_n.is_some(), force.period_s.is_some()];
            violations.extend(check_swing(&format!("{pointer}/force"), swings));
            if force.at_m.is_some() {
                let pointer = format!("{pointer}/force/at_m");
                violations.extend(known.check_clump(pointer, body.body));
            }
        }
    }
}

/// A plane that follows what presses on it.
fn check_servo(known: &Known<'_>, servo: &Servo, wall: &str, pointer: &str) -> Option<Violation> {
    let mut planes = known.spec.planes.iter();
    let Some(plane) = planes.find(|plane| plane.name == wall) else {
        let detail = "only a plane has an axis along which it follows";
        return Some(Violation::new(pointer, "not_a_plane", detail).allowed("a wall of /planes"));
    };
    if servo.force_n.is_some() == servo.stress_pa.is_some() {
        let detail = "a servo has one aim";
        let violation = Violation::new(pointer, "not_one_aim", detail);
        return Some(violation.allowed("exactly one of: force_n, stress_pa"));
    }
    let is_enclosed = [Axis::X, Axis::Y, Axis::Z].iter().all(|axis| {
        let across = known.spec.planes.iter().filter(|other| other.axis == *axis);
        let facings: Vec<i32> = across.map(|other| i32::from(other.facing)).collect();
        *axis == plane.axis || (facings.contains(&1) && facings.contains(&-1))
    });
    (servo.stress_pa.is_some() && !is_enclosed).then(|| {
        let detail = "planes on both sides across the other two axes must enclose the area";
        Violation::new(format!("{pointer}/stress_pa"), "no_area", detail)
            .value(servo.stress_pa)
            .allowed("such planes, or force_n instead")
    })
}

/// A stage that sets something down.
pub(super) fn check_place(
    known: &Known<'_>,
    place: &Place,
    pointer: &str,
    violations: &mut Violations,
) {
    if place.wall.is_some() == place.body.is_some() {
        violations.push(
            Violation::new(pointer, "not_one_of", "a wall or a body is set down")
                .allowed("exactly one of: wall, body"),
        );
    }
    if let Some(wall) = &place.wall {
        violations.extend(known.check_wall(format!("{pointer}/wall"), wall));
    }
    if let Some(body) = place.body {
        violations.extend(known.check_body(format!("{pointer}/body"), body));
        if place.mass_kg.is_some() {
            let pointer = format!("{pointer}/mass_kg");
            let violation = Violation::new(pointer, "not_together", "a body has its own mass");
            violations.push(violation.value(place.mass_kg).allowed("none with body"));
        }
    }
}

fn driven_twice(pointer: String, what: &str) -> Violation {
    let detail = format!("this {what} is driven twice in one stage");
    Violation::new(pointer, "driven_twice", detail).allowed("each once")
}

/// That a force has both its peak and its period, or neither.
pub(super) fn check_swing(pointer: &str, [peak, period]: [bool; 2]) -> Option<Violation> {
    (peak != period).then(|| {
        Violation::new(
            format!("{pointer}/period_s"),
            "not_both",
            "a force that swings needs its peak and its period",
        )
        .allowed("both or none of: peak_force_n, period_s")
    })
}
