//! Circles that press against deformed faces: an energy, its forces and its tangent.
//!
//! A face is a line of straight segments between its particles, wherever these have gone. Its
//! distance to a circle of radius R about c obeys, segment by segment,
//!
//! g = min over s in 0..1 of |x₁ + s (x₂ - x₁) - c| - R ≥ 0,  N ≥ 0,  N g = 0   (9)
//!
//! with the force N along the normal of the circle at the nearest point. So the place of contact moves
//! along the face and around the roller, from segment to segment, and the resultant of a roller
//! passes through its axis: it has no friction. (9) is reached as the augmented Lagrangian
//! [SimoLaursen1992] has it,
//!
//! Π = … + Σ ⟨p - κ g⟩² / (2κ),  N = ⟨p - κ g⟩,  p ← N until g vanishes where N does not   (10)
//!
//! with ⟨·⟩ for the positive part: p is the force that is known so far, and κ only decides how fast
//! it is found.
use crate::matrix::GridMatrix;

/// Stiffness κ over that of a cell: stiffer ones need fewer rounds, each of them with more steps.
const STIFFER: f64 = 4.0;
/// Springs that keep what nothing touches yet, over κ; in the tangent only, so that they decide
/// nothing but the way.
const SOFT: f64 = 1e-9;

/// A roller's circle and the face that it lies against.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Circle {
    pub(crate) radius_mm: f64,
    /// How far it has gone along `inward` from where it just touches the undeformed face [mm].
    pub(crate) advance_mm: f64,
    /// Inward normal of the undeformed face.
    pub(crate) inward: [f64; 2],
    /// Along the undeformed face.
    pub(crate) along: [f64; 2],
    /// Particles of the face from one end to the other, with their undeformed places along it, from
    /// the roller's [mm].
    pub(crate) face: Vec<(usize, f64)>,
    /// Turns the way along the face into the inward normal: 1 to its left, -1 to its right.
    pub(crate) left: f64,
    /// p of every segment [N].
    pub(crate) pressing: Vec<f64>,
}

/// All circles in the way of a section; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Circles {
    pub(crate) all: Vec<Circle>,
    /// κ [N/mm].
    pub(crate) stiffness: f64,
}

/// Where a segment is nearest to a circle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    /// From its first particle to its second, 0 to 1.
    pub(crate) share: f64,
    /// g [mm].
    pub(crate) gap: f64,
    /// From the axis to the nearest point.
    pub(crate) normal: [f64; 2],
    length: f64,
    /// Whether the foot of the axis lies within the segment.
    is_inside: bool,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Circle {
    pub(crate) fn segments(&self) -> usize {
        self.face.len() - 1
    }

    /// The two particles of a segment.
    pub(crate) fn ends(&self, segment: usize) -> [usize; 2] {
        [self.face[segment].0, self.face[segment + 1].0]
    }

    /// Gaps are told from displacements, not from places: of a beam that has hardly bent, too, they
    /// must be known better than to a place's round-off.
    pub(crate) fn nearest(&self, segment: usize, u: &[f64]) -> Nearest {
        let radius = self.radius_mm;
        let ends = [self.face[segment], self.face[segment + 1]];
        // of both ends, what they have moved against the axis
        let [first, second] = ends.map(|(particle, _)| {
            [0, 1].map(|axis| u[2 * particle + axis] - self.advance_mm * self.inward[axis])
        });
        let side = ends[1].1 - ends[0].1;
        let along = [0, 1].map(|axis| side * self.along[axis] + (second[axis] - first[axis]));
        let length = along[0].hypot(along[1]);
        let from = |end: usize, moved: [f64; 2]| {
            [0, 1].map(|axis| {
                ends[end].1 * self.along[axis] + radius * self.inward[axis] + moved[axis]
            })
        };
        let foot = -dot(from(0, first), along) / (length * length);
        if (0.0..=1.0).contains(&foot) {
            // signed: a face beyond the axis is not outside of the circle
            let normal = [-along[1], along[0]].map(|part| self.left * part / length);
            let lean = dot(normal, self.along);
            let upright = dot(normal, self.inward);
            // n · n₀ - 1 without cancellation
            let fallen = if upright > 0.0 {
                -lean * lean / (1.0 + upright)
            } else {
                upright - 1.0
            };
            return Nearest {
                share: foot,
                gap: lean * ends[0].1 + radius * fallen + dot(normal, first),
                normal,
                length,
                is_inside: true,
            };
        }
        let end = usize::from(foot > 1.0);
        let moved = [first, second][end];
        let point = from(end, moved);
        let distance = point[0].hypot(point[1]);
        // (|x|² - R²) / (|x| + R)
        let undeformed =
            [0, 1].map(|axis| 2.0 * (ends[end].1 * self.along[axis] + radius * self.inward[axis]));
        let square = ends[end].1 * ends[end].1 + dot(undeformed, moved) + dot(moved, moved);
        Nearest {
            share: end as f64,
            gap: square / (distance + radius),
            normal: point.map(|part| part / distance),
            length,
            is_inside: false,
        }
    }

    /// N of (10) [N].
    pub(crate) fn force(&self, segment: usize, nearest: &Nearest, stiffness: f64) -> f64 {
        (self.pressing[segment] - stiffness * nearest.gap).max(0.0)
    }
}

impl Circles {
    pub(crate) fn new(all: Vec<Circle>, cell_stiffness: f64) -> Self {
        Self {
            all,
            stiffness: STIFFER * cell_stiffness,
        }
    }

    /// Whether a circle holds up an end of its face.
    pub(crate) fn holds_an_end(&self, u: &[f64]) -> bool {
        self.all.iter().any(|circle| {
            let last = circle.segments() - 1;
            [(0, 0.0), (last, 1.0)].into_iter().any(|(segment, end)| {
                let nearest = circle.nearest(segment, u);
                let is_at_end = (nearest.share - end).abs() < f64::EPSILON;
                is_at_end && circle.force(segment, &nearest, self.stiffness) > 0.0
            })
        })
    }

    /// Energy of (10) [N mm] at displacements u [mm]; takes its forces from those that hold the
    /// section there [N], and tells the largest of them.
    pub(crate) fn press(&self, u: &[f64], forces: &mut [f64]) -> (f64, f64) {
        let (mut energy, mut largest) = (0.0, 0.0_f64);
        for circle in &self.all {
            for segment in 0..circle.segments() {
                let nearest = circle.nearest(segment, u);
                let force = circle.force(segment, &nearest, self.stiffness);
                if force <= 0.0 {
                    continue;
                }
                energy += force * force / (2.0 * self.stiffness);
                largest = largest.max(force);
                let shares = [1.0 - nearest.share, nearest.share];
                for (particle, share) in circle.ends(segment).into_iter().zip(shares) {
                    for axis in 0..2 {
                        forces[2 * particle + axis] -= share * force * nearest.normal[axis];
                    }
                }
            }
        }
        (energy, largest)
    }

    /// Adds the tangent of (10) [N/mm]; without its part by which the normal turns, where that could
    /// make it negative, unless it is to be `exact`.
    pub(crate) fn stiffen(&self, u: &[f64], exact: bool, matrix: &mut GridMatrix) {
        for circle in &self.all {
            let mut closest: Option<(usize, f64)> = None;
            for segment in 0..circle.segments() {
                let nearest = circle.nearest(segment, u);
                if closest.is_none_or(|(_, gap)| nearest.gap < gap) {
                    closest = Some((segment, nearest.gap));
                }
                let reach = circle.pressing[segment] - self.stiffness * nearest.gap;
                // what just touches counts, so that a section may begin to lean on it
                if reach >= 0.0 {
                    let part = self.tangent(circle, &nearest, reach, exact);
                    matrix.add_pair(circle.ends(segment), &part);
                }
            }
            if let Some((segment, _)) = closest {
                let mut soft = [[0.0; 4]; 4];
                for (place, row) in soft.iter_mut().enumerate() {
                    row[place] = SOFT * self.stiffness;
                }
                matrix.add_pair(circle.ends(segment), &soft);
            }
        }
    }

    /// κ ∂g ∂gᵀ - N ∂²g over both particles of a segment.
    ///
    /// With τ the displacement of the nearest point along the segment, δθ the segment's turn and d the
    /// distance of the axis: ∂²g = -2 δθ τ - d δθ² within a segment, τ²/d at a particle.
    fn tangent(
        &self,
        circle: &Circle,
        nearest: &Nearest,
        force: f64,
        exact: bool,
    ) -> [[f64; 4]; 4] {
        let normal = nearest.normal;
        let along = [normal[1], -normal[0]].map(|part| circle.left * part);
        let shares = [1.0 - nearest.share, nearest.share];
        let spread = |direction: [f64; 2], weights: [f64; 2]| {
            let [first, second] = weights;
            [
                first * direction[0],
                first * direction[1],
                second * direction[0],
                second * direction[1],
            ]
        };
        let opening = spread(normal, shares);
        let sliding = spread(along, shares);
        let distance = nearest.gap + circle.radius_mm;
        // with the inward normal to the left of the way along, a turn lifts the second particle
        let over = circle.left / nearest.length;
        let turning = spread(normal, [-over, over]);
        let mut matrix = [[0.0; 4]; 4];
        for (row, line) in matrix.iter_mut().enumerate() {
            for (column, value) in line.iter_mut().enumerate() {
                *value += self.stiffness * opening[row] * opening[column];
                if nearest.is_inside {
                    *value += force * distance * turning[row] * turning[column];
                    if exact {
                        let mixed = turning[row] * sliding[column] + sliding[row] * turning[column];
                        *value += circle.left * force * mixed;
                    }
                } else if exact {
                    *value -= force * sliding[row] * sliding[column] / distance;
                }
            }
        }
        matrix
    }

    /// The largest gap or overlap [mm] by which (9) is missed.
    ///
    /// Forces of neighbouring segments that touch near their common particle are hardly told apart, and
    /// need not be: how far they are from settling says nothing.
    pub(crate) fn missed_mm(&self, u: &[f64]) -> f64 {
        let mut missed = 0.0_f64;
        for circle in &self.all {
            for segment in 0..circle.segments() {
                let force = circle.force(segment, &circle.nearest(segment, u), self.stiffness);
                missed = missed.max((force - circle.pressing[segment]).abs() / self.stiffness);
            }
        }
        missed
    }

    /// Takes the forces of (10) as known.
    pub(crate) fn augment(&mut self, u: &[f64]) {
        let stiffness = self.stiffness;
        for circle in &mut self.all {
            for segment in 0..circle.segments() {
                let nearest = circle.nearest(segment, u);
                circle.pressing[segment] = circle.force(segment, &nearest, stiffness);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two segments of a bottom face over a circle, somewhat askew.
    fn circle(left: f64, pressing: f64) -> Circle {
        Circle {
            radius_mm: 1.15,
            advance_mm: 0.05,
            inward: [0.0, left],
            along: [1.0, 0.0],
            face: vec![(0, -0.9), (1, 0.1), (2, 1.1)],
            left,
            pressing: vec![pressing; 2],
        }
    }

    #[test]
    fn forces_and_tangent_are_derivatives_of_the_energy() {
        for left in [1.0, -1.0] {
            // the middle particle outside of both feet, and feet within both segments
            for lift in [0.02, -0.05] {
                let circles = Circles::new(vec![circle(left, 0.3)], 2.0);
                let u = [0.01, -0.02, 0.03, left * lift, -0.02, 0.04];
                let forces = |u: &[f64]| {
                    let mut forces = vec![0.0; 6];
                    let (energy, _) = circles.press(u, &mut forces);
                    (energy, forces)
                };
                let (energy, found) = forces(&u);
                assert!(energy > 0.0);
                let mut matrix = GridMatrix::zeros(3, 1);
                circles.stiffen(&u, true, &mut matrix);
                let step = 1e-6;
                for place in 0..6 {
                    let moved = |by: f64| {
                        let mut moved = u;
                        moved[place] += by;
                        forces(&moved)
                    };
                    let (up, down) = (moved(step), moved(-step));
                    // what is taken from the forces that hold is the energy's derivative
                    let slope = (up.0 - down.0) / (2.0 * step);
                    assert!((slope - found[place]).abs() < 1e-7, "{slope} {found:?}");
                    let mut unit = vec![0.0; 6];
                    unit[place] = 1.0;
                    let mut column = vec![0.0; 6];
                    matrix.multiply(&unit, &mut column);
                    for (row, value) in column.iter().enumerate() {
                        let slope = (up.1[row] - down.1[row]) / (2.0 * step);
                        assert!(
                            (slope - value).abs() < 1e-5,
                            "{left} {lift} {row} {place}: {slope} {}",
                            value
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_force_between_two_particles_is_shared_by_its_place() {
        // the axis stands three quarters along the first segment
        let mut circle = circle(1.0, 0.0);
        circle.face = vec![(0, -0.75), (1, 0.25), (2, 1.25)];
        circle.advance_mm = 0.15;
        let circles = Circles::new(vec![circle], 1.0);
        let mut forces = vec![0.0; 6];
        circles.press(&[0.0; 6], &mut forces);
        // g = 1 - 1.15, N = κ 0.15 with κ = 4; the second segment's own end is √(1 + 0.25²) away
        let n = 4.0 * 0.15;
        let end = 1.0_f64.hypot(0.25);
        let other = 4.0 * (1.15 - end);
        assert!((forces[1] + 0.25 * n).abs() < 1e-12);
        assert!((forces[3] + 0.75 * n + other / end).abs() < 1e-12);
        assert!((forces[2] + other * 0.25 / end).abs() < 1e-12);
    }
}
