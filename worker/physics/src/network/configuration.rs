//! A network at some displacements: energy, tensions, resultants, stiffness.
use crate::{parallel::Team, wide::wide};

use super::{
    Laws,
    assembly::{Assembly, BondState, NO_LENGTH},
    blocks::{BLOCK, Buffer, Sums},
    field::{self, Field, Real, sum},
    law::StrainLaw,
    rounded::RoundedLaw,
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
    /// Sum of the bond forces on every node [N], held ones included.
    pub(crate) resultants: Field<f64>,
    pub(crate) stiffness: Stiffness<T>,
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
            stiffness: Stiffness::zeros(slots, dimensions),
            spill: Spill::new(&assembly.strips, dimensions),
        };
        configuration.update(assembly, team);
        configuration
    }

    /// Makes everything follow the displacements, (4)-(7).
    pub(crate) fn update(&mut self, assembly: &Assembly, team: &Team) {
        match (&assembly.laws, assembly.dimensions(), assembly.rounding) {
            (&Laws::Same(law), 2, None) => self.update_in::<2, _>(assembly, team, move |_| law),
            (&Laws::Same(law), _, None) => self.update_in::<3, _>(assembly, team, move |_| law),
            (Laws::Each(laws), 2, None) => {
                self.update_in::<2, _>(assembly, team, move |bond| laws[bond]);
            }
            (Laws::Each(laws), _, None) => {
                self.update_in::<3, _>(assembly, team, move |bond| laws[bond]);
            }
            (laws, 2, Some(rounding)) => {
                self.update_in::<2, _>(assembly, team, RoundedLaw::each(laws, rounding));
            }
            (laws, _, Some(rounding)) => {
                self.update_in::<3, _>(assembly, team, RoundedLaw::each(laws, rounding));
            }
        }
    }

    fn update_in<const D: usize, L: StrainLaw>(
        &mut self,
        assembly: &Assembly,
        team: &Team,
        law: impl Fn(usize) -> L + Copy + Sync + Send,
    ) {
        let displacements = self.displacements.components();
        let outputs = (
            InSlots([self.tensions.as_mut_slice()]),
            (
                InSlots([self.stiffness.transverse.as_mut_slice()]),
                InSlots(self.stiffness.axial.each_mut().map(Vec::as_mut_slice)),
            ),
        );
        self.energy = self.spill.sum(
            &assembly.strips,
            team,
            self.resultants.components_mut(),
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

    /// The state of the bond in a slot.
    pub(crate) fn bond(&self, assembly: &Assembly, slot: usize) -> BondState {
        let [first, second] =
            assembly.ends[slot].map(|place| self.displacements.at(place as usize));
        assembly.respond(slot, &first, &second)
    }

    /// The largest resultant, and whether `force_limit` [N] or round-off bounds all of them.
    pub(crate) fn residual(&self, assembly: &Assembly, force_limit: f64) -> Residual {
        let (mut largest, mut node) = (0.0, assembly.free().start);
        self.see_squares(
            assembly,
            #[inline(always)]
            |start, squares| {
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

/// What is known of the bonds from a slot on.
struct Bonds<'a, T> {
    first: usize,
    tensions: &'a mut [f64],
    transverse: &'a mut [T],
    axial: [&'a mut [T]; 3],
}

/// Lets the bonds of a strip follow the displacements; returns their energy.
#[inline(always)]
fn respond<const D: usize, T: Real, L: StrainLaw>(
    assembly: &Assembly,
    strip: &Strip,
    displacements: [&[f64]; 3],
    law: impl Fn(usize) -> L,
    bonds: &mut Bonds<'_, T>,
    resultants: &mut Sums<'_, f64, 3>,
) -> f64 {
    let positions = assembly.positions.components();
    let mut forces: Buffer<f64> = [[0.0; BLOCK]; 3];
    let mut place_scratch = [forces; 2];
    let mut move_scratch = [forces; 2];
    let mut energies = [0.0; BLOCK];
    let no_excess = [0.0; BLOCK];
    let mut energy = 0.0;
    for block in &assembly.blocks[strip.blocks.clone()] {
        let (start, count) = (block.start, block.count);
        let [first, second] =
            block.at_ends::<f64, D>(&assembly.ends, &positions, &mut place_scratch);
        let [moved_first, moved_second] =
            block.at_ends::<f64, D>(&assembly.ends, &displacements, &mut move_scratch);
        let rest_lengths = &assembly.rest_lengths[start..][..count];
        let acts = &assembly.acts[start..][..count];
        let excess = assembly.excess.get(start..start + count);
        let excess = &excess.unwrap_or(&no_excess)[..count];
        let own = start - bonds.first;
        let tensions = &mut bonds.tensions[own..][..count];
        let transverse = &mut bonds.transverse[own..][..count];
        let [ax, ay, az] = bonds.axial.each_mut().map(
            #[inline(always)]
            |axial| axial.get_mut(own..own + count).unwrap_or_default(),
        );
        let [fx, fy, fz] = forces.each_mut().map(
            #[inline(always)]
            |forces| &mut forces[..count],
        );
        let energies = &mut energies[..count];
        for bond in 0..count {
            // from the second end to the first
            let x = first[0][bond] - second[0][bond];
            let y = first[1][bond] - second[1][bond];
            let wx = moved_first[0][bond] - moved_second[0][bond];
            let wy = moved_first[1][bond] - moved_second[1][bond];
            let (mut z, mut wz) = (0.0, 0.0);
            if D == 3 {
                z = first[2][bond] - second[2][bond];
                wz = moved_first[2][bond] - moved_second[2][bond];
            }
            let (px, py, pz) = (x + wx, y + wy, z + wz);
            let mut square = px * px + py * py;
            let mut elongation = wx * (x + px) + wy * (y + py);
            if D == 3 {
                square += pz * pz;
                elongation += wz * (z + pz);
            }
            let rest = rest_lengths[bond];
            let act = f64::from(acts[bond]);
            let length = square.sqrt();
            let strain = (elongation + excess[bond]) / ((length + rest) * rest);
            let law = law(start + bond);
            let tension = act * law.tension(strain);
            let inverse = if length > NO_LENGTH * rest {
                1.0 / length
            } else {
                0.0
            };
            energies[bond] = act * rest * law.energy(strain);
            tensions[bond] = tension;
            transverse[bond] = T::new(tension * inverse);
            let root = T::new(act * law.axial_excess(strain) * inverse).sqrt();
            ax[bond] = T::new(px * inverse) * root;
            ay[bond] = T::new(py * inverse) * root;
            // the first end is pulled towards the second
            let pull = -tension * inverse;
            fx[bond] = px * pull;
            fy[bond] = py * pull;
            if D == 3 {
                az[bond] = T::new(pz * inverse) * root;
                fz[bond] = pz * pull;
            }
        }
        energy += sum(energies);
        block.scatter::<f64, D>(&assembly.ends, &forces, resultants);
    }
    energy
}

impl BondState {
    /// Error of the bond's force by rounding [N], its ends having moved by `moved` [mm] together.
    pub(crate) fn round_off(&self, moved: f64) -> f64 {
        let stiffness = self.axial.max(self.transverse.abs());
        ROUNDINGS * f64::EPSILON * (self.tension.abs() + stiffness * moved)
    }
}
