//! Where the arms of a split laminate are.
use loadframe_api::spec::composite_bending::{CompositeBending, Delamination};

/// The stretch that is apart from the start and begins at the left end.
pub(super) fn open(spec: &CompositeBending) -> Option<&Delamination> {
    let mut all = spec.delaminations.iter();
    all.find(|open| open.from_mm <= 0.0)
}

/// Heights of the middles of both arms [mm], lower and upper.
pub(super) fn arms_middle_mm(spec: &CompositeBending) -> [f64; 2] {
    let face = face_mm(spec);
    [0.5 * face, 0.5 * (face + spec.section.height_mm)]
}

/// Height of the face that is open [mm].
pub(super) fn face_mm(spec: &CompositeBending) -> f64 {
    let beneath = open(spec).map_or(0, |open| open.above_ply as usize);
    let plies = spec.plies.iter().take(beneath);
    plies.map(|ply| ply.thickness_mm).sum()
}
