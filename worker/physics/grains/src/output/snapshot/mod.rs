//! Pictures of a scene for ParaView.
//!
//! Particles are points in the order of the spec, so that filters over time find the same ones; to
//! see spheres, use the filter Glyph, scaled by `radius_m` (the point is the centre). Contacts are
//! lines from centre to centre, or from a centre to its foot on a wall. Walls are a second part of the
//! series of particles ([`walls`]).
mod walls;

use std::io;

use loadframe_harness::{
    Recorder,
    vtk::{Array, Lines, Points, Series},
};

use super::journal::Journal;
use crate::{
    observe::{contact::Contact, fragments::Fragments},
    step::engine::Engine,
};

fn particles_name(step: u64) -> String {
    format!("snapshots/step_{step:09}.vtp")
}

fn walls_name(step: u64) -> String {
    format!("snapshots/walls_{step:09}.vtp")
}

fn contacts_name(step: u64) -> String {
    format!("snapshots/contacts_{step:09}.vtp")
}

/// Writes particles, contacts and walls as they are now.
pub(crate) fn take(
    engine: &Engine,
    contacts: &[Contact],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let step = engine.state.step;
    take_particles(engine, contacts, &particles_name(step), recorder)?;
    take_contacts(engine, contacts, &contacts_name(step), recorder)?;
    walls::take(engine, &walls_name(step), recorder)
}

fn take_particles(
    engine: &Engine,
    contacts: &[Contact],
    name: &str,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let particles = &engine.state.particles;
    let count = particles.len();
    let mut touching = vec![0; count];
    for contact in contacts {
        touching[contact.particles.0] += 1;
        if let Some(other) = contact.particles.1 {
            touching[other] += 1;
        }
    }
    // where each particle is in memory, by number
    let mut places: Vec<usize> = (0..count).collect();
    places.sort_unstable_by_key(|place| particles.numbers[*place]);
    let mut points = Vec::with_capacity(count);
    let mut radii = Vec::with_capacity(count);
    let mut velocities = Vec::with_capacity(3 * count);
    let mut spins = Vec::with_capacity(3 * count);
    let mut bodies = Vec::with_capacity(count);
    let mut coordination = Vec::with_capacity(count);
    for place in places {
        let [x, y, z, radius] = particles.centres[place].0;
        points.push([x, y, z]);
        radii.push(radius);
        velocities.extend_from_slice(&particles.velocities[place].0[..3]);
        let body = particles.owners[place];
        let spin = particles.spins.get(place).map(|spin| spin.vector());
        spins.extend(spin.unwrap_or(engine.model.spins[body as usize]).iter());
        bodies.push(body as i32);
        coordination.push(touching[place]);
    }
    let mut data = vec![
        Array::scalars("radius_m", &radii),
        Array::vectors("velocity_m_per_s", &velocities),
        Array::vectors("angular_velocity_rad_per_s", &spins),
        Array::indices("body", &bodies),
        Array::indices("coordination", &coordination),
    ];
    let (grains, fragments);
    if !engine.model.grains.is_empty() {
        let held = Fragments::of(engine);
        // NO_GRAIN becomes −1
        let grain = |body: &i32| engine.model.grains[*body as usize] as i32;
        grains = bodies.iter().map(grain).collect::<Vec<i32>>();
        let fragment = |body: &i32| held.of_body(*body as u32) as i32;
        fragments = bodies.iter().map(fragment).collect::<Vec<i32>>();
        data.push(Array::indices("grain", &grains));
        data.push(Array::indices("fragment", &fragments));
    }
    let picture = Points {
        points: &points,
        data: &data,
    };
    recorder.file(name, &mut |out| picture.write(out))
}

fn take_contacts(
    engine: &Engine,
    contacts: &[Contact],
    name: &str,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let centres = &engine.state.particles.centres;
    let mut points = Vec::with_capacity(2 * contacts.len());
    let mut forces = Vec::with_capacity(3 * contacts.len());
    let (mut normal, mut shear, mut overlap) = (Vec::new(), Vec::new(), Vec::new());
    for contact in contacts {
        let (a, b) = contact.particles;
        let centre = &centres[a];
        let end = match b {
            Some(b) => centres[b].vector(),
            None => centre.vector() + contact.normal * (centre.0[3] - contact.overlap),
        };
        points.push(centre.vector().into());
        points.push(end.into());
        forces.extend((contact.normal_force + contact.shear_force).iter());
        normal.push(contact.normal_force.norm());
        shear.push(contact.shear_force.norm());
        overlap.push(contact.overlap);
    }
    let ends: Vec<[u32; 2]> = (0..contacts.len() as u32)
        .map(|line| [2 * line, 2 * line + 1])
        .collect();
    let lines = Lines {
        points: &points,
        ends: &ends,
        point_data: &[],
        cell_data: &[
            Array::scalars("normal_force_n", &normal),
            Array::scalars("shear_force_n", &shear),
            Array::vectors("force_n", &forces),
            Array::scalars("overlap_m", &overlap),
        ],
    };
    recorder.file(name, &mut |out| lines.write(out))
}

/// Writes the series of all snapshots, played over time.
pub(crate) fn write_series(
    journal: &Journal,
    has_walls: bool,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    if journal.snapshots.is_empty() {
        return Ok(());
    }
    let series = |names: &[fn(u64) -> String]| {
        let snapshots = journal.snapshots.iter();
        let entries = snapshots
            .flat_map(|(step, time)| names.iter().map(|name| (*time, name(*step))))
            .collect();
        Series { entries }
    };
    let pictures: &[fn(u64) -> String] = if has_walls {
        &[particles_name, walls_name]
    } else {
        &[particles_name]
    };
    for (file, series) in [
        ("snapshots.pvd", series(pictures)),
        ("contacts.pvd", series(&[contacts_name])),
    ] {
        recorder.file(file, &mut |out| series.write(out))?;
    }
    Ok(())
}
