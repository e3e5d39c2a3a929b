//! Where the nodes of a fibre are: at its points, at its bonds, and between them.
use nalgebra::Vector3;

use super::error::FrameError;
use super::input::{Attachment, FrameFibre, FrameModel};

/// Two places of a fibre closer than this share of its width are one. A segment shorter than that would
/// cost digits and change nothing.
const ONE_PLACE: f64 = 1e-6;

/// A point this share of the distance of the jaws away from a jaw is at it: round-off of a cut edge.
const AT_JAW: f64 = 1e-9;

/// The jaw that holds a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Jaw {
    /// At x = 0, at rest.
    Left,
    /// At x = length, pulled along x.
    Right,
}

/// A node to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) arc_um: f64,
    pub(crate) at: Vector3<f64>,
    pub(crate) jaw: Option<Jaw>,
}

/// Where a bond is on a fibre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum BondPlace {
    /// At a node.
    Node(usize),
    /// Between a node and the next, at this share of the way.
    Inside(usize, f64),
}

/// A fibre's centre line by its arc length.
#[derive(Debug)]
pub(crate) struct CentreLine {
    points: Vec<Vector3<f64>>,
    arcs: Vec<f64>,
}

impl CentreLine {
    pub(crate) fn new(number: usize, fibre: &FrameFibre) -> Result<Self, FrameError> {
        let points: Vec<Vector3<f64>> = fibre
            .centre_line_um
            .iter()
            .map(|&point| point.into())
            .collect();
        if points.len() < 2 {
            return Err(FrameError::FewPoints {
                fibre: number,
                points: points.len(),
            });
        }
        for (index, point) in points.iter().enumerate() {
            if let Some(&value) = point.iter().find(|value| !value.is_finite()) {
                return Err(FrameError::Value {
                    quantity: format!("coordinate [um] of point {index} of fibre {number}"),
                    value,
                    allowed: "finite",
                });
            }
        }
        let mut arcs = Vec::with_capacity(points.len());
        let mut arc = 0.0;
        arcs.push(arc);
        for (index, pair) in points.windows(2).enumerate() {
            let step = (pair[1] - pair[0]).norm();
            if step <= ONE_PLACE * fibre.section.width_um {
                return Err(FrameError::SamePlace {
                    fibre: number,
                    point: index + 1,
                });
            }
            arc += step;
            arcs.push(arc);
        }
        Ok(Self { points, arcs })
    }

    pub(crate) fn length_um(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// The point at an arc length [µm]; straight on beyond the ends.
    pub(crate) fn at(&self, arc: f64) -> Vector3<f64> {
        let last = self.points.len() - 1;
        let next = self
            .arcs
            .partition_point(|&point| point <= arc)
            .clamp(1, last);
        let share = (arc - self.arcs[next - 1]) / (self.arcs[next] - self.arcs[next - 1]);
        self.points[next - 1].lerp(&self.points[next], share)
    }

    /// The unit direction of the chord `reach` [µm] to either side of an arc length; 0 where the line turns back.
    pub(crate) fn along(&self, arc: f64, reach: f64) -> Vector3<f64> {
        let chord = self.at(arc + reach) - self.at(arc - reach);
        chord.try_normalize(1e-3 * reach).unwrap_or_default()
    }

    /// The nodes of a fibre whose bonds are at `bonds` (ascending arc lengths), and where each bond is.
    ///
    /// Given points and bonds in a jaw's reach are held by it; what is put between them to shorten
    /// segments is not, so that a fibre pulls the same however it is cut into segments. Bonds in a jaw's
    /// reach have nodes in any case.
    pub(crate) fn places(
        &self,
        width_um: f64,
        bonds: &[f64],
        model: &FrameModel,
    ) -> (Vec<Place>, Vec<BondPlace>) {
        if model.attachment == Attachment::Node {
            let (places, of_bonds) = self.places_at_bonds(width_um, bonds, model);
            return (places, of_bonds.into_iter().map(BondPlace::Node).collect());
        }
        let is_held = |bond: f64| jaw_at(self.at(bond), model).is_some();
        let held: Vec<f64> = bonds
            .iter()
            .copied()
            .filter(|&bond| is_held(bond))
            .collect();
        let (places, _) = self.places_at_bonds(width_um, &held, model);
        let near = ONE_PLACE * width_um;
        let of_bonds = bonds.iter().map(|&bond| {
            let next = places
                .partition_point(|place| place.arc_um <= bond)
                .clamp(1, places.len() - 1);
            let [from, to] = [places[next - 1].arc_um, places[next].arc_um];
            if bond - from <= near {
                BondPlace::Node(next - 1)
            } else if to - bond <= near {
                BondPlace::Node(next)
            } else {
                BondPlace::Inside(next - 1, (bond - from) / (to - from))
            }
        });
        let of_bonds = of_bonds.collect();
        (places, of_bonds)
    }

    fn places_at_bonds(
        &self,
        width_um: f64,
        bonds: &[f64],
        model: &FrameModel,
    ) -> (Vec<Place>, Vec<usize>) {
        let near = ONE_PLACE * width_um;
        let mut places: Vec<Place> = Vec::new();
        let mut of_bonds = Vec::with_capacity(bonds.len());
        let mut next_point = 0;
        for &bond in bonds {
            self.points_up_to(bond + near, &mut next_point, model, &mut places);
            let is_new = places.last().is_none_or(|place| bond - place.arc_um > near);
            if is_new {
                let at = self.at(bond);
                self.reach(bond, at, model, &mut places);
            }
            of_bonds.push(places.len() - 1);
        }
        self.points_up_to(f64::INFINITY, &mut next_point, model, &mut places);
        match model.segment_um {
            None => (places, of_bonds),
            Some(longest) => self.shortened(&places, of_bonds, longest),
        }
    }

    fn points_up_to(
        &self,
        arc: f64,
        next: &mut usize,
        model: &FrameModel,
        places: &mut Vec<Place>,
    ) {
        while *next < self.points.len() && self.arcs[*next] <= arc {
            self.reach(self.arcs[*next], self.points[*next], model, places);
            *next += 1;
        }
    }

    fn reach(&self, arc_um: f64, at: Vector3<f64>, model: &FrameModel, places: &mut Vec<Place>) {
        let jaw = jaw_at(at, model);
        places.push(Place { arc_um, at, jaw });
    }

    fn shortened(
        &self,
        places: &[Place],
        of_bonds: Vec<usize>,
        longest: f64,
    ) -> (Vec<Place>, Vec<usize>) {
        let mut all = Vec::with_capacity(places.len());
        let mut moved = Vec::with_capacity(places.len());
        for (index, place) in places.iter().enumerate() {
            if index > 0 {
                let from = &places[index - 1];
                let gap = place.arc_um - from.arc_um;
                // a gap of 3.0000000001 longest ones needs no fourth
                let parts = (gap / longest - 1e-9).ceil().max(1.0);
                for part in 1..parts as usize {
                    let share = part as f64 / parts;
                    all.push(Place {
                        arc_um: from.arc_um + share * gap,
                        at: from.at.lerp(&place.at, share),
                        jaw: None,
                    });
                }
            }
            moved.push(all.len());
            all.push(*place);
        }
        (
            all,
            of_bonds.into_iter().map(|place| moved[place]).collect(),
        )
    }
}

/// The jaw in whose reach a point is.
pub(crate) fn jaw_at(at: Vector3<f64>, model: &FrameModel) -> Option<Jaw> {
    let near = AT_JAW * model.length_um;
    if at.x <= near {
        Some(Jaw::Left)
    } else if at.x >= model.length_um - near {
        Some(Jaw::Right)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::input::Level;
    use crate::frame::tests::tube;

    fn line(points: &[[f64; 3]]) -> CentreLine {
        let fibre = FrameFibre {
            centre_line_um: points.to_vec(),
            section: tube(),
        };
        CentreLine::new(0, &fibre).unwrap()
    }

    fn model(segment_um: Option<f64>) -> FrameModel {
        FrameModel {
            level: Level::Beam,
            segment_um,
            attachment: Attachment::Node,
            length_um: 100.0,
        }
    }

    fn arcs(places: &[Place]) -> Vec<f64> {
        places.iter().map(|place| place.arc_um).collect()
    }

    #[test]
    fn nodes_are_at_points_and_bonds_and_one_place_has_one() {
        let line = line(&[[0.0; 3], [30.0, 40.0, 0.0], [30.0, 40.0, 10.0]]);
        let (places, bonds) = line.places(
            30.0,
            &[0.0, 25.0, 25.0 + 1e-6, 50.0, 55.0, 60.0],
            &model(None),
        );
        assert_eq!(arcs(&places), [0.0, 25.0, 50.0, 55.0, 60.0]);
        assert_eq!(bonds, [0, 1, 1, 2, 3, 4].map(BondPlace::Node));
        assert!((places[1].at - Vector3::new(15.0, 20.0, 0.0)).norm() < 1e-12);
        assert!((places[3].at - Vector3::new(30.0, 40.0, 5.0)).norm() < 1e-12);
    }

    #[test]
    fn long_gaps_are_cut_into_equal_parts() {
        let line = line(&[[1.0, 0.0, 0.0], [91.0, 0.0, 0.0]]);
        let (places, bonds) = line.places(30.0, &[30.0], &model(Some(25.0)));
        assert_eq!(arcs(&places), [0.0, 15.0, 30.0, 50.0, 70.0, 90.0]);
        assert_eq!(bonds, [BondPlace::Node(2)]);
    }

    #[test]
    fn given_points_and_bonds_in_reach_are_held_but_no_others() {
        let line = line(&[[-40.0, 0.0, 0.0], [160.0, 0.0, 0.0]]);
        let (places, _) = line.places(30.0, &[20.0], &model(Some(10.0)));
        let held: Vec<f64> = places
            .iter()
            .filter(|p| p.jaw.is_some())
            .map(|p| p.arc_um)
            .collect();
        assert_eq!(held, [0.0, 20.0, 200.0]);
        assert_eq!(places[0].jaw, Some(Jaw::Left));
        assert_eq!(places[places.len() - 1].jaw, Some(Jaw::Right));
    }

    #[test]
    fn bonds_inside_segments_have_a_share_of_the_way() {
        let line = line(&[[1.0, 0.0, 0.0], [91.0, 0.0, 0.0]]);
        let inside = FrameModel {
            attachment: Attachment::Inside,
            ..model(Some(45.0))
        };
        let (places, bonds) = line.places(30.0, &[0.0, 9.0, 45.0, 63.0, 90.0], &inside);
        assert_eq!(arcs(&places), [0.0, 45.0, 90.0]);
        let expected = [
            BondPlace::Node(0),
            BondPlace::Inside(0, 0.2),
            BondPlace::Node(1),
            BondPlace::Inside(1, 0.4),
            BondPlace::Node(2),
        ];
        assert_eq!(bonds, expected);
    }
}
