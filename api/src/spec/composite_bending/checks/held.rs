//! A section that must be held, and loaded by something.
use crate::spec::composite_bending::{
    Axis, CompositeBending, Face, HistoryLoad, LoadPlace, Solver, Support, SupportWord, Supports,
    Test,
};
use crate::{Violation, Violations};

pub(super) fn check_held(
    spec: &CompositeBending,
    supports: &Supports,
    violations: &mut Violations,
) {
    let test = &spec.test;
    let drives = supports.faces().iter().any(|(_, support)| support.drives());
    if test.load.is_none() && !drives && !moves_first(test) {
        violations.push(
            Violation::new("/test/load", "missing", "nothing loads the section")
                .allowed("a load, a face with displacement_mm, or a velocity in history"),
        );
    }
    check_load(spec, violations);
    check_borne(spec, supports, violations);
    check_free(spec, supports, violations);
    check_history(spec, violations);
    check_corners(supports, violations);
    if let Some(motion) = loose(supports) {
        violations.push(
            Violation::new(
                "/test/supports",
                "unsupported",
                format!("the supports let the section {motion}"),
            )
            .allowed("faces held so that it can neither move along x, along y, nor turn"),
        );
    }
}

/// Faces that meet at a corner and move it to two places.
fn check_corners(supports: &Supports, violations: &mut Violations) {
    let across = [(Face::Left, &supports.left), (Face::Right, &supports.right)];
    let along = [(Face::Bottom, &supports.bottom), (Face::Top, &supports.top)];
    for (first, one) in across {
        for (second, other) in along {
            let pair = [(first, one), (second, other)].map(|(face, held)| prescribed(face, held));
            for (axis, name) in ["x", "y"].into_iter().enumerate() {
                let (Some(a), Some(b)) = (pair[0][axis], pair[1][axis]) else {
                    continue;
                };
                if (a - b).abs() > SAME * a.abs().max(b.abs()) {
                    violations.push(
                        Violation::new(
                            "/test/supports",
                            "contradiction",
                            format!(
                                "the {} and the {} face ask their common corner for different \
                                 displacements along {name}",
                                first.name(),
                                second.name()
                            ),
                        )
                        .value(vec![a, b])
                        .allowed(
                            "the same displacement, or one of the two left free along this axis",
                        )
                        .unit("mm"),
                    );
                }
            }
        }
    }
}

/// Displacements that differ by less than this part are the same.
const SAME: f64 = 1e-12;

/// What a face is held at along both axes [mm].
fn prescribed(face: Face, support: &Support) -> [Option<f64>; 2] {
    match support {
        Support::Driven(driven) => driven.displacement_mm,
        _ => held_axes(face, support).map(|is_held| is_held.then_some(0.0)),
    }
}

/// Whether the history itself sets the section in motion.
fn moves_first(test: &Test) -> bool {
    let history = test.history.as_ref();
    history.is_some_and(|history| history.velocity_mm_per_s.iter().any(|speed| *speed != 0.0))
}

/// How the section could move as a whole: a face is a line of points, so that one held across
/// resists turning, and two held along do, too.
fn loose(supports: &Supports) -> Option<&'static str> {
    let held = supports
        .faces()
        .map(|(face, support)| (face, held_axes(face, support)));
    let along = |axis: usize| held.iter().any(|(_, axes)| axes[axis]);
    if !along(0) {
        return Some("move along x");
    }
    if !along(1) {
        return Some("move along y");
    }
    // a face held across keeps its direction; one held only along itself turns about any of its
    // points unless another line of such points exists
    let across = held.iter().any(|(face, axes)| match face {
        Face::Left | Face::Right => axes[0],
        Face::Bottom | Face::Top => axes[1],
    });
    let pair = |first: Face, second: Face, axis: usize| {
        let is_held = |face: Face| {
            held.iter()
                .any(|(known, axes)| *known == face && axes[axis])
        };
        is_held(first) && is_held(second)
    };
    let turns = !across && !pair(Face::Left, Face::Right, 1) && !pair(Face::Bottom, Face::Top, 0);
    turns.then_some("turn")
}

fn held_axes(face: Face, support: &Support) -> [bool; 2] {
    match support {
        Support::Word(SupportWord::Clamped) => [true; 2],
        Support::Word(SupportWord::Free) => [false; 2],
        Support::Word(SupportWord::Rolling) => match face {
            Face::Left | Face::Right => [true, false],
            Face::Bottom | Face::Top => [false, true],
        },
        Support::PerAxis(axes) => axes.map(|axis| axis == Axis::Clamped),
        Support::Driven(driven) => driven.displacement_mm.map(|value| value.is_some()),
    }
}

fn check_load(spec: &CompositeBending, violations: &mut Violations) {
    let Some(load) = &spec.test.load else { return };
    if load.force_n.iter().all(|force| *force == 0.0) {
        violations.push(
            Violation::new("/test/load/force_n", "out_of_range", "the load is no force")
                .value(load.force_n.to_vec())
                .allowed("a force other than 0")
                .unit("N"),
        );
    }
    let sides = [spec.section.length_mm, spec.section.height_mm];
    match &load.on {
        LoadPlace::Patch(patch) => {
            let side = match patch.face {
                Face::Left | Face::Right => sides[1],
                Face::Bottom | Face::Top => sides[0],
            };
            if patch.to_mm <= patch.from_mm || patch.to_mm > side {
                violations.push(
                    Violation::new(
                        "/test/load/on/patch",
                        "load_on_nothing",
                        format!("the patch is no part of the {} face", patch.face.name()),
                    )
                    .value(vec![patch.from_mm, patch.to_mm])
                    .allowed(format!("0 ≤ from_mm < to_mm ≤ {side}"))
                    .unit("mm"),
                );
            }
        }
        LoadPlace::PointMm(point) => {
            violations.extend(outside(spec, "/test/load/on/point_mm".to_owned(), *point));
        }
        LoadPlace::Face(_) | LoadPlace::Body => {}
    }
}

/// A force on points that are held along it goes into the support and moves nothing.
fn check_borne(spec: &CompositeBending, supports: &Supports, violations: &mut Violations) {
    let Some(load) = &spec.test.load else { return };
    let sides = [spec.section.length_mm, spec.section.height_mm];
    let acts_on = |face: Face| match &load.on {
        LoadPlace::Face(loaded) => *loaded == face,
        LoadPlace::Patch(patch) => patch.face == face,
        LoadPlace::PointMm([x, y]) => match face {
            Face::Left => *x <= 0.0,
            Face::Right => *x >= sides[0],
            Face::Bottom => *y <= 0.0,
            Face::Top => *y >= sides[1],
        },
        LoadPlace::Body => false,
    };
    for (face, support) in supports.faces() {
        if !acts_on(face) {
            continue;
        }
        let held = held_axes(face, support);
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            if held[axis] && load.force_n[axis] != 0.0 {
                violations.push(
                    Violation::new(
                        format!("/test/load/force_n/{axis}"),
                        "load_on_nothing",
                        format!(
                            "the {} face is held along {name} where the force acts: its support \
                             bears the force, which moves nothing",
                            face.name()
                        ),
                    )
                    .value(load.force_n[axis])
                    .allowed(format!(
                        "0, a load elsewhere, or a face left free along {name}"
                    ))
                    .unit("N"),
                );
            }
        }
    }
}

/// A force along an axis along which no particle can move: one cell between two held faces has none but theirs.
fn check_free(spec: &CompositeBending, supports: &Supports, violations: &mut Violations) {
    let Some(load) = &spec.test.load else { return };
    let pairs = [
        [(Face::Left, &supports.left), (Face::Right, &supports.right)],
        [(Face::Bottom, &supports.bottom), (Face::Top, &supports.top)],
    ];
    let cells = spec.grid().cells;
    for (across, pair) in pairs.into_iter().enumerate() {
        let is_held = |axis: usize| pair.iter().all(|(face, held)| held_axes(*face, held)[axis]);
        let is_borne = |axis: usize| load.force_n[axis] != 0.0 && is_held(axis);
        if cells[across] < 2 && (is_borne(0) || is_borne(1)) {
            violations.push(
                Violation::new(
                    format!("/grid/cells/{across}"),
                    "load_on_nothing",
                    format!(
                        "the {} and the {} face are held along the force, and one cell between them has no \
                         particle that could move",
                        pair[0].0.name(),
                        pair[1].0.name()
                    ),
                )
                .value(cells[across])
                .allowed("at least 2 between faces that are held"),
            );
        }
    }
}

fn check_history(spec: &CompositeBending, violations: &mut Violations) {
    let Some(history) = &spec.test.history else {
        return;
    };
    let knobs = spec.accuracy.knobs();
    if knobs.solver != Solver::Verlet {
        violations.push(
            Violation::new(
                "/accuracy/solver",
                "not_allowed",
                "motion in time is that of springs: the shifts of pbd and xpbd damp it, and static \
                 has none",
            )
            .allowed("\"verlet\" with history"),
        );
    }
    if history.load == HistoryLoad::Released && spec.test.load.is_none() {
        violations.push(
            Violation::new("/test/load", "missing", "there is no load to release")
                .allowed("a load"),
        );
    }
}

/// A point of the section that lies outside of it.
pub(super) fn outside(
    spec: &CompositeBending,
    pointer: String,
    [x, y]: [f64; 2],
) -> Option<Violation> {
    let (length, height) = (spec.section.length_mm, spec.section.height_mm);
    let is_inside = (0.0..=length).contains(&x) && (0.0..=height).contains(&y);
    (!is_inside).then(|| {
        Violation::new(
            pointer,
            "outside_section",
            "the point lies outside the section",
        )
        .value(vec![x, y])
        .allowed(format!("x from 0 to {length}, y from 0 to {height}"))
        .unit("mm")
    })
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::{JobKind, Submission, SubmissionError};

    /// The pointers at what is refused of the paper's section with a load and supports.
    fn refused(load: Value, supports: Value) -> Vec<String> {
        let body = JobKind::CompositeBending.examples()[0].body;
        let mut body: Value = serde_json::from_str(body).expect("JSON");
        body["spec"]["test"] = json!({"load": load, "supports": supports});
        pointers(&body)
    }

    fn pointers(body: &Value) -> Vec<String> {
        match Submission::from_slice(body.to_string().as_bytes()) {
            Ok(_) => Vec::new(),
            Err(SubmissionError::Invalid(violations)) => violations
                .into_iter()
                .map(|violation| format!("{} {}", violation.pointer, violation.code))
                .collect(),
            Err(other) => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_force_that_a_support_bears_is_refused() {
        let body_text = JobKind::CompositeBending.examples()[0].body;
        let body: Value = serde_json::from_str(body_text).expect("JSON");
        let side = |name: &str| body["spec"]["section"][name].as_f64().expect("a number");
        let (length, height) = (side("length_mm"), side("height_mm"));
        let sides = json!({"left": "clamped", "right": "clamped"});
        let borne = |axis: usize| vec![format!("/spec/test/load/force_n/{axis} load_on_nothing")];
        for (force, on, expected) in [
            ([0.0, -10.0], json!({"face": "top"}), vec![]),
            ([0.0, -10.0], json!("body"), vec![]),
            ([0.0, -10.0], json!({"face": "left"}), borne(1)),
            ([3.0, 0.0], json!({"face": "right"}), borne(0)),
            (
                [0.0, -10.0],
                json!({"patch": {"face": "left", "from_mm": 0.0, "to_mm": 0.5 * height}}),
                borne(1),
            ),
            (
                [0.0, 1.0],
                json!({"point_mm": [length, 0.5 * height]}),
                borne(1),
            ),
            (
                [0.0, 1.0],
                json!({"point_mm": [0.5 * length, height]}),
                vec![],
            ),
        ] {
            let load = json!({"force_n": force, "on": on});
            assert_eq!(refused(load.clone(), sides.clone()), expected, "{load}");
        }
        // nothing can move in one cell between two held faces, and in one across them all can
        let body = |cells: [u32; 2]| {
            let mut job: Value = serde_json::from_str(body_text).expect("JSON");
            job["spec"]["grid"] = json!({"cells": cells});
            pointers(&job)
        };
        assert_eq!(body([1, 7]), ["/spec/grid/cells/0 load_on_nothing"]);
        assert!(body([2, 1]).is_empty());
        // a face that slides bears what presses on it, and moves with what pulls along it
        let slides = json!({"left": "clamped", "right": "rolling"});
        for (force, expected) in [([0.0, -1.0], vec![]), ([2.0, -1.0], borne(0))] {
            let load = json!({"force_n": force, "on": {"face": "right"}});
            assert_eq!(refused(load, slides.clone()), expected);
        }
    }
}
