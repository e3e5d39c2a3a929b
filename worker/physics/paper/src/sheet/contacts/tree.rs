//! The tree of boxes of one fibre, and the walk down two of them.
//!
//! A fibre is halved along its length until few segments are left. Nodes are stored in the order of
//! a walk down the first halves, so that the first child follows its parent.
use std::ops::Range;

use super::bounds::Bound;
use crate::sheet::SheetFibre;

/// Segments in a leaf: in a deposited sheet they are together as long as the fibre is wide, and smaller
/// boxes would hardly be smaller, since all are wider than a fibre.
const LEAF: usize = 4;

/// Boxes around a fibre and its parts.
#[derive(Clone, Debug)]
pub(super) struct Tree<B> {
    nodes: Box<[Node<B>]>,
    segments: u32,
}

#[derive(Clone, Copy, Debug)]
struct Node<B> {
    bound: B,
    /// Steps to the second child; 0 for a leaf.
    second: u32,
}

impl<B: Bound> Tree<B> {
    pub(super) fn new(fibre: &SheetFibre, gap_um: f64) -> Self {
        let segments = fibre.centre_line_um.len() - 1;
        let mut nodes = Vec::new();
        add(&mut nodes, fibre, gap_um, 0..segments);
        Self {
            nodes: nodes.into_boxed_slice(),
            segments: segments as u32,
        }
    }

    fn root(&self) -> Part {
        Part {
            node: 0,
            from: 0,
            to: self.segments,
        }
    }

    fn bound(&self, part: Part) -> &B {
        &self.nodes[part.node as usize].bound
    }

    /// Both halves of a part; none of a leaf.
    fn halves(&self, part: Part) -> Option<[Part; 2]> {
        let second = self.nodes[part.node as usize].second;
        let middle = part.from + (part.to - part.from) / 2;
        let [first, last] = [
            Part {
                node: part.node + 1,
                to: middle,
                ..part
            },
            Part {
                node: part.node + second,
                from: middle,
                ..part
            },
        ];
        (second > 0).then_some([first, last])
    }
}

fn add<B: Bound>(
    nodes: &mut Vec<Node<B>>,
    fibre: &SheetFibre,
    gap_um: f64,
    segments: Range<usize>,
) {
    let node = nodes.len();
    let points = &fibre.centre_line_um[segments.start..=segments.end];
    nodes.push(Node {
        bound: B::around(points, fibre.section, gap_um),
        second: 0,
    });
    if segments.len() > LEAF {
        let middle = segments.start + segments.len() / 2;
        add(nodes, fibre, gap_um, segments.start..middle);
        nodes[node].second = (nodes.len() - node) as u32;
        add(nodes, fibre, gap_um, middle..segments.end);
    }
}

/// A node and the segments below it.
#[derive(Clone, Copy, Debug)]
struct Part {
    node: u32,
    from: u32,
    to: u32,
}

impl Part {
    fn segments(self) -> Range<usize> {
        self.from as usize..self.to as usize
    }
}

/// The walk down two trees from the top; keeps its memory from pair to pair.
#[derive(Debug, Default)]
pub(super) struct Walk {
    open: Vec<[Part; 2]>,
    /// Pairs of boxes compared.
    pub(super) compared: u64,
}

impl Walk {
    /// Gives the segments of every two leaves whose boxes meet.
    pub(super) fn leaves<B: Bound>(
        &mut self,
        trees: [&Tree<B>; 2],
        mut visit: impl FnMut([Range<usize>; 2]),
    ) {
        let [first, second] = trees;
        self.open.push([first.root(), second.root()]);
        while let Some([one, other]) = self.open.pop() {
            self.compared += 1;
            if !first.bound(one).meets(second.bound(other)) {
                continue;
            }
            // the longer part is halved, so that boxes of like size meet
            let halves = [first.halves(one), second.halves(other)];
            let is_first_longer = one.to - one.from >= other.to - other.from;
            match halves {
                [None, None] => visit([one.segments(), other.segments()]),
                [Some(ones), others] if is_first_longer || others.is_none() => {
                    self.open.extend(ones.map(|one| [one, other]));
                }
                [_, Some(others)] => self.open.extend(others.map(|other| [one, other])),
                [Some(ones), None] => self.open.extend(ones.map(|one| [one, other])),
            }
        }
    }
}
