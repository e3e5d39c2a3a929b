//! The pull of a network whose fibres turn and straighten: step by step, and break by break.
//!
//! The elongation grows by steps. When something is over its limit after one, the elongation at which
//! the first is just there is sought between the last two, and it breaks; what is over its limit then
//! breaks at that elongation, the worst first, until all holds.
use super::super::clusters::Clusters;
use super::super::element::stress_gpa;
use super::super::error::{FrameError, check};
use super::super::events::{Bore, Broken, Event, PullEnd};
use super::super::network::Network;
use super::super::pull::PullTest;
use super::super::survey::bond_index;
use super::newton::{Found, Newton};
use super::shape::Shape;

/// A part breaks when it is this close to its limit, or the elongation is known to this share of a step.
const AT_LIMIT: f64 = 1e-8;

/// Looks for the elongation of a break; each wins a digit or more.
const LOOKS: usize = 40;

/// How a network is pulled at large motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargePullTest {
    pub until: PullTest,
    /// Strain of a step: how finely the curve is seen, and how far Newton goes at once.
    pub strain_step: f64,
}

/// What a step of the pull gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LargeStep {
    /// All holds at this strain and force of the moving jaw [mN].
    Reached {
        strain: f64,
        force_mn: f64,
    },
    Broke(Event),
    Ended(PullEnd),
}

/// A pull under way.
#[derive(Debug)]
pub struct LargePull<'n> {
    newton: Newton<'n>,
    test: LargePullTest,
    is_whole: Vec<bool>,
    shape: Shape,
    found: Found,
    elongation_um: f64,
    worst: Option<Worst>,
    is_falling: bool,
    avalanche: u32,
    peak_mn: f64,
    broken: usize,
    ended: Option<PullEnd>,
}

/// The element nearest to its limit: 1 is there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Worst {
    element: usize,
    index: f64,
    bore: Bore,
}

impl<'n> LargePull<'n> {
    /// Holds the network in its jaws.
    ///
    /// # Errors
    /// [`FrameError`] when the test is outside its range, or the network has no equilibrium.
    pub fn new(network: &'n Network, test: LargePullTest) -> Result<Self, FrameError> {
        let (strain, fraction) = (test.until.max_strain, test.until.stop_force_fraction);
        check(|| "largest strain".into(), strain, strain > 0.0, "above 0")?;
        check(
            || "strain step".into(),
            test.strain_step,
            test.strain_step > 0.0,
            "above 0",
        )?;
        let is_share = (0.0..1.0).contains(&fraction);
        check(
            || "force fraction".into(),
            fraction,
            is_share,
            "0 to below 1",
        )?;
        let precision = test.until.break_precision;
        check(
            || "break precision".into(),
            precision,
            precision == 0.0,
            "0 with large displacements",
        )?;
        if network.yields() {
            return Err(FrameError::Yields);
        }
        let is_whole = network.unbroken();
        let mut newton = Newton::new(network, &is_whole, Clusters::Spanning)?;
        let mut shape = Shape::of(network);
        let found = newton.settle(&mut shape, &[], 1.0)?;
        let ended = (!newton.is_active.contains(&true)).then_some(PullEnd::NoPath);
        Ok(Self {
            newton,
            test,
            is_whole,
            shape,
            found,
            elongation_um: 0.0,
            worst: None,
            is_falling: false,
            avalanche: 0,
            peak_mn: 0.0,
            broken: 0,
            ended,
        })
    }

    /// Goes on by a step or to a break.
    ///
    /// # Errors
    /// [`FrameError`] when equilibrium is not found.
    pub fn advance(&mut self) -> Result<LargeStep, FrameError> {
        if let Some(end) = self.ended {
            return Ok(LargeStep::Ended(end));
        }
        if self.is_falling {
            match self.worst {
                Some(worst) if worst.index >= 1.0 => return self.break_part(worst),
                _ => self.is_falling = false,
            }
        }
        let length = self.newton.network.model().length_um;
        let last = self.test.until.max_strain * length;
        if self.broken > 0 && self.force_mn() <= self.test.until.stop_force_fraction * self.peak_mn
        {
            return Ok(self.end(PullEnd::ForceFraction));
        }
        if self.elongation_um >= last {
            return Ok(self.end(PullEnd::MaxStrain));
        }
        let step = self.test.strain_step * length;
        let (start, before) = (self.shape.clone(), self.elongation_um);
        let start_index = self.worst.map_or(0.0, |worst| worst.index);
        self.go(&start, before, (before + step).min(last))?;
        self.find_limit(&start, before, start_index)?;
        self.peak_mn = self.peak_mn.max(self.force_mn());
        match self.worst {
            Some(worst) if worst.index >= 1.0 => {
                self.avalanche += 1;
                self.is_falling = true;
                self.break_part(worst)
            }
            _ => Ok(LargeStep::Reached {
                strain: self.elongation_um / length,
                force_mn: self.force_mn(),
            }),
        }
    }

    /// Elongation as it is [µm].
    #[must_use]
    pub fn elongation_um(&self) -> f64 {
        self.elongation_um
    }

    /// Forces of the left and the right jaw, positive when they pull [mN].
    #[must_use]
    pub fn jaw_force_mn(&self) -> [f64; 2] {
        self.found.forces.at_jaws(self.newton.network.jaws())
    }

    /// Elastic energy [nJ].
    #[must_use]
    pub fn energy_nj(&self) -> f64 {
        self.found.forces.energy
    }

    /// Where a node is [µm].
    #[must_use]
    pub fn position_um(&self, node: usize) -> [f64; 3] {
        self.shape.positions[node].into()
    }

    fn force_mn(&self) -> f64 {
        self.jaw_force_mn()[1]
    }

    /// From a shape at one elongation to the equilibrium at another.
    fn go(&mut self, from: &Shape, before_um: f64, to_um: f64) -> Result<(), FrameError> {
        self.shape.clone_from(from);
        self.newton.elongate(&mut self.shape, to_um - before_um);
        self.found = self.newton.settle(&mut self.shape, &[], 1.0)?;
        self.elongation_um = to_um;
        self.worst = self.worst();
        Ok(())
    }

    /// When the last step went beyond a limit: back to where it is reached, by false position that halves
    /// where it does not win.
    fn find_limit(
        &mut self,
        start: &Shape,
        start_um: f64,
        start_index: f64,
    ) -> Result<(), FrameError> {
        let (mut low, mut low_index) = (start_um, start_index.min(1.0));
        let step = self.elongation_um - start_um;
        for look in 0..LOOKS {
            let index = self.worst.map_or(0.0, |worst| worst.index);
            let high = self.elongation_um;
            if look == 0 && index < 1.0 {
                return Ok(());
            }
            if index >= 1.0 && (index - 1.0 <= AT_LIMIT || high - low <= AT_LIMIT * step) {
                return Ok(());
            }
            let share = if look % 3 == 2 {
                0.5
            } else {
                (1.0 - low_index) / (index - low_index)
            };
            // a little beyond the guess, so that it comes from above
            let guess = low + (high - low) * (share + 0.1 * AT_LIMIT).clamp(1e-6, 1.0 - 1e-6);
            let over = (self.shape.clone(), self.found.clone(), high, self.worst);
            self.go(start, start_um, guess)?;
            let found = self.worst.map_or(0.0, |worst| worst.index);
            if found < 1.0 {
                (low, low_index) = (guess, found);
                (self.shape, self.found, self.elongation_um, self.worst) = over;
            }
        }
        Ok(())
    }

    fn worst(&self) -> Option<Worst> {
        let network = self.newton.network;
        let segments = network.segments();
        let mut worst: Option<Worst> = None;
        for (element, response) in self.newton.responses(&self.shape) {
            let Some(response) = response else { continue };
            let loads = response.loads;
            let (index, bore) = if element < segments {
                let section = network.section_of(element);
                let stress_gpa = stress_gpa(section, network.model().level, &loads);
                let index = section
                    .strength_gpa
                    .map_or(0.0, |strength| stress_gpa / strength);
                (index, Bore::Segment { stress_gpa })
            } else {
                let bore = Bore::Bond {
                    normal_mn: loads[0],
                    shear_mn: loads[1].hypot(loads[2]),
                };
                (
                    bond_index(&loads, network.strengths(element - segments)),
                    bore,
                )
            };
            if index > worst.map_or(0.0, |worst| worst.index) {
                worst = Some(Worst {
                    element,
                    index,
                    bore,
                });
            }
        }
        worst
    }

    fn break_part(&mut self, worst: Worst) -> Result<LargeStep, FrameError> {
        let network = self.newton.network;
        let [left_force_before_mn, force_before_mn] = self.jaw_force_mn();
        let stored_before_nj = self.energy_nj();
        self.is_whole[worst.element] = false;
        self.broken += 1;
        self.newton = Newton::new(network, &self.is_whole, Clusters::Spanning)?;
        self.found = self.newton.settle(&mut self.shape, &[], 1.0)?;
        self.worst = self.worst();
        if !self.newton.is_active.contains(&true) {
            self.ended = Some(PullEnd::Parted);
        }
        let [left_force_after_mn, force_after_mn] = self.jaw_force_mn();
        let broken = match worst.element.checked_sub(network.segments()) {
            Some(bond) => Broken::Bond(bond),
            None => Broken::Segment(worst.element),
        };
        Ok(LargeStep::Broke(Event {
            strain: self.elongation_um / network.model().length_um,
            elongation_um: self.elongation_um,
            avalanche: self.avalanche,
            broken,
            bore: worst.bore,
            force_before_mn,
            force_after_mn,
            left_force_before_mn,
            left_force_after_mn,
            stored_before_nj,
            energy_released_nj: stored_before_nj - self.energy_nj(),
            residual: self.found.residual,
        }))
    }

    fn end(&mut self, end: PullEnd) -> LargeStep {
        self.ended = Some(end);
        LargeStep::Ended(end)
    }
}
