//! Spheres by where they are: which of them are near a place, however they differ in size and however
//! many share a plane.
//!
//! A tree of boxes, halved at the median along the longest side, built in n log n. In a packing that
//! can be run a sphere meets a few boxes more than it has neighbours.
use std::ops::ControlFlow;

/// A sphere of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Particle {
    /// Place among the bodies, and its number.
    pub(super) body: usize,
    pub(super) number: usize,
    pub(super) centre: [f64; 3],
    pub(super) radius: f64,
    /// Whether no force moves its body.
    pub(super) is_held: bool,
}

/// A box around spheres [m].
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) lower: [f64; 3],
    pub(super) upper: [f64; 3],
}

/// The tree, with its spheres in an order of its own.
#[derive(Debug)]
pub(super) struct SphereTree {
    pub(super) particles: Vec<Particle>,
    nodes: Vec<Node>,
}

/// Nodes stand in the order of a walk through them.
#[derive(Debug)]
struct Node {
    bounds: Bounds,
    /// The number that all of its spheres have, if they do.
    number: Option<usize>,
    first: usize,
    end: usize,
    /// The node to go on with when this one is of no interest.
    next: usize,
    is_leaf: bool,
}

/// Spheres in a box that is not halved further.
const LEAF: usize = 8;

impl Bounds {
    /// The box around one sphere.
    pub(super) fn of(particle: &Particle) -> Self {
        let at = |sign: f64| {
            particle
                .centre
                .map(|centre| centre + sign * particle.radius)
        };
        Self {
            lower: at(-1.0),
            upper: at(1.0),
        }
    }

    /// Whether the boxes have a point in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| {
            self.lower[axis] <= other.upper[axis] && other.lower[axis] <= self.upper[axis]
        })
    }

    fn and(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            self.lower[axis] = self.lower[axis].min(other.lower[axis]);
            self.upper[axis] = self.upper[axis].max(other.upper[axis]);
        }
        self
    }
}

impl SphereTree {
    pub(super) fn new(particles: Vec<Particle>) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(particles.len() / LEAF * 4 + 1),
            particles,
        };
        if !tree.particles.is_empty() {
            tree.halve(0, tree.particles.len());
        }
        tree
    }

    fn halve(&mut self, first: usize, end: usize) {
        let place = self.nodes.len();
        let own = &mut self.particles[first..end];
        let whole = own.iter().skip(1).fold(Bounds::of(&own[0]), |bounds, one| {
            bounds.and(&Bounds::of(one))
        });
        let is_leaf = own.len() <= LEAF;
        self.nodes.push(Node {
            bounds: whole,
            number: (own.iter().all(|one| one.number == own[0].number)).then_some(own[0].number),
            first,
            end,
            next: place + 1,
            is_leaf,
        });
        if is_leaf {
            return;
        }
        let centres = own
            .iter()
            .skip(1)
            .fold([own[0].centre; 2], |[low, high], one| {
                let with = |given: [f64; 3], take: fn(f64, f64) -> f64| {
                    std::array::from_fn(|axis| take(given[axis], one.centre[axis]))
                };
                [with(low, f64::min), with(high, f64::max)]
            });
        let wide = |axis: usize| centres[1][axis] - centres[0][axis];
        let widest = (1..3).fold(
            0,
            |best, axis| if wide(axis) > wide(best) { axis } else { best },
        );
        let middle = own.len() / 2;
        // spheres in one place are told apart by their numbers, so that the order is always the same
        own.select_nth_unstable_by(middle, |a, b| {
            let along = a.centre[widest].total_cmp(&b.centre[widest]);
            along.then(a.number.cmp(&b.number))
        });
        self.halve(first, first + middle);
        self.halve(first + middle, end);
        self.nodes[place].next = self.nodes.len();
    }

    /// Shows the places of all spheres in boxes that `meets` does not turn away, other than those of
    /// the number `except`, until `see` has seen enough.
    pub(super) fn visit(
        &self,
        except: Option<usize>,
        meets: impl Fn(&Bounds) -> bool,
        mut see: impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut place = 0;
        while let Some(node) = self.nodes.get(place) {
            let is_own = except.is_some() && node.number == except;
            if is_own || !meets(&node.bounds) {
                place = node.next;
                continue;
            }
            if node.is_leaf {
                for particle in node.first..node.end {
                    if except != Some(self.particles[particle].number) {
                        see(particle)?;
                    }
                }
            }
            place += 1;
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(number: usize, centre: [f64; 3], radius: f64) -> Particle {
        Particle {
            body: number,
            number,
            centre,
            radius,
            is_held: false,
        }
    }

    /// Places spread evenly without a pattern: multiples of irrational numbers, their fractions.
    fn scattered(count: usize) -> Vec<Particle> {
        let part = |index: usize, of: f64| (index as f64 * of).fract();
        let spheres = (0..count).map(|index| {
            let ways = [0.754_877_666, 0.569_840_290, 0.419_643_377];
            let centre = ways.map(|way| part(index, way));
            // sizes over five decades
            sphere(
                index,
                centre,
                0.1 * 10_f64.powf(-5.0 * part(index, 0.618_033_988)),
            )
        });
        spheres.collect()
    }

    #[test]
    fn the_tree_finds_what_a_search_through_all_finds() {
        let all = scattered(700);
        let tree = SphereTree::new(all.clone());
        for one in &all {
            let own = Bounds::of(one);
            let mut found = Vec::new();
            let end = tree.visit(
                Some(one.number),
                |bounds| bounds.meets(&own),
                |place| {
                    let other = &tree.particles[place];
                    if Bounds::of(other).meets(&own) {
                        found.push(other.number);
                    }
                    ControlFlow::Continue(())
                },
            );
            assert!(end.is_continue());
            found.sort_unstable();
            let others = all.iter().filter(|other| other.number != one.number);
            let near = others.filter(|other| Bounds::of(other).meets(&own));
            assert_eq!(found, near.map(|other| other.number).collect::<Vec<_>>());
        }
    }

    #[test]
    fn spheres_of_one_number_are_passed_over_together() {
        let clump = (0..1000).map(|_| sphere(7, [0.0; 3], 1.0));
        let tree = SphereTree::new(clump.chain([sphere(8, [0.0; 3], 1.0)]).collect());
        let mut seen = 0;
        let _ = tree.visit(
            Some(7),
            |_| true,
            |_| {
                seen += 1;
                ControlFlow::Continue(())
            },
        );
        assert_eq!(seen, 1);
    }
}
