//! Preconditioned conjugate gradients [HestenesStiefel1952].

/// Equations K x = f under way: what was found of x, what that leaves, r = f - K x, and a direction d.
///
/// K is symmetric, and so is the preconditioner M, about the inverse of K and positive. Who keeps the vectors
/// decides of their precision and order, and of which passes are one.
pub trait Iterated {
    /// What ends the iterations from outside.
    type Interrupt;

    /// Finds K d; gives d · K d.
    ///
    /// # Errors
    /// The interrupt to obey now.
    fn apply(&mut self) -> Result<f64, Self::Interrupt>;

    /// Goes this multiple of d: x grows by it, r falls by as much of K d, which comes from [`Self::apply`].
    /// Gives r · z of z = M r; none when x is near enough, and z need not be known then.
    fn advance(&mut self, length: f64) -> Option<f64>;

    /// Sets d to z + `keep` d.
    fn turn(&mut self, keep: f64);
}

/// How iterations ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ended {
    /// x is as near as was asked.
    Near,
    /// K or M is not positive along d, or what it gives is no number. Where K is not, the minimum along d
    /// would be this multiple of it away if the energy curved upwards as strongly.
    CurvesDown(f64),
    /// All iterations are spent. With this r · z they can go on.
    Spent(f64),
}

/// Iterates at most so often, from a direction d and the `product` r · z it began with: z itself at the start.
/// Gives how often it advanced.
///
/// # Errors
/// The interrupt that ended it early.
pub fn iterate<E: Iterated>(
    equations: &mut E,
    mut product: f64,
    most: usize,
) -> Result<(usize, Ended), E::Interrupt> {
    for iteration in 0..most {
        let curvature = equations.apply()?;
        if curvature.is_nan() || curvature <= 0.0 || product < 0.0 {
            return Ok((iteration, Ended::CurvesDown(product / curvature.abs())));
        }
        let Some(next) = equations.advance(product / curvature) else {
            return Ok((iteration + 1, Ended::Near));
        };
        equations.turn(next / product);
        product = next;
    }
    Ok((most, Ended::Spent(product)))
}
