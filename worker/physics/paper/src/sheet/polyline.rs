//! Polylines: their length, points at an arc length, what a rectangle leaves of them.

/// End segments shorter than this share of their neighbours are joined to them: a cut may pass a
/// point at any distance, and a segment of no length has a stiffness without bound.
const SHORT_END: f64 = 0.1;

/// A polyline within a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) points: Vec<[f64; 3]>,
    /// Whether its first and its last point lie on the rectangle's edge because it was cut there.
    pub(super) is_cut: [bool; 2],
    /// Arc lengths [µm] of its ends on the whole polyline.
    pub(super) span_um: [f64; 2],
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    (x * x + y * y + z * z).sqrt()
}

/// Length [µm].
pub(super) fn length(points: &[[f64; 3]]) -> f64 {
    points
        .windows(2)
        .map(|ends| distance(ends[0], ends[1]))
        .sum()
}

/// Arc length [µm] of every point from the first.
pub(super) fn arc_lengths(points: &[[f64; 3]]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut arcs = Vec::with_capacity(points.len());
    arcs.push(sum);
    arcs.extend(points.windows(2).map(|ends| {
        sum += distance(ends[0], ends[1]);
        sum
    }));
    arcs
}

/// The point a share `t` of the way from one to another.
pub(super) fn between(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + t * (b[axis] - a[axis]))
}

/// What lies between two arc lengths [µm] from the first point.
pub(super) fn part(points: &[[f64; 3]], from_um: f64, to_um: f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::with_capacity(points.len());
    let mut start = 0.0;
    for ends in points.windows(2) {
        let segment = distance(ends[0], ends[1]);
        let end = start + segment;
        if segment > 0.0 && end > from_um && start < to_um {
            let at = |arc: f64| between(ends[0], ends[1], (arc - start) / segment);
            if kept.is_empty() {
                kept.push(if from_um > start {
                    at(from_um)
                } else {
                    ends[0]
                });
            }
            kept.push(if to_um < end { at(to_um) } else { ends[1] });
        }
        start = end;
    }
    join_short_ends(&mut kept);
    kept
}

/// Its beginning, exactly so long [µm]; all of it when it is no longer.
pub(super) fn shortened(mut points: Vec<[f64; 3]>, length_um: f64) -> Vec<[f64; 3]> {
    let arcs = arc_lengths(&points);
    // the first point at or beyond the new end, at least the second
    let mut end = arcs.partition_point(|arc| *arc < length_um).max(1);
    if end >= points.len() {
        return points;
    }
    // a segment that would be short is joined to the one before
    if end > 1 && length_um - arcs[end - 1] < SHORT_END * (arcs[end - 1] - arcs[end - 2]) {
        end -= 1;
    }
    let [from, to] = [points[end - 1], points[end]];
    points.truncate(end);
    let share = (length_um - arcs[end - 1]) / (arcs[end] - arcs[end - 1]);
    points.push(between(from, to, share));
    points
}

/// The parts of a polyline within 0 ≤ x ≤ size, 0 ≤ y ≤ size, in its order. Cut ends lie exactly on
/// the edge.
pub(super) fn cut(points: &[[f64; 3]], size: [f64; 2]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut is_open = false;
    let mut arc = 0.0;
    for ends in points.windows(2) {
        let segment = distance(ends[0], ends[1]);
        let start = arc;
        arc += segment;
        let Some([entry, exit]) = inside(ends[0], ends[1], size) else {
            is_open = false;
            continue;
        };
        if !is_open {
            pieces.push(Piece {
                points: vec![entry.map_or(ends[0], |(_, point)| point)],
                is_cut: [entry.is_some(), false],
                span_um: [start + segment * entry.map_or(0.0, |(t, _)| t), 0.0],
            });
        }
        if let Some(piece) = pieces.last_mut() {
            piece.points.push(exit.map_or(ends[1], |(_, point)| point));
            piece.is_cut[1] = exit.is_some();
            piece.span_um[1] = start + segment * exit.map_or(1.0, |(t, _)| t);
        }
        is_open = exit.is_none();
    }
    for piece in &mut pieces {
        join_short_ends(&mut piece.points);
    }
    pieces
}

/// A point of a segment on the edge, and its share of the segment.
type Crossing = Option<(f64, [f64; 3])>;

/// Where a segment enters and leaves the rectangle, `None` for ends inside; nothing when it has no
/// length inside. Source: [LiangBarsky1984].
fn inside(a: [f64; 3], b: [f64; 3], size: [f64; 2]) -> Option<[Crossing; 2]> {
    let mut entry: Option<(f64, usize, f64)> = None;
    let mut exit: Option<(f64, usize, f64)> = None;
    for axis in 0..2 {
        let along = b[axis] - a[axis];
        for (edge, outward) in [(0.0, -1.0), (size[axis], 1.0)] {
            // outside where (x − edge) · outward > 0
            let [first, last] = [a, b].map(|point| (point[axis] - edge) * outward);
            if first > 0.0 && last > 0.0 {
                return None;
            }
            let t = (edge - a[axis]) / along;
            if first > 0.0 && entry.is_none_or(|(latest, ..)| t > latest) {
                entry = Some((t, axis, edge));
            }
            if last > 0.0 && exit.is_none_or(|(earliest, ..)| t < earliest) {
                exit = Some((t, axis, edge));
            }
        }
    }
    let [from, to] = [
        entry.map_or(0.0, |(t, ..)| t),
        exit.map_or(1.0, |(t, ..)| t),
    ];
    if from >= to {
        return None;
    }
    let on_edge = |crossing: (f64, usize, f64)| {
        let (t, axis, edge) = crossing;
        let mut point = between(a, b, t);
        for axis in 0..2 {
            point[axis] = point[axis].clamp(0.0, size[axis]);
        }
        point[axis] = edge;
        (t, point)
    };
    Some([entry.map(on_edge), exit.map(on_edge)])
}

fn join_short_ends(points: &mut Vec<[f64; 3]>) {
    let count = points.len();
    if count > 2 && is_short(points[0], points[1], points[2]) {
        points.remove(1);
    }
    let count = points.len().min(count);
    if count > 2 && is_short(points[count - 1], points[count - 2], points[count - 3]) {
        points.remove(count - 2);
    }
}

fn is_short(end: [f64; 3], next: [f64; 3], after: [f64; 3]) -> bool {
    distance(end, next) < SHORT_END * distance(next, after)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        points.iter().map(|[x, y]| [*x, *y, 1.0]).collect()
    }

    #[test]
    fn a_line_through_the_rectangle_ends_exactly_on_its_edges() {
        let pieces = cut(&flat(&[[-1.0, 0.3], [4.1, 0.7], [11.3, 0.9]]), [10.0, 5.0]);
        let [piece] = &pieces[..] else {
            panic!("one piece: {pieces:?}");
        };
        assert_eq!(piece.is_cut, [true, true]);
        assert!(piece.points[0][0].abs() < f64::MIN_POSITIVE);
        assert!((piece.points[2][0] - 10.0).abs() < f64::MIN_POSITIVE);
        let whole = length(&piece.points);
        assert!((piece.span_um[1] - piece.span_um[0] - whole).abs() < 1e-12);
    }

    #[test]
    fn a_bent_line_that_leaves_and_returns_makes_two_pieces() {
        let line = flat(&[[1.0, 1.0], [5.0, 9.0], [9.0, 1.0]]);
        let pieces = cut(&line, [10.0, 5.0]);
        assert_eq!(pieces.len(), 2);
        assert_eq!(
            [pieces[0].is_cut, pieces[1].is_cut],
            [[false, true], [true, false]]
        );
        assert_eq!(pieces[0].points, flat(&[[1.0, 1.0], [3.0, 5.0]]));
        assert_eq!(pieces[1].points, flat(&[[7.0, 5.0], [9.0, 1.0]]));
    }

    #[test]
    fn a_corner_is_cut_on_both_edges_and_what_is_outside_leaves_nothing() {
        let pieces = cut(&flat(&[[-1.0, 1.0], [1.0, -1.0]]), [10.0, 5.0]);
        assert!(pieces.is_empty(), "a corner has no length: {pieces:?}");
        let pieces = cut(&flat(&[[-1.0, 2.0], [2.0, -1.0]]), [10.0, 5.0]);
        assert_eq!(pieces[0].points, flat(&[[0.0, 1.0], [1.0, 0.0]]));
        assert!(cut(&flat(&[[-1.0, -2.0], [12.0, -1.0]]), [10.0, 5.0]).is_empty());
        assert!(cut(&flat(&[[-3.0, 2.0], [2.0, -3.0]]), [10.0, 5.0]).is_empty());
    }

    #[test]
    fn a_point_just_inside_makes_no_short_segment() {
        let line = flat(&[[-1.0, 1.0], [1e-9, 1.0], [1.0, 1.0], [2.0, 1.0]]);
        let pieces = cut(&line, [10.0, 5.0]);
        assert_eq!(
            pieces[0].points,
            flat(&[[0.0, 1.0], [1.0, 1.0], [2.0, 1.0]])
        );
    }

    #[test]
    fn a_shortened_line_is_exactly_so_long() {
        let line = flat(&[[0.0, 0.0], [3.0, 4.0], [3.0, 10.0]]);
        for wanted in [0.1, 4.9, 5.0, 5.1, 10.0, 11.0] {
            let kept = shortened(line.clone(), wanted);
            assert!((length(&kept) - wanted).abs() < 1e-14 * 11.0, "{wanted}");
        }
        // 0.1 beyond a bend, it goes straight on
        assert_eq!(shortened(line.clone(), 5.1).len(), 2);
        assert_eq!(shortened(line, 6.0).len(), 3);
    }

    #[test]
    fn a_part_is_as_long_as_its_arc_lengths_say() {
        let line = flat(&[[0.0, 0.0], [3.0, 4.0], [3.0, 10.0]]);
        for (from, to) in [(0.0, 11.0), (1.0, 4.0), (4.9, 5.3), (6.0, 10.5)] {
            let kept = part(&line, from, to);
            // short ends are joined across the bend
            let joined = if from > 4.0 && from < 5.0 {
                0.05
            } else {
                1e-12
            };
            assert!((length(&kept) - (to - from)).abs() < joined, "{from} {to}");
        }
        assert_eq!(arc_lengths(&line), [0.0, 5.0, 11.0]);
    }
}
