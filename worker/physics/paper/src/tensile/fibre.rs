//! One fibre as a specimen: its tube, its constants, and the loads.
use loadframe_api::spec::paper_tensile::{PaperTensile, Pulp, SingleFibre, SingleFibreLoad};
use loadframe_harness::Halt;

use crate::fibre::equilibrium::{RESIDUAL, Rest, Supports, large, moved, small};
use crate::fibre::measure::{self, Constants, Pushed};
use crate::fibre::{Divided, Elasticity, FibreError, Section, Spring, Tube, TubeError, divide};

/// Displacement of a mode in its picture over the length of the fibre.
const MODE_SHOWN: f64 = 0.05;
/// Strain of a curled fibre's chord from which its first rest is scaled.
const FIRST_STRAIN: f64 = 1e-9;

/// The fibre of a spec, divided.
pub(super) struct Specimen<'a> {
    pub(super) spec: &'a PaperTensile,
    pub(super) single: &'a SingleFibre,
    pub(super) pulp: &'a Pulp,
    pub(super) section: Section,
    pub(super) elasticity: Elasticity,
    pub(super) divided: Divided,
    pub(super) tube: Tube,
}

/// What the load of the spec came to.
#[derive(Default)]
pub(super) struct Loaded {
    /// Largest unbalanced force over the largest force of a spring.
    pub(super) residual: f64,
    /// Force at the largest strain of a pull [mN].
    pub(super) force_mn: Option<f64>,
    /// Force over the strain of the chord, of the first step of a pull [mN].
    pub(super) stiffness_mn: Option<f64>,
    /// Of a fibre that is pinned at its ends [mN].
    pub(super) buckling_load_mn: f64,
    pub(super) factorings: u64,
}

/// A tube in a state of its test.
pub(super) struct Picture {
    /// Value of the curve's first column.
    pub(super) at: f64,
    pub(super) step: u32,
    pub(super) points_um: Vec<[f64; 3]>,
    pub(super) displacements_um: Vec<f64>,
    pub(super) tensions_mn: Vec<f64>,
}

/// Takes how far the test is, a point of the curve, and perhaps a picture.
type Observe<'a> = dyn FnMut(f64, Vec<f64>, Option<Picture>) -> Result<(), Halt> + 'a;

impl<'a> Specimen<'a> {
    pub(super) fn new(spec: &'a PaperTensile, single: &'a SingleFibre) -> Result<Self, TubeError> {
        let pulp = spec.pulp_of(single).ok_or_else(|| {
            FibreError::out_of_range("number of pulps", "1", 0.0, "a pulp of the given name")
        })?;
        let (section, elasticity) = (pulp.section()?, pulp.elasticity()?);
        let length_um = 1e3 * pulp.mean_length_mm();
        let divided = divide(length_um, &section, &elasticity, &spec.model.division())?;
        let tube = match single.load {
            SingleFibreLoad::Pull => Tube::curled(&divided, pulp.shape_factor)?,
            _ => Tube::straight(divided.segments, &divided.segment, &divided.springs),
        };
        Ok(Self {
            spec,
            single,
            pulp,
            section,
            elasticity,
            divided,
            tube,
        })
    }

    /// A line for the log.
    pub(super) fn described(&self) -> String {
        format!(
            "a fibre of {} segments of {:.3} µm, {} points and {} springs",
            self.divided.segments,
            self.divided.segment.length_um(),
            self.tube.places_um().len(),
            self.tube.springs().len()
        )
    }

    pub(super) fn springs(&self) -> &[Spring] {
        self.tube.springs()
    }

    pub(super) fn constants(&self) -> Result<Constants, TubeError> {
        measure::constants(&self.divided, &self.section)
    }

    /// The tube before its load.
    pub(super) fn unloaded(&self) -> Picture {
        let rest = unloaded(&self.tube);
        Picture {
            at: 0.0,
            step: 0,
            points_um: moved(&self.tube, &rest.displacements_um),
            displacements_um: rest.displacements_um,
            tensions_mn: rest.tensions_mn,
        }
    }

    /// Columns of the curve; tension, and moments that act with the turn, are positive.
    pub(super) fn columns(&self) -> &'static [&'static str] {
        self.single.load.curve_columns()
    }

    /// Does what the spec says.
    pub(super) fn load(
        &self,
        constants: &Constants,
        observe: &mut Observe<'_>,
    ) -> Result<Loaded, Halt> {
        let straight = Tube::straight(
            self.divided.segments,
            &self.divided.segment,
            &self.divided.springs,
        );
        let pushed = measure::push(&straight)?;
        let mut loaded = Loaded {
            residual: constants.residual,
            buckling_load_mn: pushed.load_mn,
            factorings: 5,
            ..Loaded::default()
        };
        let radius_um = self.divided.segment.diameter_um() / 2.0;
        let most = self.spec.test.max_strain;
        match self.single.load {
            SingleFibreLoad::Pull => self.pull(&mut loaded, observe)?,
            SingleFibreLoad::Twist => {
                let (torque, rest) = measure::twist(&self.tube, most / radius_um)?;
                // 1/µm is 1000/mm, mN µm is 10⁻⁶ N mm
                self.in_proportion(&[1e3 * most / radius_um, 1e-6 * torque], &rest, observe)?;
                loaded.residual = loaded.residual.max(rest.residual);
            }
            SingleFibreLoad::Bend => {
                let (moment, rest) = measure::bend(&self.tube, most / radius_um)?;
                self.in_proportion(&[1e3 * most / radius_um, 1e-6 * moment], &rest, observe)?;
                loaded.residual = loaded.residual.max(rest.residual);
            }
            SingleFibreLoad::Buckle => self.buckle(&pushed, observe)?,
        }
        Ok(loaded)
    }

    /// Moves the glued last ring away in equal steps, each brought to rest.
    fn pull(&self, loaded: &mut Loaded, observe: &mut Observe<'_>) -> Result<(), Halt> {
        let steps = self.spec.accuracy.knobs().load_steps;
        let chord_um = self.tube.chord_um();
        let most_um = self.spec.test.max_strain * chord_um;
        let rest = small(&self.tube, &self.glued(FIRST_STRAIN * chord_um))?;
        loaded.stiffness_mn = Some(self.force_mn(&rest, self.tube.segments()) / FIRST_STRAIN);
        let size = rest.displacements_um.len();
        let scale = most_um / f64::from(steps) / (FIRST_STRAIN * chord_um);
        let (mut before, mut now) = (vec![0.0; size], vec![0.0; size]);
        self.observe(0, &unloaded(&self.tube), observe)?;
        for step in 1..=steps {
            // on along the straight line from the last rest but one
            let start: Vec<f64> = match step {
                1 => rest
                    .displacements_um
                    .iter()
                    .map(|part| scale * part)
                    .collect(),
                _ => now
                    .iter()
                    .zip(&before)
                    .map(|(now, before)| 2.0 * now - before)
                    .collect(),
            };
            let by_um = most_um * f64::from(step) / f64::from(steps);
            let rest = large(&self.tube, &self.glued(by_um), &start)?;
            before = std::mem::replace(&mut now, rest.displacements_um.clone());
            loaded.residual = loaded.residual.max(rest.residual);
            loaded.factorings += u64::from(rest.factorings);
            loaded.force_mn = Some(self.force_mn(&rest, self.tube.segments()));
            self.observe(step, &rest, observe)?;
        }
        Ok(())
    }

    fn observe(&self, step: u32, rest: &Rest, observe: &mut Observe<'_>) -> Result<(), Halt> {
        let steps = self.spec.accuracy.knobs().load_steps;
        let fraction = f64::from(step) / f64::from(steps);
        let strain = self.spec.test.max_strain * fraction;
        let point = vec![
            strain,
            1e-3 * self.force_mn(rest, self.tube.segments()),
            -1e-3 * self.force_mn(rest, 0),
            0.0,
            rest.residual / RESIDUAL,
        ];
        let every = self.spec.output.snapshot_every_steps;
        let is_due = every > 0 && (step.is_multiple_of(every) || step == steps);
        let picture = is_due.then(|| Picture {
            at: strain,
            step,
            points_um: moved(&self.tube, &rest.displacements_um),
            displacements_um: rest.displacements_um.clone(),
            tensions_mn: rest.tensions_mn.clone(),
        });
        observe(fraction, point, picture)
    }

    /// A curve that is a straight line to its end, where the picture is taken.
    fn in_proportion(
        &self,
        end: &[f64; 2],
        rest: &Rest,
        observe: &mut Observe<'_>,
    ) -> Result<(), Halt> {
        let steps = self.spec.accuracy.knobs().load_steps;
        for step in 0..=steps {
            let fraction = f64::from(step) / f64::from(steps);
            let point = vec![
                fraction * end[0],
                fraction * end[1],
                rest.residual / RESIDUAL,
            ];
            let is_last = step == steps && self.spec.output.snapshot_every_steps > 0;
            let picture = is_last.then(|| Picture {
                at: end[0],
                step,
                points_um: moved(&self.tube, &rest.displacements_um),
                displacements_um: rest.displacements_um.clone(),
                tensions_mn: rest.tensions_mn.clone(),
            });
            observe(fraction, point, picture)?;
        }
        Ok(())
    }

    /// The straight path up to the load at which the fibre leaves it, and the mode it leaves by.
    fn buckle(&self, pushed: &Pushed, observe: &mut Observe<'_>) -> Result<(), Halt> {
        let steps = self.spec.accuracy.knobs().load_steps;
        let last = self.tube.segments();
        let shortening_um = self.tube.ring(last).next().map_or(0.0, |point| {
            pushed.prestress.displacements_um[3 * point] - pushed.prestress.displacements_um[0]
        });
        let strain = pushed.load_mn * shortening_um / self.tube.length_um();
        for step in 0..=steps {
            let fraction = f64::from(step) / f64::from(steps);
            let force_n = -1e-3 * fraction * pushed.load_mn;
            let residual = pushed.prestress.residual / RESIDUAL;
            let point = vec![fraction * strain, force_n, force_n, 0.0, residual];
            let is_last = step == steps && self.spec.output.snapshot_every_steps > 0;
            let picture = is_last.then(|| {
                let shown = MODE_SHOWN * self.tube.length_um();
                let mode: Vec<f64> = pushed
                    .buckling
                    .mode
                    .iter()
                    .map(|part| shown * part)
                    .collect();
                let tensions = pushed.prestress.tensions_mn.iter();
                Picture {
                    at: strain,
                    step,
                    points_um: moved(&self.tube, &mode),
                    displacements_um: mode,
                    tensions_mn: tensions.map(|tension| pushed.load_mn * tension).collect(),
                }
            });
            observe(fraction, point, picture)?;
        }
        Ok(())
    }

    /// Both end rings glued, the last moved along x.
    fn glued(&self, by_um: f64) -> Supports {
        let mut supports = Supports::none(&self.tube);
        supports.move_ring(&self.tube, 0, |_| [Some(0.0); 3]);
        let last = self.tube.segments();
        supports.move_ring(&self.tube, last, |_| [Some(by_um), Some(0.0), Some(0.0)]);
        supports
    }

    /// Sum of a ring's reactions along x [mN].
    fn force_mn(&self, rest: &Rest, ring: usize) -> f64 {
        self.tube
            .ring(ring)
            .map(|point| rest.reactions_mn[3 * point])
            .sum()
    }
}

fn unloaded(tube: &Tube) -> Rest {
    let size = 3 * tube.places_um().len();
    Rest {
        displacements_um: vec![0.0; size],
        reactions_mn: vec![0.0; size],
        tensions_mn: vec![0.0; tube.springs().len()],
        residual: 0.0,
        factorings: 0,
    }
}
