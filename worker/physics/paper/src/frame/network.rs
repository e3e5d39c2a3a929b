//! The network: nodes, the segments of fibres between them, and bonds.
//!
//! A description ([`FrameFibre`], [`FrameBond`]) becomes a network once; it has no state. Nodes of a
//! fibre follow one another, and segment i of a fibre joins its nodes i and i + 1. Every bond has a
//! node of its own on either fibre, so that beams bent by bonds are exact between them, or it hangs on
//! the segments between nodes ([`Attachment::Inside`](super::Attachment)): its two points then follow all nodes of fibres
//! and have no motion of their own. Networks of tubes ([`Network::of_tubes`]) have the points of rings as nodes.
use nalgebra::Vector3;

use super::clusters::{Standing, standings};
use super::element::{Element, TAUT};
use super::error::{FrameError, check};
use super::input::{BeamSection, FrameBond, FrameFibre, FrameModel, Level};
use super::places::{BondPlace, CentreLine, Jaw, Place};
use super::tie::Tie;
use super::tubes::Tubes;

mod drawing;
mod ends;
mod face;
mod tubes;

pub use drawing::Drawing;
use ends::{bond_ends, strengths, void};
use face::normals;

/// Fibres and bonds, ready to be pulled.
#[derive(Debug, Clone)]
pub struct Network {
    model: FrameModel,
    sections: Vec<BeamSection>,
    /// Strain by which bars are taut; means nothing to beams.
    taut_strain: f64,
    /// Of every bond: normal and shear strength [mN], infinite where it cannot break.
    strengths: Vec<[f64; 2]>,
    positions: Vec<Vector3<f64>>,
    arcs: Vec<f64>,
    jaws: Vec<Option<Jaw>>,
    /// First node of each fibre, and the number of nodes.
    starts: Vec<u32>,
    /// Points between nodes, which have the numbers after those of nodes.
    hanging: Vec<Hanging>,
    /// Segments by fibre, then bonds; none of tubes.
    elements: Vec<Element>,
    tubes: Option<Tubes>,
    /// Fibre of each segment.
    owners: Vec<u32>,
    /// Fibres of each bond.
    joined: Vec<[u32; 2]>,
    /// Bonds without any strength.
    void: Vec<u32>,
    standing: Vec<Standing>,
}

/// A point of a bond inside a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hanging {
    pub(crate) segment: u32,
    /// Share of the way from the segment's first node.
    pub(crate) share: f64,
}

impl Network {
    /// Places the nodes and makes the elements.
    ///
    /// # Errors
    /// [`FrameError`] when a quantity is outside its range or a bond is not on its fibres.
    pub fn new(
        fibres: &[FrameFibre],
        bonds: &[FrameBond],
        model: FrameModel,
    ) -> Result<Self, FrameError> {
        model.check()?;
        if model.level == Level::Tube {
            return Err(FrameError::Tubes);
        }
        let mut lines = Vec::with_capacity(fibres.len());
        for (number, fibre) in fibres.iter().enumerate() {
            fibre.section.check(number)?;
            lines.push(CentreLine::new(number, fibre)?);
        }
        let ends = bond_ends(&lines, bonds)?;
        let normals = normals(fibres, &lines, bonds, &ends);

        let mut starts = vec![0];
        let mut nodes: Vec<Place> = Vec::new();
        let mut hung: Vec<(usize, usize, Hanging)> = Vec::new();
        let mut bond_nodes = vec![[0; 2]; bonds.len()];
        let mut rest = ends.as_slice();
        for (number, line) in lines.iter().enumerate() {
            let count = rest.partition_point(|end| end.fibre as usize == number);
            let (own, others) = rest.split_at(count);
            rest = others;
            let arcs: Vec<f64> = own.iter().map(|end| end.arc_um).collect();
            let (places, of_bonds) = line.places(fibres[number].section.width_um, &arcs, &model);
            for (end, place) in own.iter().zip(of_bonds) {
                let (bond, side) = (end.bond as usize, end.side);
                match place {
                    BondPlace::Node(place) => {
                        bond_nodes[bond][side] = (nodes.len() + place) as u32;
                    }
                    BondPlace::Inside(place, share) => {
                        // each fibre before has a segment less than nodes
                        let segment = (nodes.len() + place - number) as u32;
                        hung.push((bond, side, Hanging { segment, share }));
                    }
                }
            }
            nodes.extend(places);
            if nodes.len() > (u32::MAX / 16) as usize {
                return Err(FrameError::TooManyNodes { nodes: nodes.len() });
            }
            starts.push(nodes.len() as u32);
        }

        let mut elements = Vec::with_capacity(nodes.len() + bonds.len());
        let mut owners = Vec::with_capacity(nodes.len());
        for (number, fibre) in fibres.iter().enumerate() {
            for node in starts[number]..starts[number + 1] - 1 {
                let along = nodes[node as usize + 1].at - nodes[node as usize].at;
                elements.push(Element::segment(
                    [node, node + 1],
                    along,
                    &fibre.section,
                    model.level,
                ));
                owners.push(number as u32);
            }
        }
        for (bond, side, hanging) in &hung {
            let [from, to] = elements[hanging.segment as usize]
                .nodes
                .map(|node| nodes[node as usize]);
            bond_nodes[*bond][*side] = nodes.len() as u32;
            nodes.push(Place {
                arc_um: from.arc_um + hanging.share * (to.arc_um - from.arc_um),
                at: from.at.lerp(&to.at, hanging.share),
                jaw: None,
            });
        }
        if nodes.len() > (u32::MAX / 16) as usize {
            return Err(FrameError::TooManyNodes { nodes: nodes.len() });
        }
        for (number, (bond, joined)) in bonds.iter().zip(&bond_nodes).enumerate() {
            if joined[0] == joined[1] {
                return Err(FrameError::SamePoint {
                    bond: number,
                    fibre: bond.fibres[0],
                });
            }
            elements.push(Element::bond(*joined, normals[number], bond, model.level));
        }

        let mut network = Self {
            model,
            sections: fibres.iter().map(|fibre| fibre.section).collect(),
            taut_strain: TAUT,
            strengths: bonds.iter().map(strengths).collect(),
            positions: nodes.iter().map(|node| node.at).collect(),
            arcs: nodes.iter().map(|node| node.arc_um).collect(),
            jaws: nodes.iter().map(|node| node.jaw).collect(),
            starts,
            hanging: hung.into_iter().map(|(_, _, hanging)| hanging).collect(),
            elements,
            tubes: None,
            owners,
            joined: bonds.iter().map(|bond| bond.fibres).collect(),
            void: void(bonds),
            standing: Vec::new(),
        };
        network.standing = network.standing_without(&network.unbroken());
        Ok(network)
    }

    /// The same with bars that are taut by this strain, as fibres are that dried held: 1e-9 otherwise. The more they
    /// are the fewer iterations find equilibrium, for a truss is nearly a mechanism, and the stiffer it is.
    ///
    /// # Errors
    /// [`FrameError::Value`] when the strain is not from 1e-9 to 0.01, [`FrameError::Taut`] when fibres are no bars.
    pub fn with_taut_bars(mut self, strain: f64) -> Result<Self, FrameError> {
        if self.model.level != Level::Truss {
            return Err(FrameError::Taut);
        }
        let is_small = (TAUT..=0.01).contains(&strain);
        let what = || "strain by which bars are taut".into();
        check(what, strain, is_small, "1e-9 to 0.01")?;
        self.taut_strain = strain;
        let segments = self.segments();
        for segment in &mut self.elements[..segments] {
            *segment = segment.taut(strain);
        }
        Ok(self)
    }

    /// Strain by which bars are taut.
    pub(crate) fn taut_strain(&self) -> f64 {
        self.taut_strain
    }

    /// How it was built.
    #[must_use]
    pub fn model(&self) -> &FrameModel {
        &self.model
    }

    /// Number of fibres.
    #[must_use]
    pub fn fibres(&self) -> usize {
        self.sections.len()
    }

    /// Number of points that move: nodes of fibres, then points of bonds that hang between them.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.positions.len()
    }

    /// Number of nodes of fibres, those that have motions of their own.
    #[must_use]
    pub fn fibre_nodes(&self) -> usize {
        self.positions.len() - self.hanging.len()
    }

    /// Number of segments of all fibres.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.owners.len()
    }

    /// Number of bonds.
    #[must_use]
    pub fn bonds(&self) -> usize {
        self.strengths.len()
    }

    /// Number of rings, of a network of tubes.
    #[must_use]
    pub fn rings(&self) -> Option<usize> {
        self.tubes.as_ref().map(Tubes::rings)
    }

    /// Nodes of a fibre, in order of arc length.
    #[must_use]
    pub fn nodes_of(&self, fibre: usize) -> std::ops::Range<usize> {
        self.starts[fibre] as usize..self.starts[fibre + 1] as usize
    }

    /// Where a node is before any pull [µm].
    #[must_use]
    pub fn position_um(&self, node: usize) -> [f64; 3] {
        self.positions[node].into()
    }

    /// Arc length of a node from its fibre's start [µm].
    #[must_use]
    pub fn arc_um(&self, node: usize) -> f64 {
        self.arcs[node]
    }

    /// The jaw that holds a node.
    #[must_use]
    pub fn jaw(&self, node: usize) -> Option<Jaw> {
        self.jaws[node]
    }

    /// The jaw of every node.
    pub(crate) fn jaws(&self) -> &[Option<Jaw>] {
        &self.jaws
    }

    /// What a node's cluster is held by before anything breaks.
    #[must_use]
    pub fn standing(&self, node: usize) -> Standing {
        self.standing[node]
    }

    /// The two nodes of a segment.
    #[must_use]
    pub fn segment_nodes(&self, segment: usize) -> [usize; 2] {
        let nodes = match &self.tubes {
            Some(tubes) => [0, 1].map(|next| tubes.node_of(tubes.first_rings[segment] + next)),
            None => self.elements[segment].nodes,
        };
        nodes.map(|node| node as usize)
    }

    /// The fibre of a node that a fibre has.
    pub(crate) fn fibre_of(&self, node: u32) -> usize {
        self.starts.partition_point(|&start| start <= node) - 1
    }

    /// The fibre of a segment.
    #[must_use]
    pub fn segment_fibre(&self, segment: usize) -> usize {
        self.owners[segment] as usize
    }

    /// The first segment of a fibre; those of a fibre follow one another along it.
    #[must_use]
    pub fn first_segment(&self, fibre: usize) -> usize {
        self.owners
            .partition_point(|&owner| (owner as usize) < fibre)
    }

    /// E A of a segment: force over strain [mN].
    #[must_use]
    pub fn segment_stiffness_mn(&self, segment: usize) -> f64 {
        let section = self.section_of(segment);
        section.youngs_modulus_gpa * section.area_um2
    }

    /// Whether any fibre yields.
    #[must_use]
    pub fn yields(&self) -> bool {
        let mut sections = self.sections.iter();
        sections.any(|section| section.yielding.is_some())
    }

    /// The two nodes of a bond.
    #[must_use]
    pub fn bond_nodes(&self, bond: usize) -> [usize; 2] {
        self.elements[self.segments() + bond]
            .nodes
            .map(|node| node as usize)
    }

    /// Whether a bond has no strength at all: it counts as broken before the pull.
    #[must_use]
    pub fn is_void(&self, bond: usize) -> bool {
        self.void.binary_search(&(bond as u32)).is_ok()
    }

    /// The node of a fibre nearest to an arc length.
    #[must_use]
    pub fn nearest_node(&self, fibre: usize, arc_um: f64) -> usize {
        let nodes = self.nodes_of(fibre);
        let next = nodes.start + self.arcs[nodes.clone()].partition_point(|&arc| arc < arc_um);
        let after = next.min(nodes.end - 1);
        let before = after.saturating_sub(1).max(nodes.start);
        let is_before_nearer =
            (self.arcs[before] - arc_um).abs() < (self.arcs[after] - arc_um).abs();
        if is_before_nearer { before } else { after }
    }

    pub(crate) fn hanging(&self) -> &[Hanging] {
        &self.hanging
    }

    /// How a hanging point moves with its nodes, and with one of them when its segment is broken.
    pub(crate) fn tie(&self, hanging: &Hanging, is_whole: &[bool]) -> Tie {
        let segment = &self.elements[hanging.segment as usize];
        let [from, to] = segment.nodes.map(|node| self.positions[node as usize]);
        if is_whole[hanging.segment as usize] {
            Tie::inside(segment, to - from, hanging.share)
        } else {
            Tie::torn(segment, to - from, hanging.share)
        }
    }

    /// Segments and bonds: all that may break.
    pub(crate) fn parts(&self) -> usize {
        self.segments() + self.bonds()
    }

    /// The two fibres of a bond, or that of a segment twice.
    pub(crate) fn fibres_of(&self, part: usize) -> [usize; 2] {
        let fibres = match part.checked_sub(self.segments()) {
            None => [self.owners[part]; 2],
            Some(bond) => self.joined[bond],
        };
        fibres.map(|fibre| fibre as usize)
    }

    /// Of a network of tubes.
    pub(crate) fn tubes(&self) -> Option<&Tubes> {
        self.tubes.as_ref()
    }

    pub(crate) fn elements(&self) -> &[Element] {
        &self.elements
    }

    pub(crate) fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    pub(crate) fn section_of(&self, segment: usize) -> &BeamSection {
        &self.sections[self.owners[segment] as usize]
    }

    /// Normal and shear strength of a bond [mN].
    pub(crate) fn strengths(&self, bond: usize) -> [f64; 2] {
        self.strengths[bond]
    }

    /// Motions of a node that count.
    pub(crate) fn motions(&self) -> usize {
        match self.model.level {
            Level::Beam => 6,
            Level::Truss | Level::Tube => 3,
        }
    }

    /// Mean radius of gyration √(I/A) of the sections [µm]: makes moments comparable with forces.
    pub(crate) fn gyration_um(&self) -> f64 {
        let of = |section: &BeamSection| (section.inertia_um4 / section.area_um2).sqrt();
        self.sections.iter().map(of).sum::<f64>() / self.sections.len().max(1) as f64
    }

    /// Which elements are there before the pull: all but void bonds.
    pub(crate) fn unbroken(&self) -> Vec<bool> {
        let tubes = self.tubes.as_ref().map_or(0, |tubes| tubes.parts.len());
        let mut is_whole = vec![true; self.elements.len().max(tubes)];
        for &bond in &self.void {
            is_whole[self.segments() + bond as usize] = false;
        }
        is_whole
    }

    /// The standing of every node when only these elements are whole.
    pub(crate) fn standing_without(&self, is_whole: &[bool]) -> Vec<Standing> {
        if let Some(tubes) = &self.tubes {
            return standings(&self.jaws, tubes.links(is_whole).into_iter());
        }
        let whole = self
            .elements
            .iter()
            .zip(is_whole)
            .filter(|(_, is_whole)| **is_whole);
        let fibre_nodes = self.fibre_nodes() as u32;
        let hung = (fibre_nodes..).zip(&self.hanging);
        let hung = hung.map(|(point, hanging)| [point, self.tie(hanging, is_whole).nearer()]);
        standings(
            &self.jaws,
            whole.map(|(element, _)| element.nodes).chain(hung),
        )
    }
}
