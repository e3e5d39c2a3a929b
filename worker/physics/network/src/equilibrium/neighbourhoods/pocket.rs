//! A few nodes that are brought to equilibrium while those around them are held.
//!
//! The method is that of the whole ([`newton_cg`](super::super::newton_cg)), less what only the whole
//! needs: where the Hessian curves downwards the step goes as far as it was found and some way along
//! that direction, and where no step leads down the rest is left to the whole.
use loadframe_harness::Interrupt;
use loadframe_numerics::wide;

use super::rows::{Bonds, Nodes, Row, State, longest_square, multiply};
use crate::{
    assembly::Assembly,
    configuration::Configuration,
    equilibrium::{
        Search,
        conjugate_gradients::Stop,
        forcing::{NEAR, SINGLE, away, relative_residual, stop},
        line_search::{Point, descend},
        work::Meter,
    },
    field::dot,
    law::StrainLaw,
    places::NONE,
    response::{WithLaws, with_laws},
};

/// Newton iterations for a part: most need four.
const ITERATIONS: u32 = 30;
/// Of a place: it is to be in a pocket, but in none yet.
pub(super) const WAITING: u32 = NONE - 1;
/// Flag of the number of a held node while a pocket grows.
const HELD: u32 = 1 << 31;

/// Memory that pockets use one after the other.
#[derive(Debug, Default)]
pub(super) struct Pocket {
    /// Places of the nodes, those that move first.
    places: Vec<u32>,
    /// How many move.
    free: usize,
    held: Vec<u32>,
    bonds: Bonds,
    here: State,
    there: State,
    /// Energy, and resultants of the held nodes, at the start.
    energy: f64,
    reactions: Vec<Row<f64>>,
    nodes: Nodes,
    residual: Vec<Row<f32>>,
    search: Vec<Row<f32>>,
    product: Vec<Row<f32>>,
    step: Vec<Row<f32>>,
}

impl Pocket {
    /// Takes the place `first` and all waiting ones that hang together with it.
    pub(super) fn grow(&mut self, assembly: &Assembly, first: u32, numbers: &mut [u32]) {
        self.places.clear();
        self.held.clear();
        self.bonds.clear();
        self.bonds.starts.push(0);
        self.places.push(first);
        numbers[first as usize] = 0;
        let incidence = assembly.incidence();
        let mut number = 0;
        while let Some(place) = self.places.get(number as usize).copied() {
            for (slot, other) in incidence.around(place as usize) {
                let of_other = &mut numbers[other as usize];
                // a bond between two nodes that move is met twice, one from a node to itself does nothing
                if *of_other <= number || !assembly.acts(slot as usize) {
                    continue;
                }
                if *of_other == WAITING {
                    *of_other = self.places.len() as u32;
                    self.places.push(other);
                } else if *of_other == NONE {
                    *of_other = HELD | self.held.len() as u32;
                    self.held.push(other);
                }
                self.bonds.ends.push([number, *of_other]);
                self.bonds.slots.push(slot);
            }
            number += 1;
            self.bonds.starts.push(self.bonds.ends.len() as u32);
        }
        self.free = self.places.len();
        self.places.append(&mut self.held);
        for [_, second] in &mut self.bonds.ends {
            if *second & HELD != 0 {
                *second = (*second & !HELD) + self.free as u32;
            }
        }
        self.bonds.look_up(assembly, &self.places);
        for place in &self.places {
            numbers[*place as usize] = NONE;
        }
    }

    /// Brings the nodes to equilibrium, or nearer to it, from where the whole is.
    ///
    /// # Errors
    /// The interrupt that ended it early.
    pub(super) fn balance(
        &mut self,
        search: &Search,
        assembly: &Assembly,
        whole: &mut Configuration,
        meter: &mut Meter<'_>,
    ) -> Result<(), Interrupt> {
        let (nodes, bonds) = (self.places.len(), self.bonds.ends.len());
        for state in [&mut self.here, &mut self.there] {
            state.resize(nodes, bonds);
        }
        for rows in [
            &mut self.residual,
            &mut self.search,
            &mut self.product,
            &mut self.step,
        ] {
            rows.clear();
            rows.resize(nodes, [0.0; 4]);
        }
        let places = self.places.iter();
        for (row, place) in self.here.displacements.iter_mut().zip(places) {
            let [x, y, z] = whole.displacements.at(*place as usize).into();
            *row = [x, y, z, 0.0];
        }
        self.there
            .displacements
            .copy_from_slice(&self.here.displacements);
        with_laws(
            assembly,
            Balance {
                pocket: self,
                search,
                meter,
            },
        )?;
        self.tell(whole);
        Ok(())
    }

    /// Goes on to equilibrium.
    fn settle<const D: usize, L: StrainLaw>(
        &mut self,
        search: &Search,
        law: impl Fn(usize) -> L + Copy,
        meter: &mut Meter<'_>,
    ) -> Result<(), Interrupt> {
        let (free, bonds) = (self.free, self.bonds.ends.len());
        meter.spend(bonds)?;
        self.here.update(&self.bonds, law);
        self.energy = self.here.energy;
        self.reactions.clear();
        self.reactions.extend(&self.here.resultants[free..]);
        let mut previous_norm = 0.0;
        for _ in 0..ITERATIONS.min(search.iteration_limit) {
            let largest = longest_square(&self.here.resultants[..free]).sqrt();
            if largest <= search.force_limit {
                break;
            }
            // numbers of order one stay within the range of single precision
            let unit = largest;
            let norm = self.begin::<D>(unit);
            if largest < NEAR * search.force_limit {
                previous_norm = f64::INFINITY;
            }
            let relative = relative_residual(norm * unit * unit, previous_norm, SINGLE);
            previous_norm = norm * unit * unit;
            let stop = stop(search, relative, unit, norm, self.nodes.compliance, free);
            self.solve(search, norm, unit, stop, meter)?;
            if !self.follow(search, unit, law, meter)? {
                break;
            }
        }
        Ok(())
    }

    /// Sets the residual to the resultants in units of `unit`, and the search to the preconditioned
    /// residual; returns the product of both.
    fn begin<const D: usize>(&mut self, unit: f64) -> f64 {
        let free = self.free;
        let resultants = &self.here.resultants[..free];
        for (residual, resultant) in self.residual.iter_mut().zip(resultants) {
            *residual = resultant.map(|force| (force / unit) as f32);
        }
        self.nodes
            .follow::<D>(&self.bonds, &self.here.stiffness, free, self.places.len());
        self.step.fill([0.0; 4]);
        let (nodes, residual) = (&self.nodes, &self.residual[..free]);
        let search = &mut self.search[..free];
        wide(
            #[inline(always)]
            || {
                nodes.apply(residual, search);
                dot(residual.as_flattened(), search.as_flattened())
            },
        )
    }

    /// Finds a step by conjugate gradients.
    fn solve(
        &mut self,
        search: &Search,
        mut norm: f64,
        unit: f64,
        stop: Stop,
        meter: &mut Meter<'_>,
    ) -> Result<(), Interrupt> {
        let free = self.free;
        let enough = (stop.relative * norm).max(stop.absolute);
        for _ in 0..stop.iterations {
            if norm <= enough {
                break;
            }
            meter.spend(self.bonds.ends.len())?;
            multiply(
                &self.bonds,
                &self.here.stiffness,
                &self.search,
                &mut self.product,
            );
            let direction = self.search[..free].as_flattened_mut();
            let product = &mut self.product[..free];
            let step = self.step[..free].as_flattened_mut();
            let residual = &mut self.residual[..free];
            let nodes = &self.nodes;
            let curvature = wide(
                #[inline(always)]
                || dot(direction, product.as_flattened()),
            );
            if curvature.is_nan() || curvature <= 0.0 {
                let longest = longest_square_of(direction);
                if let Some(length) = away(search, norm / curvature.abs(), longest.sqrt() * unit) {
                    add(step, length as f32, direction);
                }
                break;
            }
            let length = (norm / curvature) as f32;
            norm = wide(
                #[inline(always)]
                || {
                    add(step, length, direction);
                    add(residual.as_flattened_mut(), -length, product.as_flattened());
                    nodes.apply(residual, product);
                    let next = dot(residual.as_flattened(), product.as_flattened());
                    let turn = (next / norm) as f32;
                    for (direction, moved) in direction.iter_mut().zip(product.as_flattened()) {
                        *direction = turn.mul_add(*direction, *moved);
                    }
                    next
                },
            );
        }
        Ok(())
    }

    /// Goes along the step, in units of `unit`, as far as the energy falls; returns whether it did.
    fn follow<L: StrainLaw>(
        &mut self,
        search: &Search,
        unit: f64,
        law: impl Fn(usize) -> L + Copy,
        meter: &mut Meter<'_>,
    ) -> Result<bool, Interrupt> {
        let (free, bonds) = (self.free, &self.bonds);
        let step = &self.step[..free];
        let (here, there) = (&self.here, &mut self.there);
        let point = |state: &State| {
            let pairs = state.resultants[..free].iter().zip(step);
            let work: f64 = pairs
                .map(|(force, step)| {
                    let [x, y, z, _] = [0, 1, 2, 3].map(|part| force[part] * f64::from(step[part]));
                    x + y + z
                })
                .sum();
            Point {
                energy: state.energy,
                slope: -work * unit,
            }
        };
        let longest = longest_square_of(step.as_flattened()).sqrt() * unit;
        let went = descend(point(here), search.step_cap / longest, |length| {
            meter.spend(bonds.ends.len())?;
            let rows = there.displacements.iter_mut().zip(&here.displacements);
            for ((there, here), step) in rows.zip(step) {
                for part in 0..4 {
                    there[part] = here[part] + f64::from(step[part]) * unit * length;
                }
            }
            there.update(bonds, law);
            Ok(point(there))
        })?;
        if went {
            std::mem::swap(&mut self.here, &mut self.there);
        }
        Ok(went)
    }

    /// Lets the whole have what changed here: at the held nodes that is what the bonds here do more
    /// than before. The sign of s may differ from what the whole would find, as a bond may be seen
    /// from its other end here: only s sᵀ counts.
    fn tell(&self, whole: &mut Configuration) {
        let (here, free) = (&self.here, self.free);
        whole.energy += here.energy - self.energy;
        whole.is_patched = true;
        for (axis, moved) in whole.displacements.components_mut().into_iter().enumerate() {
            if moved.is_empty() {
                continue;
            }
            for (place, row) in self.places[..free].iter().zip(&here.displacements) {
                moved[*place as usize] = row[axis];
            }
        }
        for (axis, sums) in whole.resultants.components_mut().into_iter().enumerate() {
            if sums.is_empty() {
                continue;
            }
            let (free, held) = self.places.split_at(free);
            for (place, row) in free.iter().zip(&here.resultants) {
                sums[*place as usize] = row[axis];
            }
            let rows = here.resultants[free.len()..].iter().zip(&self.reactions);
            for (place, (row, before)) in held.iter().zip(rows) {
                sums[*place as usize] += row[axis] - before[axis];
            }
        }
        let slots = self.bonds.ends.iter().zip(&self.bonds.slots);
        let [sx, sy, sz] = whole.stiffness.axial.each_mut();
        for (bond, (_, slot)) in slots.enumerate() {
            let slot = *slot as usize;
            let [x, y, z, b] = here.stiffness[bond];
            whole.tensions[slot] = here.tensions[bond];
            whole.stiffness.transverse[slot] = b;
            (sx[slot], sy[slot]) = (x, y);
            if let Some(sz) = sz.get_mut(slot) {
                *sz = z;
            }
        }
    }
}

/// Lets a pocket settle under the laws of the whole.
struct Balance<'a, 'b> {
    pocket: &'a mut Pocket,
    search: &'a Search,
    meter: &'a mut Meter<'b>,
}

impl WithLaws for Balance<'_, '_> {
    type Output = Result<(), Interrupt>;

    fn run<const D: usize, L: StrainLaw>(
        self,
        _: &Assembly,
        law: impl Fn(usize) -> L + Copy + Sync + Send,
    ) -> Self::Output {
        self.pocket.settle::<D, L>(self.search, law, self.meter)
    }
}

/// `values` += `factor` `others`.
#[inline(always)]
fn add(values: &mut [f32], factor: f32, others: &[f32]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = factor.mul_add(*other, *value);
    }
}

/// The largest square of the length of four numbers.
fn longest_square_of(values: &[f32]) -> f64 {
    let rows = values.chunks_exact(4);
    let squares = rows.map(|row| row.iter().map(|x| f64::from(x * x)).sum::<f64>());
    squares.fold(0.0, f64::max)
}
