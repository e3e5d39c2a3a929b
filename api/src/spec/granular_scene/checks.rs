//! What the JSON Schema cannot say: names that must exist, bodies that must not sit in each other,
//! a step that must be stable.
use super::{
    Body, ContactLaw, GranularScene, LoadPlane, Material, MovePlane, Plane, Stage, TimeStep,
    check_walls,
    part_checks::{check_clump, check_cohesive, check_material},
};
use crate::violations::LISTED_OF_A_SORT;
use crate::{Violation, Violations, worker::MOST_CURVE_COLUMNS};

/// More spheres than this are refused: about 4 GB.
const MOST_PARTICLES: u64 = 10_000_000;

pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    if let Some(violation) = super::part_checks::check_filled_together(spec) {
        // what follows fills every shape
        violations.push(violation);
        return;
    }
    check_bodies(spec, violations);
    check_materials_of_walls(spec, violations);
    check_walls::check(spec, violations);
    check_stages(spec, violations);
    super::supply_checks::check(spec, violations);
    super::replacements::check(spec, violations);
    check_recorded(spec, violations);
    let bodies = spec.given_bodies();
    let is_all_given = spec.generators().next().is_none() && !bodies.iter().any(Body::is_filled);
    if is_all_given {
        check_recorded_bodies(spec, bodies.iter().map(Body::numbers).sum(), violations);
    }
    check_laws(spec, violations);
    super::region::check(spec, violations);
    if violations.is_empty() {
        super::curve::check(spec, violations);
    }
    // what follows looks up materials and shapes
    if violations.is_empty() {
        super::overlaps::check(spec, &bodies, largest_overlap(spec), violations);
        check_time_step(spec, violations);
    }
}

/// δ/r that bodies may start with.
fn largest_overlap(spec: &GranularScene) -> f64 {
    if spec.is_relaxed_first() {
        f64::INFINITY
    } else {
        spec.largest_overlap_at_start
    }
}

impl GranularScene {
    /// What is wrong with the places, speeds and numbers of all bodies that the scene starts with,
    /// where `spec` itself could not tell.
    pub fn check_start(&self, bodies: &[Body], numbers: usize) -> Vec<Violation> {
        let mut violations = Violations::default();
        super::overlaps::check(self, bodies, largest_overlap(self), &mut violations);
        check_recorded_bodies(self, numbers, &mut violations);
        violations.into_vec()
    }
}

fn check_bodies(spec: &GranularScene, violations: &mut Violations) {
    let mut wrong = Vec::new();
    for (index, body) in spec.bodies.iter().enumerate() {
        if wrong.len() >= LISTED_OF_A_SORT {
            break;
        }
        let pointer = format!("/bodies/{index}");
        let shapes = [
            body.sphere.is_some(),
            body.clump.is_some(),
            body.breakable.is_some(),
        ];
        if shapes.iter().filter(|shape| **shape).count() != 1 {
            let detail = "a body is a sphere, a clump or a breakable one";
            wrong.push(
                Violation::new(&pointer, "not_one_shape", detail)
                    .allowed("exactly one of: sphere, clump, breakable"),
            );
        }
        if let Some(clump) = &body.clump {
            wrong.extend(check_clump(&format!("{pointer}/clump"), clump));
        }
        if let Some(grain) = &body.breakable {
            wrong.extend(check_clump(&format!("{pointer}/breakable"), grain));
            wrong.extend(check_cohesive(spec, &pointer, &body.material));
        }
        wrong.extend(check_material(spec, &pointer, &body.material));
    }
    wrong.truncate(LISTED_OF_A_SORT);
    violations.extend(wrong);
    let particles = spec.particles();
    if particles > MOST_PARTICLES {
        violations.push(
            Violation::new("/bodies", "too_large", "too many spheres")
                .value(particles)
                .allowed(format!("at most {MOST_PARTICLES} spheres")),
        );
    }
}

fn check_materials_of_walls(spec: &GranularScene, violations: &mut Violations) {
    for (index, plane) in spec.planes.iter().enumerate() {
        violations.extend(check_material(
            spec,
            &format!("/planes/{index}"),
            &plane.material,
        ));
    }
    for (index, mesh) in spec.facets.iter().enumerate() {
        violations.extend(check_material(
            spec,
            &format!("/facets/{index}"),
            &mesh.material,
        ));
    }
}

fn check_plane_name(spec: &GranularScene, pointer: String, name: &str) -> Option<Violation> {
    let names = || spec.planes.iter().map(|plane: &Plane| plane.name.as_str());
    (!names().any(|known| known == name)).then(|| {
        let allowed = match spec.planes.len() {
            0 => "the scene has no planes".to_owned(),
            _ => format!("one of: {}", names().collect::<Vec<_>>().join(", ")),
        };
        Violation::new(pointer, "no_such_plane", "no plane has this name")
            .value(name)
            .allowed(allowed)
    })
}

fn check_stages(spec: &GranularScene, violations: &mut Violations) {
    let known = check_walls::Known::of(spec);
    for (index, stage) in spec.stages.iter().enumerate() {
        if violations.is_full() {
            return;
        }
        let pointer = format!("/stages/{index}/{}", stage.name());
        let duration = stage.duration();
        let takes_time = !stage.is_instant();
        if takes_time && duration.steps.is_some() == duration.time_s.is_some() {
            violations.push(
                Violation::new(&pointer, "not_one_duration", "a stage needs one duration")
                    .allowed("exactly one of: steps, time_s"),
            );
        }
        if let Stage::MovePlane(MovePlane { name, .. }) | Stage::LoadPlane(LoadPlane { name, .. }) =
            stage
        {
            violations.extend(check_plane_name(spec, format!("{pointer}/name"), name));
        }
        match stage {
            Stage::LoadPlane(load) => {
                let swings = [load.peak_force_n.is_some(), load.period_s.is_some()];
                violations.extend(check_walls::check_swing(&pointer, swings));
            }
            Stage::Drive(drive) => check_walls::check_drive(&known, drive, &pointer, violations),
            Stage::Place(place) => check_walls::check_place(&known, place, &pointer, violations),
            _ => {}
        }
    }
}

fn check_recorded(spec: &GranularScene, violations: &mut Violations) {
    for (index, name) in spec.record.planes.iter().enumerate() {
        let pointer = format!("/record/planes/{index}");
        violations.extend(check_plane_name(spec, pointer, name));
    }
    let known = check_walls::Known::of(spec);
    for (index, name) in spec.record.walls.iter().enumerate() {
        let pointer = format!("/record/walls/{index}");
        violations.extend(known.check_wall(pointer, name));
    }
    for (index, body) in spec.record.turns.iter().enumerate() {
        let pointer = format!("/record/turns/{index}");
        violations.extend(known.check_clump(pointer, *body));
    }
    for (index, name) in spec.record.normal_forces.iter().enumerate() {
        let pointer = format!("/record/normal_forces/{index}");
        violations.extend(known.check_wall(pointer, name));
    }
    let columns = spec.curve_columns().len();
    if columns > MOST_CURVE_COLUMNS {
        let detail = "planes, walls, driven bodies and regions give the curve too many columns";
        violations.push(
            Violation::new("/record", "too_many_columns", detail)
                .value(columns)
                .allowed(format!(
                    "at most {MOST_CURVE_COLUMNS} columns: 2 for a plane, 6 for a wall or body, 1 for normal forces, 10 for a region"
                )),
        );
    }
    super::voids::check(spec, violations);
    let (first, stages) = (spec.record.from_stage, spec.stages.len());
    if first >= stages {
        let detail = "there is no such stage";
        violations.push(
            Violation::new("/record/from_stage", "no_such_stage", detail)
                .value(first)
                .allowed(format!("0 … {}", stages - 1)),
        );
    }
}

fn check_recorded_bodies(spec: &GranularScene, count: usize, violations: &mut Violations) {
    let bodies = spec.record.bodies.iter().flatten().enumerate();
    let missing = bodies.filter(|(_, body)| **body as usize >= count);
    violations.extend(missing.take(LISTED_OF_A_SORT).map(|(index, body)| {
        let allowed = match count {
            0 => "the scene has no bodies".to_owned(),
            _ => format!("0 … {}", count - 1),
        };
        Violation::new(
            format!("/record/bodies/{index}"),
            "no_such_body",
            "there is no body of this number",
        )
        .value(*body)
        .allowed(allowed)
    }));
}

/// Bonds know linear springs alone, and what changes with the modulus is known of those that are
/// proportional to it.
fn check_laws(spec: &GranularScene, violations: &mut Violations) {
    if spec.laws.contact == ContactLaw::HertzMindlin {
        let planes = spec.planes.iter().enumerate();
        let sprung =
            planes.filter_map(|(index, plane)| Some((index, plane.contact_stiffness_n_per_m?)));
        violations.extend(sprung.map(|(index, stiffness)| {
            let pointer = format!("/planes/{index}/contact_stiffness_n_per_m");
            let detail = "a contact of Hertz has no stiffness of its own";
            Violation::new(pointer, "not_together", detail)
                .value(stiffness)
                .allowed("\"linear\" or \"logarithmic\" contacts")
                .unit("N/m")
        }));
        let stages = spec.stages.iter().enumerate();
        let stiffen = stages.filter(|(_, stage)| matches!(stage, Stage::Stiffen(_)));
        violations.extend(stiffen.map(|(index, _)| {
            let pointer = format!("/stages/{index}/stiffen");
            Violation::new(
                pointer,
                "not_together",
                "the modulus of Hertz's contacts stays",
            )
            .allowed("\"linear\" or \"logarithmic\" contacts")
        }));
    }
    violations.extend(check_raised_cohesion(spec));
    if !spec.materials.values().any(Material::is_cohesive) {
        return;
    }
    let cohesive = spec.materials.iter();
    let cohesive = cohesive.filter(|(_, material)| material.has_cohesion());
    violations.extend(
        cohesive
            .filter(|_| spec.has_parallel_bonds())
            .map(|(name, _)| {
                let pointer = format!("/materials/{name}");
                let detail = "cohesion, and somewhere in the scene bonds that bend and twist";
                Violation::new(pointer, "not_together", detail)
                    .allowed("parallel_bond or cohesions above 0, one of the two in a scene")
            }),
    );
    if spec.laws.contact != ContactLaw::Linear {
        violations.push(
            Violation::new(
                "/laws/contact",
                "not_together",
                "bonds of cohesive materials stand on linear springs",
            )
            .allowed("\"linear\" with cohesion, any other without"),
        );
    }
    let viscous = spec.materials.iter().flat_map(|(name, material)| {
        [
            ("restitution", material.restitution),
            ("shear_restitution", material.shear_restitution),
        ]
        .map(|(field, value)| (format!("/materials/{name}/{field}"), value))
    });
    let viscous = viscous.filter(|(_, value)| value.is_some());
    violations.extend(viscous.map(|(pointer, value)| {
        Violation::new(pointer, "not_together", "bonds have no dashpots")
            .value(value)
            .allowed("none in a scene with cohesion; damp it by /laws/local_damping")
    }));
    let materials = spec.materials.iter();
    let rolling = materials.filter(|(_, material)| material.rolling_resistance.is_some());
    violations.extend(rolling.map(|(name, _)| {
        let pointer = format!("/materials/{name}/rolling_resistance");
        let detail = "contacts that may be bonded do not resist rolling";
        Violation::new(pointer, "not_together", detail).allowed("none in a scene with cohesion")
    }));
}

/// What is raised is there, and is set back.
fn check_raised_cohesion(spec: &GranularScene) -> Option<Violation> {
    let raised = spec.laws.raised_cohesion?;
    let pointer = "/laws/raised_cohesion";
    if !spec.materials.values().any(Material::has_cohesion) {
        let detail = "no material has cohesion";
        let violation = Violation::new(format!("{pointer}/factor"), "not_together", detail);
        return Some(
            violation.value(raised.factor).allowed(
                "none, or a material with normal_cohesion_pa or shear_cohesion_pa above 0",
            ),
        );
    }
    let last = spec.stages.len().saturating_sub(1);
    if raised.from_stage >= raised.until_stage {
        let detail = "cohesions would be set back before they are raised";
        let violation = Violation::new(format!("{pointer}/from_stage"), "out_of_order", detail);
        let allowed = format!("below until_stage, {}", raised.until_stage);
        return Some(violation.value(raised.from_stage).allowed(allowed));
    }
    (raised.until_stage > last).then(|| {
        let detail = "cohesions would never be set back";
        Violation::new(format!("{pointer}/until_stage"), "no_such_stage", detail)
            .value(raised.until_stage)
            .allowed(format!("1 … {last}"))
    })
}

fn check_time_step(spec: &GranularScene, violations: &mut Violations) {
    let TimeStep::Given(step) = spec.time_step_s else {
        return;
    };
    let samples = spec.samples();
    if let Some(critical) = spec.critical_step_of_one_contact(
        &samples,
        GranularScene::first_speed(&samples),
        &spec.plates(),
    ) && step > critical.step
        && !spec.allow_unstable
    {
        let partner = match critical.partner {
            Some(partner) => format!("body {partner}"),
            None => "a wall".to_owned(),
        };
        let detail = format!(
            "a contact of body {} with {partner} would gain energy in every step",
            critical.body
        );
        violations.push(
            Violation::new("/time_step_s", "unstable", detail)
                .value(step)
                .allowed(format!(
                    "≤ {:e}, better {:e} or \"auto\" (or set /allow_unstable)",
                    critical.step,
                    0.2 * critical.step
                ))
                .unit("s"),
        );
    }
    super::speeds::check(spec, step, violations);
}
