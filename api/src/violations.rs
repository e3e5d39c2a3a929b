//! What is wrong with a request, as far as anybody wants to read it.
use crate::Violation;

/// At most this many are listed; a hundred are as clear as a million.
pub(crate) const LISTED: usize = 100;
/// At most this many of one sort, so that others are seen beside them.
pub(crate) const LISTED_OF_A_SORT: usize = 20;
/// Longest pointer, sentence and range kept [bytes]: names in them are as long as their author likes.
const LONGEST_TEXT: usize = 2000;

/// The first violations found, so that a body full of mistakes takes no more memory than one with a
/// hundred. Those beyond are counted as far as they were seen, and not kept.
#[derive(Clone, Debug, Default)]
pub struct Violations {
    listed: Vec<Violation>,
    count: usize,
}

impl Violations {
    /// Takes in one more.
    pub fn push(&mut self, violation: Violation) {
        self.count += 1;
        if self.listed.len() < LISTED {
            self.listed.push(shortened(violation));
        }
    }

    /// Whether all that are shown are there: whoever searches may stop.
    pub fn is_full(&self) -> bool {
        self.listed.len() >= LISTED
    }

    /// Whether nothing is wrong.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// How many were found, those included that are not kept. It grows with every step that finds
    /// something, however many were found before.
    pub fn count(&self) -> usize {
        self.count
    }

    /// What is shown.
    pub fn into_vec(self) -> Vec<Violation> {
        self.listed
    }
}

/// Asks for no more than one beyond what is shown, so that a lazy search ends there.
impl Extend<Violation> for Violations {
    fn extend<I: IntoIterator<Item = Violation>>(&mut self, found: I) {
        for violation in found {
            let was_full = self.is_full();
            self.push(violation);
            if was_full {
                break;
            }
        }
    }
}

impl<'a> IntoIterator for &'a Violations {
    type Item = &'a Violation;
    type IntoIter = std::slice::Iter<'a, Violation>;

    fn into_iter(self) -> Self::IntoIter {
        self.listed.iter()
    }
}

fn shortened(mut violation: Violation) -> Violation {
    shorten(&mut violation.pointer);
    shorten(&mut violation.detail);
    violation.allowed.iter_mut().for_each(shorten);
    violation
}

/// Cuts a text between two characters.
pub(crate) fn shorten(text: &mut String) {
    if text.len() > LONGEST_TEXT {
        text.truncate(text.floor_char_boundary(LONGEST_TEXT));
        text.push('…');
        text.shrink_to_fit();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mistake(number: usize) -> Violation {
        Violation::new(format!("/{number}"), "wrong", "it is wrong")
    }

    #[test]
    fn a_search_is_asked_for_one_more_than_is_shown() {
        let mut asked = 0;
        let mut violations = Violations::default();
        violations.extend((0..1_000_000).map(|number| {
            asked = number + 1;
            mistake(number)
        }));
        assert_eq!(asked, LISTED + 1);
        assert!(violations.is_full());
        // a check that finds something more tells so, though it is not shown
        let before = violations.count();
        violations.extend([mistake(0)]);
        assert_eq!(violations.count(), before + 1);
        assert_eq!(violations.into_vec().len(), LISTED);
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        let mut violations = Violations::default();
        violations.push(mistake(0).allowed("é".repeat(LONGEST_TEXT)));
        let allowed = violations.into_vec().remove(0).allowed;
        assert_eq!(allowed, Some("é".repeat(LONGEST_TEXT / 2) + "…"));
    }
}
