//! What the JSON Schema cannot say of a cell: names that must exist, fibres that find room.
use super::{Arrangement, CompositeCell, Measured, RoundFibre};
use crate::section::material::PlaneState;
use crate::spec::composite_bending::checks::{check_material, refused_interface, unknown_material};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations};

/// More cells of the grid than this are refused, in all and along a side.
const MOST_CELLS: u64 = 1 << 22;
const MOST_ALONG: u64 = 2048;

pub(super) fn check(spec: &CompositeCell, violations: &mut Violations) {
    for (name, material) in &spec.materials {
        // seen along its axes 3 and 2: together they ask for all that a stable material needs
        let angles = [0.0, 90.0].into_iter();
        check_material(name, material, PlaneState::Strain, angles, violations);
    }
    let others = spec
        .materials
        .iter()
        .filter(|(name, _)| **name != spec.fibre);
    violations.extend(others.filter_map(|(name, material)| refused_interface(name, material)));
    violations.extend(unknown_material(&spec.materials, "/matrix", &spec.matrix));
    violations.extend(unknown_material(&spec.materials, "/fibre", &spec.fibre));
    check_arrangement(spec, violations);
    if spec.repeats > 1 && !matches!(spec.arrangement, Arrangement::Random(_)) {
        violations.push(
            Violation::new(
                "/repeats",
                "not_allowed",
                "fibres in given places are the same in every repeat",
            )
            .value(spec.repeats)
            .allowed("1, or a random arrangement"),
        );
    }
    let [columns, rows] = spec.cells().map(u64::from);
    let is_long = columns.max(rows) > MOST_ALONG;
    if is_long || columns.saturating_mul(rows) > MOST_CELLS {
        violations.push(
            Violation::new(
                "/accuracy/cells_per_fibre",
                "too_large",
                format!("the cell needs a grid of {columns} by {rows}"),
            )
            .value(spec.chosen_knobs().cells_per_fibre)
            .allowed(format!(
                "at most {MOST_ALONG} cells along a side and {MOST_CELLS} in all: fewer fibres, or fewer cells \
                 through the thinnest"
            )),
        );
    }
}

fn check_arrangement(spec: &CompositeCell, violations: &mut Violations) {
    let regular = |pointer: &str, given: f64, most: f64| {
        (given >= most).then(|| {
            Violation::new(
                format!("/arrangement/{pointer}/fibre_fraction"),
                "out_of_range",
                "the fibres do not find room",
            )
            .value(given)
            .allowed(format!("below {most:.4}, where they touch"))
            .unit("1")
        })
    };
    match &spec.arrangement {
        Arrangement::Square(given) => violations.extend(regular(
            "square",
            given.fibre_fraction,
            std::f64::consts::FRAC_PI_4,
        )),
        Arrangement::Hexagonal(given) => violations.extend(regular(
            "hexagonal",
            given.fibre_fraction,
            std::f64::consts::PI / 12.0_f64.sqrt(),
        )),
        Arrangement::Random(random) => {
            // the gap belongs to the fibre when room is looked for
            let filled = random.fibre_fraction * (1.0 + random.least_gap).powi(2);
            if filled > MOST_FILLED {
                violations.push(
                    Violation::new(
                        "/arrangement/random/fibre_fraction",
                        "out_of_range",
                        format!(
                            "with gaps of {} of a diameter around them, the fibres fill {filled:.3} of the \
                             cell, which random places do not do",
                            random.least_gap
                        ),
                    )
                    .value(random.fibre_fraction)
                    .allowed(format!(
                        "at most {:.4} with these gaps",
                        MOST_FILLED / (1.0 + random.least_gap).powi(2)
                    ))
                    .unit("1"),
                );
            }
        }
        Arrangement::Measured(measured) => check_measured(measured, violations),
    }
}

/// Random discs with their gaps fill no more than this: above 0.84 they jam.
const MOST_FILLED: f64 = 0.8;

fn check_measured(measured: &Measured, violations: &mut Violations) {
    let [width, height] = measured.size_mm;
    let too_thick = measured
        .fibres
        .iter()
        .enumerate()
        .find(|(_, fibre)| fibre.diameter_mm >= width || fibre.diameter_mm >= height);
    if let Some((index, fibre)) = too_thick {
        violations.push(
            Violation::new(
                format!("/arrangement/measured/fibres/{index}/diameter_mm"),
                "out_of_range",
                "the fibre would meet itself across the cell's edges",
            )
            .value(fibre.diameter_mm)
            .allowed(format!("below {}", width.min(height)))
            .unit("mm"),
        );
        return;
    }
    let mut found = 0;
    for (second, fibre) in measured.fibres.iter().enumerate() {
        for (first, other) in measured.fibres[..second].iter().enumerate() {
            let distance = apart(fibre, other, measured.size_mm);
            let least = 0.5 * (fibre.diameter_mm + other.diameter_mm);
            // what was measured touches now and then by a rounded digit
            if distance < least * (1.0 - TOUCHING) {
                violations.push(
                    Violation::new(
                        format!("/arrangement/measured/fibres/{second}"),
                        "overlap",
                        format!(
                            "fibres {first} and {second} overlap: their middles are {distance:.6} mm apart, \
                             over the edges of the cell where that is nearer"
                        ),
                    )
                    .value(distance)
                    .allowed(format!("at least {least:.6}"))
                    .unit("mm"),
                );
                found += 1;
                if found == LISTED_OF_A_SORT {
                    return;
                }
            }
        }
    }
}

/// Part of the sum of two radii by which fibres may overlap.
const TOUCHING: f64 = 1e-9;

/// Distance of the middles of two fibres, the nearest of all copies.
fn apart(one: &RoundFibre, other: &RoundFibre, size_mm: [f64; 2]) -> f64 {
    let way = |axis: usize| {
        let plain = one.centre_mm[axis] - other.centre_mm[axis];
        plain - size_mm[axis] * (plain / size_mm[axis]).round()
    };
    way(0).hypot(way(1))
}

#[cfg(test)]
mod tests {
    use crate::{JobKind, Submission};
    use serde_json::{Value, json};

    #[test]
    fn the_interface_of_a_matrix_is_refused() {
        let body = JobKind::CompositeCell.examples()[0].body;
        let mut body: Value = serde_json::from_str(body).expect("JSON");
        let bears = json!({"strength_mpa": 60});
        let interface = json!({"normal": bears, "shear": bears});
        let [matrix, fibre] = ["matrix", "fibre"].map(|role| body["spec"][role].clone());
        let mut with = |name: &Value| {
            let name = name.as_str().expect("a name");
            body["spec"]["materials"][name]["interface"] = interface.clone();
            match Submission::from_slice(body.to_string().as_bytes()) {
                Ok(_) => Vec::new(),
                Err(error) => error.violations(),
            }
        };
        assert_eq!(with(&fibre), []);
        let refused = with(&matrix);
        assert_eq!(refused.len(), 1);
        let pointer = format!(
            "/spec/materials/{}/interface",
            matrix.as_str().expect("a name")
        );
        assert_eq!(refused[0].pointer, pointer);
    }
}
