//! Equilibrium of the few nodes that are far from it, while all others rest.
//!
//! Where a bond broke or buckled the net moves far, elsewhere hardly at all. Newton's method on the
//! whole needs several iterations for that place, each as dear as if everything moved. So the worst
//! nodes are brought to equilibrium together with what is a few bonds around them, part by part; the
//! step of the whole that follows is nearly linear. As the others rest, the energy of the whole
//! falls by as much as that of the parts.
//!
//! Source: nonlinear elimination, [LanzkronRoseWilkes1996].
use super::{
    Search,
    newton_cg::{Memory, descend},
    work::Meter,
};
use crate::{
    Interrupt,
    network::{
        Vector,
        assembly::Assembly,
        configuration::{Configuration, Residual},
        field::Field,
        places::NONE,
    },
    parallel::Team,
};

/// A node counts as far from equilibrium when its resultant is this part of the largest: what is
/// nearer is for the step of the whole.
const SHARE_OF_WORST: f64 = 0.1;
/// Largest resultant over the limit below which a step of the whole does it all.
const NEARLY_BALANCED: f64 = 3.0;
/// Bonds from a node far from equilibrium to the nodes at rest: with fewer too much of its force is
/// handed on to them, with more the part costs as much as it saves. From 4 to 7 all serve alike.
const RINGS: usize = 5;
/// Parts of more than this share of the free nodes together cost as much as the whole.
const LARGEST_SHARE: f64 = 0.15;
/// More nodes far from equilibrium than this share of the free ones are hardly ever so close together
/// that their parts would be small: to list those would be in vain.
const MOST_FAR: f64 = LARGEST_SHARE / 12.0;
/// Newton iterations for a part: most need four.
const ITERATIONS: u32 = 30;

/// Memory that passes use one after the other.
#[derive(Debug, Default)]
pub(super) struct Neighbourhoods {
    /// Nodes of the parts, the far ones first.
    members: Vec<u32>,
    /// Nodes of one part.
    part: Vec<u32>,
    /// Of each place: whether it is among the members and in no part yet.
    is_waiting: Vec<bool>,
    /// Of each place: its number in a part under construction.
    numbers: Vec<u32>,
}

impl Neighbourhoods {
    /// Balances what is about the nodes farthest from equilibrium, if that is little; returns
    /// whether anything moved.
    ///
    /// # Errors
    /// The interrupt that ended it early.
    pub(super) fn relax(
        &mut self,
        search: &Search,
        assembly: &Assembly,
        here: &mut Configuration,
        residual: &Residual,
        team: &Team,
        meter: &mut Meter<'_>,
    ) -> Result<bool, Interrupt> {
        if residual.largest < NEARLY_BALANCED * search.force_limit
            || !self.gather(assembly, here, SHARE_OF_WORST * residual.largest)
        {
            return Ok(false);
        }
        let search = Search {
            iteration_limit: ITERATIONS.min(search.iteration_limit),
            ..*search
        };
        // the counts of iterations are those of the whole; bond evaluations count all
        let counted = meter.work;
        for index in 0..self.members.len() {
            if self.connect(assembly, self.members[index]) {
                self.balance(&search, assembly, here, meter)?;
            }
        }
        meter.work.newton_iterations = counted.newton_iterations;
        meter.work.conjugate_gradient_iterations = counted.conjugate_gradient_iterations;
        meter.spend(assembly.bonds())?;
        here.update(assembly, team);
        Ok(true)
    }

    /// Lists the nodes whose resultant exceeds `force` [N] and those around them; returns false
    /// when they are too many.
    fn gather(&mut self, assembly: &Assembly, here: &Configuration, force: f64) -> bool {
        let [most, most_far] =
            [LARGEST_SHARE, MOST_FAR].map(|share| (share * assembly.free().len() as f64) as usize);
        self.members.clear();
        here.list_beyond(assembly, force, &mut self.members);
        if self.members.len() > most_far {
            return false;
        }
        self.numbers.resize(assembly.places(), NONE);
        self.is_waiting.resize(assembly.places(), false);
        for member in &self.members {
            self.is_waiting[*member as usize] = true;
        }
        let mut ring = 0;
        'rings: for _ in 0..RINGS {
            let end = self.members.len();
            for index in ring..end {
                if self.members.len() > most {
                    break 'rings;
                }
                let node = self.members[index] as usize;
                for neighbour in assembly.free_neighbours(node) {
                    if !self.is_waiting[neighbour as usize] {
                        self.is_waiting[neighbour as usize] = true;
                        self.members.push(neighbour);
                    }
                }
            }
            ring = end;
        }
        let is_little = self.members.len() <= most;
        if !is_little {
            for member in &self.members {
                self.is_waiting[*member as usize] = false;
            }
        }
        is_little
    }

    /// Takes `first` and all members connected with it as the part; returns false when it was in
    /// another.
    fn connect(&mut self, assembly: &Assembly, first: u32) -> bool {
        if !std::mem::take(&mut self.is_waiting[first as usize]) {
            return false;
        }
        self.part.clear();
        self.part.push(first);
        let mut next = 0;
        while let Some(node) = self.part.get(next) {
            for neighbour in assembly.free_neighbours(*node as usize) {
                if std::mem::take(&mut self.is_waiting[neighbour as usize]) {
                    self.part.push(neighbour);
                }
            }
            next += 1;
        }
        self.part.sort_unstable();
        true
    }

    /// Brings the part to equilibrium, or nearer to it.
    fn balance(
        &mut self,
        search: &Search,
        assembly: &Assembly,
        here: &mut Configuration,
        meter: &mut Meter<'_>,
    ) -> Result<(), Interrupt> {
        let part = assembly.part(&self.part, &mut self.numbers);
        let displacement = |place| match part.node(place) as u32 {
            NONE => Vector::zeros(),
            whole => here.displacements.at(whole as usize),
        };
        let start: Vec<Vector> = (0..part.places()).map(displacement).collect();
        // a part is too small to be shared
        let alone = Team::alone();
        let start = Field::of(&start, part.dimensions());
        let mut inside = Configuration::new(&part, start, &alone);
        let mut there = inside.clone();
        let mut memory = Memory::of_part(&part);
        descend(
            search,
            &part,
            &mut inside,
            &mut there,
            &mut memory,
            &alone,
            meter,
        )?;
        let components = here.displacements.components_mut().into_iter();
        for (whole, moved) in components.zip(inside.displacements.components()) {
            for (place, moved) in self.part.iter().zip(moved) {
                whole[*place as usize] = *moved;
            }
        }
        Ok(())
    }
}
