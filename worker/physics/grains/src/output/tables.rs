//! The tables a run leaves behind.
use std::io;

use loadframe_api::spec::granular_scene::GranularScene;
use loadframe_harness::Recorder;

use super::{
    breaks,
    fragments::{self, FragmentRow},
    journal::Journal,
    table::write_table,
};
use crate::{
    motion::clump::Clump, numbers::Vector, observe::contact::Contact, step::engine::Engine,
};

const BODY_COLUMNS: [&str; 16] = [
    "step",
    "time_s",
    "body",
    "x_m",
    "y_m",
    "z_m",
    "vx_m_per_s",
    "vy_m_per_s",
    "vz_m_per_s",
    "wx_rad_per_s",
    "wy_rad_per_s",
    "wz_rad_per_s",
    "qw",
    "qx",
    "qy",
    "qz",
];

const CONTACT_COLUMNS: [&str; 14] = [
    "step",
    "body_a",
    "body_b",
    "overlap_m",
    "normal_x",
    "normal_y",
    "normal_z",
    "fn_x_n",
    "fn_y_n",
    "fn_z_n",
    "fs_x_n",
    "fs_y_n",
    "fs_z_n",
    "bonded",
];

/// Moment of what resists rolling and twisting, springs and dashpots, on the second body, where there is any.
const MOMENT_COLUMNS: [&str; 3] = ["m_x_n_m", "m_y_n_m", "m_z_n_m"];

/// A row of the curve. Unknown readings are left at 0.
pub(crate) fn curve_row(
    spec: &GranularScene,
    engine: &Engine,
    journal: &Journal,
    contacts: &[Contact],
    step_ratio: f64,
) -> Vec<f64> {
    let state = &engine.state;
    let mut row = vec![state.step as f64, state.time, journal.number() as f64];
    for name in &spec.record.planes {
        let plane = engine
            .model
            .planes
            .iter()
            .position(|plane| plane.name == *name);
        let Some(plane) = plane else { continue };
        let face = &state.faces[plane];
        row.push(face.position - engine.model.planes[plane].face.position);
        row.push(engine.wall_force(plane)[face.axis]);
    }
    for name in spec.recorded_walls() {
        let Some(wall) = engine.wall(name) else {
            continue;
        };
        row.extend(engine.wall_displacement(wall));
        row.extend(engine.wall_force(wall));
    }
    for driven in &engine.model.driven {
        row.extend(engine.body_displacement(driven).iter());
        row.extend(force_on(driven.body, contacts).iter());
    }
    for name in &spec.record.normal_forces {
        let number = engine.wall(name).unwrap_or(usize::MAX);
        row.push(pressed(engine, number, contacts));
    }
    for body in &spec.record.turns {
        let turn = engine.turn_of(*body);
        row.extend(turn.unwrap_or_default().scaled_axis().iter());
    }
    let reading = &journal.last;
    row.extend([
        reading.kinetic,
        reading.elastic,
        reading.contacts as f64,
        reading.coordination.unwrap_or(0.0),
        reading.unbalanced.unwrap_or(0.0),
        step_ratio,
    ]);
    let points = if spec.record.regions.is_empty() {
        Vec::new()
    } else {
        engine.points()
    };
    for region in &spec.record.regions {
        let cuboid = engine.cuboid([region.low_m, region.high_m]);
        let only = region.material.as_ref();
        let only = only.and_then(|name| spec.materials.keys().position(|known| known == name));
        let solid = engine.solid(&cuboid, only);
        row.extend(engine.measure(&cuboid, only, &points, contacts).row(solid));
    }
    if spec.is_cohesive() {
        row.push(engine.broken_bonds(reading) as f64);
    }
    row
}

/// Sizes of the normal forces of all contacts at a wall [N].
fn pressed(engine: &Engine, wall: usize, contacts: &[Contact]) -> f64 {
    let number = engine.model.masses.len() + wall;
    let at_wall = contacts.iter().filter(|contact| {
        let [_, other] = contact.bodies;
        other as usize == number
    });
    at_wall.map(|contact| contact.normal_force.norm()).sum()
}

/// Force of all contacts on a body [N].
fn force_on(body: u32, contacts: &[Contact]) -> Vector {
    let mut force = Vector::zeros();
    for contact in contacts {
        let on_second = contact.normal_force + contact.shear_force;
        if contact.bodies[1] == body {
            force += on_second;
        } else if contact.bodies[0] == body {
            force -= on_second;
        }
    }
    force
}

impl Engine {
    /// Adds the rows of these bodies of the spec to `table`.
    pub(crate) fn body_rows(&self, bodies: &[u32], table: &mut Vec<f64>) {
        let state = &self.state;
        let mut places = vec![Place::Missing; self.model.masses.len()];
        for (particle, owner) in state.particles.owners.iter().enumerate() {
            places[*owner as usize] = Place::Sphere(particle);
        }
        for (clump, owner) in state.clumps.iter().enumerate() {
            places[owner.body as usize] = Place::Clump(clump);
        }
        for body in bodies {
            let [position, velocity, spin] = match places[*body as usize] {
                Place::Missing => continue,
                Place::Sphere(particle) => {
                    let particles = &state.particles;
                    let spin = particles.spins.get(particle);
                    let initial = self.model.spins[*body as usize];
                    [
                        particles.centres[particle].vector(),
                        particles.velocities[particle].vector(),
                        // without friction nothing turns a sphere
                        spin.map_or(initial, |spin| spin.vector()),
                    ]
                }
                Place::Clump(clump) => {
                    let clump = &state.clumps[clump];
                    [clump.centre, clump.velocity, clump.spin]
                }
            };
            table.extend([state.step as f64, state.time, f64::from(*body)]);
            for vector in [position, velocity, spin] {
                table.extend(vector.iter());
            }
            table.extend(match places[*body as usize] {
                Place::Clump(clump) => {
                    state.clumps[clump].turned(&self.model.orientations[*body as usize])
                }
                // the turning of a sphere is not followed: it cannot be seen
                _ => [1.0, 0.0, 0.0, 0.0],
            });
        }
    }
}

/// Where a body of the spec is in memory.
#[derive(Clone, Copy)]
enum Place {
    Missing,
    Sphere(usize),
    Clump(usize),
}

impl Clump {
    /// Rotation since the start as a quaternion w, x, y, z.
    fn turned(&self, start: &nalgebra::UnitQuaternion<f64>) -> [f64; 4] {
        let turn = self.orientation * start.inverse();
        [turn.w, turn.i, turn.j, turn.k]
    }
}

/// Adds the rows of these contacts to `table`, with moments where the scene resists rolling.
pub(crate) fn contact_rows(
    step: u64,
    contacts: &[Contact],
    has_moments: bool,
    table: &mut Vec<f64>,
) {
    for contact in contacts {
        table.extend([
            step as f64,
            f64::from(contact.bodies[0]),
            f64::from(contact.bodies[1]),
            contact.overlap,
        ]);
        for vector in [contact.normal, contact.normal_force, contact.shear_force] {
            table.extend(vector.iter());
        }
        table.push(f64::from(u8::from(contact.is_bonded)));
        if has_moments {
            table.extend(contact.moment.iter());
        }
    }
}

/// Gives all tables to the recorder.
pub(crate) fn write(
    spec: &GranularScene,
    journal: &Journal,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let columns = spec.curve_columns();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    write_table(recorder, "curve.csv", &columns, &journal.curve)?;
    if !journal.bodies.is_empty() {
        write_table(recorder, "bodies.csv", &BODY_COLUMNS, &journal.bodies)?;
    }
    if !journal.fragments.is_empty() {
        let rows: Vec<f64> = (journal.fragments.iter())
            .flat_map(FragmentRow::numbers)
            .collect();
        write_table(recorder, "fragments.csv", &fragments::COLUMNS, &rows)?;
    }
    breaks::write(journal, recorder)?;
    if spec.record.contacts {
        let mut columns = CONTACT_COLUMNS.to_vec();
        if spec.has_moments() {
            columns.extend(MOMENT_COLUMNS);
        }
        write_table(recorder, "contacts.csv", &columns, &journal.contacts)?;
    }
    Ok(())
}
