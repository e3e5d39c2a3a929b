//! What rollers could touch, and that they do not touch each other.
use super::roller::Roller;
use crate::error::CompositeError;
use crate::section::Grid;
use crate::supports::{Face, Supports};

/// A particle in a roller's reach.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    /// Place of the nearest roller of its face.
    pub(crate) roller: usize,
    /// Across the face.
    pub(crate) displacement: usize,
    /// The inward normal's component along it.
    pub(crate) inward: f64,
    /// Along the face.
    pub(crate) at_mm: f64,
    /// To the roller while that just touches.
    pub(crate) gap_mm: f64,
}

/// Two circles on one side of a line are apart when their feet are 2√(R₁R₂) apart.
pub(super) fn refuse_overlap(rollers: &[Roller]) -> Result<(), CompositeError> {
    for (second, b) in rollers.iter().enumerate() {
        for (first, a) in rollers[..second].iter().enumerate() {
            let distance_mm = (a.at_mm - b.at_mm).abs();
            let least_mm = 2.0 * (a.radius_mm * b.radius_mm).sqrt();
            if a.face == b.face && distance_mm < least_mm {
                return Err(CompositeError::RollersOverlap {
                    first,
                    second,
                    distance_mm,
                    least_mm,
                });
            }
        }
    }
    Ok(())
}

/// All particles that a roller could touch, each with the nearest roller of its face.
///
/// # Errors
/// [`CompositeError::RollerOnSupport`].
pub(crate) fn points(
    grid: &Grid,
    supports: &Supports,
    rollers: &[Roller],
) -> Result<Vec<Point>, CompositeError> {
    let mut points = Vec::new();
    for face in Face::ALL {
        for (line, &at_mm) in face.lines_mm(grid).iter().enumerate() {
            let nearest = rollers
                .iter()
                .enumerate()
                .filter(|(_, roller)| roller.face == face)
                .filter_map(|(place, roller)| Some((place, roller, roller.gap(at_mm)?)))
                .min_by(|a, b| a.2.total_cmp(&b.2));
            let Some((place, roller, gap_mm)) = nearest else {
                continue;
            };
            let displacement = 2 * face.particle(grid, line) + roller.normal();
            if supports.is_held(displacement) {
                let [x_mm, y_mm] = grid.place_mm(displacement / 2);
                return Err(CompositeError::RollerOnSupport {
                    roller: place,
                    x_mm,
                    y_mm,
                });
            }
            points.push(Point {
                roller: place,
                displacement,
                inward: roller.inward(),
                at_mm,
                gap_mm,
            });
        }
    }
    Ok(points)
}
