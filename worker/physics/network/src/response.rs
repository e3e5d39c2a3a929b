//! The kernels that let bonds follow the displacements of their ends, (4)-(7).
use super::{
    Laws,
    assembly::{Assembly, NO_LENGTH},
    blocks::{Block, Buffer},
    field::{BLOCK, Real, sum},
    law::StrainLaw,
    rounded::RoundedLaw,
    strips::Strip,
    sums::Sums,
};

/// Work that depends on the law of each bond and on the number of dimensions.
pub(crate) trait WithLaws {
    type Output;

    /// `law` gives the law of the bond in a slot.
    fn run<const D: usize, L: StrainLaw>(
        self,
        assembly: &Assembly,
        law: impl Fn(usize) -> L + Copy + Sync + Send,
    ) -> Self::Output;
}

/// Does work in as many dimensions as needed, one law for all bonds being the leaner case.
pub(crate) fn with_laws<W: WithLaws>(assembly: &Assembly, work: W) -> W::Output {
    match (&assembly.laws, assembly.dimensions(), assembly.rounding) {
        (&Laws::Same(law), 2, None) => work.run::<2, _>(assembly, move |_| law),
        (&Laws::Same(law), _, None) => work.run::<3, _>(assembly, move |_| law),
        (Laws::Each(laws), 2, None) => work.run::<2, _>(assembly, move |bond| laws[bond]),
        (Laws::Each(laws), _, None) => work.run::<3, _>(assembly, move |bond| laws[bond]),
        (laws, 2, Some(rounding)) => work.run::<2, _>(assembly, RoundedLaw::each(laws, rounding)),
        (laws, _, Some(rounding)) => work.run::<3, _>(assembly, RoundedLaw::each(laws, rounding)),
    }
}

/// What is known of the bonds from a slot on.
pub(crate) struct Bonds<'a, T> {
    pub(crate) first: usize,
    pub(crate) tensions: &'a mut [f64],
    pub(crate) transverse: &'a mut [T],
    pub(crate) axial: [&'a mut [T]; 3],
}

/// The bonds of a block: where their first and second ends were, how far these moved, and l₀.
struct Ends<'a> {
    places: [[&'a [f64]; 3]; 2],
    moves: [[&'a [f64]; 3]; 2],
    rest_lengths: &'a [f64],
    excess: &'a [f64],
}

/// Copies of numbers that do not lie side by side.
type Scratch = [[Buffer<f64>; 2]; 2];

const NO_EXCESS: [f64; BLOCK] = [0.0; BLOCK];

impl<'a> Ends<'a> {
    #[inline(always)]
    fn of<const D: usize>(
        block: &Block,
        assembly: &'a Assembly,
        displacements: &[&'a [f64]; 3],
        scratch: &'a mut Scratch,
    ) -> Self {
        let (start, count) = (block.start, block.count);
        let [places, moves] = scratch;
        let ends = &assembly.ends;
        let excess = assembly.excess.get(start..start + count);
        Self {
            places: cut(
                block.at_ends::<f64, D>(ends, &assembly.positions.components(), places),
                count,
            ),
            moves: cut(block.at_ends::<f64, D>(ends, displacements, moves), count),
            rest_lengths: &assembly.rest_lengths[start..][..count],
            excess: &excess.unwrap_or(&NO_EXCESS)[..count],
        }
    }

    /// See [`stretch`].
    #[inline(always)]
    fn stretch<const D: usize>(&self, bond: usize) -> ([f64; 3], f64, f64) {
        let between = |[first, second]: [[&[f64]; 3]; 2], axis: usize| {
            if axis < D {
                first[axis][bond] - second[axis][bond]
            } else {
                0.0
            }
        };
        let (places, moves) = (self.places, self.moves);
        stretch::<D>(
            [between(places, 0), between(places, 1), between(places, 2)],
            [between(moves, 0), between(moves, 1), between(moves, 2)],
            self.rest_lengths[bond],
            self.excess[bond],
        )
    }
}

/// From the second end of a bond to the first [mm], the length of that, and the strain, (4)-(5),
/// given the same at the start, how far the first end moved more than the second, l₀ and the excess
/// |X|² − l₀².
#[inline(always)]
pub(crate) fn stretch<const D: usize>(
    [x, y, z]: [f64; 3],
    [wx, wy, wz]: [f64; 3],
    rest: f64,
    excess: f64,
) -> ([f64; 3], f64, f64) {
    let (px, py, pz) = (x + wx, y + wy, z + wz);
    let mut square = px * px + py * py;
    let mut elongation = wx * (x + px) + wy * (y + py);
    if D == 3 {
        square += pz * pz;
        elongation += wz * (z + pz);
    }
    let length = square.sqrt();
    let strain = (elongation + excess) / ((length + rest) * rest);
    ([px, py, pz], length, strain)
}

/// What a bond does, in terms of kernels.
pub(crate) struct Reaction<T> {
    /// l₀ φ(u) [N mm].
    pub(crate) energy: f64,
    /// T [N].
    pub(crate) tension: f64,
    /// Force on the first end over the vector from the second end to it [N/mm].
    pub(crate) pull: f64,
    /// b [N/mm].
    pub(crate) transverse: T,
    /// √(a − b) [√(N/mm)].
    pub(crate) root: T,
    /// One over the length, zero for a bond without [1/mm].
    pub(crate) inverse: f64,
}

/// The reaction of a bond of this length and strain, (6) and (7), times `act`.
#[inline(always)]
pub(crate) fn react<T: Real, L: StrainLaw>(
    law: &L,
    act: f64,
    length: f64,
    strain: f64,
    rest: f64,
) -> Reaction<T> {
    let tension = act * law.tension(strain);
    let inverse = if length > NO_LENGTH * rest {
        1.0 / length
    } else {
        0.0
    };
    Reaction {
        energy: act * rest * law.energy(strain),
        tension,
        // the first end is pulled towards the second
        pull: -tension * inverse,
        transverse: T::new(tension * inverse),
        root: T::new(act * law.axial_excess(strain) * inverse).sqrt(),
        inverse,
    }
}

/// The first so many numbers, all there are: the compiler does not know, and checks every index.
#[inline(always)]
fn cut(at_ends: [[&[f64]; 3]; 2], count: usize) -> [[&[f64]; 3]; 2] {
    at_ends.map(
        #[inline(always)]
        |end| {
            end.map(
                #[inline(always)]
                |values| &values[..count],
            )
        },
    )
}

/// Lets the bonds of a strip follow the displacements; returns their energy.
#[inline(always)]
pub(crate) fn respond<const D: usize, T: Real, L: StrainLaw>(
    assembly: &Assembly,
    strip: &Strip,
    displacements: [&[f64]; 3],
    law: impl Fn(usize) -> L,
    bonds: &mut Bonds<'_, T>,
    resultants: &mut Sums<'_, f64, 3>,
) -> f64 {
    let mut scratch: Scratch = [[[[0.0; BLOCK]; 3]; 2]; 2];
    let mut forces: Buffer<f64> = [[0.0; BLOCK]; 3];
    let mut energies = [0.0; BLOCK];
    // of its own, so that the compiler knows that writing them changes nothing that is read
    let mut stiffness = [[T::zero(); BLOCK]; 4];
    let mut energy = 0.0;
    for block in &assembly.blocks[strip.blocks.clone()] {
        let (start, count) = (block.start, block.count);
        let ends = Ends::of::<D>(block, assembly, &displacements, &mut scratch);
        let acts = &assembly.acts[start..][..count];
        let own = start - bonds.first;
        let tensions = &mut bonds.tensions[own..][..count];
        let [ax, ay, az, transverse] = stiffness.each_mut().map(
            #[inline(always)]
            |part| &mut part[..count],
        );
        let [fx, fy, fz] = forces.each_mut().map(
            #[inline(always)]
            |forces| &mut forces[..count],
        );
        let energies = &mut energies[..count];
        for bond in 0..count {
            let ([px, py, pz], length, strain) = ends.stretch::<D>(bond);
            let act = f64::from(acts[bond]);
            let law = law(start + bond);
            let reaction = react::<T, L>(&law, act, length, strain, ends.rest_lengths[bond]);
            energies[bond] = reaction.energy;
            tensions[bond] = reaction.tension;
            transverse[bond] = reaction.transverse;
            ax[bond] = T::new(px * reaction.inverse) * reaction.root;
            ay[bond] = T::new(py * reaction.inverse) * reaction.root;
            fx[bond] = px * reaction.pull;
            fy[bond] = py * reaction.pull;
            if D == 3 {
                az[bond] = T::new(pz * reaction.inverse) * reaction.root;
                fz[bond] = pz * reaction.pull;
            }
        }
        energy += sum(energies);
        for (axial, part) in bonds.axial.iter_mut().zip([ax, ay, az]).take(D) {
            axial[own..][..count].copy_from_slice(part);
        }
        bonds.transverse[own..][..count].copy_from_slice(transverse);
        block.scatter::<f64, D>(&assembly.ends, &forces, resultants);
    }
    energy
}

/// The energy of the bonds of a strip.
#[inline(always)]
pub(crate) fn energy<const D: usize, L: StrainLaw>(
    assembly: &Assembly,
    strip: &Strip,
    displacements: [&[f64]; 3],
    law: impl Fn(usize) -> L,
) -> f64 {
    let mut scratch: Scratch = [[[[0.0; BLOCK]; 3]; 2]; 2];
    let mut energies = [0.0; BLOCK];
    let mut energy = 0.0;
    for block in &assembly.blocks[strip.blocks.clone()] {
        let (start, count) = (block.start, block.count);
        let ends = Ends::of::<D>(block, assembly, &displacements, &mut scratch);
        let acts = &assembly.acts[start..][..count];
        let energies = &mut energies[..count];
        for bond in 0..count {
            let (_, _, strain) = ends.stretch::<D>(bond);
            let act = f64::from(acts[bond]);
            energies[bond] = act * ends.rest_lengths[bond] * law(start + bond).energy(strain);
        }
        energy += sum(energies);
    }
    energy
}
