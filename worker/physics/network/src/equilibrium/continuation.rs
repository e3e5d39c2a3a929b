//! From an easy problem to a hard one.
//!
//! Where compressed bonds have hardly any stiffness, a net at small strains is nearly a mechanism:
//! which bonds are taut changes from iteration to iteration, and Newton's method creeps from kink to
//! kink of the energy for thousands of iterations. A search that takes long goes on by way of laws
//! whose kinks are rounded off (`RoundedLaw`) less and less, and follows the minimum from one to the
//! next.
//!
//! The way is to be followed closely: slack parts keep a shape that little forces determine, and one
//! lost on a rounding is hardly found again on the next. With roundings that shrink to 0.3 of
//! themselves at once, some steps of nets with r_c/e of 2.5e-6 stay unbalanced at A_cc 1e4 even after
//! thousands of iterations, as they do by way of compression stiffnesses that fall from near e; so
//! closely the first five steps take 4200 there, and 5900 at A_cc 1e6.
use loadframe_harness::Interrupt;
use loadframe_numerics::Team;

use super::{
    Search, Settled,
    newton_cg::{Memory, descend},
    work::Meter,
    workspace::Workspace,
};
use crate::{
    Vector,
    assembly::Assembly,
    configuration::{Configuration, Residual, Verdict},
};

/// Iterations before a search counts as a long one: nets with stiff compression take some 20.
const PATIENCE: u32 = 60;
/// Compression stiffness over e from which on kinks are not what takes long.
const STIFF: f64 = 0.3;
/// Iterations on one rounding.
const PER_ROUNDING: u32 = 200;
/// First rounding μ: the strains of a net that is just becoming taut.
const WIDEST: f64 = 0.03;
const SHRINKING: f64 = 0.6;
/// Rounding below which strains are not told apart.
const NARROWEST: f64 = 1e-13;
/// How exactly the problem of a rounding is solved, over the force e μ that it blurs.
const LOOSE: f64 = 1e-3;
/// A force that is this part of the limit does not count.
const NOTHING: f64 = 0.02;

/// See [`Search::run`].
pub(super) fn solve(
    search: &Search,
    assembly: &Assembly,
    displacements: &[Vector],
    team: &Team,
    workspace: &mut Workspace,
    meter: &mut Meter<'_>,
) -> Result<Settled, Interrupt> {
    let start = workspace.start.take();
    let mut here = start.unwrap_or_else(|| workspace.configuration(assembly, displacements, team));
    // every step sets all of it
    let mut there = workspace.spare.pop().unwrap_or_else(|| here.clone());
    let memory = workspace.memory.take();
    let mut single = memory.unwrap_or_else(|| Memory::new(assembly));
    let (from, to) = (&mut here, &mut there);
    let settled = descend_by_stages(search, assembly, from, to, &mut single, team, meter);
    workspace.memory = Some(single);
    workspace.spare.push(there);
    let residual = settled?;
    Ok(Settled {
        configuration: here,
        residual,
    })
}

/// Moves `here` to equilibrium; `there` and `memory` are memory.
fn descend_by_stages(
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
    let laws = &assembly.laws;
    if laws.most(|law| STIFF * law.modulus - law.compression_stiffness) <= 0.0 {
        return descend(search, assembly, here, there, memory, team, meter);
    }
    let modulus = laws.most(|law| law.modulus);
    let mut easier = assembly.clone();
    let mut rounding = WIDEST;
    while rounding > NARROWEST && rounding * modulus > NOTHING * search.force_limit {
        easier.rounding = Some(rounding);
        here.update(&easier, team);
        let stage = Search {
            iteration_limit: search.iteration_limit.min(PER_ROUNDING),
            force_limit: search.force_limit.max(LOOSE * rounding * modulus),
            ..*search
        };
        descend(&stage, &easier, here, there, memory, team, meter)?;
        rounding *= SHRINKING;
    }
    here.update(assembly, team);
    descend(search, assembly, here, there, memory, team, meter)
}
