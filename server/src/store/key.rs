//! What jobs are sorted by, and the cursor that a page of a sorted list ends with.
use std::cmp::Ordering;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;

use super::database::Row;
use super::error::{Result, StoreError};

/// What a job is sorted by: a number, else a text; neither comes last. Among equals the order is that of
/// their submission, falling as the values do; those with neither are the newest first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Key {
    pub(super) number: Option<f64>,
    pub(super) text: Option<String>,
    pub(super) seq: i64,
}

impl Key {
    /// Those of rows that are a job's number, a number, and a text.
    pub(super) fn all(rows: Vec<Row>) -> Result<Vec<Self>> {
        let key = |row: Row| {
            Ok(Self {
                number: row.get(1)?,
                text: row.get(2)?,
                seq: row.get(0)?,
            })
        };
        rows.into_iter().map(key).collect()
    }

    pub(super) fn compare(&self, other: &Self, is_falling: bool) -> Ordering {
        let rank = |key: &Self| match (&key.number, &key.text) {
            (Some(_), _) => 0,
            (None, Some(_)) => 1,
            (None, None) => 2,
        };
        let values = match (&self.number, &other.number) {
            // as the database compares them: none is NaN
            (Some(mine), Some(theirs)) => mine.partial_cmp(theirs).unwrap_or(Ordering::Equal),
            _ => self.text.cmp(&other.text),
        };
        let rising = values.then(self.seq.cmp(&other.seq));
        let in_order = match rank(self) {
            2 => other.seq.cmp(&self.seq),
            _ if is_falling => rising.reverse(),
            _ => rising,
        };
        rank(self).cmp(&rank(other)).then(in_order)
    }

    /// As a page gives it to go on after.
    pub(super) fn cursor(&self) -> String {
        let seq = self.seq;
        match (self.number, &self.text) {
            (Some(number), _) => format!("n{number:?}_{seq}"),
            (None, Some(text)) => format!("t{}_{seq}", URL_SAFE_NO_PAD.encode(text)),
            (None, None) => format!("o_{seq}"),
        }
    }

    /// The key that a cursor was made of.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] for one that no sorted list gave.
    pub(super) fn of_cursor(cursor: &str) -> Result<Self> {
        let read = || {
            // the text may hold the sign, the number does not
            let (value, seq) = cursor.rsplit_once('_')?;
            let seq = seq.parse().ok()?;
            let (number, text) = match value.split_at_checked(1)? {
                ("n", number) => (number.parse().ok().filter(|of: &f64| of.is_finite()), None),
                ("t", text) => {
                    let bytes = URL_SAFE_NO_PAD.decode(text).ok()?;
                    (None, String::from_utf8(bytes).ok())
                }
                ("o", "") => {
                    return Some(Self {
                        number: None,
                        text: None,
                        seq,
                    });
                }
                _ => return None,
            };
            let key = Self { number, text, seq };
            (key.number.is_some() || key.text.is_some()).then_some(key)
        };
        read().ok_or_else(|| StoreError::Invalid("the cursor is not one of this order".to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(number: Option<f64>, text: Option<&str>, seq: i64) -> Key {
        let text = text.map(str::to_owned);
        Key { number, text, seq }
    }

    #[test]
    fn what_has_no_value_comes_last_either_way() {
        let keys = [
            key(None, None, 1),
            key(Some(2.0), None, 2),
            key(None, Some("b"), 3),
            key(Some(-1.0), None, 4),
            key(Some(2.0), None, 5),
            key(None, Some("a"), 6),
            key(None, None, 7),
        ];
        for (is_falling, expected) in [
            (false, [4, 2, 5, 6, 3, 7, 1]),
            (true, [5, 2, 4, 3, 6, 7, 1]),
        ] {
            let mut sorted = keys.clone();
            sorted.sort_unstable_by(|a, b| a.compare(b, is_falling));
            assert_eq!(sorted.map(|key| key.seq), expected);
        }
    }

    #[test]
    fn a_cursor_is_its_key_again() {
        for key in [
            key(Some(0.1 + 0.2), None, 7),
            key(Some(-1e-300), None, 1),
            key(None, Some("a_b \u{e9}"), i64::MAX),
            key(None, Some(""), 3),
            key(None, None, 4),
        ] {
            assert_eq!(Key::of_cursor(&key.cursor()).expect("a cursor"), key);
        }
        for wrong in [
            "", "7", "n_7", "nNaN_7", "ninf_7", "t*_7", "o_", "ox_1", "\u{e9}_1", "from-20",
        ] {
            assert!(Key::of_cursor(wrong).is_err(), "{wrong}");
        }
    }
}
