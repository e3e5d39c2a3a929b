//! What is wrong with a parameter of a query, in the form of other violations.
use axum::extract::Query;
use axum::http::Uri;
use loadframe_api::Violation;

/// How the framework's refusal of a query begins.
const REFUSED: &str = "Failed to deserialize query string: ";
/// What stands before the values that are allowed: in messages of [`super::bounded`] and of moments, and in
/// those of enumerations and unknown parameters.
const ALLOWED: [&str; 2] = ["it must be ", "expected "];

/// The violation that such a refusal tells of, and a sentence with all of it.
pub(super) fn violation(uri: &Uri, refusal: &str) -> Option<(Violation, String)> {
    let (name, reason) = refusal.strip_prefix(REFUSED)?.split_once(": ")?;
    let Query(given) = Query::<Vec<(String, String)>>::try_from_uri(uri).ok()?;
    let (_, value) = given.into_iter().find(|(given, _)| given == name)?;
    let allowed = match ALLOWED.iter().find_map(|before| reason.split_once(before)) {
        Some((_, allowed)) => allowed.to_owned(),
        None if reason.starts_with("UUID") => "a UUID".to_owned(),
        None if reason.contains("`true` or `false`") => "true or false".to_owned(),
        None => return None,
    };
    let is_unknown = reason.starts_with("unknown field");
    let pointer = format!("/{}", name.replace('~', "~0").replace('/', "~1"));
    let (code, detail) = match is_unknown {
        true => ("unknown_field", "there is no such parameter".to_owned()),
        false => ("not_allowed", reason.to_owned()),
    };
    let sentence = match is_unknown {
        true => format!("the parameter {name:?} is none of this address: {allowed}"),
        false => format!("{name} is {value:?}, but must be {allowed}"),
    };
    let violation = Violation::new(&pointer, code, detail);
    Some((violation.value(value).allowed(&allowed), sentence))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_refusals_of_parameters_are_understood() {
        let uri: Uri = "/v1/jobs?limit=-1".parse().expect("an address");
        let found = |text: &str| violation(&uri, text).map(|(violation, _)| violation.pointer);
        let refused = |rest: &str| found(&format!("{REFUSED}{rest}"));
        let expected = Some("/limit".to_owned());
        assert_eq!(
            refused("limit: it must be a whole number, 1 … 200"),
            expected
        );
        assert_eq!(refused("duplicate field `limit`"), None);
        assert_eq!(refused("cursor: it must be short"), None);
        assert_eq!(found("limit: it must be a whole number"), None);
    }
}
