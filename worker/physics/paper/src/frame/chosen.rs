//! The pull that suits a network.
use super::element::Element;
use super::error::FrameError;
use super::held::Means;
use super::moving::MovingPull;
use super::network::Network;
use super::pull::{Pull, PullTest};
use super::pulling::Pulling;
use super::state::PullState;
use super::tubes::PointSprings;
use super::yielding::YieldingPull;

/// A pull of this network from a state of the same network and test, to the same bits: with masses in
/// motion where that is asked for, with fibres that yield where there are such.
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
    if let Some(motion) = means.motion {
        return Ok(if network.tubes().is_some() {
            Box::new(MovingPull::<PointSprings>::resume(
                network, test, motion, state,
            )?)
        } else {
            Box::new(MovingPull::<Element>::resume(network, test, motion, state)?)
        });
    }
    Ok(if network.yields() {
        Box::new(YieldingPull::resume(network, test, state)?)
    } else {
        Box::new(Pull::resume(network, test, state, means)?)
    })
}
