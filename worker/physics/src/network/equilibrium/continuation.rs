//! From an easy problem to a hard one.
//!
//! Where compressed bonds have hardly any stiffness, a net at small strains is nearly a mechanism:
//! which bonds are taut changes from iteration to iteration, and Newton's method creeps from kink to
//! kink of the energy for thousands of iterations. A search that takes long goes on by way of laws
//! that are easier, and follows the minimum from one to the next:
//!
//! - Where compression counts, on laws whose compression stiffness r_c falls from near e to its own
//!   value ([`stiffened`]). Slack parts then keep a shape that little forces determine, and that
//!   changes little from law to law; coming from r_c = 0, where any shape will do, they have none.
//!   With r_c/e = 1e-5 and A_cc 480, strain 0.4 %, a net of 8000 degrees of freedom takes 370
//!   iterations; it was not solved after 1000 without.
//! - Where the limit leaves nothing of compression, on laws whose kinks are rounded off
//!   (`RoundedLaw`) less and less. With r_c = 0 at A_cc 1e4 to 1e12, strain 1 %, a net of 2400
//!   degrees of freedom takes 300 iterations; it was not solved after 1000 without.
use super::{
    Search,
    newton_cg::{Memory, descend},
    work::Meter,
};
use crate::{
    Interrupt,
    network::{
        Laws,
        assembly::Assembly,
        configuration::{Configuration, Residual, Verdict},
        law::BondLaw,
    },
    parallel::Team,
};

/// Iterations before a search counts as a long one: nets with stiff compression take some 20.
const PATIENCE: u32 = 60;
/// Compression stiffness over e to begin with, and from law to law.
const STIFFEST: f64 = 0.3;
const SOFTENING: f64 = 0.3;
/// Iterations on one stiffened law; a shape lost on one is not found again on the next.
const PER_SOFTENING: u32 = 100;
/// How far the residual falls on one stiffened law.
const FALL: f64 = 1e-2;
/// Iterations on one rounding: more only polish what the next one changes.
const PER_ROUNDING: u32 = 40;
/// First rounding μ: the strains of a net that is just becoming taut.
const WIDEST: f64 = 0.03;
const SHRINKING: f64 = 0.3;
/// Rounding below which strains are not told apart.
const NARROWEST: f64 = 1e-13;
/// How exactly the problem of a rounding is solved, over the force e μ that it blurs.
const LOOSE: f64 = 3e-3;
/// A force that is this part of the limit does not count.
const NOTHING: f64 = 0.02;

/// Moves `here` to equilibrium; `there` and `memory` are memory.
pub(super) fn descend_by_stages(
    search: &Search,
    assembly: &Assembly,
    here: &mut Configuration,
    there: &mut Configuration,
    memory: &mut Memory<f32>,
    team: &Team,
    meter: &mut Meter<'_>,
) -> Result<Residual, Interrupt> {
    let direct = Search {
        iteration_limit: search.iteration_limit.min(PATIENCE),
        ..*search
    };
    let residual = descend(&direct, assembly, here, there, memory, team, meter)?;
    if residual.verdict != Verdict::Unbalanced || search.iteration_limit <= PATIENCE {
        return Ok(residual);
    }
    let mut easier = assembly.clone();
    let nothing = NOTHING * search.force_limit;
    // r_c is the compression of a bond pressed to no length
    if assembly.laws.most(|law| law.compression_stiffness) > nothing {
        let mut share = STIFFEST;
        while let Some(laws) = stiffened(&assembly.laws, share) {
            easier.laws = laws;
            here.update(&easier, team);
            let start = here.residual(&easier, search.force_limit);
            let stage = Search {
                iteration_limit: PER_SOFTENING,
                force_limit: search.force_limit.max(FALL * start.largest),
                ..*search
            };
            descend(&stage, &easier, here, there, memory, team, meter)?;
            share *= SOFTENING;
        }
    } else {
        let modulus = assembly.laws.most(|law| law.modulus);
        let mut rounding = WIDEST;
        while rounding > NARROWEST && rounding * modulus > nothing {
            easier.rounding = Some(rounding);
            here.update(&easier, team);
            let stage = Search {
                iteration_limit: PER_ROUNDING,
                force_limit: search.force_limit.max(LOOSE * rounding * modulus),
                ..*search
            };
            descend(&stage, &easier, here, there, memory, team, meter)?;
            rounding *= SHRINKING;
        }
    }
    here.update(assembly, team);
    descend(search, assembly, here, there, memory, team, meter)
}

/// The laws with a compression stiffness of at least this share of e; `None` when all have it.
fn stiffened(laws: &Laws, share: f64) -> Option<Laws> {
    let mut is_any = false;
    let laws = laws.map(|law| {
        let least = share * law.modulus;
        is_any |= law.compression_stiffness < least && law.compression_stiffness > 0.0;
        BondLaw {
            compression_stiffness: law.compression_stiffness.max(least),
            ..law
        }
    });
    is_any.then_some(laws)
}
