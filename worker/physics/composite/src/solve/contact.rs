//! Rollers pressed against faces: rigid, without friction, in small displacements.
//!
//! A roller that has advanced by a into the section stands in the way of every particle of its face:
//! the particle's displacement w along the inward normal and the force p on it obey
//!
//! w ≥ a - g,  p ≥ 0,  p (w - a + g) = 0,  g = R - √(R² - d²)   (8)
//!
//! with the distance d of the particle from the roller's place along the face, both in the
//! undeformed section. The circle is exact; (8) itself is of first order, as all small displacements
//! are: it leaves out the turn of the normal and the way a particle travels along the face.
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
//! an advance is one more linear equation. The set that is found is at last given to [`equilibrium`]
//! as supports, and (8) is checked against what comes back.
use nalgebra::{DMatrix, DVector};

use crate::error::{CompositeError, finite, positive};
use crate::lattice::{Geometry, Lattice, Tangent};
use crate::matrix::GridMatrix;
use crate::section::{Grid, within};
use crate::solve::equations::Equations;
use crate::solve::equilibrium::{Equilibrium, StaticOptions, equilibrium};
use crate::stiffness::{Stiffness, compliance};
use crate::supports::{Face, Supports};

/// A rigid cylinder whose axis crosses the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roller {
    /// The face it lies against.
    pub face: Face,
    /// Where along the face [mm].
    pub at_mm: f64,
    pub radius_mm: f64,
}

/// A roller that has advanced from where it just touches the undeformed face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressedRoller {
    pub roller: Roller,
    /// Along the inward normal, positive into the section [mm].
    pub advance_mm: f64,
}

/// What a roller does to the section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollerContact {
    /// Along the inward normal [mm].
    pub advance_mm: f64,
    /// Pressing, along the inward normal [N].
    pub force_n: f64,
    /// Number of particles that carry it.
    pub particles: usize,
    /// The first and the last of them along the face [mm]; none where it does not touch.
    pub between_mm: Option<[f64; 2]>,
    /// Mean place of the force along the face [mm]; the roller's own where it does not touch.
    pub centre_mm: f64,
    /// Twice the root mean square distance of the force from its mean place [mm]: the half width of
    /// a contact under Hertz's pressure, known better than to a particle.
    pub half_width_mm: f64,
}

/// A lattice at rest between rollers.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEquilibrium {
    /// Its reactions hold the forces of rollers beside those of supports.
    pub equilibrium: Equilibrium,
    /// In the order of the rollers given.
    pub rollers: Vec<RollerContact>,
    /// Sets of touching particles that were tried.
    pub rounds: u64,
}

/// Beyond so many sets for each particle in reach the search is lost to round-off.
const ROUNDS: usize = 20;
/// Springs that keep what nothing touches, over the stiffness of a cell: soft against the bending of
/// the slenderest beam that small displacements make sense for, stiff against round-off.
const SOFT: f64 = 1e-8;
/// How often the ends of the springs may follow.
const FOLLOWED: usize = 30;
/// Pull or overlap below this share of the largest is round-off of condensed equations.
const ROUND_OFF: f64 = 1e-10;
/// How well the equilibrium must obey (8), as a share of the largest force or displacement. A thin
/// sandwich with a core a thousand times softer, on cells from 0.01 mm to 1 mm, reaches 2e-7.
const OBEYED: f64 = 1e-5;

/// Finds the rest of a lattice between rollers that have advanced by given amounts.
///
/// Displacements along the face's normal must not be prescribed where a roller reaches.
///
/// # Errors
/// When geometry is large; a roller has no radius, lies beside its face, over another or on a
/// support; when supports and rollers leave the section loose; or no equilibrium is found.
pub fn contact_equilibrium(
    lattice: &Lattice,
    supports: &Supports,
    load_n: &[f64],
    rollers: &[PressedRoller],
    options: &StaticOptions,
) -> Result<ContactEquilibrium, CompositeError> {
    let advances = rollers
        .iter()
        .map(|pressed| finite("a roller's advance [mm]", pressed.advance_mm).map(Some))
        .collect::<Result<Vec<_>, _>>()?;
    let rollers: Vec<Roller> = rollers.iter().map(|pressed| pressed.roller).collect();
    let mut condensed = Condensed::new(lattice, supports, load_n, &rollers, options)?;
    let touch = condensed.settle(&advances, 0.0)?;
    certified(&condensed, supports, load_n, &rollers, options, &touch)
}

/// As [`contact_equilibrium`], with further rollers that advance together until the sum of their
/// forces is `force_n` [N]. They come after the others in what is returned.
///
/// # Errors
/// As [`contact_equilibrium`], and when the force is not above 0 or no roller presses.
pub fn pressed_equilibrium(
    lattice: &Lattice,
    supports: &Supports,
    load_n: &[f64],
    resting: &[PressedRoller],
    pressing: &[Roller],
    force_n: f64,
    options: &StaticOptions,
) -> Result<ContactEquilibrium, CompositeError> {
    positive("the force on the rollers [N]", force_n)?;
    if pressing.is_empty() {
        return Err(CompositeError::OutOfRange {
            quantity: "the number of rollers that press",
            given: 0.0,
            allowed: "at least 1",
        });
    }
    let mut advances = Vec::with_capacity(resting.len() + pressing.len());
    for pressed in resting {
        advances.push(Some(finite("a roller's advance [mm]", pressed.advance_mm)?));
    }
    advances.resize(resting.len() + pressing.len(), None);
    let rollers: Vec<Roller> = resting
        .iter()
        .map(|pressed| pressed.roller)
        .chain(pressing.iter().copied())
        .collect();
    let mut condensed = Condensed::new(lattice, supports, load_n, &rollers, options)?;
    let touch = condensed.settle(&advances, force_n)?;
    let found = certified(&condensed, supports, load_n, &rollers, options, &touch)?;
    let pressed: f64 = found.rollers[resting.len()..]
        .iter()
        .map(|contact| contact.force_n)
        .sum();
    obeyed((pressed / force_n - 1.0).abs())?;
    Ok(found)
}

/// Half width [mm] of the contact of a rigid cylinder with a half-space, b² = 4 F R / (π E* t), for
/// the force F over the thickness t.
///
/// The half-space has a plane stiffness with the axes of its face: 1/E* =
/// ½ √(S₂₂ (2 S₁₂ + S₆₆ + 2 √(S₁₁S₂₂))) with 2 along the normal, which is 1/E in isotropic plane stress
/// and (1 - ν²)/E in plane strain. Source: [Johnson1985] (4.43), E* by the characteristic equation of
/// [Lekhnitskii1968]. Coupling of stretch and shear is left out.
#[must_use]
pub fn hertz_half_width_mm(
    stiffness: &Stiffness,
    thickness_mm: f64,
    radius_mm: f64,
    force_n: f64,
) -> f64 {
    let s = compliance(stiffness);
    let sum = 2.0 * s[(0, 1)] + s[(2, 2)] + 2.0 * (s[(0, 0)] * s[(1, 1)]).sqrt();
    let flexible = 0.5 * (s[(1, 1)] * sum).sqrt();
    (4.0 * force_n * radius_mm * flexible / (std::f64::consts::PI * thickness_mm)).sqrt()
}

impl Roller {
    /// The axis across its face.
    fn normal(&self) -> usize {
        1 - self.face.along()
    }

    /// The inward normal's component along [`Roller::normal`].
    fn inward(&self) -> f64 {
        match self.face {
            Face::Bottom | Face::Left => 1.0,
            Face::Top | Face::Right => -1.0,
        }
    }

    /// Distance of the roller from a place along its face while it just touches [mm]; `None` out of
    /// its reach.
    fn gap(&self, at_mm: f64) -> Option<f64> {
        let distance = at_mm - self.at_mm;
        let radius = self.radius_mm;
        let square = (radius - distance) * (radius + distance);
        // R - √(R² - d²) without cancellation.
        (square > 0.0).then(|| distance * distance / (radius + square.sqrt()))
    }

    fn checked(&self, grid: &Grid) -> Result<(), CompositeError> {
        positive("a roller's radius [mm]", self.radius_mm)?;
        finite("a roller's place [mm]", self.at_mm)?;
        if within(self.face.lines_mm(grid), self.at_mm).is_none() {
            let mut place = grid.place_mm(self.face.particle(grid, 0));
            place[self.face.along()] = self.at_mm;
            return Err(CompositeError::OutsideSection {
                what: "a roller",
                x_mm: place[0],
                y_mm: place[1],
            });
        }
        Ok(())
    }
}

/// Two circles on one side of a line are apart when their feet are 2√(R₁R₂) apart.
fn refuse_overlap(rollers: &[Roller]) -> Result<(), CompositeError> {
    for (second, b) in rollers.iter().enumerate() {
        for (first, a) in rollers[..second].iter().enumerate() {
            let distance_mm = (a.at_mm - b.at_mm).abs();
            let least_mm = 2.0 * (a.radius_mm * b.radius_mm).sqrt();
            if a.face == b.face && distance_mm < least_mm {
                return Err(CompositeError::RollersOverlap {
                    first,
                    second,
                    distance_mm,
                    least_mm,
                });
            }
        }
    }
    Ok(())
}

/// A particle in a roller's reach.
#[derive(Debug, Clone, Copy)]
struct Point {
    roller: usize,
    displacement: usize,
    inward: f64,
    at_mm: f64,
    gap_mm: f64,
}

/// The lattice as seen from the particles in reach, all along inward normals.
struct Condensed<'a> {
    lattice: &'a Lattice,
    supports: &'a Supports,
    matrix: GridMatrix,
    equations: Equations,
    /// Which displacements the factor holds.
    anchored: Supports,
    points: Vec<Point>,
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
struct Touch {
    touching: Vec<bool>,
    advances: Vec<f64>,
    rounds: u64,
}

/// What a set of touching points leads to.
struct Trial {
    /// Along the inward normals [mm].
    displacements: Vec<f64>,
    /// On points that touch [N].
    forces: Vec<f64>,
    advances: Vec<f64>,
    shared_advance: f64,
}

/// Where the ends of the soft springs stand: on anchors, and on the shared advance [mm].
struct Springs {
    anchors: Vec<f64>,
    advance: f64,
}

impl<'a> Condensed<'a> {
    fn new(
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
            .map_err(|failure| failure.told(grid))?;
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
            .map_err(|failure| failure.told(self.lattice.grid()))?;
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
    fn settle(&mut self, advances: &[Option<f64>], force: f64) -> Result<Touch, CompositeError> {
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

impl Trial {
    /// The touching point that is pulled most.
    fn pulled(&self, touching: &[bool]) -> Option<usize> {
        let pull = -ROUND_OFF * largest(&self.forces);
        (0..touching.len())
            .filter(|&point| touching[point] && self.forces[point] < pull)
            .min_by(|&a, &b| self.forces[a].total_cmp(&self.forces[b]))
    }

    /// Where on the way from given forces to these the first of them vanishes, and which.
    fn first_released(&self, touching: &[bool], from: &[f64]) -> Option<(f64, usize)> {
        let pull = -ROUND_OFF * largest(&self.forces);
        (0..touching.len())
            .filter(|&point| touching[point] && self.forces[point] < pull)
            .map(|point| {
                let start = from[point].max(0.0);
                (start / (start - self.forces[point]), point)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |a, b| a.max(b.abs()))
}

/// All particles that a roller could touch, each with the nearest roller of its face.
fn points(
    grid: &Grid,
    supports: &Supports,
    rollers: &[Roller],
) -> Result<Vec<Point>, CompositeError> {
    let mut points = Vec::new();
    for face in Face::ALL {
        for (line, &at_mm) in face.lines_mm(grid).iter().enumerate() {
            let nearest = rollers
                .iter()
                .enumerate()
                .filter(|(_, roller)| roller.face == face)
                .filter_map(|(place, roller)| Some((place, roller, roller.gap(at_mm)?)))
                .min_by(|a, b| a.2.total_cmp(&b.2));
            let Some((place, roller, gap_mm)) = nearest else {
                continue;
            };
            let displacement = 2 * face.particle(grid, line) + roller.normal();
            if supports.is_held(displacement) {
                let [x_mm, y_mm] = grid.place_mm(displacement / 2);
                return Err(CompositeError::RollerOnSupport {
                    roller: place,
                    x_mm,
                    y_mm,
                });
            }
            points.push(Point {
                roller: place,
                displacement,
                inward: roller.inward(),
                at_mm,
                gap_mm,
            });
        }
    }
    Ok(points)
}

fn obeyed(share: f64) -> Result<(), CompositeError> {
    if share <= OBEYED {
        Ok(())
    } else {
        Err(CompositeError::ContactUnsettled { share })
    }
}

/// The equilibrium with touching particles held where the rollers want them, checked against (8).
fn certified(
    condensed: &Condensed,
    supports: &Supports,
    load: &[f64],
    rollers: &[Roller],
    options: &StaticOptions,
    touch: &Touch,
) -> Result<ContactEquilibrium, CompositeError> {
    let lattice = condensed.lattice;
    let grid = lattice.grid();
    let mut held = supports.clone();
    for (place, point) in condensed.points.iter().enumerate() {
        if touch.touching[place] {
            let value = point.inward * (touch.advances[point.roller] - point.gap_mm);
            held.hold(grid, point.displacement / 2, point.displacement % 2, value)?;
        }
    }
    let rest = equilibrium(lattice, &held, load, options)?;
    let mut contacts: Vec<RollerContact> = rollers
        .iter()
        .zip(&touch.advances)
        .map(|(roller, &advance_mm)| RollerContact {
            advance_mm,
            force_n: 0.0,
            particles: 0,
            between_mm: None,
            centre_mm: roller.at_mm,
            half_width_mm: 0.0,
        })
        .collect();
    let mut moments = vec![[0.0; 2]; rollers.len()];
    let (mut largest, mut pulled) = (0.0_f64, 0.0_f64);
    let (mut farthest, mut pierced) = (0.0_f64, 0.0_f64);
    for (place, point) in condensed.points.iter().enumerate() {
        let inward = point.inward * rest.displacements_mm[point.displacement];
        farthest = farthest.max(inward.abs());
        for (roller, advance) in rollers.iter().zip(&touch.advances) {
            if roller.face == rollers[point.roller].face
                && let Some(gap) = roller.gap(point.at_mm)
            {
                pierced = pierced.max(advance - gap - inward);
            }
        }
        if touch.touching[place] {
            let force = point.inward * rest.reactions_n[point.displacement];
            largest = largest.max(force);
            pulled = pulled.max(-force);
            let contact = &mut contacts[point.roller];
            contact.force_n += force;
            contact.particles += 1;
            let [from, to] = contact.between_mm.unwrap_or([point.at_mm; 2]);
            contact.between_mm = Some([from.min(point.at_mm), to.max(point.at_mm)]);
            let distance = point.at_mm - rollers[point.roller].at_mm;
            moments[point.roller][0] += force * distance;
            moments[point.roller][1] += force * distance * distance;
        }
    }
    if largest > 0.0 {
        obeyed(pulled / largest)?;
    }
    if farthest > 0.0 {
        obeyed(pierced / farthest)?;
    }
    for (contact, [first, second]) in contacts.iter_mut().zip(moments) {
        if contact.force_n > 0.0 {
            let mean = first / contact.force_n;
            contact.centre_mm += mean;
            let spread = second / contact.force_n - mean * mean;
            contact.half_width_mm = 2.0 * spread.max(0.0).sqrt();
        }
    }
    Ok(ContactEquilibrium {
        equilibrium: rest,
        rollers: contacts,
        rounds: touch.rounds,
    })
}
