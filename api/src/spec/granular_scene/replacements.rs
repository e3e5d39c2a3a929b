//! Stages that replace spheres: how many, and whether they can.
use super::{
    Clump, Equal, Grain, GranularScene, Replace, Stage,
    part_checks::{check_clump, check_material},
    whole::Whole,
};
use crate::{Violation, Violations};

impl GranularScene {
    /// Stages that replace spheres, and their numbers.
    pub(super) fn replacements(&self) -> impl Iterator<Item = (usize, &Replace)> {
        let stages = self.stages.iter().enumerate();
        stages.filter_map(|(index, stage)| match stage {
            Stage::Replace(replace) => Some((index, replace.as_ref())),
            _ => None,
        })
    }

    /// About how many spheres a stage replaces: those that came in since the stage before that replaces the
    /// same.
    pub(super) fn expected_replaced(&self, stage: usize, replace: &Replace) -> f64 {
        let before = self
            .replacements()
            .filter(|(number, other)| *number < stage && other.material == replace.material);
        let before = before.map(|(number, _)| number).last();
        let given = match before {
            None => {
                let given = self.given_bodies();
                given.iter().filter(|body| replace.replaces(body)).count() as f64
            }
            Some(_) => 0.0,
        };
        let first = self.generate.iter().filter(|_| before.is_none());
        let since = before.map_or(0, |number| number + 1);
        let stages = self.stages.iter().take(stage).skip(since);
        let inserted = stages.filter_map(|stage| match stage {
            Stage::Insert(insert) => Some(&insert.bodies),
            _ => None,
        });
        let made = first.chain(inserted).filter(|generator| {
            generator.material == replace.material && generator.grain == Grain::Sphere
        });
        let density = self.density_of(&replace.material);
        given
            + made
                .map(|generator| generator.expected_grains(density))
                .sum::<f64>()
    }
}

/// What is replaced is there, and can be.
pub(super) fn check(spec: &GranularScene, violations: &mut Violations) {
    for (index, replace) in spec.replacements() {
        let pointer = format!("/stages/{index}/replace");
        let missing = check_material(spec, &pointer, &replace.material);
        let clump = check_template(&format!("{pointer}/clump"), &replace.clump);
        if missing.is_some() || clump.is_some() {
            violations.extend(missing.into_iter().chain(clump));
            continue;
        }
        let of_material = |code: &str, detail: &str, allowed: &str| {
            Violation::new(format!("{pointer}/material"), code, detail)
                .value(replace.material.as_str())
                .allowed(allowed)
        };
        if spec.materials[&replace.material].is_cohesive() {
            let detail = "spheres of this material may be bonded, and would lose their bonds";
            let allowed = "a material without cohesion and parallel_bond";
            violations.push(of_material("not_together", detail, allowed));
        } else if spec.expected_replaced(index, replace) < 0.5 {
            let detail = "no spheres of this material that are free are there by then";
            let allowed = "the material of spheres that are given, generated, or inserted by an earlier stage";
            violations.push(of_material("no_such_body", detail, allowed));
        }
        let is_relaxed = matches!(spec.stages.get(index + 1), Some(Stage::Relax(_)));
        if replace.equal == Equal::Mass && !is_relaxed {
            let detail = "clumps of equal mass stand out of their spheres, into their neighbours";
            violations.push(
                Violation::new(format!("{pointer}/equal"), "not_together", detail)
                    .value("mass")
                    .allowed("\"size\", or a relax stage after this one"),
            );
        }
        violations.extend(check_farthest(
            &format!("{pointer}/equal"),
            replace.equal,
            &replace.clump,
        ));
    }
}

/// A clump of several members, which can be filled.
fn check_template(pointer: &str, clump: &Clump) -> Option<Violation> {
    check_clump(pointer, clump).or_else(|| {
        (clump.filled.is_none() && clump.members.len() == 1).then(|| {
            Violation::new(pointer, "clump_of_one", "a clump of one is a sphere")
                .value(1)
                .allowed("at least 2 members")
        })
    })
}

/// A member whose centre lies outside of the sphere may begin behind a wall of triangles, or behind the
/// members of a neighbour, and would be pressed out on the wrong side.
fn check_farthest(pointer: &str, equal: Equal, clump: &Clump) -> Option<Violation> {
    let whole = Whole::of(&clump.resolved().ok()?.members);
    let (farthest, radius) = (whole.farthest, equal.radius(&whole));
    (farthest > radius).then(|| {
        let detail = format!(
            "a member's centre would lie {:.3} radii of the replaced sphere from its centre, outside of \
             it, where a wall or a neighbour may be",
            farthest / radius
        );
        Violation::new(pointer, "not_together", detail)
            .value("mass")
            .allowed("\"size\", or a clump whose members have their centres inside the ball of its volume")
    })
}
