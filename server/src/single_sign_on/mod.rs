//! Single sign-on: whom others vouch for.
//!
//! A provider of identities vouches by OpenID Connect ([`Provider`]): the browser is sent to it with a
//! [`Started`] sign-in in a sealed cookie, and comes back with a code. A proxy before the server vouches
//! by a header of each request, if it comes from an address that the [`Settings`] name. Who comes in, and
//! as what, is said there too. Neither accounts nor sessions are known here.
mod provider;
mod settings;
mod started;
mod vouched;

use std::net::IpAddr;
use std::path::Path;

use axum::http::HeaderMap;
use ipnet::IpNet;

pub use provider::{Provider, ProviderError, ProviderSettings};
pub use settings::{ProxySettings, Rule, Settings, SettingsError};
pub use started::{LONGEST, Seal, Started};
pub use vouched::Vouched;

use crate::store::people::Admission;

/// The issuer of identities that a proxy vouches for.
pub const PROXY: &str = "proxy";

/// Who vouches for people, ready to be asked.
#[derive(Debug)]
pub struct SingleSignOn {
    settings: Settings,
    provider: Option<Provider>,
    proxies: Vec<IpNet>,
    seal: Seal,
}

impl SingleSignOn {
    /// By the settings in a file.
    ///
    /// # Errors
    /// [`SettingsError`].
    pub fn read(path: &Path) -> Result<Self, SettingsError> {
        Self::new(Settings::read(path)?)
    }

    /// By settings.
    ///
    /// # Errors
    /// [`SettingsError`].
    pub fn new(settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let provider = settings.provider.clone().map(Provider::new).transpose();
        let proxies = settings.proxy.as_ref().map(ProxySettings::networks);
        Ok(Self {
            provider: provider.map_err(SettingsError::Provider)?,
            proxies: proxies.transpose()?.unwrap_or_default(),
            settings,
            seal: Seal::default(),
        })
    }

    pub fn provider(&self) -> Option<&Provider> {
        self.provider.as_ref()
    }

    pub fn seal(&self) -> &Seal {
        &self.seal
    }

    /// As what somebody without an account comes in, if at all.
    pub fn admission(&self, vouched: &Vouched) -> Option<Admission> {
        self.settings.admission(vouched)
    }

    /// Whom a request's headers vouch for; nobody where they do not come from the proxy.
    pub fn vouched_by_proxy(&self, peer: Option<IpAddr>, headers: &HeaderMap) -> Option<Vouched> {
        let proxy = self
            .settings
            .proxy
            .as_ref()
            .filter(|_| self.is_proxy(peer))?;
        let text = |name: &str| {
            let mut values = headers.get_all(name).iter();
            let value = values.next()?.to_str().ok()?.trim();
            // a header that stands there twice may be half the sender's own
            (!value.is_empty() && values.next().is_none()).then(|| value.to_owned())
        };
        let subject = text(&proxy.user_header)?;
        let groups = proxy
            .groups_header
            .as_deref()
            .and_then(text)
            .unwrap_or_default();
        Some(Vouched {
            issuer: PROXY.to_owned(),
            names: vec![subject.clone()],
            subject,
            email: proxy.email_header.as_deref().and_then(text),
            groups: groups.split(',').map(|of| of.trim().to_owned()).collect(),
        })
    }

    /// The address that a request came from: behind the proxy, the one that it says.
    pub fn client_address(&self, peer: Option<IpAddr>, headers: &HeaderMap) -> Option<IpAddr> {
        if !self.is_proxy(peer) {
            return peer;
        }
        // the last one is the proxy's own word, those before may be the sender's
        let mut lines = headers.get_all("x-forwarded-for").iter();
        let last = lines.next_back().and_then(|value| value.to_str().ok());
        let last = last.and_then(|text| text.rsplit(',').next()?.trim().parse().ok());
        last.or(peer)
    }

    fn is_proxy(&self, peer: Option<IpAddr>) -> bool {
        let peer = peer.map(|address| address.to_canonical());
        peer.is_some_and(|peer| self.proxies.iter().any(|network| network.contains(&peer)))
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn behind_a_proxy() -> SingleSignOn {
        let settings = json!({
            "proxy": { "addresses": ["10.0.0.0/24"], "email_header": "x-email", "groups_header": "x-groups" },
            "admit": [{ "everybody": true, "role": "member" }],
        });
        SingleSignOn::new(serde_json::from_value(settings).expect("settings"))
            .expect("good settings")
    }

    fn headers(given: &[(&'static str, &str)]) -> HeaderMap {
        let pair = |(name, value): &(&'static str, &str)| {
            (
                axum::http::HeaderName::from_static(name),
                value.parse().expect("a header"),
            )
        };
        let mut headers = HeaderMap::new();
        given.iter().map(pair).for_each(|(name, value)| {
            headers.append(name, value);
        });
        headers
    }

    #[test]
    fn a_header_says_something_only_if_the_proxy_sent_it() {
        let sign_on = behind_a_proxy();
        let given = headers(&[
            ("x-forwarded-user", "anna"),
            ("x-email", "a@b.c"),
            ("x-groups", "x, y"),
        ]);
        let by =
            |peer: &str| sign_on.vouched_by_proxy(Some(peer.parse().expect("an address")), &given);
        let anna = by("10.0.0.9").expect("anna");
        assert_eq!((anna.subject.as_str(), anna.groups.len()), ("anna", 2));
        assert_eq!(by("::ffff:10.0.0.9"), Some(anna));
        assert_eq!(by("10.0.1.9"), None);
        assert_eq!(by("127.0.0.1"), None);
        assert_eq!(sign_on.vouched_by_proxy(None, &given), None);
        let twice = headers(&[("x-forwarded-user", "anna"), ("x-forwarded-user", "ada")]);
        let peer = Some([10, 0, 0, 9].into());
        assert_eq!(sign_on.vouched_by_proxy(peer, &twice), None);
        assert_eq!(
            sign_on.vouched_by_proxy(peer, &headers(&[("x-forwarded-user", " ")])),
            None
        );
    }

    #[test]
    fn the_clients_address_is_the_proxys_own_word() {
        let sign_on = behind_a_proxy();
        let of = |peer: [u8; 4], line: &str| {
            let given = headers(&[("x-forwarded-for", line)]);
            sign_on
                .client_address(Some(peer.into()), &given)
                .map(|of| of.to_string())
        };
        assert_eq!(
            of([10, 0, 0, 9], "6.6.6.6, 192.0.2.7").as_deref(),
            Some("192.0.2.7")
        );
        assert_eq!(of([10, 0, 0, 9], "nonsense").as_deref(), Some("10.0.0.9"));
        assert_eq!(of([192, 0, 2, 1], "6.6.6.6").as_deref(), Some("192.0.2.1"));
    }
}
