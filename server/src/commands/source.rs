//! A job's text: from a file or standard input, with violations shown at their lines.
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

use indexmap::IndexMap;
use loadframe_api::{Submission, SubmissionError, Violation};
use serde_json::value::RawValue;

use super::failure::{Code, Failure};

/// The text of a submission and where it came from.
#[derive(Debug)]
pub(crate) struct Source {
    name: String,
    pub(crate) text: Vec<u8>,
}

impl Source {
    /// Reads `path`, or standard input when it is `-`.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let mut text = Vec::new();
        let (name, read) = if path == Path::new("-") {
            let read = std::io::stdin().read_to_end(&mut text);
            ("standard input".to_owned(), read.map(drop))
        } else {
            let read = std::fs::read(path).map(|bytes| text = bytes);
            (path.display().to_string(), read)
        };
        match read {
            Ok(()) => Ok(Self { name, text }),
            Err(error) => Err(Failure::new(
                Code::Usage,
                format!("{name} cannot be read: {error}"),
            )),
        }
    }

    /// Checks the text as the server would.
    pub(crate) fn submission(&self) -> Result<Submission, Failure> {
        Submission::from_slice(&self.text).map_err(|error| self.refusal(&error))
    }

    pub(crate) fn refusal(&self, error: &SubmissionError) -> Failure {
        match error {
            SubmissionError::Syntax(violation) => {
                let message = format!("{} is not JSON: {}", self.name, violation.detail);
                Failure::new(Code::Usage, message)
            }
            SubmissionError::Invalid(violations) => {
                Failure::new(Code::Usage, self.findings(violations))
            }
        }
    }

    /// All violations as a list, in the order of their lines.
    pub(crate) fn findings(&self, violations: &[Violation]) -> String {
        let count = match violations.len() {
            1 => "one thing is".to_owned(),
            count => format!("{count} things are"),
        };
        let mut text = format!("{count} wrong in {}:", self.name);
        let located = violations
            .iter()
            .map(|violation| (line_of(&self.text, &violation.pointer), violation));
        let mut located: Vec<_> = located.collect();
        located.sort_by_key(|(line, _)| *line);
        for (line, violation) in located {
            let _ = match line {
                Some(line) => write!(text, "\n  line {line}, {violation}"),
                None => write!(text, "\n  {violation}"),
            };
        }
        text
    }
}

/// Line of the value at `pointer`, or of the closest one around it that exists.
fn line_of(text: &[u8], pointer: &str) -> Option<usize> {
    let text = std::str::from_utf8(text).ok()?;
    let mut value: &RawValue = serde_json::from_str(text).ok()?;
    for part in pointer.split('/').skip(1) {
        let part = part.replace("~1", "/").replace("~0", "~");
        let Some(inner) = part_of(value.get(), &part) else {
            break;
        };
        value = inner;
    }
    // the value borrows from the text: where it begins is how many lines precede it
    let offset = (value.get().as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    Some(text.get(..offset)?.matches('\n').count() + 1)
}

fn part_of<'a>(value: &'a str, name: &str) -> Option<&'a RawValue> {
    if value.starts_with('{') {
        let fields: IndexMap<std::borrow::Cow<'a, str>, &'a RawValue> =
            serde_json::from_str(value).ok()?;
        fields.get(name).copied()
    } else {
        let items: Vec<&'a RawValue> = serde_json::from_str(value).ok()?;
        items.get(name.parse::<usize>().ok()?).copied()
    }
}

/// Argument naming a job's text.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SpecArgument {
    /// The job as JSON, as POST /v1/jobs takes it; - reads standard input
    #[arg(value_name = "SPEC.json")]
    spec: PathBuf,
}

impl SpecArgument {
    pub(crate) fn read(&self) -> Result<Source, Failure> {
        Source::read(&self.spec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "{\n  \"kind\": \"x\",\n  \"spec\": {\n    \"a\": [1,\n      {\"b/c\": 2}]\n  }\n}";

    #[test]
    fn lines_are_found_through_objects_and_lists() {
        for (pointer, line) in [
            ("", 1),
            ("/kind", 2),
            ("/spec", 3),
            ("/spec/a/0", 4),
            ("/spec/a/1/b~1c", 5),
        ] {
            assert_eq!(line_of(TEXT.as_bytes(), pointer), Some(line), "{pointer}");
        }
    }

    #[test]
    fn a_missing_field_is_shown_where_it_should_be() {
        assert_eq!(line_of(TEXT.as_bytes(), "/spec/missing"), Some(3));
        assert_eq!(line_of(TEXT.as_bytes(), "/spec/a/9"), Some(4));
        assert_eq!(line_of(b"[", "/spec"), None);
    }

    #[test]
    fn findings_come_in_the_order_of_the_text() {
        let source = Source {
            name: "my.json".to_owned(),
            text: TEXT.into(),
        };
        let late = Violation::new("/spec/a/1/b~1c", "out_of_range", "too small");
        let early = Violation::new("/kind", "not_allowed", "no such kind");
        assert_eq!(
            source.findings(&[late, early]),
            "2 things are wrong in my.json:\n  line 2, /kind: no such kind\n  line 5, /spec/a/1/b~1c: too small"
        );
    }
}
