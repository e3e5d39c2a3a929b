//! What every pull can be asked, whatever its fibres are and however it goes.
use super::element::{PARTS, stress_gpa};
use super::error::FrameError;
use super::events::{Broken, Event, PullEnd, Step};
use super::moving::MotionReport;
use super::network::Network;
use super::state::{PullCost, PullState};

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

    /// Error of failure indices that is allowed.
    fn index_limit(&self) -> f64 {
        self.residual_limit()
    }

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

    /// The point of the curve that it is at.
    fn curve_point(&self) -> CurvePoint {
        let measures = &self.state().measures;
        CurvePoint {
            at_um: self.elongation_um(),
            forces_mn: self.jaw_force_mn(),
            stored_nj: measures.stored_nj,
            residual: measures.largest_residual,
        }
    }

    /// How masses moved; none where every point is one of rest.
    fn motion_report(&self) -> Option<MotionReport> {
        None
    }

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

/// A point of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    pub at_um: f64,
    /// Forces of the left and the right jaw [mN].
    pub forces_mn: [f64; 2],
    /// Elastic energy [nJ].
    pub stored_nj: f64,
    /// What is missing to rest, to be held against [`Pulling::residual_limit`].
    pub residual: f64,
}

/// Loads q of an element, in the order of its springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loads(pub(crate) [f64; PARTS]);

/// Pulls to the end; gives every break and why it ended.
///
/// # Errors
/// As [`Pulling::advance`].
pub fn run(pull: &mut dyn Pulling) -> Result<(Vec<Event>, PullEnd), FrameError> {
    let mut events = Vec::new();
    loop {
        match pull.advance()? {
            Step::Broke(broke) | Step::Moved(broke) => events.extend(broke),
            Step::Strained => {}
            Step::Ended(end) => return Ok((events, end)),
        }
    }
}
