//! What a network of fibres can be refused for.

/// Why there is no network, or no equilibrium of it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// A quantity is outside its range.
    #[error("{quantity} is {value}, allowed is {allowed}")]
    Value {
        quantity: String,
        value: f64,
        allowed: &'static str,
    },
    /// A centre line of fewer than two points.
    #[error("fibre {fibre} has {points} points, allowed are 2 or more")]
    FewPoints { fibre: usize, points: usize },
    /// Two points of a centre line, one after the other, in one place.
    #[error("points {} and {point} of fibre {fibre} are in one place", point - 1)]
    SamePlace { fibre: usize, point: usize },
    /// A bond names a fibre that is not there.
    #[error("bond {bond} joins fibre {fibre}, but there are {fibres} fibres")]
    NoSuchFibre {
        bond: usize,
        fibre: u32,
        fibres: usize,
    },
    /// A bond lies beyond its fibre's end.
    #[error(
        "bond {bond} lies {at_um} um from the start of fibre {fibre}, which is {length_um} um long"
    )]
    BeyondFibre {
        bond: usize,
        fibre: u32,
        at_um: f64,
        length_um: f64,
    },
    /// Both ends of a bond are one point of one fibre.
    #[error("bond {bond} joins a point of fibre {fibre} with itself")]
    SamePoint { bond: usize, fibre: u32 },
    /// More nodes than an index holds.
    #[error("the network has {nodes} nodes, allowed are up to {}", u32::MAX / 16)]
    TooManyNodes { nodes: usize },
    /// The factor does not fit into memory.
    #[error("the factor of {unknowns} unknowns does not fit into memory")]
    TooLarge { unknowns: usize },
    /// The stiffness has no Cholesky factor.
    #[error("the network gives way without force near node {node}, ({x} {y} {z}) um")]
    GivesWay { node: usize, x: f64, y: f64, z: f64 },
    /// Forces are not in balance as well as they must be.
    #[error(
        "forces balance to {residual:e} of the largest force, allowed is {allowed:e}, after {iterations} iterations"
    )]
    Unbalanced {
        residual: f64,
        allowed: f64,
        iterations: usize,
    },
    /// Beams are held by their bending.
    #[error("only bars are taut by a strain; these fibres are not bars")]
    Taut,
    /// Bonds inside segments ask for iterations and small displacements.
    #[error(
        "bonds are attached inside segments, and neither a factor nor large displacements know these; attach them at nodes"
    )]
    Hanging,
    /// Fibres that yield have a history, which only a pull of small displacements with a factor follows.
    #[error("fibres yield, which only a pull of small displacements with bonds at nodes follows")]
    Yields,
    /// Tubes have a factor and small displacements, and are elastic until they break.
    #[error("tubes are pulled by small displacements with a factor, and do not yield")]
    Tubes,
    /// Masses in motion whose energy has no bound any more.
    #[error("the motion of masses has become unstable at step {step}")]
    Unstable { step: u64 },
    /// Segments that flow or not by turns.
    #[error("which segments yield was not decided in {rounds} rounds")]
    Undecided { rounds: usize },
    /// A state to go on from does not belong to this network.
    #[error("the state to go on from names {what} {index}, but the network has {count}")]
    ForeignState {
        what: &'static str,
        index: usize,
        count: usize,
    },
}

/// Refuses what is not finite or not as `is_allowed` wants it.
pub(crate) fn check(
    quantity: impl FnOnce() -> String,
    value: f64,
    is_allowed: bool,
    allowed: &'static str,
) -> Result<(), FrameError> {
    if value.is_finite() && is_allowed {
        Ok(())
    } else {
        Err(FrameError::Value {
            quantity: quantity(),
            value,
            allowed,
        })
    }
}
