//! What to look at in a run, and which fields of its spec and which of its stages would help. Stages count
//! from 1, fields are JSON pointers into the spec.
use loadframe_api::{
    QualityCheck,
    spec::granular_scene::{GranularScene, Stage, TimeStep},
};
use loadframe_harness::ReportBuilder;

use super::journal::Journal;
use crate::step::engine::Engine;

/// Escaped bodies, walls and stages named in a warning.
const LISTED: usize = 5;

/// Whose spec a scene is made of: warnings name the fields that a person wrote, and tests have no stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fields {
    Scene,
    Soil,
    Ballast,
}

impl Fields {
    /// The field of a material's modulus.
    fn modulus(self, material: &str) -> String {
        match self {
            Self::Scene | Self::Ballast => format!("/materials/{material}/youngs_modulus_pa"),
            Self::Soil => "/soil/youngs_modulus_pa".to_owned(),
        }
    }

    /// That of a plane's own stiffness; in a test it is the mat.
    fn stiffness(self, plane: usize) -> String {
        match self {
            Self::Scene | Self::Soil => format!("/planes/{plane}/contact_stiffness_n_per_m"),
            Self::Ballast => "/materials/mat/contact_stiffness_n_per_m".to_owned(),
        }
    }

    /// What says how long a stage lasts.
    fn duration(self, spec: &GranularScene, stage: usize) -> String {
        let found = spec.stages.get(stage);
        match (self, found) {
            (Self::Scene, _) => {
                let name = found.map_or("", Stage::name);
                let has_steps = found.is_some_and(|stage| stage.duration().steps.is_some());
                let field = if has_steps { "steps" } else { "time_s" };
                format!("/stages/{stage}/{name}/{field}")
            }
            (Self::Ballast, Some(Stage::Settle(_))) => "/preparation/longest_settling_s".to_owned(),
            _ => "time".to_owned(),
        }
    }
}

/// Adds the warnings to a report whose checks are made.
pub(super) fn warn(
    report: &mut ReportBuilder,
    spec: &GranularScene,
    engine: &Engine,
    journal: &Journal,
    escaped: &[u32],
    fields: Fields,
) {
    let checks = report.checks().filter(|(_, check)| !check.ok);
    let failed: Vec<(String, QualityCheck)> = checks
        .map(|(name, check)| (name.to_owned(), check.clone()))
        .collect();
    for (name, check) in failed {
        let advice = match name.as_str() {
            "largest_overlap_ratio" => harder(spec, journal, fields),
            "servo_force_error" => servo(spec, journal, fields),
            "inertial_number" | "driven_unbalanced_force_ratio" => slower(spec, fields),
            _ => smaller_step(spec, engine, journal),
        };
        let detail = format!(
            "{} is {:.3e}, beyond {}: {advice}",
            name.replace('_', " "),
            check.value,
            check.bound
        );
        report.warn(&name, detail);
    }
    if let Some(detail) = frictionless(spec) {
        report.warn("friction_left_out", detail);
    }
    if let Some(detail) = through_walls(spec, engine, fields) {
        report.warn("passed_through", detail);
    }
    for stage in &journal.unsettled_stages {
        let detail = format!(
            "stage {} ended before the bodies were as it waits for: give it more {}",
            stage + 1,
            fields.duration(spec, *stage)
        );
        report.warn("not_settled", detail);
    }
    for (stage, left) in &journal.not_inserted {
        let region = match fields {
            Fields::Scene => format!("/stages/{stage}/insert/bodies/region"),
            Fields::Soil | Fields::Ballast => "room".to_owned(),
        };
        let detail = format!(
            "stage {} ended before {left} of its grains found room: give it more {} or a larger {region}",
            stage + 1,
            fields.duration(spec, *stage)
        );
        report.warn("not_inserted", detail);
    }
    if !escaped.is_empty() {
        let listed: Vec<String> = escaped.iter().take(LISTED).map(u32::to_string).collect();
        let more = if escaped.len() > LISTED { ", ..." } else { "" };
        let detail = format!(
            "{} bodies left the scene: {}{more}",
            escaped.len(),
            listed.join(", ")
        );
        report.warn("escaped_bodies", detail);
    }
}

/// Materials whose friction is not given.
fn frictionless(spec: &GranularScene) -> Option<String> {
    let smooth = spec.materials.iter();
    let smooth = smooth.filter(|(_, material)| material.friction_angle_rad.is_none());
    let smooth: Vec<&str> = smooth.map(|(name, _)| name.as_str()).collect();
    (!smooth.is_empty()).then(|| {
        format!(
            "no friction_angle_rad is given for {}: contacts with it are frictionless; 0 says that this \
             is meant",
            smooth.join(", ")
        )
    })
}

/// For servos that had not come to their force.
fn servo(spec: &GranularScene, journal: &Journal, fields: Fields) -> String {
    if fields != Fields::Scene {
        // its walls are as fast as the test
        return SLOWER_TEST.to_owned();
    }
    let stage = journal.servo.map_or(0, |worst| worst.stage);
    format!(
        "give the stage more {} to come to the force, or a smaller largest_velocity_m_per_s to keep it",
        fields.duration(spec, stage)
    )
}

/// For tests, whose speeds follow from one number where they are not given.
const SLOWER_TEST: &str = "drive more slowly: a smaller /accuracy/inertial_number, or where /test gives \
                           speeds or periods itself, smaller or longer ones";

/// For contacts that were pressed too far.
fn harder(spec: &GranularScene, journal: &Journal, fields: Fields) -> String {
    // contacts with planes that have a stiffness of their own do not know the modulus of their material
    let softer = spec
        .planes
        .iter()
        .position(|plane| plane.contact_stiffness_n_per_m.is_some());
    let softer = softer.map(|plane| format!(", {}", fields.stiffness(plane)));
    let softer = softer.unwrap_or_default();
    let is_felt = |name: &String| {
        let mut sprung = spec.planes.iter().filter(|plane| plane.material == *name);
        !sprung.any(|plane| plane.contact_stiffness_n_per_m.is_some())
    };
    let materials = spec.materials.iter().filter(|(name, _)| is_felt(name));
    let softest = materials
        .min_by(|(_, a), (_, b)| a.youngs_modulus_pa.total_cmp(&b.youngs_modulus_pa))
        .map_or(String::new(), |(name, _)| fields.modulus(name));
    let stage = journal.worst_stages[0];
    let driven = spec.stages.get(stage);
    let load = match driven.filter(|_| fields == Fields::Scene) {
        Some(Stage::LoadPlane(load)) => {
            let field = match load.peak_force_n {
                Some(peak) if peak.abs() > load.force_n.abs() => "peak_force_n",
                _ => "force_n",
            };
            format!(", or a smaller /stages/{stage}/load_plane/{field}")
        }
        Some(Stage::MovePlane(_)) => {
            format!(", or a shorter or slower /stages/{stage}/move_plane")
        }
        Some(Stage::Drive(_)) => format!(", or a weaker /stages/{stage}/drive"),
        _ => String::new(),
    };
    format!(
        "it was so in stage {}; choose a higher {softest}{softer}{load}",
        stage + 1
    )
}

/// For stages that drive too fast.
fn slower(spec: &GranularScene, fields: Fields) -> String {
    if fields != Fields::Scene {
        return SLOWER_TEST.to_owned();
    }
    let stages = spec.stages.iter().enumerate();
    let driving = stages.filter(|(_, stage)| stage.is_quasi_static());
    let mut fields = driving.flat_map(|(number, stage)| {
        let at = format!("/stages/{number}/{}", stage.name());
        let fields: Vec<String> = match stage {
            Stage::MovePlane(_) => vec![format!("a smaller {at}/velocity_m_per_s")],
            Stage::LoadPlane(load) if load.period_s.is_some() => {
                vec![format!("a longer {at}/period_s")]
            }
            Stage::LoadPlane(_) => vec![format!("a smaller {at}/force_n")],
            Stage::Drive(drive) => {
                let walls = drive.walls.iter().enumerate().map(|(wall, drive)| {
                    let at = format!("{at}/walls/{wall}");
                    if drive.servo.is_some() {
                        return format!("a smaller {at}/servo/largest_velocity_m_per_s");
                    }
                    match (&drive.force, drive.velocity_m_per_s, drive.sine) {
                        (Some(force), ..) if force.period_s.is_some() => {
                            format!("a longer {at}/force/period_s")
                        }
                        (Some(_), ..) => format!("a smaller {at}/force/force_n"),
                        (_, Some(_), _) => format!("a smaller {at}/velocity_m_per_s"),
                        (.., Some(_)) => format!("a smaller {at}/sine/frequency_hz"),
                        _ => format!("a smaller {at}/turn/angular_velocity_rad_per_s"),
                    }
                });
                let bodies = drive.bodies.iter().enumerate().map(|(body, drive)| {
                    let at = format!("{at}/bodies/{body}");
                    match &drive.force {
                        Some(force) if force.period_s.is_some() => {
                            format!("a longer {at}/force/period_s")
                        }
                        Some(_) => format!("a smaller {at}/force/force_n"),
                        None => format!("a smaller {at}/velocity/velocity_m_per_s"),
                    }
                });
                walls.chain(bodies).collect()
            }
            _ => Vec::new(),
        };
        fields
            .into_iter()
            .map(move |field| format!("{field} (stage {})", number + 1))
    });
    let listed: Vec<String> = fields.by_ref().take(LISTED).collect();
    let more = if fields.next().is_some() { ", ..." } else { "" };
    format!("drive more slowly: {}{more}", listed.join(", "))
}

/// For steps that integrate badly.
fn smaller_step(spec: &GranularScene, engine: &Engine, journal: &Journal) -> String {
    let field = match spec.time_step_s {
        TimeStep::Given(_) => "/time_step_s",
        TimeStep::Automatic(_) => "/accuracy/critical_step_fraction",
    };
    match journal.worst.with(&engine.state.seen).critical {
        Some(critical) => format!(
            "choose a smaller {field}; the smallest critical step seen was {:e} s in stage {}, set by \
             {} and its contact with {}",
            critical.step,
            journal.worst_stages[1] + 1,
            engine.name_of(critical.body),
            engine.name_of(critical.partner)
        ),
        None => format!("choose a smaller {field}"),
    }
}

/// Walls that bodies went through.
fn through_walls(spec: &GranularScene, engine: &Engine, fields: Fields) -> Option<String> {
    let through = &engine.state.through;
    if through.is_empty() {
        return None;
    }
    let planes = spec.planes.len();
    let told = through.iter().take(LISTED).map(|(wall, through)| {
        let wall = *wall as usize;
        let harder = match wall.checked_sub(planes) {
            None if spec.planes[wall].contact_stiffness_n_per_m.is_some() => fields.stiffness(wall),
            None => fields.modulus(&spec.planes[wall].material),
            Some(mesh) => fields.modulus(&spec.facets[mesh].material),
        };
        let name = engine.name_of((engine.model.masses.len() + wall) as u32);
        let times = match through.passages {
            1 => "once".to_owned(),
            count => format!("{count} times"),
        };
        format!(
            "{name} {times}, first body {} in step {} (choose a higher {harder})",
            through.body, through.step
        )
    });
    let told: Vec<String> = told.collect();
    let more = if through.len() > LISTED { "; ..." } else { "" };
    Some(format!(
        "centres of bodies went through walls, which are too soft for what pressed or met them: {}{more}",
        told.join("; ")
    ))
}

#[cfg(test)]
mod tests {
    use loadframe_api::{JobSpec, Submission};

    use super::*;

    const SERVO: &str = r#"{"kind": "granular_scene", "spec": {"version": 1,
        "materials": {"g": {"density_kg_per_m3": 2600, "youngs_modulus_pa": 1e8}},
        "bodies": [{"sphere": {"radius_m": 0.01}, "material": "g", "position_m": [0, 0, 0.02]}],
        "planes": [{"name": "lid", "axis": "z", "position_m": 0.04, "facing": -1, "material": "g"}],
        "stages": [{"drive": {"steps": 10, "walls": [
            {"name": "lid", "servo": {"force_n": 1, "largest_velocity_m_per_s": 0.1}}]}}]}}"#;
    const TRIAXIAL: &str = include_str!("../../../../../api/examples/triaxial.json");

    fn job(text: &str) -> JobSpec {
        Submission::from_slice(text.as_bytes())
            .expect("a valid job")
            .spec
    }

    #[test]
    fn a_servo_is_slowed_down_by_a_field_that_it_has() {
        let JobSpec::GranularScene(spec) = job(SERVO) else {
            panic!("a scene");
        };
        let advice = slower(&spec, Fields::Scene);
        let field = "/stages/0/drive/walls/0/servo/largest_velocity_m_per_s";
        assert!(advice.contains(field), "{advice}");
        let written: serde_json::Value = serde_json::from_str(SERVO).expect("JSON");
        assert!(written["spec"].pointer(field).is_some());
    }

    /// A test has no stages and no materials by name.
    #[test]
    fn a_test_is_told_its_own_fields() {
        let JobSpec::Triaxial(spec) = job(TRIAXIAL) else {
            panic!("a triaxial test");
        };
        let scene = spec.script().scene;
        let mut journal = Journal::default();
        journal.worst_stages[0] = scene.stages.len() - 1;
        for (advice, field) in [
            (slower(&scene, Fields::Soil), "/accuracy/inertial_number"),
            (
                servo(&scene, &journal, Fields::Soil),
                "/accuracy/inertial_number",
            ),
            (
                harder(&scene, &journal, Fields::Soil),
                "/soil/youngs_modulus_pa",
            ),
        ] {
            assert!(advice.contains(field), "{advice}");
            for other in ["/stages", "/materials", "/planes"] {
                assert!(!advice.contains(other), "{advice}");
            }
        }
    }
}
