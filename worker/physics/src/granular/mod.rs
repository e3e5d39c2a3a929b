//! Bodies in contact: the discrete element method.

#[cfg_attr(
    not(test),
    expect(dead_code, unused_imports, reason = "the engine that calls it follows")
)]
mod clump_geometry;
#[cfg_attr(
    not(test),
    expect(dead_code, reason = "the engine that calls it follows")
)]
#[expect(unused_imports, reason = "the engine that calls it follows")]
mod generate;
// the compiler does not count an expectation here as met
#[allow(dead_code, reason = "the engine that calls it follows")]
#[expect(unused_imports, reason = "the engine that calls it follows")]
mod import;
#[cfg_attr(
    not(test),
    expect(dead_code, reason = "the engine that calls it follows")
)]
mod lattice;
#[cfg_attr(
    not(test),
    expect(dead_code, reason = "the engine that calls it follows")
)]
#[expect(unused_imports, reason = "the engine that calls it follows")]
mod mesh;
mod sphere;
