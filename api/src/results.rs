//! Names and units of the results that jobs of each kind may have, for those who refer to them before
//! a job has run. Which of them a job does have depends on its spec; that the engines give no others is
//! tested with every example.
use serde_json::{Value, json};

use crate::JobKind;

/// A result's name and unit; a moment of the test, or another result, within a name is written `*`, once.
pub(crate) type Named = (&'static str, &'static str);

/// What names of a second direction end in.
const ALONG: [&str; 4] = ["_along_x", "_along_y", "_along_md", "_along_cd"];

/// `x-results` of a kind's schema: name and unit of each result.
pub(crate) fn results_of(kind: JobKind) -> Value {
    let all = kind.results().concat().into_iter();
    all.map(|(name, unit)| json!({ "name": name, "unit": unit }))
        .collect()
}

/// Names of the results that jobs of a kind may have.
pub fn result_names(kind: JobKind) -> Vec<&'static str> {
    let mut names: Vec<&str> = kind
        .results()
        .concat()
        .iter()
        .map(|(name, _)| *name)
        .collect();
    names.dedup();
    names
}

/// The units in which jobs of a kind may give a result; none where they have no such result.
pub fn result_units(kind: JobKind, name: &str) -> Vec<&'static str> {
    let own = ALONG
        .iter()
        .find_map(|end| name.strip_suffix(end))
        .unwrap_or(name);
    let all = kind.results().concat();
    let units = |is_it: &dyn Fn(&str) -> bool| -> Vec<&'static str> {
        let found = all.iter().filter(|(known, _)| is_it(known));
        found.map(|(_, unit)| *unit).collect()
    };
    let named = units(&|known| known == name || known == own);
    if !named.is_empty() {
        return named;
    }
    units(&|known| {
        let parts = known.split_once('*');
        parts.is_some_and(|(beginning, end)| {
            let fits = |name: &str| {
                let rest = name.strip_prefix(beginning);
                rest.and_then(|rest| rest.strip_suffix(end))
                    .is_some_and(|moment| !moment.is_empty())
            };
            fits(name) || fits(own)
        })
    })
}
