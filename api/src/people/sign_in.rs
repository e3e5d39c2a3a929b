//! How people sign in where they have no password here.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `GET /v1/sign-in`: how people can sign in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SignInWays {
    /// Whether this server has accounts.
    pub accounts: bool,
    /// Name of the provider of single sign-on, where there is one.
    pub provider: Option<String>,
}

/// `POST /v1/sign-in/provider`: a sign-in that has begun.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SignInBegun {
    /// Where the browser goes on.
    pub address: String,
}
