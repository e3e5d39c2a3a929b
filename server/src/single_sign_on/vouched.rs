//! What an issuer says of somebody.
use serde_json::Value;

use crate::store::people::Identity;

/// Somebody as the issuer vouches for them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Vouched {
    pub issuer: String,
    /// What the issuer calls them, for ever.
    pub subject: String,
    /// Names for an account, the best first.
    pub names: Vec<String>,
    /// An address that the issuer has verified.
    pub email: Option<String>,
    pub groups: Vec<String>,
}

impl Vouched {
    /// By the claims of a token, and of what its issuer adds on being asked.
    pub(super) fn by_claims(
        issuer: &str,
        subject: &str,
        claims: &[Value],
        groups_claim: &str,
    ) -> Self {
        let text = |name: &str| {
            let found = claims.iter().find_map(|of| of.get(name)?.as_str());
            found.filter(|text| !text.is_empty()).map(str::to_owned)
        };
        // an address counts only with the word that it is verified, from the same source
        let email = claims.iter().find_map(|of| {
            let is_verified = of.get("email_verified") == Some(&Value::Bool(true));
            of.get("email")?.as_str().filter(|_| is_verified)
        });
        let groups = claims
            .iter()
            .find_map(|of| of.get(groups_claim)?.as_array());
        let groups = groups.into_iter().flatten().filter_map(Value::as_str);
        Self {
            issuer: issuer.to_owned(),
            subject: subject.to_owned(),
            names: ["name", "preferred_username", "email"]
                .iter()
                .filter_map(|name| text(name))
                .collect(),
            email: email.map(str::to_owned),
            groups: groups.map(str::to_owned).collect(),
        }
    }

    /// For the store.
    pub fn identity(&self) -> Identity {
        Identity {
            issuer: self.issuer.clone(),
            subject: self.subject.clone(),
            names: self.names.clone(),
            email: self.email.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_address_that_is_not_verified_is_a_name_at_most() {
        let of = |claims: Value| Vouched::by_claims("https://i", "1", &[claims], "groups");
        let anna = of(
            json!({ "name": "Anna", "email": "anna@example.org", "email_verified": true, "groups": ["a", 3] }),
        );
        assert_eq!(anna.names, ["Anna", "anna@example.org"]);
        assert_eq!(anna.email.as_deref(), Some("anna@example.org"));
        assert_eq!(anna.groups, ["a"]);
        for is_verified in [json!(false), json!("true"), json!(null)] {
            let claims = json!({ "email": "anna@example.org", "email_verified": is_verified });
            assert_eq!(of(claims).email, None);
        }
    }
}
