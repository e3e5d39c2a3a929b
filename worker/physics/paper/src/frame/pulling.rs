//! What every pull can be asked, whatever its fibres are and however it goes.
use super::element::{PARTS, stress_gpa};
use super::error::FrameError;
use super::held::Means;
use super::network::Network;
use super::pull::{Bore, Broken, Event, Pull, PullEnd, PullTest, Step};
use super::state::{PullCost, PullMeasures, PullState};
use super::yielding::YieldingPull;

/// A pull under way.
pub trait Pulling: std::fmt::Debug {
    /// Goes to the next break, or breaks, or a little on, or to the end.
    ///
    /// # Errors
    /// [`FrameError`] when the network has no equilibrium.
    fn advance(&mut self) -> Result<Step, FrameError>;

    /// Elongation as it is [µm].
    fn elongation_um(&self) -> f64;

    /// Forces of the left and the right jaw, positive when they pull [mN].
    fn jaw_force_mn(&self) -> [f64; 2];

    /// Displacement of a node as it is [µm].
    fn displacement_um(&self, node: usize) -> [f64; 3];

    /// Largest turn of a node as it is [rad]: small displacements are small where turns are.
    fn turn_rad(&self) -> f64;

    /// Loads of an element as it is [mN or mN µm]; none when it is broken or hangs loose.
    fn loads(&self, element: usize) -> Option<Loads>;

    /// Whether a part is broken.
    fn is_broken(&self, part: Broken) -> bool;

    /// Unbalanced force over the largest force of an element that is allowed.
    fn residual_limit(&self) -> f64;

    /// What it takes to go on.
    fn state(&self) -> &PullState;

    /// Factors made and passes of solution, since it was built: what a pull costs.
    fn cost(&self) -> PullCost;

    /// What it pulls.
    fn network(&self) -> &Network;

    /// Elongation that would be left were it unloaded from here without another event [µm].
    ///
    /// # Errors
    /// [`FrameError`] when the network has no equilibrium.
    fn residual_elongation_um(&self) -> Result<f64, FrameError>;

    /// Tensile stress of a segment of force and bending as it is [GPa]; 0 when it is broken.
    fn segment_stress_gpa(&self, segment: usize) -> f64 {
        let network = self.network();
        let loads = self.loads(segment);
        loads.map_or(0.0, |loads| {
            stress_gpa(network.section_of(segment), network.model().level, &loads.0)
        })
    }

    /// Force along a segment as it is [mN], tension positive; 0 when it is broken.
    fn segment_force_mn(&self, segment: usize) -> f64 {
        self.loads(segment).map_or(0.0, |loads| loads.0[0])
    }

    /// Force of a bond across its face and along it as it is [mN]; 0 when it is broken.
    fn bond_force_mn(&self, bond: usize) -> [f64; 2] {
        let loads = self.loads(self.network().segments() + bond);
        loads.map_or([0.0; 2], |Loads(loads)| {
            [loads[0], loads[1].hypot(loads[2])]
        })
    }
}

/// Loads q of an element, in the order of its springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loads(pub(crate) [f64; PARTS]);

/// A pull of this network from a state of the same network and test, to the same bits: with fibres that
/// yield where there are such.
///
/// # Errors
/// [`FrameError`] when the test is outside its range, the state names parts that the network does not have,
/// or the network has no equilibrium.
pub fn pull<'n>(
    network: &'n Network,
    test: PullTest,
    state: PullState,
    means: &Means,
) -> Result<Box<dyn Pulling + 'n>, FrameError> {
    Ok(if network.yields() {
        Box::new(YieldingPull::resume(network, test, state)?)
    } else {
        Box::new(Pull::resume(network, test, state, means)?)
    })
}

/// Pulls to the end; gives every break and why it ended.
///
/// # Errors
/// As [`Pulling::advance`].
pub fn run(pull: &mut dyn Pulling) -> Result<(Vec<Event>, PullEnd), FrameError> {
    let mut events = Vec::new();
    loop {
        match pull.advance()? {
            Step::Broke(broke) => events.extend(broke),
            Step::Strained => {}
            Step::Ended(end) => return Ok((events, end)),
        }
    }
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

impl PullMeasures {
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
}
