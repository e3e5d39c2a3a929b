//! A network of tubes, made of their springs and of bonds between them.
use nalgebra::Vector3;

use super::super::element::{Element, TAUT};
use super::super::error::{FrameError, check};
use super::super::input::{FrameBond, FrameFibre, FrameModel, Level};
use super::super::places::{CentreLine, jaw_at};
use super::super::tubes::{Hold, Joint, Ring, Tubes, springs_of};
use super::{Network, bond_ends, normals, strengths, void};
use crate::fibre::Tube;

/// Places of a bond on one fibre closer than this share of its width are one.
const ONE_PLACE: f64 = 1e-6;

impl Network {
    /// A network of fibres each as the tube that follows its centre line; rings whose centre is in a jaw's reach are
    /// held by it, all points of them. Bonds are where the fibres touch: half way between their centre lines.
    ///
    /// # Errors
    /// [`FrameError`] when a quantity is outside its range, a bond is not on its fibres, or fibres yield.
    pub fn of_tubes(
        fibres: &[FrameFibre],
        tubes: &[Tube],
        bonds: &[FrameBond],
        model: FrameModel,
    ) -> Result<Self, FrameError> {
        let model = FrameModel {
            level: Level::Tube,
            ..model
        };
        model.check()?;
        let points_on_ring = tubes
            .first()
            .map_or(4, |tube| tube.segment().points_on_ring());
        check_tubes(fibres, tubes, points_on_ring)?;
        let mut lines = Vec::with_capacity(fibres.len());
        for (number, fibre) in fibres.iter().enumerate() {
            fibre.section.check(number)?;
            lines.push(CentreLine::new(number, fibre)?);
        }
        let mut at_um = vec![[0.0; 2]; bonds.len()];
        let ends = bond_ends(&lines, bonds)?;
        let normals = normals(fibres, &lines, bonds, &ends);
        for end in ends {
            at_um[end.bond as usize][end.side] = end.arc_um;
        }

        let (mut positions, mut arcs, mut jaws) = (Vec::new(), Vec::new(), Vec::new());
        let (mut starts, mut owners, mut first_rings) = (vec![0], Vec::new(), Vec::new());
        let (mut parts, mut rings) = (Vec::new(), Vec::new());
        for (number, tube) in tubes.iter().enumerate() {
            let first = positions.len();
            let nodes = first + tube.places_um().len();
            if nodes > (u32::MAX / 16) as usize {
                return Err(FrameError::TooManyNodes { nodes });
            }
            let [of_segments, of_rings] = springs_of(tube, first as u32);
            parts.extend(of_segments);
            rings.extend(of_rings);
            for ring in 0..=tube.segments() {
                let jaw = jaw_at(tube.centre_um(ring).into(), &model);
                for point in tube.ring(ring) {
                    positions.push(Vector3::from(tube.places_um()[point]));
                    arcs.push(ring as f64 * tube.segment().length_um());
                    jaws.push(jaw);
                }
            }
            let first_ring = first / points_on_ring;
            first_rings.extend((0..tube.segments()).map(|segment| (first_ring + segment) as u32));
            owners.extend(std::iter::repeat_n(number as u32, tube.segments()));
            starts.push(nodes as u32);
        }

        let mut joints = Vec::with_capacity(bonds.len());
        for (number, (bond, at_um)) in bonds.iter().zip(&at_um).enumerate() {
            let [one, other] = bond.fibres;
            let width = fibres[one as usize].section.width_um;
            if one == other && (at_um[0] - at_um[1]).abs() <= ONE_PLACE * width {
                return Err(FrameError::SamePoint {
                    bond: number,
                    fibre: one,
                });
            }
            let [from, to] = [0, 1].map(|side| lines[bond.fibres[side] as usize].at(at_um[side]));
            let touch = from.lerp(&to, 0.5);
            let holds = [0, 1].map(|side| {
                let fibre = bond.fibres[side] as usize;
                let first_ring = starts[fibre] / points_on_ring as u32;
                let first_segment = first_ring - fibre as u32;
                let tube = &tubes[fibre];
                let along = (at_um[side] / tube.segment().length_um()) as usize;
                let segment = along.min(tube.segments() - 1) as u32;
                let ring = |ring: u32| {
                    let first = (first_ring + ring) * points_on_ring as u32;
                    Ring::new(&positions, first, points_on_ring).centre
                };
                let (start, chord) = (ring(segment), ring(segment + 1) - ring(segment));
                Hold {
                    segment: first_segment + segment,
                    ring: first_ring + segment,
                    share: (touch - start).dot(&chord) / chord.norm_squared(),
                    at: touch,
                }
            });
            let like = Element::bond([0, 1], normals[number], bond, Level::Tube);
            joints.push(Joint {
                holds,
                axes: like.axes,
                stiffness: like.stiffness,
            });
        }
        let mut has_bonds = vec![false; owners.len()];
        for hold in joints.iter().flat_map(|joint| &joint.holds) {
            has_bonds[hold.segment as usize] = true;
        }
        let bonded = joints.iter();
        parts.extend(bonded.map(|joint| joint.springs(&positions, points_on_ring, [true; 2])));
        parts.extend(rings);

        let mut network = Self {
            model,
            sections: fibres.iter().map(|fibre| fibre.section).collect(),
            taut_strain: TAUT,
            strengths: bonds.iter().map(strengths).collect(),
            positions,
            arcs,
            jaws,
            starts,
            hanging: Vec::new(),
            elements: Vec::new(),
            tubes: Some(Tubes {
                points_on_ring,
                parts,
                joints,
                first_rings,
                has_bonds,
            }),
            owners,
            joined: bonds.iter().map(|bond| bond.fibres).collect(),
            void: void(bonds),
            standing: Vec::new(),
        };
        network.standing = network.standing_without(&network.unbroken());
        Ok(network)
    }

    /// The two points of the centre lines between which a bond of tubes is drawn, where they are at rest and displaced
    /// by what moves the rings around [µm].
    pub(super) fn bond_points(
        &self,
        tubes: &Tubes,
        bond: usize,
        displacement_um: &dyn Fn(usize) -> [f64; 3],
    ) -> [[Vector3<f64>; 2]; 2] {
        tubes.joints[bond].holds.map(|hold| {
            let mut point = [Vector3::zeros(); 2];
            for (ring, share) in [(hold.ring, 1.0 - hold.share), (hold.ring + 1, hold.share)] {
                let share = share / tubes.points_on_ring as f64;
                let first = tubes.node_of(ring) as usize;
                for node in first..first + tubes.points_on_ring {
                    point[0] += self.positions[node] * share;
                    point[1] += Vector3::from(displacement_um(node)) * share;
                }
            }
            point
        })
    }
}

fn check_tubes(
    fibres: &[FrameFibre],
    tubes: &[Tube],
    points_on_ring: usize,
) -> Result<(), FrameError> {
    check(
        || "number of tubes".into(),
        tubes.len() as f64,
        tubes.len() == fibres.len(),
        "one for each fibre",
    )?;
    for (number, tube) in tubes.iter().enumerate() {
        let count = tube.segment().points_on_ring();
        check(
            || format!("points on a ring of tube {number}"),
            count as f64,
            count == points_on_ring,
            "as many as those of the first",
        )?;
    }
    let yields = fibres.iter().any(|fibre| fibre.section.yielding.is_some());
    if yields {
        Err(FrameError::Tubes)
    } else {
        Ok(())
    }
}
