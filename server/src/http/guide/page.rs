//! Pages and their addresses.
use loadframe_api::JobKind;

use crate::http::sheet::Sheet;

/// The page that tells of several kinds; each of them has a section of its name there.
const BALLAST: &str = "ballast";

/// A page at its address.
#[derive(Debug)]
pub(super) struct Page {
    pub(super) address: String,
    pub(super) sheet: Sheet,
}

/// The address of the page on a kind.
pub(super) fn home_of(kind: JobKind) -> String {
    let name = kind.name();
    match name.starts_with("ballast_") {
        true => format!("/guide/{BALLAST}#{name}"),
        false => format!("/guide/{name}"),
    }
}
