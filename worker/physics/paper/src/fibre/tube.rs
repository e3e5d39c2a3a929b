//! The tube of points and springs that stands for a fibre, straight, curled to an arc, or along any line.
//!
//! Point j of ring i is number i N + j. The chord of a straight or curled tube lies along x and its arc in the plane of x
//! and y; a straight tube has its rings at x = i l and point j at the angle 2πj/N
//! from y. All springs are at rest as generated.
use std::f64::consts::{PI, TAU};

use loadframe_api::fibre::ring_centres;
use nalgebra::Vector3;

use super::{Divided, FibreError, Segment, Springs};

/// Which of the springs of [`super::springs`] one is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    Along,
    Around,
    Diagonal,
    Across,
    Second,
}

/// A spring between two points, the lower one first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    pub points: [u32; 2],
    pub sort: Sort,
    pub stiffness_mn_per_um: f64,
    pub rest_um: f64,
}

/// Where a ring lies: from its centre up to point 0, and across that.
struct Ring {
    centre: Vector3<f64>,
    up: Vector3<f64>,
    across: Vector3<f64>,
}

/// Points, their masses, and springs.
#[derive(Debug, Clone)]
pub struct Tube {
    segment: Segment,
    segments: usize,
    places_um: Vec<[f64; 3]>,
    springs: Vec<Spring>,
}

impl Tube {
    /// A straight tube.
    pub fn straight(segments: usize, segment: &Segment, springs: &Springs) -> Self {
        Self::along(segments, segment, springs, 0.0)
    }

    /// The tube of a fibre whose chord is `shape_factor` times its length.
    ///
    /// # Errors
    /// Those of [`half_angle`].
    pub fn curled(divided: &Divided, shape_factor: f64) -> Result<Self, FibreError> {
        let half_angle = half_angle(shape_factor)?;
        Ok(Self::along(
            divided.segments,
            &divided.segment,
            &divided.springs,
            half_angle,
        ))
    }

    /// Equal segments, each turned against the one before by θ = 2 ψ/n, and rings halfway between:
    /// (1) and (7) of the patent, with the turns placed evenly about the middle.
    fn along(segments: usize, segment: &Segment, springs: &Springs, half_angle: f64) -> Self {
        let turn = 2.0 * half_angle / segments as f64;
        let mut rings = Vec::with_capacity(segments + 1);
        let mut centre = [0.0, 0.0];
        for ring in 0..=segments {
            let (sine, cosine) = (half_angle - ring as f64 * turn).sin_cos();
            rings.push(Ring {
                centre: Vector3::new(centre[0], centre[1], 0.0),
                up: Vector3::new(-sine, cosine, 0.0),
                across: Vector3::z(),
            });
            let (sine, cosine) = (half_angle - (ring as f64 + 0.5) * turn).sin_cos();
            centre[0] += segment.length_um() * cosine;
            centre[1] += segment.length_um() * sine;
        }
        Self::of_rings(&rings, segment, springs)
    }

    /// The tube of a fibre along a line: rings at equal arc lengths, across the bisector of the chords that meet there,
    /// each turned from the one before by the smallest rotation, which does not twist the fibre. On the first ring point 0
    /// is the one that lies most to the left, seen along the fibre in the plane of x and y.
    ///
    /// # Errors
    /// Those of [`ring_centres`].
    pub fn along_line(line_um: &[[f64; 3]], divided: &Divided) -> Result<Self, FibreError> {
        let centres = ring_centres(line_um, divided.segments, &divided.segment)?;
        let centres: Vec<Vector3<f64>> = centres.into_iter().map(Vector3::from).collect();
        let chord = |segment: usize| (centres[segment + 1] - centres[segment]).normalize();
        let last = divided.segments - 1;
        let mut normal = chord(0);
        let up = Vector3::z().cross(&normal);
        // a fibre that stands upright lies to no side
        let mut up = up.try_normalize(1e-6).unwrap_or_else(Vector3::y);
        up = (up - normal * normal.dot(&up)).normalize();
        let mut rings = Vec::with_capacity(centres.len());
        for (ring, &centre) in centres.iter().enumerate() {
            // of two chords, where there are
            let sum = chord(ring.saturating_sub(1)) + chord(ring.min(last));
            let next = sum.normalize();
            // the smallest rotation from n to n': u' = u - (n'·u) (n + n')/(1 + n·n'), for u across n
            up -= (normal + next) * (next.dot(&up) / (1.0 + normal.dot(&next)));
            up = (up - next * next.dot(&up)).normalize();
            normal = next;
            rings.push(Ring {
                centre,
                up,
                across: normal.cross(&up),
            });
        }
        Ok(Self::of_rings(&rings, &divided.segment, &divided.springs))
    }

    fn of_rings(rings: &[Ring], segment: &Segment, springs: &Springs) -> Self {
        let (count, radius) = (segment.points_on_ring(), segment.diameter_um() / 2.0);
        let mut places = Vec::with_capacity(rings.len() * count);
        for ring in rings {
            for point in 0..count {
                let (across, up) = (TAU * point as f64 / count as f64).sin_cos();
                let arm = ring.up * radius * up + ring.across * radius * across;
                places.push((ring.centre + arm).into());
            }
        }
        let segments = rings.len() - 1;
        let mut tube = Self {
            segment: *segment,
            segments,
            places_um: places,
            springs: Vec::new(),
        };
        tube.join(springs);
        tube
    }

    fn join(&mut self, springs: &Springs) {
        let count = self.segment.points_on_ring();
        let number = |ring: usize, point: usize| ring * count + point % count;
        for ring in 0..=self.segments {
            let is_end = usize::from(ring == 0 || ring == self.segments);
            for point in 0..count {
                let own = number(ring, point);
                self.push(
                    Sort::Around,
                    own,
                    number(ring, point + 1),
                    springs.around[is_end],
                );
                if springs.second[is_end] > 0.0 {
                    let other = number(ring, point + 2);
                    self.push(Sort::Second, own, other, springs.second[is_end]);
                }
                if point < count / 2 {
                    let other = number(ring, point + count / 2);
                    self.push(Sort::Across, own, other, springs.across[is_end]);
                }
                if ring < self.segments {
                    self.push(Sort::Along, own, number(ring + 1, point), springs.along);
                    for other in [point + 1, point + count - 1] {
                        self.push(
                            Sort::Diagonal,
                            own,
                            number(ring + 1, other),
                            springs.diagonal,
                        );
                    }
                }
            }
        }
    }

    fn push(&mut self, sort: Sort, one: usize, other: usize, stiffness: f64) {
        let (low, high) = (one.min(other), one.max(other));
        self.springs.push(Spring {
            points: [low as u32, high as u32],
            sort,
            stiffness_mn_per_um: stiffness,
            rest_um: distance(self.places_um[low], self.places_um[high]),
        });
    }

    /// Places of all points [µm].
    pub fn places_um(&self) -> &[[f64; 3]] {
        &self.places_um
    }

    /// All springs.
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// The geometry of rings and segments.
    pub fn segment(&self) -> &Segment {
        &self.segment
    }

    /// Segments from end to end; there is one ring more.
    pub fn segments(&self) -> usize {
        self.segments
    }

    /// Points of a ring.
    pub fn ring(&self, ring: usize) -> std::ops::Range<usize> {
        let count = self.segment.points_on_ring();
        ring * count..(ring + 1) * count
    }

    /// Sum of the lengths of all segments [µm].
    pub fn length_um(&self) -> f64 {
        self.segments as f64 * self.segment.length_um()
    }

    /// Mean of a ring's points [µm].
    pub fn centre_um(&self, ring: usize) -> [f64; 3] {
        let points = self.ring(ring);
        let count = points.len() as f64;
        let mut centre = [0.0; 3];
        for point in points {
            for (sum, part) in centre.iter_mut().zip(self.places_um[point]) {
                *sum += part / count;
            }
        }
        centre
    }

    /// From the centre of the first ring to that of the last [µm].
    pub fn chord_um(&self) -> f64 {
        distance(self.centre_um(0), self.centre_um(self.segments))
    }

    /// Mass of every point [µg] at a coarseness [mg/m]: (2) m = c L/(n N), half of it at both ends.
    /// 1 mg/m is 10⁻³ µg/µm.
    pub fn masses_ug(&self, coarseness_mg_per_m: f64) -> Vec<f64> {
        let count = self.segment.points_on_ring();
        let whole = 1e-3 * coarseness_mg_per_m * self.segment.length_um() / count as f64;
        let mut masses = vec![whole; self.places_um.len()];
        for ring in [0, self.segments] {
            for point in self.ring(ring) {
                masses[point] *= 0.5;
            }
        }
        masses
    }
}

/// Half angle ψ [rad] of the arc whose chord is `shape_factor` times its length, sin ψ/ψ = C_f (6):
/// Newton's method from ψ = √(6 (1 - C_f)), kept between bounds.
///
/// # Errors
/// [`FibreError::OutOfRange`] unless 0 < `shape_factor` ≤ 1.
pub fn half_angle(shape_factor: f64) -> Result<f64, FibreError> {
    if !(shape_factor > 0.0 && shape_factor <= 1.0) {
        return Err(FibreError::out_of_range(
            "shape factor",
            "1",
            shape_factor,
            "above 0, at most 1",
        ));
    }
    let excess = |angle: f64| angle.sin() - shape_factor * angle;
    let (mut below, mut above) = (0.0, PI);
    let mut angle = (6.0 * (1.0 - shape_factor)).sqrt();
    for _ in 0..100 {
        let value = excess(angle);
        if value > 0.0 {
            below = angle;
        } else {
            above = angle;
        }
        let step = value / (angle.cos() - shape_factor);
        // at angle 0 both are 0: the fibre is straight
        if !step.is_finite() || step.abs() <= 1e-15 * angle {
            break;
        }
        let next = angle - step;
        angle = if next > below && next < above {
            next
        } else {
            0.5 * (below + above)
        };
    }
    Ok(angle)
}

pub(super) fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| other[axis] - one[axis]);
    (x * x + y * y + z * z).sqrt()
}
