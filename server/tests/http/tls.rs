//! TLS: what is believed, what is refused, and a certificate that is renewed.
use std::fs::{self, Permissions};
use std::net::SocketAddr;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::sync::Arc;

use loadframe_client::{ServerClient, ServerError};
use loadframe_server::connections::{ConnectionLimits, Listening, Tls, TlsError, TlsFiles};
use reqwest::Method;
use tempfile::TempDir;
use tokio::net::TcpListener;

use crate::support::Lab;

/// Writes a new certificate of `localhost` and its key; the certificate in PEM.
fn write_certificate(folder: &Path) -> (TlsFiles, String) {
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]);
    let made = made.expect("a certificate");
    let files = TlsFiles {
        certificate: folder.join("certificate.pem"),
        key: folder.join("key.pem"),
    };
    fs::write(&files.certificate, made.cert.pem()).expect("written");
    fs::write(&files.key, made.signing_key.serialize_pem()).expect("written");
    fs::set_permissions(&files.key, Permissions::from_mode(0o600)).expect("private");
    (files, made.cert.pem())
}

async fn listen(lab: &Lab, tls: Arc<Tls>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    let listening = Listening {
        listener,
        app: lab.router.clone(),
        tls: Some(tls),
        limits: ConnectionLimits::with_places(64),
        stopping: lab.state.stopping.clone(),
    };
    tokio::spawn(listening.serve());
    address
}

async fn ask(address: SocketAddr, authorities: &str) -> Result<u16, ServerError> {
    let url = format!("https://localhost:{}", address.port());
    let client = ServerClient::trusting(&url, None, Some(authorities.as_bytes()))?;
    let answer = client.send(client.request(Method::GET, "/v1/jobs")).await?;
    Ok(answer.status().as_u16())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_certificate_is_believed_by_who_trusts_it_and_renewed_without_a_restart() {
    let folder = TempDir::new().expect("a folder");
    let (files, first) = write_certificate(folder.path());
    let tls = Arc::new(Tls::open(files).expect("a certificate"));
    let lab = Lab::open().await;
    let address = listen(&lab, tls.clone()).await;
    assert_eq!(ask(address, &first).await.expect("believed"), 200);
    assert!(!tls.renew().expect("nothing new"));

    // the certificate of one pair and the key of another: what was read before stays
    let other = TempDir::new().expect("a folder");
    let (other, second) = write_certificate(other.path());
    fs::write(folder.path().join("certificate.pem"), &second).expect("written");
    let refused = tls.renew().expect_err("they do not fit");
    assert!(matches!(refused, TlsError::Unusable { .. }), "{refused}");
    assert_eq!(ask(address, &first).await.expect("still the first"), 200);

    fs::copy(&other.key, folder.path().join("key.pem")).expect("written");
    assert!(tls.renew().expect("a new one"));
    assert_eq!(ask(address, &second).await.expect("the second"), 200);
    let stranger = ask(address, &first).await.expect_err("not believed");
    assert!(stranger.to_string().contains("certificate"), "{stranger}");
}

#[tokio::test(flavor = "multi_thread")]
async fn plain_http_gets_no_answer_where_tls_is_spoken() {
    let folder = TempDir::new().expect("a folder");
    let (files, _) = write_certificate(folder.path());
    let lab = Lab::open().await;
    let address = listen(&lab, Arc::new(Tls::open(files).expect("a certificate"))).await;
    let client = ServerClient::new(&format!("http://{address}"), None).expect("a client");
    let refused = client.send(client.request(Method::GET, "/v1/jobs")).await;
    let refused = refused.expect_err("no answer");
    assert!(
        matches!(refused, ServerError::Unreachable { .. }),
        "{refused}"
    );
}

#[test]
fn files_that_cannot_be_used_are_named() {
    let folder = TempDir::new().expect("a folder");
    let (files, _) = write_certificate(folder.path());
    let open = |files: &TlsFiles| {
        Tls::open(files.clone())
            .map(drop)
            .map_err(|error| error.to_string())
    };
    assert_eq!(open(&files), Ok(()));
    for (mode, is_private) in [(0o640, true), (0o400, true), (0o644, false), (0o660, false)] {
        fs::set_permissions(&files.key, Permissions::from_mode(mode)).expect("set");
        let opened = open(&files);
        assert_eq!(opened.is_ok(), is_private, "{mode:o}");
        if let Err(sentence) = opened {
            assert!(sentence.contains(&format!("{mode:03o}")), "{sentence}");
            assert!(sentence.contains("key.pem"), "{sentence}");
        }
    }
    fs::set_permissions(&files.key, Permissions::from_mode(0o600)).expect("set");
    let swapped = TlsFiles {
        certificate: files.key.clone(),
        ..files.clone()
    };
    let sentence = open(&swapped).expect_err("a key is no certificate");
    assert!(
        sentence.ends_with("key.pem has no certificate in PEM"),
        "{sentence}"
    );
    let absent = TlsFiles {
        certificate: folder.path().join("absent.pem"),
        ..files
    };
    let sentence = open(&absent).expect_err("it is not there");
    assert!(
        sentence.ends_with("absent.pem cannot be read"),
        "{sentence}"
    );
}
