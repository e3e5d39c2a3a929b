//! The pull of masses in motion: from one point of the curve to the next.
//!
//! Nodes have the velocities of an even stretch at the start, and drag resists what they do beside that. Leapfrog:
//! velocities half a step before and after the places, drag by their mean. Parts break in the step in which their failure
//! index has come to 1, all of them at once. Energies are those of one moment: the mean velocity is that of the places.
//!
//! Long for its two halves, the steps and what every pull is asked, share one state.
use std::borrow::Cow;
use std::f64::consts::PI;

use nalgebra::Vector3;

use super::super::balance::{Forces, Motion};
use super::super::clusters::{Clusters, Standing};
use super::super::element::PARTS;
use super::super::equilibrium::{Equilibrium, Refactoring};
use super::super::error::FrameError;
use super::super::events::{Bore, Breaking, Broken, Event, PullEnd, Step, bore};
use super::super::network::Network;
use super::super::places::Jaw;
use super::super::pull::PullTest;
use super::super::pulling::{CurvePoint, Loads, Pulling};
use super::super::springs::SpringSum;
use super::super::state::{Interval, Moved, Moving, MovingPeak, PullCost, PullState};
use super::super::survey::{breaks_at, survey_of};
use super::masses::Masses;
use super::{MotionReport, MotionTest};

/// Force over the largest from which on it is asked whether all is at rest.
const ASKED_FROM: f64 = 0.1;

/// A pull under way.
#[derive(Debug)]
pub(crate) struct MovingPull<'n, E: SpringSum> {
    network: &'n Network,
    test: PullTest,
    state: PullState,
    elements: Cow<'n, [E]>,
    is_whole: Vec<bool>,
    free: Vec<u32>,
    masses: Masses,
    gyration: f64,
    added_mass: f64,
    steps_of_interval: u64,
    /// Speed of the right jaw [µm/µs], and drag [1/µs].
    speed: f64,
    drag: f64,
    step_us: f64,
    motion: Motion,
    velocity: Vec<[Vector3<f64>; 2]>,
    forces: Forces,
    now: Moved,
}

/// The largest force is sought in means over at most this share of the stretch so far that end where something breaks,
/// and in at most an interval of the curve: where force grows evenly, the last mean before a break is half of it too
/// low. Shorter ones would find waves.
const WINDOW: f64 = 0.01;

/// Steps of which a force is the mean.
struct Window {
    from_um: f64,
    work_from_nj: f64,
    steps: u64,
    /// Of the right jaw [mN].
    force: f64,
}

/// Sums over the steps of an interval.
#[derive(Default)]
struct Sums {
    steps: u64,
    forces: [f64; 2],
    kinetic: f64,
    stored: f64,
    /// At the last step: kinetic and stored energy, work, what drag took and breaks set free [nJ].
    last: [f64; 5],
}

impl<'n, E: SpringSum> MovingPull<'n, E> {
    /// Holds the network in its jaws, or goes on from a state of the same network and test.
    ///
    /// # Errors
    /// [`FrameError`] when the test is outside its range, or bonds have no nodes of their own.
    pub(crate) fn resume(
        network: &'n Network,
        test: PullTest,
        motion: MotionTest,
        state: PullState,
    ) -> Result<Self, FrameError> {
        if !network.hanging().is_empty() {
            return Err(FrameError::Hanging);
        }
        if network.yields() {
            return Err(FrameError::Yields);
        }
        test.check()?;
        motion.check()?;
        state.check(network)?;
        let elements = Cow::Borrowed(E::of(network));
        let is_whole = network.unbroken();
        let masses = Masses::new(network, &elements, &is_whole, &motion);
        let length = network.model().length_um;
        let speed = motion.strain_rate_per_us * length;
        let until_us = test.max_strain / motion.strain_rate_per_us;
        // whole steps between points, none longer than is stable
        let interval_us = until_us / f64::from(motion.points);
        let steps_of_interval = (interval_us / masses.step_us).ceil().max(1.0);
        let free = (0..network.nodes() as u32).filter(|&node| network.jaw(node as usize).is_none());
        let mut pull = Self {
            network,
            test,
            elements,
            is_whole,
            free: free.collect(),
            gyration: network.gyration_um(),
            added_mass: masses.added,
            steps_of_interval: steps_of_interval as u64,
            speed,
            drag: 0.0,
            step_us: interval_us / steps_of_interval,
            motion: Motion::rest(network.nodes()),
            velocity: vec![[Vector3::zeros(); 2]; network.nodes()],
            forces: Forces::new(network.nodes()),
            now: Moved::default(),
            masses,
            state,
        };
        match pull.state.moving.take() {
            Some(moving) => pull.put(moving)?,
            None => pull.start()?,
        }
        // the slowest vibration along the pull of a rod between both jaws: π √(K/M)
        let mass = (1.0 + pull.added_mass) * pull.masses.own;
        if mass > 0.0 {
            let stiffness = pull.state.measures.initial_stiffness_mn / length;
            pull.drag = 2.0 * motion.damping * PI * (stiffness / mass).sqrt();
        }
        Ok(pull)
    }

    /// Force per strain [mN] at rest, before anything breaks.
    fn stiffness_at_rest(network: &'n Network) -> Result<f64, FrameError> {
        let unit = (1.0, [].as_slice());
        let whole = ([].as_slice(), [].as_slice());
        let rest = Equilibrium::<E>::new(
            network,
            Clusters::Spanning,
            unit,
            Refactoring::ByCost,
            whole,
        )?;
        Ok(rest.forces.at_jaws(network.jaws())[1] * network.model().length_um)
    }

    /// Share of the elongation that a node has in an even stretch.
    fn even(&self, node: usize) -> f64 {
        match self.network.jaw(node) {
            Some(Jaw::Left) => 0.0,
            Some(Jaw::Right) => 1.0,
            None => self.network.position_um(node)[0] / self.network.model().length_um,
        }
    }

    fn start(&mut self) -> Result<(), FrameError> {
        if self.is_spanning() {
            let stiffness = Self::stiffness_at_rest(self.network)?;
            self.state.measures.initial_stiffness_mn = stiffness;
        } else {
            self.state.ended = Some(PullEnd::NoPath);
        }
        for &node in &self.free {
            self.velocity[node as usize][0].x = self.speed * self.even(node as usize);
        }
        self.now.kinetic_at_start_nj = self.kinetic(&self.velocity);
        self.look();
        self.keep();
        Ok(())
    }

    fn put(&mut self, moving: Moving) -> Result<(), FrameError> {
        let count = self.network.nodes();
        if moving.motion.len() != count || moving.velocity.len() != count {
            return Err(FrameError::ForeignState {
                what: "motion",
                index: moving.motion.len(),
                count,
            });
        }
        for (node, (motion, velocity)) in moving.motion.iter().zip(&moving.velocity).enumerate() {
            self.motion.nodes[node] = halves(motion);
            self.velocity[node] = halves(velocity);
        }
        let mut tears = false;
        for &element in &self.state.factored {
            self.is_whole[element as usize] = false;
            tears |= E::tears(self.network, element as usize);
        }
        if tears {
            E::tear(self.network, &self.is_whole, &mut self.elements);
        }
        self.now = moving.now;
        self.look();
        self.state.moving = Some(moving);
        Ok(())
    }

    fn keep(&mut self) {
        let moving = self.state.moving.get_or_insert_default();
        moving.motion = flat(&self.motion.nodes);
        moving.velocity = flat(&self.velocity);
        moving.now = self.now;
    }

    fn kinetic(&self, velocity: &[[Vector3<f64>; 2]]) -> f64 {
        let free = self.free.iter().map(|&node| {
            let [mass, inertia] = self.masses.of_node[node as usize];
            let [shift, turn] = &velocity[node as usize];
            0.5 * (mass * shift.norm_squared() + inertia * turn.norm_squared())
        });
        free.sum()
    }

    /// Forces of what is whole; gives the least factor that would break a part.
    fn look(&mut self) -> f64 {
        let critical = survey_of(
            self.network,
            &self.elements,
            &self.is_whole,
            &self.motion,
            self.gyration,
            &mut self.forces,
        );
        critical.map_or(f64::INFINITY, |critical| critical.factor)
    }

    /// New velocities; gives kinetic energy and the power of drag [nJ/µs] at the places as they are.
    fn kick(&mut self) -> [f64; 2] {
        let half = 0.5 * self.drag * self.step_us;
        let (keep, share) = ((1.0 - half) / (1.0 + half), 1.0 / (1.0 + half));
        let length = self.network.model().length_um;
        let (mut kinetic, mut power) = (0.0, 0.0);
        for &node in &self.free {
            let node = node as usize;
            let of_mass = self.masses.of_node[node];
            let even = Vector3::x() * (self.speed * self.network.positions()[node].x / length);
            for (part, mass) in of_mass.into_iter().enumerate() {
                if mass <= 0.0 {
                    continue;
                }
                let along = if part == 0 { even } else { Vector3::zeros() };
                let before = self.velocity[node][part];
                let push = self.forces.nodes[node][part] * (self.step_us / mass);
                let after = before * keep + (along * (2.0 * half) - push) * share;
                let middle = 0.5 * (before + after);
                kinetic += 0.5 * mass * middle.norm_squared();
                power += self.drag * mass * (middle - along).dot(&middle);
                self.velocity[node][part] = after;
            }
        }
        [kinetic, power]
    }

    fn drift(&mut self) {
        for &node in &self.free {
            let node = node as usize;
            for part in 0..2 {
                self.motion.nodes[node][part] += self.velocity[node][part] * self.step_us;
            }
        }
        self.now.steps += 1;
        let elongation = self.speed * self.step_us * self.now.steps as f64;
        self.state.elongation_um = elongation;
        for (node, jaw) in self.network.jaws().iter().enumerate() {
            if *jaw == Some(Jaw::Right) {
                self.motion.nodes[node][0].x = elongation;
            }
        }
    }

    /// One step of time; gives what broke.
    fn step(&mut self, sums: &mut Sums, window: &mut Window) -> Vec<Event> {
        let (stored, work, drag) = (self.forces.energy, self.now.work_nj, self.now.drag_nj);
        let [kinetic, power] = self.kick();
        sums.last = [kinetic, stored, work, drag, self.now.released_nj];
        sums.kinetic += kinetic;
        sums.stored += stored;
        self.now.drag_nj += power * self.step_us;
        let from_mn = self.forces.at_jaws(self.network.jaws());
        self.drift();
        let factor = self.look();
        let to_mn = self.forces.at_jaws(self.network.jaws());
        let middle = [0, 1].map(|jaw| 0.5 * (from_mn[jaw] + to_mn[jaw]));
        self.now.work_nj += middle[1] * self.speed * self.step_us;
        sums.steps += 1;
        for (sum, force) in sums.forces.iter_mut().zip(middle) {
            *sum += force;
        }
        window.steps += 1;
        window.force += middle[1];
        if factor <= 1.0 {
            self.break_parts()
        } else {
            Vec::new()
        }
    }

    /// Breaks all that is at its limit, the most loaded first.
    fn break_parts(&mut self) -> Vec<Event> {
        let network = self.network;
        let mut over: Vec<(f64, usize, [f64; PARTS])> = Vec::new();
        for element in (0..network.parts()).filter(|&element| self.is_whole[element]) {
            let loads = self.elements[element].loads(&self.motion);
            let factor = breaks_at(network, element, &loads);
            if factor <= 1.0 {
                over.push((factor, element, loads));
            }
        }
        over.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (before_mn, stored_before_nj) =
            (self.forces.at_jaws(network.jaws()), self.forces.energy);
        let mut broken: Vec<(Broken, Bore)> = Vec::with_capacity(over.len());
        let mut tears = false;
        for (_, element, loads) in &over {
            self.is_whole[*element] = false;
            self.state.factored.push(*element as u32);
            tears |= E::tears(network, *element);
            broken.push(bore(network, *element, loads));
        }
        if tears {
            E::tear(network, &self.is_whole, &mut self.elements);
        }
        self.look();
        let released_nj = stored_before_nj - self.forces.energy;
        self.now.released_nj += released_nj;
        self.state.avalanche += 1;
        self.state.measures.count(&broken);
        let breaking = Breaking {
            elongation_um: self.state.elongation_um,
            avalanche: self.state.avalanche,
            before_mn,
            after_mn: self.forces.at_jaws(network.jaws()),
            stored_before_nj,
            released_nj,
            residual: 0.0,
        };
        breaking.events(network, broken)
    }

    /// A window that begins here.
    fn window(&self) -> Window {
        Window {
            from_um: self.state.elongation_um,
            work_from_nj: self.now.work_nj,
            steps: 0,
            force: 0.0,
        }
    }

    /// Whether an interval from here is short enough to be one window.
    fn is_short(&self) -> bool {
        let whole = self.steps_of_interval;
        whole as f64 <= WINDOW * (self.now.steps + whole) as f64
    }

    /// Means since the last point of the curve, which was at `from_um`.
    fn means(&self, from_um: f64, sums: &Sums) -> Interval {
        let steps = sums.steps as f64;
        let kinetic_share = if sums.stored > 0.0 {
            sums.kinetic / sums.stored
        } else {
            f64::INFINITY
        };
        Interval {
            at_um: 0.5 * (from_um + self.state.elongation_um),
            forces_mn: sums.forces.map(|sum| sum / steps),
            kinetic_share,
            stored_nj: sums.stored / steps,
        }
    }

    /// Asks whether the force of a window, the last of these sums, is the largest so far.
    /// What broke at its end has borne it.
    fn seek_peak(&mut self, window: &Window, broke: usize, from_um: f64, sums: &Sums) {
        let force_mn = window.force / window.steps as f64;
        if force_mn <= self.state.measures.peak_force_mn {
            return;
        }
        let last = self.means(from_um, sums);
        let turn = self.largest_turn();
        let at_um = 0.5 * (window.from_um + self.state.elongation_um);
        let measures = &mut self.state.measures;
        measures.peak_force_mn = force_mn;
        measures.strain_at_peak = at_um / self.network.model().length_um;
        measures.work_to_peak_nj = 0.5 * (window.work_from_nj + self.now.work_nj);
        measures.turn_to_peak_rad = measures.turn_to_peak_rad.max(turn);
        let broken = measures.broken() - broke;
        if let Some(moving) = &mut self.state.moving {
            moving.peak = Some(MovingPeak {
                motion: flat(&self.motion.nodes),
                broken,
                intervals: moving.intervals.len(),
                last,
            });
        }
    }

    /// Takes down an interval whose steps are done.
    fn measure(&mut self, from_um: f64, sums: &Sums) {
        let [kinetic, stored, work, drag, released] = sums.last;
        let interval = self.means(from_um, sums);
        let measures = &mut self.state.measures;
        measures.stored_nj = stored;
        measures.kinetic_nj = kinetic - self.now.kinetic_at_start_nj;
        measures.work_nj = work;
        measures.drag_nj = drag;
        measures.released_nj = released;
        self.keep();
        if let Some(moving) = &mut self.state.moving {
            moving.intervals.push(interval);
        }
    }

    /// How near to rest it was up to the peak.
    fn judge(&mut self) {
        let Some(moving) = &self.state.moving else {
            return;
        };
        let peak = self.state.measures.peak_force_mn;
        let whole = moving.peak.as_ref().map_or(0, |peak| peak.intervals);
        let last = moving.peak.as_ref().map(|peak| &peak.last);
        let until_peak = moving.intervals.iter().take(whole).chain(last);
        let asked = until_peak.filter(|one| one.forces_mn[1] >= ASKED_FROM * peak);
        let (mut share, mut imbalance) = (0.0_f64, 0.0_f64);
        for one in asked {
            share = share.max(one.kinetic_share);
            imbalance = imbalance.max((one.forces_mn[1] - one.forces_mn[0]).abs() / peak);
        }
        let measures = &mut self.state.measures;
        measures.kinetic_share = Some(share);
        measures.largest_jaw_imbalance = imbalance;
    }

    fn largest_turn(&self) -> f64 {
        match self.network.tubes() {
            Some(tubes) => tubes.largest_turn(self.network.positions(), &self.motion),
            None => self
                .motion
                .nodes
                .iter()
                .map(|motion| motion[1].norm())
                .fold(0.0, f64::max),
        }
    }

    fn is_spanning(&self) -> bool {
        let standing = self.network.standing_without(&self.is_whole);
        standing.contains(&Standing::Spanning)
    }

    fn last(&self) -> Option<&Interval> {
        self.state.moving.as_ref()?.intervals.last()
    }

    fn ending(&self) -> Option<PullEnd> {
        let measures = self.state.measures;
        let last = self.last()?;
        let force = last.forces_mn[1];
        let is_broken = measures.broken() > 0;
        if is_broken && force <= 1e-3 * measures.peak_force_mn && !self.is_spanning() {
            return Some(PullEnd::Parted);
        }
        if is_broken && force <= self.test.stop_force_fraction * measures.peak_force_mn {
            return Some(PullEnd::ForceFraction);
        }
        // half a step of it may be lost to round-off
        let until_um = self.test.max_strain * self.network.model().length_um;
        let is_through = self.state.elongation_um + 0.5 * self.speed * self.step_us >= until_um;
        is_through.then_some(PullEnd::MaxStrain)
    }
}

fn flat(nodes: &[[Vector3<f64>; 2]]) -> Vec<[f64; 6]> {
    nodes
        .iter()
        .map(|[shift, turn]| [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z])
        .collect()
}

fn halves(motion: &[f64; 6]) -> [Vector3<f64>; 2] {
    let [a, b, c, d, e, f] = *motion;
    [Vector3::new(a, b, c), Vector3::new(d, e, f)]
}

impl<E: SpringSum> Pulling for MovingPull<'_, E> {
    fn advance(&mut self) -> Result<Step, FrameError> {
        if let Some(end) = self.state.ended {
            return Ok(Step::Ended(end));
        }
        if let Some(end) = self.ending() {
            // once: it reads all points
            self.judge();
            self.state.ended = Some(end);
            return Ok(Step::Ended(end));
        }
        let (from_um, is_short) = (self.state.elongation_um, self.is_short());
        let (mut sums, mut window) = (Sums::default(), self.window());
        let mut events = Vec::new();
        for _ in 0..self.steps_of_interval {
            let broke = self.step(&mut sums, &mut window);
            let is_full = window.steps as f64 >= WINDOW * self.now.steps as f64;
            let is_cut = !is_short && (is_full || !broke.is_empty());
            if is_cut || sums.steps == self.steps_of_interval {
                self.seek_peak(&window, broke.len(), from_um, &sums);
                window = self.window();
            }
            events.extend(broke);
        }
        if !self.forces.energy.is_finite() {
            return Err(FrameError::Unstable {
                step: self.now.steps,
            });
        }
        self.measure(from_um, &sums);
        Ok(Step::Moved(events))
    }

    fn elongation_um(&self) -> f64 {
        self.state.elongation_um
    }

    fn jaw_force_mn(&self) -> [f64; 2] {
        self.last().map_or([0.0; 2], |last| last.forces_mn)
    }

    fn curve_point(&self) -> CurvePoint {
        let last = self.last();
        CurvePoint {
            at_um: last.map_or(0.0, |last| last.at_um),
            forces_mn: self.jaw_force_mn(),
            stored_nj: last.map_or(0.0, |last| last.stored_nj),
            residual: last.map_or(0.0, |last| last.kinetic_share),
        }
    }

    fn displacement_um(&self, node: usize) -> [f64; 3] {
        self.motion.nodes[node][0].into()
    }

    fn turn_rad(&self) -> f64 {
        self.largest_turn()
    }

    fn loads(&self, element: usize) -> Option<Loads> {
        let is_whole = self.is_whole[element];
        is_whole.then(|| Loads(self.elements[element].loads(&self.motion)))
    }

    fn is_broken(&self, part: Broken) -> bool {
        !self.is_whole[part.element(self.network)]
    }

    /// Kinetic energy over that of the springs.
    fn residual_limit(&self) -> f64 {
        MotionReport::LARGEST_KINETIC_SHARE
    }

    fn state(&self) -> &PullState {
        &self.state
    }

    fn cost(&self) -> PullCost {
        PullCost {
            unknowns: self.free.len() * self.network.motions(),
            stored: 0,
            factors: 0,
            solutions: 0,
            iterations: 0,
        }
    }

    fn network(&self) -> &Network {
        self.network
    }

    fn residual_elongation_um(&self) -> Result<f64, FrameError> {
        Ok(0.0)
    }

    fn motion_report(&self) -> Option<MotionReport> {
        Some(MotionReport {
            step_us: self.step_us,
            steps: self.now.steps,
            added_mass: self.added_mass,
            kinetic_share: self.state.measures.kinetic_share.unwrap_or(0.0),
        })
    }
}
