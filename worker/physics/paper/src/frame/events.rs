//! What happens in a pull: breaks, what parts bore when they broke, and why it ended.
use serde::{Deserialize, Serialize};

use super::element::{PARTS, stress_gpa};
use super::network::Network;

/// What broke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Broken {
    Bond(usize),
    Segment(usize),
}

impl Broken {
    /// The element that it is.
    pub(crate) fn element(self, network: &Network) -> usize {
        match self {
            Self::Bond(bond) => network.segments() + bond,
            Self::Segment(segment) => segment,
        }
    }
}

/// What it bore when it broke.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Bore {
    /// A bond: force across its face (opening is positive) and along it [mN].
    Bond { normal_mn: f64, shear_mn: f64 },
    /// A segment: tensile stress of force and bending [GPa].
    Segment { stress_gpa: f64 },
}

/// A break.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Event {
    pub strain: f64,
    pub elongation_um: f64,
    /// Which avalanche it belongs to, from 1: breaks at one elongation.
    pub avalanche: u32,
    pub broken: Broken,
    pub bore: Bore,
    /// Force at the moving jaw before and after [mN].
    pub force_before_mn: f64,
    pub force_after_mn: f64,
    /// Force at the jaw at rest before and after [mN].
    pub left_force_before_mn: f64,
    pub left_force_after_mn: f64,
    /// Elastic energy before it [nJ].
    pub stored_before_nj: f64,
    /// Elastic energy that it set free [nJ].
    pub energy_released_nj: f64,
    /// Largest unbalanced force after it over the largest force of an element.
    pub residual: f64,
}

/// Why a pull ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PullEnd {
    /// The largest strain is reached.
    MaxStrain,
    /// The force fell to the given share of its peak.
    ForceFraction,
    /// Nothing ties the jaws together any more.
    Parted,
    /// Nothing ever did: the network is below percolation.
    NoPath,
}

impl PullEnd {
    /// The reason in a sentence.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            Self::MaxStrain => "the largest strain is reached",
            Self::ForceFraction => "the force fell to the given share of its peak",
            Self::Parted => "no fibres and bonds tie the jaws together any more",
            Self::NoPath => "no fibres and bonds ever tied the jaws together: the force is 0",
        }
    }
}

/// What a step of the pull gave.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Parts broke together, the most loaded first; one where they break one by one. The force falls, and
    /// energy is set free, with the last.
    Broke(Vec<Event>),
    /// It moved on to the next point of the curve, and these broke on the way.
    Moved(Vec<Event>),
    /// It went on without a break: fibres yielded, or a part of the way is done.
    Strained,
    Ended(PullEnd),
}

/// How a network was before parts broke together, and what is left of its force.
pub(crate) struct Breaking {
    pub(crate) elongation_um: f64,
    pub(crate) avalanche: u32,
    /// At the left and the right jaw [mN].
    pub(crate) before_mn: [f64; 2],
    pub(crate) after_mn: [f64; 2],
    pub(crate) stored_before_nj: f64,
    pub(crate) released_nj: f64,
    pub(crate) residual: f64,
}

impl Breaking {
    /// A break for each part: forces fall, and energy is set free, with the last.
    pub(crate) fn events(&self, network: &Network, bore: Vec<(Broken, Bore)>) -> Vec<Event> {
        let last = bore.len().saturating_sub(1);
        let events = bore.into_iter().enumerate().map(|(index, (broken, bore))| {
            let (left, released) = if index == last {
                (self.after_mn, self.released_nj)
            } else {
                (self.before_mn, 0.0)
            };
            Event {
                strain: self.elongation_um / network.model().length_um,
                elongation_um: self.elongation_um,
                avalanche: self.avalanche,
                broken,
                bore,
                force_before_mn: self.before_mn[1],
                force_after_mn: left[1],
                left_force_before_mn: self.before_mn[0],
                left_force_after_mn: left[0],
                stored_before_nj: self.stored_before_nj,
                energy_released_nj: released,
                residual: self.residual,
            }
        });
        events.collect()
    }
}

/// What a part is, and what it bears.
pub(crate) fn bore(network: &Network, element: usize, loads: &[f64; PARTS]) -> (Broken, Bore) {
    if element < network.segments() {
        let stress_gpa = stress_gpa(network.section_of(element), network.model().level, loads);
        (Broken::Segment(element), Bore::Segment { stress_gpa })
    } else {
        let bore = Bore::Bond {
            normal_mn: loads[0],
            shear_mn: loads[1].hypot(loads[2]),
        };
        (Broken::Bond(element - network.segments()), bore)
    }
}
