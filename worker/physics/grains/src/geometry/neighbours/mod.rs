//! Which bodies may touch before the next search.
//!
//! [`order`] puts bodies that are near in space near in memory. [`grid`] finds every pair of
//! spheres closer than the skin. [`skin`] says when the next search is due, and how wide its skin
//! should be: wide for bodies that flow, narrow for a bed at rest, which then looks at hardly
//! anything but its contacts.
pub(crate) mod grid;
pub(crate) mod order;
pub(crate) mod skin;
