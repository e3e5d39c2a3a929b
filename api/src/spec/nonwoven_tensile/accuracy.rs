//! How exactly equilibrium is solved, and breaks are found.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Preset};

/// How exactly equilibrium is solved: a preset's name or its knobs.
pub type Accuracy = accuracy::Accuracy<Knobs>;

/// The knobs of accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Knobs {
    pub solver: Solver,
    /// A_cc: equilibrium is reached when every free node's resultant is below
    /// (e ε + f_r ε²)/A_cc at nominal strain ε ([Zilka2022] eq. 3-4).
    #[schemars(range(min = 1.0, max = 1e15), extend("x-unit" = "1"))]
    pub force_accuracy: f64,
    /// Sweeps (relaxations) or Newton iterations (`newton_cg`) allowed per equilibrium; a step that
    /// needs more is reported as unconverged. Left out: 100 000 sweeps, 1 000 Newton iterations.
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub iteration_limit: Option<u32>,
    /// ω, the part of its Newton step a node moves in parallel relaxation.
    #[schemars(range(min = 0.01, max = 1.0), extend("x-unit" = "1"))]
    pub relaxation_factor: f64,
    /// A strain step is divided until no bond whose breaking lowers the force by more than this part of
    /// the maximum breaks at more than this part above its strength; the first bond that breaks is
    /// found as well. `null`: bonds break at whole strain steps only, as in [Zilka2022], and a maximum
    /// between two of them is not seen.
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    pub break_precision: Option<f64>,
    /// Farthest a node may move at once on the way to equilibrium, in mean rest lengths of bonds. A node
    /// thrown farther passes through its neighbours. Left out, 2: about two row spacings.
    #[schemars(range(min = 1e-3, max = 1e3), extend("x-unit" = "1"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_move: Option<f64>,
    /// The gradient that `gradient_descent` and `barzilai_borwein` follow.
    #[serde(skip_serializing_if = "DescentGradient::is_exact")]
    pub descent_gradient: DescentGradient,
    /// α, by which they multiply it: of every move, or of the first move of each node. Left out, the
    /// force limit over the squared stiffness of the node, the longest step that ends within the limit.
    #[schemars(range(min = 1e-12, max = 1e12), extend("x-unit" = "mm2/N"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub descent_step_mm2_per_n: Option<f64>,
    /// Distance of the 5 x 5 x 5 values that `"descent_gradient": "smoothed"` goes by, in mean rest
    /// lengths of bonds. [Zilka2022] gives none: far enough apart to smooth, and not so far that the
    /// minimum moves.
    #[schemars(range(min = 1e-6, max = 1.0), extend("x-unit" = "1"))]
    #[serde(skip_serializing_if = "is_usual_spacing")]
    pub smoothing_spacing: f64,
}

/// Values that smooth the resultant stand so far apart where the spec does not say.
const SMOOTHING_SPACING: f64 = 0.02;

#[allow(
    clippy::float_cmp,
    clippy::trivially_copy_pass_by_ref,
    reason = "what serde asks for: the same number"
)]
fn is_usual_spacing(spacing: &f64) -> bool {
    *spacing == SMOOTHING_SPACING
}

/// The way to equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Descends the energy of the whole network; reaches the tolerance at every step.
    #[default]
    NewtonCg,
    /// The thesis' relaxation, node after node.
    Sequential,
    /// The thesis' relaxation with all displacements computed before any node moves.
    Parallel,
    /// Node after node against the gradient of the magnitude of its resultant, by a fixed step; the
    /// thesis tried it. Slow, and seldom in balance: left out, `iteration_limit` is 1 000 sweeps.
    GradientDescent,
    /// The same by the steps of Barzilai and Borwein.
    BarzilaiBorwein,
}

/// The gradient of the magnitude F_b of a node's resultant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DescentGradient {
    /// That of F_b, [Zilka2022] eq. 7.
    #[default]
    Exact,
    /// The sum of the gradients of the bonds' forces, as [Zilka2022] prints it in eq. 10-12. That is the
    /// gradient of another function, which has its minimum elsewhere: no test comes to balance by it.
    AsPrinted,
    /// That of a cubic spline through values of F_b around the node, [Zilka2022] section 2.3.3.
    Smoothed,
}

impl DescentGradient {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "what serde asks for")]
    fn is_exact(&self) -> bool {
        *self == Self::Exact
    }
}

impl Default for Knobs {
    fn default() -> Self {
        accuracy::Knobs::of(Preset::default())
    }
}

impl accuracy::Knobs for Knobs {
    const ABOUT: &'static str = "How exactly equilibrium is solved: a preset's name or its knobs.";
    const PRESETS: &'static str = "Named choices of the knobs; their measured error and cost are in the guide, under \"Speed against accuracy\".";

    fn of(preset: Preset) -> Self {
        let (force_accuracy, break_precision) = match preset {
            Preset::Draft => (5.0, 0.05),
            Preset::Standard => (100.0, 0.01),
            Preset::Reference => (1e4, 0.002),
        };
        Self {
            solver: Solver::default(),
            force_accuracy,
            iteration_limit: None,
            relaxation_factor: 0.6,
            break_precision: Some(break_precision),
            largest_move: None,
            descent_gradient: DescentGradient::default(),
            descent_step_mm2_per_n: None,
            smoothing_spacing: SMOOTHING_SPACING,
        }
    }
}
