//! Who may do what: pure functions of the caller, the action and the object.
//!
//! Every route of the service asks [`may`]; nothing else decides. The store tells who a secret
//! belongs to ([`Caller`]) and whose an object is ([`JobFacts`], [`ProjectFacts`]); lists and streams
//! are narrowed by a [`Sight`], which asks the same rule of every project. Neither a database nor a
//! request is known here.
//!
//! What a caller must not see is [`Verdict::Hidden`], and is answered like what is not there. What it
//! sees and must not do is [`Verdict::No`] with a sentence. Rules that look at the caller alone come
//! first, so that a refusal tells nothing of the object.
mod caller;
mod guesses;
mod object;
mod pace;
pub mod password;
mod rule;
mod sight;

pub use caller::{Caller, Credential, Identity, Link, Person};
pub use guesses::Guesses;
pub use object::{ComparisonFacts, DeletedFacts, JobFacts, ProjectFacts};
pub use pace::Pace;
pub(crate) use rule::ARCHIVED;
pub use rule::{Action, Object, Verdict, may};
pub use sight::{Sight, Whose};
