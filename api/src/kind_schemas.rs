//! The JSON Schema of each kind's spec, and specs held against it.
use std::sync::OnceLock;

use serde_json::Value;

use crate::kinds::{JobKind, JobSpec, SpecVisitor};
use crate::problem::Violation;
use crate::results::results_of;
use crate::schema::{Checker, unit_at};
use crate::spec_trait::Spec;
use crate::violations::Violations;

/// JSON Schema (2020-12) of a kind's spec, without references, with `x-unit` at every quantity and the
/// results that its jobs may have, with their units, in `x-results`.
pub fn kind_schema(kind: JobKind) -> &'static Value {
    &kind_checker(kind).schema
}

/// Unit of the field of a kind's spec that the JSON pointer names; none where it has none or there is no
/// such field.
pub fn unit_of_field(kind: JobKind, pointer: &str) -> Option<&'static str> {
    unit_at(kind_schema(kind), pointer)
}

impl JobSpec {
    /// Everything that is wrong with the spec, with pointers into it.
    ///
    /// # Errors
    /// The violations, when there are any.
    pub fn check(&self) -> Result<(), Vec<Violation>> {
        let wrong = spec_violations(self.kind(), &self.to_value());
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let mut violations = Violations::default();
        self.cross_check(&mut violations);
        if violations.is_empty() {
            Ok(())
        } else {
            Err(violations.into_vec())
        }
    }
}

/// Everything in `spec` that the kind's schema refuses, with pointers relative to the spec.
pub(crate) fn spec_violations(kind: JobKind, spec: &Value) -> Vec<Violation> {
    kind_checker(kind).violations(spec)
}

fn kind_checker(kind: JobKind) -> &'static Checker {
    struct Compile;
    impl SpecVisitor for Compile {
        type Output = Checker;
        fn visit<T: Spec>(self, _: fn(T) -> JobSpec) -> Checker {
            Checker::of::<T>()
        }
    }
    // each by itself: a job needs the schema of its own kind only, and they take milliseconds each
    static CHECKERS: [OnceLock<Checker>; JobKind::ALL.len()] =
        [const { OnceLock::new() }; JobKind::ALL.len()];
    CHECKERS[kind as usize].get_or_init(|| {
        let mut checker = kind.visit(Compile);
        checker.schema["x-results"] = results_of(kind);
        checker
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_schema_compiles_and_names_the_unit_of_every_number() {
        for kind in JobKind::ALL {
            let checker = kind_checker(*kind);
            assert!(checker.is_usable(), "{kind}");
            assert!(jsonschema::meta::is_valid(&checker.schema), "{kind}");
            // the longer ending first
            let units = [
                ("_mm2_per_n", "mm2/N"),
                ("_n_per_mm", "N/mm"),
                ("_mm", "mm"),
                ("_n", "N"),
                ("_pa", "Pa"),
            ];
            each_field(&checker.schema, &mut |field, node| {
                let known = units.iter().find(|(name, _)| field.ends_with(name));
                if let Some((_, unit)) = known {
                    assert_eq!(node["x-unit"], *unit, "{kind} {field}");
                }
            });
        }
    }

    #[test]
    fn a_field_of_a_spec_has_its_unit() {
        let unit = |pointer| unit_of_field(JobKind::NonwovenTensile, pointer);
        assert_eq!(unit("/bond/modulus_n"), Some("N"));
        assert_eq!(unit("/fabric/lattice/spacing_mm/2"), Some("mm"));
        assert_eq!(unit("/seed"), None);
        assert_eq!(unit("/no/such/field_mm"), None);
    }

    fn each_field(node: &Value, see: &mut impl FnMut(&str, &Value)) {
        match node {
            Value::Object(map) => {
                if let Some(fields) = map.get("properties").and_then(Value::as_object) {
                    fields.iter().for_each(|(name, field)| see(name, field));
                }
                map.values().for_each(|child| each_field(child, see));
            }
            Value::Array(items) => items.iter().for_each(|child| each_field(child, see)),
            _ => {}
        }
    }
}
