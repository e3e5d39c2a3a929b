//! A provider of OpenID Connect: authorisation code with PKCE, state and nonce.
//!
//! Its metadata and keys are fetched when first needed, again after an hour, and at once when a token is
//! signed by a key that is not known: providers change their keys. Tokens are taken only with a signature
//! by a public key, from this issuer, for this client, in time and with the nonce of their sign-in.
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use loadframe_api::Timestamp;
use openidconnect::core::{
    CoreAuthDisplay, CoreAuthPrompt, CoreClientAuthMethod, CoreErrorResponseType, CoreGenderClaim,
    CoreJsonWebKey, CoreJweContentEncryptionAlgorithm, CoreJwsSigningAlgorithm,
    CoreProviderMetadata, CoreResponseType, CoreRevocableToken, CoreRevocationErrorResponse,
    CoreTokenIntrospectionResponse, CoreTokenType,
};
use openidconnect::{
    AdditionalClaims, AuthType, AuthenticationFlow, AuthorizationCode, ClaimsVerificationError,
    ClientId, ClientSecret, CsrfToken, EmptyExtraTokenFields, EndpointMaybeSet, EndpointNotSet,
    EndpointSet, HttpRequest, HttpResponse, IdTokenFields, IssuerUrl, Nonce, OAuth2TokenResponse,
    PkceCodeChallenge, PkceCodeVerifier, RedirectUrl, Scope, StandardErrorResponse,
    StandardTokenResponse, TokenResponse, UserInfoClaims,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use tokio::sync::Mutex;
use url::Url;
use uuid::Uuid;

use super::{Started, Vouched};

/// Metadata and keys are fetched again after this,
const FRESH: Duration = Duration::from_secs(3600);
/// and for an unknown key not more often than this.
const KEYS_AT_MOST_EVERY: Duration = Duration::from_secs(1);
/// The provider answers in this time, or not.
const PATIENCE: Duration = Duration::from_secs(10);
/// Longest answer of a provider [bytes].
const LONGEST_ANSWER: usize = 1 << 20;

/// All claims beyond those that the standard names.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Others {
    #[serde(flatten)]
    claims: Map<String, Value>,
}

impl AdditionalClaims for Others {}

type Fields = IdTokenFields<
    Others,
    EmptyExtraTokenFields,
    CoreGenderClaim,
    CoreJweContentEncryptionAlgorithm,
    CoreJwsSigningAlgorithm,
>;

type Tokens = StandardTokenResponse<Fields, CoreTokenType>;

/// What can be asked of a provider whose metadata are known.
type Client = openidconnect::Client<
    Others,
    CoreAuthDisplay,
    CoreGenderClaim,
    CoreJweContentEncryptionAlgorithm,
    CoreJsonWebKey,
    CoreAuthPrompt,
    StandardErrorResponse<CoreErrorResponseType>,
    Tokens,
    CoreTokenIntrospectionResponse,
    CoreRevocableToken,
    CoreRevocationErrorResponse,
    EndpointSet,
    EndpointNotSet,
    EndpointNotSet,
    EndpointNotSet,
    EndpointMaybeSet,
    EndpointMaybeSet,
>;

/// A provider, and how this server is known to it.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProviderSettings {
    /// What people call it.
    pub name: String,
    /// Its address, letter by letter as its tokens name it.
    pub issuer: String,
    pub client_id: String,
    /// File that holds the client's secret; without one the client is public.
    #[serde(default)]
    pub client_secret_file: Option<PathBuf>,
    /// Address of this server, as browsers see it.
    pub address: Url,
    /// What is asked for besides `openid`.
    #[serde(default = "usual_scopes")]
    pub scopes: Vec<String>,
    /// The claim that lists somebody's groups there.
    #[serde(default = "usual_claim")]
    pub groups_claim: String,
}

fn usual_scopes() -> Vec<String> {
    vec!["profile".to_owned(), "email".to_owned()]
}

fn usual_claim() -> String {
    "groups".to_owned()
}

impl ProviderSettings {
    /// Where the provider sends browsers back to.
    pub fn return_address(&self) -> String {
        format!("{}v1/sign-in/provider", self.address)
    }
}

/// Why a provider could not be asked, or is not believed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProviderError {
    #[error("the client's secret in {path} cannot be read")]
    Secret {
        path: String,
        #[source]
        source: std::io::Error,
    },
    #[error("the address {0:?} cannot be used")]
    Address(String),
    #[error("no connection can be made")]
    Client(#[source] reqwest::Error),
    #[error("the provider at {issuer} cannot be asked ({what}): {reason}")]
    Unreachable {
        issuer: String,
        what: &'static str,
        reason: String,
    },
    #[error("the token of the provider is not believed")]
    Token(#[source] ClaimsVerificationError),
    #[error("the provider gave no token of OpenID Connect")]
    NoToken,
}

/// An answer that did not come.
#[derive(Debug, thiserror::Error)]
enum CarryError {
    #[error("{0}")]
    Http(String),
    #[error("the answer is longer than {LONGEST_ANSWER} bytes")]
    Long,
}

#[derive(Debug)]
struct Known {
    since: Instant,
    metadata: CoreProviderMetadata,
}

/// A provider, and what is known of it.
#[derive(Debug)]
pub struct Provider {
    settings: ProviderSettings,
    secret: Option<ClientSecret>,
    issuer: IssuerUrl,
    redirect: RedirectUrl,
    http: reqwest::Client,
    known: Mutex<Option<Arc<Known>>>,
}

impl Provider {
    /// By its settings; asks nothing yet, so that a server starts while its provider is away.
    ///
    /// # Errors
    /// A secret that cannot be read, an address that is none.
    pub fn new(settings: ProviderSettings) -> Result<Self, ProviderError> {
        let read = |path: &std::path::PathBuf| {
            let text = std::fs::read_to_string(path).map_err(|source| ProviderError::Secret {
                path: path.display().to_string(),
                source,
            })?;
            Ok(ClientSecret::new(text.trim().to_owned()))
        };
        let secret = settings.client_secret_file.as_ref().map(read).transpose()?;
        let issuer = settings.issuer.as_str();
        let unusable = |address: &str| ProviderError::Address(address.to_owned());
        let issuer = IssuerUrl::new(issuer.to_owned()).map_err(|_| unusable(issuer))?;
        let redirect = settings.return_address();
        let redirect = RedirectUrl::new(redirect.clone()).map_err(|_| unusable(&redirect))?;
        // a second installation finds the first
        let _ = rustls::crypto::ring::default_provider().install_default();
        let http = reqwest::Client::builder()
            .timeout(PATIENCE)
            // an endpoint that leads elsewhere could lead into the house
            .redirect(reqwest::redirect::Policy::none())
            .user_agent(concat!("loadframe/", env!("CARGO_PKG_VERSION")));
        // the machine's own certificates take a moment to read, and some machines have none
        let http = match settings.issuer.starts_with("http://") {
            true => http.tls_certs_only([]),
            false => http,
        };
        Ok(Self {
            http: http.build().map_err(ProviderError::Client)?,
            secret,
            issuer,
            redirect,
            settings,
            known: Mutex::default(),
        })
    }

    /// What people call it.
    pub fn name(&self) -> &str {
        &self.settings.name
    }

    /// Whether browsers reach this server over TLS.
    pub fn is_secure(&self) -> bool {
        self.settings.address.scheme() == "https"
    }

    /// Whether an answer that names its issuer (RFC 9207) names this one.
    pub fn is_issuer(&self, issuer: &str) -> bool {
        issuer == self.issuer.as_str()
    }

    /// Begins a sign-in: where the browser goes, and what it keeps until it comes back.
    ///
    /// # Errors
    /// [`ProviderError`] where the provider cannot be asked.
    pub async fn begin(&self, person: Option<Uuid>) -> Result<(String, Started), ProviderError> {
        let known = self.known(FRESH).await?;
        let client = self.client(&known);
        let (challenge, verifier) = PkceCodeChallenge::new_random_sha256();
        let flow = AuthenticationFlow::<CoreResponseType>::AuthorizationCode;
        let mut request = client.authorize_url(flow, CsrfToken::new_random, Nonce::new_random);
        for scope in &self.settings.scopes {
            request = request.add_scope(Scope::new(scope.clone()));
        }
        let (address, state, nonce) = request.set_pkce_challenge(challenge).url();
        let started = Started {
            state: state.into_secret(),
            nonce: nonce.secret().clone(),
            verifier: verifier.into_secret(),
            person,
            since: Timestamp::now().as_millis(),
        };
        Ok((address.into(), started))
    }

    /// Ends a sign-in with the code that the browser brought: whom the provider vouches for.
    ///
    /// # Errors
    /// [`ProviderError`] where the provider cannot be asked or its token is not believed.
    pub async fn end(&self, code: String, started: &Started) -> Result<Vouched, ProviderError> {
        let mut known = self.known(FRESH).await?;
        let mut client = self.client(&known);
        let carry = |request| carry(self.http.clone(), request);
        let tokens: Tokens = client
            .exchange_code(AuthorizationCode::new(code))
            .map_err(|error| self.unreachable("token", &error))?
            .set_pkce_verifier(PkceCodeVerifier::new(started.verifier.clone()))
            .request_async(&carry)
            .await
            .map_err(|error| self.unreachable("token", &error))?;
        let token = tokens.id_token().ok_or(ProviderError::NoToken)?;
        let nonce = Nonce::new(started.nonce.clone());
        let mut claims = token.claims(&verifier(&client), &nonce);
        if let Err(ClaimsVerificationError::SignatureVerification(_)) = claims {
            known = self.known(KEYS_AT_MOST_EVERY).await?;
            client = self.client(&known);
            claims = token.claims(&verifier(&client), &nonce);
        }
        let claims = claims.map_err(ProviderError::Token)?;
        let subject = claims.subject().clone();
        let mut told = vec![serde_json::to_value(claims).unwrap_or_default()];
        // many providers put addresses and groups there alone
        if client.user_info_url().is_some() {
            let request = client.user_info(tokens.access_token().clone(), Some(subject.clone()));
            let request = request.map_err(|error| self.unreachable("user info", &error))?;
            let more: UserInfoClaims<Others, CoreGenderClaim> = request
                .request_async(&carry)
                .await
                .map_err(|error| self.unreachable("user info", &error))?;
            told.push(serde_json::to_value(more).unwrap_or_default());
        }
        let (issuer, groups) = (self.issuer.as_str(), &self.settings.groups_claim);
        Ok(Vouched::by_claims(issuer, &subject, &told, groups))
    }

    /// Metadata that are no older than `most`.
    async fn known(&self, most: Duration) -> Result<Arc<Known>, ProviderError> {
        let mut known = self.known.lock().await;
        if let Some(fresh) = known.as_ref().filter(|of| of.since.elapsed() < most) {
            return Ok(fresh.clone());
        }
        let carry = |request| carry(self.http.clone(), request);
        let metadata = CoreProviderMetadata::discover_async(self.issuer.clone(), &carry)
            .await
            .map_err(|error| self.unreachable("discovery", &error))?;
        let fetched = Arc::new(Known {
            since: Instant::now(),
            metadata,
        });
        *known = Some(fetched.clone());
        Ok(fetched)
    }

    fn client(&self, known: &Known) -> Client {
        let id = ClientId::new(self.settings.client_id.clone());
        let metadata = known.metadata.clone();
        let ways = metadata.token_endpoint_auth_methods_supported();
        // the standard's own way unless the provider does not take it
        let has = |way| ways.is_none_or(|ways| ways.contains(&way));
        let by = match has(CoreClientAuthMethod::ClientSecretBasic) {
            true => AuthType::BasicAuth,
            false => AuthType::RequestBody,
        };
        Client::from_provider_metadata(metadata, id, self.secret.clone())
            .set_redirect_uri(self.redirect.clone())
            .set_auth_type(by)
    }

    fn unreachable(&self, what: &'static str, error: &dyn std::error::Error) -> ProviderError {
        let causes = std::iter::successors(Some(error), |error| error.source());
        let causes: Vec<String> = causes.map(ToString::to_string).collect();
        ProviderError::Unreachable {
            issuer: self.issuer.to_string(),
            what,
            reason: causes.join(": "),
        }
    }
}

/// Takes signatures by public keys alone: one by the client's secret would be as good as the secret.
fn verifier(client: &Client) -> openidconnect::IdTokenVerifier<'_, CoreJsonWebKey> {
    use CoreJwsSigningAlgorithm::{
        EcdsaP256Sha256, EcdsaP384Sha384, EdDsa, RsaSsaPkcs1V15Sha256, RsaSsaPkcs1V15Sha384,
        RsaSsaPkcs1V15Sha512, RsaSsaPssSha256, RsaSsaPssSha384, RsaSsaPssSha512,
    };
    client.id_token_verifier().set_allowed_algs([
        RsaSsaPkcs1V15Sha256,
        RsaSsaPkcs1V15Sha384,
        RsaSsaPkcs1V15Sha512,
        RsaSsaPssSha256,
        RsaSsaPssSha384,
        RsaSsaPssSha512,
        EcdsaP256Sha256,
        EcdsaP384Sha384,
        EdDsa,
    ])
}

/// Carries a request of the protocol to the provider.
async fn carry(http: reqwest::Client, request: HttpRequest) -> Result<HttpResponse, CarryError> {
    let failed = |error: reqwest::Error| CarryError::Http(error.without_url().to_string());
    let request = reqwest::Request::try_from(request).map_err(failed)?;
    let mut answer = http.execute(request).await.map_err(failed)?;
    let mut response = axum::http::Response::builder().status(answer.status());
    if let Some(headers) = response.headers_mut() {
        *headers = answer.headers().clone();
    }
    let mut body = Vec::new();
    while let Some(piece) = answer.chunk().await.map_err(failed)? {
        if body.len() + piece.len() > LONGEST_ANSWER {
            return Err(CarryError::Long);
        }
        body.extend_from_slice(&piece);
    }
    let response = response.body(body);
    response.map_err(|error| CarryError::Http(error.to_string()))
}
