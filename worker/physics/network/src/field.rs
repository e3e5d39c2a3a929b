//! Vectors at nodes as kernels like them: one array per component, in either precision.
use std::{iter::Sum, ops::Range};

use loadframe_numerics::wide;
use num_traits::{Float, NumAssign};

use super::Vector;

/// Numbers worked on together: as many as the widest vector registers hold.
pub(crate) const LANES: usize = 16;
/// Bonds in a block, at most: their buffers stay in the core's nearest cache.
pub(crate) const BLOCK: usize = 256;

/// The number type of a kernel: `f64` for what is reported, `f32` for what only points the way.
pub(crate) trait Real:
    Float + NumAssign + Sum + Default + Send + Sync + std::fmt::Debug + 'static
{
    fn new(value: f64) -> Self;
    fn wide(self) -> f64;
    fn widen(value: f32) -> Self;
    fn narrow(self) -> f32;
}

impl Real for f32 {
    #[inline(always)]
    fn new(value: f64) -> Self {
        value as Self
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn widen(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn narrow(self) -> f32 {
        self
    }
}

impl Real for f64 {
    #[inline(always)]
    fn new(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }

    #[inline(always)]
    fn widen(value: f32) -> Self {
        Self::from(value)
    }

    #[inline(always)]
    fn narrow(self) -> f32 {
        self as f32
    }
}

/// A vector at every node. Components that vanish everywhere, as z in a plane, are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Field<T>([Vec<T>; 3]);

impl<T: Real> Field<T> {
    pub(crate) fn zeros(places: usize, dimensions: usize) -> Self {
        Self([0, 1, 2].map(|axis| {
            let length = if axis < dimensions { places } else { 0 };
            vec![T::zero(); length]
        }))
    }

    /// Makes room for so many places; what they hold is to be set.
    pub(crate) fn resize(&mut self, places: usize, dimensions: usize) {
        for component in &mut self.0[..dimensions] {
            component.resize(places, T::zero());
        }
    }

    pub(crate) fn of(vectors: &[Vector], dimensions: usize) -> Self {
        let mut field = Self::zeros(vectors.len(), dimensions);
        for (axis, component) in field.0.iter_mut().enumerate() {
            for (value, vector) in component.iter_mut().zip(vectors) {
                *value = T::new(vector[axis]);
            }
        }
        field
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        for (component, other) in self.0.iter_mut().zip(&other.0) {
            component.copy_from_slice(other);
        }
    }

    pub(crate) fn clear(&mut self) {
        for component in &mut self.0 {
            component.fill(T::zero());
        }
    }

    /// The vector at a node.
    #[inline]
    pub(crate) fn at(&self, node: usize) -> Vector {
        let component = |axis: usize| self.0[axis].get(node).map_or(0.0, |value| value.wide());
        Vector::new(component(0), component(1), component(2))
    }

    pub(crate) fn axis(&self, axis: usize) -> &[T] {
        &self.0[axis]
    }

    #[inline(always)]
    pub(crate) fn components(&self) -> [&[T]; 3] {
        self.0.each_ref().map(Vec::as_slice)
    }

    #[inline(always)]
    pub(crate) fn components_mut(&mut self) -> [&mut [T]; 3] {
        self.0.each_mut().map(Vec::as_mut_slice)
    }

    /// The components over the places of `range`.
    #[inline(always)]
    pub(crate) fn panel(&self, range: Range<usize>) -> [&[T]; 3] {
        self.0.each_ref().map(
            #[inline(always)]
            |component| component.get(range.clone()).unwrap_or_default(),
        )
    }

    /// Σ a · b over the nodes of `range`, in an order that depends on nothing else.
    #[inline(always)]
    pub(crate) fn dot(&self, other: &Self, range: Range<usize>) -> f64 {
        let mut total = 0.0;
        for (a, b) in self.0.iter().zip(&other.0) {
            if !a.is_empty() {
                total += dot(&a[range.clone()], &b[range.clone()]);
            }
        }
        total
    }

    /// Adds `factor` times the `others`.
    pub(crate) fn add(&mut self, factor: T, others: &Self) {
        for (values, others) in self.0.iter_mut().zip(&others.0) {
            for (value, other) in values.iter_mut().zip(others) {
                *value += factor * *other;
            }
        }
    }

    /// Sets `squares` to those of the vectors from place `start` on.
    #[inline(always)]
    pub(crate) fn squares(&self, start: usize, squares: &mut [T]) {
        set_squares(self.panel(start..start + squares.len()), squares);
    }

    /// Longest vector, squared.
    pub(crate) fn longest_square(&self) -> T {
        longest_square(self.components())
    }

    /// Whether all components of the vectors are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let components = self.0.iter();
        // 0 for a number, else not a number
        let mut nothing = components.map(|component| {
            wide(
                #[inline(always)]
                || {
                    sum_of(
                        component,
                        #[inline(always)]
                        |value| value * T::zero(),
                    )
                },
            )
        });
        nothing.all(|nothing| nothing == 0.0)
    }
}

#[inline(always)]
fn set_squares<T: Real>([x, y, z]: [&[T]; 3], squares: &mut [T]) {
    for (square, (x, y)) in squares.iter_mut().zip(x.iter().zip(y)) {
        *square = *x * *x + *y * *y;
    }
    for (square, z) in squares.iter_mut().zip(z) {
        *square += *z * *z;
    }
}

/// Longest of the vectors with these components, squared.
#[inline(always)]
pub(crate) fn longest_square<T: Real>(components: [&[T]; 3]) -> T {
    let mut longest = T::zero();
    let mut squares = [T::zero(); BLOCK];
    for start in (0..components[0].len()).step_by(BLOCK) {
        let panel = components.map(
            #[inline(always)]
            |component| component.get(start..).unwrap_or_default(),
        );
        let squares = &mut squares[..panel[0].len().min(BLOCK)];
        set_squares(panel, squares);
        longest = longest.max(largest(squares));
    }
    longest
}

/// The largest of `values` that are not below zero; what is not a number is left out.
#[inline(always)]
pub(crate) fn largest<T: Real>(values: &[T]) -> T {
    #[inline(always)]
    fn larger<T: Real>(most: T, value: T) -> T {
        if value > most { value } else { most }
    }
    let mut lanes = [T::zero(); LANES];
    let mut groups = values.chunks_exact(LANES);
    for group in &mut groups {
        for lane in 0..LANES {
            lanes[lane] = larger(lanes[lane], group[lane]);
        }
    }
    let rest = groups.remainder().iter();
    lanes.iter().chain(rest).copied().fold(T::zero(), larger)
}

/// Numbers summed in the precision of the data before the sum goes on in double precision.
const PANEL: usize = 512;

/// Σ `values`.
#[inline(always)]
pub(crate) fn sum<T: Real>(values: &[T]) -> f64 {
    sum_of(
        values,
        #[inline(always)]
        |value| value,
    )
}

/// Σ `of` each of `values`.
#[inline(always)]
fn sum_of<T: Real>(values: &[T], of: impl Fn(T) -> T) -> f64 {
    let mut total = 0.0;
    for panel in values.chunks(PANEL) {
        let mut lanes = [T::zero(); LANES];
        let mut groups = panel.chunks_exact(LANES);
        for group in &mut groups {
            for lane in 0..LANES {
                lanes[lane] += of(group[lane]);
            }
        }
        for (lane, value) in lanes.iter_mut().zip(groups.remainder()) {
            *lane += of(*value);
        }
        total += fold(&lanes);
    }
    total
}

/// Σ `a` `b`.
#[inline(always)]
pub(crate) fn dot<T: Real>(a: &[T], b: &[T]) -> f64 {
    let mut total = 0.0;
    for (a, b) in a.chunks(PANEL).zip(b.chunks(PANEL)) {
        let mut lanes = [T::zero(); LANES];
        let (mut many_a, mut many_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
        for (a, b) in (&mut many_a).zip(&mut many_b) {
            for lane in 0..LANES {
                lanes[lane] = a[lane].mul_add(b[lane], lanes[lane]);
            }
        }
        let rest = many_a.remainder().iter().zip(many_b.remainder());
        for (lane, (a, b)) in lanes.iter_mut().zip(rest) {
            *lane += *a * *b;
        }
        total += fold(&lanes);
    }
    total
}

/// Σ `lanes`, one after the other.
#[inline(always)]
pub(crate) fn fold<T: Real>(lanes: &[T; LANES]) -> f64 {
    let mut total = 0.0;
    for lane in lanes {
        total += lane.wide();
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_take_every_number_once() {
        // whole numbers, so that any order gives the same sum exactly
        for count in [0, 1, 15, 16, 17, 511, 512, 513, 1300] {
            let ones: Vec<f32> = vec![1.0; count];
            let numbers: Vec<f32> = (0..count).map(|number| number as f32).collect();
            let expected = (count * count.saturating_sub(1) / 2) as f64;
            assert!((sum(&numbers) - expected).abs() < 0.5);
            assert!((dot(&numbers, &ones) - expected).abs() < 0.5);
        }
    }

    #[test]
    fn a_flat_field_has_no_third_component() {
        let field: Field<f64> = Field::of(&[Vector::new(3.0, 4.0, 0.0)], 2);
        assert!(field.axis(2).is_empty());
        assert_eq!(field.at(0), Vector::new(3.0, 4.0, 0.0));
        assert!((field.longest_square() - 25.0).abs() < 1e-12);
        assert!((field.dot(&field, 0..1) - 25.0).abs() < 1e-12);
    }
}
