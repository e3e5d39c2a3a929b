//! Pictures of a sheet for ParaView: at the start, at the largest force and at the end.
//!
//! Every picture holds all segments of all fibres, then all bonds, broken ones included and marked, so
//! that cells keep their numbers. A segment of a tube is the lines along and around it, which all tell of the whole
//! segment.
use std::io;

use loadframe_harness::Recorder;
use loadframe_harness::vtk::{Array, Lines, Series};

use super::course::{Course, Record};
use super::specimen::Specimen;
use super::tables;
use crate::frame::{Broken, Jaw, Pulling};

/// mN in N, GPa in MPa.
const N: f64 = 1e-3;
const MPA: f64 = 1e3;

const START: &str = "snapshots/sheet_00000.vtp";
const PEAK: &str = "snapshots/sheet_00001.vtp";
const END: &str = "snapshots/sheet_00002.vtp";

/// The sheet before the pull.
pub(super) fn start(
    course: &Course<'_>,
    specimen: &Specimen,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    take(START, Some(course.pull.as_ref()), specimen, &[], recorder)
}

/// The sheet before it is held.
pub(super) fn unheld(specimen: &Specimen, recorder: &mut dyn Recorder) -> io::Result<()> {
    take(START, None, specimen, &[], recorder)
}

/// The sheet at its largest force, if there was one, and at the end; and the series of all.
pub(super) fn rest(
    course: &Course<'_>,
    peak: Option<&dyn Pulling>,
    specimen: &Specimen,
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let records = &course.kept.records;
    let length_um = specimen.network.model().length_um;
    let mut entries = vec![(0.0, START.to_owned())];
    if let Some(peak) = peak {
        let gone = &records[..course.kept.broken_at_peak.min(records.len())];
        take(PEAK, Some(peak), specimen, gone, recorder)?;
        entries.push((peak.elongation_um() / length_um, PEAK.to_owned()));
    }
    take(END, Some(course.pull.as_ref()), specimen, records, recorder)?;
    // players want times that grow, and the end may be the fall from the largest force
    let last = entries.last().map_or(0.0, |(at, _)| *at);
    let end = course.pull.elongation_um() / length_um;
    entries.push((end.max(last.next_up()), END.to_owned()));
    let series = Series { entries };
    recorder.file("snapshots.pvd", &mut |out| series.write(out))
}

fn take(
    name: &str,
    pull: Option<&dyn Pulling>,
    specimen: &Specimen,
    gone: &[Record],
    recorder: &mut dyn Recorder,
) -> io::Result<()> {
    let network = &specimen.network;
    let displacement = |node: usize| pull.map_or([0.0; 3], |pull| pull.displacement_um(node));
    let drawing = network.drawing(&displacement);
    let moved: Vec<f64> = drawing.displacements_um.iter().flatten().copied().collect();
    let jaws = drawing.jaws.iter().map(|jaw| match jaw {
        None => 0,
        Some(Jaw::Left) => 1,
        Some(Jaw::Right) => 2,
    });
    let jaws: Vec<u8> = jaws.collect();

    let (segments, bonds) = (network.segments(), network.bonds());
    let zeros = || vec![0.0; segments + bonds];
    let (mut strain, mut force, mut stress) = (zeros(), zeros(), zeros());
    for (pull, segment) in pull
        .iter()
        .flat_map(|pull| (0..segments).map(move |of| (pull, of)))
    {
        let along_mn = pull.segment_force_mn(segment);
        force[segment] = N * along_mn;
        stress[segment] = MPA * pull.segment_stress_gpa(segment);
        strain[segment] = along_mn / network.segment_stiffness_mn(segment);
    }
    for (pull, bond) in pull
        .iter()
        .flat_map(|pull| (0..bonds).map(move |of| (pull, of)))
    {
        let [normal, shear] = pull.bond_force_mn(bond);
        force[segments + bond] = N * normal.hypot(shear);
    }
    let parts = (0..segments)
        .map(Broken::Segment)
        .chain((0..bonds).map(Broken::Bond));
    let broken: Vec<u8> = parts
        .map(|part| u8::from(pull.is_some_and(|pull| pull.is_broken(part))))
        .collect();
    let mut modes = vec![0_u8; segments + bonds];
    for record in gone {
        let mode = record
            .bond()
            .and_then(|bond| specimen.mode(bond, record.event.bore));
        let element = match record.event.broken {
            Broken::Segment(segment) => segment,
            Broken::Bond(bond) => segments + bond,
        };
        modes[element] = tables::number(mode) as u8;
    }
    let is_bond: Vec<u8> = (0..segments + bonds)
        .map(|element| u8::from(element >= segments))
        .collect();
    let owners = (0..segments).map(|segment| network.segment_fibre(segment) as i32);
    let owners: Vec<i32> = owners.chain((0..bonds).map(|bond| bond as i32)).collect();
    // a line shows its part
    let elements = drawing.parts.iter().map(|part| match *part {
        Broken::Segment(segment) => segment,
        Broken::Bond(bond) => segments + bond,
    });
    let elements: Vec<usize> = elements.collect();
    let [strain, force, stress] = [strain, force, stress].map(|all| of_lines(&elements, &all));
    let [broken, modes, is_bond] = [broken, modes, is_bond].map(|all| of_lines(&elements, &all));
    let owners = of_lines(&elements, &owners);
    let lines = Lines {
        points: &drawing.points_um,
        ends: &drawing.lines,
        point_data: &[
            Array::vectors("displacement_um", &moved),
            Array::bytes("jaw", &jaws),
        ],
        cell_data: &[
            Array::scalars("strain", &strain),
            Array::scalars("force_n", &force),
            Array::scalars("stress_mpa", &stress),
            Array::bytes("broken", &broken),
            Array::bytes("mode", &modes),
            Array::bytes("is_bond", &is_bond),
            Array::indices("number", &owners),
        ],
    };
    recorder.file(name, &mut |out| lines.write(out))
}

/// What each line has of its part.
fn of_lines<T: Copy>(elements: &[usize], of_parts: &[T]) -> Vec<T> {
    elements.iter().map(|&element| of_parts[element]).collect()
}
