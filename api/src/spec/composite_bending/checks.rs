//! What the JSON Schema cannot say: names that must exist, materials that must be stable, fibres that
//! must not share a place, a section that must be held.
use super::{
    CompositeBending, Face, Flexure, Geometry, LoadPlace, Material, Solver, Support, SupportWord,
    Supports, Test, Way,
};
use crate::Violation;
use crate::section::error::CompositeError;
use crate::section::fibre::{Band, Fibre, refuse_overlap};

/// At most this many violations of one sort are listed.
const LISTED: usize = 20;
/// More particles than this are refused.
const MOST_PARTICLES: u64 = 50_000_000;
/// Thicknesses of plies sum up to the height within this part of it.
const PLIES_FILL: f64 = 1e-9;

pub(super) fn check(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    check_materials(spec, violations);
    check_filling(spec, violations);
    check_fibres(spec, violations);
    check_grid(spec, violations);
    check_test(spec, violations);
    check_probes(spec, violations);
}

fn check_materials(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    let needs_density = spec.test.history.is_some();
    for (name, material) in &spec.materials {
        let pointer = format!("/materials/{}", escaped(name));
        let Some(elastic) = material.elastic() else {
            let detail = "a material is isotropic or orthotropic";
            violations.push(
                Violation::new(&pointer, "not_one_material", detail)
                    .allowed("exactly one of: isotropic, orthotropic"),
            );
            continue;
        };
        // a ply shows its material from the side at which it is turned
        let state = spec.section.state.into();
        let angles = spec.plies.iter().filter(|ply| ply.material == *name);
        let angles = angles.map(|ply| ply.angle_deg).chain([0.0]);
        let refused = angles
            .map(|angle| elastic.stiffness_out_of_plane(state, angle))
            .find_map(Result::err);
        if let Some(error) = refused {
            violations.push(unstable(&pointer, material, &error));
        }
        if needs_density && material.density_kg_per_m3.is_none() {
            let detail = "motion in time needs the density of every material";
            violations.push(
                Violation::new(format!("{pointer}/density_kg_per_m3"), "missing", detail)
                    .allowed("a density above 0")
                    .unit("kg/m3"),
            );
        }
    }
}

/// Elastic constants that no stable material has.
fn unstable(pointer: &str, material: &Material, error: &CompositeError) -> Violation {
    let form = if material.isotropic.is_some() {
        "isotropic"
    } else {
        "orthotropic"
    };
    let violation = Violation::new(
        format!("{pointer}/{form}"),
        "unstable_material",
        error.to_string(),
    );
    match error {
        CompositeError::UnstableMaterial { given, bound, .. } => violation
            .value(*given)
            .allowed(format!("above -{bound:.6} and below {bound:.6}")),
        CompositeError::OutOfRange { given, allowed, .. } => {
            violation.value(*given).allowed(*allowed)
        }
        _ => violation,
    }
}

/// A name that is not one of the materials'.
fn unknown_material(spec: &CompositeBending, pointer: String, name: &str) -> Option<Violation> {
    (!spec.materials.contains_key(name)).then(|| {
        let known: Vec<&str> = spec.materials.keys().map(String::as_str).collect();
        let allowed = if known.is_empty() {
            "the spec has no materials".to_owned()
        } else {
            format!("one of: {}", known.join(", "))
        };
        Violation::new(pointer, "unknown_material", "there is no such material")
            .value(name)
            .allowed(allowed)
    })
}

/// A matrix or plies, whose thicknesses fill the height.
fn check_filling(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    match (&spec.matrix, spec.plies.is_empty()) {
        (Some(name), true) => {
            violations.extend(unknown_material(spec, "/matrix".to_owned(), name));
        }
        (None, true) => violations.push(
            Violation::new("/matrix", "missing", "nothing fills the section")
                .allowed("the name of a material, or plies"),
        ),
        (Some(name), false) => violations.push(
            Violation::new(
                "/matrix",
                "not_allowed",
                "the plies fill the section already",
            )
            .value(name.as_str())
            .allowed("a matrix or plies, not both"),
        ),
        (None, false) => {}
    }
    let unknown = spec.plies.iter().enumerate().filter_map(|(index, ply)| {
        unknown_material(spec, format!("/plies/{index}/material"), &ply.material)
    });
    violations.extend(unknown.take(LISTED));
    let filled: f64 = spec.plies.iter().map(|ply| ply.thickness_mm).sum();
    let height = spec.section.height_mm;
    if !spec.plies.is_empty() && (filled - height).abs() > PLIES_FILL * height {
        violations.push(
            Violation::new(
                "/plies",
                "plies_do_not_fill",
                "the thicknesses of the plies do not sum up to the section's height",
            )
            .value(filled)
            .allowed(format!("height_mm = {height}"))
            .unit("mm"),
        );
    }
}

fn check_fibres(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    let before = violations.len();
    let sides = [spec.section.length_mm, spec.section.height_mm];
    let mut bands = Vec::with_capacity(spec.fibres.len());
    for (index, fibre) in spec.fibres.iter().enumerate() {
        if violations.len() - before >= LISTED {
            break;
        }
        let pointer = format!("/fibres/{index}");
        violations.extend(unknown_material(
            spec,
            format!("{pointer}/material"),
            &fibre.material,
        ));
        let band = Fibre {
            material: 0,
            through_mm: fibre.through_mm,
            angle_deg: fibre.angle_deg,
            thickness_mm: fibre.thickness_mm,
            length_mm: fibre.length_mm,
        };
        match Band::new(index, &band, sides) {
            Ok(band) => bands.push(band),
            Err(_) => violations.push(
                Violation::new(
                    format!("{pointer}/through_mm"),
                    "outside_section",
                    "the fibre does not touch the section",
                )
                .value(fibre.through_mm.to_vec())
                .allowed(format!(
                    "a point with x from 0 to {}, y from 0 to {}",
                    sides[0], sides[1]
                ))
                .unit("mm"),
            ),
        }
    }
    if violations.len() > before {
        return;
    }
    if let Err(CompositeError::Overlap {
        first,
        second,
        area_mm2,
        x_mm,
        y_mm,
    }) = refuse_overlap(&bands)
    {
        violations.push(
            Violation::new(
                format!("/fibres/{second}"),
                "overlap",
                format!(
                    "fibres {first} and {second} share {area_mm2:.6} mm² around ({x_mm:.6}, \
                     {y_mm:.6}) mm: move one, or cut it with a length"
                ),
            )
            .value(area_mm2)
            .allowed("fibres that do not overlap"),
        );
    }
}

fn check_grid(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    let particles = spec.particles();
    if particles > MOST_PARTICLES {
        violations.push(
            Violation::new(
                "/grid/cells",
                "too_large",
                "the grid has too many particles",
            )
            .value(particles)
            .allowed(format!("at most {MOST_PARTICLES} particles")),
        );
    }
    let grid = spec.grid();
    if grid.equal_cells && grid.graded_cells_per_fibre.is_some() {
        violations.push(
            Violation::new(
                "/grid/equal_cells",
                "not_allowed",
                "cells of a graded grid are not equal",
            )
            .value(true)
            .allowed("equal_cells or graded_cells_per_fibre, not both"),
        );
    }
    let super::Lattice::Paper(_) = spec.lattice else {
        return;
    };
    let [width, height] = [
        spec.section.length_mm / f64::from(grid.cells[0]),
        spec.section.height_mm / f64::from(grid.cells[1]),
    ];
    let refused = |pointer: &str, code: &str, detail: String, allowed: &str| {
        Violation::new(pointer, code, detail).allowed(allowed)
    };
    if (width / height - 1.0).abs() > 1e-9 {
        violations.push(refused(
            "/grid/cells",
            "not_square",
            format!(
                "the paper's lattice needs square cells, and these are {width} mm by {height} mm"
            ),
            "numbers of cells in proportion to the section's sides",
        ));
    }
    if grid.graded_cells_per_fibre.is_some() {
        violations.push(refused(
            "/grid/graded_cells_per_fibre",
            "not_allowed",
            "the paper's lattice needs equal cells".to_owned(),
            "a grid given by its cells alone",
        ));
    }
    if !spec.plies.is_empty() {
        violations.push(refused(
            "/plies",
            "not_allowed",
            "the paper's lattice has a matrix and fibres, no plies".to_owned(),
            "a matrix, or the exact lattice",
        ));
    }
}

fn check_test(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    let test = &spec.test;
    let ways = test.ways();
    let [(name, way)] = ways.as_slice() else {
        let given: Vec<&str> = ways.iter().map(|(name, _)| *name).collect();
        violations.push(
            Violation::new("/test", "not_one_test", "a job does exactly one test")
                .value(given)
                .allowed(
                    "exactly one of: supports (with load), three_point, four_point, short_beam, \
                     tension, shear",
                ),
        );
        return;
    };
    match way {
        Way::Held(supports) => check_held(spec, supports, violations),
        Way::ThreePoint(flexure) => check_flexure(spec, name, flexure, 1, violations),
        Way::ShortBeam(flexure) => check_flexure(spec, name, flexure, 1, violations),
        Way::FourPoint(flexure) => check_flexure(spec, name, flexure, 2, violations),
        Way::Tension(tension) => check_strain(name, tension.strain, violations),
        Way::Shear(shear) => check_strain(name, shear.strain, violations),
    }
    if !matches!(way, Way::Held(_)) {
        for (field, given) in [
            ("load", test.load.is_some()),
            ("history", test.history.is_some()),
        ] {
            if given {
                violations.push(
                    Violation::new(
                        format!("/test/{field}"),
                        "not_allowed",
                        format!("{name} brings its own load"),
                    )
                    .allowed("with supports only"),
                );
            }
        }
    }
}

fn check_strain(name: &str, strain: f64, violations: &mut Vec<Violation>) {
    if strain == 0.0 {
        violations.push(
            Violation::new(
                format!("/test/{name}/strain"),
                "out_of_range",
                "nothing is strained",
            )
            .value(strain)
            .allowed("other than 0")
            .unit("1"),
        );
    }
}

fn check_held(spec: &CompositeBending, supports: &Supports, violations: &mut Vec<Violation>) {
    let test = &spec.test;
    let drives = supports.faces().iter().any(|(_, support)| support.drives());
    if test.load.is_none() && !drives && !moves_first(test) {
        violations.push(
            Violation::new("/test/load", "missing", "nothing loads the section")
                .allowed("a load, a face with displacement_mm, or a velocity in history"),
        );
    }
    check_load(spec, violations);
    check_history(spec, violations);
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
        Support::PerAxis(axes) => axes.map(|axis| axis == super::Axis::Clamped),
        Support::Driven(driven) => driven.displacement_mm.map(|value| value.is_some()),
    }
}

fn check_load(spec: &CompositeBending, violations: &mut Vec<Violation>) {
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

fn check_history(spec: &CompositeBending, violations: &mut Vec<Violation>) {
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
    if history.load == super::HistoryLoad::Released && spec.test.load.is_none() {
        violations.push(
            Violation::new("/test/load", "missing", "there is no load to release")
                .allowed("a load"),
        );
    }
}

fn check_flexure(
    spec: &CompositeBending,
    name: &str,
    flexure: &Flexure,
    loading: u32,
    violations: &mut Vec<Violation>,
) {
    let pointer = |field: &str| format!("/test/{name}/{field}");
    if flexure.displacement_mm.is_some() == flexure.force_n.is_some() {
        violations.push(
            Violation::new(
                format!("/test/{name}"),
                "not_one_drive",
                "the rollers are driven by a way or by a force",
            )
            .allowed("exactly one of: displacement_mm, force_n"),
        );
    }
    let length = spec.section.length_mm;
    if flexure.span_mm >= length {
        violations.push(
            Violation::new(
                pointer("span_mm"),
                "out_of_range",
                "the supports are beyond the ends",
            )
            .value(flexure.span_mm)
            .allowed(format!("< length_mm = {length}"))
            .unit("mm"),
        );
    }
    // neighbouring rollers of one side must not meet, nor those of the other in the specimen's middle
    let room = flexure.span_mm / 2.0;
    if flexure.support_radius_mm > room {
        violations.push(
            Violation::new(
                pointer("support_radius_mm"),
                "out_of_range",
                "the supports meet",
            )
            .value(flexure.support_radius_mm)
            .allowed(format!("≤ span_mm / 2 = {room}"))
            .unit("mm"),
        );
    }
    let room = if loading == 2 {
        flexure.span_mm / 6.0
    } else {
        room
    };
    if flexure.loading_radius_mm > room {
        violations.push(
            Violation::new(
                pointer("loading_radius_mm"),
                "out_of_range",
                "the loading rollers are wider than the span has room for",
            )
            .value(flexure.loading_radius_mm)
            .allowed(format!("≤ {room}"))
            .unit("mm"),
        );
    }
    let knobs = spec.accuracy.knobs();
    if knobs.geometry == Geometry::Large {
        violations.push(
            Violation::new(
                "/accuracy/geometry",
                "not_allowed",
                "contact with rollers is worked out for small displacements",
            )
            .value("large")
            .allowed("\"linear\" with rollers"),
        );
    }
    if knobs.solver != Solver::Static {
        violations.push(
            Violation::new(
                "/accuracy/solver",
                "not_allowed",
                "rollers need the solver static",
            )
            .allowed("\"static\" with rollers"),
        );
    }
}

fn check_probes(spec: &CompositeBending, violations: &mut Vec<Violation>) {
    let probes = spec.probes_mm.iter().enumerate();
    let wrong =
        probes.filter_map(|(index, point)| outside(spec, format!("/probes_mm/{index}"), *point));
    violations.extend(wrong.take(LISTED));
}

fn outside(spec: &CompositeBending, pointer: String, [x, y]: [f64; 2]) -> Option<Violation> {
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

/// A name as a part of a JSON pointer.
fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}
