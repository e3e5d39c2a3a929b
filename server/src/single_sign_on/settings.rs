//! What `--single-sign-on FILE` says.
use std::net::IpAddr;
use std::path::Path;

use ipnet::IpNet;
use loadframe_api::people::Role;
use serde::Deserialize;
use url::Url;

use super::{ProviderError, ProviderSettings, Vouched};
use crate::store::people::Admission;

/// Who vouches, and who comes in.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// A provider of OpenID Connect.
    #[serde(default)]
    pub provider: Option<ProviderSettings>,
    /// A proxy that has signed people in.
    #[serde(default)]
    pub proxy: Option<ProxySettings>,
    /// Who gets an account without an invitation; the first that fits holds.
    #[serde(default)]
    pub admit: Vec<Rule>,
}

/// A proxy that says in a header who sends a request.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProxySettings {
    /// Addresses or networks it speaks from; from all others the headers say nothing.
    pub addresses: Vec<String>,
    /// Header with the name that is the person's for ever.
    #[serde(default = "usual_header")]
    pub user_header: String,
    /// Header with the e-mail address, where there is one.
    #[serde(default)]
    pub email_header: Option<String>,
    /// Header with the groups, between commas, where there is one.
    #[serde(default)]
    pub groups_header: Option<String>,
}

/// Who gets an account, by one of the first three, and what kind of.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rule {
    /// The part behind `@` of a verified address.
    #[serde(default)]
    pub email_domain: Option<String>,
    /// A group of the provider or the proxy.
    #[serde(default)]
    pub group: Option<String>,
    /// Everybody who can sign in there.
    #[serde(default)]
    pub everybody: bool,
    pub role: Role,
    /// Groups here that the person will be in.
    #[serde(default)]
    pub joins: Vec<String>,
}

fn usual_header() -> String {
    "x-forwarded-user".to_owned()
}

/// Why the settings cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    #[error("{path} cannot be read")]
    File {
        path: String,
        #[source]
        source: std::io::Error,
    },
    #[error("{path} is not as it should be")]
    Json {
        path: String,
        #[source]
        source: serde_json::Error,
    },
    #[error("the provider cannot be asked")]
    Provider(#[source] ProviderError),
    #[error("{field} is {value:?}: {allowed}")]
    Field {
        field: String,
        value: String,
        allowed: &'static str,
    },
}

fn wrong(field: impl Into<String>, value: impl ToString, allowed: &'static str) -> SettingsError {
    SettingsError::Field {
        field: field.into(),
        value: value.to_string(),
        allowed,
    }
}

impl Settings {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`SettingsError`] names the field, its value and what is allowed.
    pub fn read(path: &Path) -> Result<Self, SettingsError> {
        let name = || path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| SettingsError::File {
            path: name(),
            source,
        })?;
        let settings: Self = serde_json::from_str(&text).map_err(|source| SettingsError::Json {
            path: name(),
            source,
        })?;
        settings.check()?;
        Ok(settings)
    }

    /// Checks what the types leave open.
    ///
    /// # Errors
    /// [`SettingsError::Field`].
    pub fn check(&self) -> Result<(), SettingsError> {
        if self.provider.is_none() && self.proxy.is_none() {
            return Err(wrong(
                "provider",
                "",
                "a provider, a proxy or both are needed",
            ));
        }
        if let Some(provider) = &self.provider {
            check_provider(provider)?;
        }
        if let Some(proxy) = &self.proxy {
            proxy.networks()?;
            let headers = [
                Some(&proxy.user_header),
                proxy.email_header.as_ref(),
                proxy.groups_header.as_ref(),
            ];
            for header in headers.into_iter().flatten() {
                axum::http::HeaderName::try_from(header.as_str()).map_err(|_| {
                    wrong("proxy.user_header", header, "the name of a header of HTTP")
                })?;
            }
        }
        for (index, rule) in self.admit.iter().enumerate() {
            let given = [
                rule.email_domain.is_some(),
                rule.group.is_some(),
                rule.everybody,
            ];
            if given.into_iter().filter(|is_given| *is_given).count() != 1 {
                let allowed = "a rule has one of email_domain, group and everybody";
                return Err(wrong(format!("admit[{index}]"), "", allowed));
            }
            let domain = rule.email_domain.as_deref();
            if let Some(domain) = domain.filter(|of| of.contains('@') || !of.contains('.')) {
                let allowed = "the part of an address behind @, such as example.org";
                return Err(wrong(
                    format!("admit[{index}].email_domain"),
                    domain,
                    allowed,
                ));
            }
        }
        Ok(())
    }

    /// As what somebody without an account comes in, if at all.
    pub fn admission(&self, vouched: &Vouched) -> Option<Admission> {
        let rule = self.admit.iter().find(|rule| rule.fits(vouched))?;
        Some(Admission {
            role: rule.role,
            groups: rule.joins.clone(),
        })
    }
}

impl Rule {
    fn fits(&self, vouched: &Vouched) -> bool {
        let domain = vouched
            .email
            .as_deref()
            .and_then(|email| email.rsplit_once('@'));
        let is_of =
            |allowed: &String| domain.is_some_and(|(_, of)| of.eq_ignore_ascii_case(allowed));
        self.everybody
            || self.email_domain.as_ref().is_some_and(is_of)
            || self
                .group
                .as_ref()
                .is_some_and(|group| vouched.groups.contains(group))
    }
}

impl ProxySettings {
    /// Where the proxy speaks from.
    ///
    /// # Errors
    /// [`SettingsError::Field`] for what is no address or network.
    pub fn networks(&self) -> Result<Vec<IpNet>, SettingsError> {
        let network = |text: &String| {
            let address = text.parse::<IpAddr>().map(IpNet::from);
            address.or_else(|_| text.parse::<IpNet>())
        };
        let read = |text: &String| {
            let allowed = "an address or a network, such as 10.0.0.7 or 10.0.0.0/24";
            network(text).map_err(|_| wrong("proxy.addresses", text, allowed))
        };
        if self.addresses.is_empty() {
            return Err(wrong("proxy.addresses", "", "at least one address"));
        }
        self.addresses.iter().map(read).collect()
    }
}

fn check_provider(provider: &ProviderSettings) -> Result<(), SettingsError> {
    let allowed = "an address of https, or of http on this machine";
    let issuer = Url::parse(&provider.issuer)
        .map_err(|_| wrong("provider.issuer", &provider.issuer, allowed))?;
    for (field, address) in [
        ("provider.issuer", &issuer),
        ("provider.address", &provider.address),
    ] {
        let is_here = matches!(
            address.host_str(),
            Some("localhost" | "127.0.0.1" | "[::1]")
        );
        if address.scheme() != "https" && !(address.scheme() == "http" && is_here) {
            return Err(wrong(field, address, allowed));
        }
    }
    if provider.address.path() != "/" {
        return Err(wrong(
            "provider.address",
            &provider.address,
            "an address without a path",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn read(settings: &Value) -> Result<Settings, String> {
        let settings: Settings =
            serde_json::from_value(settings.clone()).map_err(|error| error.to_string())?;
        settings.check().map_err(|error| error.to_string())?;
        Ok(settings)
    }

    fn good() -> Value {
        json!({
            "provider": { "name": "University", "issuer": "https://login.example.org", "client_id": "lab",
                "address": "https://lab.example.org" },
            "proxy": { "addresses": ["10.0.0.7", "fd00::/8"] },
            "admit": [{ "group": "heads", "role": "administrator" },
                { "email_domain": "example.org", "role": "member", "joins": ["Paper"] }],
        })
    }

    #[test]
    fn what_cannot_be_is_named() {
        read(&good()).expect("good settings");
        for (pointer, value, said) in [
            (
                "/provider/issuer",
                json!("http://login.example.org"),
                "provider.issuer is",
            ),
            (
                "/provider/address",
                json!("https://lab.example.org/a"),
                "without a path",
            ),
            (
                "/proxy/addresses",
                json!(["10.0.0.0/33"]),
                "proxy.addresses is \"10.0.0.0/33\"",
            ),
            ("/proxy/addresses", json!([]), "at least one address"),
            ("/admit/0/everybody", json!(true), "admit[0]"),
            (
                "/admit/1/email_domain",
                json!("@example.org"),
                "admit[1].email_domain",
            ),
            ("/admit/1/role", json!("king"), "unknown variant `king`"),
        ] {
            let mut settings = good();
            match settings.pointer_mut(pointer) {
                Some(field) => *field = value,
                None => settings["admit"][0]["everybody"] = value,
            }
            let refused = read(&settings).expect_err(pointer);
            assert!(refused.contains(said), "{refused}");
        }
        assert!(
            read(&json!({}))
                .expect_err("nothing")
                .contains("a provider, a proxy")
        );
    }

    #[test]
    fn the_first_rule_that_fits_holds() {
        let settings = read(&good()).expect("good settings");
        let admission = |email: Option<&str>, groups: &[&str]| {
            let vouched = Vouched {
                email: email.map(str::to_owned),
                groups: groups.iter().map(|of| (*of).to_owned()).collect(),
                ..Vouched::default()
            };
            settings.admission(&vouched)
        };
        let anna = admission(Some("anna@Example.org"), &[]).expect("a member");
        assert_eq!(
            (anna.role, anna.groups),
            (Role::Member, vec!["Paper".to_owned()])
        );
        let head = admission(Some("anna@example.org"), &["heads"]).expect("an administrator");
        assert_eq!(head.role, Role::Administrator);
        for email in [
            "anna@evil.example",
            "anna@notexample.org",
            "anna@example.org.evil.example",
        ] {
            assert_eq!(admission(Some(email), &["head"]), None, "{email}");
        }
        assert_eq!(admission(None, &[]), None);
    }
}
