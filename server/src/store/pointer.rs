//! What lists are sorted, filtered and widened by: values of specs and results, by JSON pointer.
//!
//! A pointer is `/spec/…` as in the spec of a job (RFC 6901), or `/summary/NAME`, a result's value. A part
//! that is a whole number, written as such, is a place in a list. It is taken apart here, once, and goes into
//! statements as a value.
use std::fmt::Write;
use std::str::FromStr;

/// Longest pointer [bytes].
const LONGEST: usize = 200;
/// A place in a list has so many digits at most: databases count no further.
const MOST_DIGITS: usize = 9;
/// Longest text that is compared [bytes]: longer ones of specs are notes, no values.
pub(super) const LONGEST_TEXT: usize = 500;

/// Where a value stands in a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pointer {
    text: String,
    root: Root,
    /// The same in the database's words.
    path: String,
}

/// What of a job a pointer leads into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    Spec,
    Results,
}

/// Why a text is no pointer, condition or order.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PointerError {
    #[error(
        "{0:?} is not /spec/… or /summary/NAME, with parts of up to 200 bytes in all, without quotes and \
         control characters, ~ as ~0 and / as ~1, and places in lists of up to {MOST_DIGITS} digits"
    )]
    Pointer(String),
    #[error("{0:?} is not a pointer, one of = != < <= > >=, and a value")]
    Condition(String),
    #[error("{0:?} is not a number: only numbers are less or more")]
    NoNumber(String),
    #[error("{0:?} is a number beyond 1.8e308: write it in quotes if it is a text")]
    LargeNumber(String),
    #[error("{0:?} has a zero character, which no value of a job has")]
    Zero(String),
    #[error("a text of {0} bytes is compared with nothing: at most {LONGEST_TEXT}")]
    LongText(usize),
}

impl Pointer {
    /// As it was given, so that a client finds its value again.
    pub fn text(&self) -> &str {
        &self.text
    }

    pub fn root(&self) -> Root {
        self.root
    }

    /// The part below the spec.
    pub fn within_spec(&self) -> Option<&str> {
        match self.root {
            Root::Spec => self.text.strip_prefix("/spec"),
            Root::Results => None,
        }
    }

    pub(super) fn path(&self) -> &str {
        &self.path
    }
}

impl FromStr for Pointer {
    type Err = PointerError;

    fn from_str(text: &str) -> Result<Self, PointerError> {
        let refused = || PointerError::Pointer(text.to_owned());
        let is_strange = |c: char| c.is_control() || c == '"' || c == '\\';
        let is_plain = text.len() <= LONGEST && !text.contains(is_strange);
        let mut parts = text.split('/');
        if !is_plain || parts.next() != Some("") {
            return Err(refused());
        }
        let root = match parts.next() {
            Some("spec") => Root::Spec,
            Some("summary") => Root::Results,
            _ => return Err(refused()),
        };
        let parts: Option<Vec<String>> = parts.map(unescaped).collect();
        let parts = parts.ok_or_else(refused)?;
        let is_whole = match root {
            Root::Spec => !parts.is_empty(),
            // the value is all that a result is sorted by
            Root::Results => parts.len() == 1,
        };
        if !is_whole || parts.iter().any(String::is_empty) {
            return Err(refused());
        }
        let mut path = "$".to_owned();
        for part in &parts {
            let is_number = part.bytes().all(|byte| byte.is_ascii_digit());
            // with zeros before it, it is a name
            let is_place =
                root == Root::Spec && is_number && (part == "0" || !part.starts_with('0'));
            if is_place && part.len() > MOST_DIGITS {
                return Err(refused());
            }
            // writing to a text does not fail
            let _ = match is_place {
                true => write!(path, "[{part}]"),
                false => write!(path, ".\"{part}\""),
            };
        }
        if root == Root::Results {
            path.push_str(".value");
        }
        Ok(Self {
            text: text.to_owned(),
            root,
            path,
        })
    }
}

/// A part of a pointer as the name that it stands for; nothing where a `~` is neither `~0` nor `~1`.
fn unescaped(part: &str) -> Option<String> {
    let mut pieces = part.split('~');
    let mut name = pieces.next()?.to_owned();
    for piece in pieces {
        let (sign, rest) = piece.split_at_checked(1)?;
        name.push(match sign {
            "0" => '~',
            "1" => '/',
            _ => return None,
        });
        name.push_str(rest);
    }
    Some(name)
}

/// How a value is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    Equal,
    NotEqual,
    Less,
    AtMost,
    More,
    AtLeast,
}

/// In the order in which they are looked for: the longer before what it begins with.
const COMPARISONS: [(&str, Comparison); 6] = [
    ("!=", Comparison::NotEqual),
    ("<=", Comparison::AtMost),
    (">=", Comparison::AtLeast),
    ("=", Comparison::Equal),
    ("<", Comparison::Less),
    (">", Comparison::More),
];

impl Comparison {
    pub(super) fn sql(self) -> &'static str {
        match self {
            Self::Equal => "=",
            Self::NotEqual => "<>",
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::More => ">",
            Self::AtLeast => ">=",
        }
    }
}

/// What a value is compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    Number(f64),
    Truth(bool),
    Text(String),
}

/// A condition on a job: that it has the value, of the operand's type, and that the comparison holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    pub pointer: Pointer,
    pub comparison: Comparison,
    pub operand: Operand,
}

impl FromStr for Condition {
    type Err = PointerError;

    /// Such as `/spec/test/max_strain>=0.05` or `/spec/test/breaking=none`.
    fn from_str(text: &str) -> Result<Self, PointerError> {
        let refused = || PointerError::Condition(text.to_owned());
        let place = text.find(['!', '<', '>', '=']).ok_or_else(refused)?;
        let (pointer, rest) = text.split_at(place);
        let mut known = COMPARISONS.into_iter();
        let found = known.find_map(|(sign, of)| Some((of, rest.strip_prefix(sign)?)));
        let (comparison, value) = found.ok_or_else(refused)?;
        let value = value.trim();
        // `==` and `=>` are no comparisons
        if value.is_empty() || value.starts_with(['=', '<', '>', '!']) {
            return Err(refused());
        }
        let operand = match (value, value.parse::<f64>()) {
            (_, Ok(number)) if number.is_finite() => Operand::Number(number),
            // words such as `inf` are none
            (_, Ok(_)) if value.bytes().any(|byte| byte.is_ascii_digit()) => {
                return Err(PointerError::LargeNumber(value.to_owned()));
            }
            ("true", _) => Operand::Truth(true),
            ("false", _) => Operand::Truth(false),
            _ => Operand::Text(unquoted(value).to_owned()),
        };
        match &operand {
            Operand::Text(text) if text.len() > LONGEST_TEXT => {
                return Err(PointerError::LongText(text.len()));
            }
            Operand::Text(text) if text.contains('\0') => {
                return Err(PointerError::Zero(text.clone()));
            }
            _ => {}
        }
        let is_ordered = !matches!(comparison, Comparison::Equal | Comparison::NotEqual);
        if is_ordered && !matches!(operand, Operand::Number(_)) {
            return Err(PointerError::NoNumber(value.to_owned()));
        }
        Ok(Self {
            pointer: pointer.trim().parse()?,
            comparison,
            operand,
        })
    }
}

/// A text without the quotes around it.
fn unquoted(text: &str) -> &str {
    let inner = text
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    inner.unwrap_or(text)
}

/// What jobs are sorted by; those without the value come last of all, either way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    pub pointer: Pointer,
    pub is_falling: bool,
}

impl FromStr for Order {
    type Err = PointerError;

    /// A pointer, falling with `-` before it.
    fn from_str(text: &str) -> Result<Self, PointerError> {
        let (is_falling, pointer) = match text.strip_prefix('-') {
            Some(pointer) => (true, pointer),
            None => (false, text),
        };
        Ok(Self {
            pointer: pointer.parse()?,
            is_falling,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pointer_leads_into_a_spec_or_to_a_result() {
        for (text, root, path) in [
            ("/spec/seed", Root::Spec, "$.\"seed\""),
            (
                "/spec/pulp/0/width_um",
                Root::Spec,
                "$.\"pulp\"[0].\"width_um\"",
            ),
            (
                "/spec/materials/a~1b~0c",
                Root::Spec,
                "$.\"materials\".\"a/b~c\"",
            ),
            // a name that reads like an escape, and names of digits that are no places
            ("/spec/a~01/b", Root::Spec, "$.\"a~1\".\"b\""),
            ("/spec/a/007", Root::Spec, "$.\"a\".\"007\""),
            ("/spec/a/0", Root::Spec, "$.\"a\"[0]"),
            ("/spec/a/999999999", Root::Spec, "$.\"a\"[999999999]"),
            ("/spec/é%_'[*]", Root::Spec, "$.\"é%_'[*]\""),
            ("/summary/max_force", Root::Results, "$.\"max_force\".value"),
        ] {
            let pointer: Pointer = text.parse().expect(text);
            assert_eq!((pointer.root(), pointer.path()), (root, path));
        }
        let long = format!("/spec/{}", "a".repeat(LONGEST));
        for wrong in [
            "",
            "/",
            "spec/seed",
            "/spec",
            "/spec/",
            "/spec//a",
            "/name",
            "/summary/a/b",
            "/spec/a\"b",
            "/spec/a\nb",
            "/spec/a\u{0}",
            "/spec/a~2b",
            "/spec/a~",
            "/spec/a~\u{e9}",
            "/spec/a/4294967296",
            "/summary",
            &long,
        ] {
            assert!(wrong.parse::<Pointer>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_condition_is_a_pointer_a_comparison_and_a_value() {
        for (text, comparison, operand) in [
            ("/spec/seed=3", Comparison::Equal, Operand::Number(3.0)),
            (
                "/spec/seed != 3",
                Comparison::NotEqual,
                Operand::Number(3.0),
            ),
            (
                "/summary/max_force>=1.5e3",
                Comparison::AtLeast,
                Operand::Number(1500.0),
            ),
            (
                "/summary/max_force<-2",
                Comparison::Less,
                Operand::Number(-2.0),
            ),
            ("/spec/a=true", Comparison::Equal, Operand::Truth(true)),
            (
                "/spec/a=none",
                Comparison::Equal,
                Operand::Text("none".to_owned()),
            ),
            (
                "/spec/a=\"3 mm\"",
                Comparison::Equal,
                Operand::Text("3 mm".to_owned()),
            ),
            (
                "/spec/a=\"1e999\"",
                Comparison::Equal,
                Operand::Text("1e999".to_owned()),
            ),
            (
                "/spec/a=5\"",
                Comparison::Equal,
                Operand::Text("5\"".to_owned()),
            ),
            (
                "/spec/a=nan",
                Comparison::Equal,
                Operand::Text("nan".to_owned()),
            ),
        ] {
            let condition: Condition = text.parse().expect(text);
            assert_eq!(
                (condition.comparison, condition.operand),
                (comparison, operand),
                "{text}"
            );
        }
        for wrong in [
            "/spec/a",
            "/spec/a=",
            "/spec/a!3",
            "=3",
            "/spec/a<b",
            "/spec/a<true",
            "/spec/a<inf",
            "/spec/a=1e999",
            "/spec/a=-1e999",
            "/spec/a<NaN",
            "/spec/a=x\u{0}y",
            "/spec/a==3",
        ] {
            assert!(wrong.parse::<Condition>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_order_falls_by_a_sign_before_it() {
        let order: Order = "-/summary/max_force".parse().expect("an order");
        assert!(order.is_falling && order.pointer.text() == "/summary/max_force");
        assert!(!"/spec/seed".parse::<Order>().expect("an order").is_falling);
        assert!("--/spec/seed".parse::<Order>().is_err());
    }
}
