//! A network as points and lines, to be looked at.
use nalgebra::Vector3;

use super::super::events::Broken;
use super::super::places::Jaw;
use super::Network;

/// Points, and lines between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Where points are, displaced [µm]: nodes first; of tubes then both ends of every bond, on the centre lines.
    pub points_um: Vec<[f64; 3]>,
    /// Their displacements [µm].
    pub displacements_um: Vec<[f64; 3]>,
    pub jaws: Vec<Option<Jaw>>,
    /// By segment, then by bond: one line each, of a segment of a tube those along and around it.
    pub lines: Vec<[u32; 2]>,
    /// What each line is of.
    pub parts: Vec<Broken>,
}

impl Network {
    /// Draws it with its nodes displaced so [µm].
    #[must_use]
    pub fn drawing(&self, displacement_um: &dyn Fn(usize) -> [f64; 3]) -> Drawing {
        let nodes = 0..self.nodes();
        let mut drawing = Drawing {
            points_um: Vec::new(),
            displacements_um: Vec::new(),
            jaws: Vec::new(),
            lines: Vec::with_capacity(self.parts()),
            parts: Vec::with_capacity(self.parts()),
        };
        for node in nodes {
            drawing.point(
                self.positions[node],
                displacement_um(node).into(),
                self.jaws[node],
            );
        }
        for segment in 0..self.segments() {
            for line in self.lines_of(segment) {
                drawing.lines.push(line);
                drawing.parts.push(Broken::Segment(segment));
            }
        }
        for bond in 0..self.bonds() {
            let line = match &self.tubes {
                None => self.bond_nodes(bond).map(|node| node as u32),
                Some(tubes) => self
                    .bond_points(tubes, bond, displacement_um)
                    .map(|[at, moved]| drawing.point(at, moved, None)),
            };
            drawing.lines.push(line);
            drawing.parts.push(Broken::Bond(bond));
        }
        drawing
    }

    /// Lines of a segment; the last of a tube has its last ring, too.
    fn lines_of(&self, segment: usize) -> Vec<[u32; 2]> {
        let Some(tubes) = &self.tubes else {
            return vec![self.segment_nodes(segment).map(|node| node as u32)];
        };
        let count = tubes.points_on_ring as u32;
        let ring = tubes.first_rings[segment];
        let first = tubes.node_of(ring);
        let along = (0..count).map(|point| [first + point, first + count + point]);
        let is_last = self.owners.get(segment + 1) != self.owners.get(segment);
        let around = (ring..=ring + u32::from(is_last)).flat_map(|ring| {
            let first = tubes.node_of(ring);
            (0..count).map(move |point| [first + point, first + (point + 1) % count])
        });
        along.chain(around).collect()
    }
}

impl Drawing {
    fn point(&mut self, at: Vector3<f64>, moved: Vector3<f64>, jaw: Option<Jaw>) -> u32 {
        self.points_um.push((at + moved).into());
        self.displacements_um.push(moved.into());
        self.jaws.push(jaw);
        self.points_um.len() as u32 - 1
    }
}
