//! Newton's method: steps until forces balance, each gone as far as it leads down.

/// What is to come to rest.
///
/// How a step is found is its own: by which tangent, what is done where that is not positive definite, by
/// which equations.
pub trait Newton {
    type Failure;

    /// Whether forces balance where it is, after so many steps.
    ///
    /// # Errors
    /// Why it must not go on.
    fn is_at_rest(&mut self, steps: u32) -> Result<bool, Self::Failure>;

    /// Finds a step and goes along it; false where it leads nowhere, and neither would another.
    ///
    /// # Errors
    /// Why there is no step.
    fn advance(&mut self) -> Result<bool, Self::Failure>;
}

/// Where steps led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Settled {
    /// Forces balance after so many steps.
    AtRest(u32),
    /// They do not, and the step after so many leads nowhere.
    Stuck(u32),
    /// They do not after as many as are allowed.
    Slow,
}

/// Takes steps until forces balance, at most so many.
///
/// # Errors
/// Why it could not go on.
pub fn settle<N: Newton>(newton: &mut N, most: u32) -> Result<Settled, N::Failure> {
    for steps in 0..=most {
        if newton.is_at_rest(steps)? {
            return Ok(Settled::AtRest(steps));
        }
        if steps < most && !newton.advance()? {
            return Ok(Settled::Stuck(steps));
        }
    }
    Ok(Settled::Slow)
}

/// Halves a length, at most so often, until `goes` there, which is also told how often it was halved. False
/// when it never does.
///
/// # Errors
/// Why `goes` gave up.
pub fn halved<F>(
    mut length: f64,
    most: u32,
    mut goes: impl FnMut(f64, u32) -> Result<bool, F>,
) -> Result<bool, F> {
    for halvings in 0..=most {
        if goes(length, halvings)? {
            return Ok(true);
        }
        length *= 0.5;
    }
    Ok(false)
}

/// What forces leave over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unbalanced {
    /// Largest force that nothing balances.
    pub largest: f64,
    /// Largest force that acts.
    pub scale: f64,
    /// What round-off alone may leave over.
    pub round_off: f64,
}

impl Unbalanced {
    /// Over the largest force that acts.
    pub fn share(&self) -> f64 {
        self.largest / self.scale.max(f64::MIN_POSITIVE)
    }

    /// Whether it is at most this share of the largest force, or what round-off explains.
    pub fn is_within(&self, share: f64) -> bool {
        self.share() <= share || self.largest <= self.round_off
    }
}
