//! The line to which forces bend a beam, by Timoshenko's theory.
//!
//! With the deflection w [mm], the turn φ of cross-sections, the shear force V [N] and the moment
//! M [N mm] along x:
//!
//! φ' = M / EI, w' = φ + V / kGA, M' = -V, V' = -q   [Timoshenko1921]
//!
//! Forces act at points, so that V is even between them and the rest follows exactly: over a
//! distance d, M falls by V d, φ grows by (M d - V d²/2)/EI and w by φ d + (M d²/2 - V d³/6)/EI + V d/kGA.
//! That q = -V' is the load follows from the balance of a slice; with V = kGA (w' - φ) the two first-order
//! pairs are the theory's equations.
use super::Beam;

/// What holds an end of a beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct End {
    /// It cannot turn.
    pub holds_turn: bool,
    /// It cannot deflect.
    pub holds_deflection: bool,
}

/// A force across the beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointForce {
    /// [mm].
    pub at_mm: f64,
    /// Upwards [N].
    pub force_n: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct State {
    deflection: f64,
    turn: f64,
    shear: f64,
    moment: f64,
}

impl State {
    fn over(self, beam: &Beam, d: f64) -> Self {
        let Self { shear, moment, .. } = self;
        let bent = |first: f64, second: f64| (moment * first - shear * second) / beam.bending_n_mm2;
        Self {
            deflection: self.deflection
                + self.turn * d
                + bent(d * d / 2.0, d * d * d / 6.0)
                + shear * d / beam.shear_n,
            turn: self.turn + bent(d, d * d / 2.0),
            shear,
            moment: moment - shear * d,
        }
    }
}

/// Deflections [mm], upwards, of a beam from the first to the last of its `places_mm`, at each of them, which
/// ascend; forces ascend by their places too and lie between the ends. `None` when nothing keeps it in place.
#[must_use]
pub fn deflected_line(
    beam: &Beam,
    places_mm: &[f64],
    forces: &[PointForce],
    [left, right]: [End; 2],
) -> Option<Vec<f64>> {
    let holds = |end: &End| usize::from(end.holds_deflection);
    let turns_nowhere = left.holds_turn || right.holds_turn;
    let held = holds(&left) + holds(&right);
    if held == 0 || (held == 1 && !turns_nowhere) {
        return None;
    }
    // what the left end does not hold is unknown there, what it holds presses on it
    let unknown = |first: f64, second: f64| {
        let mut state = State::default();
        *(if left.holds_deflection {
            &mut state.shear
        } else {
            &mut state.deflection
        }) = first;
        *(if left.holds_turn {
            &mut state.moment
        } else {
            &mut state.turn
        }) = second;
        state
    };
    let ends = |state: State| {
        [
            if right.holds_deflection {
                state.deflection
            } else {
                state.shear
            },
            if right.holds_turn {
                state.turn
            } else {
                state.moment
            },
        ]
    };
    let shape = |state: State, forces: &[PointForce]| march(beam, places_mm, forces, state);
    let (loaded, first, second) = (
        shape(State::default(), forces),
        shape(unknown(1.0, 0.0), &[]),
        shape(unknown(0.0, 1.0), &[]),
    );
    let [p, a, b] = [&loaded, &first, &second].map(|shape| ends(shape.1));
    let determinant = a[0] * b[1] - a[1] * b[0];
    let factors = [
        (b[0] * p[1] - p[0] * b[1]) / determinant,
        (a[1] * p[0] - a[0] * p[1]) / determinant,
    ];
    let all = loaded.0.iter().zip(&first.0).zip(&second.0);
    let line: Vec<f64> = all
        .map(|((loaded, first), second)| loaded + factors[0] * first + factors[1] * second)
        .collect();
    line.iter().all(|w| w.is_finite()).then_some(line)
}

/// As [`deflected_line`], of a beam that lies on two points within its length and is bent by forces in balance,
/// what those points bear among them.
#[must_use]
pub fn line_on_supports(
    beam: &Beam,
    places_mm: &[f64],
    forces: &[PointForce],
    supports_mm: [f64; 2],
) -> Vec<f64> {
    let free = State::default();
    let (line, _) = march(beam, places_mm, forces, free);
    let from = places_mm.first().copied().unwrap_or(0.0);
    let at = supports_mm.map(|at| march(beam, &[from, at], forces, free).1.deflection);
    let slope = (at[1] - at[0]) / (supports_mm[1] - supports_mm[0]);
    let along = places_mm.iter().zip(line);
    along
        .map(|(x, w)| w - at[0] - slope * (x - supports_mm[0]))
        .collect()
}

/// Deflections at all places from a state at the first of them, and the state after the last.
fn march(
    beam: &Beam,
    places_mm: &[f64],
    forces: &[PointForce],
    mut state: State,
) -> (Vec<f64>, State) {
    let mut at = places_mm.first().copied().unwrap_or(0.0);
    let mut forces = forces.iter().peekable();
    let mut line = Vec::with_capacity(places_mm.len());
    for &place in places_mm {
        while let Some(force) = forces.next_if(|force| force.at_mm <= place) {
            state = state.over(beam, force.at_mm - at);
            state.shear -= force.force_n;
            at = force.at_mm;
        }
        state = state.over(beam, place - at);
        at = place;
        line.push(state.deflection);
    }
    (line, state)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// EI = 2, kGA = 5.
    const BEAM: Beam = Beam {
        axial_n: 1.0,
        bending_n_mm2: 2.0,
        shear_n: 5.0,
        neutral_mm: 0.0,
    };
    const CLAMPED: End = End {
        holds_turn: true,
        holds_deflection: true,
    };
    const PINNED: End = End {
        holds_turn: false,
        holds_deflection: true,
    };
    const GUIDED: End = End {
        holds_turn: true,
        holds_deflection: false,
    };
    const FREE: End = End {
        holds_turn: false,
        holds_deflection: false,
    };

    fn force(at_mm: f64, force_n: f64) -> PointForce {
        PointForce { at_mm, force_n }
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn a_cantilever_bends_by_bending_and_shear() {
        // P L³/(3 EI) + P L/kGA of P = 6, L = 2: 8 + 2.4, from either side
        for (ends, at, tip) in [([CLAMPED, FREE], 2.0, 2), ([FREE, CLAMPED], 0.0, 0)] {
            let line = deflected_line(&BEAM, &[0.0, 1.0, 2.0], &[force(at, 6.0)], ends).unwrap();
            near(line[tip], 8.0 + 2.4);
            near(line[2 - tip], 0.0);
            // half way: P x² (3 L - x)/(6 EI) + P x/kGA = 6·5/12 + 1.2
            near(line[1], 2.5 + 1.2);
        }
    }

    #[test]
    fn clamped_and_pinned_strips_sag_as_handbooks_say() {
        // a force F = 3 amid L = 4: F L³/(192 EI) + F L/(4 kGA) clamped, F L³/(48 EI) + F L/(4 kGA) pinned
        let down = [force(2.0, -3.0)];
        let middle = |ends| deflected_line(&BEAM, &[0.0, 2.0, 4.0], &down, ends).unwrap()[1];
        near(middle([CLAMPED; 2]), -(3.0 * 64.0 / 384.0 + 12.0 / 20.0));
        near(middle([PINNED; 2]), -(3.0 * 64.0 / 96.0 + 12.0 / 20.0));
        // half of the clamped strip with half of the force, its middle guided
        let half = deflected_line(&BEAM, &[0.0, 2.0], &[force(2.0, -1.5)], [CLAMPED, GUIDED]);
        near(half.unwrap()[1], middle([CLAMPED; 2]));
    }

    #[test]
    fn what_nothing_keeps_in_place_has_no_line() {
        for ends in [[FREE; 2], [PINNED, FREE], [GUIDED; 2], [GUIDED, FREE]] {
            assert!(deflected_line(&BEAM, &[0.0, 1.0], &[], ends).is_none());
        }
        for ends in [[PINNED, GUIDED], [FREE, CLAMPED], [GUIDED, PINNED]] {
            assert!(deflected_line(&BEAM, &[0.0, 1.0], &[], ends).is_some());
        }
    }

    #[test]
    fn on_two_supports_the_overhangs_rise() {
        // L = 4 between supports at 1 and 5, F = 3 amid: F L³/(48 EI) + F L/(4 kGA) there; the ends rise
        // straight on, at a distance 1 by the slope F L²/(16 EI) at the supports, shear aside
        let forces = [force(1.0, 1.5), force(3.0, -3.0), force(5.0, 1.5)];
        let line = line_on_supports(&BEAM, &[0.0, 1.0, 3.0, 5.0, 6.0], &forces, [1.0, 5.0]);
        near(line[2], -(3.0 * 64.0 / 96.0 + 12.0 / 20.0));
        near(line[0], 3.0 * 16.0 / 32.0);
        near(line[4], line[0]);
        near(line[1], 0.0);
    }
}
