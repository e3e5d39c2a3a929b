//! Which grids are solved by a factor, and which by conjugate gradients.
//!
//! Of its grid a job says here how it will be solved; the engine asks, and so does what foresees time
//! and memory. Measured on one thread, three grids to a job: of 361 000 equal cells conjugate gradients take
//! 4.7 s and 0.36 GB, a factor some 3.7 s and 1.1 GB; of cells 2.25, 4 and 9 times as long as high they take
//! 7, 12 and 26 s, because their number of iterations grows with that, and a factor no more than before.

/// Beyond so many particles a factor takes far more memory than conjugate gradients for about the same time.
pub const LARGEST_FACTORED: u64 = 300_000;
/// The same of grids whose cells are stretched, where conjugate gradients take far longer: a factor of a
/// million particles holds some 3 GB.
pub const LARGEST_STRETCHED: u64 = 1_000_000;
/// Longer side of a cell over its shorter one, from which on a grid is stretched.
const STRETCHED: f64 = 2.0;

/// Longest side of a cell of lines of particles along x and y over its shorter one.
pub fn stretch(lines_mm: [&[f64]; 2]) -> f64 {
    let [x, y] = lines_mm.map(|lines| {
        let sides = lines.windows(2).map(|pair| pair[1] - pair[0]);
        sides.fold([f64::INFINITY, 0.0_f64], |[low, high], side| {
            [low.min(side), high.max(side)]
        })
    });
    (x[1] / y[0]).max(y[1] / x[0])
}

/// Whether a grid of so many particles, of cells as stretched as told, is solved by a factor.
pub fn is_factored(particles: u64, stretch: f64) -> bool {
    let most = if stretch > STRETCHED {
        LARGEST_STRETCHED
    } else {
        LARGEST_FACTORED
    };
    particles <= most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretched_grids_are_factored_to_larger_sizes() {
        // cells of 1 to 3 by 0.5 to 1: the longest is 3 by 0.5
        let found = stretch([&[0.0, 1.0, 4.0], &[0.0, 0.5, 1.5]]);
        assert!((found - 6.0).abs() < 1e-15);
        assert!((stretch([&[0.0, 0.1], &[0.0, 2.0]]) - 20.0).abs() < 1e-12);
        assert!(is_factored(300_000, 1.0) && !is_factored(300_001, 2.0));
        assert!(is_factored(1_000_000, 2.1) && !is_factored(1_000_001, 50.0));
    }
}
