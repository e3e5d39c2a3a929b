//! Small displacements or large ones, and what of the energy is wanted of them.
/// How displacements are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Geometry {
    /// Small displacements: forces are proportional to them.
    Linear,
    /// Rotations of any size.
    Large,
}

/// Which tangent of the energy is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tangent {
    /// The energy's second derivatives.
    Exact,
    /// Without the parts that may be negative: always leads downhill.
    Convex,
}
