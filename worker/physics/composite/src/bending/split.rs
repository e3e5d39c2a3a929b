//! Double cantilevers: arms of a split laminate as two beams.
//!
//! Each arm is a cantilever of the crack's length a by [Timoshenko1921], so that under the force P
//!
//! δ / P = Σ a³/(3 EI) + a/(kGA),  G = P²/(2b) d(δ/P)/da = P²/(2b) Σ a²/EI + 1/(kGA)
//!
//! over both arms, the width b, as [Williams1989] has it. The length is the one that the measured δ/P stands
//! for: what the root turns and the zone in which the crack opens are in it, as the correction Δ is that
//! [ASTMD5528] and [ISO15024] add to a measured length.
use super::arms::{face_mm, open};
use super::model::Model;
use super::tested::Broken;
use crate::breaking::Event;
use crate::error::CompositeError;
use crate::flexure::Beam;
use crate::section::Section;

/// What a double cantilever comes to; not numbers where the test did not get so far.
pub(super) struct Peeled {
    /// G while the crack grows, mean over its events [N/mm].
    pub(super) release_rate: f64,
    /// What the crack took for its area while it grew [N/mm].
    pub(super) energy_per_area: f64,
    /// P/δ of beams as long as the first crack [N/mm].
    pub(super) beam_stiffness: f64,
    /// a by δ/P at the last event [mm].
    pub(super) crack_length_mm: f64,
}

/// How far from where it began and from the right end a crack must be, over the height of the higher arm,
/// to grow as a long one does: the root's rotation needs its room, and so does the end.
const BEGUN: f64 = 1.0;
const ENDING: f64 = 3.0;

/// The arms as beams.
struct Arms {
    both: [Beam; 2],
    width_mm: f64,
}

impl Arms {
    /// `None` where an arm is no beam.
    fn of(model: &Model<'_>) -> Result<Option<Self>, CompositeError> {
        let section = &model.section;
        let count = open(model.spec).map_or(0, |open| open.above_ply as usize);
        let height = face_mm(model.spec);
        let (lower, upper) = section.plies.split_at(count.min(section.plies.len()));
        let arm = |plies: &[crate::section::Ply], height_mm: f64| {
            Beam::of(&Section {
                plies: plies.to_vec(),
                height_mm,
                ..section.clone()
            })
        };
        let both = [arm(lower, height)?, arm(upper, section.height_mm - height)?];
        Ok(match both {
            [Some(lower), Some(upper)] => Some(Self {
                both: [lower, upper],
                width_mm: section.thickness_mm,
            }),
            _ => None,
        })
    }

    /// δ / P [mm/N] of a crack's length, and its derivative.
    fn compliance(&self, a: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for beam in &self.both {
            sums[0] += a.powi(3) / (3.0 * beam.bending_n_mm2) + a / beam.shear_n;
            sums[1] += a * a / beam.bending_n_mm2 + 1.0 / beam.shear_n;
        }
        sums
    }

    /// The length whose beams are as soft [mm].
    fn length_mm(&self, compliance: f64) -> f64 {
        let bending: f64 = self.both.iter().map(|beam| 1.0 / beam.bending_n_mm2).sum();
        // from above, where the cubic is convex, Newton's method comes down
        let mut length = (3.0 * compliance / bending).cbrt();
        for _ in 0..60 {
            let [value, slope] = self.compliance(length);
            length -= (value - compliance) / slope;
        }
        length
    }

    /// a [mm] and G [N/mm] at an event.
    fn at(&self, event: &Event) -> [f64; 2] {
        let length = self.length_mm(event.displacement_mm / event.force_n);
        let [_, slope] = self.compliance(length);
        let rate = event.force_n * event.force_n * slope / (2.0 * self.width_mm);
        [length, rate]
    }
}

/// What a double cantilever came to; `None` where its arms are no beams.
pub(super) fn peeled(model: &Model<'_>, broken: &Broken) -> Option<Peeled> {
    let arms = Arms::of(model).ok().flatten()?;
    let notch = open(model.spec)?.to_mm;
    let section = &model.spec.section;
    let face = face_mm(model.spec);
    let height = face.max(section.height_mm - face);
    let along: Vec<[f64; 2]> = broken.events.iter().map(|event| arms.at(event)).collect();
    let first = along.first().map_or(f64::NAN, |[length, _]| *length);
    let grows = first + BEGUN * height..section.length_mm - ENDING * height;
    let rates = along.iter().filter(|[length, _]| grows.contains(length));
    let (sum, count) = rates.fold((0.0, 0.0), |(sum, count), [_, rate]| {
        (sum + rate, count + 1.0)
    });
    Some(Peeled {
        release_rate: sum / count,
        energy_per_area: taken_per_area(&broken.events),
        beam_stiffness: 1.0 / arms.compliance(notch)[0],
        crack_length_mm: along.last().map_or(f64::NAN, |[length, _]| *length),
    })
}

/// Energy per area over the middle half of the openings [N/mm], lest its beginning and end count.
fn taken_per_area(events: &[Event]) -> f64 {
    let opened: Vec<&Event> = (events.iter())
        .filter(|event| event.crack_area_mm2 > 0.0)
        .collect();
    if opened.len() < 8 {
        return f64::NAN;
    }
    let (first, last) = (opened[opened.len() / 4], opened[3 * opened.len() / 4]);
    let between = |event: &&&Event| event.number > first.number && event.number <= last.number;
    let area: f64 = opened
        .iter()
        .filter(between)
        .map(|event| event.crack_area_mm2)
        .sum();
    (last.dissipated_n_mm - first.dissipated_n_mm) / area
}
