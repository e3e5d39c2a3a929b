//! A network as it is strained: where its nodes are, and what its segments have become longer for good.
use nalgebra::Vector3;

use super::super::balance::{Forces, Motion};
use super::super::element::PARTS;
use super::super::error::FrameError;
use super::super::input::Level;
use super::super::network::Network;
use super::law::{Law, Plastic};

/// How much longer a segment is for good, by how much it has hardened [µm], and whether it flows.
type KeptSegment = (f64, f64, bool);

/// Where a network is, and the forces there.
#[derive(Debug, Clone)]
pub(super) struct Strained<'n> {
    pub(super) network: &'n Network,
    /// Of every segment; none where it never yields.
    pub(super) laws: Vec<Option<Law>>,
    pub(super) motion: Motion,
    pub(super) plastic: Vec<Plastic>,
    pub(super) forces: Forces,
    gyration: f64,
}

impl<'n> Strained<'n> {
    /// As it was made.
    pub(super) fn new(network: &'n Network) -> Self {
        let laws = (0..network.segments())
            .map(|segment| Law::new(network.section_of(segment), &network.elements()[segment]));
        let fresh = Plastic {
            longer_um: 0.0,
            hardened_um: 0.0,
            flows: false,
        };
        Self {
            network,
            laws: laws.collect(),
            motion: Motion::rest(network.nodes()),
            plastic: vec![fresh; network.segments()],
            forces: Forces::new(network.nodes()),
            gyration: network.gyration_um(),
        }
    }

    /// Forces of what is active.
    pub(super) fn look(&mut self, is_active: &[bool]) {
        self.forces.clear();
        let is_truss = self.network.model().level == Level::Truss;
        for (index, element) in self.network.elements().iter().enumerate() {
            if !is_active[index] {
                continue;
            }
            let longer = self.longer_um(index);
            let loads = self
                .forces
                .add_longer(element, &self.motion, longer, self.gyration);
            if is_truss && index < self.network.segments() {
                self.forces.taut_energy += 0.5
                    * (1..3)
                        .map(|part| loads[part] * loads[part] / element.stiffness[part])
                        .sum::<f64>();
            }
        }
    }

    /// The same after every segment went straight from where it was, `before`, to where its nodes are.
    pub(super) fn flow(&mut self, is_active: &[bool], before: &[Plastic]) {
        for (segment, law) in self.laws.iter().enumerate() {
            let Some(law) = law else {
                continue;
            };
            if !is_active[segment] {
                // it bears nothing, wherever its nodes go
                self.plastic[segment].flows = false;
            } else {
                let elongation = self.elongation_um(segment);
                let flows = self.plastic[segment].flows;
                self.plastic[segment] = law.reach(elongation, before[segment], flows);
            }
        }
        self.look(is_active);
    }

    /// Loads q of an element.
    pub(super) fn loads(&self, index: usize) -> [f64; PARTS] {
        let element = &self.network.elements()[index];
        let mut deformation = element.deformation(&self.motion.ends(element));
        deformation[0] -= self.longer_um(index);
        element.loads(&deformation)
    }

    /// Elongation of a segment [µm].
    fn elongation_um(&self, segment: usize) -> f64 {
        let element = &self.network.elements()[segment];
        element.deformation(&self.motion.ends(element))[0]
    }

    fn longer_um(&self, element: usize) -> f64 {
        let plastic = self.plastic.get(element);
        plastic.map_or(0.0, |plastic| plastic.longer_um)
    }

    /// Moves on, flowing segments flow: with the motion, and the elongations it gives them.
    pub(super) fn moved(&mut self, from: &Motion) {
        let network = self.network;
        for (segment, plastic) in self.plastic.iter_mut().enumerate() {
            if let (true, Some(law)) = (plastic.flows, &self.laws[segment]) {
                let element = &network.elements()[segment];
                let [now, then] = [&self.motion, from]
                    .map(|motion| element.deformation(&motion.ends(element))[0]);
                let more = law.lasting() * (now - then);
                let force = law.stiffness * (then - plastic.longer_um);
                plastic.longer_um += more;
                plastic.hardened_um += more * force.signum();
            }
        }
    }

    /// Work that yielding has taken so far [nJ], of broken segments, too.
    pub(super) fn dissipated_nj(&self) -> f64 {
        let segments = self.laws.iter().zip(&self.plastic);
        segments
            .filter_map(|(law, plastic)| Some(law.as_ref()?.dissipated(plastic.hardened_um)))
            .sum()
    }

    /// Share of the length of all fibres that has yielded.
    pub(super) fn yielded_share(&self) -> f64 {
        let (mut yielded, mut all) = (0.0, 0.0);
        for (segment, plastic) in self.plastic.iter().enumerate() {
            let [from, to] = self.network.segment_nodes(segment);
            let length = self.network.arc_um(to) - self.network.arc_um(from);
            all += length;
            if plastic.hardened_um > 0.0 {
                yielded += length;
            }
        }
        if all > 0.0 { yielded / all } else { 0.0 }
    }

    /// Largest turn of a node [rad].
    pub(super) fn turn_rad(&self) -> f64 {
        let turns = self.motion.nodes.iter().map(|motion| motion[1].norm());
        turns.fold(0.0, f64::max)
    }

    /// Where nodes and segments are, to go on from.
    pub(super) fn kept(&self) -> (Vec<[f64; 6]>, Vec<KeptSegment>) {
        let motion = self
            .motion
            .nodes
            .iter()
            .map(|[shift, turn]| [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z]);
        let segments = self
            .plastic
            .iter()
            .map(|plastic| (plastic.longer_um, plastic.hardened_um, plastic.flows));
        (motion.collect(), segments.collect())
    }

    /// # Errors
    /// [`FrameError::ForeignState`] when it is not of this network.
    pub(super) fn put(
        &mut self,
        motion: &[[f64; 6]],
        segments: &[(f64, f64, bool)],
    ) -> Result<(), FrameError> {
        let foreign = |what, index, count| FrameError::ForeignState { what, index, count };
        let nodes = self.network.nodes();
        if motion.len() != nodes {
            return Err(foreign("node", motion.len(), nodes));
        }
        if segments.len() != self.plastic.len() {
            return Err(foreign("segment", segments.len(), self.plastic.len()));
        }
        let nodes = motion
            .iter()
            .map(|[x, y, z, a, b, c]| [[*x, *y, *z], [*a, *b, *c]].map(Vector3::from));
        self.motion = Motion {
            nodes: nodes.collect(),
        };
        let plastic = segments
            .iter()
            .map(|&(longer_um, hardened_um, flows)| Plastic {
                longer_um,
                hardened_um,
                flows,
            });
        self.plastic = plastic.collect();
        Ok(())
    }
}
