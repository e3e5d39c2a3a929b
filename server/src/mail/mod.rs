//! E-mail to people: what their outbox holds, handed to the SMTP server of the house.
//!
//! What is told, when it is tried again and when it is given up is the store's, as for webhooks. Here is
//! only the way: [`settings`] say which server, [`message`] what is written. Nothing is sent to an address
//! but the link that verifies it until that was followed.
mod message;
mod settings;

use std::time::Duration;

use lettre::message::header::{ContentType, HeaderName, HeaderValue};
use lettre::transport::smtp::authentication::Credentials;
use lettre::transport::smtp::client::{Certificate, Tls, TlsParameters};
use lettre::{AsyncSmtpTransport, AsyncTransport, Message, Tokio1Executor};

pub use settings::{MailSettings, MailSettingsError, Security};

use crate::store::people::Due;

/// The server answers each step in this time, or not,
const PATIENCE: Duration = Duration::from_secs(20);
/// and has taken the e-mail in this, or not.
const LONGEST: Duration = Duration::from_secs(60);
/// So much of what it says of a refusal is kept [characters].
const KEPT: usize = 400;

/// Sends e-mail.
#[derive(Clone, Debug)]
pub struct Mailer {
    transport: AsyncSmtpTransport<Tokio1Executor>,
    from: lettre::message::Mailbox,
    /// With a slash at its end.
    address: String,
}

/// Why no e-mail can be sent.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MailError {
    #[error(transparent)]
    Settings(#[from] MailSettingsError),
    #[error("TLS cannot be spoken")]
    Tls(#[source] lettre::transport::smtp::Error),
}

/// Why an e-mail was not taken.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SendError {
    #[error("this is no address of e-mail")]
    Address(#[from] lettre::address::AddressError),
    #[error("the e-mail cannot be written: {0}")]
    Message(#[from] lettre::error::Error),
    #[error("the mail server did not take it: {0}")]
    Refused(String),
    #[error("the mail server did not take it within {0} s")]
    Silent(u64),
}

impl Mailer {
    /// The way that the settings name.
    ///
    /// # Errors
    /// For files that cannot be read, and certificates that are none.
    pub fn new(settings: &MailSettings) -> Result<Self, MailError> {
        let (host, port) = settings.host_and_port()?;
        let tls = || -> Result<TlsParameters, MailError> {
            let mut tls = TlsParameters::builder(host.to_owned());
            if let Some(path) = &settings.ca_file {
                let text = settings::text_of(path)?;
                let certificate = Certificate::from_pem(text.as_bytes()).map_err(MailError::Tls)?;
                tls = tls.add_root_certificate(certificate);
            }
            tls.build_rustls().map_err(MailError::Tls)
        };
        let tls = match settings.security {
            Security::Starttls => Tls::Required(tls()?),
            Security::Tls => Tls::Wrapper(tls()?),
            Security::None => Tls::None,
        };
        let mut transport = AsyncSmtpTransport::<Tokio1Executor>::builder_dangerous(host)
            .port(port)
            .tls(tls)
            .timeout(Some(PATIENCE));
        if let (Some(user), Some(path)) = (&settings.user, &settings.password_file) {
            let password = settings::text_of(path)?;
            let password = password.trim_end_matches(['\r', '\n']).to_owned();
            transport = transport.credentials(Credentials::new(user.clone(), password));
        }
        let address = settings.address.as_str().trim_end_matches('/');
        Ok(Self {
            transport: transport.build(),
            from: settings.sender()?,
            address: format!("{address}/"),
        })
    }

    /// Hands over what is due.
    pub(crate) async fn send(&self, due: &Due) -> Result<(), SendError> {
        let written = match due.is_question() {
            true => message::verification(due, &self.address),
            false => message::digest(due, &self.address),
        };
        let to: lettre::Address = due.address.parse()?;
        // nobody's absence is to answer it (RFC 3834)
        let generated = HeaderValue::new(
            HeaderName::new_from_ascii_str("Auto-Submitted"),
            "auto-generated".to_owned(),
        );
        let message = Message::builder()
            .from(self.from.clone())
            .to(to.into())
            .subject(written.subject)
            .raw_header(generated)
            .header(ContentType::TEXT_PLAIN)
            .body(written.text)?;
        let sent = tokio::time::timeout(LONGEST, self.transport.send(message)).await;
        let sent = sent.map_err(|_| SendError::Silent(LONGEST.as_secs()))?;
        sent.map(drop)
            .map_err(|error| SendError::Refused(told(&error, &due.secret)))
    }
}

/// What the server says of a refusal. A filter of unwanted e-mail may repeat the link that it disliked, which
/// nobody but the reader of the address is to see.
fn told(error: &lettre::transport::smtp::Error, secret: &str) -> String {
    let causes = std::iter::successors(Some(error as &dyn std::error::Error), |error| {
        error.source()
    });
    let causes: Vec<String> = causes.map(ToString::to_string).collect();
    let said = causes.join(": ").replace(secret, "…");
    said.chars().take(KEPT).collect()
}

/// Whether this is an address of e-mail that something can be sent to.
pub(crate) fn is_address(text: &str) -> bool {
    // one without a dot in its domain is of this machine alone
    let has_domain = text
        .rsplit_once('@')
        .is_some_and(|(_, domain)| domain.contains('.'));
    has_domain && text.parse::<lettre::Address>().is_ok()
}
