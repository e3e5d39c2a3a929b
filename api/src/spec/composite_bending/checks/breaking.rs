//! What can break, and in which tests.
use super::materials::refused_interface;
use crate::spec::composite_bending::{
    CompositeBending, Delamination, Geometry, Lattice, Solver, Way,
};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations};

pub(super) fn check_breaking(spec: &CompositeBending, violations: &mut Violations) {
    check_delaminations(spec, violations);
    if spec.test.breaking.is_none() {
        return;
    }
    let breaks = |material: &super::super::Material| {
        let strength = material.strength.unwrap_or_default();
        strength != Default::default() || material.interface.is_some()
    };
    if !spec.materials.values().any(breaks) && spec.ply_interface.is_none() {
        violations.push(
            Violation::new(
                "/test/breaking",
                "nothing_breaks",
                "no material has a strength",
            )
            .allowed("a strength or an interface of at least one material, or a ply_interface"),
        );
    }
    check_interfaces(spec, violations);
    let knobs = spec.accuracy.knobs();
    let refusals = [
        (
            "/lattice",
            !matches!(spec.lattice, Lattice::Exact(_)),
            "the paper's lattice has one stiffness for all directions, which no strength fits",
            "{\"exact\": {}} with breaking",
        ),
        (
            "/accuracy/solver",
            knobs.solver != Solver::Static,
            "breaks are found by the equations of equilibrium",
            "\"static\" with breaking",
        ),
        (
            "/accuracy/geometry",
            knobs.geometry == Geometry::Large,
            "breaks are found for small displacements",
            "\"linear\" with breaking",
        ),
        (
            "/test/history",
            spec.test.history.is_some(),
            "breaks are found at rest, not in time",
            "breaking without history",
        ),
    ];
    for (pointer, is_refused, detail, allowed) in refusals {
        if is_refused {
            violations.push(Violation::new(pointer, "not_allowed", detail).allowed(allowed));
        }
    }
    if let Some(Way::Held(supports)) = spec.test.way()
        && spec.test.load.is_some()
        && supports.faces().iter().any(|(_, support)| support.drives())
    {
        violations.push(
            Violation::new(
                "/test/load",
                "two_drives",
                "a load and moved faces would have to grow together, in a proportion that nothing says",
            )
            .allowed("a load or faces with displacement_mm"),
        );
    }
}

/// Faces between plies, and stretches of them that are open.
fn check_delaminations(spec: &CompositeBending, violations: &mut Violations) {
    let plies = spec.plies.len();
    if spec.ply_interface.is_some() && plies < 2 {
        violations.push(
            Violation::new(
                "/ply_interface",
                "not_allowed",
                "there are no two plies with a face between them",
            )
            .value(plies)
            .allowed("with at least two plies"),
        );
        return;
    }
    if spec.delaminations.is_empty() {
        return;
    }
    if spec.test.breaking.is_none() || spec.ply_interface.is_none() {
        violations.push(
            Violation::new(
                "/delaminations",
                "not_allowed",
                "faces that are open from the start belong to plies that can come apart",
            )
            .allowed("with breaking in the test and a ply_interface"),
        );
    }
    check_overlap(spec, violations);
    let length = spec.section.length_mm;
    for (index, open) in spec.delaminations.iter().enumerate().take(LISTED_OF_A_SORT) {
        let pointer = |field: &str| format!("/delaminations/{index}/{field}");
        if open.above_ply as usize >= plies {
            violations.push(
                Violation::new(
                    pointer("above_ply"),
                    "out_of_range",
                    "there is no ply above it",
                )
                .value(open.above_ply)
                .allowed(format!("from 1 to {}", plies.saturating_sub(1)))
                .unit("1"),
            );
        }
        if open.to_mm <= open.from_mm || open.to_mm > length {
            violations.push(
                Violation::new(
                    pointer("to_mm"),
                    "out_of_range",
                    "it ends before it begins, or beyond the section",
                )
                .value(open.to_mm)
                .allowed(format!(
                    "> from_mm = {}, ≤ length_mm = {length}",
                    open.from_mm
                ))
                .unit("mm"),
            );
        }
    }
}

/// The first stretch of a face that is open twice.
fn check_overlap(spec: &CompositeBending, violations: &mut Violations) {
    let mut order: Vec<usize> = (0..spec.delaminations.len()).collect();
    let of = |index: usize| &spec.delaminations[index];
    order.sort_by(|&a, &b| {
        let by_face = of(a).above_ply.cmp(&of(b).above_ply);
        by_face.then(of(a).from_mm.total_cmp(&of(b).from_mm))
    });
    let overlapping = order.windows(2).find(|pair| {
        let [first, second] = [of(pair[0]), of(pair[1])];
        first.above_ply == second.above_ply && second.from_mm < first.to_mm
    });
    if let Some(&[first, second]) = overlapping {
        violations.push(
            Violation::new(
                format!("/delaminations/{second}/from_mm"),
                "overlap",
                format!("it overlaps delamination {first} (counted from 0) of the same face"),
            )
            .value(of(second).from_mm)
            .allowed(format!("≥ to_mm = {} of that one", of(first).to_mm))
            .unit("mm"),
        );
    }
}

/// A double cantilever, whose arms end where they are apart from the start.
pub(super) fn check_split(spec: &CompositeBending, violations: &mut Violations) {
    if spec.test.breaking.is_none() {
        violations.push(
            Violation::new(
                "/test/double_cantilever",
                "not_allowed",
                "it tells at which energy plies come apart, and nothing breaks",
            )
            .allowed("with breaking in the test and a ply_interface"),
        );
    }
    let begin = |open: &&Delamination| open.from_mm <= 0.0;
    let arms = spec.delaminations.iter().filter(begin).count();
    if arms != 1 {
        violations.push(
            Violation::new(
                "/delaminations",
                "not_split",
                "the arms that are pulled apart are those of a delamination that begins at the left end",
            )
            .value(arms)
            .allowed("exactly one with from_mm 0"),
        );
    }
}

/// Interfaces are those of fibres.
fn check_interfaces(spec: &CompositeBending, violations: &mut Violations) {
    for (name, material) in &spec.materials {
        let is_fibre = spec.fibres.iter().any(|fibre| fibre.material == *name);
        if !is_fibre {
            violations.extend(refused_interface(name, material));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{JobKind, Submission};
    use serde_json::{Value, json};

    /// What is wrong with the double cantilever of the examples after a change of its spec.
    fn violations(change: impl FnOnce(&mut Value)) -> Vec<(String, String)> {
        let examples = JobKind::CompositeBending.examples();
        let peel = examples
            .iter()
            .find(|one| one.name == "composite_bending_peel");
        let body = peel.expect("an example").body;
        let mut body: Value = serde_json::from_str(body).expect("JSON");
        change(&mut body["spec"]);
        match Submission::from_slice(body.to_string().as_bytes()) {
            Ok(_) => Vec::new(),
            Err(error) => {
                let found = error.violations().into_iter();
                found.map(|one| (one.pointer, one.code)).collect()
            }
        }
    }

    fn one(pointer: &str, code: &str) -> Vec<(String, String)> {
        vec![(pointer.to_owned(), code.to_owned())]
    }

    #[test]
    fn delaminations_of_one_face_must_not_overlap() {
        let open = |from: f64, to: f64| json!({"above_ply": 1, "from_mm": from, "to_mm": to});
        assert_eq!(violations(|_| {}), []);
        // in any order, and whatever lies beside them; what touches does not overlap
        let given = [open(50.0, 60.0), open(0.0, 30.0), open(30.0, 40.0)];
        assert_eq!(violations(|spec| spec["delaminations"] = json!(given)), []);
        let given = [open(50.0, 60.0), open(0.0, 30.0), open(29.0, 51.0)];
        let found = violations(|spec| spec["delaminations"] = json!(given));
        assert_eq!(found, one("/spec/delaminations/2/from_mm", "overlap"));
    }

    #[test]
    fn a_double_cantilever_needs_arms_and_something_that_breaks() {
        let found = violations(|spec| spec["delaminations"][0]["from_mm"] = json!(5));
        assert_eq!(found, one("/spec/delaminations", "not_split"));
        let found = violations(|spec| {
            spec["test"]["breaking"] = Value::Null;
            spec["test"]
                .as_object_mut()
                .expect("a test")
                .remove("breaking");
        });
        let pointers: Vec<&str> = found.iter().map(|(pointer, _)| pointer.as_str()).collect();
        assert_eq!(
            pointers,
            ["/spec/test/double_cantilever", "/spec/delaminations"]
        );
    }
}
