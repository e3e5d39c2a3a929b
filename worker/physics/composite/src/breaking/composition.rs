//! From the parts of a cell to its stiffness, and from its strain back to what each part bears.
//!
//! The same assumption as [`laminate`](crate::stiffness::laminate): layers share the strain along
//! them and the stresses across them; what layers of one direction make is a layer of the next. A
//! crack adds compliance on its plane to the part it is in,
//!
//! S = S₀ + Σ (1/ω - 1) (S₀,nn n n + S₀,ss s s)   (4)
//!
//! in the axes of its planes, so that no cell can become indefinite; a face adds its compliance to the
//! layers that it lies between.
use nalgebra::{Matrix2, Matrix3, RowVector2, Vector2, Vector3};

use super::part::{BrokenPart, Damage, Law, Part};
use super::saw::LEAST_RESIDUAL;
use crate::lattice::CellStiffness;
use crate::section::along;
use crate::stiffness::{Stiffness, compliance, turned_to};

/// What a part makes of the strain of its cell, in the axes of its planes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Bearing {
    /// Of a face 0.
    pub(crate) strain: Matrix3<f64>,
    pub(crate) stress: Matrix3<f64>,
    /// Below this times the largest strain of the cell, stresses and strains are round-off.
    least: [[f64; 3]; 2],
}

/// A part of the strain of a cell that is but round-off of the others.
const NOTHING: f64 = 1e-9;

impl Bearing {
    fn new(strain: Matrix3<f64>, stress: Matrix3<f64>) -> Self {
        let least = |map: &Matrix3<f64>| [0, 1, 2].map(|row| NOTHING * map.row(row).amax());
        Self {
            strain,
            stress,
            least: [least(&stress), least(&strain)],
        }
    }

    /// Stress and strain of the part at a strain of its cell; round-off is taken as 0, lest it break
    /// parts at loads of any size.
    pub(crate) fn of(&self, strain: &Vector3<f64>) -> [[f64; 3]; 2] {
        let size = strain.amax();
        let of = |map: &Matrix3<f64>, least: &[f64; 3]| {
            let borne = map * strain;
            [0, 1, 2].map(|row| {
                if borne[row].abs() > least[row] * size {
                    borne[row]
                } else {
                    0.0
                }
            })
        };
        [
            of(&self.stress, &self.least[0]),
            of(&self.strain, &self.least[1]),
        ]
    }
}

/// Strains in axes turned by cosine and sine, from those of the section.
pub(crate) fn strain_turn([c, s]: [f64; 2]) -> Matrix3<f64> {
    Matrix3::new(
        c * c,
        s * s,
        c * s,
        s * s,
        c * c,
        -c * s,
        -2.0 * c * s,
        2.0 * c * s,
        c * c - s * s,
    )
}

/// Stiffness of a damaged layer in the axes of its planes (4).
fn damaged(part: &Part, law: &Law, damage: &Damage, teeth: u16) -> Stiffness {
    let [c, s] = damage.axis;
    let intact = turned_to(&part.stiffness, [c, -s]);
    if damage.is_none() {
        return intact;
    }
    let intact = compliance(&intact);
    let mut soft = intact;
    for (place, plane) in damage.planes.iter().enumerate() {
        let [normal, shear] = plane.softness(teeth, part.slides(law, place));
        soft[(place, place)] += normal * intact[(place, place)];
        soft[(2, 2)] += shear * intact[(2, 2)];
    }
    compliance(&soft)
}

/// Compliances of a face [1/MPa] across and along, as if spread over the cell.
///
/// Plies that have come apart are long and slender: what an open face keeps for the equations' sake
/// must be soft beside their bending, not only beside its own stiffness.
pub(crate) fn face(part: &Part, damage: &Damage, teeth: u16) -> [f64; 2] {
    let plane = &damage.planes[1];
    let [mut normal, mut shear] = plane.softness(teeth, true);
    if matches!(part.kind, BrokenPart::PlyFace(_)) && plane.level >= teeth {
        let none = 1.0 / LEAST_RESIDUAL - 1.0;
        shear = none;
        if plane.opened >= teeth && !plane.is_closed {
            normal = none;
        }
    }
    [normal / part.bed[0], shear / part.bed[1]]
}

/// A layer in the axes of its stage.
struct Layer {
    share: f64,
    local: Stiffness,
}

impl Layer {
    fn across(&self) -> Matrix2<f64> {
        self.local.fixed_view::<2, 2>(1, 1).into_owned()
    }

    fn coupling(&self) -> RowVector2<f64> {
        RowVector2::new(self.local[(0, 1)], self.local[(0, 2)])
    }

    /// Its strain from that of the stage, whose stresses across it shares.
    fn bears(&self, stage: &Stiffness) -> Matrix3<f64> {
        let mut across = stage.fixed_view::<2, 3>(1, 0).into_owned();
        across[(0, 0)] -= self.local[(1, 0)];
        across[(1, 0)] -= self.local[(2, 0)];
        let across = inverted(&self.across()) * across;
        let mut map = Matrix3::zeros();
        map[(0, 0)] = 1.0;
        map.fixed_view_mut::<2, 3>(1, 0).copy_from(&across);
        map
    }
}

fn inverted(m: &Matrix2<f64>) -> Matrix2<f64> {
    let determinant = m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)];
    Matrix2::new(m[(1, 1)], -m[(0, 1)], -m[(1, 0)], m[(0, 0)]) / determinant
}

/// Layers side by side with faces between them, in their own axes.
fn stacked(layers: &[Layer], faces: [f64; 2]) -> Stiffness {
    let mut along = 0.0;
    let mut transfer = RowVector2::zeros();
    let mut soft = Matrix2::zeros();
    let mut total = 0.0;
    for layer in layers {
        let coupling = layer.coupling();
        let inverse = inverted(&layer.across());
        along += layer.share * (layer.local[(0, 0)] - (coupling * inverse).dot(&coupling));
        transfer += layer.share * (coupling * inverse);
        soft += inverse * layer.share;
        total += layer.share;
    }
    let mut soft = soft / total;
    soft[(0, 0)] += faces[0];
    soft[(1, 1)] += faces[1];
    let across = inverted(&soft);
    let transfer = transfer / total;
    let coupling: RowVector2<f64> = transfer * across;
    let along = along / total + coupling.dot(&transfer);
    let coupled: Vector2<f64> = coupling.transpose();
    Matrix3::new(
        along,
        coupled[0],
        coupled[1],
        coupled[0],
        across[(0, 0)],
        across[(0, 1)],
        coupled[1],
        across[(0, 1)],
        across[(1, 1)],
    )
}

/// Moduli across and along [MPa] of intact layers side by side.
pub(crate) fn bed(layers: &[(f64, Stiffness)], along: [f64; 2]) -> [f64; 2] {
    let [c, s] = along;
    let (mut soft, mut total) = (Matrix2::zeros(), 0.0);
    for (share, stiffness) in layers {
        let layer = Layer {
            share: *share,
            local: turned_to(stiffness, [c, -s]),
        };
        soft += inverted(&layer.across()) * *share;
        total += share;
    }
    [total / soft[(0, 0)], total / soft[(1, 1)]]
}

/// What a cell with these parts, sorted by stage, is left with; what each bears is written to `bearings`.
pub(crate) fn compose(
    parts: &[Part],
    laws: &[Law],
    damage: &[Damage],
    teeth: u16,
    bearings: &mut [Bearing],
) -> CellStiffness {
    let law = |place: usize| &laws[parts[place].law as usize];
    let own = |place: usize| damaged(&parts[place], law(place), &damage[place], teeth);

    // upwards: what each stage makes of what lies below
    let mut stages: Vec<Stage> = Vec::new();
    let mut ground: Option<(f64, Stiffness)> = None;
    let mut first = 0;
    for group in parts.chunk_by(|a, b| a.stage == b.stage) {
        let places = first..first + group.len();
        first = places.end;
        let along = group[0].along;
        let [c, s] = along;
        let mut layers = Vec::with_capacity(group.len() + 1);
        if let Some((share, stiffness)) = ground {
            layers.push(Layer {
                share,
                local: turned_to(&stiffness, [c, -s]),
            });
        }
        let has_ground = ground.is_some();
        let mut share = ground.map_or(0.0, |(share, _)| share);
        let mut faces = [0.0; 2];
        for place in places.clone() {
            if parts[place].is_face() {
                let soft = face(&parts[place], &damage[place], teeth);
                faces[0] += soft[0];
                faces[1] += soft[1];
            } else {
                let stiffness = turned_to(&own(place), damage[place].axis);
                layers.push(Layer {
                    share: parts[place].share,
                    local: turned_to(&stiffness, [c, -s]),
                });
                share += parts[place].share;
            }
        }
        let is_alone = layers.len() == 1 && faces[0] + faces[1] <= 0.0;
        let local = if is_alone {
            layers[0].local
        } else {
            stacked(&layers, faces)
        };
        ground = Some((share, turned_to(&local, along)));
        stages.push(Stage {
            places,
            along,
            local,
            layers,
            has_ground,
        });
    }

    // downwards: from the cell's strain to that of each part
    let mut strain = Matrix3::identity();
    for stage in stages.iter().rev() {
        let [c, s] = stage.along;
        let (turn, back) = (strain_turn([c, s]), strain_turn([c, -s]));
        let here = turn * strain;
        let mut layer = usize::from(stage.has_ground);
        for place in stage.places.clone() {
            if parts[place].is_face() {
                let mut stress = stage.local * here;
                stress.fill_row(0, 0.0);
                bearings[place] = Bearing::new(Matrix3::zeros(), stress);
            } else {
                let inside = back * stage.layers[layer].bears(&stage.local) * here;
                let strain = strain_turn(damage[place].axis) * inside;
                bearings[place] = Bearing::new(strain, own(place) * strain);
                layer += 1;
            }
        }
        if stage.has_ground {
            strain = back * stage.layers[0].bears(&stage.local) * here;
        }
    }
    // bars must not bear more than what is left of their fibres: C - E t t is never negative
    let modulus_left = |(place, part): (usize, &Part)| {
        if damage[place].is_none() {
            return 1.0;
        }
        let left = turned_to(&own(place), damage[place].axis);
        along(&left, part.along) / along(&part.stiffness, part.along)
    };
    let fibres = parts.iter().enumerate();
    let fibres = fibres.filter(|(_, part)| matches!(part.kind, BrokenPart::Fibre(_)));
    CellStiffness {
        stiffness: ground.map_or_else(Matrix3::zeros, |(_, stiffness)| stiffness),
        along_fibres: fibres.map(modulus_left).fold(1.0, f64::min),
    }
}

/// Layers of one direction.
struct Stage {
    places: std::ops::Range<usize>,
    along: [f64; 2],
    local: Stiffness,
    layers: Vec<Layer>,
    has_ground: bool,
}
