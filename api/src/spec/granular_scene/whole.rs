//! Volume, middle and extent of a clump, before the engine makes it.
use std::f64::consts::PI;

use super::Member;

/// What a clump is as a whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole {
    /// Of the union of its members [m³].
    pub(crate) volume: f64,
    /// Radius of the ball about its centre of mass that holds it [m].
    pub(crate) reach: f64,
    /// Distance of the farthest centre of a member from there [m].
    pub(crate) farthest: f64,
}

/// Lines along z across a clump, each way.
const LINES: usize = 64;
/// Across a radius, at least.
const LINES_ACROSS: f64 = 1.5;

impl Whole {
    /// Of members, by lines along z that are cut where they enter and leave the union: volumes to some
    /// thousandths.
    pub(crate) fn of(members: &[Member]) -> Self {
        let ends = |axis: usize| {
            let sides = members.iter().map(|member| {
                let [low, high] = [-1.0, 1.0].map(|side| side * member.radius_m);
                [member.offset_m[axis] + low, member.offset_m[axis] + high]
            });
            sides.fold([f64::INFINITY, f64::NEG_INFINITY], |sum, side| {
                [sum[0].min(side[0]), sum[1].max(side[1])]
            })
        };
        let across = [ends(0), ends(1)];
        let width = across.map(|[low, high]| (high - low) / LINES as f64);
        let thinnest = members.iter().map(|member| member.radius_m);
        if thinnest.fold(f64::INFINITY, f64::min) < LINES_ACROSS * width[0].max(width[1]) {
            return Self::of_apart(members);
        }
        let mut lines: Vec<Vec<[f64; 2]>> = vec![Vec::new(); LINES * LINES];
        let place = |axis: usize, line: usize| across[axis][0] + (line as f64 + 0.5) * width[axis];
        for Member { offset_m, radius_m } in members {
            let [first, last] = [-1.0, 1.0].map(|side| {
                // beyond the box lies no line
                [0, 1].map(|axis| {
                    let at = offset_m[axis] + side * radius_m - across[axis][0];
                    ((at / width[axis]).floor().max(0.0) as usize).min(LINES - 1)
                })
            });
            for x in first[0]..=last[0] {
                for y in first[1]..=last[1] {
                    let beside = (place(0, x) - offset_m[0]).hypot(place(1, y) - offset_m[1]);
                    let half = radius_m * radius_m - beside * beside;
                    if half > 0.0 {
                        let half = half.sqrt();
                        lines[x * LINES + y].push([offset_m[2] - half, offset_m[2] + half]);
                    }
                }
            }
        }
        let (mut length, mut moments) = (0.0, [0.0; 3]);
        for (number, line) in lines.iter_mut().enumerate() {
            line.sort_by(|one, other| one[0].total_cmp(&other[0]));
            let mut top = f64::NEG_INFINITY;
            for [from, to] in line {
                let from = from.max(top);
                if *to > from {
                    let part = *to - from;
                    length += part;
                    moments[0] += part * place(0, number / LINES);
                    moments[1] += part * place(1, number % LINES);
                    moments[2] += part * 0.5 * (from + *to);
                    top = *to;
                }
            }
        }
        let centre = moments.map(|moment| moment / length);
        Self::about(centre, length * width[0] * width[1], members)
    }

    /// Of members so small that lines would miss them: as if none overlapped another.
    fn of_apart(members: &[Member]) -> Self {
        let (mut volume, mut moments) = (0.0, [0.0; 3]);
        for member in members {
            let part = 4.0 / 3.0 * PI * member.radius_m.powi(3);
            volume += part;
            for (moment, offset) in moments.iter_mut().zip(&member.offset_m) {
                *moment += part * offset;
            }
        }
        Self::about(moments.map(|moment| moment / volume), volume, members)
    }

    fn about(centre: [f64; 3], volume: f64, members: &[Member]) -> Self {
        let away = |member: &Member| {
            let squares = (0..3).map(|axis| (member.offset_m[axis] - centre[axis]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        Self {
            volume,
            reach: (members.iter())
                .map(|member| away(member) + member.radius_m)
                .fold(0.0, f64::max),
            farthest: members.iter().map(away).fold(0.0, f64::max),
        }
    }

    /// Radius of the ball of its volume [m].
    pub(crate) fn equal_radius(&self) -> f64 {
        (self.volume * 0.75 / PI).cbrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(offset_m: [f64; 3], radius_m: f64) -> Member {
        Member { offset_m, radius_m }
    }

    #[test]
    fn lines_find_the_volume_and_middle_of_members_that_overlap() {
        // two balls of 1 at ±½: each loses a cap of height ½, π h² (3 − h)/3 = 5π/24
        let two = [[0.3, 0.0, 0.5], [0.3, 0.0, -0.5]].map(|offset| member(offset, 1.0));
        let whole = Whole::of(&two);
        let volume = 8.0 / 3.0 * PI - 2.0 * 5.0 / 24.0 * PI;
        // 64 lines across a diameter: h²/24 of the curvature, and as much where lines begin and end
        assert!(
            (whole.volume / volume - 1.0).abs() < 2e-3,
            "{whole:?} {volume}"
        );
        assert!((whole.reach - 1.5).abs() < 1e-9, "{whole:?}");
        assert!((whole.farthest - 0.5).abs() < 1e-9, "{whole:?}");
        // the same about another axis
        let lying = [[0.0, 0.5, 7.0], [0.0, -0.5, 7.0]].map(|offset| member(offset, 1.0));
        let lying = Whole::of(&lying);
        assert!((lying.volume / volume - 1.0).abs() < 2e-3, "{lying:?}");
    }

    #[test]
    fn members_that_lines_would_miss_are_summed() {
        let two = [[10.0, 0.0, 0.0], [-10.0, 0.0, 0.0]].map(|offset| member(offset, 0.1));
        let whole = Whole::of(&two);
        let volume = 2.0 * 4.0 / 3.0 * PI * 1e-3;
        assert!((whole.volume / volume - 1.0).abs() < 1e-12, "{whole:?}");
        assert!((whole.reach - 10.1).abs() < 1e-12, "{whole:?}");
    }

    #[test]
    fn a_ball_is_its_own_whole() {
        let whole = Whole::of(&[member([1.0, 2.0, 3.0], 0.5)]);
        // the middle by lines, which are half a line off at most
        assert!((whole.reach - 0.5).abs() < 1e-9, "{whole:?}");
        assert!((whole.equal_radius() - 0.5).abs() < 1e-3, "{whole:?}");
    }
}
