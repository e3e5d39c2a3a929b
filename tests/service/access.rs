//! Who may use a server: everybody here by its own name, nobody from a web page of elsewhere, and
//! only holders of a token where tokens are demanded.
use loadframe_tests::{Server, loadframe};
use serde_json::Value;

#[test]
fn an_open_server_answers_under_its_own_names_only() {
    let server = Server::start();
    let ask = |headers: &[(&str, &str)]| {
        server
            .client
            .send("GET", "/v1/jobs", headers, b"")
            .unwrap()
            .status
    };
    assert_eq!(ask(&[("host", "localhost:1234")]), 200);
    let own = ("host", "localhost:1234");
    assert_eq!(ask(&[own, ("origin", "http://localhost:1234")]), 200);
    let refused = [
        [("host", "lab.example.com")],
        [("origin", "http://localhost:1234")],
        [("origin", "https://lab.example.com")],
        [("origin", "null")],
    ];
    for header in refused {
        assert_eq!(ask(&header), 403, "{header:?}");
    }
}

#[test]
fn tokens_are_made_demanded_and_revoked() {
    let server = Server::start_with(&["--require-token"]);
    let token = |arguments: &[&str]| -> Value {
        let mut command = loadframe();
        command
            .arg("token")
            .args(arguments)
            .args(["--json", "--data"])
            .arg(server.data());
        let output = command.output().unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
    };
    let ask = |secret: &str| {
        let bearer = format!("Bearer {secret}");
        server
            .client
            .send("GET", "/v1/jobs", &[("authorization", &bearer)], b"")
            .unwrap()
            .status
    };
    assert_eq!(server.client.get("/v1/jobs").status, 401);
    assert_eq!(ask("guessed"), 401);
    let made = token(&["create", "--name", "a test"]);
    let (id, secret) = (
        made["id"].as_str().unwrap(),
        made["secret"].as_str().unwrap(),
    );
    assert_eq!(ask(secret), 200);
    // the secret is stored nowhere
    let listed = token(&["list"]);
    assert!(
        listed.to_string().contains("a test") && !listed.to_string().contains(secret),
        "{listed}"
    );
    for file in std::fs::read_dir(server.data()).unwrap() {
        let path = file.unwrap().path();
        let bytes = if path.is_file() {
            std::fs::read(&path).unwrap()
        } else {
            Vec::new()
        };
        let holds = bytes
            .windows(secret.len())
            .any(|window| window == secret.as_bytes());
        assert!(!holds, "{} holds the secret", path.display());
    }
    token(&["revoke", id]);
    assert_eq!(
        ask(secret),
        401,
        "with the next request, by whichever process"
    );
}

#[test]
fn a_server_for_others_demands_tokens() {
    let server = Server::start_on("0.0.0.0", &[]);
    assert_eq!(server.client.get("/healthz").status, 200);
    for path in ["/v1/jobs", "/v1/kinds", "/metrics"] {
        assert_eq!(server.client.get(path).status, 401, "{path}");
    }
}
