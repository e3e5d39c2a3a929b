//! Finding an example by its name.
use crate::kinds::{Example, JobKind};

/// Names that are less alike than this (Jaro-Winkler, 0 to 1) are no misspellings of each other.
const ALIKE: f64 = 0.7;

impl Example {
    /// The example of this name; a kind's name is that of its first example.
    ///
    /// # Errors
    /// [`UnknownExample`], which lists all there are.
    pub fn named(name: &str) -> Result<&'static Self, UnknownExample> {
        let found = all().find(|example| example.name == name);
        found.ok_or_else(|| UnknownExample {
            name: name.chars().take(100).collect(),
        })
    }
}

fn all() -> impl Iterator<Item = &'static Example> {
    JobKind::ALL.iter().flat_map(|kind| kind.examples())
}

/// There is no example of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no example named {name:?}{}; there are:{}", self.suggestion(), list())]
pub struct UnknownExample {
    pub name: String,
}

impl UnknownExample {
    /// The name that was probably meant.
    pub fn nearest(&self) -> Option<&'static str> {
        let likeness = |name: &str| strsim::jaro_winkler(&self.name, name);
        let names = all().map(|example| example.name);
        let nearest = names.max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        nearest.filter(|name| likeness(name) >= ALIKE)
    }

    fn suggestion(&self) -> String {
        self.nearest()
            .map_or_else(String::new, |name| format!(" (did you mean {name:?}?)"))
    }
}

/// All examples, a line for each kind.
fn list() -> String {
    let names = |kind: &JobKind| {
        let names = kind.examples().iter().map(|example| example.name);
        names.collect::<Vec<_>>().join(", ")
    };
    let lines = JobKind::ALL
        .iter()
        .map(|kind| format!("\n  {}", names(kind)));
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_names_its_first_example_and_every_example_itself() {
        for kind in JobKind::ALL {
            let first = Example::named(kind.name()).expect("every kind has an example");
            assert_eq!(first.name, kind.examples()[0].name);
            for example in kind.examples() {
                let found = Example::named(example.name).expect("it is listed");
                assert_eq!(found.body, example.body);
            }
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest_and_all_there_are() {
        let error = Example::named("granular_scene_hoper").expect_err("a letter is missing");
        assert_eq!(error.nearest(), Some("granular_scene_hopper"));
        let text = error.to_string();
        assert!(
            text.contains("did you mean \"granular_scene_hopper\"?"),
            "{text}"
        );
        for kind in JobKind::ALL {
            assert!(text.contains(&format!("\n  {}", kind.name())), "{text}");
        }
        let strange = Example::named("xyz").expect_err("nothing is called so");
        assert_eq!(strange.nearest(), None);
    }
}
