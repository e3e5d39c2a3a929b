//! Contacts of two spheres.
//!
//! d = x_b − x_a, n = d/|d|, δ = r_a + r_b − |d| (G.5). Slip uses the branch vectors of the
//! spheres as if they just touched, which keeps a contact that is wound up and unwound from
//! creeping (granular ratcheting, [GarciaRojo2005]):
//!
//!   v = α (v_b − v_a) − (r_a ω_a + r_b ω_b) × n, α = (r_a + r_b)/|d|, v_T = v − (v·n) n (G.6)
//!
//! Both spheres of an *inner* block belong to one patch, which adds to both. Of an *outer* block
//! the second sphere belongs to a later patch: what acts on it is summed in the patch's halo, for
//! the other to fetch.
use pulp::Simd;

use super::{
    Depths, Kinematics, Slip, Touch,
    blocks::{Before, Block, Blocks, Ends},
    law::{Law, direction},
    packed::Columns,
};
use crate::{
    motion::Wrenches,
    numbers::{
        ahead::ask,
        lanes::{LANES, Lanes, Vectors, any, bits},
        rows::{Gathered, Row, Scattered, gather},
    },
};

/// Particles a and b of a block; padding is a particle against itself.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    pub(super) a: [u32; LANES],
    pub(super) b: [u32; LANES],
}

type PairBlock<F> = Block<Pairs, F>;

/// Candidates of two spheres.
#[derive(Clone, Debug, Default)]
pub(super) struct PairList<F: Law> {
    pub(super) list: Blocks<Pairs, F>,
    /// Rows of the halo for particles b, where these belong to other patches.
    pub(super) places: Vec<[u32; LANES]>,
}

impl Ends for Pairs {
    type Lane = [u32; 2];

    fn padding([a, _]: [u32; 2]) -> Self {
        Self {
            a: [a; LANES],
            b: [a; LANES],
        }
    }

    fn set(&mut self, lane: usize, ends: [u32; 2]) {
        [self.a[lane], self.b[lane]] = ends;
    }

    fn show(&mut self, columns: &mut dyn Columns) {
        columns.ends(&mut self.a);
        columns.ends(&mut self.b);
    }
}

/// Blocks asked for before their turn, half a microsecond: several times what memory takes. From 4
/// to 24 all serve alike.
const BLOCKS_AHEAD: usize = 8;
/// Blocks whose particles of other patches are asked for before their turn: 1 comes too late, 4 too
/// early by some per cent.
const OTHERS_AHEAD: usize = 2;

impl<F: Law> PairList<F> {
    /// Asks for a block, if there is one.
    #[inline(always)]
    fn ask(&self, index: usize) {
        if let Some(block) = self.list.blocks.get(index) {
            // both ends are in one line
            ask(&block.ends.a);
            ask(&block.stiffness);
            block.law.ask();
        }
    }

    /// Adds the forces on first particles, and of inner blocks those on second ones, to the patch that
    /// begins with particle `first`; of outer blocks those on second particles to the `halo`.
    ///
    /// One loop for both: twice as much code takes twice as long to compile, law by law and width by
    /// width, and what is asked in each lane is foreseen by the processor.
    #[inline(always)]
    pub(super) fn push<S: Simd>(
        &mut self,
        simd: S,
        kinematics: Kinematics<'_>,
        first: usize,
        wrenches: &mut Wrenches,
        mut halo: Option<&mut Wrenches>,
        depths: &mut Depths<S>,
    ) {
        for index in 0..self.list.blocks.len() {
            self.ask(index + BLOCKS_AHEAD);
            let mut places = [0; LANES];
            if halo.is_some() {
                if let Some(block) = self.list.blocks.get(index + OTHERS_AHEAD) {
                    kinematics.ask(&block.ends.b);
                }
                places = self.places[index];
            }
            let (block, touching, before) = self.list.take(index);
            let (a, b) = (block.ends.a, block.ends.b);
            *touching = block.advance(
                simd,
                kinematics,
                before,
                depths,
                #[inline(always)]
                |lane: usize, force: [f64; 4], torque: [f64; 4], moment: Option<[f64; 4]>| {
                    let a = a[lane] as usize - first;
                    wrenches.forces[a].subtract(force);
                    let moments = F::IS_ROUGH.then(|| moments(force, torque, moment));
                    if let Some([on_a, _]) = moments {
                        wrenches.torques[a].subtract(on_a);
                    }
                    let (other, b) = match &mut halo {
                        None => (&mut *wrenches, b[lane] as usize - first),
                        Some(halo) => (&mut **halo, places[lane] as usize),
                    };
                    other.forces[b].add(force);
                    if let Some([_, on_b]) = moments {
                        other.torques[b].subtract(on_b);
                    }
                },
            );
        }
    }
}

impl<F: Law> PairList<F> {
    /// Sets the row of the halo for particle b of a candidate, by the place that [`Blocks::add`] gave.
    pub(super) fn set_place(&mut self, candidate: usize, row: u32) {
        // padding of the last block adds nothing, anywhere
        self.places.resize(self.list.blocks.len(), [row; LANES]);
        self.places[candidate / LANES][candidate % LANES] = row;
    }

    /// Memory [bytes].
    pub(super) fn bytes(&self) -> usize {
        self.list.bytes() + size_of_val(self.places.as_slice())
    }

    /// All is added.
    pub(super) fn finish(&mut self) {
        self.list.finish();
        self.places.shrink_to_fit();
    }
}

/// Moments (r − δ/2) n × F about both centres, the arms riding in the fourth numbers, and on b less what
/// resists rolling, on a with it.
#[inline(always)]
fn moments(force: [f64; 4], torque: [f64; 4], resisting: Option<[f64; 4]>) -> [[f64; 4]; 2] {
    let [arm_a, arm_b] = [force[3], torque[3]];
    let (mut on_a, mut on_b) = (torque, torque);
    for axis in 0..4 {
        on_a[axis] *= arm_a;
        on_b[axis] *= arm_b;
    }
    if let Some(moment) = resisting {
        for axis in 0..4 {
            on_a[axis] += moment[axis];
            on_b[axis] -= moment[axis];
        }
    }
    [on_a, on_b]
}

impl<F: Law> PairBlock<F> {
    /// Advances the contacts by a step. Gives `act` the force F on b with arm of a, n × F with the arm
    /// of b, and the moment on b of what resists rolling, for every lane of a part in which something touches, or touched in the
    /// last step; zero where nothing does. Returns which lanes touch.
    #[inline(always)]
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        kinematics: Kinematics<'_>,
        before: Before<'_>,
        depths: &mut Depths<S>,
        mut act: impl FnMut(usize, [f64; 4], [f64; 4], Option<[f64; 4]>),
    ) -> u8 {
        let mut touching = 0;
        for part in 0..LANES / S::F64_LANES {
            let a = gather(simd, kinematics.centres, &self.ends.a, part);
            let b = gather(simd, kinematics.centres, &self.ends.b, part);
            let between = b.vector - a.vector;
            let reach = a.fourth + b.fourth;
            let distance = between.dot(between).sqrt();
            let is_near = distance.at_most(reach);
            // equal centres have no normal; they are told of elsewhere
            let is_apart = Lanes::splat(simd, 0.0).below(distance);
            let is_touching = simd.and_m64s(is_near, is_apart);
            let may_act = self.law.acting(simd, part, is_touching);
            if !any::<S>(may_act) {
                if before.touched != 0 {
                    self.law.forget(simd, part);
                    // adds nothing, but the compiler lays the loop out better: without it a bed without
                    // friction takes 6 to 8 % longer
                    let lanes = part * S::F64_LANES..(part + 1) * S::F64_LANES;
                    for lane in lanes {
                        act(lane, [0.0; 4], [0.0; 4], None);
                    }
                }
                continue;
            }
            let inverse = Lanes::splat(simd, 1.0).over(distance);
            let normal = between.scaled(inverse);
            let overlap = reach - distance;
            let [shear_ratio, friction] = before.tangent.load(simd, part);
            let touch = Touch {
                normal,
                overlap,
                reach,
                stiffness: Lanes::load(simd, &self.stiffness, part),
                shear_ratio,
                friction,
                is_touching,
            };
            let mut slip = Slip::none(simd);
            if F::FEELS_SPEED {
                let velocities = self.sides(simd, kinematics.velocities, part);
                let relative = velocities[1] - velocities[0];
                slip.approach = relative.dot(normal);
                if F::IS_ROUGH {
                    let spins = self.sides(simd, kinematics.spins, part);
                    let branches = spins[0].scaled(a.fourth) + spins[1].scaled(b.fourth);
                    let velocity = relative.scaled(reach * inverse) - branches.cross(normal);
                    slip.velocity = velocity - normal.scaled(velocity.dot(normal));
                    slip.spins = spins[0] + spins[1];
                    if F::RESISTS_ROLLING {
                        slip.rolling = spins[1] - spins[0];
                    }
                    if F::FOLLOWS_NORMALS {
                        let way = relative.scaled(Lanes::splat(simd, kinematics.last_step));
                        slip.last_normal = direction(simd, between - way, inverse);
                    }
                }
            }
            let push = self
                .law
                .advance(simd, part, touch, slip, kinematics.time_step);
            touching |= bits::<S>(push.acts, part);
            push.tell(simd, a.fourth.or_smaller(b.fourth), depths);
            let half = Lanes::splat(simd, 0.5) * overlap;
            let force = Gathered {
                vector: normal.scaled(push.normal) + push.shear,
                fourth: a.fourth - half,
            };
            let torque = Gathered {
                vector: normal.cross(push.shear),
                fourth: b.fourth - half,
            };
            // a lane that does not act holds numbers without meaning, perhaps not even finite
            let force = force.masked(simd, push.acts).scatter(simd);
            let torque = torque.masked(simd, push.acts).scatter(simd);
            let moment = push.moment_rows(simd);
            for lane in 0..S::F64_LANES {
                let resisting = Scattered::row_of(moment.as_ref(), lane);
                let contact = part * S::F64_LANES + lane;
                act(contact, force.row(lane), torque.row(lane), resisting);
            }
        }
        touching
    }

    /// A vector of both particles.
    #[inline(always)]
    fn sides<S: Simd>(&self, simd: S, rows: &[Row], part: usize) -> [Vectors<S>; 2] {
        [
            gather(simd, rows, &self.ends.a, part).vector,
            gather(simd, rows, &self.ends.b, part).vector,
        ]
    }
}
