//! What a pull must remember to go on elsewhere, and what it has measured.
use serde::{Deserialize, Serialize};

use super::error::FrameError;
use super::events::{Bore, Broken, PullEnd};
use super::network::Network;

/// Where a pull is. With the same network and test it goes on to the same bits.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PullState {
    /// Elements (segments, then bonds) that broke before the last factor was made, and after; in order.
    pub(crate) factored: Vec<u32>,
    pub(crate) taken: Vec<u32>,
    pub(crate) elongation_um: f64,
    pub(crate) avalanche: u32,
    pub(crate) ended: Option<PullEnd>,
    /// Motion of all nodes of fibres at unit elongation that iterations go on from; empty with a factor.
    pub(crate) motion: Vec<f64>,
    /// Of masses in motion.
    pub(crate) moving: Option<Moving>,
    /// Of fibres that yield.
    pub(crate) yielding: Option<Yielded>,
    pub measures: PullMeasures,
}

/// What fibres that yield have become.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Yielded {
    /// Motion of every node [µm, rad], one after the other.
    pub(crate) motion: Vec<[f64; 6]>,
    /// Of every segment: how much longer it is for good, how far it has hardened [µm], and whether it
    /// flows.
    pub(crate) segments: Vec<(f64, f64, bool)>,
    /// The same where the force was largest.
    pub(crate) peak: Option<Peak>,
}

/// Where the force was largest.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Peak {
    pub(crate) motion: Vec<[f64; 6]>,
    pub(crate) segments: Vec<(f64, f64, bool)>,
}

/// Masses in motion.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Moving {
    /// Motion [µm, rad] of every node, and its rate half a step before [µm/µs, rad/µs].
    pub(crate) motion: Vec<[f64; 6]>,
    pub(crate) velocity: Vec<[f64; 6]>,
    pub(crate) now: Moved,
    /// Means between points of the curve.
    pub(crate) intervals: Vec<Interval>,
    pub(crate) peak: Option<MovingPeak>,
}

/// When the force of masses in motion was largest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct MovingPeak {
    pub(crate) motion: Vec<[f64; 6]>,
    pub(crate) broken: usize,
    /// Whole intervals before it, and means from the last point of the curve up to it.
    pub(crate) intervals: usize,
    pub(crate) last: Interval,
}

/// What masses in motion have done so far.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Moved {
    pub(crate) steps: u64,
    /// Work of the moving jaw, what drag took, and what breaks set free [nJ].
    pub(crate) work_nj: f64,
    pub(crate) drag_nj: f64,
    pub(crate) released_nj: f64,
    pub(crate) kinetic_at_start_nj: f64,
}

/// Means between two points of the curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Interval {
    /// Elongation in the middle [µm].
    pub(crate) at_um: f64,
    pub(crate) forces_mn: [f64; 2],
    /// Kinetic energy over that of the springs.
    pub(crate) kinetic_share: f64,
    pub(crate) stored_nj: f64,
}

/// What a pull has measured so far.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PullMeasures {
    /// Force per strain before anything breaks [mN].
    pub initial_stiffness_mn: f64,
    /// Largest force [mN], its strain, and the work up to it [nJ].
    pub peak_force_mn: f64,
    pub strain_at_peak: f64,
    pub work_to_peak_nj: f64,
    /// Work of the moving jaw [nJ]: the area under the curve.
    pub work_nj: f64,
    /// Elastic energy that is left, what breaks set free, and what yielding took [nJ], also up to the peak.
    pub stored_nj: f64,
    pub released_nj: f64,
    pub dissipated_nj: f64,
    pub dissipated_at_peak_nj: f64,
    /// Kinetic energy beyond that at the start, and what drag took [nJ]; 0 at rest.
    pub kinetic_nj: f64,
    pub drag_nj: f64,
    /// Largest kinetic energy over that of the springs on the way to the peak; none at rest.
    pub kinetic_share: Option<f64>,
    /// Share of the length of all fibres that has yielded, at the peak.
    pub yielded_share_at_peak: f64,
    /// Largest turn of a node up to the peak [rad].
    pub turn_to_peak_rad: f64,
    pub broken_bonds: usize,
    pub broken_segments: usize,
    /// Largest unbalanced force over the largest force of an element.
    pub largest_residual: f64,
    /// Largest estimated error, at any rest, of the failure indices of what broke next; none with a factor.
    pub largest_index_error: Option<f64>,
    /// Largest difference of the jaws' forces over the peak.
    pub largest_jaw_imbalance: f64,
    /// Largest share of the energy in what only keeps a truss in place: near 1 it is a mechanism.
    pub largest_taut_share: f64,
}

/// What a pull cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PullCost {
    /// Unknowns, and the numbers that the factor stores: of all of them, or of groups as rigid bodies.
    pub unknowns: usize,
    pub stored: usize,
    /// Factors made, and passes of solution over one.
    pub factors: usize,
    pub solutions: usize,
    /// Iterations of all solutions; none with a factor.
    pub iterations: usize,
}

impl PullMeasures {
    /// What the energies lack, over the work: work = stored + released + dissipated, and of masses in
    /// motion kinetic energy and drag.
    #[must_use]
    pub fn energy_error(&self) -> f64 {
        let spent = self.stored_nj + self.kinetic_nj + self.drag_nj;
        let missing = self.work_nj - spent - self.released_nj - self.dissipated_nj;
        if self.work_nj > 0.0 {
            missing.abs() / self.work_nj
        } else {
            missing.abs()
        }
    }

    /// The jaw went on from one elongation to another while its force went from `from_mn` to `to_mn`.
    pub(crate) fn elongated(
        &mut self,
        [from_um, to_um]: [f64; 2],
        [from_mn, to_mn]: [f64; 2],
        length_um: f64,
    ) {
        self.work_nj += 0.5 * (from_mn + to_mn) * (to_um - from_um);
        // from rest there is always a first peak, be it 0
        if to_mn > self.peak_force_mn || from_um == 0.0 {
            self.peak_force_mn = to_mn;
            self.strain_at_peak = to_um / length_um;
            self.work_to_peak_nj = self.work_nj;
            self.dissipated_at_peak_nj = self.dissipated_nj;
        }
    }

    pub(crate) fn count(&mut self, broken: &[(Broken, Bore)]) {
        for (part, _) in broken {
            match part {
                Broken::Bond(_) => self.broken_bonds += 1,
                Broken::Segment(_) => self.broken_segments += 1,
            }
        }
    }

    /// Parts that broke.
    #[must_use]
    pub fn broken(&self) -> usize {
        self.broken_bonds + self.broken_segments
    }
}

impl Moving {
    /// The same where the force was largest, to look at.
    fn at_peak(&self) -> Option<Self> {
        let motion = &self.peak.as_ref()?.motion;
        Some(Self {
            velocity: vec![[0.0; 6]; motion.len()],
            motion: motion.clone(),
            ..Self::default()
        })
    }
}

impl PullState {
    /// Where this pull was when its force was largest and its first `broken` parts were broken: to look at,
    /// not to go on from.
    #[must_use]
    pub fn at_peak(&self, broken: usize, elongation_um: f64) -> Self {
        let gone = self.factored.iter().chain(&self.taken);
        let peak = self
            .yielding
            .as_ref()
            .and_then(|yielded| yielded.peak.as_ref());
        let moved = self.moving.as_ref().and_then(|moving| moving.peak.as_ref());
        let broken = moved.map_or(broken, |peak| peak.broken);
        Self {
            factored: gone.take(broken).copied().collect(),
            taken: Vec::new(),
            elongation_um,
            avalanche: self.avalanche,
            ended: Some(PullEnd::MaxStrain),
            motion: Vec::new(),
            moving: self.moving.as_ref().and_then(Moving::at_peak),
            yielding: peak.map(|peak| Yielded {
                motion: peak.motion.clone(),
                segments: peak.segments.clone(),
                peak: None,
            }),
            measures: self.measures,
        }
    }

    pub(crate) fn is_new(&self) -> bool {
        self.measures.broken() == 0 && self.elongation_um == 0.0 && self.ended.is_none()
    }

    /// # Errors
    /// [`FrameError::ForeignState`] when it names what the network does not have.
    pub(crate) fn check(&self, network: &Network) -> Result<(), FrameError> {
        let count = network.parts();
        match self
            .factored
            .iter()
            .chain(&self.taken)
            .find(|&&element| element as usize >= count)
        {
            Some(&element) => Err(FrameError::ForeignState {
                what: "element",
                index: element as usize,
                count,
            }),
            None => Ok(()),
        }
    }
}
