//! Measures of a beam's deformation, with their first and second derivatives.
//!
//! With n the chord from node a to node b, l its length, and tᵢ = R eᵢ the triad of a node:
//!
//! | measure | of a beam |
//! |---|---|
//! | stretch | l - l₀ |
//! | rotation of a node against the chord, about e₂ and e₃ | (n·t₃, -n·t₂) asin(s)/s, s the norm of the pair |
//! | twist | asin ½(t₃ᵃ·t₂ᵇ - t₂ᵃ·t₃ᵇ) |
//!
//! [Crisfield1990]'s with the chord for the mean frame ([Besseling1977]'s strains, with angles for
//! sines): a beam bent to a circle is exact, rigid motions strain nothing however large, and for small
//! motions they are those of the element's own. Derivatives are with respect to displacements and
//! rotation vectors *on top of* the shape, so that the second one is symmetric; both are in closed form.
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

pub(super) type Gradient = SVector<f64, 12>;
pub(super) type Hessian = SMatrix<f64, 12, 12>;

/// Rows of the displacement and the rotation of either node.
const SHIFT: [usize; 2] = [0, 6];
pub(super) const TURN: [usize; 2] = [3, 9];

/// A measure of deformation with its derivatives.
pub(super) struct Measure {
    pub(super) value: f64,
    pub(super) gradient: Gradient,
    pub(super) hessian: Hessian,
}

impl Measure {
    fn zero() -> Self {
        Self {
            value: 0.0,
            gradient: Gradient::zeros(),
            hessian: Hessian::zeros(),
        }
    }

    /// asin of the measure; none beyond a right angle.
    pub(super) fn angle(mut self) -> Option<Self> {
        let rest = 1.0 - self.value * self.value;
        if rest.is_nan() || rest <= 0.0 {
            return None;
        }
        let first = 1.0 / rest.sqrt();
        let second = self.value * first / rest;
        self.hessian *= first;
        self.hessian += second * self.gradient * self.gradient.transpose();
        self.gradient *= first;
        self.value = self.value.asin();
        Some(self)
    }
}

/// The chord of an element.
pub(super) struct Chord {
    pub(super) length: f64,
    pub(super) direction: Vector3<f64>,
    /// 1 - n nᵀ.
    pub(super) across: Matrix3<f64>,
}

impl Chord {
    pub(super) fn new(from: Vector3<f64>, to: Vector3<f64>) -> Option<Self> {
        let along = to - from;
        let length = along.norm();
        // not a number is no length, either
        (length > 0.0).then(|| {
            let direction = along / length;
            Self {
                length,
                direction,
                across: Matrix3::identity() - direction * direction.transpose(),
            }
        })
    }

    /// l - l₀.
    pub(super) fn stretch(&self, rest: f64) -> Measure {
        let mut measure = Measure::zero();
        measure.value = self.length - rest;
        add_difference(&mut measure.gradient, &self.direction);
        add_difference_block(&mut measure.hessian, &(self.across / self.length));
        measure
    }

    /// n·t, t an axis of node `end`.
    pub(super) fn lean(&self, end: usize, axis: Vector3<f64>) -> Measure {
        let (n, length) = (self.direction, self.length);
        let along = n.dot(&axis);
        let part = self.across * axis;
        let mut measure = Measure::zero();
        measure.value = along;
        add_difference(&mut measure.gradient, &(part / length));
        add_rows(&mut measure.gradient, TURN[end], &axis.cross(&n));
        let bent = n * part.transpose() + part * n.transpose() + self.across * along;
        add_difference_block(&mut measure.hessian, &(bent / (-length * length)));
        let turned = half_sum(n, axis) - Matrix3::identity() * along;
        add_block(&mut measure.hessian, TURN[end], TURN[end], &turned);
        let cross = axis.cross_matrix() * self.across / length;
        for (shift, sign) in SHIFT.into_iter().zip([-1.0, 1.0]) {
            add_block(&mut measure.hessian, TURN[end], shift, &(cross * sign));
            add_block(
                &mut measure.hessian,
                shift,
                TURN[end],
                &(cross.transpose() * sign),
            );
        }
        measure
    }
}

/// The rotation vector across the chord whose sine has these components: φᵢ = gᵢ f(σ), σ = g₁² + g₂²,
/// f = asin(√σ)/√σ. It does not know how the axes lie about the fibre. None beyond a right angle.
pub(super) fn angles(sines: [Measure; 2]) -> Option<[Measure; 2]> {
    let g = [sines[0].value, sines[1].value];
    let sigma = g[0] * g[0] + g[1] * g[1];
    if sigma.is_nan() || sigma >= 1.0 {
        return None;
    }
    let (f, first, second) = arcsine_factor(sigma);
    let same = |a: usize, b: usize| f64::from(u8::from(a == b));
    Some([0, 1].map(|i| {
        let mut angle = Measure::zero();
        angle.value = g[i] * f;
        for j in 0..2 {
            let slope = same(i, j) * f + 2.0 * g[i] * g[j] * first;
            angle.gradient += slope * sines[j].gradient;
            angle.hessian += slope * sines[j].hessian;
            for k in 0..2 {
                let bend =
                    2.0 * first * (same(i, j) * g[k] + same(i, k) * g[j] + same(j, k) * g[i])
                        + 4.0 * second * g[i] * g[j] * g[k];
                angle.hessian += bend * sines[j].gradient * sines[k].gradient.transpose();
            }
        }
        angle
    }))
}

/// asin(√σ)/√σ with its first and second derivative by σ.
fn arcsine_factor(sigma: f64) -> (f64, f64, f64) {
    // below, differences of nearly equal numbers would cost more digits than the series lacks
    if sigma < 1e-3 {
        let f = 1.0 + sigma * (1.0 / 6.0 + sigma * (3.0 / 40.0 + sigma * 5.0 / 112.0));
        let first =
            1.0 / 6.0 + sigma * (3.0 / 20.0 + sigma * (15.0 / 112.0 + sigma * 35.0 / 288.0));
        let second = 3.0 / 20.0 + sigma * (15.0 / 56.0 + sigma * 35.0 / 96.0);
        return (f, first, second);
    }
    let sine = sigma.sqrt();
    let secant = 1.0 / (1.0 - sigma).sqrt();
    let f = sine.asin() / sine;
    let first = (secant - f) / (2.0 * sigma);
    let second = (0.5 * secant.powi(3) - 3.0 * first) / (2.0 * sigma);
    (f, first, second)
}

/// ½(t₃ᵃ·t₂ᵇ - t₂ᵃ·t₃ᵇ).
pub(super) fn twist(first: &Matrix3<f64>, second: &Matrix3<f64>) -> Measure {
    let mut measure = Measure::zero();
    for (of_first, of_second, half) in [(2, 1, 0.5), (1, 2, -0.5)] {
        let (a, b) = (
            first.column(of_first).into_owned(),
            second.column(of_second).into_owned(),
        );
        let product = a.dot(&b);
        measure.value += half * product;
        let gradient = a.cross(&b) * half;
        add_rows(&mut measure.gradient, TURN[0], &gradient);
        add_rows(&mut measure.gradient, TURN[1], &-gradient);
        let own = (half_sum(a, b) - Matrix3::identity() * product) * half;
        let cross = (Matrix3::identity() * product - b * a.transpose()) * half;
        add_block(&mut measure.hessian, TURN[0], TURN[0], &own);
        add_block(&mut measure.hessian, TURN[1], TURN[1], &own);
        add_block(&mut measure.hessian, TURN[0], TURN[1], &cross);
        add_block(&mut measure.hessian, TURN[1], TURN[0], &cross.transpose());
    }
    measure
}

fn half_sum(a: Vector3<f64>, b: Vector3<f64>) -> Matrix3<f64> {
    (a * b.transpose() + b * a.transpose()) * 0.5
}

pub(super) fn add_rows(gradient: &mut Gradient, row: usize, value: &Vector3<f64>) {
    let mut rows = gradient.fixed_rows_mut::<3>(row);
    rows += value;
}

/// Adds what acts on the difference of the displacements.
pub(super) fn add_difference(gradient: &mut Gradient, value: &Vector3<f64>) {
    add_rows(gradient, SHIFT[0], &-value);
    add_rows(gradient, SHIFT[1], value);
}

pub(super) fn add_block(hessian: &mut Hessian, row: usize, column: usize, value: &Matrix3<f64>) {
    let mut block = hessian.fixed_view_mut::<3, 3>(row, column);
    block += value;
}

pub(super) fn add_difference_block(hessian: &mut Hessian, value: &Matrix3<f64>) {
    for (row, row_sign) in SHIFT.into_iter().zip([-1.0, 1.0]) {
        for (column, column_sign) in SHIFT.into_iter().zip([-1.0, 1.0]) {
            add_block(hessian, row, column, &(value * (row_sign * column_sign)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arcsine_has_no_step_where_its_series_ends() {
        let (below, above) = (arcsine_factor(1e-3 * (1.0 - 1e-12)), arcsine_factor(1e-3));
        assert!((below.0 - above.0).abs() < 1e-12);
        assert!((below.1 - above.1).abs() < 1e-11);
        assert!((below.2 - above.2).abs() < 1e-8);
    }
}
