//! Laws of contact: what springs, friction and bonds make of overlap and slip.
//!
//! A law is a type of its own, one file each, chosen once for a scene: [`Frictionless`] remembers
//! nothing and turns nothing, [`Coulomb`] remembers its shear force (and turns it by the normal of the
//! last step, [`Kept`] or [`Followed`]), [`HertzMindlin`] the overlap it
//! belongs to as well, [`Bonded`] holds together until it breaks, [`Cemented`] with moments. Each stands on a spring along the
//! [`normal`]: [`Linear`], [`Logarithmic`] or [`Hertz`]. [`Viscous`] is a dashpot beside any of them,
//! [`Along`] the normal or, beside those with friction, [`Across`]. Around all of these stands what is
//! [`Resisting`] rolling and twisting.
mod bonded;
mod cemented;
mod coulomb;
mod frictionless;
mod hertz;
mod logarithmic;
pub(crate) mod normal;
mod normals;
mod resisting;
mod viscous;

use std::fmt::Debug;

use pulp::Simd;

use super::{Push, Slip, Touch, packed::Columns, past::Past, stiffness::Springs};
use crate::numbers::{Vector, lanes::Lanes};

pub(crate) use bonded::Bonded;
pub(crate) use cemented::Cemented;
pub(crate) use coulomb::Coulomb;
pub(crate) use frictionless::Frictionless;
pub(crate) use hertz::{Hertz, HertzMindlin};
pub(crate) use logarithmic::Logarithmic;
pub(crate) use normal::{Linear, Normal, Spring};
pub(crate) use normals::{Followed, Kept, Normals, direction};
pub(crate) use resisting::Resisting;
pub(crate) use viscous::{Across, Along, Viscous};

/// What a contact does, as observers see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ContactForces {
    /// F_N of the spring [N].
    pub(crate) spring_force: f64,
    /// F_N of spring and dashpot [N].
    pub(crate) force: f64,
    /// F_T of the spring on b [N].
    pub(crate) spring_shear: Vector,
    /// F_T of spring and dashpot on b [N].
    pub(crate) shear: Vector,
    /// Tangents k_N, k_T [N/m].
    pub(crate) stiffness: [f64; 2],
    /// c_N and c_T of the dashpots [N s/m].
    pub(crate) dashpots: [f64; 2],
    /// Moments on b of the springs against rolling and, along the normal, twisting [N m].
    pub(crate) rolling: Vector,
    pub(crate) twisting: f64,
    /// Moment on b of these and of dashpots beside them, where there may be such [N m].
    pub(crate) moment: Option<Vector>,
    /// k_r and k_t [N m].
    pub(crate) turning_stiffness: [f64; 2],
    /// c_r and c_t [N m s].
    pub(crate) turning_dashpots: [f64; 2],
    /// Compression of the spring [m], negative where a bond is stretched.
    pub(crate) compression: f64,
    /// In what holds beside those springs [J].
    pub(crate) held: f64,
    /// Whether an intact bond holds the bodies together.
    pub(crate) is_bonded: bool,
}

/// The law of a block one contact at a time: what lists and observers need of it between steps.
pub(crate) trait Lanewise {
    fn past(&self, lane: usize) -> Past;

    /// Sets a lane: what the contact has beside its springs, and what it remembers.
    fn start(&mut self, lane: usize, _springs: &Springs, past: &Past) {
        self.remember(lane, past);
    }

    /// Sets what the contact in a lane remembers.
    fn remember(&mut self, lane: usize, past: &Past);

    /// What the contact in a lane does at this overlap.
    fn forces(&self, lane: usize, spring: &Spring) -> ContactForces;

    /// Shows all that the block keeps.
    fn show(&mut self, columns: &mut dyn Columns);
}

/// A law for the contacts of a block.
pub(crate) trait Law: Lanewise + Clone + Debug + Default + Send + Sync + 'static {
    /// The spring along the normal.
    type Normal: Normal;

    /// Whether there are shear forces.
    const IS_ROUGH: bool;

    /// Whether the normals of the last step are to be found from velocities.
    const FOLLOWS_NORMALS: bool;

    /// Whether velocities matter.
    const FEELS_SPEED: bool = Self::IS_ROUGH;

    /// Whether the difference of spins matters.
    const RESISTS_ROLLING: bool = false;

    /// Lanes in which something may act, given those that touch.
    #[inline(always)]
    fn acting<S: Simd>(&self, _simd: S, _part: usize, touching: S::m64s) -> S::m64s {
        touching
    }

    /// Forces of a contact in this step; of no meaning where it does not act.
    fn advance<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        touch: Touch<S>,
        slip: Slip<S>,
        time_step: f64,
    ) -> Push<S>;

    /// Asks for the memory of the block, which comes next.
    fn ask(&self);

    /// Nothing acts in this part of the block.
    fn forget<S: Simd>(&mut self, simd: S, part: usize);
}

impl ContactForces {
    /// A normal spring alone, with what shears it: the constant of k_T and the force on b.
    fn spring<N: Normal>(spring: &Spring, shear_constant: f64, shear: Vector) -> Self {
        let force = spring.force::<N>();
        Self {
            spring_force: force,
            force,
            spring_shear: shear,
            shear,
            stiffness: [N::tangent(spring), N::shear(shear_constant, spring)],
            compression: spring.overlap,
            ..Self::default()
        }
    }

    /// In the springs across the normal and against rolling and twisting [J].
    pub(crate) fn tangential_energy(&self) -> f64 {
        let [rolling, twisting] = self.turning_stiffness;
        in_spring(self.spring_shear.norm_squared(), self.stiffness[1])
            + in_spring(self.rolling.norm_squared(), rolling)
            + in_spring(self.twisting.powi(2), twisting)
            + self.held
    }
}

/// Part of its load that a spring keeps, given what its stiffness is in proportion to, now and before: all,
/// but where it has softened. Carried over whole, the load would make energy.
#[inline(always)]
fn kept<S: Simd>(simd: S, softness: Lanes<S>, before: Lanes<S>) -> Lanes<S> {
    let part = softness.over(before);
    // without a load before the quotient is not a number, and not taken
    part.only_if(softness.below(before), Lanes::splat(simd, 1.0))
}

/// Energy [J] of a spring, given the square of its load.
fn in_spring(square: f64, stiffness: f64) -> f64 {
    if stiffness > 0.0 {
        0.5 * square / stiffness
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        contact::{
            past::{Beam, Bond},
            stiffness::{Cement, Resistance},
        },
        numbers::lanes::{Array, LANES, Vectors},
    };
    use pulp::{Arch, Scalar, WithSimd};

    /// Some steps of one block of contacts, all different; the last step in bits.
    struct Block<F: Law>(F);

    impl<F: Law> WithSimd for Block<F> {
        type Output = Vec<u64>;

        fn with_simd<S: Simd>(mut self, simd: S) -> Vec<u64> {
            let number = |place: usize| ((place * 7919 + 3) % 1000) as f64 / 1000.0;
            let array =
                |row: usize| -> Array { std::array::from_fn(|lane| number(LANES * row + lane)) };
            for lane in 0..LANES {
                let springs = Springs {
                    normal: 1e5 * (1.0 + number(lane)),
                    ratio: 0.3,
                    friction: 0.5,
                    dashpots: [7.0, 3.0],
                    resistance: Resistance {
                        stiffness: [2.0, 5.0],
                        reach: [1e-3, 2e-3],
                        dashpots: [1e-4, 2e-4],
                    },
                    cement: Cement {
                        radius: 0.008,
                        section: 1e3,
                        ratio: 0.4,
                        strengths: [1e9, 1e9],
                    },
                };
                let past = Past {
                    normal: Vector::new(0.0, 0.6, 0.8),
                    bond: Bond {
                        is_intact: true,
                        strength: [1e9; 2],
                        beam: Beam {
                            length: 0.02,
                            ..Beam::default()
                        },
                        ..Bond::default()
                    },
                    ..Past::default()
                };
                self.0.start(lane, &springs, &past);
            }
            let mut bits = Vec::new();
            for step in 1..9 {
                let row = |row: usize| array(20 * step + row);
                let (reach, vectors) = ([0.02; LANES], [row(1), row(2), row(3)]);
                for part in 0..LANES / S::F64_LANES {
                    let small = Lanes::splat(simd, 1e-3);
                    // some lanes do not touch
                    let overlap =
                        (Lanes::load(simd, &row(0), part) - Lanes::splat(simd, 0.2)) * small;
                    let normal = Vectors::load(simd, &vectors, part);
                    let touch = Touch {
                        normal: normal
                            .scaled(Lanes::splat(simd, 1.0).over(normal.dot(normal).sqrt())),
                        overlap,
                        reach: Lanes::load(simd, &reach, part),
                        stiffness: Lanes::splat(simd, 1e5),
                        shear_ratio: Lanes::splat(simd, 0.3),
                        friction: Lanes::splat(simd, 0.5),
                        is_touching: Lanes::splat(simd, 0.0).below(overlap),
                    };
                    let slip = Slip {
                        approach: Lanes::load(simd, &row(4), part),
                        velocity: Vectors::load(simd, &[row(5), row(6), row(7)], part),
                        spins: Vectors::load(simd, &[row(8), row(9), row(10)], part),
                        last_normal: Vectors::load(simd, &[row(11), row(12), row(13)], part),
                        rolling: Vectors::load(simd, &[row(14), row(15), row(16)], part),
                    };
                    let push = self.0.advance(simd, part, touch, slip, 1e-5);
                    let nothing = Vectors::zero(simd);
                    let mut out = [[0.0; LANES]; 8];
                    let force = push.normal.only_if(push.acts, nothing.x);
                    force.store(&mut out[0], part);
                    let compression = push.compression.only_if(push.acts, nothing.x);
                    compression.store(&mut out[4], part);
                    let moment = push.moment.unwrap_or(nothing);
                    let moment = moment.only_if(push.acts, nothing);
                    for (first, vector) in [(1, push.shear), (5, moment)] {
                        let components = [vector.x, vector.y, vector.z];
                        for (column, component) in out[first..].iter_mut().zip(components) {
                            component.store(column, part);
                        }
                    }
                    let lanes = part * S::F64_LANES..(part + 1) * S::F64_LANES;
                    bits.extend(lanes.flat_map(|lane| out.map(|column| column[lane].to_bits())));
                }
            }
            bits
        }
    }

    /// How many arrays there are.
    struct Count(usize);

    impl Columns for Count {
        fn ends(&mut self, _column: &mut [u32; LANES]) {}

        fn numbers(&mut self, _column: &mut Array) {
            self.0 += 1;
        }
    }

    fn assert_same_bits<F: Law>() {
        // a checkpoint has all that there is
        let mut shown = Count(0);
        F::default().show(&mut shown);
        assert_eq!(shown.0 * size_of::<Array>(), size_of::<F>());

        let block = || Block(F::default());
        let expected = Simd::vectorize(Scalar::new(), block());
        assert!(expected.iter().any(|bits| *bits != 0));
        assert_eq!(Arch::new().dispatch(block()), expected);
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            assert_eq!(Simd::vectorize(simd, block()), expected);
        }
    }

    #[test]
    fn every_law_gives_the_same_bits_in_every_width_and_shows_all_that_it_keeps() {
        assert_same_bits::<Frictionless<Linear>>();
        assert_same_bits::<Frictionless<Logarithmic>>();
        assert_same_bits::<Coulomb<Linear, Followed>>();
        assert_same_bits::<Coulomb<Linear, Kept>>();
        assert_same_bits::<Coulomb<Logarithmic, Kept>>();
        assert_same_bits::<HertzMindlin>();
        assert_same_bits::<Bonded>();
        assert_same_bits::<Cemented>();
        assert_same_bits::<Viscous<HertzMindlin, Along>>();
        assert_same_bits::<Viscous<Frictionless<Hertz>, Along>>();
        assert_same_bits::<Viscous<Coulomb<Linear, Followed>, Across>>();
        assert_same_bits::<Viscous<Viscous<HertzMindlin, Across>, Along>>();
        assert_same_bits::<Resisting<Coulomb<Linear, Kept>>>();
        assert_same_bits::<Resisting<Viscous<Viscous<HertzMindlin, Across>, Along>>>();
    }
}
