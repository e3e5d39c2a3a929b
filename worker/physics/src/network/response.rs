//! The kernels that let bonds follow the displacements of their ends, (4)-(7).
use super::{
    Laws,
    assembly::{Assembly, NO_LENGTH},
    blocks::{BLOCK, Block, Buffer, Sums},
    field::{Real, sum},
    law::StrainLaw,
    rounded::RoundedLaw,
    strips::Strip,
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

    /// From the second end of a bond to the first [mm], the length of that, and the strain, (4)-(5).
    #[inline(always)]
    fn stretch<const D: usize>(&self, bond: usize) -> ([f64; 3], f64, f64) {
        let [first, second] = &self.places;
        let [moved_first, moved_second] = &self.moves;
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
        let rest = self.rest_lengths[bond];
        let length = square.sqrt();
        let strain = (elongation + self.excess[bond]) / ((length + rest) * rest);
        ([px, py, pz], length, strain)
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
            let rest = ends.rest_lengths[bond];
            let act = f64::from(acts[bond]);
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
