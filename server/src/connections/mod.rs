//! Connections: who may have one, and how long a client may keep the server waiting.
//!
//! Nothing here knows what a request asks. A connection is accepted by [`listen`], gets a place among
//! [`places`], is spoken to through a [`line`] that ends it when its client does not go on, and, where
//! the server has a certificate, through [`tls`]; `hyper` reads the requests and the router answers.
//!
//! A place belongs to a client only while the server has something to do for it. Where there is no
//! place left, of the address or in all, a new connection takes that of the one whose client has been
//! waited for longest: so however many connections are begun and left, others are answered.
mod descriptors;
mod limits;
mod line;
mod listen;
mod pace;
mod places;
mod standing;
mod tls;

pub use limits::ConnectionLimits;
pub use listen::Listening;
pub(crate) use places::client;
pub use tls::{Tls, TlsError, TlsFiles};
