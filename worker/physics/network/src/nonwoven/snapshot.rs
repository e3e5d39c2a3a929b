//! Pictures of the network for ParaView, and the distribution of bond forces.
//!
//! Every snapshot holds all bonds in the order of the network, broken ones included and marked, so
//! that cell numbers are the bond numbers of `events.csv` and filters over time find the same
//! cells. To see the intact network, keep the cells with `broken` below one half.
use std::io::{self, Write};

use loadframe_api::spec::nonwoven_tensile::NonwovenTensile;
use loadframe_harness::{
    Recorder,
    vtk::{Array, Lines, Series},
};

use super::{
    experiment::{Experiment, Loaded},
    specimen::Specimen,
    state::{HistogramBin, State},
};
use crate::{Vector, configuration::Configuration};

/// Bond quantities of a snapshot; zero for broken and unloaded bonds.
struct Fields {
    strain: Vec<f64>,
    force: Vec<f64>,
    force_over_strength: Vec<f64>,
    broken: Vec<u8>,
}

/// Name of the snapshot of a step.
fn name(step: u64) -> String {
    format!("snapshots/step_{step:05}.vtp")
}

/// Name of the snapshot of the largest force.
const PEAK: &str = "snapshots/peak.vtp";

/// Writes the snapshot of the step just recorded and keeps its force histogram.
pub(super) fn take(experiment: &mut Experiment<'_>, recorder: &mut dyn Recorder) -> io::Result<()> {
    let step = experiment.state.step;
    let settled = experiment.settled.as_ref();
    let fields = fields(
        &experiment.specimen,
        &experiment.loaded,
        settled.map(|settled| &settled.configuration),
    );
    let displacements = &experiment.state.displacements;
    write(
        &name(step),
        &experiment.specimen,
        displacements,
        &fields,
        recorder,
    )?;
    let bins = histogram(experiment);
    experiment.state.histogram.extend(bins);
    let nominal_strain = experiment.nominal_strain();
    experiment.state.snapshots.push((step, nominal_strain));
    Ok(())
}

/// Writes the snapshot of a specimen that nothing was done to.
pub(super) fn take_first(specimen: &Specimen, recorder: &mut dyn Recorder) -> io::Result<()> {
    let network = &specimen.network;
    let zeros = || vec![0.0; network.bonds.len()];
    let fields = Fields {
        strain: zeros(),
        force: zeros(),
        force_over_strength: zeros(),
        broken: vec![0; network.bonds.len()],
    };
    let displacements = vec![Vector::zeros(); network.positions.len()];
    write(&name(0), specimen, &displacements, &fields, recorder)
}

/// Writes the snapshot of the largest force, whichever steps have theirs.
pub(super) fn take_peak(
    experiment: &Experiment<'_>,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let Some(peak) = &experiment.state.peak else {
        return Ok(());
    };
    let (loaded, configuration) = experiment.at(peak);
    let fields = fields(&experiment.specimen, &loaded, Some(&configuration));
    write(
        PEAK,
        &experiment.specimen,
        &peak.displacements,
        &fields,
        recorder,
    )
}

fn write(
    name: &str,
    specimen: &Specimen,
    displacements: &[Vector],
    fields: &Fields,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let network = &specimen.network;
    let moved = network.positions.iter().zip(displacements);
    let points: Vec<[f64; 3]> = moved
        .map(|(position, moved)| (position + moved).into())
        .collect();
    let moved = displacements.iter();
    let displacement: Vec<f64> = moved
        .flat_map(|moved| [moved.x, moved.y, moved.z])
        .collect();
    // 0 for none, 1 and 2 for the jaws, then other sets; more than a byte tells are one
    let number = |set: u16| u8::try_from(set + 1).unwrap_or(u8::MAX);
    let jaw = network.holds.iter().map(|hold| hold.map_or(0, number));
    let jaw: Vec<u8> = jaw.collect();
    let lines = Lines {
        points: &points,
        ends: &network.bonds.ends,
        point_data: &[
            Array::vectors("displacement_mm", &displacement),
            Array::bytes("jaw", &jaw),
        ],
        cell_data: &[
            Array::scalars("strain", &fields.strain),
            Array::scalars("force_n", &fields.force),
            Array::scalars("force_over_strength", &fields.force_over_strength),
            Array::bytes("broken", &fields.broken),
        ],
    };
    recorder.file(name, &mut |out| lines.write(out))
}

/// The series of all snapshots, played over nominal strain, or over steps where it comes back.
pub(super) fn series(out: &mut dyn Write, spec: &NonwovenTensile, state: &State) -> io::Result<()> {
    let has_history = !spec.test.history.is_empty();
    let entry = |(step, strain): &(u64, f64)| {
        let time = if has_history { *step as f64 } else { *strain };
        (time, name(*step))
    };
    let entries = state.snapshots.iter().map(entry).collect();
    Series { entries }.write(out)
}

fn fields(specimen: &Specimen, loaded: &Loaded, configuration: Option<&Configuration>) -> Fields {
    let bonds = loaded.intact.len();
    let mut fields = Fields {
        strain: vec![0.0; bonds],
        force: vec![0.0; bonds],
        force_over_strength: vec![0.0; bonds],
        broken: loaded
            .intact
            .iter()
            .map(|intact| u8::from(!intact))
            .collect(),
    };
    let strengths = &specimen.network.bonds.strengths;
    let Some(configuration) = configuration else {
        return fields;
    };
    for (bond, (strength, slot)) in strengths.iter().zip(loaded.assembly.slots()).enumerate() {
        let state = configuration.bond(&loaded.assembly, slot);
        fields.strain[bond] = state.strain;
        fields.force[bond] = state.tension;
        // a bond without strength is at its strength as soon as it is loaded
        if *strength > 0.0 {
            fields.force_over_strength[bond] = state.tension / strength;
        }
    }
    fields
}

/// Numbers of loaded bonds in equal bins from the smallest to the largest force.
pub(super) fn histogram(experiment: &Experiment<'_>) -> Vec<HistogramBin> {
    let Some(settled) = &experiment.settled else {
        return Vec::new();
    };
    let assembly = &experiment.loaded.assembly;
    let tensions = || {
        let acting = assembly.slots().filter(|slot| assembly.acts(*slot));
        acting.map(|slot| settled.configuration.tensions[slot])
    };
    let lowest = tensions().fold(f64::INFINITY, f64::min);
    let highest = tensions().fold(f64::NEG_INFINITY, f64::max);
    let bins = if lowest < highest {
        experiment.histogram_bins()
    } else {
        1
    };
    let width = (highest - lowest) / f64::from(bins);
    let bound = |bin: u32| {
        if bin == bins {
            highest
        } else {
            lowest + f64::from(bin) * width
        }
    };
    let nominal_strain = experiment.nominal_strain();
    let mut histogram: Vec<HistogramBin> = (0..bins)
        .map(|bin| HistogramBin {
            nominal_strain,
            lower: bound(bin),
            upper: bound(bin + 1),
            bonds: 0,
        })
        .collect();
    for tension in tensions() {
        // NaN for equal forces becomes bin 0
        let bin = ((tension - lowest) / width) as usize;
        histogram[bin.min(bins as usize - 1)].bonds += 1;
    }
    histogram
}
