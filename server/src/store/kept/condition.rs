//! Conditions on values that are kept.
use super::super::database::Builder;
use super::super::pointer::{Condition, Operand};

/// That a kept value, by this name in the statement, is one of the field that the condition holds for.
pub(in super::super) fn push_condition(
    query: &mut Builder,
    name: &str,
    field: i64,
    condition: &Condition,
) {
    let sign = condition.comparison.sql();
    query.push(format!("{name}.field = ")).push_bind(field);
    match &condition.operand {
        Operand::Number(number) => {
            query.push(format!(
                " AND {name}.is_truth = 0 AND {name}.number {sign} "
            ));
            query.push_bind(*number);
        }
        Operand::Truth(truth) => {
            query.push(format!(
                " AND {name}.is_truth = 1 AND {name}.number {sign} "
            ));
            query.push_bind(f64::from(u8::from(*truth)));
        }
        Operand::Text(text) => {
            query.push(format!(" AND {name}.text {sign} "));
            query.push_bind(text.clone());
        }
    }
}
