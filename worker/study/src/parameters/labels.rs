//! Labels of cases as far as they differ.
use super::case::CaseRow;

/// The words that labels have in common: `stiffness = 1` and `stiffness = 2` are values of stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Labels<'a> {
    name: Option<&'a str>,
}

impl<'a> Labels<'a> {
    pub(super) fn of(cases: &'a [CaseRow]) -> Self {
        Self::common(cases.iter().map(|case| case.label.as_str()))
    }

    fn common(mut labels: impl Iterator<Item = &'a str>) -> Self {
        let first = labels.next().and_then(|label| label.split_once(" = "));
        let name = first.filter(|(_, value)| !value.contains(" = "));
        let name = name.map(|(name, _)| name);
        let shares = |label: &str| match label.split_once(" = ") {
            Some((own, value)) => Some(own) == name && !value.contains(" = "),
            None => false,
        };
        Self {
            name: name.filter(|_| labels.all(shares)),
        }
    }

    /// What the labels are values of.
    pub(super) fn name(self) -> &'a str {
        self.name.unwrap_or("case")
    }

    /// What is a label's own.
    pub(super) fn short(self, label: &str) -> &str {
        let value = self.name.and_then(|name| label.strip_prefix(name));
        let value = value.and_then(|value| value.strip_prefix(" = "));
        value.unwrap_or(label)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_name_that_all_share_is_left_out() {
        let shown = |labels: &[&'static str]| {
            let common = Labels::common(labels.iter().copied());
            let short: Vec<&str> = labels.iter().map(|label| common.short(label)).collect();
            format!("{}: {}", common.name(), short.join("; "))
        };
        assert_eq!(shown(&["nu = 0.1", "nu = 0.3"]), "nu: 0.1; 0.3");
        assert_eq!(
            shown(&["nu = 0.1", "phi = 0.3"]),
            "case: nu = 0.1; phi = 0.3"
        );
        assert_eq!(
            shown(&["nu = 1, k = 2", "nu = 2, k = 2"]),
            "case: nu = 1, k = 2; nu = 2, k = 2"
        );
        assert_eq!(shown(&["as it is", "nu = 0.3"]), "case: as it is; nu = 0.3");
        assert_eq!(shown(&[]), "case: ");
    }
}
