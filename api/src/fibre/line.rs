//! Rings along a fibre's line.
use super::{FibreError, Segment};

/// sin(β/2) of the sharpest turn β between two chords, 128°: a fibre that turns back has no ring across.
const SHARPEST: f64 = 0.9;

/// Centres of the rings of so many equal segments [µm], at equal arc lengths of a line, its ends included.
///
/// The ring between two chords lies across their bisector, so that its points, Φ/2 from the centre, come up to
/// Φ/2 sin(β/2) nearer to the next ring where chords turn by β.
///
/// # Errors
/// [`FibreError::TooBent`] where rings would cut through one another, and [`FibreError::OutOfRange`] for a line without
/// length.
pub fn ring_centres(
    line_um: &[[f64; 3]],
    segments: usize,
    segment: &Segment,
) -> Result<Vec<[f64; 3]>, FibreError> {
    let length_um = line_length_um(line_um);
    if !(length_um.is_finite() && length_um > 0.0) {
        return Err(FibreError::out_of_range(
            "length of a fibre's line",
            "µm",
            length_um,
            "above 0",
        ));
    }
    let mut centres = Vec::with_capacity(segments + 1);
    let (mut part, mut before) = (0, 0.0);
    for ring in 0..=segments {
        let arc = length_um * ring as f64 / segments as f64;
        // the parts of a line of one point are none, and its length is 0
        while part + 2 < line_um.len() && before + distance(line_um[part], line_um[part + 1]) < arc
        {
            before += distance(line_um[part], line_um[part + 1]);
            part += 1;
        }
        let [from, to] = [line_um[part], line_um[part + 1]];
        let share = ((arc - before) / distance(from, to)).min(1.0);
        centres.push(std::array::from_fn(|axis| {
            from[axis] + share * (to[axis] - from[axis])
        }));
    }
    check_bends(&centres, segment)?;
    Ok(centres)
}

/// Length of a line [µm].
pub fn line_length_um(line_um: &[[f64; 3]]) -> f64 {
    line_um
        .windows(2)
        .map(|ends| distance(ends[0], ends[1]))
        .sum()
}

fn check_bends(centres: &[[f64; 3]], segment: &Segment) -> Result<(), FibreError> {
    let chords: Vec<f64> = centres
        .windows(2)
        .map(|ends| distance(ends[0], ends[1]))
        .collect();
    // sin(β/2) between chords a and b is |a - b|/2 of unit vectors; rings at the ends are across their chord
    let half_turns = centres
        .windows(3)
        .zip(chords.windows(2))
        .map(|(at, lengths)| {
            let parts = (0..3).map(|axis| {
                let before = (at[1][axis] - at[0][axis]) / lengths[0];
                let after = (at[2][axis] - at[1][axis]) / lengths[1];
                (after - before).powi(2)
            });
            0.5 * parts.sum::<f64>().sqrt()
        });
    let mut sines = vec![0.0];
    sines.extend(half_turns);
    sines.push(0.0);
    let radius = 0.5 * segment.diameter_um();
    for (place, (chord, sines)) in chords.iter().zip(sines.windows(2)).enumerate() {
        // nan where two rings are in one place
        let is_apart = radius * (sines[0] + sines[1]) < *chord;
        if !is_apart || sines[1] > SHARPEST {
            return Err(FibreError::TooBent {
                at_um: (place as f64 + 0.5) * segment.length_um(),
                diameter_um: segment.diameter_um(),
            });
        }
    }
    Ok(())
}

fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| other[axis] - one[axis]);
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_at_equal_arc_lengths() {
        // 3-4-5, then 10 along z: 15 µm in three
        let line = [[0.0; 3], [3.0, 4.0, 0.0], [3.0, 4.0, 10.0]];
        let segment = Segment::new(6, 2.0, 5.0).unwrap();
        let centres = ring_centres(&line, 3, &segment).unwrap();
        let expected = [[0.0; 3], [3.0, 4.0, 0.0], [3.0, 4.0, 5.0], [3.0, 4.0, 10.0]];
        for (one, other) in centres.iter().zip(expected) {
            assert!(distance(*one, other) < 1e-12, "{one:?}");
        }
    }

    #[test]
    fn rings_that_would_cut_through_one_another_are_refused() {
        // a right angle between chords of 10 µm: sin 45° = 0.7071, half a diameter of 14.1 µm reaches 5.0, one of
        // 28.4 µm 10.04
        let line = [[0.0; 3], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]];
        let centres = |diameter| ring_centres(&line, 2, &Segment::new(6, diameter, 10.0).unwrap());
        assert!(centres(28.2).is_ok());
        let error = centres(28.4).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the fibre turns too sharply 5.0000 µm from its start: rings of 28.4000 µm across would cut through \
             one another; allowed are longer segments or a smoother line"
        );
        let folded = [[0.0; 3], [10.0, 0.0, 0.0], [0.0; 3]];
        assert!(ring_centres(&folded, 4, &Segment::new(6, 1.0, 5.0).unwrap()).is_err());
    }
}
