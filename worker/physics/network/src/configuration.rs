//! A network at some displacements: energy, tensions, resultants, stiffness.

use loadframe_numerics::{Team, wide};

use super::{
    Vector,
    assembly::{Assembly, BondState},
    field::{self, BLOCK, Field, Real},
    law::StrainLaw,
    response::{Bonds, WithLaws, energy, respond, with_laws},
    stiffness::Stiffness,
    strips::{InSlots, Spill, Strip, again},
};

/// What follows from the displacements of a network's nodes; `T` is the precision of the
/// stiffness, which only points the way.
#[derive(Clone, Debug)]
pub(crate) struct Configuration<T = f32> {
    /// Of every node [mm]; those of held nodes are given.
    pub(crate) displacements: Field<f64>,
    /// E [N mm].
    pub(crate) energy: f64,
    /// T of the bond in each slot [N], zero where it does not act.
    pub(crate) tensions: Vec<f64>,
    /// Sum of the bond forces on every node [N], fixed ones included; of guided ones without what their
    /// guides take.
    pub(crate) resultants: Field<f64>,
    /// What each of [`Assembly::guided`] takes [N], 0 along the axes in which it is free.
    pub(crate) held_back: Vec<Vector>,
    pub(crate) stiffness: Stiffness<T>,
    /// Whether energy and resultants were changed by differences since they were summed: what
    /// rounding leaves of them depends on the way then.
    pub(crate) is_patched: bool,
    spill: Spill<f64, 3>,
}

/// Roundings that separate a computed resultant from the exact one, in units of the machine
/// precision times the sum of what was rounded: about two for each bond's displacements, two for
/// its force, one for the sum.
const ROUNDINGS: f64 = 8.0;

/// How far a network is from equilibrium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    /// Largest resultant of a free node [N].
    pub(crate) largest: f64,
    /// The free node it acts on.
    pub(crate) node: usize,
    /// Root mean square of the resultants of the free nodes [N].
    pub(crate) mean: f64,
    pub(crate) verdict: Verdict,
}

/// What a [`Residual`] means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Every resultant is within the limit.
    Balanced,
    /// Some exceed the limit, but only by what rounding alone explains: no arithmetic of this
    /// precision gets closer.
    RoundOff,
    Unbalanced,
}

impl<T: Real> Configuration<T> {
    /// The network at `displacements`.
    pub(crate) fn new(assembly: &Assembly, displacements: Field<f64>, team: &Team) -> Self {
        let slots = assembly.ends.len();
        let dimensions = assembly.dimensions();
        let mut configuration = Self {
            displacements,
            energy: 0.0,
            tensions: vec![0.0; slots],
            resultants: Field::zeros(assembly.places(), dimensions),
            held_back: vec![Vector::zeros(); assembly.guided().len()],
            stiffness: Stiffness::zeros(slots, dimensions),
            is_patched: false,
            spill: Spill::new(&assembly.strips, dimensions),
        };
        configuration.update(assembly, team);
        configuration
    }

    /// The network with these displacements of its nodes.
    pub(crate) fn of(assembly: &Assembly, displacements: &[Vector], team: &Team) -> Self {
        let displacements = assembly.pick(displacements);
        Self::new(
            assembly,
            Field::of(&displacements, assembly.dimensions()),
            team,
        )
    }

    /// Makes everything follow the displacements, (4)-(7).
    pub(crate) fn update(&mut self, assembly: &Assembly, team: &Team) {
        with_laws(assembly, Update(self, team));
        self.held_back.fill(Vector::zeros());
        self.hold_back(assembly);
        self.is_patched = false;
    }

    /// Moves what resultants have along axes in which guides hold their nodes to what these take.
    pub(crate) fn hold_back(&mut self, assembly: &Assembly) {
        let resultants = self.resultants.components_mut();
        for (axis, sums) in resultants
            .into_iter()
            .enumerate()
            .filter(|(_, sums)| !sums.is_empty())
        {
            for ((place, held), taken) in assembly.guided().iter().zip(&mut self.held_back) {
                if held[axis] {
                    taken[axis] += std::mem::take(&mut sums[*place as usize]);
                }
            }
        }
    }

    /// Forces of the loaded bonds on each set [N], along the axes that it holds: the negative of its
    /// reaction. Sums in the order of places.
    pub(crate) fn forces_on_sets(&self, assembly: &Assembly) -> Vec<Vector> {
        let force = |place: &u32| {
            let place = *place as usize;
            match assembly.guide_at(place) {
                Some(guide) => self.held_back[guide],
                None => self.resultants.at(place),
            }
        };
        let of_set = |places: &Vec<u32>| {
            Vector::from_fn(|axis, _| places.iter().map(|place| force(place)[axis]).sum())
        };
        assembly.sets().iter().map(of_set).collect()
    }

    /// Leaves out the bonds that acted and act no more: much less work than to update everything.
    pub(crate) fn let_go(&mut self, assembly: &Assembly) {
        for slot in (0..assembly.ends.len()).filter(|slot| !assembly.acts(*slot)) {
            let tension = std::mem::take(&mut self.tensions[slot]);
            if tension != 0.0 {
                let ends = assembly.ends[slot].map(|place| place as usize);
                let [first, second] = ends.map(|place| self.displacements.at(place));
                let bond = assembly.respond_intact(slot, &first, &second);
                self.energy -= bond.energy;
                let pull = tension * bond.direction;
                let sums = self.resultants.components_mut().into_iter().zip(&pull);
                for (sums, pull) in sums.filter(|(sums, _)| !sums.is_empty()) {
                    sums[ends[0]] -= pull;
                    sums[ends[1]] += pull;
                }
            }
            self.stiffness.clear(slot);
        }
        self.hold_back(assembly);
        self.is_patched = true;
    }

    /// The state of the bond in a slot.
    pub(crate) fn bond(&self, assembly: &Assembly, slot: usize) -> BondState {
        let [first, second] =
            assembly.ends[slot].map(|place| self.displacements.at(place as usize));
        assembly.respond(slot, &first, &second)
    }

    /// The largest resultant, and whether `force_limit` [N] or round-off bounds all of them.
    pub(crate) fn residual(&self, assembly: &Assembly, force_limit: f64) -> Residual {
        let (mut largest, mut node) = (0.0, assembly.free().start);
        let mut total = 0.0;
        self.see_squares(
            assembly,
            #[inline(always)]
            |start, squares| {
                total += field::sum(squares);
                // most blocks have none that is larger
                if field::largest(squares) <= largest && !squares.iter().any(|s| s.is_nan()) {
                    return;
                }
                for (index, square) in squares.iter().enumerate() {
                    // a NaN must not pass for a balanced node
                    if *square > largest || square.is_nan() {
                        (largest, node) = (*square, start + index);
                    }
                }
            },
        );
        let largest = largest.sqrt();
        let verdict = if largest <= force_limit {
            Verdict::Balanced
        } else if self.is_within_round_off(assembly, force_limit, node) {
            Verdict::RoundOff
        } else {
            Verdict::Unbalanced
        };
        Residual {
            largest,
            node,
            mean: (total / assembly.free().len() as f64).sqrt(),
            verdict,
        }
    }

    /// Adds the free nodes whose resultant exceeds `force` [N] to `nodes`, ascending.
    pub(crate) fn list_beyond(&self, assembly: &Assembly, force: f64, nodes: &mut Vec<u32>) {
        self.see_squares(
            assembly,
            #[inline(always)]
            |start, squares| {
                if field::largest(squares) <= force * force {
                    return;
                }
                let beyond = (start..).zip(squares);
                let beyond = beyond.filter(|(_, square)| **square > force * force);
                nodes.extend(beyond.map(|(node, _)| node as u32));
            },
        );
    }

    /// Shows the squares of the free nodes' resultants, some at a time, with the place of the first.
    #[inline(always)]
    fn see_squares(&self, assembly: &Assembly, mut see: impl FnMut(usize, &[f64])) {
        let free = assembly.free();
        wide(
            #[inline(always)]
            || {
                let mut squares = [0.0; BLOCK];
                for start in free.clone().step_by(BLOCK) {
                    let squares = &mut squares[..BLOCK.min(free.end - start)];
                    self.resultants.squares(start, squares);
                    see(start, squares);
                }
            },
        );
    }

    /// Whether every resultant beyond the limit, the one of node `worst` above all, is within the
    /// rounding error of its bonds.
    fn is_within_round_off(&self, assembly: &Assembly, force_limit: f64, worst: usize) -> bool {
        let is_beyond = |node: usize| {
            let resultant = self.resultants.at(node).norm();
            if resultant <= force_limit {
                return false;
            }
            let bonds = assembly.incidence().of(node).iter();
            let rounding: f64 = bonds
                .map(|slot| self.round_off(assembly, *slot as usize))
                .sum();
            resultant > rounding || resultant.is_nan()
        };
        // far from equilibrium the worst node alone answers, at little cost
        !is_beyond(worst) && !assembly.free().any(is_beyond)
    }

    fn round_off(&self, assembly: &Assembly, slot: usize) -> f64 {
        let [first, second] =
            assembly.ends[slot].map(|place| self.displacements.at(place as usize));
        let state = assembly.respond(slot, &first, &second);
        state.round_off(first.amax() + second.amax())
    }
}

/// Lets a configuration follow its displacements.
struct Update<'a, T>(&'a mut Configuration<T>, &'a Team);

impl<T: Real> WithLaws for Update<'_, T> {
    type Output = ();

    fn run<const D: usize, L: StrainLaw>(
        self,
        assembly: &Assembly,
        law: impl Fn(usize) -> L + Copy + Sync + Send,
    ) {
        let Self(configuration, team) = self;
        let displacements = configuration.displacements.components();
        let stiffness = &mut configuration.stiffness;
        let outputs = (
            InSlots([configuration.tensions.as_mut_slice()]),
            (
                InSlots([stiffness.transverse.as_mut_slice()]),
                InSlots(stiffness.axial.each_mut().map(Vec::as_mut_slice)),
            ),
        );
        configuration.energy = configuration.spill.sum(
            &assembly.strips,
            team,
            configuration.resultants.components_mut(),
            outputs,
            |strip, (InSlots([tensions]), (InSlots([transverse]), InSlots(axial))), resultants| {
                let mut bonds = Bonds {
                    first: strip.first_slot,
                    tensions,
                    transverse,
                    axial: again(axial),
                };
                wide(
                    #[inline(always)]
                    || {
                        respond::<D, T, L>(
                            assembly,
                            &strip,
                            displacements,
                            law,
                            &mut bonds,
                            resultants,
                        )
                    },
                )
            },
        );
    }
}

/// Finds the energy at displacements, and nothing else.
struct Energy<'a>(&'a Field<f64>, &'a Team);

impl WithLaws for Energy<'_> {
    type Output = f64;

    fn run<const D: usize, L: StrainLaw>(
        self,
        assembly: &Assembly,
        law: impl Fn(usize) -> L + Copy + Sync + Send,
    ) -> f64 {
        let Self(displacements, team) = self;
        let displacements = displacements.components();
        let of = |strip: &Strip| {
            wide(
                #[inline(always)]
                || energy::<D, L>(assembly, strip, displacements, law),
            )
        };
        let strips = &assembly.strips;
        of(&strips.left_over()) + strips.sum(team, (), |strip, ()| of(&strip))
    }
}

/// E of a network at displacements [N mm], and nothing else that follows from them.
pub(crate) fn energy_at(assembly: &Assembly, displacements: &Field<f64>, team: &Team) -> f64 {
    with_laws(assembly, Energy(displacements, team))
}

impl BondState {
    /// Error of the bond's force by rounding [N], its ends having moved by `moved` [mm] together.
    pub(crate) fn round_off(&self, moved: f64) -> f64 {
        let stiffness = self.axial.max(self.transverse.abs());
        ROUNDINGS * f64::EPSILON * (self.tension.abs() + stiffness * moved)
    }
}
