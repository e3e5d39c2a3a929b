//! Materials whose constants an earlier job found.
use super::checks::pointer_to;
use super::{Limit, Material, Orthotropic, Strength};
use crate::earlier::{Earlier, EarlierJob, UNKNOWN_RESULTS};
use crate::{JobKind, Violation, Violations};

impl Material {
    /// Fills in the constants, and the strengths where none are given, of the job that it names.
    pub(super) fn learn(&mut self, name: &str, earlier: &Earlier, violations: &mut Violations) {
        let Some(id) = self.from_job else { return };
        if self.isotropic.is_some() || self.orthotropic.is_some() {
            return;
        }
        let refused = |detail: String| {
            Violation::new(
                format!("{}/from_job", pointer_to(name)),
                UNKNOWN_RESULTS,
                detail,
            )
            .value(id.to_string())
        };
        let found = match earlier.job(id) {
            Some(Ok(job)) => constants(job).ok_or_else(|| {
                let detail = format!("job {id} is a {} job", job.kind.name());
                refused(detail).allowed("a finished composite_cell job")
            }),
            Some(Err(reason)) => {
                Err(refused(reason.to_owned()).allowed("a finished composite_cell job"))
            }
            None => Err(refused(
                "the constants of that job are known to the server that ran it, which fills them in when it \
                 takes a job"
                    .to_owned(),
            )
            .allowed("constants beside it, as the job's file material.json has them")),
        };
        match found {
            Ok((constants, strength)) => {
                self.orthotropic = Some(constants);
                self.strength = self.strength.or(strength);
            }
            Err(violation) => violations.push(violation),
        }
    }
}

/// The constants and strengths that a cell found.
fn constants(job: &EarlierJob) -> Option<(Orthotropic, Option<Strength>)> {
    if job.kind != JobKind::CompositeCell {
        return None;
    }
    let value = |name: &str| job.summary.get(name).and_then(|quantity| quantity.value);
    let constants = Orthotropic {
        modulus_1_mpa: value("modulus_1")?,
        modulus_2_mpa: value("modulus_2")?,
        poisson_ratio_12: value("poisson_ratio_12")?,
        shear_modulus_12_mpa: Some(value("shear_modulus_12")?),
        modulus_3_mpa: Some(value("modulus_3")?),
        poisson_ratio_13: Some(value("poisson_ratio_13")?),
        poisson_ratio_23: Some(value("poisson_ratio_23")?),
        shear_modulus_13_mpa: Some(value("shear_modulus_13")?),
        shear_modulus_23_mpa: Some(value("shear_modulus_23")?),
    };
    let limit = |name: &str| {
        value(name).map(|strength_mpa| Limit {
            strength_mpa,
            fracture_energy_n_per_mm: None,
        })
    };
    let strength = Strength {
        tension: limit("strength_along_tension"),
        compression: limit("strength_along_compression"),
        across_tension: limit("strength_across_tension"),
        across_compression: limit("strength_across_compression"),
        shear: limit("strength_shear"),
    };
    let has_any = strength != Strength::default();
    Some((constants, has_any.then_some(strength)))
}
