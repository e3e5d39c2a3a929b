//! How long springs with a drag take to come to rest.
//!
//! A vibration of frequency ω under a drag -c m v dies as e^(-r t), r = c/2 up to c = 2 ω, where it just does not
//! swing any more and (1 + ω t) e^(-ω t) is left; a larger drag holds it back, r = c/2 - √(c²/4 - ω²). Every
//! faster vibration dies within the same time: the slowest one says when all is at rest.

/// Steps τ [s] until a part `residual` is left of the slowest vibration ω [1/s] under a drag c [1/s]; of
/// 2 ω where none is given.
pub fn steps_to_rest(
    lowest_per_s: f64,
    drag_per_s: Option<f64>,
    time_step_s: f64,
    residual: f64,
) -> f64 {
    let part = -residual.min(0.5).ln();
    let phase = match drag_per_s {
        Some(drag) => {
            let (half, lowest) = (0.5 * drag, lowest_per_s);
            let rate = if half <= lowest {
                half
            } else {
                // half - √(half² - ω²), without taking like from like
                lowest * lowest / (half + (half * half - lowest * lowest).sqrt())
            };
            part * lowest / rate
        }
        None => {
            // x = ln(1 + x) - ln r, by its fixed point of slope 1 / (1 + x)
            (0..30).fold(part, |phase, _| part + phase.ln_1p())
        }
    };
    phase / (lowest_per_s * time_step_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_of_the_slowest_vibration_is_the_part_asked_for() {
        // ω τ = 0.01
        let steps = steps_to_rest(2.0, None, 0.005, 1e-7);
        let phase = 0.01 * steps;
        assert!(((1.0 + phase) * (-phase).exp() / 1e-7 - 1.0).abs() < 1e-6);
        // a fifth of that drag: e^(-0.4 t), for t = ln(1e7) / 0.4 at 200 steps a second
        let steps = steps_to_rest(2.0, Some(0.8), 0.005, 1e-7);
        assert!((steps - 1e7_f64.ln() / 0.4 * 200.0).abs() < 1e-6);
        // c/2 = 5/2, √(25/4 - 4) = 3/2: e^(-t)
        let steps = steps_to_rest(2.0, Some(5.0), 0.005, 1e-7);
        assert!((steps - 1e7_f64.ln() * 200.0).abs() < 1e-6);
        assert!(steps_to_rest(2.0, Some(0.0), 0.005, 1e-7).is_infinite());
    }
}
