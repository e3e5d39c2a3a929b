//! A section that is loaded until it breaks, crack by crack.
//!
//! Rollers are forces that balance each other and grow by one factor, found for the whole section and
//! anew as it breaks ([`Pressed`]).
use loadframe_api::spec::composite_bending as spec;
use loadframe_api::spec::composite_bending::Breaking as Given;

use super::model::{Model, drive, nearest};
use super::progress::{CracksState, Progress};
use super::tested::{Broken, Look, Tested};
use super::watch::{Halt, Watch};
use crate::breaking::{
    Advance, BetweenPlies, Breaking, BreakingOptions, Control, Event, Machine, MaterialStrength,
    NO_MATERIAL, OpenFace, Pressed, Scatter, ScatterLaw, Specimen, Stop, opened_lattice,
};
use crate::error::CompositeError;
use crate::flexure::{Flexure, FlexureResult};
use crate::lattice::Lattice;
use crate::material::hubers_shear_modulus;
use crate::solve::{StaticOptions, equilibrium};
use crate::strength::{Criterion, Strength};
use crate::supports::{Face, Supports};

/// Events between two looks at whether to go on.
const LOOK: u64 = 20;

pub(super) fn conduct(
    model: &Model<'_>,
    given: &Given,
    progress: Option<Progress>,
    watch: &mut dyn Watch,
) -> Result<Tested, Halt> {
    watch.columns(model.spec.columns())?;
    let strengths: Vec<MaterialStrength> = model
        .spec
        .materials
        .values()
        .map(|material| MaterialStrength {
            bulk: limits(material, given.criterion),
            interface: material.interface.map(Into::into),
        })
        .collect();
    let between_plies = between_plies(model);
    let options = options(model, given);
    let opened = (!between_plies.open.is_empty())
        .then(|| opened_lattice(&model.layout, &strengths, &between_plies, &options))
        .transpose()
        .map_err(|error| named(error, model))?;
    let (mut tested, begun) = whole(model, opened.as_ref().unwrap_or(&model.lattice))?;
    let specimen = Specimen {
        layout: &model.layout,
        supports: &begun.supports,
        load_n: &begun.load,
        strengths: &strengths,
        between_plies: &between_plies,
        rollers: begun.rollers.as_ref(),
    };
    let breaking = Breaking::new(specimen, options);
    let mut breaking = breaking.map_err(|error| named(error, model))?;
    let (mut events, mut peak) = (Vec::new(), None);
    let mut curve = Curve::new(given);
    if let Some(Progress::Cracks(kept)) = progress {
        breaking.resume(kept.state)?;
        (events, peak) = (kept.events, kept.peak);
        curve.known(&events);
    } else {
        watch.point(&Curve::START)?;
    }
    let mut largest = peak.as_ref().map_or(0.0, |look: &Look| look.force_n);
    let reason = loop {
        let advance = breaking.advance();
        let event = match advance.map_err(|error| named(error, model))? {
            Advance::Ended(reason) => break reason,
            Advance::Broke(event) => event,
        };
        let is_seen = curve.add(&event, watch)?;
        events.push(event);
        if is_seen && event.force_n > largest {
            largest = event.force_n;
            peak = Some(Look {
                // the section as it bears its largest force, the crack of this event just there
                force_n: event.force_n,
                ..look(&breaking, event.displacement_mm)
            });
        }
        if event.number.is_multiple_of(LOOK) {
            let mut state = || {
                Progress::Cracks(Box::new(CracksState {
                    state: breaking.state(),
                    events: events.clone(),
                    peak: peak.clone(),
                }))
            };
            watch.look(fraction(given, &event, largest), &mut state)?;
        }
    };
    curve.end(&events, watch)?;
    tested.broken = Some(Broken {
        reason,
        totals: breaking.totals(),
        end: events.last().map(|last| look(&breaking, curve.at_mm(last))),
        peak,
        events,
    });
    Ok(tested)
}

/// What holds a section, and what drives its breaking.
struct Begun {
    supports: Supports,
    load: Vec<f64>,
    rollers: Option<Pressed>,
}

/// The section before it breaks under what is given, and what drives its breaking.
fn whole(model: &Model<'_>, lattice: &Lattice) -> Result<(Tested, Begun), Halt> {
    let options = StaticOptions::default();
    if let Some((flexure, given)) = model.flexure() {
        let found = flexure.bend(&model.section, lattice, drive(given, 1.0), &options)?;
        let begun = frozen(model, flexure, &found)?;
        return Ok((Tested::bent(found), begun));
    }
    let rest = equilibrium(lattice, &model.supports, &model.load, &options)?;
    let begun = Begun {
        supports: model.supports.clone(),
        load: model.load.clone(),
        rollers: None,
    };
    Ok((Tested::at_rest(rest), begun))
}

/// The forces of rollers on the particles that touch them, which balance each other, and what keeps
/// the section from moving as a whole, which bears nothing: no particle that a roller touches, whose
/// force would be lost to it.
fn frozen(
    model: &Model<'_>,
    flexure: Flexure,
    found: &FlexureResult,
) -> Result<Begun, CompositeError> {
    let grid = model.lattice.grid();
    let reactions = &found.contact.equilibrium.reactions_n;
    let mut load = vec![0.0; reactions.len()];
    for face in [Face::Bottom, Face::Top] {
        for line in 0..=grid.columns() {
            let vertical = 2 * face.particle(grid, line) + 1;
            load[vertical] = reactions[vertical];
        }
    }
    let (kept, _) = flexure.kept(&model.section, &model.lattice)?;
    let mut supports = kept.clone();
    let (resting, pressing) = flexure.rollers(&model.section);
    let row = (grid.rows() / 2).max(1);
    for roller in resting {
        let line = nearest(grid.x_mm(), roller.at_mm);
        supports.hold(grid, grid.particle(line, row), 1, 0.0)?;
    }
    Ok(Begun {
        supports,
        load,
        rollers: Some(Pressed {
            resting: resting.to_vec(),
            pressing,
            force_n: found.force_n,
            kept,
        }),
    })
}

/// What holds plies together, and where they are apart from the start.
fn between_plies(model: &Model<'_>) -> BetweenPlies {
    let open = model.spec.delaminations.iter().map(|given| OpenFace {
        // checked with the spec: from 1
        above_ply: (given.above_ply as usize).saturating_sub(1),
        between_mm: [given.from_mm, given.to_mm],
    });
    BetweenPlies {
        interface: model.spec.ply_interface.map(Into::into),
        open: open.collect(),
    }
}

/// Limits of a material in what they are compared with: stresses [MPa], or strains, each its strength over
/// the modulus of its direction.
fn limits(material: &spec::Material, criterion: spec::Criterion) -> Strength {
    let mut limits: Strength = material.strength.unwrap_or_default().into();
    if criterion == spec::Criterion::Stress {
        return limits;
    }
    let [along, across, shear] = match (material.isotropic, material.orthotropic) {
        (Some(constants), _) => [constants.youngs_modulus_mpa; 3],
        (None, Some(constants)) => {
            let (e1, e2) = (constants.modulus_1_mpa, constants.modulus_2_mpa);
            let huber = || hubers_shear_modulus(e1, e2, constants.poisson_ratio_12);
            [e1, e2, constants.shear_modulus_12_mpa.unwrap_or_else(huber)]
        }
        (None, None) => return limits,
    };
    for (limit, modulus) in [
        (&mut limits.tension, along),
        (&mut limits.compression, along),
        (&mut limits.across_tension, across),
        (&mut limits.across_compression, across),
        (&mut limits.shear, shear),
    ] {
        if let Some(limit) = limit {
            limit.limit /= modulus;
        }
    }
    limits
}

/// An error that tells a material by its place, with its name.
fn named(error: CompositeError, model: &Model<'_>) -> CompositeError {
    match error {
        CompositeError::CellTooLarge {
            x_mm,
            y_mm,
            material,
            width_mm,
            largest_mm,
        } => {
            let place = material.parse::<usize>().ok();
            let ply_interface = "ply_interface".to_owned();
            let name = place.and_then(|place| match place {
                NO_MATERIAL => Some(&ply_interface),
                place => model.spec.materials.keys().nth(place),
            });
            CompositeError::CellTooLarge {
                x_mm,
                y_mm,
                material: name.map_or(material, |name| format!("{name:?}")),
                width_mm,
                largest_mm,
            }
        }
        error => error,
    }
}

fn options(model: &Model<'_>, given: &Given) -> BreakingOptions {
    BreakingOptions {
        criterion: match given.criterion {
            spec::Criterion::Stress => Criterion::Stress,
            spec::Criterion::Strain => Criterion::Strain,
        },
        scatter: given.scatter.map(|scatter| Scatter {
            law: ScatterLaw::Weibull {
                modulus: scatter.weibull_modulus,
            },
            reference_volume_mm3: scatter.reference_volume_mm3,
        }),
        teeth: given.teeth,
        seed: model.spec.seed,
        stop: Stop {
            force_fraction: given.stop_force_fraction,
            events: given.max_events,
            displacement_mm: given.max_displacement_mm,
        },
    }
}

/// The section where the drive stands at a displacement [mm].
fn look(breaking: &Breaking, displacement_mm: f64) -> Look {
    let (force_n, displacements_mm) = breaking.held_at(displacement_mm);
    Look {
        displacement_mm,
        force_n,
        damage: breaking.damage().to_vec(),
        stresses_mpa: breaking.stresses_mpa(&displacements_mm),
        displacements_mm,
    }
}

/// How far a test is, as far as its force or its way tells.
fn fraction(given: &Given, event: &Event, largest: f64) -> f64 {
    let by_force = (1.0 - event.force_n / largest) / (1.0 - given.stop_force_fraction);
    let by_way = given
        .max_displacement_mm
        .map_or(0.0, |most| event.displacement_mm / most);
    let by_events = event.number as f64 / given.max_events as f64;
    by_force.max(by_way).max(by_events).clamp(0.0, 0.99)
}

/// The curve that a machine records, as it grows.
struct Curve {
    machine: Machine,
}

impl Curve {
    /// Unloaded.
    const START: [f64; 4] = [0.0; 4];

    fn new(given: &Given) -> Self {
        let control = match given.control {
            spec::Control::Displacement => Control::Displacement,
            spec::Control::Force => Control::Force,
            spec::Control::Path => Control::Events,
        };
        Self {
            machine: Machine::new(control),
        }
    }

    /// Takes in events whose points are known already.
    fn known(&mut self, events: &[Event]) {
        for event in events {
            self.machine.add(event);
        }
    }

    /// Adds an event; whether the machine sees it.
    fn add(&mut self, event: &Event, watch: &mut dyn Watch) -> Result<bool, Halt> {
        let Some(points) = self.machine.add(event) else {
            return Ok(false);
        };
        for (displacement, force) in points.into_iter().flatten() {
            watch.point(&[
                displacement,
                force,
                event.number as f64,
                event.dissipated_n_mm,
            ])?;
        }
        Ok(true)
    }

    /// Where the machine stands after the last event [mm].
    fn at_mm(&self, last: &Event) -> f64 {
        let landed = self.machine.end(last);
        landed.map_or(last.displacement_mm, |(displacement, _)| displacement)
    }

    /// The fall after the last event.
    fn end(&self, events: &[Event], watch: &mut dyn Watch) -> Result<(), Halt> {
        let Some(last) = events.last() else {
            return Ok(());
        };
        if let Some((displacement, force)) = self.machine.end(last) {
            let dissipated = last.dissipated_n_mm;
            watch.point(&[displacement, force, last.number as f64, dissipated])?;
        }
        Ok(())
    }
}
