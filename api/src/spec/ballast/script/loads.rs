//! The stages of the load: the smallest force, then block by block.
use super::super::super::granular_scene::{
    Axis, BodyDrive, BodyForce, Drive, Stage, Until, WallDrive, WallForce,
};
use super::{
    super::{
        Apparatus, Ballast, Materials,
        loading::{Cycles, Motion, Pace},
    },
    Course, GRAVITY, Load, Phase, Script,
};

/// Part of a period during which the smallest force acts before the first cycle.
const SEATING: f64 = 0.05;

impl<A: Apparatus> Ballast<A> {
    /// The blocks of the load, with all that each took from those before.
    pub(in crate::spec::ballast) fn blocks(&self) -> Vec<Cycles> {
        let knobs = self.accuracy.knobs();
        let aggregate = &self.materials.aggregate;
        let pace = Pace {
            inertial_number: knobs.inertial_number,
            area: self.apparatus.loaded_area(),
            diameter: (self.spheres_first()).map_or_else(
                || self.grains.mean_diameter(),
                |first| first.mean_diameter(),
            ),
            density: aggregate.density_kg_per_m3,
            modulus: knobs.stiffness * aggregate.youngs_modulus_pa,
        };
        self.test.blocks(&pace, self.apparatus.bed_height())
    }

    /// The smallest force, then the cycles.
    pub(super) fn load(&self, script: &mut Script, materials: &Materials) {
        let mass = self.apparatus.loading_mass(materials);
        if !A::IS_OEDOMETER {
            script.weight = mass * GRAVITY;
        }
        let mut cycle = 0;
        let mut before: Option<Cycles> = None;
        for (block, cycles) in self.blocks().into_iter().enumerate() {
            let [smallest, peak] = cycles.forces;
            let time = cycles.cycle_time();
            let seat = match before {
                None => Some(script.force(mass, [smallest; 2], f64::INFINITY, SEATING * time)),
                Some(before) if before.forces[0].to_bits() != smallest.to_bits() => {
                    // half a swing from the old force to the new one
                    let period = before.cycle_time();
                    let forces = [before.forces[0], smallest];
                    Some(script.force(mass, forces, period, 0.5 * period))
                }
                Some(_) => None,
            };
            if let Some(seat) = seat {
                script.add(Phase::Seat, seat);
            }
            match cycles.motion {
                Motion::Force { period } => {
                    let time = f64::from(cycles.cycles) * period;
                    let stage = script.force(mass, cycles.forces, period, time);
                    let course = Course::Swing {
                        period,
                        cycles: cycles.cycles,
                    };
                    script.add_load(block, cycle, course, stage);
                }
                Motion::Machine {
                    velocity, largest, ..
                } => {
                    for cycle in (cycle..).take(cycles.cycles as usize) {
                        let down = script.machine(-velocity, largest, peak);
                        script.add_load(block, cycle, Course::Down { force: peak }, down);
                        let up = script.machine(velocity, largest, smallest);
                        script.add_load(block, cycle, Course::Up, up);
                    }
                }
            }
            cycle += cycles.cycles as usize;
            before = Some(cycles);
        }
    }
}

impl Script {
    fn add_load(&mut self, block: usize, cycle: usize, course: Course, stage: Stage) {
        let load = Load {
            block,
            cycle,
            course,
        };
        self.loads.insert(self.scene.stages.len(), load);
        self.add(Phase::Load, stage);
    }

    /// A force on the wall of this mass [kg], downward, that swings between two values [N] with a period
    /// [s], for a time [s].
    fn force(&self, mass_kg: f64, forces: [f64; 2], period: f64, time: f64) -> Stage {
        // gravity acts on a body, and must be given to a wall
        let own = if self.body.is_some() {
            0.0
        } else {
            self.weight
        };
        let [force_n, peak] = forces.map(|force| [0.0, 0.0, -(force + own)]);
        let swings = period.is_finite();
        let (peak_force_n, period_s) = (swings.then_some(peak), swings.then_some(period));
        let wall = || WallDrive {
            force: Some(WallForce {
                mass_kg,
                force_n,
                peak_force_n,
                period_s,
                free: vec![Axis::Z],
            }),
            ..WallDrive::of(&self.wall)
        };
        let body = |body| BodyDrive {
            body,
            velocity: None,
            force: Some(BodyForce {
                force_n,
                at_m: self.rail,
                peak_force_n,
                period_s,
            }),
        };
        Stage::Drive(Drive {
            walls: self.body.is_none().then(wall).into_iter().collect(),
            bodies: self.body.map(body).into_iter().collect(),
            flow: false,
            friction_factor: 1.0,
            until: None,
            steps: None,
            time_s: Some(time),
        })
    }

    /// A machine that moves the wall at a velocity along z [m/s], this far at most [m], until the bed
    /// presses on it with a force [N] beside its weight.
    fn machine(&self, velocity: f64, largest: f64, force: f64) -> Stage {
        let force = force + self.weight;
        Stage::Drive(Drive {
            walls: vec![WallDrive {
                velocity_m_per_s: Some([0.0, 0.0, velocity]),
                ..WallDrive::of(&self.wall)
            }],
            bodies: Vec::new(),
            flow: false,
            friction_factor: 1.0,
            until: Some(Until {
                wall: self.wall.clone(),
                axis: Axis::Z,
                at_least_n: (velocity < 0.0).then_some(force),
                at_most_n: (velocity > 0.0).then_some(force),
            }),
            steps: None,
            time_s: Some(largest / velocity.abs()),
        })
    }
}
