//! Linear equations over the free displacements: factors while they fit, else conjugate gradients.
use loadframe_api::section::solving;
use loadframe_numerics::NoFactor;

use crate::error::CompositeError;
use crate::matrix::GridMatrix;
use crate::section::Grid;
use crate::solve::direct::Direct;
use crate::solve::multigrid::{COARSEST, Multigrid};
use crate::supports::Supports;

/// How linear equations are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Factors while grids are small or their cells stretched, else conjugate gradients ([`solving`]).
    #[default]
    Automatic,
    /// Sparse Cholesky factors.
    Direct,
    /// Conjugate gradients preconditioned by a multigrid cycle.
    ConjugateGradients,
}

/// Equations of one pattern, ready to be solved for many right-hand sides.
#[derive(Debug)]
pub(crate) enum Equations {
    Factored(Box<Direct>),
    Iterated(Box<Multigrid>),
}

/// What is asked of conjugate gradients for one right-hand side; equilibrium refines further.
const ITERATED_TOLERANCE: f64 = 1e-11;

/// The residual at which no motion is left unknown: of 10⁶ displacements each has about 10⁻³ of the right-hand
/// side.
const STABLE_TOLERANCE: f64 = 1e-6;

/// Numbers between -½ and ½ without order, the same every time: SplitMix64 [SteeleLeaFlood2014] of the places.
fn scattered(size: usize) -> Vec<f64> {
    let of = |place: u64| {
        let mut bits = place.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..size as u64).map(of).collect()
}

impl Equations {
    pub(crate) fn new(
        method: Method,
        matrix: &GridMatrix,
        grid: &Grid,
        supports: &Supports,
    ) -> Result<Self, NoFactor> {
        let factored = match method {
            Method::Automatic => {
                let stretch = solving::stretch([grid.x_mm(), grid.y_mm()]);
                solving::is_factored(grid.particles() as u64, stretch)
            }
            Method::Direct => true,
            Method::ConjugateGradients => false,
        };
        if factored {
            Ok(Self::Factored(Box::new(Direct::new(matrix, supports)?)))
        } else {
            Ok(Self::Iterated(Box::new(Multigrid::new(
                grid, supports, COARSEST,
            )?)))
        }
    }

    pub(crate) fn prepare(&mut self, matrix: &GridMatrix) -> Result<(), NoFactor> {
        match self {
            Self::Factored(direct) => direct.factor(matrix),
            Self::Iterated(multigrid) => multigrid.prepare(matrix),
        }
    }

    /// Whether the matrix that was prepared is positive definite, over the free displacements.
    ///
    /// A factor has told already. Of conjugate gradients only a coarser grid's matrix was factored, so that
    /// they are let go from a right-hand side with a part in every motion: the residual of a motion of negative
    /// stiffness does not fall before the iterations know its stiffness, by Lanczos' process, and then a
    /// direction curves down.
    ///
    /// # Source
    ///
    /// [HestenesStiefel1952]; that conjugate gradients are Lanczos' process: [GolubVanLoan2013], chapter 11.
    pub(crate) fn is_positive(&mut self, matrix: &GridMatrix) -> bool {
        match self {
            Self::Factored(_) => true,
            Self::Iterated(multigrid) => {
                let size = 2 * matrix.particles();
                let mut solution = vec![0.0; size];
                multigrid.converges(matrix, &scattered(size), &mut solution, STABLE_TOLERANCE)
            }
        }
    }

    /// Solves; the number of iterations it took, 0 for factors.
    pub(crate) fn solve(
        &mut self,
        matrix: &GridMatrix,
        right: &[f64],
        solution: &mut [f64],
    ) -> Result<u64, NoFactor> {
        match self {
            Self::Factored(direct) => {
                direct.solve(right, solution);
                Ok(0)
            }
            Self::Iterated(multigrid) => {
                multigrid.solve(matrix, right, solution, ITERATED_TOLERANCE)
            }
        }
    }
}

/// What to tell of a lattice on this grid that should have had a factor.
pub(crate) fn told(failure: NoFactor, grid: &Grid) -> CompositeError {
    match failure {
        NoFactor::Indefinite { unknown } => {
            let [x_mm, y_mm] = grid.place_mm(unknown / 2);
            CompositeError::Mechanism { x_mm, y_mm }
        }
        NoFactor::TooLarge => CompositeError::TooLarge {
            particles: grid.particles(),
        },
    }
}
