//! Bodies that are not in the scene yet.
use std::ops::Range;

use loadframe_api::spec::granular_scene::Body;

use super::{particles::Particles, specimen::Specimen};
use crate::{motion::clump::Clump, numbers::rows::Row};

/// Bodies that wait, about the origin.
#[derive(Debug, Default)]
pub(crate) struct Reserve {
    pub(crate) particles: Particles,
    pub(crate) clumps: Vec<Clump>,
    /// One for each grain.
    pub(crate) grains: Vec<Waiting>,
    /// Place of the first grain among the specimen's bodies.
    pub(crate) first: usize,
}

/// A grain that waits.
#[derive(Clone, Debug)]
pub(crate) struct Waiting {
    pub(crate) particles: Range<usize>,
    pub(crate) clump: Option<usize>,
    /// Radius of the ball that holds it [m].
    pub(crate) reach: f64,
}

impl Reserve {
    /// Takes what is not there at the start from the particles and clumps of all bodies.
    pub(crate) fn split_off(
        specimen: &Specimen<'_>,
        particles: &mut Particles,
        clumps: &mut Vec<Clump>,
    ) -> Self {
        let (there, coming) = specimen.bodies.split_at(specimen.present);
        let count = |bodies: &[Body]| {
            bodies
                .iter()
                .map(|body| body.spheres().count())
                .sum::<usize>()
        };
        let particles = particles.split_off(count(there));
        let kept = there.iter().filter(|body| body.clump.is_some()).count();
        let mut clumps = clumps.split_off(kept);
        let (mut next, mut clump) = (0, 0);
        let mut grains = Vec::with_capacity(coming.len());
        for body in coming {
            let range = next..next + body.spheres().count();
            next = range.end;
            let is_clump = body.clump.is_some();
            if is_clump {
                clumps[clump].first = range.start as u32;
            }
            let reach = |row: &Row| row.vector().norm() + row.0[3];
            grains.push(Waiting {
                reach: particles.centres[range.clone()]
                    .iter()
                    .map(reach)
                    .fold(0.0, f64::max),
                particles: range,
                clump: is_clump.then_some(clump),
            });
            clump += usize::from(is_clump);
        }
        Self {
            particles,
            clumps,
            grains,
            first: specimen.present,
        }
    }
}
