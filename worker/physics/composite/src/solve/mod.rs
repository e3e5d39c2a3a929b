//! Ways to equilibrium.
mod circles;
mod contact;
pub(crate) mod direct;
mod equations;
pub(crate) mod equilibrium;
mod load_path;
pub(crate) mod multigrid;
mod order;

pub use contact::{
    ContactEquilibrium, PressedRoller, Roller, RollerContact, Rolling, RollingState,
    contact_equilibrium, pressed_equilibrium,
};
pub(crate) use contact::{Point, points};
pub use equations::Method;
pub(crate) use equations::{Equations, told};
pub use equilibrium::{Equilibrium, StaticOptions};
pub use load_path::{LoadPath, PathState, equilibrium, is_stable};
