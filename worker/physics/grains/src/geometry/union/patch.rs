//! Moments of the part of a unit sphere that a set of caps leaves uncovered.
//!
//! A cap with axis d and height h is {n : n·d > h}; its circle has radius s = √(1 − h²) and the
//! points n(α) = h d + s (cos α e + sin α f) with e, f, d right-handed. The patch is bounded by the
//! arcs of these circles that lie in no other cap. With ν the outward normal of the patch within
//! the sphere, ν ds = (d − h n) dα, and the Laplacian on the sphere,
//!   Δ n = −2 n,   Δ n nᵀ = 2·1 − 6 n nᵀ,   Δ n_a n_b n_c = 2 (δ_ab n_c + δ_bc n_a + δ_ca n_b) − 12 n_a n_b n_c,
//! the divergence theorem ∫ Δp dΩ = ∮ ∂p/∂ν ds turns every moment into the area and integrals of
//! trigonometric polynomials along the arcs:
//!   ∫ n dΩ     = −1/2 ∮ (d − h n) dα
//!   ∫ n nᵀ dΩ  = 1/6 (2A 1 − ∮ (d nᵀ + n dᵀ − 2h n nᵀ) dα), the third moment likewise.
//! The area itself is the integral of the form (1 − z) dφ about a pole z, which on a circle is
//!   (−h + (h + d_z)/(1 + h d_z + s e_z cos α)) dα, e in the plane of d and z,
//! with a closed antiderivative; it is singular in −z only, which adds 4π when −z is uncovered.
//!
//! A patch needs no topology this way: no loops are joined, no holes counted, and an arc whose ends
//! are off by round-off moves the result by round-off.
use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};

/// Circles whose axes are closer than this [rad] are not crossed: at an angle ψ round-off moves
/// their crossings by 1e-16/ψ, and three such circles may then disagree about who is outermost.
/// Taking them as concentric moves the patch by ψ. Both are smallest together at 1e-8.
const PARALLEL: f64 = 1e-8;
/// A pole this far from every circle [-] is good enough.
const CLEAR_OF_CIRCLES: f64 = 0.1;
/// Directions tried as poles.
const POLES: u32 = 24;

/// What another sphere covers of the unit sphere: {n : n·axis > height}.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cap {
    axis: Vector3<f64>,
    height: f64,
    /// Radius of its circle.
    radius: f64,
}

/// How the circles of two caps lie.
enum Relation {
    /// Their circles cross.
    Crossing {
        /// Half the chord between the crossings, times the sine of the angle between the axes.
        half_chord: f64,
        /// Cross product of the axes, larger cap × smaller cap.
        normal: Vector3<f64>,
    },
    /// Neither circle lies in the other cap.
    Apart,
    /// The second cap lies in the first.
    Inside,
    /// Together they cover the sphere.
    Covering,
}

impl Cap {
    /// The cap, unless it is so small that its circle is a point.
    pub(super) fn new(axis: Vector3<f64>, height: f64) -> Option<Self> {
        let squared = (1.0 - height) * (1.0 + height);
        (squared > 0.0).then(|| Self {
            axis,
            height,
            radius: squared.sqrt(),
        })
    }

    /// How far the middle of this cap's circle lies in another cap: h c − h_j with c = d·d_j,
    /// without the cancellation of small caps side by side.
    fn middle_above(&self, other: &Self) -> f64 {
        let cosine_deficit = 0.5 * (self.axis - other.axis).norm_squared();
        (self.height - other.height) - self.height * cosine_deficit
    }

    /// Relation to a cap of the same size or smaller.
    fn relation_to(&self, smaller: &Self) -> Relation {
        let normal = self.axis.cross(&smaller.axis);
        let sine = normal.norm();
        let inwards = smaller.middle_above(self);
        if sine <= PARALLEL {
            // back to back, a gap that narrow is none
            return match (self.axis.dot(&smaller.axis) > 0.0, inwards >= -PARALLEL) {
                (true, _) => Relation::Inside,
                (false, true) => Relation::Covering,
                (false, false) => Relation::Apart,
            };
        }
        // half the chord × sine = √(s_k² sin² − (h_j − h_k c)²)
        let reach = smaller.radius * sine;
        let squared = (reach - inwards) * (reach + inwards);
        if squared > 0.0 {
            let half_chord = squared.sqrt();
            return Relation::Crossing { half_chord, normal };
        }
        match (inwards >= 0.0, self.middle_above(smaller) >= 0.0) {
            (false, _) => Relation::Apart,
            (true, false) => Relation::Inside,
            (true, true) => Relation::Covering,
        }
    }
}

/// Moments of a patch of the unit sphere over the solid angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// ∫ dΩ.
    pub(super) area: f64,
    /// ∫ n dΩ.
    pub(super) first: Vector3<f64>,
    /// ∫ n nᵀ dΩ.
    pub(super) second: Matrix3<f64>,
    /// ∫ n nᵀ (n·along) dΩ.
    pub(super) third_along: Matrix3<f64>,
}

impl Patch {
    const NOTHING: Self = Self {
        area: 0.0,
        first: Vector3::new(0.0, 0.0, 0.0),
        second: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        third_along: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// The patch that `caps` leave, which are put in order on the way.
    pub(super) fn uncovered_by(caps: &mut Vec<Cap>, along: &Vector3<f64>) -> Self {
        if !keep_outermost(caps) {
            return Self::NOTHING;
        }
        let (pole, is_antipole_uncovered) = clear_pole(caps);
        let mut boundary = Boundary::default();
        let mut covered = Vec::new();
        for (index, cap) in caps.iter().enumerate() {
            let circle = Circle::new(cap, &pole);
            if !circle.collect_covered(caps, index, &mut covered) {
                continue;
            }
            // the gaps between the covered intervals
            covered.sort_unstable_by(|first: &[f64; 2], second| first[0].total_cmp(&second[0]));
            let mut from = -PI;
            for &[start, end] in &covered {
                if start > from {
                    boundary.add(&circle.arc(from, start, along));
                }
                from = from.max(end);
            }
            if from < PI {
                boundary.add(&circle.arc(from, PI, along));
            }
        }
        boundary.patch(is_antipole_uncovered, along)
    }
}

/// Leaves only caps that lie in no other, largest first; false when two of them cover the sphere.
fn keep_outermost(caps: &mut Vec<Cap>) -> bool {
    caps.sort_by(|first, second| first.height.total_cmp(&second.height));
    let mut kept = 0;
    for candidate in 0..caps.len() {
        let cap = caps[candidate];
        let mut is_inside = false;
        for outer in &caps[..kept] {
            match outer.relation_to(&cap) {
                Relation::Covering => return false,
                Relation::Inside => is_inside = true,
                Relation::Crossing { .. } | Relation::Apart => {}
            }
        }
        if !is_inside {
            caps[kept] = cap;
            kept += 1;
        }
    }
    caps.truncate(kept);
    true
}

/// A pole z whose opposite is far from every circle, and whether that opposite is uncovered.
fn clear_pole(caps: &[Cap]) -> (Vector3<f64>, bool) {
    let mut best = (f64::NEG_INFINITY, Vector3::z(), true);
    for number in 0..POLES {
        // a spiral of even density: no direction a regular arrangement prefers
        let height = 1.0 - (2.0 * f64::from(number) + 1.0) / f64::from(POLES);
        let angle = f64::from(number) * PI * (3.0 - 5.0_f64.sqrt());
        let ring = (1.0 - height * height).sqrt();
        let antipole = Vector3::new(ring * angle.cos(), ring * angle.sin(), height);
        let mut clearance = f64::INFINITY;
        let mut is_uncovered = true;
        for cap in caps {
            let above = antipole.dot(&cap.axis) - cap.height;
            clearance = clearance.min(above.abs());
            is_uncovered &= above <= 0.0;
        }
        if clearance > best.0 {
            best = (clearance, -antipole, is_uncovered);
        }
        if clearance > CLEAR_OF_CIRCLES {
            break;
        }
    }
    (best.1, best.2)
}

/// The circle of a cap, with α = 0 on the side of the pole.
struct Circle<'a> {
    cap: &'a Cap,
    /// d·z of axis and pole.
    axis_along_pole: f64,
    /// e·z, at least 0; f·z = 0.
    zero_along_pole: f64,
    zero: Vector3<f64>,
    quarter: Vector3<f64>,
}

impl<'a> Circle<'a> {
    fn new(cap: &'a Cap, pole: &Vector3<f64>) -> Self {
        let axis_along_pole = cap.axis.dot(pole);
        let sideways = pole - cap.axis * axis_along_pole;
        let zero_along_pole = sideways.norm();
        // where axis and pole coincide, every direction is at the same height
        let (zero, zero_along_pole) = if zero_along_pole > f64::EPSILON {
            (sideways / zero_along_pole, zero_along_pole)
        } else {
            let across = cap.axis.cross(&Vector3::ith(cap.axis.iamin(), 1.0));
            (across.normalize(), 0.0)
        };
        // once more at right angles to the axis, for what the first difference left of a short one
        let zero = (zero - cap.axis * cap.axis.dot(&zero)).normalize();
        Self {
            cap,
            axis_along_pole,
            zero_along_pole,
            zero,
            quarter: cap.axis.cross(&zero),
        }
    }

    /// Collects the intervals of α in [−π, π] inside other caps; false when all of it is.
    fn collect_covered(&self, caps: &[Cap], index: usize, covered: &mut Vec<[f64; 2]>) -> bool {
        covered.clear();
        for (other_index, other) in caps.iter().enumerate() {
            if other_index == index {
                continue;
            }
            // both circles of a pair take the same numbers, or their arcs would not meet
            let relation = if other_index < index {
                other.relation_to(self.cap)
            } else {
                self.cap.relation_to(other)
            };
            let (half_chord, normal) = match relation {
                Relation::Crossing { half_chord, normal } if other_index < index => {
                    (half_chord, -normal)
                }
                Relation::Crossing { half_chord, normal } => (half_chord, normal),
                Relation::Apart => continue,
                // not between caps that have been sorted out
                Relation::Inside | Relation::Covering => return false,
            };
            // covered where cos(α − middle) > (h_k − h_j c)/(s_j sin)
            let middle = (-normal.dot(&self.zero)).atan2(normal.dot(&self.quarter));
            let half = half_chord.atan2(-self.cap.middle_above(other));
            let (start, end) = (middle - half, middle + half);
            if start < -PI {
                covered.push([start + TAU, PI]);
            }
            if end > PI {
                covered.push([-PI, end - TAU]);
            }
            covered.push([start.max(-PI), end.min(PI)]);
        }
        true
    }

    /// ∫ (1 − z) dφ from α = 0.
    fn area_form(&self, angle: f64) -> f64 {
        let Cap { height, radius, .. } = *self.cap;
        let (sine, cosine) = (0.5 * angle).sin_cos();
        let rise = height + self.axis_along_pole;
        let sum = 1.0 + height * self.axis_along_pole + radius * self.zero_along_pole;
        2.0 * (rise * sine).atan2(sum * cosine) - height * angle
    }

    fn arc(&self, from: f64, to: f64, along: &Vector3<f64>) -> Arc {
        let (d, e, f) = (&self.cap.axis, &self.zero, &self.quarter);
        let (h, s) = (self.cap.height, self.cap.radius);
        let ((sin_from, cos_from), (sin_to, cos_to)) = (from.sin_cos(), to.sin_cos());
        let cubes = (sin_to.powi(3) - sin_from.powi(3)) / 3.0;
        let cosine_cubes = (cos_to.powi(3) - cos_from.powi(3)) / 3.0;
        // integrals of cosⁱ sinʲ
        let length = to - from;
        let c = sin_to - sin_from;
        let s1 = cos_from - cos_to;
        let cc = 0.5 * (length + sin_to * cos_to - sin_from * cos_from);
        let cs = 0.5 * (sin_to * sin_to - sin_from * sin_from);
        let ss = length - cc;
        let (ccc, ccs, css, sss) = (c - cubes, -cosine_cubes, cubes, s1 + cosine_cubes);

        let sideways = e * c + f * s1;
        let first = d * (h * length) + sideways * s;
        let symmetric = |a: &Vector3<f64>, b: &Vector3<f64>| a * b.transpose() + b * a.transpose();
        let (axial, mixed) = (d * d.transpose(), symmetric(e, f));
        let (ee, ff) = (e * e.transpose(), f * f.transpose());
        let second = axial * (h * h * length)
            + symmetric(d, &sideways) * (h * s)
            + (ee * cc + mixed * cs + ff * ss) * (s * s);
        // ∫ n nᵀ (n·along) dα
        let (d_along, e_along, f_along) = (d.dot(along), e.dot(along), f.dot(along));
        let sideways_along = e * (cc * e_along + cs * f_along) + f * (cs * e_along + ss * f_along);
        let third = second * (h * d_along)
            + (axial * (h * h * (c * e_along + s1 * f_along))
                + symmetric(d, &sideways_along) * (h * s)
                + (ee * (ccc * e_along + ccs * f_along)
                    + mixed * (ccs * e_along + css * f_along)
                    + ff * (css * e_along + sss * f_along))
                    * (s * s))
                * s;
        Arc {
            area_form: self.area_form(to) - self.area_form(from),
            first: d * length - first * h,
            second: symmetric(d, &first) - second * (2.0 * h),
            third_along: symmetric(d, &(second * along)) + second * d_along - third * (3.0 * h),
        }
    }
}

/// Integrals along an arc.
struct Arc {
    /// ∫ (1 − z) dφ, counter-clockwise about the cap.
    area_form: f64,
    /// ∮ ∂n/∂ν ds, and so on.
    first: Vector3<f64>,
    second: Matrix3<f64>,
    third_along: Matrix3<f64>,
}

/// Sums over the arcs of a patch.
#[derive(Default)]
struct Boundary {
    area_form: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
    third_along: Matrix3<f64>,
}

impl Boundary {
    fn add(&mut self, arc: &Arc) {
        self.area_form += arc.area_form;
        self.first += arc.first;
        self.second += arc.second;
        self.third_along += arc.third_along;
    }

    fn patch(&self, is_antipole_uncovered: bool, along: &Vector3<f64>) -> Patch {
        let whole = if is_antipole_uncovered {
            2.0 * TAU
        } else {
            0.0
        };
        // the patch lies to the right of its arcs
        let area = whole - self.area_form;
        let first = self.first * -0.5;
        let isotropic = Matrix3::from_diagonal_element(2.0 * area);
        let mixed = first * along.transpose();
        let linear = Matrix3::from_diagonal_element(first.dot(along)) + mixed + mixed.transpose();
        Patch {
            area,
            first,
            second: (isotropic - self.second) / 6.0,
            third_along: (linear * 2.0 - self.third_along) / 12.0,
        }
    }
}
