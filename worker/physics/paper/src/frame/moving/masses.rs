//! Masses of nodes, and the step of time that they allow.
//!
//! A segment gives half of its mass to either end; of a tube, to the points of either ring alike. Rotations of beams have
//! the moment of inertia of those halves about their end, m (l²/12 + I/A).
//!
//! The highest frequency is bounded by rows of the matrix [Gershgorin1931]: ω² ≤ max Σⱼ|Kᵢⱼ|/Mᵢ, with rotations
//! times the radius of gyration as displacements. A leapfrog is stable below 2/ω.
use super::super::network::Network;
use super::super::springs::SpringSum;
use super::MotionTest;

/// Step over the longest stable one by the bound.
const OF_STABLE: f64 = 0.9;
/// Halvings of the range of steps: beyond round-off.
const HALVINGS: usize = 60;

/// What resists acceleration.
#[derive(Debug, Clone)]
pub(super) struct Masses {
    /// Mass [µg] and moment of inertia [µg µm²] of every node.
    pub(super) of_node: Vec<[f64; 2]>,
    /// All mass of nodes that move, without what was added [µg].
    pub(super) own: f64,
    /// What was added over that.
    pub(super) added: f64,
    pub(super) step_us: f64,
}

impl Masses {
    pub(super) fn new<E: SpringSum>(
        network: &Network,
        elements: &[E],
        is_whole: &[bool],
        test: &MotionTest,
    ) -> Self {
        let gyration = network.gyration_um();
        let own_masses = of_nodes(network);
        let rows = rows(network, elements, is_whole, gyration);
        let is_free = |node: usize| network.jaw(node).is_none();
        let free: Vec<usize> = (0..network.nodes()).filter(|&node| is_free(node)).collect();
        // mass, and moment of inertia over the squared radius of gyration, that a unit of step² asks for
        let asked = |node: usize| {
            let row = &rows[node];
            let most = |part: usize| {
                row[3 * part..3 * part + 3]
                    .iter()
                    .copied()
                    .fold(0.0, f64::max)
            };
            [most(0), most(1)].map(|most| 0.25 * most / (OF_STABLE * OF_STABLE))
        };
        let has = |node: usize| {
            let [mass, inertia] = own_masses[node];
            [mass, inertia / (gyration * gyration)]
        };
        let sums = |each: &dyn Fn(usize) -> [f64; 2]| {
            free.iter()
                .map(|&node| each(node).iter().sum::<f64>())
                .sum::<f64>()
        };
        let all = sums(&has);
        let own = free.iter().map(|&node| own_masses[node][0]).sum();
        // steps that no node needs mass for, and that all need more for than may be added
        let ratios = free.iter().flat_map(|&node| {
            let (asked, has) = (asked(node), has(node));
            [0, 1].map(|part| (asked[part] > 0.0).then(|| (has[part] / asked[part]).sqrt()))
        });
        let steps: Vec<f64> = ratios.flatten().collect();
        let shortest = steps.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = steps.iter().copied().fold(0.0, f64::max);
        let lacks = |node: usize, step: f64| {
            let (asked, has) = (asked(node), has(node));
            [0, 1].map(|part| (asked[part] * step * step - has[part]).max(0.0))
        };
        let mut range = [shortest, longest.max(shortest)];
        if test.added_mass > 0.0 {
            for _ in 0..HALVINGS {
                let middle = 0.5 * (range[0] + range[1]);
                let added = sums(&|node| lacks(node, middle));
                if added <= test.added_mass * all {
                    range[0] = middle;
                } else {
                    range[1] = middle;
                }
            }
        }
        let step_us = range[0];
        let mut added = 0.0;
        let mut of_node = own_masses.clone();
        for &node in &free {
            let [mass, inertia] = lacks(node, step_us);
            of_node[node][0] += mass;
            of_node[node][1] += inertia * gyration * gyration;
            added += mass + inertia;
        }
        Self {
            of_node,
            own,
            added: if all > 0.0 { added / all } else { 0.0 },
            step_us,
        }
    }
}

/// Mass and moment of inertia of every node.
fn of_nodes(network: &Network) -> Vec<[f64; 2]> {
    let mut of_node = vec![[0.0; 2]; network.nodes()];
    for segment in 0..network.segments() {
        let section = network.section_of(segment);
        let ends = network.segment_nodes(segment);
        let (length, count) = match network.tubes() {
            None => {
                let [from, to] = ends.map(|node| network.positions()[node]);
                ((to - from).norm(), 1)
            }
            Some(tubes) => {
                let first = tubes.first_rings[segment];
                let centre = |ring| tubes.ring(network.positions(), ring).centre;
                let along = centre(first + 1) - centre(first);
                (along.norm(), tubes.points_on_ring)
            }
        };
        let half = 0.5 * section.line_density_ug_per_um * length;
        let gyration_squared = section.inertia_um4 / section.area_um2;
        let inertia = half * (length * length / 12.0 + gyration_squared);
        for end in ends {
            for node in &mut of_node[end..end + count] {
                node[0] += half / count as f64;
                node[1] += inertia / count as f64;
            }
        }
    }
    of_node
}

/// Sums of the sizes of a row's entries, by node and motion [mN/µm].
fn rows<E: SpringSum>(
    network: &Network,
    elements: &[E],
    is_whole: &[bool],
    gyration: f64,
) -> Vec<[f64; 6]> {
    let mut rows = vec![[0.0; 6]; network.nodes()];
    let scale = |motion: usize| if motion % 6 < 3 { 1.0 } else { 1.0 / gyration };
    let whole = elements
        .iter()
        .zip(is_whole)
        .filter(|(_, is_whole)| **is_whole);
    for (element, _) in whole {
        element.matrices(&mut |nodes, matrix| {
            for (row, values) in matrix.iter().enumerate() {
                let sizes = values.iter().enumerate();
                let sum: f64 = sizes
                    .map(|(column, value)| value.abs() * scale(column))
                    .sum();
                rows[nodes[row / 6] as usize][row % 6] += scale(row) * sum;
            }
        });
    }
    rows
}
