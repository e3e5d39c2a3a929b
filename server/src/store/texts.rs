//! What is searched for in names, notes and tags of jobs: any part of them, in letters of any size, or the
//! beginning of an id.
//!
//! An index leads from any three neighbouring characters to their jobs. Shorter texts, and what the index of a
//! database cannot decide by itself, are looked for in the jobs. Texts of new jobs come into the index of some
//! databases by [`Store::index_texts`], many at a time.
use uuid::Uuid;

use super::Store;
use super::database::{Builder, Texts, query, query_scalar};
use super::error::Result;

/// Texts are found by any three neighbouring characters of theirs; shorter ones by looking at all.
const SHORTEST_FOUND: usize = 3;
/// So many hexadecimal digits may begin an id: fewer are those of the moment, which many share.
const SHORTEST_ID: usize = 8;

/// What is searched for.
pub(super) struct Text {
    /// As typed: letters are made small where those of the jobs are, and in the same way (of `İ` a database may
    /// make one letter, Rust makes two).
    typed: String,
    /// Whether the index of texts leads to it.
    is_found: bool,
    /// First and last id that begin so, if enough of it is given.
    ids: Option<[Uuid; 2]>,
    /// Whether those that the index leads to are few enough to be all looked up at once.
    is_rare: bool,
    texts: &'static Texts,
}

impl Text {
    pub(super) fn of(typed: &str, texts: &'static Texts) -> Self {
        let typed = typed.to_owned();
        // a text of the database's index ends at its first zero
        let is_found = typed.chars().count() >= SHORTEST_FOUND && !typed.contains('\0');
        Self {
            is_found,
            ids: ids_beginning_with(&typed),
            typed,
            is_rare: false,
            texts,
        }
    }

    /// Whether what the index leads to is all that holds the text, and nothing else.
    pub(super) fn is_decided(&self) -> bool {
        self.texts.index_decides
    }

    /// The statement for a row of each job that the index leads to.
    pub(super) fn rows_found(&self) -> Option<Builder> {
        self.is_indexed().then(|| {
            let mut query = Builder::new("SELECT 1 FROM job_texts t WHERE ");
            self.push_found(&mut query);
            query
        })
    }

    /// Has it looked for in the jobs, when not all of them are in the index.
    pub(super) fn look_at_all(&mut self) {
        self.is_found = false;
    }

    /// Has all that the index leads to looked up at once from now on.
    pub(super) fn set_rare(&mut self) {
        self.is_rare = true;
    }

    pub(super) fn is_rare(&self) -> bool {
        self.is_rare
    }

    /// Whether walking the index of texts finds all of it.
    pub(super) fn is_indexed(&self) -> bool {
        self.is_found && self.ids.is_none()
    }

    /// The column of the index with the numbers of jobs.
    pub(super) fn number(&self) -> &'static str {
        self.texts.number_of_text
    }

    /// The tables `j` of jobs and `t` of the index, walked by the index, and the condition on both.
    pub(super) fn push_walk(&self, query: &mut Builder) {
        // CROSS: in this order
        query.push("job_texts t CROSS JOIN jobs j WHERE j.seq = ");
        query.push(self.number()).push(" AND ");
        self.push_found(query);
        if !self.texts.index_decides {
            self.push_held(query);
        }
    }

    /// The condition on a job that is at hand.
    pub(super) fn push(&self, query: &mut Builder) {
        let number = self.number();
        match (self.is_found, self.ids) {
            // what reads like an id is in few texts
            (true, Some([first, last])) => {
                query.push(format!(
                    " AND j.seq IN (SELECT {number} FROM job_texts t WHERE "
                ));
                self.push_found(query);
                query.push(" UNION SELECT seq FROM jobs WHERE id BETWEEN ");
                query.push_bind(first).push(" AND ");
                query.push_bind(last).push(")");
            }
            (true, None) if self.texts.index_decides => {
                query.push(" AND EXISTS (SELECT 1 FROM job_texts t WHERE ");
                query.push(format!("{number} = j.seq AND "));
                self.push_found(query);
                query.push(")");
            }
            _ => {}
        }
        if !(self.is_found && self.texts.index_decides) {
            self.push_held(query);
        }
    }

    /// The same where very many jobs `n.seq` are at hand. The index is slow to be asked for one after the other:
    /// what is rare, or has letters with accents, is looked up in it once, all else looked for in the job itself.
    pub(super) fn push_among_many(&self, query: &mut Builder) {
        if !self.is_indexed() {
            self.push(query);
            return;
        }
        let is_sought = self.is_rare || (self.is_decided() && !self.typed.is_ascii());
        if is_sought {
            // before the job itself is read
            let number = self.number();
            query.push(format!(
                " AND n.seq IN (SELECT {number} FROM job_texts t WHERE "
            ));
            self.push_found(query);
            query.push(")");
        }
        if !is_sought || !self.is_decided() {
            self.push_held(query);
        }
    }

    /// What the index says.
    fn push_found(&self, query: &mut Builder) {
        let [before, after] = self.texts.text_found;
        query.push(before).push_bind(self.typed.clone()).push(after);
    }

    /// What the job itself says.
    fn push_held(&self, query: &mut Builder) {
        query.push(" AND (FALSE");
        if let Some([first, last]) = self.ids {
            query.push(" OR j.id BETWEEN ").push_bind(first);
            query.push(" AND ").push_bind(last);
        }
        let folded = self.texts.folded;
        for column in ["j.name", "j.notes", "j.tags"] {
            query.push(format!(" OR instr({folded}({column}), {folded}("));
            query.push_bind(self.typed.clone()).push(")) > 0");
        }
        query.push(")");
    }
}

impl Store {
    /// Takes texts of new jobs into the index; whoever searches does so before.
    ///
    /// # Errors
    /// The database's.
    pub(super) async fn index_texts(&self) -> Result<()> {
        let Some(new) = self.reads().texts().new_texts else {
            return Ok(());
        };
        loop {
            let are_there: bool = query_scalar(new.are_there)
                .fetch_one(self.lookups())
                .await?;
            if !are_there {
                return Ok(());
            }
            self.write_from_reserve(move |change| {
                Box::pin(async move {
                    query(new.index_some)
                        .execute(&mut change.connection)
                        .await?;
                    Ok(())
                })
            })
            .await?;
        }
    }
}

/// The first and the last id that begin with these digits, with or without hyphens.
fn ids_beginning_with(typed: &str) -> Option<[Uuid; 2]> {
    let digits = typed.replace('-', "");
    let is_one = (SHORTEST_ID..=32).contains(&digits.len())
        && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !is_one {
        return None;
    }
    let id = |fill: &str| {
        let rest = fill.repeat(32 - digits.len());
        Uuid::try_parse(&format!("{digits}{rest}")).ok()
    };
    id("0").zip(id("f")).map(|(first, last)| [first, last])
}

#[cfg(test)]
mod tests {
    use super::super::database::TEXTS;
    use super::*;

    #[test]
    fn ids_are_known_by_eight_digits_or_more() {
        let [first, last] = ids_beginning_with("0192-abcd").expect("eight digits");
        assert_eq!(first.to_string(), "0192abcd-0000-0000-0000-000000000000");
        assert_eq!(last.to_string(), "0192abcd-ffff-ffff-ffff-ffffffffffff");
        let whole = "0192abcd-0000-7000-8000-00000000000a";
        let [first, last] = ids_beginning_with(whole).expect("a whole id");
        assert_eq!((first.to_string(), first), (whole.to_owned(), last));
        for no_id in ["0192abc", "series 192abcdef", "", &"0".repeat(33)] {
            assert!(ids_beginning_with(no_id).is_none(), "{no_id}");
        }
    }

    #[test]
    fn the_index_leads_to_three_characters_or_more() {
        let is_indexed = |typed: &str| Text::of(typed, &TEXTS).is_indexed();
        for (typed, expected) in [
            ("Wet\" OR \"dry", true),
            ("äöü", true),
            ("äö", false),
            ("ab\0c", false),
            // an id, which is no text
            ("0192abcd", false),
        ] {
            assert_eq!(is_indexed(typed), expected, "{typed:?}");
        }
    }
}
