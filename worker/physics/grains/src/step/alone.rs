//! How large a step one contact alone allows: for every step of a run, at the price of a comparison.
//!
//! What a body's contacts allow together ([`time_step`](crate::observe::time_step)) is only known when
//! somebody looks. In between contacts come and go: a sphere that bounces may touch and part between two
//! looks. So the candidates of a patch are asked for the one that would allow least when they are
//! listed, by the rows of (G.10), (G.11), (G.19) for a contact of its own along an axis. As soon as any contact
//! of the patch touches, that one counts, at the largest overlap over radius that contacts of the patch
//! have had: for linear springs, whose stiffness is constant, for Hertz's, which grow as one, and for
//! logarithmic ones, bounded at two radii, no contact of the patch allows less.
use serde::{Deserialize, Serialize};

use crate::{
    contact::{Deepest, chosen::Chosen, law::Spring, stiffness::Springs},
    motion::critical_step,
    scene::model::Model,
};

/// Overlap over radius at which candidates are compared: of stiff grains.
const COMPARED_AT: f64 = 1e-3;

/// How far a push moves a particle's body, and the place where it is pushed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mobility {
    /// 1/m [1/kg]; 0 for one that does not move.
    along: f64,
    /// Arm² over inertia [1/kg].
    about: f64,
    /// 1/√m [1/√kg].
    root: f64,
}

/// What a body of a candidate meets.
#[derive(Clone, Copy, Debug)]
pub(super) enum Other {
    Body(Mobility),
    /// 1/m [1/kg]; 0 of a wall that no force moves.
    Wall(f64),
}

/// A contact of two bodies, as if they had no other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Alone {
    /// The one that moves more easily, and its partner.
    pub(crate) bodies: [u32; 2],
    constant: f64,
    shear_ratio: f64,
    /// k_T, and the larger of k_r and k_t over the square of the smaller radius, over k_T.
    turning_ratio: f64,
    dashpots: [f64; 2],
    /// The larger of c_r and c_t over the square of the smaller radius, half of it [N s/m].
    turning_dashpot: f64,
    /// The smaller one [m].
    radius: f64,
    /// 1/m and 1/m + r²/I, with the terms of the other body [1/kg].
    mobility: [f64; 2],
}

/// The shortest step, over the step done, that any contact of a patch alone has allowed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Shortest {
    alone: Option<Alone>,
    /// Overlap over radius and Δt [s] of the last time it was asked.
    asked: [f64; 2],
}

/// A wall that bodies went through.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Through {
    /// How often one did.
    pub(crate) passages: u64,
    /// The first of them, and when.
    pub(crate) body: u32,
    pub(crate) step: u64,
}

/// Stiffness [N/m] and dashpot [N s/m] that a candidate at a wall has, for stiff grains.
pub(super) fn at_wall(law: &Chosen, is_rough: bool, radius: f64, springs: &Springs) -> [f64; 2] {
    let spring = Spring {
        constant: springs.normal,
        shear_ratio: f64::from(u8::from(is_rough)) * springs.ratio,
        overlap: COMPARED_AT * radius,
        reach: 2.0 * radius,
    };
    let [normal, shear] = (law.tangents)(&spring);
    let [along, across] = springs.dashpots;
    [
        normal.max(shear),
        (law.dashpot)(&spring) * along.max(across),
    ]
}

/// The worst that all steps so far had, contact by contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Seen {
    /// Largest compression over the smaller radius.
    pub(crate) overlap_ratio: f64,
    /// Largest Δt over the critical step of a contact alone.
    pub(crate) step_ratio: f64,
    /// That critical step [s], and the bodies of its contact.
    pub(crate) critical: Option<(f64, [u32; 2])>,
}

impl Mobility {
    /// Of a body of mass `mass` [kg], pushed where arm² over inertia is `about` [1/kg].
    pub(super) fn new(mass: f64, about: f64) -> Self {
        Self {
            along: 1.0 / mass,
            about,
            root: 1.0 / mass.sqrt(),
        }
    }

    /// 1/m and 1/m + r²/I of both together, at a wall of this 1/m [1/kg] (G.26).
    fn at_wall(&self, wall: f64) -> [f64; 2] {
        [self.along + wall, self.along + self.about + wall]
    }

    /// 1/m and 1/m + r²/I times (1 + √(m/m')), beside another body.
    fn beside(&self, other: &Self) -> [f64; 2] {
        let factor = if self.root > 0.0 {
            1.0 + other.root / self.root
        } else {
            0.0
        };
        [self.along * factor, (self.along + self.about) * factor]
    }
}

impl Alone {
    /// Critical step [s] where it has this overlap over radius.
    fn critical_step(&self, law: &Chosen, overlap_ratio: f64) -> f64 {
        let spring = Spring {
            constant: self.constant,
            shear_ratio: self.shear_ratio,
            overlap: overlap_ratio * self.radius,
            reach: 2.0 * self.radius,
        };
        let [normal, shear] = (law.tangents)(&spring);
        let scale = (law.dashpot)(&spring);
        let [normal_dashpot, shear_dashpot] = self.dashpots.map(|dashpot| scale * dashpot);
        let turning = shear * self.turning_ratio;
        let turning_dashpot = shear_dashpot + scale * self.turning_dashpot;
        let [along, about] = self.mobility;
        critical_step(
            (normal.max(shear) * along).max(turning * about),
            (normal_dashpot.max(shear_dashpot) * along).max(turning_dashpot * about),
        )
    }
}

/// The candidates of a patch, one after the other.
#[derive(Debug)]
pub(super) struct Candidates<'a> {
    pub(super) law: &'a Chosen,
    pub(super) model: &'a Model,
    least: f64,
    found: Option<Alone>,
}

impl<'a> Candidates<'a> {
    pub(super) fn new(law: &'a Chosen, model: &'a Model) -> Self {
        Self {
            law,
            model,
            least: f64::INFINITY,
            found: None,
        }
    }

    /// A candidate between two bodies, the smaller of which has this radius [m].
    pub(super) fn add(
        &mut self,
        bodies: [u32; 2],
        own: &Mobility,
        other: &Other,
        radius: f64,
        springs: &Springs,
    ) {
        let (is_first, mobility) = match other {
            Other::Body(other) => {
                let (own, other) = (own.beside(other), other.beside(own));
                let most = [0, 1].map(|way: usize| own[way].max(other[way]));
                (own[1] >= other[1], most)
            }
            Other::Wall(wall) => (own.along >= *wall, own.at_wall(*wall)),
        };
        let is_rough = f64::from(u8::from(self.model.is_rough));
        let larger = |[rolling, twisting]: [f64; 2]| rolling.max(twisting);
        let turning = larger(springs.resistance.stiffness);
        let dashpot = larger(springs.resistance.dashpots);
        let square = radius * radius;
        let alone = Alone {
            bodies: if is_first {
                bodies
            } else {
                [bodies[1], bodies[0]]
            },
            constant: springs.normal,
            shear_ratio: is_rough * springs.ratio,
            turning_ratio: 1.0 + turning / (springs.normal * springs.ratio * square),
            dashpots: [springs.dashpots[0], is_rough * springs.dashpots[1]],
            turning_dashpot: 0.5 * dashpot / square,
            radius,
            mobility,
        };
        let step = alone.critical_step(self.law, COMPARED_AT);
        // the lower numbers where several are alike
        let key = (step, alone.bodies);
        let is_less = self
            .found
            .is_none_or(|found| key < (self.least, found.bodies));
        if step.is_finite() && is_less {
            (self.least, self.found) = (step, Some(alone));
        }
    }

    pub(super) fn shortest(&self) -> Shortest {
        Shortest {
            alone: self.found,
            ..Shortest::default()
        }
    }
}

impl Seen {
    /// A step of Δt [s] of a patch whose contacts were so deep.
    pub(super) fn see(
        &mut self,
        law: &Chosen,
        deepest: Deepest,
        shortest: &mut Shortest,
        time_step: f64,
    ) {
        let overlap_ratio = deepest.ratio;
        self.overlap_ratio = self.overlap_ratio.max(overlap_ratio);
        let asked = [overlap_ratio, time_step];
        #[allow(clippy::float_cmp, reason = "what was asked before, or not")]
        let is_known = shortest.asked == asked;
        if is_known {
            return;
        }
        shortest.asked = asked;
        if let Some(alone) = shortest.alone.filter(|_| overlap_ratio > 0.0) {
            let critical = alone.critical_step(law, overlap_ratio);
            let ratio = time_step / critical;
            if ratio > self.step_ratio {
                self.step_ratio = ratio;
                self.critical = Some((critical, alone.bodies));
            }
        }
    }
}
