//! Rollers on a section that breaks.
//!
//! Between events the section answers in proportion to its load, a contact does not: it grows with
//! the force, and moves as cracks let the section turn. So the forces on particles keep their
//! proportions only while they are near those of the contact, and are found anew for the section as
//! it is broken, at the force of the next event, when they are not: when that force has grown or
//! fallen far, or the rollers would have to bend or part by more than a thousandth of their way.
use crate::error::CompositeError;
use crate::lattice::Lattice;
use crate::solve::{Point, PressedRoller, Roller, StaticOptions, points, pressed_equilibrium};
use crate::supports::Supports;

/// Rollers that bend a section, and their force.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressed {
    pub resting: Vec<Roller>,
    pub pressing: Vec<Roller>,
    /// Total force of those that press, at load factor 1 [N].
    pub force_n: f64,
    /// What keeps the section from sliding while contact is found.
    pub kept: Supports,
}

/// Change of the force since contact was found, up and down, beyond which it is found anew: the
/// width of a contact grows with its root.
const GROWN: f64 = 1.1;
const FALLEN: f64 = 0.5;
/// How far rollers may miss the section, over their way.
const MISSED: f64 = 1e-3;

/// The contact as it was found last.
#[derive(Debug)]
pub(crate) struct Contact {
    pressed: Pressed,
    points: Vec<Point>,
    /// Load factor at which it was found.
    pub(crate) factor: f64,
}

impl Contact {
    /// A contact that was found at load factor 1.
    pub(crate) fn new(lattice: &Lattice, pressed: &Pressed) -> Result<Self, CompositeError> {
        let rollers: Vec<Roller> = pressed.rollers();
        Ok(Self {
            points: points(lattice.grid(), &pressed.kept, &rollers)?,
            pressed: pressed.clone(),
            factor: 1.0,
        })
    }

    /// Whether forces in the proportions of `load` fit the section no longer at a load factor, with
    /// its displacements at load factor 1, and the way of the drive there [mm].
    pub(crate) fn is_stale(&self, load: &[f64], unit: &[f64], factor: f64, way_mm: f64) -> bool {
        let change = factor / self.factor;
        if !(FALLEN..=GROWN).contains(&change) {
            return true;
        }
        let count = self.pressed.resting.len() + self.pressed.pressing.len();
        // what each roller would have to advance, by the particles it presses
        let mut sums = vec![[0.0; 3]; count];
        let advance =
            |point: &Point| point.gap_mm + point.inward * factor * unit[point.displacement];
        let pressing = |point: &Point| (point.inward * load[point.displacement]).max(0.0);
        for point in &self.points {
            let force = pressing(point);
            let sum = &mut sums[point.roller];
            sum[0] += force;
            sum[1] += force * advance(point);
            sum[2] += force * point.at_mm;
        }
        let mut missed = vec![0.0_f64; count];
        for point in &self.points {
            let [force, mean, _] = sums[point.roller];
            if force <= 0.0 {
                return true;
            }
            let miss = mean / force - advance(point);
            let own = pressing(point);
            missed[point.roller] += own / force * miss.abs();
            if own <= 0.0 && miss > MISSED * way_mm {
                return true;
            }
        }
        missed.iter().any(|miss| *miss > MISSED * way_mm) || self.tilts(&sums, way_mm)
    }

    /// Whether rollers that move together would have come apart. The section's displacements are known
    /// but for a motion as a whole, by which the resting ones come to lie where they are.
    fn tilts(&self, sums: &[[f64; 3]], way_mm: f64) -> bool {
        let resting = self.pressed.resting.len();
        let ([[f, a, x], [g, b, y]], pressing) = (
            match sums[..resting] {
                [first, second] => [first, second],
                _ => return false,
            },
            &sums[resting..],
        );
        let (first, second) = (x / f, y / g);
        let slope = (b / g - a / f) / (second - first);
        let advances: Vec<f64> = pressing
            .iter()
            .map(|[force, sum, moment]| {
                // the section rises by what the resting rollers lack
                sum / force + a / f + slope * (moment / force - first)
            })
            .collect();
        let low = advances.iter().copied().fold(f64::INFINITY, f64::min);
        let high = advances.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high - low > MISSED * way_mm
    }

    /// The forces of rollers on the section as it is broken, at a load factor, over that factor [N].
    pub(crate) fn found(&self, lattice: &Lattice, factor: f64) -> Result<Vec<f64>, CompositeError> {
        let resting: Vec<PressedRoller> = self
            .pressed
            .resting
            .iter()
            .map(|&roller| PressedRoller {
                roller,
                advance_mm: 0.0,
            })
            .collect();
        let still = vec![0.0; lattice.displacements()];
        let found = pressed_equilibrium(
            lattice,
            &self.pressed.kept,
            &still,
            &resting,
            &self.pressed.pressing,
            factor * self.pressed.force_n,
            &StaticOptions::default(),
        )?;
        let mut load = still;
        for point in &self.points {
            let place = point.displacement;
            load[place] = found.equilibrium.reactions_n[place] / factor;
        }
        Ok(load)
    }
}

impl Pressed {
    fn rollers(&self) -> Vec<Roller> {
        self.resting.iter().chain(&self.pressing).copied().collect()
    }
}
