//! Slack and preload: where the abscissa begins to count.
use super::{Hints, Place, Refusal};

/// Moves the origin of the abscissa, and takes out the points before it; says what it did.
///
/// With the abscissa x₀ of the new origin, x becomes x − x₀; a strain ε, of which the slack is no part
/// of the specimen's length, becomes (ε − ε₀)/(1 + ε₀), elongation over gauge length and slack
/// (ISO 13934-1, specimens mounted slack).
///
/// # Errors
/// When the curve does not get to the ordinates that are named.
pub(super) fn move_to(
    points: &mut Vec<[f64; 2]>,
    is_strain: bool,
    hints: &Hints<'_>,
) -> Result<Vec<String>, Refusal> {
    let mut words = Vec::new();
    if let Some([low, high]) = hints.slack {
        let between = |ordinate| reached(points, ordinate, Place::Slack);
        let (one, other) = (between(low)?, between(high)?);
        if other.abscissa <= one.abscissa {
            let detail =
                format!("between {low} and {high} the curve does not rise with its abscissa");
            let allowed = "two ordinates, the smaller first, of a straight rising part";
            return Err(Refusal::new(Place::Slack, "out_of_range", detail, allowed));
        }
        let origin = one.abscissa - low * (other.abscissa - one.abscissa) / (high - low);
        shift(points, origin, is_strain, |[x, _]| *x >= origin);
        points.insert(0, [0.0, 0.0]);
        words.push(format!(
            "slack of {origin:.6} taken off, where the line through ordinates {low} and {high} is at 0"
        ));
    }
    if let Some(preload) = hints.preload {
        let begin = reached(points, preload, Place::Preload)?;
        let mut index = 0;
        shift(points, begin.abscissa, is_strain, |_| {
            index += 1;
            index > begin.before
        });
        if points.first().is_none_or(|[x, _]| *x > 0.0) {
            points.insert(0, [0.0, preload]);
        }
        words.push(format!(
            "counted from {:.6}, where the ordinate first is at the preload of {preload}",
            begin.abscissa
        ));
    }
    Ok(words)
}

fn shift(
    points: &mut Vec<[f64; 2]>,
    origin: f64,
    is_strain: bool,
    keep: impl FnMut(&[f64; 2]) -> bool,
) {
    let length = if is_strain { 1.0 + origin } else { 1.0 };
    points.retain(keep);
    for [x, _] in points {
        *x = (*x - origin) / length;
    }
}

/// Where a curve first gets to an ordinate.
struct Reached {
    abscissa: f64,
    /// Points before it.
    before: usize,
}

fn reached(points: &[[f64; 2]], ordinate: f64, place: Place) -> Result<Reached, Refusal> {
    let at = points.iter().position(|[_, y]| *y >= ordinate);
    let Some(at) = at else {
        let largest = points
            .iter()
            .map(|[_, y]| *y)
            .fold(f64::NEG_INFINITY, f64::max);
        let detail = format!("the curve does not get there: its largest ordinate is {largest}");
        let refusal = Refusal::new(place, "out_of_range", detail, "an ordinate of the curve");
        return Err(refusal.value(ordinate.to_string()));
    };
    let [x, y] = points[at];
    let abscissa = match at.checked_sub(1).map(|before| points[before]) {
        Some([x0, y0]) => x0 + (ordinate - y0) / (y - y0) * (x - x0),
        None => x,
    };
    Ok(Reached {
        abscissa,
        before: at,
    })
}
