//! From an easy problem to a hard one.
//!
//! Where compressed bonds have hardly any stiffness, a net at small strains is nearly a mechanism:
//! which bonds are taut changes from iteration to iteration, and Newton's method creeps from kink to
//! kink of the energy for thousands of iterations. A search that takes long starts over on a law
//! whose kinks are rounded off (`RoundedLaw`) and follows the
//! minimum while the rounding shrinks to nothing; on the true law little is left to do. With
//! r_c = 0 at A_cc 1e4 to 1e12, strain 1 %, a net of 2400 degrees of freedom takes 300 iterations
//! this way and was not solved after 1000 without.
use super::{
    Search,
    newton_cg::{Memory, descend},
    work::Meter,
};
use crate::{
    Interrupt,
    network::{
        assembly::Assembly,
        configuration::{Configuration, Residual, Verdict},
    },
};

/// Iterations before a search counts as a long one: nets with stiff compression take some 20.
const PATIENCE: u32 = 60;
/// Iterations on one rounding: more only polish what the next one changes.
const PER_ROUNDING: u32 = 40;
/// First rounding μ: the strains of a net that is just becoming taut.
const WIDEST: f64 = 0.03;
const SHRINKING: f64 = 0.3;
/// Rounding below which strains are not told apart.
const NARROWEST: f64 = 1e-13;
/// How exactly the problem of a rounding is solved, over the force e μ that it blurs.
const LOOSE: f64 = 3e-3;
/// Where the force that is blurred is this part of the limit, the law is the true one.
const TRUE: f64 = 0.02;

/// Moves `here` to equilibrium; `there` and `memory` are memory.
pub(super) fn descend_by_stages(
    search: &Search,
    assembly: &Assembly,
    here: &mut Configuration,
    there: &mut Configuration,
    memory: &mut Memory<f32>,
    meter: &mut Meter<'_>,
) -> Result<Residual, Interrupt> {
    let direct = Search {
        iteration_limit: search.iteration_limit.min(PATIENCE),
        ..*search
    };
    let residual = descend(&direct, assembly, here, there, memory, meter)?;
    if residual.verdict != Verdict::Unbalanced || search.iteration_limit <= PATIENCE {
        return Ok(residual);
    }
    let mut rounded = assembly.clone();
    let modulus = rounded.laws.largest_modulus();
    let mut rounding = WIDEST;
    while rounding > NARROWEST && rounding * modulus > TRUE * search.force_limit {
        rounded.rounding = Some(rounding);
        here.update(&rounded);
        let stage = Search {
            iteration_limit: PER_ROUNDING,
            force_limit: search.force_limit.max(LOOSE * rounding * modulus),
            ..*search
        };
        descend(&stage, &rounded, here, there, memory, meter)?;
        rounding *= SHRINKING;
    }
    here.update(assembly);
    descend(search, assembly, here, there, memory, meter)
}
