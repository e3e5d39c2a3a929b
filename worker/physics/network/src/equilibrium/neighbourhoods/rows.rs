//! Kernels of a neighbourhood.
//!
//! Its bonds lie in no order, so the numbers of a node, or of a bond, are a row of four that is
//! loaded and stored at once: that is three times as fast as to gather each by itself.
use std::ops::{AddAssign, Range, SubAssign};

use loadframe_numerics::wide;

use crate::{
    assembly::Assembly,
    equilibrium::block_jacobi::{DIAGONAL, invert},
    field::{LANES, fold, sum},
    law::StrainLaw,
    response::{react, stretch},
    stiffness::positive_block,
};

/// Three components, and a fourth number or none.
pub(super) type Row<T> = [T; 4];

/// Bonds between nodes of a neighbourhood, all of which act, node by node of their first ends. Arrays
/// of other things than ends are filled up to whole vectors, with bonds that do nothing.
#[derive(Debug, Default)]
pub(super) struct Bonds {
    /// The first bond of each node that has first ends, and how many bonds there are.
    pub(super) starts: Vec<u32>,
    pub(super) ends: Vec<[u32; 2]>,
    /// In the whole.
    pub(super) slots: Vec<u32>,
    /// From the second end to the first at the start [mm].
    spans: [Vec<f64>; 3],
    /// l₀ [mm].
    rest_lengths: Vec<f64>,
    /// |X|² − l₀² [mm²].
    excess: Vec<f64>,
}

/// Nodes and bonds at some displacements; of bonds in the order of [`Bonds`], ended as they are.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    /// [mm].
    pub(super) displacements: Vec<Row<f64>>,
    /// E of the bonds [N mm].
    pub(super) energy: f64,
    /// Sum of the forces of the bonds on every node [N].
    pub(super) resultants: Vec<Row<f64>>,
    /// T [N].
    pub(super) tensions: Vec<f64>,
    /// Of the bonds on their first ends [N].
    forces: Vec<Row<f64>>,
    /// s [√(N/mm)] and b [N/mm], see [`Stiffness`](crate::stiffness::Stiffness).
    pub(super) stiffness: Vec<Row<f32>>,
}

impl Bonds {
    pub(super) fn clear(&mut self) {
        self.starts.clear();
        self.ends.clear();
        self.slots.clear();
    }

    /// Takes from the whole what is known of the bonds in these slots, between nodes at these places.
    pub(super) fn look_up(&mut self, assembly: &Assembly, places: &[u32]) {
        let whole = self.ends.len().next_multiple_of(LANES);
        for (axis, spans) in self.spans.iter_mut().enumerate() {
            spans.clear();
            let positions = assembly.positions.axis(axis);
            if !positions.is_empty() {
                let at = |end: u32| positions[places[end as usize] as usize];
                spans.extend(
                    self.ends
                        .iter()
                        .map(|[first, second]| at(*first) - at(*second)),
                );
            }
        }
        let slots = self.slots.iter();
        self.rest_lengths.clear();
        self.rest_lengths.extend(
            slots
                .clone()
                .map(|slot| assembly.rest_lengths[*slot as usize]),
        );
        self.excess.clear();
        if !assembly.excess.is_empty() {
            self.excess
                .extend(slots.map(|slot| assembly.excess[*slot as usize]));
        }
        let [x, y, z] = &mut self.spans;
        x.resize(whole, 1.0);
        y.resize(whole, 0.0);
        z.resize(whole, 0.0);
        self.rest_lengths.resize(whole, 1.0);
        self.excess.resize(whole, 0.0);
        self.slots.resize(whole, 0);
    }

    /// Each node that has first ends, and its bonds.
    fn by_node(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        let starts = self.starts.windows(2).enumerate();
        starts.map(|(node, range)| (node, range[0] as usize..range[1] as usize))
    }
}

impl State {
    /// Makes room for so many nodes and bonds.
    pub(super) fn resize(&mut self, nodes: usize, bonds: usize) {
        let bonds = bonds.next_multiple_of(LANES);
        self.displacements.resize(nodes, [0.0; 4]);
        self.resultants.resize(nodes, [0.0; 4]);
        self.tensions.resize(bonds, 0.0);
        self.forces.resize(bonds, [0.0; 4]);
        self.stiffness.resize(bonds, [0.0; 4]);
    }

    /// Makes everything follow the displacements, (4)-(7). `law` gives the law of the bond in a slot
    /// of the whole.
    pub(super) fn update<L: StrainLaw>(&mut self, bonds: &Bonds, law: impl Fn(usize) -> L + Copy) {
        wide(
            #[inline(always)]
            || self.respond(bonds, law),
        );
    }

    #[inline(always)]
    fn respond<L: StrainLaw>(&mut self, bonds: &Bonds, law: impl Fn(usize) -> L) {
        self.resultants.fill([0.0; 4]);
        let moves = self.displacements.as_slice();
        let mut energies = [0.0; LANES];
        let mut apart = [[0.0; LANES]; 3];
        // of their own, so that the compiler knows that writing them changes nothing that is read
        let mut tensions = [0.0; LANES];
        let mut stiffness = [[0.0_f32; 4]; LANES];
        let mut forces = [[0.0; 4]; LANES];
        for (group, ends) in bonds.ends.chunks(LANES).enumerate() {
            let start = group * LANES;
            for (lane, [first, second]) in ends.iter().enumerate() {
                let (first, second) = (&moves[*first as usize], &moves[*second as usize]);
                for axis in 0..3 {
                    apart[axis][lane] = first[axis] - second[axis];
                }
            }
            for apart in &mut apart {
                apart[ends.len()..].fill(0.0);
            }
            let [x, y, z] = bonds.spans.each_ref().map(
                #[inline(always)]
                |span| &span[start..][..LANES],
            );
            let rest = &bonds.rest_lengths[start..][..LANES];
            let excess = &bonds.excess[start..][..LANES];
            let slots = &bonds.slots[start..][..LANES];
            for lane in 0..LANES {
                let (p, length, strain) = stretch::<3>(
                    [x[lane], y[lane], z[lane]],
                    [apart[0][lane], apart[1][lane], apart[2][lane]],
                    rest[lane],
                    excess[lane],
                );
                let law = law(slots[lane] as usize);
                let reaction = react::<f32, L>(&law, 1.0, length, strain, rest[lane]);
                energies[lane] += reaction.energy;
                tensions[lane] = reaction.tension;
                let axial = reaction.inverse;
                stiffness[lane] = [
                    (p[0] * axial) as f32 * reaction.root,
                    (p[1] * axial) as f32 * reaction.root,
                    (p[2] * axial) as f32 * reaction.root,
                    reaction.transverse,
                ];
                let pull = reaction.pull;
                forces[lane] = [p[0] * pull, p[1] * pull, p[2] * pull, 0.0];
            }
            self.tensions[start..][..LANES].copy_from_slice(&tensions);
            self.stiffness[start..][..LANES].copy_from_slice(&stiffness);
            self.forces[start..][..LANES].copy_from_slice(&forces);
        }
        for (node, range) in bonds.by_node() {
            let mut sum = [0.0; 4];
            let of_node = bonds.ends[range.clone()].iter().zip(&self.forces[range]);
            for ([_, other], force) in of_node {
                add(&mut sum, *force);
                subtract(&mut self.resultants[*other as usize], *force);
            }
            add(&mut self.resultants[node], sum);
        }
        self.energy = fold(&energies);
    }
}

/// Sets `product` to K `field`, where it matters: `field` must vanish at nodes that are held.
pub(super) fn multiply(
    bonds: &Bonds,
    stiffness: &[Row<f32>],
    field: &[Row<f32>],
    product: &mut [Row<f32>],
) {
    wide(
        #[inline(always)]
        || {
            product.fill([0.0; 4]);
            for (node, range) in bonds.by_node() {
                let here = &field[node];
                let mut sum = [0.0; 4];
                let of_node = bonds.ends[range.clone()].iter().zip(&stiffness[range]);
                for ([_, other], stiffness) in of_node {
                    let there = &field[*other as usize];
                    let mut apart = [0.0; 4];
                    for part in 0..4 {
                        apart[part] = here[part] - there[part];
                    }
                    let [sx, sy, sz, b] = stiffness;
                    let along = sz.mul_add(apart[2], sy.mul_add(apart[1], sx * apart[0]));
                    // what this makes of the fourth number is never looked at
                    let mut force = [0.0; 4];
                    for part in 0..4 {
                        force[part] = stiffness[part].mul_add(along, b * apart[part]);
                    }
                    add(&mut sum, force);
                    subtract(&mut product[*other as usize], force);
                }
                add(&mut product[node], sum);
            }
        },
    );
}

#[inline(always)]
fn add<T: Copy + AddAssign, const N: usize>(sums: &mut [T; N], values: [T; N]) {
    for part in 0..N {
        sums[part] += values[part];
    }
}

#[inline(always)]
fn subtract<T: Copy + SubAssign, const N: usize>(sums: &mut [T; N], values: [T; N]) {
    for part in 0..N {
        sums[part] -= values[part];
    }
}

/// The inverse of each node's own stiffness, as [`BlockJacobi`](super::super::block_jacobi::BlockJacobi)
/// has it.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    /// xx, yy, xy, zz, xz, yz of each bond, and nothing.
    of_bonds: Vec<[f32; 8]>,
    /// What they sum up to at each node.
    blocks: Vec<[f32; 8]>,
    /// Of their inverses.
    inverses: [Vec<f32>; 6],
    /// Mean over the directions of what the blocks multiply, summed over the nodes [mm/N].
    pub(super) compliance: f64,
}

impl Nodes {
    /// Becomes that of this stiffness in D dimensions, for the first `free` of the nodes.
    pub(super) fn follow<const D: usize>(
        &mut self,
        bonds: &Bonds,
        stiffness: &[Row<f32>],
        free: usize,
        nodes: usize,
    ) {
        self.of_bonds.resize(stiffness.len(), [0.0; 8]);
        self.blocks.clear();
        self.blocks.resize(nodes, [0.0; 8]);
        for part in &mut self.inverses {
            part.resize(free, 0.0);
        }
        self.compliance = wide(
            #[inline(always)]
            || {
                self.sum(bonds, stiffness);
                self.invert::<D>()
            },
        );
    }

    #[inline(always)]
    fn sum(&mut self, bonds: &Bonds, stiffness: &[Row<f32>]) {
        let mut blocks = [[0.0; 8]; LANES];
        for (stiffness, of_bonds) in stiffness.chunks(LANES).zip(self.of_bonds.chunks_mut(LANES)) {
            for (block, [sx, sy, sz, b]) in blocks.iter_mut().zip(stiffness) {
                let [xx, yy, xy, zz, xz, yz] = positive_block([*sx, *sy, *sz], *b);
                *block = [xx, yy, xy, zz, xz, yz, 0.0, 0.0];
            }
            of_bonds.copy_from_slice(&blocks[..of_bonds.len()]);
        }
        for (node, range) in bonds.by_node() {
            let mut sum = [0.0; 8];
            let of_node = bonds.ends[range.clone()].iter().zip(&self.of_bonds[range]);
            for ([_, other], block) in of_node {
                add(&mut sum, *block);
                add(&mut self.blocks[*other as usize], *block);
            }
            add(&mut self.blocks[node], sum);
        }
    }

    /// Inverts the blocks; returns the compliance.
    #[inline(always)]
    fn invert<const D: usize>(&mut self) -> f64 {
        let mut parts = self.inverses.each_mut().map(
            #[inline(always)]
            |part| part.as_mut_slice(),
        );
        for (part, inverses) in parts.iter_mut().enumerate() {
            for (inverse, block) in inverses.iter_mut().zip(&self.blocks) {
                *inverse = block[part];
            }
        }
        invert::<f32, D>(&mut parts);
        // nothing moves out of the plane
        for part in &mut parts[D * (D + 1) / 2..] {
            part.fill(0.0);
        }
        DIAGONAL.map(|part| sum(parts[part])).iter().sum::<f64>() / 3.0
    }

    /// Sets `moved` to about the displacements that relieve `forces`.
    #[inline(always)]
    pub(super) fn apply(&self, forces: &[Row<f32>], moved: &mut [Row<f32>]) {
        let count = forces.len();
        let moved = &mut moved[..count];
        let [xx, yy, xy, zz, xz, yz] = self.inverses.each_ref().map(
            #[inline(always)]
            |part| &part[..count],
        );
        for node in 0..count {
            let [x, y, z, _] = forces[node];
            moved[node] = [
                xz[node].mul_add(z, xy[node].mul_add(y, xx[node] * x)),
                yz[node].mul_add(z, yy[node].mul_add(y, xy[node] * x)),
                zz[node].mul_add(z, yz[node].mul_add(y, xz[node] * x)),
                0.0,
            ];
        }
    }
}

/// The largest square of the length of a row.
pub(super) fn longest_square(rows: &[Row<f64>]) -> f64 {
    let squares = rows.iter().map(|[x, y, z, _]| x * x + y * y + z * z);
    squares.fold(0.0, |longest, square| {
        // a NaN is to be seen
        if square <= longest { longest } else { square }
    })
}
