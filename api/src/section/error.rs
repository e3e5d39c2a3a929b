//! Why a section cannot be described, or has no result.

/// What is wrong with a description, or what made an equilibrium or a motion impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompositeError {
    /// A number is outside the range in which it means something.
    #[error("{quantity} is {given} and must be {allowed}")]
    OutOfRange {
        quantity: &'static str,
        given: f64,
        allowed: &'static str,
    },
    /// Elastic constants would let the material give out energy when it is strained.
    #[error(
        "the elastic constants are not those of a stable material: {quantity} is {given} and must \
         lie between -{bound} and {bound}"
    )]
    UnstableMaterial {
        quantity: &'static str,
        given: f64,
        bound: f64,
    },
    /// The three Poisson ratios do not go together, though each alone would.
    #[error(
        "the elastic constants are not those of a stable material: 1 - ν₁₂ν₂₁ - ν₂₃ν₃₂ - ν₁₃ν₃₁ - \
         2 ν₂₁ν₃₂ν₁₃ is {determinant} and must be positive; lower a Poisson ratio"
    )]
    UnstableTogether { determinant: f64 },
    /// Two fibres share a place.
    #[error(
        "fibres {first} and {second} overlap by {area_mm2} mm² around ({x_mm} mm, {y_mm} mm): move \
         one, or cut it with a length"
    )]
    Overlap {
        first: usize,
        second: usize,
        area_mm2: f64,
        x_mm: f64,
        y_mm: f64,
    },
    /// Plies do not fill the section's height.
    #[error(
        "the plies are {total_mm} mm thick together and the section is {height_mm} mm high: make \
         them agree"
    )]
    PliesMissHeight { total_mm: f64, height_mm: f64 },
    /// A fibre lies beside the section.
    #[error("fibre {fibre} does not touch the section: move its point into the section")]
    FibreOutside { fibre: usize },
    /// The paper's lattice has no rule for cells that are not square.
    #[error(
        "the paper's lattice needs square cells, and these are {width_mm} mm by {height_mm} mm: \
         choose numbers of cells in proportion to the section's sides, or the exact lattice"
    )]
    NotSquare { width_mm: f64, height_mm: f64 },
    /// The supports leave the section free to move as a whole.
    #[error("the supports let the section {motion}: fix it where it could move")]
    Unsupported { motion: &'static str },
    /// A grid that is not to be made as large as that.
    #[error("the grid has {cells} cells, and at most {most} are laid out here")]
    TooManyCells { cells: usize, most: usize },
    /// Nobody wants it any more.
    #[error("what was being made is not wanted any more")]
    GivenUp,
    /// The lattice yields without resistance, as far as double precision can tell.
    #[error(
        "the lattice yields without resistance at ({x_mm} mm, {y_mm} mm): bonds along edges alone do \
         not keep the shape of a cell (choose crossed bonds or one diagonal); with other bonds the \
         section is too slender, or its materials too different, for double precision (a smaller \
         ratio of length to height, or of moduli)"
    )]
    Mechanism { x_mm: f64, y_mm: f64 },
    /// No memory for the equations.
    #[error(
        "the equations of {particles} particles do not fit into memory: use fewer cells, or \
         conjugate gradients"
    )]
    TooLarge { particles: usize },
    /// Supports that meet at a node ask for different displacements.
    #[error(
        "supports ask for different displacements along {axis} at ({x_mm} mm, {y_mm} mm): {first_mm} \
         mm and {second_mm} mm"
    )]
    Contradiction {
        axis: char,
        x_mm: f64,
        y_mm: f64,
        first_mm: f64,
        second_mm: f64,
    },
    /// A place lies outside the section.
    #[error("{what} at ({x_mm} mm, {y_mm} mm) lies outside the section")]
    OutsideSection {
        what: &'static str,
        x_mm: f64,
        y_mm: f64,
    },
    /// Two rollers on a face share a place.
    #[error(
        "rollers {first} and {second} stand {distance_mm} mm apart on one face and overlap below \
         {least_mm} mm: move them apart, or make them thinner"
    )]
    RollersOverlap {
        first: usize,
        second: usize,
        distance_mm: f64,
        least_mm: f64,
    },
    /// A roller reaches what a support holds.
    #[error(
        "roller {roller} reaches the particle at ({x_mm} mm, {y_mm} mm), which a support holds \
         across the face: free it, or move the roller"
    )]
    RollerOnSupport { roller: usize, x_mm: f64, y_mm: f64 },
    /// Contact in large displacements.
    #[error(
        "contact with rollers that press along ways of their own, or of a section under a load, is found \
         for small displacements only: choose linear geometry, or forces in place of rollers"
    )]
    LargeContact,
    /// A force that bending in large displacements does not reach.
    #[error(
        "the section slips through between its supports: at a way of the rollers of {advance_mm} mm \
         their force falls, from {largest_n} N, and never reaches {force_n} N; drive the rollers by a \
         way, or make the span shorter"
    )]
    SlipsThrough {
        force_n: f64,
        largest_n: f64,
        advance_mm: f64,
    },
    /// Which particles touch could not be found.
    #[error("no set of particles that touch the rollers was found in {rounds} rounds")]
    NoContact { rounds: u64 },
    /// Round-off spoils a contact.
    #[error(
        "the equilibrium between rollers misses the conditions of contact by {share} of the largest \
         force or displacement: cells differ so much in size or stiffness that round-off decides; \
         use a coarser grid at the rollers"
    )]
    ContactUnsettled { share: f64 },
    /// A face between plies that are to come apart, inside cells.
    #[error(
        "the face at a height of {y_mm} mm, at which plies can come apart, lies inside cells, which would \
         lose the bending of both plies with it: take at least as many rows of cells as plies, and let lines \
         of particles follow their faces"
    )]
    FaceInsideCells { y_mm: f64 },
    /// A cell that stores more energy than the crack in it takes up.
    #[error(
        "the cell at ({x_mm} mm, {y_mm} mm) is {width_mm} mm wide across a crack in material \
         {material} and must be at most {largest_mm} mm, 2 E G / f² of its strength and fracture \
         energy: use a finer grid, or give no fracture energy"
    )]
    CellTooLarge {
        x_mm: f64,
        y_mm: f64,
        /// Its name, or its place in the list.
        material: String,
        width_mm: f64,
        largest_mm: f64,
    },
    /// Forces and displacements both drive the section.
    #[error(
        "forces and prescribed displacements both drive the section: what breaks it grows by one \
         factor; give one of them"
    )]
    MixedDrive,
    /// Nothing drives the section.
    #[error("neither a force nor a prescribed displacement drives the section: give one of them")]
    NoDrive,
    /// A cell would have to be turned inside out to go on.
    #[error(
        "cell ({column}, {row}) at ({x_mm} mm, {y_mm} mm) turns inside out at {load_fraction} of the \
         load, in step {step}: the load is more than the section can carry in this model"
    )]
    Inverted {
        column: usize,
        row: usize,
        x_mm: f64,
        y_mm: f64,
        step: u64,
        load_fraction: f64,
    },
    /// Two round fibres of a unit cell share a place; a fibre may also meet its own image.
    #[error(
        "fibres {first} and {second} of the unit cell overlap by {overlap_mm} mm, images across its \
         edges included: move one, or make the cell larger"
    )]
    RoundFibresOverlap {
        first: usize,
        second: usize,
        overlap_mm: f64,
    },
    /// Random fibres do not find room.
    #[error(
        "{count} fibres with their gaps fill {fraction} of the unit cell and found no places without \
         overlap in {rounds} rounds: lower the fraction or the gap"
    )]
    NoRoom {
        count: usize,
        fraction: f64,
        rounds: u64,
    },
    /// The equations of a unit cell were not solved.
    #[error(
        "the unit cell found no equilibrium in {iterations} iterations: the residual is {residual} \
         of the load; use materials that differ less in stiffness"
    )]
    CellNotConverged { iterations: u64, residual: f64 },
    /// Equilibrium was not found.
    #[error(
        "no equilibrium was found at {load_fraction} of the load: after {iterations} iterations the \
         residual is {residual} of the load; use more load steps, or a smaller load"
    )]
    NotConverged {
        load_fraction: f64,
        iterations: u64,
        residual: f64,
    },
    /// Motion did not come to rest.
    #[error(
        "the particles did not come to rest in {steps} time steps: the residual is {residual:e} of the \
         load; raise step_limit or residual in accuracy, or use the solver static"
    )]
    NotAtRest { steps: u64, residual: f64 },
    /// A given time step is beyond the stable one.
    #[error(
        "the time step {given_s:e} s is beyond the stable step {critical_s:e} s of this lattice: \
         choose a smaller one or none"
    )]
    UnstableTimeStep { given_s: f64, critical_s: f64 },
    /// A kept state is not one of this lattice.
    #[error("the kept state is one of another lattice")]
    OtherSize,
    /// Whoever asked for a result does not want it any more.
    #[error("stopped")]
    Stopped,
    /// A number left the range of finite numbers.
    #[error("{quantity} is not finite in step {step}")]
    NotFinite { quantity: &'static str, step: u64 },
}

/// The quantity must be finite and positive.
pub fn positive(quantity: &'static str, given: f64) -> Result<f64, CompositeError> {
    if given.is_finite() && given > 0.0 {
        Ok(given)
    } else {
        Err(CompositeError::OutOfRange {
            quantity,
            given,
            allowed: "a finite number above 0",
        })
    }
}

/// The quantity must be finite.
pub fn finite(quantity: &'static str, given: f64) -> Result<f64, CompositeError> {
    if given.is_finite() {
        Ok(given)
    } else {
        Err(CompositeError::OutOfRange {
            quantity,
            given,
            allowed: "a finite number",
        })
    }
}
