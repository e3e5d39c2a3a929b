//! Which particles touch, found on the condensed lattice.
//!
//! The lattice is condensed on the particles in reach. One factor, with the particle nearest to each
//! roller held, its *anchor*, gives the answer to an advance of every anchor and, when a particle
//! first touches, to a force on it. What touches is then found by an active set, one particle at a
//! time: the one that is pierced most is added, and on the way to the new forces the first that
//! would come to pull is released (non-negative least squares, [LawsonHanson1974], ch. 23). Every
//! set lowers the energy, so none comes twice; adding and releasing all at once takes fewer sets, and
//! was seen to leave a beam without supports on the way. A beam that nothing touches yet is kept by
//! springs on the anchors, softer than anything else, whose ends follow (the proximal point method of
//! [Rockafellar1976]); of the set they lead to the solution without them is taken. A force in place of
//! an advance is one more linear equation.
use nalgebra::{DMatrix, DVector};

use crate::error::CompositeError;
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::matrix::GridMatrix;
use crate::solve::contact::reach::{Point, points, refuse_overlap};
use crate::solve::contact::roller::Roller;
use crate::solve::contact::trial::{ROUND_OFF, Trial, largest};
use crate::solve::equations::{Equations, told};
use crate::solve::equilibrium::StaticOptions;
use crate::supports::Supports;

/// Beyond so many sets for each particle in reach the search is lost to round-off.
const ROUNDS: usize = 20;
/// Springs that keep what nothing touches, over the stiffness of a cell: soft against the bending of
/// the slenderest beam that small displacements make sense for, stiff against round-off.
const SOFT: f64 = 1e-8;
/// How often the ends of the springs may follow.
const FOLLOWED: usize = 30;
/// The lattice as seen from the particles in reach, all along inward normals.
pub(super) struct Condensed<'a> {
    pub(super) lattice: &'a Lattice,
    supports: &'a Supports,
    matrix: GridMatrix,
    equations: Equations,
    /// Which displacements the factor holds.
    anchored: Supports,
    pub(super) points: Vec<Point>,
    /// The point nearest to each roller.
    anchors: Vec<usize>,
    /// Displacements of points and reactions of anchors under load and supports, anchors at 0.
    own: Answer,
    /// The same of an advance of each anchor by 1 mm, all else at rest.
    advanced: Vec<Answer>,
    /// Displacements of points [mm] under 1 N on one of them, once it was asked for.
    pushed: Vec<Option<Vec<f64>>>,
}

struct Answer {
    displacements: Vec<f64>,
    reactions: Vec<f64>,
}

/// Which points touch, and how far the rollers have advanced.
pub(super) struct Touch {
    pub(super) touching: Vec<bool>,
    pub(super) advances: Vec<f64>,
    pub(super) rounds: u64,
}

/// Where the ends of the soft springs stand: on anchors, and on the shared advance [mm].
struct Springs {
    anchors: Vec<f64>,
    advance: f64,
}

impl<'a> Condensed<'a> {
    pub(super) fn new(
        lattice: &'a Lattice,
        supports: &'a Supports,
        load: &[f64],
        rollers: &[Roller],
        options: &StaticOptions,
    ) -> Result<Self, CompositeError> {
        if options.geometry != Geometry::Linear {
            return Err(CompositeError::LargeContact);
        }
        let grid = lattice.grid();
        for roller in rollers {
            roller.checked(grid)?;
        }
        refuse_overlap(rollers)?;
        let points = points(grid, supports, rollers)?;
        let mut anchors = Vec::with_capacity(rollers.len());
        let mut anchored = supports.clone();
        for (place, roller) in rollers.iter().enumerate() {
            let nearest = (0..points.len())
                .filter(|&point| points[point].roller == place)
                .min_by(|&a, &b| points[a].gap_mm.total_cmp(&points[b].gap_mm))
                .ok_or(CompositeError::OutOfRange {
                    quantity: "a roller's radius [mm]",
                    given: roller.radius_mm,
                    allowed: "more than the distance to the nearest particle: refine the grid there",
                })?;
            let displacement = points[nearest].displacement;
            anchored.hold(grid, displacement / 2, displacement % 2, 0.0)?;
            anchors.push(nearest);
        }
        anchored.refuse_rigid_motion(grid)?;
        let mut matrix = lattice.matrix();
        let rest = vec![0.0; lattice.displacements()];
        lattice.tangent(Geometry::Linear, Tangent::Exact, &rest, &mut matrix);
        let equations = Equations::new(options.method, &matrix, grid, &anchored)
            .and_then(|mut equations| equations.prepare(&matrix).map(|()| equations))
            .map_err(|failure| told(failure, grid))?;
        let pushed = vec![None; points.len()];
        let mut condensed = Self {
            lattice,
            supports,
            matrix,
            equations,
            anchored,
            points,
            anchors,
            own: Answer {
                displacements: Vec::new(),
                reactions: Vec::new(),
            },
            advanced: Vec::new(),
            pushed,
        };
        condensed.own = condensed.answer(supports.displacements(), load)?;
        for anchor in 0..rollers.len() {
            let Point {
                displacement,
                inward,
                ..
            } = condensed.points[condensed.anchors[anchor]];
            let mut moved = rest.clone();
            moved[displacement] = inward;
            let answer = condensed.answer(moved, &rest)?;
            condensed.advanced.push(answer);
        }
        Ok(condensed)
    }

    /// Displacements of points and reactions of anchors under a load, with what is held moved.
    fn answer(&mut self, mut u: Vec<f64>, load: &[f64]) -> Result<Answer, CompositeError> {
        let mut forces = vec![0.0; u.len()];
        let mut step = vec![0.0; u.len()];
        self.matrix.multiply(&u, &mut forces);
        for (place, force) in forces.iter_mut().enumerate() {
            *force = if self.anchored.is_held(place) {
                0.0
            } else {
                load[place] - *force
            };
        }
        self.equations
            .solve(&self.matrix, &forces, &mut step)
            .map_err(|failure| told(failure, self.lattice.grid()))?;
        for (u, step) in u.iter_mut().zip(&step) {
            *u += step;
        }
        self.matrix.multiply(&u, &mut forces);
        let reaction = |anchor: &usize| {
            let point = self.points[*anchor];
            point.inward * (forces[point.displacement] - load[point.displacement])
        };
        Ok(Answer {
            displacements: self
                .points
                .iter()
                .map(|point| point.inward * u[point.displacement])
                .collect(),
            reactions: self.anchors.iter().map(reaction).collect(),
        })
    }

    /// Makes sure that the answer to a force on a point is known.
    fn push(&mut self, point: usize) -> Result<(), CompositeError> {
        if self.pushed[point].is_none() {
            let size = self.lattice.displacements();
            let mut load = vec![0.0; size];
            load[self.points[point].displacement] = self.points[point].inward;
            let answer = self.answer(vec![0.0; size], &load)?;
            self.pushed[point] = Some(answer.displacements);
        }
        Ok(())
    }

    /// The active set: rollers of unknown advance share one, at which their forces sum to `force`.
    pub(super) fn settle(
        &mut self,
        advances: &[Option<f64>],
        force: f64,
    ) -> Result<Touch, CompositeError> {
        let limit = (ROUNDS * (1 + self.points.len())) as u64;
        let mut touching = vec![false; self.points.len()];
        let mut forces = vec![0.0; self.points.len()];
        let mut springs = Springs {
            anchors: vec![0.0; self.anchors.len()],
            advance: 0.0,
        };
        let mut rounds = 0;
        for _ in 0..FOLLOWED {
            let settled = loop {
                let next = self.trial(&touching, advances, force, Some(&springs))?;
                rounds += 1;
                if rounds > limit {
                    return Err(CompositeError::NoContact { rounds });
                }
                if let Some((share, first)) = next.first_released(&touching, &forces) {
                    for (force, next) in forces.iter_mut().zip(&next.forces) {
                        *force += share * (next - *force);
                    }
                    forces[first] = 0.0;
                    touching[first] = false;
                    continue;
                }
                match self.pierced(&touching, &next) {
                    Some(point) => {
                        touching[point] = true;
                        forces.copy_from_slice(&next.forces);
                    }
                    None => break next,
                }
            };
            forces.copy_from_slice(&settled.forces);
            if self.refuse_loose(&touching).is_ok() {
                let free = self.trial(&touching, advances, force, None)?;
                if free.pulled(&touching).is_none() && self.pierced(&touching, &free).is_none() {
                    return Ok(Touch {
                        touching,
                        advances: free.advances,
                        rounds,
                    });
                }
            }
            for (end, &anchor) in springs.anchors.iter_mut().zip(&self.anchors) {
                *end = settled.displacements[anchor];
            }
            springs.advance = settled.shared_advance;
        }
        self.refuse_loose(&touching)?;
        Err(CompositeError::NoContact { rounds })
    }

    /// Solves for given touching points.
    ///
    /// Unknown are the forces on touching points that are not anchors, in units that make them
    /// displacements, the displacements of anchors that do not touch, and the shared advance.
    fn trial(
        &mut self,
        touching: &[bool],
        advances: &[Option<f64>],
        force: f64,
        springs: Option<&Springs>,
    ) -> Result<Trial, CompositeError> {
        let is_anchor = |point: &usize| self.anchors.contains(point);
        let carriers: Vec<usize> = (0..touching.len())
            .filter(|point| touching[*point] && !is_anchor(point))
            .collect();
        for &carrier in &carriers {
            self.push(carrier)?;
        }
        let free: Vec<usize> = (0..self.anchors.len())
            .filter(|&anchor| !touching[self.anchors[anchor]])
            .collect();
        let shares_advance = advances.iter().any(Option::is_none);
        let shared = carriers.len() + free.len();
        let size = shared + usize::from(shares_advance);
        let unit = self
            .anchors
            .iter()
            .fold(f64::MIN_POSITIVE, |unit, &anchor| {
                unit.max(self.matrix.diagonal(self.points[anchor].displacement))
            });

        // A point's place as roller's advance less its gap: known part, and whether the shared
        // advance is added.
        let target = |point: usize| {
            let Point { roller, gap_mm, .. } = self.points[point];
            match advances[roller] {
                Some(advance) => (advance - gap_mm, false),
                None => (-gap_mm, true),
            }
        };
        // Rows of coefficients of the unknowns, the known part last.
        let mut row_of = vec![0.0; size + 1];
        let anchor_motion = |row: &mut [f64], anchor: usize, weight: f64| {
            if let Some(place) = free.iter().position(|&other| other == anchor) {
                row[carriers.len() + place] += weight;
            } else {
                let (known, moves) = target(self.anchors[anchor]);
                row[size] += weight * known;
                if moves {
                    row[shared] += weight;
                }
            }
        };
        let displacement = |row: &mut [f64], point: usize| {
            row.fill(0.0);
            row[size] = self.own.displacements[point];
            for (place, &carrier) in carriers.iter().enumerate() {
                if let Some(pushed) = &self.pushed[carrier] {
                    row[place] += unit * pushed[point];
                }
            }
            for (anchor, answer) in self.advanced.iter().enumerate() {
                anchor_motion(row, anchor, answer.displacements[point]);
            }
        };
        // By reciprocity an anchor answers a force on a point with minus what that point moves when
        // the anchor advances.
        let reaction = |row: &mut [f64], anchor: usize| {
            row.fill(0.0);
            row[size] = self.own.reactions[anchor] / unit;
            for (place, &carrier) in carriers.iter().enumerate() {
                row[place] -= self.advanced[anchor].displacements[carrier];
            }
            for (other, answer) in self.advanced.iter().enumerate() {
                anchor_motion(row, other, answer.reactions[anchor] / unit);
            }
            if let Some(springs) = springs {
                anchor_motion(row, anchor, SOFT);
                row[size] -= SOFT * springs.anchors[anchor];
            }
        };

        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        let mut add = |place: usize, row: &[f64], value: f64| {
            for (column, coefficient) in row[..size].iter().enumerate() {
                matrix[(place, column)] += coefficient;
            }
            right[place] += value - row[size];
        };
        for (place, &carrier) in carriers.iter().enumerate() {
            displacement(&mut row_of, carrier);
            let (known, moves) = target(carrier);
            if moves {
                row_of[shared] -= 1.0;
            }
            add(place, &row_of, known);
        }
        for (place, &anchor) in free.iter().enumerate() {
            reaction(&mut row_of, anchor);
            add(carriers.len() + place, &row_of, 0.0);
        }
        if shares_advance {
            for (anchor, &point) in self.anchors.iter().enumerate() {
                if touching[point] && target(point).1 {
                    reaction(&mut row_of, anchor);
                    add(shared, &row_of, 0.0);
                }
            }
            row_of.fill(0.0);
            for (place, &carrier) in carriers.iter().enumerate() {
                if target(carrier).1 {
                    row_of[place] = 1.0;
                }
            }
            if let Some(springs) = springs {
                row_of[shared] = SOFT;
                row_of[size] = -SOFT * springs.advance;
            }
            add(shared, &row_of, force / unit);
        }
        let solution = if size == 0 {
            right
        } else {
            matrix
                .lu()
                .solve(&right)
                .filter(|solution| solution.iter().all(|value: &f64| value.is_finite()))
                .ok_or(CompositeError::Unsupported {
                    motion: "move between the rollers",
                })?
        };

        let valued = |row: &[f64]| -> f64 {
            row[..size]
                .iter()
                .zip(solution.iter())
                .map(|(coefficient, value)| coefficient * value)
                .sum::<f64>()
                + row[size]
        };
        let mut displacements = vec![0.0; touching.len()];
        let mut forces = vec![0.0; touching.len()];
        for (point, value) in displacements.iter_mut().enumerate() {
            displacement(&mut row_of, point);
            *value = valued(&row_of);
        }
        for (place, &carrier) in carriers.iter().enumerate() {
            forces[carrier] = unit * solution[place];
        }
        for (anchor, &point) in self.anchors.iter().enumerate() {
            if touching[point] {
                reaction(&mut row_of, anchor);
                forces[point] = unit * valued(&row_of);
            }
        }
        let shared_advance = if shares_advance {
            solution[shared]
        } else {
            0.0
        };
        Ok(Trial {
            displacements,
            forces,
            advances: advances
                .iter()
                .map(|advance| advance.unwrap_or(shared_advance))
                .collect(),
            shared_advance,
        })
    }

    /// The section must not be able to move as a whole while these points touch.
    fn refuse_loose(&self, touching: &[bool]) -> Result<(), CompositeError> {
        let grid = self.lattice.grid();
        let mut held = self.supports.clone();
        for (point, _) in self
            .points
            .iter()
            .zip(touching)
            .filter(|(_, touch)| **touch)
        {
            held.hold(grid, point.displacement / 2, point.displacement % 2, 0.0)?;
        }
        held.refuse_rigid_motion(grid)
    }

    /// The point that lies deepest in a roller without touching it.
    fn pierced(&self, touching: &[bool], trial: &Trial) -> Option<usize> {
        let size = largest(&trial.displacements).max(largest(&trial.advances));
        let depth = |place: usize| {
            let point = self.points[place];
            trial.advances[point.roller] - point.gap_mm - trial.displacements[place]
        };
        (0..touching.len())
            .filter(|&place| !touching[place] && depth(place) > ROUND_OFF * size)
            .max_by(|&a, &b| depth(a).total_cmp(&depth(b)))
    }
}
